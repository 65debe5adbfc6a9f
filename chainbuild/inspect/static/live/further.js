// Further machines in the scene, as ghosts at the same axis values: that of the file while its data are changed here,
// and a second one that is shown beside it.
import { Chain } from "cb/chain";
import { element, written } from "cb/elements";
import { inverse, multiply } from "cb/linear";

const LOOKS = { file: { colour: 0x7a4fb0, opacity: 0.28 }, beside: { colour: 0x1f8a70, opacity: 0.42 } };

/** Draw the further machines, and tell how far their poses are from that of the machine. */
export function startFurther(page, root) {
  const { further } = page.data.live;
  const made = Object.entries(further).map(([name, data]) => new Further(page, name, data));
  page.further = made;
  const rows = made.map((one) => {
    const box = element("input", { type: "checkbox", "data-further": one.name });
    box.checked = true;
    const words = element("span", { class: "difference" });
    const row = element("div", { class: "further" }, element("label", {}, box, ` ${one.title}`), words);
    root.append(row);
    box.addEventListener("input", update);
    return { one, box, words, row };
  });
  function update() {
    const { changed } = page.data.live;
    let any = false;
    rows.forEach(({ one, box, words, row }) => {
      const there = one.name !== "file" || changed;
      any = any || there;
      row.hidden = !there;
      one.move(there && box.checked);
      if (there) words.textContent = one.difference(row);
    });
    root.hidden = !any;
  }
  page.onChange((_, cause) => { if (cause !== "search") update(); });
  update();
  if (further.beside) page.machine.fit();
}

class Further {
  constructor(page, name, data) {
    const { machine } = page;
    Object.assign(this, { page, name, chain: new Chain(data.chain) });
    this.title = name === "file" ? "as in the file" : data.title;
    machine.play(data.commands);
    this.root = machine.node(name);
    machine.beside.push(this.root);
    this.links = data.chain.links.map((link) => machine.node(data.paths[link]));
    const { three } = machine;
    const { colour, opacity } = LOOKS[name];
    const material = new three.MeshLambertMaterial({
      color: colour, transparent: true, opacity, depthWrite: false,
      polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2, // behind bodies in the same place
    });
    this.root.traverse((part) => { if (part.isMesh) part.material = material; });
    // Its axes by the names of the machine's; what the machine has not stays where it rests.
    this.from = this.chain.axes.map((axis) => page.chain.axes.findIndex((own) => own.name === axis.name));
    this.rest = data.rest;
    const lacks = this.chain.axes.filter((_, n) => this.from[n] < 0).map((axis) => axis.name);
    if (lacks.length) this.title += ` (${lacks.join(", ")} at rest)`;
  }

  axes() {
    return this.from.map((own, n) => (own < 0 ? this.rest[n] : this.page.axes[own]));
  }

  /** Show or hide it where the axes stand now. */
  move(shown) {
    const { machine } = this.page;
    const q = this.chain.q(this.axes());
    this.root.visible = shown && q.every(Number.isFinite);
    machine.viewer.set_dirty();
    if (!this.root.visible) return;
    machine.place(this.links, this.chain, q);
  }

  /** Return the placement in the base, row by row, at which a link is drawn. */
  drawn(link) {
    const node = this.links[this.chain.data.links.indexOf(link)];
    return this.page.machine.inBase(node).transpose().toArray();
  }

  /** Return in words where the machine's tool is against this one's, in its workpiece frame. */
  difference(row) {
    const [own, other] = [this.page.chain.fk(this.page.axes), this.chain.fk(this.axes())];
    if (own === null || other === null) return "no pose here";
    const shift = [3, 7, 11].map((k) => 1000 * (own[k] - other[k]));
    const turn = angleOf(multiply(inverse(other), own));
    Object.assign(row.dataset, { shift: shift.join(","), turn: String(turn) });
    return `tool ${shift.map((part, n) => `d${"xyz"[n]} ${written(part, 3)}`).join(", ")} mm, turned by ${written(turn, 3)}°`;
  }
}

function angleOf(T) {
  const sine = Math.hypot(T[9] - T[6], T[2] - T[8], T[4] - T[1]) / 2;
  return (Math.atan2(sine, (T[0] + T[5] + T[10] - 1) / 2) * 180) / Math.PI;
}
