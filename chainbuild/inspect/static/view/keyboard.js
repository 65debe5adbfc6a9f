// Jogging by keys: up and down choose an axis, left and right step it.

import { SHIFTED } from "cb/elements";

// Where arrows have a use of their own: fields, and sliders that are not those of axes.
const OWN = "input[type=number], input[type=search], input[type=range]:not([data-axis]), select, textarea";

/** Let the arrow keys choose and step the axes. */
export function startKeyboard(page, root) {
  const rows = [...root.querySelectorAll(".axis")];
  const sliders = rows.map((row) => row.querySelector("input[type=range]"));
  const step = root.querySelector("select");
  let chosen = 0;
  const choose = (n) => {
    chosen = (n + rows.length) % rows.length;
    rows.forEach((row, k) => row.classList.toggle("chosen", k === chosen));
  };
  rows.forEach((row, n) => row.addEventListener("focusin", () => choose(n)));
  const keys = {
    ArrowUp: () => choose(chosen - 1),
    ArrowDown: () => choose(chosen + 1),
    ArrowLeft: (many) => jog(page, chosen, -many * Number(step.value)),
    ArrowRight: (many) => jog(page, chosen, many * Number(step.value)),
  };
  document.addEventListener("keydown", (event) => {
    const typing = event.target instanceof Element && event.target.closest(OWN);
    if (!keys[event.key] || typing || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    keys[event.key](event.shiftKey ? SHIFTED : 1);
    // Whoever listens to the sliders hears which one is stepped.
    if (event.key === "ArrowUp" || event.key === "ArrowDown") sliders[chosen].focus();
  });
  choose(0);
}

/** Step an axis; from inside its limits it goes no farther than they do. */
function jog(page, n, change) {
  const { lower, upper } = page.limits;
  const from = page.axes[n];
  const to = from + change;
  const end = change > 0 && from <= upper[n] ? Math.min(to, upper[n]) : to;
  const value = change < 0 && from >= lower[n] ? Math.max(end, lower[n]) : end;
  // Steps of a tenth add up to whole numbers.
  page.setAxes(page.axes.map((v, k) => (k === n ? Number(value.toFixed(9)) : v)), "key");
}
