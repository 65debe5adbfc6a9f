// The machine in the viewer: commands of the scene, joints that move, placements read back, camera.

const FIELD_OF_VIEW = 40; // degrees
const REST = 300; // milliseconds without a change after which the picture is drawn once more, finely
const FINE = 2; // times as many pixels either way: edges are smooth although nothing antialiases

export class Machine {
  /** @param page data of the page; @param pane element that holds the picture */
  constructor(data, chain, pane) {
    const three = MeshCat.THREE;
    Object.assign(this, { data, chain, pane, three, moved: false });
    this.shows = { frames: true, bodies: true };
    this.beside = []; // roots of further machines
    this.watchers = [];
    // Without antialiasing twice as many frames a second; the background is the page's own.
    const renderer = new three.WebGLRenderer({ antialias: false, alpha: true });
    pane.appendChild(renderer.domElement);
    this.viewer = new MeshCat.Viewer(pane, false, renderer);
    // The viewer takes the window's height for its own; the pane may be lower.
    const resize = this.viewer.set_3d_pane_size.bind(this.viewer);
    this.viewer.set_3d_pane_size = () => resize(pane.offsetWidth, pane.offsetHeight);
    this.play(data.commands);
    this.viewer.scene.background = null;
    this.drawOnDemand();
    this.root = this.node("robot");
    this.links = chain.data.links.map((name) => this.node(data.paths[name]));
    this.viewer.controls.addEventListener("start", () => { this.moved = true; });
    new ResizeObserver(() => (this.moved ? this.viewer.set_3d_pane_size() : this.fit())).observe(pane);
  }

