// Elements of the panel. Texts of machine data reach the page as text only, never as markup.

export const SHIFTED = 10; // steps at once while shift is held

/**
 * Return a new element.
 * @param {string} tag its kind
 * @param {Object<string, string>} attributes
 * @param {...(Node|string)} children
 */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  Object.entries(attributes).forEach(([name, value]) => made.setAttribute(name, value));
  made.append(...children);
  return made;
}

/** Return a number as a person reads it: fixed decimals, a real minus, no minus before zero. */
export function written(value, decimals) {
  return fixed(value, decimals).replace("-", "\u2212");
}

/** Return a number as a field holds it. */
export function fixed(value, decimals) {
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? (0).toFixed(decimals) : text;
}

/** Return the sign of a unit as it stands behind a number. */
export const unitText = (unit) => (unit === "deg" ? "°" : " mm");

/** Show a value in a field, unless somebody is typing there. */
export function fill(field, value, decimals) {
  field.dataset.value = String(value);
  if (document.activeElement !== field || field.dataset.typed !== "true") field.value = fixed(value, decimals);
}

/** Take a comma, typed or pasted, for a point: a field of numbers drops it without a word, and 12,5 would become 125. */
export function takeComma(field) {
  field.addEventListener("beforeinput", (event) => {
    if (!event.data || !event.data.includes(",")) return;
    event.preventDefault();
    document.execCommand("insertText", false, pointed(event.data));
  });
}

/** Return a number with a decimal point: its last mark, unless that separates thousands because there are more of it. */
function pointed(text) {
  const place = text.search(/[.,][^.,]*$/);
  const without = (part) => part.replace(/[.,]/g, "");
  if (text.split(text[place]).length > 2) return without(text);
  return `${without(text.slice(0, place))}.${text.slice(place + 1)}`;
}

/**
 * Call a function with every finite number typed into a field; the field is written anew when it is left.
 * @param {function(): number} step what an arrow key adds
 */
export function onTyped(field, decimals, act, step) {
  const take = () => {
    field.dataset.typed = "true";
    const value = field.valueAsNumber;
    field.setAttribute("aria-invalid", String(!Number.isFinite(value)));
    if (Number.isFinite(value)) act(value);
  };
  field.addEventListener("input", take);
  takeComma(field);
  field.addEventListener("keydown", (event) => {
    const sign = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (!sign || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    const from = field.dataset.typed === "true" ? field.valueAsNumber : Number(field.dataset.value);
    if (!Number.isFinite(from)) return;
    field.value = fixed(from + sign * step() * (event.shiftKey ? SHIFTED : 1), decimals);
    take();
  });
  field.addEventListener("change", () => {
    delete field.dataset.typed;
    field.removeAttribute("aria-invalid");
    field.value = fixed(Number(field.dataset.value), decimals);
  });
}
