// The trace of the tool on the workpiece, coloured by how close it is to a singularity, and what was measured there.

import { traceRGB } from "cb/colours";

const MEASURED = 0x8e24aa; // as no body and no colour of the ramp

const SLICE = 2000; // forward kinematics at a time: a few hundredths of a second without an answer to the mouse
const CORNERS = 20000; // of the whole trace, as far as rows are fewer
const MOST_BETWEEN = 16; // corners a block: the tool moves on curves between rows of axis values

const unitColour = (value) => traceRGB(value).map((part) => part / 255);

/** Axis values a share of the way from a row to the next; null where one of them has none. */
export function between(rows, n, share) {
  const [from, to] = [rows[n], rows[Math.min(n + 1, rows.length - 1)]];
  if (share === 0 || from === null || to === null) return from;
  return from.map((value, k) => value + share * (to[k] - value));
}

/** Draw the trace; resolves to its group when it is there. */
export async function drawTrace(page) {
  const { rows, singular, kind } = page.data.playback;
  const blocks = Math.max(rows.length - 1, 1);
  // Poses are joined by lines.
  const parts = kind === "poses" ? 1 : Math.min(MOST_BETWEEN, Math.max(1, Math.floor(CORNERS / blocks)));
  const corners = { at: [], value: [], ofRows: [] };
  for (let n = 0; n < rows.length; n++) {
    corners.ofRows.push(corners.at.length);
    const moves = rows[n] !== null && n + 1 < rows.length && rows[n + 1] !== null;
    for (let k = 0; k < (moves ? parts : 1); k++) {
      addCorner(page.chain, corners, between(rows, n, k / parts), valueBetween(singular, n, k / parts));
    }
    if (n % Math.ceil(SLICE / parts) === 0) await pause();
  }
  const group = new page.three.Group();
  group.name = "trace";
  group.add(lines(page.three, corners), dots(page.three, corners));
  page.inWorkpiece.add(group);
  page.redraw();
  return group;
}

function pause() {
  return new Promise((resolve) => { setTimeout(resolve, 0); });
}

function valueBetween(values, n, share) {
  const [from, to] = [values[n], values[Math.min(n + 1, values.length - 1)]];
  return from === null || to === null ? from : from + share * (to - from);
}

function addCorner(chain, corners, axes, value) {
  const T = axes === null ? null : chain.fk(axes);
  corners.at.push(T === null ? null : [T[3], T[7], T[11]]);
  corners.value.push(value);
}

// Pieces of line, so that a row without pose leaves a gap.
function lines(three, corners) {
  const [places, colours] = [[], []];
  for (let n = 0; n + 1 < corners.at.length; n++) {
    if (corners.at[n] === null || corners.at[n + 1] === null) continue;
    for (const m of [n, n + 1]) {
      places.push(...corners.at[m]);
      colours.push(...unitColour(corners.value[m]));
    }
  }
  const drawn = new three.LineSegments(geometry(three, places, colours), new three.LineBasicMaterial({ vertexColors: true }));
  drawn.name = "trace lines";
  return drawn;
}

// A dot where a row of the file is.
function dots(three, corners) {
  const [places, colours] = [[], []];
  for (const n of corners.ofRows) {
    if (corners.at[n] === null) continue;
    places.push(...corners.at[n]);
    colours.push(...unitColour(corners.value[n]));
  }
  const material = new three.PointsMaterial({ size: 4, sizeAttenuation: false, vertexColors: true });
  const drawn = new three.Points(geometry(three, places, colours), material);
  drawn.name = "trace rows";
  return drawn;
}

function geometry(three, places, colours) {
  const made = new three.BufferGeometry();
  made.setAttribute("position", new three.Float32BufferAttribute(places, 3));
  if (colours) made.setAttribute("color", new three.Float32BufferAttribute(colours, 3));
  return made;
}

/** The power of ten that makes the largest error about a twentieth of what was measured; 1 at least. */
export function errorScale(measured, errors) {
  const most = errors.reduce((size, error) => (error === null ? size : Math.max(size, Math.hypot(...error))), 0);
  const points = measured.filter((point) => point !== null);
  const ends = [0, 1, 2].map((k) => points.reduce(([low, high], point) =>
    [Math.min(low, point[k]), Math.max(high, point[k])], [Infinity, -Infinity]));
  const size = 1000 * Math.hypot(...ends.map(([low, high]) => high - low));
  if (!(most > 0) || !(size > 0)) return 1;
  return 10 ** Math.min(4, Math.max(0, Math.floor(Math.log10(size / 20 / most))));
}

/** Draw the measured positions, and from each computed one a vector: its error times `scale`. Returns the group. */
export function drawErrors(page, scale) {
  const { measured, errors } = page.data.playback;
  const places = [];
  errors.forEach((error, n) => {
    if (error === null || measured[n] === null) return;
    const computed = measured[n].map((value, k) => value - error[k] / 1000);
    places.push(...computed, ...computed.map((value, k) => value + (scale * error[k]) / 1000));
  });
  const { three } = page;
  const group = new three.Group();
  group.name = "measured";
  const points = new three.Points(
    geometry(three, measured.filter((point) => point !== null).flat()),
    new three.PointsMaterial({ size: 6, sizeAttenuation: false, color: MEASURED }),
  );
  points.name = "measured points";
  const vectors = new three.LineSegments(geometry(three, places), new three.LineBasicMaterial({ color: MEASURED }));
  vectors.name = "error vectors";
  group.add(points, vectors);
  page.inWorkpiece.add(group);
  page.redraw();
  return group;
}