  /** Carry out commands of the scene. */
  play(commands) {
    commands.forEach((text) => {
      this.viewer.handle_command_bytearray(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)));
    });
  }

  /** Draw the bodies and frames of the page's data in the links; what hangs in them besides stays. */
  rebuild(chain) {
    this.chain = chain;
    this.links.forEach((_, n) => {
      const path = this.data.paths[chain.data.links[n]].split("/");
      partNames(this, n).forEach((name) => this.viewer.delete_path(["meshcat", ...path, name]));
    });
    this.play(this.data.commands);
    this.viewer.scene.background = null;
  }

  /** Return the three.js object at a path of the scene. */
  node(path) {
    return this.viewer.scene_tree.find(["meshcat", ...path.split("/")]).object;
  }

  /** Draw when something changed, and once more at rest: a page that rests leaves the computer alone. */
  drawOnDemand() {
    const { viewer } = this;
    let asked = false;
    let resting = null;
    const draw = (times) => {
      const ratio = times * window.devicePixelRatio;
      if (viewer.renderer.getPixelRatio() !== ratio) viewer.renderer.setPixelRatio(ratio);
      viewer.render();
      this.watchers.forEach((watch) => watch());
    };
    viewer.set_dirty = () => {
      if (asked) return;
      asked = true;
      window.clearTimeout(resting);
      window.requestAnimationFrame(() => {
        asked = false;
        draw(1);
        window.clearTimeout(resting);
        resting = window.setTimeout(() => { if (!asked) draw(FINE); }, REST);
      });
    };
    viewer.set_dirty();
  }

  /** Return the bodies that are drawn on the n-th link. */
  bodies(n) {
    return linkBodies(this, n);
  }

  /** Call a function after every frame that is drawn. */
  onFrame(watch) {
    this.watchers.push(watch);
  }

  /** Return how many frames were drawn so far. */
  get frames() {
    return this.viewer.renderer.info.render.frame;
  }

  /** Move the joints to axis values; without a pose they stay. */
  move(axes) {
    const q = this.chain.q(axes);
    if (!q.every(Number.isFinite)) return;
    this.place(this.links, this.chain, q);
  }

  /** Move the nodes of a chain's links to joint values. */
  place(links, chain, q) {
    chain.moved(q).forEach((T, n) => {
      const node = links[chain.data.joints[n].child];
      this.matrix(T).decompose(node.position, node.quaternion, node.scale);
    });
    this.viewer.set_dirty();
  }

  /** Return a thin bar of a material, seen through bodies; `lay` puts it between two points. */
  bar(material, order) {
    const bar = new this.three.Mesh(new this.three.CylinderGeometry(1, 1, 1, 6), material);
    bar.renderOrder = order;
    return bar;
  }

  /** Lay a bar from one point to another, at least so long. */
  lay(bar, start, end, thick, least = 0) {
    const { Vector3 } = this.three;
    const [from, to] = [start, end].map((point) => new Vector3(...point));
    const way = to.clone().sub(from);
    bar.position.copy(from).addScaledVector(way, 0.5);
    bar.scale.set(thick, Math.max(way.length(), least), thick);
    if (way.length() > 0) bar.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), way.normalize());
  }

  /** Return a group that hangs in the workpiece frame and moves with it: z up, metres. */
  inWorkpiece() {
    const { link, T } = this.chain.data.frames.workpiece;
    const group = new this.three.Group();
    this.matrix(T).decompose(group.position, group.quaternion, group.scale);
    this.links[link].add(group);
    return group;
  }

  matrix(T) {
    return new this.three.Matrix4().set(...T);
  }

  /** Return the placement in the base, row by row, at which a link or a named frame is drawn. */
  drawn(name) {
    const frame = this.chain.data.frames[name];
    const link = frame ? frame.link : this.chain.data.links.indexOf(name);
    const node = this.links[link];
    const T = this.inBase(node);
    if (frame) T.multiply(this.matrix(frame.T));
    return T.transpose().toArray();
  }

  /** Return the placement of a three.js object in the base, as the scene has it. */
  inBase(node) {
    node.updateWorldMatrix(true, false);
    this.root.updateWorldMatrix(true, false);
    return this.root.matrixWorld.clone().invert().multiply(node.matrixWorld);
  }

  /** Look at the machine, and at those beside it, from the front right, near enough that every corner of the box around
   *  them is inside the picture. */
  fit() {
    const { viewer, three } = this;
    viewer.set_3d_pane_size();
    const { camera } = viewer;
    // Machine coordinates have z up, three.js has y up.
    const raised = ([x, y, z]) => new three.Vector3(x, z, -y);
    const box = new three.Box3().setFromPoints(this.data.bounds.map(raised));
    this.beside.filter((root) => root.visible).forEach((root) => box.expandByObject(root));
    const target = box.getCenter(new three.Vector3());
    const { min: low, max: high } = box;
    const back = raised(this.data.view).normalize();
    const right = new three.Vector3(0, 1, 0).cross(back).normalize();
    const up = back.clone().cross(right);
    camera.fov = FIELD_OF_VIEW;
    const tall = Math.tan((camera.fov * Math.PI) / 360);
    const wide = tall * camera.aspect;
    let distance = 0;
    for (let n = 0; n < 8; n += 1) {
      const corner = new three.Vector3(...["x", "y", "z"].map((k, bit) => ((n >> bit) & 1 ? high : low)[k])).sub(target);
      const across = Math.max(Math.abs(corner.dot(right)) / wide, Math.abs(corner.dot(up)) / tall);
      distance = Math.max(distance, across + corner.dot(back));
    }
    distance *= 1.04;
    camera.near = distance / 200;
    camera.far = distance * 50;
    camera.position.copy(target).addScaledVector(back, distance);
    camera.updateProjectionMatrix();
    viewer.controls.target.copy(target);
    viewer.controls.update();
    viewer.set_dirty();
  }
}

const childrenOf = (machine, path) => machine.viewer.scene_tree.find(["meshcat", ...path.split("/")]).children;

/** Return the names of what is drawn on the n-th link. */
const partNames = ({ data, viewer }, n) => {
  const path = data.paths[data.chain.links[n]];
  const links = new Set(Object.values(data.paths));
  // The node's own object counts as a child of that name.
  const names = Object.keys(childrenOf({ viewer }, path)).filter((name) => name !== "<object>");
  return names.filter((name) => !links.has(`${path}/${name}`));
};

const partsOf = (machine, n, frames) => {
  const children = childrenOf(machine, machine.data.paths[machine.data.chain.links[n]]);
  const names = partNames(machine, n).filter((name) => name.startsWith("frame ") === frames);
  return names.map((name) => children[name].object);
};

/** Return the bodies that are drawn on the n-th link. */
export const linkBodies = (machine, n) => partsOf(machine, n, false);

/** Return the frames that are drawn on the n-th link. */
export const linkFrames = (machine, n) => partsOf(machine, n, true);
