// What the controller displays at axis values; see kinematics/displayed.py.
import { poseAngles } from "cb/angles";
import { column } from "cb/linear";
import { sumOf } from "cb/limits";

const LOCK = 1e-9; // part of a tool vector across the first turn below which that turn has no effect
const DEGREES = 180 / Math.PI;

/** Return an angle in (-180, 180]. */
export function wrapped(angle) {
  const turned = angle - 360 * Math.round(angle / 360);
  return turned <= -180 ? turned + 360 : turned;
}

/** Return what is displayed at axis values, by column, or null where there is no pose. */
export function displayed(chain, axes) {
  const T = chain.fk(axes);
  if (T === null) return null;
  const shown = { x_mm: 1000 * T[3], y_mm: 1000 * T[7], z_mm: 1000 * T[11] };
  const values = orientationShown(chain, axes, T);
  chain.data.displayColumns.forEach((name, n) => { shown[name] = values[n]; });
  chain.axes.forEach((axis, n) => { if (axis.held) shown[axis.name] = axes[n]; });
  return shown;
}

/** Return the columns of the display beside the position. */
export function displayColumns(chain) {
  const held = chain.axes.filter((axis) => axis.held).map((axis) => axis.name);
  return ["x_mm", "y_mm", "z_mm", ...chain.data.displayColumns, ...held];
}

function orientationShown(chain, axes, T) {
  const { display, absoluteC, factors, toolColumn } = chain.data;
  if (display.kind === "axes") return display.axes.map((n) => axes[n]);
  if (display.kind === "angles") {
    const angles = poseAngles(factors, T);
    if (absoluteC) angles[2] = sumOf(absoluteC, axes);
    return display.columns.map((name) => angles["abc".indexOf(name[0])]);
  }
  if (display.kind === "vector") return column(T, toolColumn);
  if (display.kind === "plane") {
    const [x, y] = column(T, "xyz".indexOf(display.along));
    return [wrapped(Math.atan2(y, x) * DEGREES - display.zero_deg)];
  }
  if (display.kind === "direction") return twoAngles(display, column(T, toolColumn));
  return display.kind === "pitch" ? pitchAndTurn(chain, axes, T) : [];
}

/** Return B and C of R = Rz(a)·Ry(B)·Rz(C - a), a being the turn of the first joint, which bears the arm. */
function pitchAndTurn(chain, axes, T) {
  const placed = chain.placements(axes);
  const across = column(placed[chain.data.joints[0].child], 1);
  const pitch = Math.atan2(across[1] * T[2] - across[0] * T[6], T[10]);
  const turn = Math.atan2(T[4] - T[1], T[0] + T[5]);
  return [pitch, turn].map((angle) => wrapped(angle * DEGREES));
}

/** Return two angles of a tool vector v = R1·R2·e; of the two pairs the one whose first angle is in (-90, 90]. */
function twoAngles(display, v) {
  const [i, j] = [...display.letters].map((letter) => "ABC".indexOf(letter));
  const k = 3 - i - j;
  const sense = (j - i + 3) % 3 === 1 ? 1 : -1;
  const across = Math.hypot(v[j], v[k]);
  const pairs = [1, -1].map((side) => ("xyz".indexOf(display.along) === i
    ? [Math.atan2(side * v[j], -sense * side * v[k]), Math.atan2(side * across, v[i])]
    : [Math.atan2(-sense * side * v[j], side * v[k]), Math.atan2(sense * v[i], side * across)]));
  const shown = pairs.map(([a, b]) => [across < LOCK ? 0 : a * DEGREES + 0, b * DEGREES + 0]);
  return shown.find(([a]) => a > -90 && a <= 90) || shown[0];
}
