// What the drives stand at, mm and degrees in channel order, from the axis values a controller shows: the twins of
// Python's `chain/drives.py`, `axis_offsets.py` and `maps/drives.py`.

import { axisMap } from "cb/maps";
import { cosSinDeg, degrees, radians, remainder, withinOne } from "cb/units";

// Indices in X, Y, Z, C, A and in X, Y, Z, B, A, CV: the outer rotary axis, the inner one, the virtual one.
const OUTER = 3;
const INNER = 4;
const VIRTUAL = 5;
const REACH_SLACK = 1e-12; // of a sine: a direction on the edge of the reach counts as reached

const dot = (row, values) => row.reduce((sum, factor, n) => sum + factor * values[n], 0);

// The axis values with the two rotary ones replaced.
const withRotary = (axes, [outer, inner]) => axes.map((value, n) => ({ [OUTER]: outer, [INNER]: inner })[n] ?? value);

// drives = A·axes + b: gears, couplings and offsets between axes of one kind.
const affine = ({ A, b }) => (axes) => A.map((row, n) => dot(row, axes) + b[n]);

// Drives of two chains that are composed: each follows its own axes.
function sideBySide({ first, second, count }) {
  const [one, other] = [driveMap(first), driveMap(second)];
  return (axes) => [...one.drives(axes.slice(0, count)), ...other.drives(axes.slice(count))];
}

// Drives of axes that stand at their values plus an offset.
function shifted({ inner, shift }) {
  const standing = driveMap(inner);
  return (axes) => standing.drives(axes.map((value, n) => value + shift[n]));
}

// 59, 60: the drives stand at the machine angles of the programmed spatial angles, plus zero offsets.
function spatial({ spatial: data, zero_deg: zero }) {
  const map = axisMap(data);
  return (axes) => {
    const q = map.q(axes);
    return withRotary(axes, [degrees(q[OUTER]) + zero[0], degrees(q[INNER]) + zero[1]]);
  };
}

// 70: the drives B, A stand where the virtual axis CV turns the programmed tool vector to; CV has no drive.
function virtualTurn({ turned: data }) {
  const map = axisMap(data);
  const { straight } = map;
  return (axes) => {
    const behind = [...map.q(axes), straight.q(axes)[VIRTUAL]].map((value, n) => value - straight.b[n]);
    return withRotary(axes, [OUTER, INNER].map((n) => dot(straight.back[n], behind) / straight.si_factors[n]));
  };
}

// 76: the machine axes behind the programmed C and A, in their places: C's drive is machine axis A, A's is B.
function bevel({ tilt_deg: tilt, mounting_deg: mounting, arrangement }) {
  const machine = { b_outside: bOutside, a_outside: aOutside, upright }[arrangement];
  const [cosine, sine] = cosSinDeg(tilt);
  return (axes) => {
    const c = radians(axes[OUTER]) - radians(mounting);
    const a = radians(axes[INNER]);
    return withRotary(axes, machine({ c, a, cosine, sine, tilt: radians(tilt) }).map(degrees));
  };
}

// The direction Rz(c)·Rx(a)·e_z.
const lean = ({ c, a }) => [Math.sin(c) * Math.sin(a), -Math.cos(c) * Math.sin(a), Math.cos(a)];

// Ry(B)·Rot(u, A)·e_z = d with u = (sin δ, 0, cos δ).
function bOutside(head) {
  const { cosine, sine } = head;
  const [x, y, z] = lean(head);
  const angle = arcSine(-y / sine);
  const level = sine * cosine * (1 - Math.cos(angle));
  const up = cosine ** 2 + sine ** 2 * Math.cos(angle);
  return [angle, Math.atan2(x, z) - Math.atan2(level, up)];
}

// Rot(u, A)·Ry(B)·e_z = d.
function aOutside(head) {
  const { cosine, sine, tilt } = head;
  const [x, y, z] = lean(head);
  const b = tilt - Math.acos(withinOne(sine * x + cosine * z));
  // Across u: Ry(b)·e_z leans from u towards (-cos δ, 0, sin δ), which Rot(u, A) turns towards -e_y.
  return [Math.atan2(-y, sine * z - cosine * x), b];
}

// Rz(B)·Rot(u, A)·e_z = d.
function upright({ c, a, cosine, sine }) {
  const angle = 2 * arcSine(Math.sin(remainder(a, 2 * Math.PI) / 2) / sine);
  return [angle, c - Math.atan2(cosine * Math.sin(angle / 2), Math.cos(angle / 2))];
}

// An arc sine, not a number beyond 1; rounding is no excess.
const arcSine = (sine) => (Math.abs(sine) <= 1 + REACH_SLACK ? Math.asin(withinOne(sine)) : NaN);

const KINDS = {
  AffineDrives: affine,
  DrivesSideBySide: sideBySide,
  ShiftedDrives: shifted,
  SpatialDrives: spatial,
  VirtualTurnDrives: virtualTurn,
  BevelDrives: bevel,
};

export const DRIVES = Object.keys(KINDS);

/** Return {drives(axes)} of the data of drives: drive values, not a number where there are none; null: the axes. */
export function driveMap(data) {
  if (data === null) return { drives: (axes) => [...axes] };
  const make = KINDS[data.class];
  if (make === undefined) throw new Error(`no drives are called ${data.class}`);
  return { drives: make(data) };
}
