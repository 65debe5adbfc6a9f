// Forward kinematics and Jacobian of the chain in the page's data; see kinematics/mechanism.py.
import { cross, identity, inverse, multiply, originOf, rotate, rotateBack, shiftBy, turnAbout } from "cb/linear";
import { axisMap } from "cb/maps";

const STEP = 1e-6; // m and rad: where differences of a map lose as much by rounding as by its bend

export class Chain {
  constructor(data) {
    this.data = data;
    this.axes = data.axes;
    this.names = data.axes.map((axis) => axis.name);
    this.factors = data.axes.map((axis) => (axis.kind === "linear" ? 1e-3 : Math.PI / 180));
    this.map = axisMap(data.map);
    this.affine = data.map.class === "AffineMap" ? data.map.A : null;
  }

  /** Return the joint values, SI; not a number where there are none. */
  q(axes) {
    return this.map.q(axes);
  }

  /** Return by link its placement in the base. */
  placements(axes) {
    return this.placementsOf(this.q(axes));
  }

  placementsOf(q) {
    const placed = [identity()];
    const moved = this.moved(q);
    this.data.joints.forEach((joint, n) => { placed[joint.child] = multiply(placed[joint.parent], moved[n]); });
    return placed;
  }

  /** Return by joint the placement of the link that it moves in the link that carries it. */
  moved(q) {
    return this.data.joints.map((joint, n) => multiply(joint.T, motionOf(joint, q[n])));
  }

  /** Return the placement of a named frame in the base. */
  frame(name, placed) {
    const { link, T } = this.data.frames[name];
    return multiply(placed[link], T);
  }

  /** Return the tool in the workpiece frame, or null where the kinematic has no pose. */
  fk(axes) {
    const q = this.q(axes);
    return q.every(Number.isFinite) ? this.poseOf(this.placementsOf(q)) : null;
  }

  poseOf(placed) {
    return multiply(inverse(this.frame("workpiece", placed)), this.frame("tool", placed));
  }

  /**
   * Return the pose and the Jacobian at axis values: 6 rows by axes, linear rows first, in the tool frame, by metres
   * and radians of the axes; null where there is none.
   */
  poseAndJacobian(axes) {
    const q = this.q(axes);
    if (!q.every(Number.isFinite)) return null;
    const placed = this.placementsOf(q);
    const screws = this.screws(placed);
    const slopes = this.affine || this.slopes(axes, q);
    const J = [0, 1, 2, 3, 4, 5].map((row) => axes.map((_, n) => {
      let sum = 0;
      for (let k = 0; k < screws.length; k += 1) sum += screws[k][row] * slopes[k][n];
      return sum;
    }));
    return { T: this.poseOf(placed), J };
  }

  jacobian(axes) {
    const found = this.poseAndJacobian(axes);
    return found && found.J;
  }

  /** Return by joint how it moves the tool against the workpiece, in the tool frame: three metres, three radians. */
  screws(placed) {
    const tool = this.frame("tool", placed);
    const screws = this.data.joints.map(() => [0, 0, 0, 0, 0, 0]);
    [["tool", 1], ["workpiece", -1]].forEach(([name, sign]) => {
      let { link } = this.data.frames[name];
      for (let n = this.data.joints.length - 1; n >= 0; n -= 1) {
        const joint = this.data.joints[n];
        if (joint.child === link) {
          link = joint.parent;
          screwOf(joint, placed[joint.child], tool).forEach((v, k) => { screws[n][k] += sign * v; });
        }
      }
    });
    return screws;
  }

  /** Return the derivative of the joint values by the axes, SI by SI, from differences; one-sided where a map ends. */
  slopes(axes, q) {
    const columns = axes.map((value, n) => {
      const step = STEP / this.factors[n];
      const [above, below] = [1, -1].map((side) => {
        return this.q(axes.map((v, m) => (m === n ? value + side * step : v)));
      });
      const [up, down] = [above, below].map((values) => values.every(Number.isFinite));
      const width = STEP * (Number(up) + Number(down)) || 1;
      return q.map((v, k) => ((up ? above[k] : v) - (down ? below[k] : v)) / width);
    });
    return q.map((_, k) => columns.map((values) => values[k]));
  }
}

function motionOf(joint, value) {
  if (joint.kind === "prismatic") return shiftBy(joint.direction.map((v) => v * value));
  return turnAbout(joint.direction, value);
}

function screwOf(joint, placed, tool) {
  const along = rotate(placed, joint.direction);
  if (joint.kind === "prismatic") return [...rotateBack(tool, along), 0, 0, 0];
  const way = originOf(tool).map((v, n) => v - originOf(placed)[n]);
  return [...rotateBack(tool, cross(along, way)), ...rotateBack(tool, along)];
}
