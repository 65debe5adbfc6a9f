// Axis map of the workpiece table on three rods (19): X and Y carry the tool, Z1 to Z3 the table by its rods.
//
// Joint values: X, Y; the shifts and the turns about X, Y and Z of the table; each carriage with its rod; the links of
// a guide. Rods in radial planes only swing; on the axis they lean, too, and a pair of links keeps the table from
// turning: the twin of Python's `maps/table.py`.

import { TableRods } from "cb/table_rods";
import { metres, millimetres, withinOne } from "cb/units";

const SLIDES = 2; // X and Y come before the carriages
const LINK_RISE = 0.5; // sine by which the links of the guide lean at home
const LEVEL = 1e-9; // upward part of the tool vector below which the table stands upright

/** X, Y, Z1, Z2, Z3 → joint values. */
export class TableMap {
  constructor(data) {
    this.rods = new TableRods(data.rods);
    this.radial = data.rods.offset[0] !== 0 || data.rods.offset[1] !== 0;
    this.count = this.radial ? 14 : 17;
    this.carriage = this.radial ? 8 : 6; // place of the first carriage among the joint values
  }

  /** Return the joint values of axis values; not a number where the way from home does not lead. */
  q(axes) {
    const heights = axes.slice(SLIDES).map(metres);
    const [state, gone] = this.rods.reached(heights);
    if (gone !== 1) return Array(this.count).fill(NaN);
    const q = [...axes.slice(0, SLIDES).map(metres), ...this.tableJoints(...state)];
    const s = -this.rods.hanging;
    this.rods.rods(state, heights).forEach(([[dx, dy, up]], n) => {
      const [ex, ey] = this.rods.directions[n];
      q.push(heights[n], Math.atan2(s * (dx * ex + dy * ey), s * up));
      if (!this.radial) q.push(Math.asin(withinOne((-s * (dy * ex - dx * ey)) / this.rods.length)));
    });
    if (this.radial) return q;
    const angle = this.link(state);
    return [...q, angle, -angle];
  }

  // The shifts that the guide leaves the table [m], and its turns about X, Y and Z [rad].
  tableJoints(h, x, y) {
    const w = Math.sqrt(1 - x * x - y * y);
    const turns = [
      Math.atan2(2 * w * x, 1 - 2 * (x * x + y * y)),
      Math.asin(withinOne(2 * w * y)),
      Math.atan2(-2 * x * y, 1 - 2 * y * y),
    ];
    return this.radial ? [h, ...this.rods.centre(x, y), ...turns] : [h, ...turns];
  }

  // Angle of the link on the post: with e half the tilt, seen from across the link, the plane between post and mirror
  // image meets it at e - asin(LINK_RISE·cos e).
  link([, x, y]) {
    const [ex, ey] = this.rods.directions[0];
    const half = Math.atan2(x * ey - y * ex, Math.sqrt(1 - x * x - y * y)); // opposite to the first column
    return half - Math.asin(LINK_RISE * Math.cos(half));
  }

  /**
   * Return the joint values between the tips that bring the upright tool to a pose; others are 0.
   *
   * target: tool in the workpiece frame; tool, workpiece: the frames on their links, flat row-major [m].
   */
  posed(target, tool, workpiece) {
    const column = (n) => [target[n], target[4 + n], target[8 + n]];
    const turned = (v) => [0, 4, 8].map((n) => workpiece[n] * v[0] + workpiece[n + 1] * v[1] + workpiece[n + 2] * v[2]);
    const [w, x, y] = tiltUpright(turned(column(2)));
    const point = turned(column(3)).map((value, n) => value + workpiece[4 * n + 3]);
    const tip = [
      [1 - 2 * y * y, 2 * x * y, 2 * w * y],
      [2 * x * y, 1 - 2 * x * x, -2 * w * x],
      [-2 * w * y, 2 * w * x, 1 - 2 * (x * x + y * y)],
    ].map((row, n) => row[0] * point[0] + row[1] * point[1] + row[2] * point[2] - tool[4 * n + 3]);
    const centre = this.rods.centre(x, y);
    const between = [centre[0] + tip[0], centre[1] + tip[1], ...this.tableJoints(-tip[2], x, y)];
    return [...between, ...Array(this.count - between.length).fill(0)];
  }

  // The table's joints [m] at joint values between the tips, or null for a table beyond upright.
  joints(q) {
    const [a, b, c] = q.slice(this.carriage - 3, this.carriage);
    const [ca, sa, cb, sb, cc, sc] = [a, b, c].flatMap((angle) => [Math.cos(angle), Math.sin(angle)]);
    if (!(ca * cb >= LEVEL)) return null;
    const [cx, cy] = this.radial ? [q[SLIDES + 1], q[SLIDES + 2]] : [0, 0];
    // The first two columns of Rx(a)·Ry(b)·Rz(c).
    const rows = [
      [cb * cc, -cb * sc],
      [sa * sb * cc + ca * sc, ca * cc - sa * sb * sc],
      [sa * sc - ca * sb * cc, ca * sb * sc + sa * cc],
    ];
    const centre = [cx, cy, q[SLIDES]];
    return this.rods.directions.map(([ex, ey]) =>
      rows.map((row, n) => centre[n] + this.rods.table * (row[0] * ex + row[1] * ey)),
    );
  }

  /** Return X and Y as they are, and the heights of each carriage that reach the table, the usual side first. */
  closing(q) {
    const values = [[millimetres(q[0])], [millimetres(q[1])]];
    const joints = this.joints(q);
    if (joints === null) return [...values, [], [], []];
    const { columns, length, hanging, directions, mayLieFlat } = this.rods;
    const heights = joints.map(([x, y, z], n) => {
      const [ex, ey] = directions[n];
      const square = length ** 2 - (x - columns * ex) ** 2 - (y - columns * ey) ** 2;
      if (!(square >= 0)) return [];
      const rise = hanging * Math.sqrt(square);
      return (mayLieFlat ? [rise, -rise] : [rise]).map((side) => millimetres(z + side));
    });
    return [...values, ...heights];
  }
}

// The quaternion (w, x, y, 0) of the tilt that brings a direction of the table to Z.
function tiltUpright([x, y, z]) {
  const size = Math.hypot(1 + z, x, y);
  return size > LEVEL ? [(1 + z) / size, y / size, -x / size] : [0, 1, 0];
}
