// The data of the machine: a field each, the line of the file beside it, what a change moves.
import { element, fixed, takeComma, written } from "cb/elements";

const DIGITS = 10; // significant, of a value in a field
const MANY = 30; // data above which those that are 0 are hidden at first
const HINT = "Point at a value, or go into its field, to see what it moves.";
const WAIT = 300; // milliseconds between two questions what a datum moves

/** Fill the section of the machine data; return what takes Python's messages on them. */
export function startParameters(page, link, root, highlights) {
  const { rows } = page.data.live;
  const list = element("div", { class: "rows" });
  const detail = element("p", { class: "detail soft", "aria-live": "polite" }, HINT);
  const search = element("input", { type: "search", placeholder: "find", "aria-label": "Find machine data" });
  const zeros = element("input", { type: "checkbox", "aria-label": "Show data that are 0" });
  zeros.checked = rows.length <= MANY;
  const reset = element("button", { type: "button", class: "reset" }, "As in the file");
  root.append(element("p", { class: "find" }, search, element("label", {}, zeros, " zeros"), reset), list, detail);
  const state = { pending: new Map(), busy: null, about: null, told: null };
  const drawn = rows.map((row) => {
    const made = field(row);
    list.append(made.root);
    made.input.addEventListener("input", () => {
      const value = made.input.tagName === "SELECT" ? Number(made.input.value) : made.input.valueAsNumber;
      const number = Number.isFinite(value);
      made.typed = Boolean(row.unit);
      made.root.classList.toggle("wrong", !number);
      made.told.textContent = number ? "" : `Not a number: ${textOf(Number(made.input.dataset.value))} holds.`;
      if (number) change(state, link, row.key, value);
    });
    takeComma(made.input);
    made.input.addEventListener("focus", () => { made.before = Number(made.input.dataset.value); });
    made.input.addEventListener("keydown", ({ key }) => {
      if (key !== "Escape" || !row.unit) return;
      made.input.value = textOf(made.before);
      made.root.classList.remove("wrong");
      made.told.textContent = "";
      change(state, link, row.key, made.before);
    });
    made.input.addEventListener("change", () => {
      made.typed = false;
      if (!waits(state, row.key)) show(page, made, row);
    });
    made.input.addEventListener("focus", () => about(row.key));
    made.root.addEventListener("pointerenter", () => { if (!list.contains(document.activeElement)) about(row.key); });
    made.back.addEventListener("click", () => link.send("reset", row.key));
    return made;
  });
  const filter = () => {
    const words = search.value.trim().toLowerCase();
    rows.forEach((row, n) => {
      const text = `${row.key} ${row.name} ${row.symbol} ${row.meaning}`.toLowerCase();
      const changed = row.key in page.data.live.values;
      drawn[n].root.hidden = !(text.includes(words) && (words || zeros.checked || row.value !== 0 || changed));
    });
  };
  let timer = null;
  const about = (key) => {
    state.about = key;
    window.clearTimeout(timer);
    timer = window.setTimeout(() => link.send("moves", key), state.told === key ? WAIT : 0);
  };
  const leave = () => {
    state.about = null;
    detail.textContent = HINT;
    highlights.show("moved", []);
  };
  root.addEventListener("focusout", ({ relatedTarget }) => { if (!root.contains(relatedTarget)) leave(); });
  list.addEventListener("pointerleave", () => { if (!list.contains(document.activeElement)) leave(); });
  [search, zeros].forEach((one) => one.addEventListener("input", filter));
  reset.addEventListener("click", () => link.send("reset"));
  const took = () => {
    rows.forEach((row, n) => show(page, drawn[n], row, typing(state, drawn[n], row.key)));
    reset.disabled = !page.data.live.changed;
    filter();
    done(state, link);
    if (state.about) about(state.about);
  };
  took();
  page.onChange((_, cause) => { if (state.about && cause !== "search" && cause !== "model") about(state.about); });
  return {
    took,
    lost: () => { Object.assign(state, { busy: null, pending: new Map() }); },
    refused: ({ key, text }) => {
      const n = rows.findIndex((row) => row.key === key);
      done(state, link);
      if (n < 0) return false;
      drawn[n].root.classList.add("wrong");
      drawn[n].told.textContent = text;
      return true;
    },
    moves: (found) => {
      if (found.key !== state.about) return;
      state.told = found.key;
      const row = rows.find((one) => one.key === found.key);
      highlights.show("moved", found.links);
      detail.textContent = detailOf(row, found);
    },
  };
}

