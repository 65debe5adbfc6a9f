// The lengths of the machine data: lines in the links, from where something would be with the length 0 to where it is.

const COLOUR = 0xc2185b; // as no body, no axis and no colour of a trace
const THICKNESS = 0.0018; // radius over the machine's size

/** Draw the lengths; the box in the toolbar shows and hides them. */
export function startDimensions(page, tools) {
  const { machine } = page;
  const { three } = machine;
  machine.shows.dimensions = false;
  const material = new three.MeshBasicMaterial({ color: COLOUR, depthTest: false, transparent: true }); // inside bodies, too
  let lines = [];
  const label = tools.querySelector("#lengths");
  const box = label.querySelector("input");
  const drawn = () => page.data.dimensions.map(({ link, start, end }) => {
    const line = machine.bar(material, 10);
    machine.lay(line, start, end, THICKNESS * page.data.size);
    line.visible = box.checked;
    machine.links[link].add(line);
    return line;
  });
  // Ends of a line in the base, as the scene has it: along y of the shape, whose length is 1.
  machine.drawnLength = (n) => [-0.5, 0.5].map((y) => {
    return new three.Vector3(0, y, 0).applyMatrix4(machine.inBase(lines[n])).toArray();
  });
  const draw = () => {
    lines.forEach((line) => line.removeFromParent());
    lines = drawn();
    label.hidden = lines.length === 0;
  };
  page.onModel(draw);
  draw();
  box.addEventListener("input", () => {
    machine.shows.dimensions = box.checked;
    lines.forEach((line) => { line.visible = box.checked; });
    machine.viewer.set_dirty();
  });
}
