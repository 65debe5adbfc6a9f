// Arrows and rings at the tool: dragging them moves the machine.
import { inverse, multiply, originOf } from "cb/linear";
import { TransformControls } from "transform-controls";

const SIZE = 0.75; // over the size that three.js gives them
const IDLE = 350; // milliseconds at rest after which every solution is looked for

/** Put the gizmo at the tool; the buttons in `root` say how it moves. */
export function startGizmo(page, root) {
  const { machine } = page;
  const { viewer, three } = machine;
  const controls = new TransformControls(viewer.camera, viewer.renderer.domElement);
  const handle = new three.Object3D();
  machine.root.add(handle);
  // The scene is turned so that z is up; the controls reckon without that.
  const upright = new three.Group();
  upright.rotation.x = Math.PI / 2;
  upright.add(controls);
  viewer.scene.add(upright);
  controls.attach(handle);
  controls.setSize(SIZE);
  // Their "world" is that of three.js: axes of the workpiece are had by turning the handle instead.
  controls.setSpace("local");
  const state = { page, controls, handle, inTool: true, grip: null, timer: null };
  controls.addEventListener("change", () => viewer.set_dirty());
  controls.addEventListener("dragging-changed", ({ value }) => {
    viewer.controls.enabled = !value;
    if (value) grip(state);
    else release(state);
  });
  controls.addEventListener("objectChange", () => follow(state));
  page.onChange(() => { if (!controls.dragging) align(state); });
  startButtons(state, root);
}

/** Put the handle where the tool is, with the axes that are asked for. */
function align({ page, handle, inTool }) {
  const { chain, machine } = page;
  const q = chain.q(page.axes);
  if (!q.every(Number.isFinite)) return;
  const placed = chain.placementsOf(q);
  const tool = chain.frame("tool", placed);
  const T = inTool ? tool : movedTo(chain.frame("workpiece", placed), originOf(tool));
  machine.matrix(T).decompose(handle.position, handle.quaternion, handle.scale);
}

/** Keep where the drag begins: a table that moves under the tool must not carry the handle with it. */
function grip(state) {
  const { chain, axes } = state.page;
  const q = chain.q(axes);
  if (!q.every(Number.isFinite)) return; // there is no tool to move
  const placed = chain.placementsOf(q);
  const workpiece = inverse(chain.frame("workpiece", placed));
  const tool = chain.frame("tool", placed);
  state.grip = { workpiece, back: inverse(movedTo(placeOf(state.handle), originOf(tool))), tool };
}

/** Let the machine follow the handle; when it rests, look for every solution. */
function follow(state) {
  const { page, grip: from } = state;
  if (from === null) return;
  const now = placeOf(state.handle);
  // The handle's turn since the drag began, about the tool's tip, and its place.
  const turned = multiply(multiply(now, from.back), from.tool);
  const T = multiply(from.workpiece, movedTo(turned, originOf(now)));
  state.wanted = T;
  page.drag(T);
  window.clearTimeout(state.timer);
  state.timer = window.setTimeout(() => page.setPose(T), IDLE);
}

function release(state) {
  window.clearTimeout(state.timer);
  if (state.wanted) state.page.setPose(state.wanted);
  state.wanted = null;
  state.grip = null;
  align(state);
}

function placeOf(handle) {
  handle.updateMatrix();
  return handle.matrix.clone().transpose().toArray();
}

function movedTo(T, [x, y, z]) {
  return [T[0], T[1], T[2], x, T[4], T[5], T[6], y, T[8], T[9], T[10], z, 0, 0, 0, 1];
}

function startButtons(state, root) {
  const { page, controls } = state;
  const { task, toolColumn } = page.chain.data;
  const modes = [...root.querySelectorAll("[data-gizmo]")];
  const space = root.querySelector("#space");
  const show = (mode) => {
    controls.visible = mode !== "off";
    controls.enabled = mode !== "off";
    if (mode !== "off") controls.setMode(mode);
    // Turns about the tool's own axis move nothing where only its direction counts.
    const bound = mode === "rotate" && task === "direction" && state.inTool;
    controls.showX = !(bound && toolColumn === 0);
    controls.showZ = !(bound && toolColumn === 2);
    modes.forEach((button) => button.setAttribute("aria-pressed", String(button.dataset.gizmo === mode)));
    state.mode = mode;
    align(state);
    page.machine.viewer.set_dirty();
  };
  modes.forEach((button) => {
    button.hidden = button.dataset.gizmo === "rotate" && task === "position";
    button.addEventListener("click", () => show(button.dataset.gizmo));
  });
  space.addEventListener("change", () => {
    state.inTool = space.value === "tool";
    show(state.mode);
  });
  show("translate");
}
