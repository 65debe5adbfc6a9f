// The state of the pose: its status, and how close to a singular position it is.
import { traceColour, traceShare } from "cb/colours";

const ROUNDING = 1e-12; // a smaller value says nothing but zero

/** Keep the status and the singular value in the panel up to date. */
export function startState(page, root) {
  const status = root.querySelector("[data-status]");
  const singular = root.querySelector("[data-singular]");
  const part = (name) => singular.querySelector(name);
  page.onChange(() => {
    const { status: word, words } = page.status;
    status.dataset.status = word;
    const text = [word, words].filter(Boolean).join(" · ");
    if (status.textContent !== text) status.textContent = text;
    const found = page.measures;
    const value = found ? found.smallest : NaN;
    singular.dataset.singular = found ? String(value) : "";
    singular.style.setProperty("--colour", traceColour(value));
    part(".level").style.width = `${100 * (found ? traceShare(value) : 0)}%`;
    part(".number").textContent = found ? `${value < ROUNDING ? 0 : Number(value.toPrecision(2))}` : "–";
    part(".sentence").textContent = found ? found.sentence : "No pose, no measure.";
  });
}
