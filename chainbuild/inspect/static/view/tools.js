// The buttons over the picture: what it shows, and from where.
import { linkBodies, linkFrames } from "cb/machine";

/** Let the buttons over the picture work. */
export function startTools(page, root, ghosts) {
  const { machine } = page;
  root.querySelector("#fit").addEventListener("click", () => {
    machine.moved = false;
    machine.fit();
  });
  const shown = root.querySelector("[data-show=ghosts]");
  shown.addEventListener("input", () => {
    ghosts.group.visible = shown.checked;
    machine.viewer.set_dirty();
  });
  const parts = { bodies: linkBodies, frames: linkFrames };
  Object.entries(parts).forEach(([name, of]) => {
    const box = root.querySelector(`[data-show=${name}]`);
    const show = () => {
      machine.shows[name] = box.checked;
      machine.links.forEach((_, n) => of(machine, n).forEach((part) => { part.visible = box.checked; }));
      machine.viewer.set_dirty();
    };
    box.addEventListener("input", show);
    page.onModel(show);
  });
}
