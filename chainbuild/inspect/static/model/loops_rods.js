// Closed axis maps of three rods that carry a platform: tripods (12, 209) and the delta robot (37).
//
// Each rod ends on a ball of radius r about its upper joint, seen with the platform's pins shrunk to one point p, the
// common point of the three balls below (above) the plane of their centres: the twin of Python's `maps/struts.py` and
// `maps/arms.py`.

import { azimuth, degrees, metres, millimetres, radians, remainder, withSign, withinOne } from "cb/units";

const ARMS = 3; // three balls have a common point
const FLAT = 1e-12; // squared sine of the triangle of the centres: below it they lie on a line
const SAME = 1e-9; // of r: centres nearer than that are one, the direction between them is rounding
const TOUCHES = 1e-15; // of r²: rounding where the rods lie in the plane of their joints
const REACHES = 1e-14; // of r²: rounding of a rod that reaches with nothing to spare

/** A carriage on a column, driven along Z. */
class Column {
  constructor(data) {
    this.data = data;
    this.direction = azimuth(data.angle_deg);
    this.si = metres;
    this.shown = millimetres;
    this.rotary = false;
  }

  // Centre of the ball [m] at an axis value [m], and the turn of the rod's frame.
  centre(value) {
    const { radius, sign } = this.data;
    const [x, y] = this.direction;
    return [[radius * x, radius * y, sign * value], 0];
  }

  // Axis values [m] for a platform point: one, the carriage above (side 1) or below it.
  values(p, rod, side) {
    const { radius, sign } = this.data;
    const [x, y] = this.direction;
    const square = rod * rod - (p[0] - radius * x) ** 2 - (p[1] - radius * y) ** 2;
    if (!(square >= -REACHES * rod * rod)) return [];
    return [sign * (p[2] + side * Math.sqrt(Math.max(square, 0)))];
  }
}

/** A lever that turns about the tangent; positive turns lower its tip. */
class Lever {
  constructor(data) {
    this.data = data;
    this.direction = azimuth(data.angle_deg);
    this.si = radians;
    this.shown = degrees;
    this.rotary = true;
  }

  // Centre of the ball [m] at an axis value [rad], and the turn of the rod's frame.
  centre(value) {
    const { radius, length, zero_deg: zero } = this.data;
    const [x, y] = this.direction;
    const angle = value - radians(zero);
    const out = radius + length * Math.cos(angle);
    return [[out * x, out * y, -length * Math.sin(angle)], angle];
  }

  // Axis values [rad] for a platform point: two, the elbow outside first.
  values(p, rod) {
    const { radius, length, zero_deg: zero } = this.data;
    const [x, y] = this.direction;
    const out = p[0] * x + p[1] * y - radius;
    const across = p[1] * x - p[0] * y;
    const distance = Math.hypot(out, p[2]);
    // In the plane of the lever: |u - length·(cos θ, -sin θ)|² = r² - across².
    const square = rod * rod - across * across;
    if (!(square >= -REACHES * rod * rod) || distance === 0 || length === 0) return [];
    const cosine = (distance * distance + length * length - Math.max(square, 0)) / (2 * distance * length);
    if (Math.abs(cosine) > 1 + REACHES) return [];
    const middle = Math.atan2(-p[2], out);
    const half = Math.acos(withinOne(cosine));
    const both = [middle - half, middle + half].sort((one, other) => Math.cos(other) - Math.cos(one));
    return both.map((angle) => remainder(angle, 2 * Math.PI) + radians(zero));
  }
}

const ARM_CLASSES = { Column, Lever };

/** Axis values of three arms (and of rotary axes beside them) → platform, rotary axes, each arm with its rod. */
export class ThreeRodsMap {
  constructor(data) {
    this.data = data;
    this.arms = data.arms.map((arm) => new ARM_CLASSES[arm.class](arm));
    this.count = ARMS + data.beside + 3 * ARMS;
  }

  /** Return the joint values of axis values; not a number where the rods do not meet. */
  q(axes) {
    const values = axes.map((value, n) => (n < ARMS ? this.arms[n].si(value) : radians(value)));
    const centres = this.arms.map((arm, n) => arm.centre(values[n]));
    const p = common(centres.map(([centre]) => centre), this.data.rod, this.data.hanging);
    if (p === null) return Array(this.count).fill(NaN);
    const rods = this.arms.map((arm, n) => [values[n], ...this.rodAngles(arm, p, ...centres[n])]);
    return [...p, ...values.slice(ARMS), ...rods.flat()];
  }

  // Swing and lean of a rod, which hangs (or stands) at 0 and swings about the tangent, then leans about its own x.
  rodAngles(arm, p, centre, turned) {
    const { rod, hanging } = this.data;
    const [x, y] = arm.direction;
    const [dx, dy, up] = p.map((value, n) => value - centre[n]);
    const out = dx * x + dy * y;
    const across = dy * x - dx * y;
    const s = -hanging;
    const lean = Math.asin(withinOne((-s * across) / rod));
    return [remainder(Math.atan2(s * out, s * up) - turned, 2 * Math.PI), lean];
  }

  /** Return the values of each arm that reach the platform's point, and the rotary ones as they are. */
  closing(q) {
    const { rod, hanging, beside } = this.data;
    const p = q.slice(0, ARMS);
    const own = this.arms.map((arm) => arm.values(p, rod, hanging).map(arm.shown));
    return [...own, ...q.slice(ARMS, ARMS + beside).map((turn) => [degrees(turn)])];
  }
}

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const square = (v) => v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
const between = (from, to) => to.map((value, n) => value - from[n]);

/** Return the common point [m] of balls about three centres, the lower one where hanging is 1, or null. */
function common([a, b, c], rod, hanging) {
  const u = between(a, b);
  const v = between(a, c);
  const n = cross(u, v);
  const nn = square(n);
  const uu = square(u);
  const vv = square(v);
  const least = (SAME * rod) ** 2;
  // The centres lie on a line, about which the platform could turn, or on one another.
  if (!(nn > FLAT * uu * vv) || uu <= least || vv <= least || square(between(b, c)) <= least) return null;
  // The circumcentre from a: (|u|²·(v × n) + |v|²·(n × u)) / (2·|n|²).
  const vn = cross(v, n);
  const nu = cross(n, u);
  const o = vn.map((value, k) => (uu * value + vv * nu[k]) / (2 * nn));
  let height = rod * rod - square(o);
  if (Math.abs(height) < TOUCHES * rod * rod) height = 0;
  if (height < 0) return null;
  // The lower point (the upper one of a platform that stands): n is taken upwards.
  const step = withSign(Math.sqrt(height / nn), n[2]) * hanging;
  return a.map((value, k) => value + o[k] - step * n[k]);
}
