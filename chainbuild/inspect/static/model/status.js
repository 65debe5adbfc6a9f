// Status and turn of a six-axis articulated arm (KIN_TYP 45); see ik/branches/status_turn.py.
import { cross, dot, inverse, multiply, originOf, rotate } from "cb/linear";

const LENGTH = 1e-12; // m: a point nearer than that is on the line
const BELOW_ZERO = 1e-9; // degrees: so little below zero counts as zero
const MEETS = 1e-9; // m: axes of a wrist nearer than that meet
const HAND = 4; // place of axis 5 among the axes

/** Return [status, turn] of axis values, or null where the controller defines none. */
export function statusTurn(chain, axes) {
  const { data } = chain;
  if (!data.hasStatus) return null;
  const joints = data.between.map((n) => data.joints[n]);
  const placed = chain.placements(axes);
  if (joints.length < 6 || !meetInPoint(joints.slice(3, 6), placed)) return null;
  // Axes 2, 3 and 5 as seen from the column, which axis 1 turns.
  const back = inverse(placed[joints[1].parent]);
  const [shoulder, elbow, wrist] = [1, 2, 4].map((n) => originOf(multiply(back, placed[joints[n].child])));
  const upper = [elbow[2] - shoulder[2], elbow[0] - shoulder[0]];
  const across = upper[0] * (wrist[0] - shoulder[0]) - upper[1] * (wrist[2] - shoulder[2]);
  const inFront = across / Math.max(Math.hypot(...upper), LENGTH);
  const status = Number(-wrist[0] > LENGTH) + 2 * Number(inFront > LENGTH) + 4 * Number(-axes[HAND] > BELOW_ZERO);
  return [status, axes.reduce((turn, value, n) => turn + (value < -BELOW_ZERO ? 2 ** n : 0), 0)];
}

/** Tell whether the lines of three joints meet in the origin of the middle one. */
function meetInPoint(joints, placed) {
  const centre = originOf(placed[joints[1].child]);
  return joints.every((joint) => {
    const T = placed[joint.child];
    const way = originOf(T).map((v, n) => centre[n] - v);
    const off = cross(rotate(T, joint.direction), way);
    return Math.sqrt(dot(off, off)) < MEETS;
  });
}
