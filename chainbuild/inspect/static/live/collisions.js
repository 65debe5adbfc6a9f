// Which bodies touch, and how far apart the nearest are, as Python finds it.
import { element, written } from "cb/elements";

const COLOUR = 0xd4281c;
const THICKNESS = 0.0022; // radius over the machine's size

/** Show what touches; return what takes a message of it. */
export function startCollisions(page, root, highlights) {
  const words = element("p", { class: "words soft", role: "status" });
  const list = element("ul", { class: "pairs" });
  root.append(words, list);
  const line = lineOf(page);
  return ({ pairs, touching, watched, words: reason }) => {
    root.dataset.collision = touching.length ? "true" : "false";
    root.classList.toggle("outside", touching.length > 0);
    words.textContent = reason || wordsOf(touching.length, watched);
    const touch = new Set(touching.map((bodies) => bodies.join("\n")));
    list.replaceChildren(...pairs.map((pair) => {
      const touches = touch.has(pair.bodies.join("\n"));
      const row = element("li", { "data-collision": pair.bodies.join(" – "), "data-mm": String(pair.mm) });
      row.classList.toggle("outside", touches);
      const far = touches ? `touch, ${written(-pair.mm, 1)}\u00a0mm deep` : `${written(pair.mm, 1)}\u00a0mm apart`;
      row.append(element("span", {}, pair.bodies.join(" – ")), element("b", {}, far));
      return row;
    }));
    const links = pairs.filter((pair) => touch.has(pair.bodies.join("\n"))).flatMap((pair) => pair.links);
    highlights.show("touching", links);
    line(pairs.length ? pairs[0].points : null);
  };
}

function wordsOf(touching, watched) {
  if (watched === 0) return "No two bodies of this machine can touch: its data hold bodies of neighbours only.";
  const bodies = "Bodies as in chainbuild collide: those of the overlay, else capsules along the links, not what is drawn.";
  return `${touching || "None"} of ${watched} pairs touch${touching === 1 ? "es" : ""}. ${bodies}`;
}

/** Return what draws the shortest way between the two nearest bodies. */
function lineOf({ machine, data }) {
  const { three } = machine;
  const material = new three.MeshBasicMaterial({ color: COLOUR, depthTest: false, transparent: true });
  const line = machine.bar(material, 11);
  line.visible = false;
  machine.root.add(line);
  return (points) => {
    line.visible = points !== null;
    if (points === null) return;
    const thick = THICKNESS * data.size;
    machine.lay(line, ...points, thick, thick); // bodies that touch have no distance
    machine.viewer.set_dirty();
  };
}
