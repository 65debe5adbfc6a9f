// A section through the workspace, coloured by how well the tool can be moved there.
import { traceColour } from "cb/colours";
import { element } from "cb/elements";
import { originOf } from "cb/linear";

const OPACITY = 0.75;
const KINDS = {
  "": "none",
  rz: "turned about z, through the tool",
  xz: "y = 0", xy: "z = 0", yz: "x = 0",
};
// In the workpiece frame: where the way across and the way up of a section point.
const WAYS = { xz: [[1, 0, 0], [0, 0, 1]], xy: [[1, 0, 0], [0, 1, 0]], yz: [[0, 1, 0], [0, 0, 1]] };

/** Offer sections of the workspace; return what takes one from Python, and what asks again for one that has not come. */
export function startSection(page, link, root) {
  const { machine } = page;
  const select = element("select", { "data-section": "", "aria-label": "Section of the workspace" });
  Object.entries(KINDS).forEach(([value, text]) => select.append(element("option", { value }, text)));
  const words = element("p", { class: "soft", role: "status" });
  root.append(select, words);
  let shown = null;
  const clear = () => {
    if (shown) {
      shown.group.removeFromParent();
      shown.map.dispose();
    }
    shown = null;
    machine.viewer.set_dirty();
  };
  const ask = () => {
    clear();
    words.textContent = select.value ? "Being computed …" : "";
    root.dataset.state = select.value ? "asked" : "";
    link.send("section", select.value || null);
  };
  select.addEventListener("input", ask);
  page.onModel(() => { if (select.value) ask(); }); // another machine has another workspace
  page.onChange(() => { if (shown) turn(page, shown); });
  const again = () => { if (root.dataset.state === "asked") ask(); };
  const take = (found) => {
    if (found.kind !== select.value || found.number !== page.data.live.number) return;
    clear();
    if (found.refused) {
      root.dataset.state = "refused";
      words.textContent = `None: ${found.refused}.`;
      return;
    }
    shown = drawn(page, found);
    turn(page, shown);
    const reached = shown.reached / (found.cells[0] * found.cells[1]);
    root.dataset.state = "shown";
    words.textContent = `Red: singular or nearly; teal: far from it. Seen in ${found.positions.toLocaleString("en")} random `
      + `positions within the limits, ${(100 * reached).toFixed(0)} % of the box; what is blank was not seen.`;
  };
  return { take, again };
}

function drawn(page, found) {
  const { machine } = page;
  const { three } = machine;
  const [across, up] = found.cells;
  const bytes = Uint8Array.from(atob(found.values), (c) => c.charCodeAt(0));
  const values = new Float32Array(bytes.buffer);
  const canvas = document.createElement("canvas");
  Object.assign(canvas, { width: across, height: up });
  const context = canvas.getContext("2d");
  let reached = 0;
  values.forEach((value, n) => {
    if (Number.isNaN(value)) return;
    reached += 1;
    context.fillStyle = traceColour(value);
    context.fillRect(n % across, up - 1 - Math.floor(n / across), 1, 1);
  });
  const map = new three.CanvasTexture(canvas);
  map.magFilter = three.NearestFilter;
  const size = found.high.map((end, n) => end - found.low[n]);
  const mesh = new three.Mesh(new three.PlaneGeometry(size[0], size[1]), new three.MeshBasicMaterial({
    map, transparent: true, opacity: OPACITY, side: three.DoubleSide, depthWrite: false,
  }));
  const group = machine.inWorkpiece();
  group.add(mesh);
  return { kind: found.kind, group, map, middle: found.low.map((v, n) => v + size[n] / 2), reached, plane: mesh };
}

/** Put a section where it belongs: one that is turned about z stands where the tool is. */
function turn(page, { kind, plane, middle }) {
  const { three } = page.machine;
  let ways = WAYS[kind];
  if (!ways) {
    const T = page.chain.fk(page.axes);
    const [x, y] = T === null ? [1, 0] : originOf(T);
    const far = Math.hypot(x, y);
    ways = [far > 1e-9 ? [x / far, y / far, 0] : [1, 0, 0], [0, 0, 1]];
  }
  const [across, up] = ways.map((way) => new three.Vector3(...way));
  const place = new three.Matrix4().makeBasis(across, up, across.clone().cross(up));
  place.decompose(plane.position, plane.quaternion, plane.scale);
  plane.position.copy(across).multiplyScalar(middle[0]).addScaledVector(up, middle[1]);
}
