// Limits on sums of axes and on drives, where there are any: bars with a mark where the machine stands.
import { sumOf } from "cb/limits";
import { element, unitText, written } from "cb/elements";

const BEYOND = 0.12; // of the range, shown on either side of it
const SLACK = 1e-6; // as in the limits

/** Show the further limits of the kinematic. */
export function startBars(page, root) {
  const { data } = page.chain;
  const sums = data.sums.map((sum) => ({ ...sum, unit: "deg", title: sum.label, value: (axes) => sumOf(sum, axes) }));
  const limited = new Set(data.driveLimits.map((one) => one.axis));
  const others = data.differing.filter((axis) => !limited.has(axis));
  const unlimited = others.map((axis) => ({ axis, name: `${data.axes[axis].name}_drive`, lower: null, upper: null }));
  const drives = [...data.driveLimits, ...unlimited].map((one) => {
    const axis = data.axes[one.axis];
    const value = (axes) => page.limits.driveValues(axes)[one.axis];
    return { ...one, unit: axis.unit, title: `drive of ${axis.name}`, value };
  });
  const bars = [...sums, ...drives];
  root.hidden = bars.length === 0;
  const updates = bars.map((bar) => added(root.querySelector(".rows"), bar));
  page.onChange(() => updates.forEach((update) => update(page.axes)));
}

/** Add a bar to the panel; return what moves its mark. */
function added(rows, bar) {
  const place = element("i", { class: "place" });
  const number = element("output");
  const row = element("div", { class: "bar", "data-bar": bar.name });
  row.append(element("span", { class: "name" }, bar.title), element("span", { class: "gauge" }, place), number);
  const ends = [bar.lower, bar.upper];
  const texts = ends.every((end) => end === null) ? [] : ends.map((end) => limitText(end, bar));
  row.append(element("span", { class: "ends" }, ...texts));
  rows.append(row);
  const closed = bar.lower !== null && bar.upper !== null && bar.upper > bar.lower;
  row.classList.toggle("open", !closed);
  const low = (bar.lower === null ? -Infinity : bar.lower) - SLACK;
  const high = (bar.upper === null ? Infinity : bar.upper) + SLACK;
  return (axes) => {
    const value = bar.value(axes);
    number.textContent = Number.isFinite(value) ? written(value, 3) + unitText(bar.unit) : "–";
    row.classList.toggle("outside", !(low <= value && value <= high));
    if (!closed) return;
    const share = (value - bar.lower) / (bar.upper - bar.lower);
    const shown = (Math.min(Math.max(share, -BEYOND), 1 + BEYOND) + BEYOND) / (1 + 2 * BEYOND);
    place.style.left = `${100 * (Number.isFinite(shown) ? shown : 0)}%`;
  };
}

function limitText(value, bar) {
  const text = value === null ? "no limit" : `${Number(value.toFixed(3))}`.replace("-", "\u2212") + unitText(bar.unit);
  return element("span", {}, text);
}
