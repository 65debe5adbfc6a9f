// The axes: a slider and a number field each.
import { fill, onTyped } from "cb/elements";

const DECIMALS = 3; // of mm and degrees, as controllers show them

/** Let the sliders and fields of the axes move the machine, and follow it. */
export function startRows(page, root) {
  const rows = [...root.querySelectorAll(".axis")];
  const sliders = rows.map((row) => row.querySelector("input[type=range]"));
  const fields = rows.map((row) => row.querySelector("input[type=number]"));
  const step = root.querySelector("select");
  const move = (n, value) => {
    page.setAxes(page.axes.map((old, k) => (k === n ? value : old)));
  };
  rows.forEach((row, n) => {
    sliders[n].addEventListener("input", () => {
      if (Number.isFinite(sliders[n].valueAsNumber)) move(n, sliders[n].valueAsNumber);
    });
    onTyped(fields[n], DECIMALS, (value) => move(n, value), () => Number(step.value));
  });
  page.onChange(() => {
    const outside = page.limits.outside(page.axes);
    rows.forEach((row, n) => {
      const value = page.axes[n];
      // A slider that is moved holds its own value, which writing it anew would only round.
      if (sliders[n].valueAsNumber !== value) sliders[n].value = String(value);
      fill(fields[n], value, DECIMALS);
      row.classList.toggle("outside", outside.includes(n));
    });
  });
}