/** Send a changed value, one at a time: of what is typed meanwhile the newest follows. */
function change(state, link, key, value) {
  state.pending.set(key, value);
  if (state.busy === null) next(state, link);
}

function next(state, link) {
  const [first] = state.pending;
  state.busy = first && link.open ? first[0] : null;
  if (!state.busy) return;
  state.pending.delete(first[0]);
  link.send("datum", { key: first[0], value: first[1] });
}

function done(state, link) {
  state.busy = null;
  next(state, link);
}

function field(row) {
  const attributes = { "data-parameter": row.key, "aria-label": `${row.key} ${row.unit}`, title: row.name };
  const input = row.unit
    ? element("input", { type: "number", step: "any", ...attributes })
    : element("select", attributes, ...row.choices.map((one) => element("option", { value: String(one) }, String(one))));
  const back = element("button", { type: "button", class: "back", title: "The value of the file" });
  const told = element("span", { class: "told" });
  const place = element("span", { class: "where soft" }, row.place || "not in the file: its default");
  const line = element("code", {}, row.line.trim());
  const root = element("div", { class: "datum" });
  root.append(element("span", { class: "name", title: row.name }, row.key), input, element("span", { class: "unit" }, unitOf(row)));
  root.append(element("span", { class: "source" }, place, line), back, told);
  return { root, input, back, told };
}

const textOf = (value) => String(Number(value.toPrecision(DIGITS)));

const unitOf = ({ unit }) => (unit === "deg" ? "°" : unit);

/** Return whether a value is on its way to Python. */
const waits = ({ pending, busy }, key) => pending.has(key) || busy === key;

/** Return whether somebody is typing, so that the field is theirs: a part of a number, one on its way, or one to correct. */
function typing(state, { root, input, typed }, key) {
  if (!typed || document.activeElement !== input) return false;
  return waits(state, key) || !Number.isFinite(input.valueAsNumber) || root.classList.contains("wrong");
}

/** Show the value of a datum as Python has it, and that of the file where it is another; `theirs`: the field is left alone. */
function show(page, { root, input, back, told }, row, theirs = false) {
  const { values } = page.data.live;
  const changed = row.key in values;
  const value = changed ? values[row.key] : row.value;
  root.classList.toggle("changed", changed);
  back.hidden = !changed;
  back.textContent = `file: ${textOf(row.value)}`;
  input.dataset.value = String(value);
  if (theirs) return;
  root.classList.remove("wrong");
  told.textContent = "";
  if (Number(input.value) !== value || input.value === "") input.value = textOf(value);
}

function detailOf(row, { links, shift, turn, to }) {
  const step = row.unit ? `One ${row.unit === "mm" ? "millimetre" : "degree"} more` : `${row.key} = ${to}`;
  const parts = [row.meaning && `${row.meaning.replace(/\.$/, "")}.`];
  if (!links.length && shift !== null && !shift.some((part) => Math.abs(part) > 1e-9) && turn < 1e-9) {
    parts.push(`${step} moves nothing here.`);
  } else if (shift === null) {
    parts.push("No other value can be built.");
  } else {
    const by = shift.map((part) => written(part, 3)).join(", ");
    parts.push(`${step} moves ${links.length ? links.join(", ") : "the frames alone"}; the tool in the workpiece frame by (${by}) mm`
      + `${turn > 1e-9 ? ` and ${fixed(turn, 3)}°` : ""}.`);
  }
  return parts.filter(Boolean).join(" ");
}
