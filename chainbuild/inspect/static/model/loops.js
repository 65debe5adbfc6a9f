// Closed axis maps: of the lambda kinematic (21) here, of three rods and of the table on three rods beside it.
//
// The joint C stands at (s_c, y_c), the joint B at (s_b, y_b); the rods l_c from C and l_b from B meet in D, on one
// side of the line from C to B: the twin of Python's `maps/scissors.py`, whose formulas it has.

import { degrees, metres, millimetres, radians, withinOne } from "cb/units";

export { ThreeRodsMap } from "cb/loops_rods";
export { TableMap } from "cb/loops_table";

const IN_LINE = 1e-14; // of a cosine: rounding where the rods are in line
const Z = 2; // index in X1, X2, Z, C
const C = 3; // likewise

/** X1, X2, Z, C → slide of C, θ, Z, turn of the gripper; slide of B, φ. */
export class LambdaMap {
  constructor(data) {
    this.data = data;
    this.count = 6;
  }

  // Direction θ of the rod from C and φ of that from B, or null where the rods do not meet.
  angles(axes) {
    const { along, across, rods, side, slides } = this.data;
    const x = metres(axes[slides[1]]) + along[1] - (metres(axes[slides[0]]) + along[0]);
    const y = across[1] - across[0];
    const apart = Math.hypot(x, y);
    if (apart === 0) return null;
    const [rod, other] = rods;
    const cosine = (rod * rod + apart * apart - other * other) / (2 * rod * apart);
    if (!(Math.abs(cosine) <= 1 + IN_LINE)) return null;
    const theta = Math.atan2(y, x) + side * Math.acos(withinOne(cosine));
    return [theta, Math.atan2(rod * Math.sin(theta) - y, rod * Math.cos(theta) - x)];
  }

  /** Return the joint values of axis values; not a number where the rods do not meet. */
  q(axes) {
    const found = this.angles(axes);
    if (found === null) return Array(this.count).fill(NaN);
    const [theta, phi] = found;
    const [c, b] = this.data.slides;
    return [metres(axes[c]), theta, metres(axes[Z]), radians(axes[C]) - this.counted(theta), metres(axes[b]), phi];
  }

  // What C counts from: the arm, or X.
  counted(theta) {
    return this.data.by_arm ? 0 : theta + this.data.bend;
  }

  /** Return the values of each axis that close the loops at joint values: B lies on the circle about D, either side. */
  closing(q) {
    const { along, across, rods, slides } = this.data;
    const [rod, other] = rods;
    const theta = q[1];
    const beside = across[0] + rod * Math.sin(theta) - across[1];
    let square = other * other - beside * beside;
    if (Math.abs(square) < IN_LINE * other * other) square = 0;
    const middle = q[0] + along[0] + rod * Math.cos(theta) - along[1];
    const half = Math.sqrt(Math.max(square, 0));
    const values = [[], [], [millimetres(q[2])], [degrees(q[3] + this.counted(theta))]];
    values[slides[0]] = [millimetres(q[0])];
    values[slides[1]] = square < 0 ? [] : [millimetres(middle - half), millimetres(middle + half)];
    return values;
  }
}
