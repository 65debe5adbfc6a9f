// Named poses: a button each, with a note on the one that was chosen.
import { element } from "cb/elements";

/** Offer the named poses of the page. */
export function startNamed(page, root) {
  const note = root.querySelector(".note");
  const made = () => page.data.presets.map((preset) => {
    const button = element("button", { type: "button", "data-preset": preset.name }, preset.title);
    if (preset.note) button.title = preset.note;
    button.addEventListener("click", () => {
      page.setAxes(preset.axes, "preset");
      note.textContent = preset.note;
    });
    return button;
  });
  let buttons = [];
  page.offerPoses = (presets) => {
    page.data.presets = presets;
    buttons = made();
    root.querySelector(".rows").replaceChildren(...buttons);
  };
  page.offerPoses(page.data.presets);
  page.onChange((_, cause) => {
    if (cause !== "search") note.textContent = "";
    buttons.forEach((button, n) => {
      const same = page.data.presets[n].axes.every((v, k) => Math.abs(v - page.axes[k]) < 1e-9);
      button.setAttribute("aria-pressed", String(same));
    });
  });
}
