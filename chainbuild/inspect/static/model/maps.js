// Axis maps: from the values a controller shows to the joint values, as in Python; one class for each of its classes.
import { Chain } from "cb/chain";
import { poseAngles } from "cb/angles";
import { LambdaMap, ThreeRodsMap, TableMap } from "cb/loops";
import { degrees, radians, withinOne } from "cb/units";

const TAU = 2 * Math.PI;

/** Return the angle moved by whole turns as near as possible to another one. */
const nearTurn = (angle, wanted) => angle + TAU * Math.round((wanted - angle) / TAU);

class AffineMap {
  constructor({ A, b, si_factors: si, back }) {
    Object.assign(this, { A, b, si_factors: si, back });
  }

  q(axes) {
    const x = axes.map((v, n) => v * this.si_factors[n]);
    return this.b.map((b, r) => {
      let sum = b;
      const row = this.A[r];
      for (let n = 0; n < x.length; n += 1) sum += row[n] * x[n];
      return sum;
    });
  }
}

class BlockMap {
  constructor({ blocks, shape }) {
    this.count = shape[0];
    this.blocks = blocks.map(({ axis_map: inner, axes, joints }) => ({ inner: axisMap(inner), axes, joints }));
  }

  q(axes) {
    const q = new Array(this.count);
    this.blocks.forEach(({ inner, axes: [first, end], joints }) => {
      inner.q(axes.slice(first, end)).forEach((v, n) => { q[joints[n]] = v; });
    });
    return q;
  }
}

class ShiftedMap {
  constructor({ inner, shift }) {
    this.inner = axisMap(inner);
    this.shift = shift;
  }

  q(axes) {
    return this.inner.q(axes.map((v, n) => v + this.shift[n]));
  }
}

/** KIN_TYP 59, 60: spatial angles are programmed, the joints stand at machine angles. */
class SpatialAnglesMap {
  constructor({ straight, cos_tilt: cosTilt, sin_tilt: sinTilt, side, zero }) {
    Object.assign(this, { straight: axisMap(straight), cosTilt, sinTilt, side, zero });
  }

  machineAngle(spatial) {
    if (Math.abs(spatial) > 2 * Math.asin(Math.abs(this.sinTilt)) + 1e-12) return NaN;
    const ratio = Math.sin(spatial / 2) / this.sinTilt;
    return this.side * 2 * Math.asin(withinOne(ratio));
  }

  q(axes) {
    const q = this.straight.q(axes);
    const machine = this.machineAngle(q[4]);
    if (Number.isNaN(machine)) return q.map(() => NaN);
    q[3] += -Math.atan2(this.cosTilt * Math.sin(machine / 2), Math.cos(machine / 2)) - this.zero[0];
    q[4] = machine - this.zero[1];
    return q;
  }
}

/** KIN_TYP 70: a virtual axis turns the programmed tool vector about Z. */
class VirtualTurnMap {
  constructor({ straight }) {
    this.straight = axisMap(straight);
  }

  q(axes) {
    const inner = this.straight.q(axes);
    const [b, a, cv] = inner.slice(3);
    const level = [Math.sin(b) * Math.cos(a), -Math.sin(a)];
    const x = Math.cos(cv) * level[0] - Math.sin(cv) * level[1];
    const y = Math.sin(cv) * level[0] + Math.cos(cv) * level[1];
    const z = Math.cos(b) * Math.cos(a);
    const side = Math.cos(a) < 0 ? -1 : 1;
    const leaned = Math.asin(withinOne(-y));
    const turned = [Math.atan2(side * x, side * z), side < 0 ? Math.PI - leaned : leaned];
    return [...inner.slice(0, 3), nearTurn(turned[0], b), nearTurn(turned[1], a)];
  }
}

/** KIN_TYP 25: the tip of the nozzle keeps its height. */
class NozzleLaw {
  constructor({ length }) {
    this.length = length;
  }

  extension(angle) {
    const cosine = Math.cos(angle);
    return Math.abs(cosine) < 1e-12 ? NaN : this.length * (1 / cosine - 1);
  }
}

/** KIN_TYP 98: the head keeps its distance between two tilts. */
class DistanceExtension {
  constructor({ law }) {
    Object.assign(this, law);
  }

  extension(angle) {
    const off = Math.abs((((degrees(angle) % 360) + 540) % 360) - 180);
    if (off > this.limit_deg + 1e-9) return NaN; // that much is rounding
    const tilt = Math.min(off, this.limit_deg);
    if (tilt <= this.start_deg) return 0;
    const held = Math.cos(radians(this.start_deg)) / Math.cos(radians(Math.min(tilt, this.end_deg)));
    return (this.length_mm * (held - 1)) / 1000;
  }
}

class TiltLengthMap {
  constructor({ straight, law, offset }) {
    this.straight = axisMap(straight);
    this.law = new { NozzleLaw, DistanceExtension }[law.class](law);
    this.offset = offset;
  }

  q(axes) {
    const q = this.straight.q(axes);
    const extension = this.law.extension(q[4] + this.offset);
    return Number.isNaN(extension) ? [...q, 0].map(() => NaN) : [...q, extension];
  }
}

/** Two transformations, one after the other: the coordinates of the first are the axes of the second. */
class TwoStepMap {
  constructor({ coordinates, second, taken, n_q: count }) {
    this.first = new Chain(coordinates.chain);
    this.byAxes = coordinates.orientation === "axes";
    this.second = axisMap(second);
    this.taken = taken;
    this.count = count;
  }

  q(axes) {
    const T = this.first.fk(axes);
    if (T === null) return new Array(this.count).fill(NaN);
    const tail = this.byAxes ? axes.slice(3) : poseAngles(this.first.data.factors, T);
    const position = [T[3], T[7], T[11]].map((v) => 1000 * v);
    return this.second.q([...position, ...tail].slice(0, this.taken));
  }
}

const CLASSES = {
  AffineMap, BlockMap, ShiftedMap, SpatialAnglesMap, VirtualTurnMap, TiltLengthMap, TwoStepMap, LambdaMap, ThreeRodsMap,
  TableMap,
};

export const MAPS = Object.keys(CLASSES);

/** Return the axis map of its data: an object with q(axes), all NaN where there are no joint values. */
export function axisMap(data) {
  return new CLASSES[data.class](data);
}
