// Names of the frames, written beside them: never over a frame that is named, nor over one another.

const GAP = 10; // pixels between a frame and its name
const SIDES = [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [-1, 1], [1, -1], [-1, -1]];
const OUT = 400; // what a name outside the picture counts, in square pixels covered

/** Write the names of the frames over the picture, in the elements of `root`. */
export function startLabels(page, root, tools) {
  const { machine } = page;
  const written = (text, shows, pointsIn) => {
    const tag = document.createElement("span");
    tag.textContent = text;
    // A thin line leads from the name to what it names, which a body may hide.
    const line = document.createElement("i");
    root.append(line, tag);
    return { tag, line, shows, pointsIn, size: null };
  };
  let labels = [];
  const write = () => {
    root.replaceChildren();
    labels = page.data.labels.map(({ text, frame }) => written(text, "frames", (pane) => armsOf(page, frame, pane)));
    page.data.dimensions.forEach((one) => {
      const label = written(one.label, "dimensions", (pane) => middleOf(page, one, pane));
      label.tag.dataset.parameter = one.symbol;
      label.tag.title = one.name;
      labels.push(label);
    });
  };
  page.onModel(write);
  write();
  // The buttons over the picture take more lines where it is narrow.
  let [width, height] = [0, 0];
  const covered = (now) => {
    if (now !== width) [width, height] = [now, tools.offsetTop + tools.offsetHeight];
    return height;
  };
  const draw = () => {
    const size = machine.viewer.renderer.getSize(new machine.three.Vector2());
    const pane = { width: size.x, height: size.y };
    const seen = labels.map((label) => ({ ...label, label, points: machine.shows[label.shows] ? label.pointsIn(pane) : null }));
    const all = seen.flatMap((one) => one.points || []);
    const taken = [{ x: 0, y: 0, width: pane.width, height: covered(pane.width) }];
    seen.forEach(({ tag, line, label, points }) => {
      tag.hidden = line.hidden = points === null;
      if (points === null) return;
      // Measured once: to ask for sizes at every frame would lay out the panel anew.
      label.size = label.size || { width: tag.offsetWidth, height: tag.offsetHeight };
      const box = placed(points[0], label.size, all, taken, pane);
      taken.push(box);
      tag.style.transform = `translate(${box.x.toFixed(1)}px, ${box.y.toFixed(1)}px)`;
      lead(line, points[0], box);
    });
  };
  machine.onFrame(draw);
}

/** Return points along the line of a length in pixels, its middle first; null outside the picture. */
function middleOf(page, { link, start, end }, pane) {
  const shares = [0.5, 0, 0.25, 0.75, 1];
  const ends = shares.map((share) => start.map((v, n) => v + share * (end[n] - v)));
  return seenIn(page, page.machine.links[link].matrixWorld, ends, pane);
}

/** Draw a line from a point to the nearest place of a box. */
function lead(line, from, box) {
  const x = Math.min(Math.max(from.x, box.x), box.x + box.width) - from.x;
  const y = Math.min(Math.max(from.y, box.y), box.y + box.height) - from.y;
  line.style.width = `${Math.hypot(x, y).toFixed(1)}px`;
  line.style.transform = `translate(${from.x.toFixed(1)}px, ${from.y.toFixed(1)}px) rotate(${Math.atan2(y, x)}rad)`;
}

/** Return points along the arms of a frame in pixels, its origin first; null outside the picture. */
function armsOf(page, name, pane) {
  const { machine } = page;
  const { link, T } = page.chain.data.frames[name];
  const arm = page.data.arm;
  const ends = [[0, 0, 0]];
  [0, 1, 2].forEach((axis) => [0.25, 0.5, 0.75, 1].forEach((share) => {
    ends.push([0, 1, 2].map((n) => (n === axis ? arm * share : 0)));
  }));
  const place = machine.links[link].matrixWorld.clone().multiply(machine.matrix(T));
  return seenIn(page, place, ends, pane);
}

/** Return points of a frame in pixels; null where the first is outside the picture. */
function seenIn({ machine }, place, ends, pane) {
  const points = ends.map((end) => {
    const seen = new machine.three.Vector3(...end).applyMatrix4(place).project(machine.viewer.camera);
    return { x: ((seen.x + 1) / 2) * pane.width, y: ((1 - seen.y) / 2) * pane.height, z: seen.z };
  });
  const [{ x, y, z }] = points;
  return z < 1 && x >= 0 && y >= 0 && x <= pane.width && y <= pane.height ? points : null;
}

/** Return the box beside a point that covers least of the frames, the other names and the picture's edge. */
function placed(at, size, arms, taken, pane) {
  let best = null;
  [1, 2.5, 5].forEach((far) => SIDES.forEach(([right, down]) => {
    const away = GAP * far;
    const x = at.x + (right > 0 ? away : right < 0 ? -away - size.width : -size.width / 2);
    const y = at.y + (down > 0 ? away : down < 0 ? -away - size.height : -size.height / 2);
    const box = { x, y, ...size };
    const covered = arms.filter((p) => p.x > x - 3 && p.x < x + size.width + 3 && p.y > y - 2 && p.y < y + size.height + 2);
    const cost = 60 * covered.length + taken.reduce((sum, other) => sum + shared(box, other), 0)
      + (inside(box, pane) ? 0 : OUT) + far;
    if (best === null || cost < best.cost) best = { cost, box };
  }));
  return best.box;
}

function shared(a, b) {
  const wide = Math.min(a.x + a.width, b.x + b.width) - Math.max(a.x, b.x);
  const tall = Math.min(a.y + a.height, b.y + b.height) - Math.max(a.y, b.y);
  return wide > 0 && tall > 0 ? wide * tall + OUT : 0;
}

const inside = (box, { width, height }) => {
  return box.x >= 0 && box.y >= 0 && box.x + box.width <= width && box.y + box.height <= height;
};
