// The pose as the controller displays it: fields that follow the machine, and move it.
import { element, fill, onTyped, written } from "cb/elements";

/** Let the fields of the pose move the machine, and follow it. */
export function startPose(page, root) {
  const fields = [...root.querySelectorAll("[data-pose]")];
  const stands = element("p", { class: "stands", role: "status" });
  root.append(stands);
  const step = document.querySelector("#axes select");
  const vector = page.chain.data.display.kind === "vector";
  const decimals = (column) => (vector && !column.endsWith("_mm") ? 4 : 3);
  // What is asked since the pose last changed otherwise. The fields hold it, whether it is reached or not: columns are
  // typed one by one, and none may change behind the one that is typed.
  let asked = null;
  fields.forEach((field) => {
    const column = field.dataset.pose;
    const act = (value) => {
      const shown = page.displayed();
      if (asked === null && shown === null) return;
      asked = asked || { shown, start: page.axes.slice() };
      asked.shown[column] = value;
      page.setDisplayed({ ...asked.shown }, asked.start);
    };
    onTyped(field, decimals(column), act, () => (vector && !column.endsWith("_mm") ? 0.01 : Number(step.value)));
    field.addEventListener("keydown", (event) => {
      if (event.key !== "Escape" || asked === null) return;
      delete field.dataset.typed;
      page.setAxes(asked.start);
    });
  });
  page.onChange((_, cause) => {
    if (cause !== "pose" && cause !== "search") asked = null;
    const shown = page.displayed();
    const missed = page.status.status === "unreachable" || page.status.status === "stalled";
    root.classList.toggle("missed", missed);
    const held = asked ? asked.shown : shown;
    if (held) fields.forEach((field) => fill(field, held[field.dataset.pose], decimals(field.dataset.pose)));
    stands.textContent = asked && missed && shown ? standsWords(fields, shown, decimals) : "";
  });
}

/** Return where the tool stands, as it cannot be where it was asked to be. */
function standsWords(fields, shown, decimals) {
  const parts = fields.map(({ dataset: { pose: column } }) => {
    const name = column.replace(/_(mm|deg)$/, "").toUpperCase();
    return `${name}\u00a0${written(shown[column], decimals(column))}`;
  });
  return `The tool stands at ${parts.join("  ")}.`;
}
