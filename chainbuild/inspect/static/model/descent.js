// Damped descents of inverse kinematics: one from a start, free or inside the limits.
import { dampedStep, inverse, logRotation, multiply, originOf, rotateBack, column, tilt } from "cb/linear";

const STEPS = 60; // at most, of one descent: from anywhere twenty do
const MET = 1e-22; // squared error (m² and rad²) at which another step gains nothing
const TOLERANCE = 1e-9; // m and rad: what a solution may miss its pose by
const STALL = 12; // steps without a tenth of gain that end a descent

/**
 * Return the error of axis values in metres and radians against a pose, and its derivative.
 * @param {string} task "pose", "direction" (position and tool vector) or "position"
 * @returns {function(number[]): ?{e: number[], J: number[][]}} null where the kinematic has no pose
 */
export function poseError(chain, target, task) {
  const along = chain.data.toolColumn;
  const rows = [0, 1, 2, 3, 4, 5].filter((row) => {
    return row < 3 || task === "pose" || (task === "direction" && row !== 3 + along);
  });
  return (x) => {
    const found = chain.poseAndJacobian(x.map((v, n) => v / chain.factors[n]));
    if (found === null || !found.J.every((row) => row.every(Number.isFinite))) return null;
    const back = multiply(inverse(found.T), target);
    const turn = task === "pose" ? logRotation(back) : tilt(rotateBack(found.T, column(target, along)), along);
    const e = [...originOf(back), ...turn];
    return { e: rows.map((row) => e[row]), J: rows.map((row) => found.J[row]) };
  };
}

/** Return the error of what is displayed against what is wanted there, by differences; angles modulo whole turns. */
export function shownError(values, wanted, factors) {
  const step = 1e-6;
  const miss = (x) => {
    const got = values(x);
    return got && wanted.map((v, n) => {
      const off = v - got[n];
      if (n < 3) return off / 1000;
      return ((off - 360 * Math.round(off / 360)) * Math.PI) / 180;
    });
  };
  return (x) => {
    const e = miss(x);
    if (e === null) return null;
    const columns = x.map((_, n) => {
      const ends = [1, -1].map((side) => miss(x.map((v, m) => (m === n ? v + side * step : v))));
      if (ends.includes(null)) return e.map(() => 0);
      return e.map((__, k) => (ends[1][k] - ends[0][k]) / (2 * step));
    });
    return { e, J: e.map((_, k) => columns.map((values) => values[k])) };
  };
}

const square = (e) => e.reduce((sum, v) => sum + v * v, 0);

/**
 * Descend from a start.
 * @param {function} error x → {e, J}, null where there is none
 * @param {number[]} start SI axis values
 * @param {number[]} free indices of the axes that move
 * @param {?{lower: number[], upper: number[], allows: function}} box limits to stay inside (SI), null: none
 * @returns {{x: number[], met: boolean, size: number, stalled: boolean}} size: norm of the error
 */
export function descend(error, start, free, box = null, steps = STEPS) {
  let x = box ? clamp(start, box, free) : start.slice();
  let at = error(x);
  if (at === null) return { x, met: false, size: Infinity, stalled: true };
  let size = square(at.e);
  let damping = 1e-3;
  let [mark, since] = [size, 0];
  let resting = false;
  for (let n = 0; n < steps && size > MET && !resting && since < STALL; n += 1) {
    const moving = box ? free.filter((k) => !pressed(x, at, k, box)) : free;
    const J = at.J.map((row) => moving.map((k) => row[k]));
    const change = moving.length ? dampedStep(J, at.e, damping * Math.min(size, 1) + 1e-13) : [];
    const next = x.slice();
    moving.forEach((k, m) => { next[k] += Math.max(-1, Math.min(1, change[m])); });
    const bounded = box ? box.allows(x, clamp(next, box, free)) : next;
    const ahead = error(bounded);
    const gained = ahead === null ? Infinity : square(ahead.e);
    if (gained < size) {
      resting = size - gained < 1e-14 * size && size > 1e-16;
      [x, at, size] = [bounded, ahead, gained];
      damping = Math.max(damping / 8, 1e-10);
    } else {
      if (size < 1e-18) break; // rounding
      damping *= 10;
      resting = damping > 1e6;
    }
    since += 1;
    if (size < 0.9 * mark) [mark, since] = [size, 0];
  }
  return { x, met: size < TOLERANCE * TOLERANCE, size: Math.sqrt(size), stalled: !resting && since < STALL };
}

function clamp(x, box, free) {
  const moved = x.slice();
  free.forEach((k) => { moved[k] = Math.min(Math.max(x[k], box.lower[k]), box.upper[k]); });
  return moved;
}

/** Tell whether an axis stands on its limit and the error would press it beyond. */
function pressed(x, { e, J }, k, box) {
  const push = J.reduce((sum, row, n) => sum + row[k] * e[n], 0);
  return (x[k] <= box.lower[k] && push < 0) || (x[k] >= box.upper[k] && push > 0);
}
