// The pose as the controller displays it: fields that follow the machine, and move it.
import { fill, onTyped } from "cb/elements";

/** Let the fields of the pose move the machine, and follow it. */
export function startPose(page, root) {
  const fields = [...root.querySelectorAll("[data-pose]")];
  const vector = page.chain.data.display.kind === "vector";
  const decimals = (column) => (vector && !column.endsWith("_mm") ? 4 : 3);
  // What was typed since the pose last changed otherwise: columns are typed one by one, and a pose on the way to the one
  // that is meant may be out of reach.
  let typed = null;
  fields.forEach((field) => {
    const column = field.dataset.pose;
    onTyped(field, decimals(column), (value) => {
      const shown = page.displayed();
      if (typed === null && shown === null) return;
      typed = typed || { shown, start: page.axes.slice() };
      typed.shown[column] = value;
      page.setDisplayed({ ...typed.shown }, typed.start);
    });
  });
  page.onChange((_, cause) => {
    if (cause !== "pose" && cause !== "search") typed = null;
    const shown = page.displayed();
    root.classList.toggle("missed", page.status.status === "unreachable" || page.status.status === "stalled");
    fields.forEach((field) => {
      const column = field.dataset.pose;
      if (shown) fill(field, shown[column], decimals(column));
    });
  });
}
