// Elements of the panel. Texts of machine data reach the page as text only, never as markup.

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

/** Call a function with every finite number typed into a field; the field is written anew when it is left. */
export function onTyped(field, decimals, act) {
  field.addEventListener("input", () => {
    field.dataset.typed = "true";
    const value = field.valueAsNumber;
    field.setAttribute("aria-invalid", String(!Number.isFinite(value)));
    if (Number.isFinite(value)) act(value);
  });
  field.addEventListener("change", () => {
    delete field.dataset.typed;
    field.removeAttribute("aria-invalid");
    field.value = fixed(Number(field.dataset.value), decimals);
  });
}
