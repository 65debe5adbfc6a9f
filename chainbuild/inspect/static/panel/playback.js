// Plays back the rows of a table: clock, slider, notes on rows, the legend of the trace, errors of a recording.
// Texts come from files: they are set as text, never as HTML.

import { HIGHEST, LOWEST, traceColour } from "cb/colours";
import { between, drawErrors, drawTrace, errorScale } from "cb/trace";

const SPEEDS = [0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000];
const WHOLE = 10; // seconds that all rows take at first, about
const LONGEST_STEP = 0.25; // seconds between two frames: a page in the background does not leap
const NOTES_SHOWN = 500; // more would make the page slow; they are counted
const VIOLATIONS = new Set(["limit", "reach", "unreachable", "no_pose"]);
const WORDS = { axes: "axis values", poses: "poses, solved one from the other", recording: "recording" };
const SCALES = [1, 10, 100, 1000, 10000];

function made(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

function button(text, act) {
  const element = made("button", { type: "button", textContent: text });
  element.addEventListener("click", act);
  return element;
}

function labelled(text, control) {
  return made("label", {}, `${text} `, control);
}

function choice(values, chosen, shown) {
  const element = made("select");
  for (const value of values) {
    element.append(made("option", { value: String(value), textContent: shown(value), selected: value === chosen }));
  }
  return element;
}

/** Fill the section `page.root` and play back `page.data.playback`; null where there is none.
 *  Returns {play, pause, seek(number of a row), row, playing, ready: a promise of the trace}. */
export function startPlayback(page) {
  const data = page.data.playback;
  if (!data) {
    page.root.hidden = true;
    return null;
  }
  const player = new Player(page, data);
  const slot = made("p"); // of what is there when the trace is
  page.root.setAttribute("aria-label", "Playback");
  page.root.append(
    made("h2", { textContent: "Playback" }),
    made("p", { textContent: `${data.source}: ${data.rows.length} rows, ${WORDS[data.kind]}` }),
    ...player.controls(),
    ...noteList(data, player),
    legend(),
    slot,
  );
  if (data.measured) page.root.append(errorChoice(page, data));
  if (page.data.given) player.label("");
  else player.seek(data.numbers[0]);
  const ready = drawTrace(page).then((trace) => { slot.append(traceChoice(page, trace)); });
  return {
    play: () => player.play(),
    pause: () => player.pause(),
    seek: (number) => player.seek(number),
    leave: () => player.leave(),
    get row() { return player.number; },
    get playing() { return player.playing; },
    ready,
  };
}

class Player {
  constructor(page, data) {
    this.page = page;
    this.data = data;
    this.place = 0; // in rows from 0; between rows only while it plays
    this.playing = false;
    this.index = new Map(data.numbers.map((number, n) => [number, n]));
    // In the order of the rows, as the notes are.
    this.violations = data.notes.filter((note) => VIOLATIONS.has(note.kind)).map((note) => note.row);
  }

  get number() {
    return this.data.numbers[Math.floor(this.place)];
  }

  controls() {
    const count = this.data.rows.length;
    this.button = button("Play", () => (this.playing ? this.pause() : this.play()));
    this.button.dataset.play = "";
    this.slider = made("input", { type: "range", min: "0", max: String(count - 1), step: "1", value: "0" });
    this.slider.setAttribute("aria-label", `Row of ${this.data.source}`);
    this.slider.style.width = "100%";
    this.slider.addEventListener("input", () => this.seek(this.data.numbers[Number(this.slider.value)]));
    this.speed = choice(SPEEDS, SPEEDS.find((speed) => count / speed <= WHOLE) ?? SPEEDS.at(-1), (speed) => `${speed} rows/s`);
    this.speed.dataset.speed = "";
    this.row = made("strong"); // no output: a reader would be told every row that passes
    this.told = made("p", { className: "playback-told" });
    this.told.setAttribute("role", "status");
    const [before, after] = [button("Previous violation", () => this.step(-1)), button("Next violation", () => this.step(1))];
    for (const one of [before, after]) one.disabled = this.violations.length === 0;
    return [
      made("p", {}, this.button, " ", labelled("Speed", this.speed)),
      this.slider,
      made("p", {}, "Row ", this.row, ` of ${count}`),
      made("p", {}, before, " ", after),
      this.told,
    ];
  }

  play() {
    if (this.playing) return;
    if (this.place >= this.data.rows.length - 1) this.place = 0;
    this.turn(true);
    let last = null;
    const tick = (now) => {
      if (!this.playing) return;
      const step = last === null ? 0 : Math.min(Math.max(now - last, 0) / 1000, LONGEST_STEP);
      last = now;
      this.place = Math.min(this.place + step * Number(this.speed.value), this.data.rows.length - 1);
      this.show();
      if (this.place >= this.data.rows.length - 1) this.pause();
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  /** Stop, on the nearest row. */
  pause() {
    if (!this.playing) return;
    this.turn(false);
    this.place = Math.round(this.place);
    this.show();
  }

  turn(playing) {
    this.playing = playing;
    this.button.textContent = playing ? "Pause" : "Play";
    // What passes by is not read out.
    this.told.setAttribute("aria-live", playing ? "off" : "polite");
  }

  /** Stop at the row with a number of the file. */
  seek(number) {
    const n = this.index.get(number);
    if (n === undefined) return;
    this.turn(false);
    this.place = n;
    this.show();
  }

  /** Stop where something else has moved the machine: no row is shown. */
  leave() {
    this.turn(false);
    this.place = Math.round(this.place);
    this.label("");
    this.told.textContent = "";
  }

  step(side) {
    const here = this.number;
    const ahead = this.violations.filter((row) => side * (row - here) > 0);
    if (ahead.length) this.seek(ahead.at(side > 0 ? 0 : -1));
    else this.told.textContent = `no violation ${side > 0 ? "after" : "before"} row ${here}`;
  }

  show() {
    const n = Math.floor(this.place);
    const axes = between(this.data.rows, n, this.place - n);
    if (axes !== null) this.page.setAxes(axes);
    this.slider.value = String(n);
    this.label(this.number);
    this.told.textContent = this.words(n).join("\n");
    this.page.redraw();
  }

  label(number) {
    this.row.dataset.row = String(number);
    this.row.textContent = number === "" ? "–" : String(number);
    this.slider.setAttribute("aria-valuetext", number === "" ? "none shown" : `row ${number}`);
  }

  words(n) {
    const { numbers, notes, rows, singular, errors } = this.data;
    const number = numbers[n];
    const said = rows[n] === null ? ["no axis values: the machine stays where it was"] : [];
    if (singular[n] !== null) said.push(`smallest singular value ${Number(singular[n].toPrecision(3))}`);
    const error = errors && errors[n];
    if (error) {
      const parts = error.map((value, k) => `d${"xyz"[k]} ${signed(value)}`).join(", ");
      const turned = this.data.turns[n] === null ? "" : `, turned by ${this.data.turns[n].toFixed(3)}°`;
      said.push(`measured ${Math.hypot(...error).toFixed(3)} mm from the model (${parts})${turned}`);
    }
    return [...said, ...notes.filter((note) => note.row <= number && number <= note.last).map((note) => note.text)];
  }
}

function signed(value) {
  const shown = value.toFixed(3);
  return Number(shown) === 0 ? "0.000" : `${value < 0 ? "\u2212" : "+"}${Math.abs(value).toFixed(3)}`;
}

function noteList(data, player) {
  const list = made("ul", { className: "playback-notes" });
  Object.assign(list.style, { maxHeight: "14em", overflowY: "auto", listStyle: "none", padding: 0 });
  for (const note of data.notes.slice(0, NOTES_SHOWN)) {
    const rows = note.last > note.row ? `rows ${note.row} \u2026 ${note.last}` : `row ${note.row}`;
    const jump = button(`${rows}: ${note.text}`, () => player.seek(note.row));
    jump.dataset.note = note.kind;
    Object.assign(jump.style, { width: "100%", textAlign: "left" });
    list.append(made("li", {}, jump));
  }
  const more = data.notes.length - NOTES_SHOWN;
  const said = `${data.notes.length || "No"} note${data.notes.length === 1 ? "" : "s"} on rows`;
  const rest = more > 0 ? [made("p", { textContent: `\u2026 and ${more} more` })] : [];
  const remarks = data.remarks.map((text) => made("p", { className: "soft", textContent: text }));
  return [made("h3", { textContent: said }), ...(data.notes.length ? [list] : []), ...rest, ...remarks];
}

function legend() {
  const ticks = [];
  for (let value = LOWEST; value < 1.001 * HIGHEST; value *= 10) ticks.push(Number(value.toPrecision(1)));
  const bar = made("div");
  Object.assign(bar.style, { height: "10px", borderRadius: "3px" });
  const steps = 24; // colours of the bar: it looks like a ramp
  const stops = Array.from({ length: steps + 1 }, (_, n) => traceColour(LOWEST * (HIGHEST / LOWEST) ** (n / steps)));
  bar.style.background = `linear-gradient(to right, ${stops.join(", ")})`;
  const scale = made("div", {}, ...ticks.map((value, n) => made("span", {
    textContent: n === 0 ? `\u2264 ${value}` : n === ticks.length - 1 ? `\u2265 ${value}` : String(value),
  })));
  Object.assign(scale.style, { display: "flex", justifyContent: "space-between" });
  const figure = made("figure", { className: "playback-legend" }, bar, scale, made("figcaption", {
    textContent: "Trace: smallest singular value, scaled; red is singular, grey unknown",
  }));
  figure.style.margin = "8px 0";
  return figure;
}

function traceChoice(page, trace) {
  const box = made("input", { type: "checkbox", checked: true });
  box.addEventListener("input", () => {
    trace.visible = box.checked;
    page.redraw();
  });
  return labelled("Trace", box);
}

function errorChoice(page, data) {
  const select = choice(SCALES, errorScale(data.measured, data.errors), (scale) => `\u00d7${scale}`);
  select.dataset.errorScale = "";
  const said = made("p");
  let drawn = null;
  const draw = () => {
    if (drawn) {
      page.inWorkpiece.remove(drawn);
      drawn.children.forEach((child) => { child.geometry.dispose(); child.material.dispose(); });
    }
    const scale = Number(select.value);
    drawn = drawErrors(page, scale);
    said.textContent = `violet: measured points; lines: errors of the model, drawn ${scale} times as long`;
  };
  select.addEventListener("input", draw);
  draw();
  return made("div", {}, labelled("Errors", select), said);
}
