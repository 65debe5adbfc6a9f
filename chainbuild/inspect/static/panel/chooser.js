// The solutions of the pose: a button each, which names the axes that differ from where the machine stands.
import { statusTurn } from "cb/status";
import { element, unitText, written } from "cb/elements";

const DIFFERS = 0.05; // mm and degrees
const MOST = 64; // buttons; more are told by their number

/** Offer the other solutions of the pose; `ghosts.emphasise(k)` makes the one that is looked at strong. */
export function startChooser(page, root, ghosts) {
  const words = root.querySelector(".words");
  const rows = root.querySelector(".rows");
  const made = [];
  const button = (k) => {
    const one = element("button", { type: "button", "data-branch": String(k) });
    one.addEventListener("click", () => page.choose(k));
    ["pointerenter", "focus"].forEach((name) => one.addEventListener(name, () => ghosts.emphasise(k)));
    ["pointerleave", "blur"].forEach((name) => one.addEventListener(name, () => ghosts.emphasise(null)));
    return one;
  };
  page.onChange(() => {
    const { branches, family } = page.status;
    words.textContent = wordsOf(page, branches.length, family);
    const shown = branches.slice(0, MOST);
    while (made.length < shown.length) made.push(button(made.length));
    // Buttons stay where they are: the one that has the focus keeps it.
    if (rows.children.length !== shown.length) rows.replaceChildren(...made.slice(0, shown.length));
    shown.forEach((axes, k) => describe(page, made[k], axes, k));
  });
}

function wordsOf(page, count, family) {
  const { searched, singular } = page.status;
  if (family) return "One of infinitely many: more axes move than the pose determines.";
  if (page.status.status === "unreachable") return "None: out of reach.";
  if (!searched) return "Not searched yet.";
  const parts = [count > 1 ? `${count} within the limits` : count ? "No other within the limits" : "None within the limits"];
  if (count) parts.push("whole turns of an axis do not count");
  if (singular) parts.push("the machine is singular here, so that each may be one of infinitely many");
  const { display, task } = page.chain.data;
  // The rotary axes are displayed themselves: another solution is another display.
  if (count > 1 && display.kind === "axes" && task === "direction") parts.push("others turn the displayed axes to the same tool vector");
  return `${parts.join("; ")}.`;
}

function describe(page, button, axes, k) {
  const different = page.axes.map((_, n) => n).filter((n) => !(Math.abs(axes[n] - page.axes[n]) < DIFFERS));
  const parts = different.map((n) => `${page.chain.names[n]}\u00a0${written(axes[n], 1)}${unitText(page.chain.axes[n].unit)}`);
  const here = different.length === 0;
  const bits = statusTurn(page.chain, axes);
  const status = bits ? ` · IS\u00a0${bits[0]} IT\u00a0${bits[1]}` : "";
  button.setAttribute("aria-pressed", String(here));
  const text = `${k + 1}  ${here ? "shown" : parts.join("  ")}${status}`;
  if (button.textContent !== text) button.textContent = text;
}
