// Inverse kinematics in the page: one descent while a gizmo is dragged, a search for every branch when it rests.
import { singular } from "cb/linear";
import { descend, poseError } from "cb/descent";
import { closedBranches } from "cb/closed";

const STARTS = 80; // finds every branch of a six-axis arm
const MOST_STARTS = 240;
const SAME = 1e-5; // m and rad: solutions nearer than that are one
const LOST = 1e-6; // singular value below which a solution is one of a continuous family
const TASK_ROWS = { pose: 6, direction: 5, position: 3 };

/** Return a function of pseudo-random numbers in 0 … 1, the same at every call of a page. */
function random(seed) {
  let a = seed;
  return () => {
    a = (a + 0x6d2b79f5) | 0;
    let t = Math.imul(a ^ (a >>> 15), 1 | a);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

export class Solver {
  constructor(chain, limits) {
    this.chain = chain;
    this.limits = limits;
    this.periodic = new Set(chain.data.periodic);
    this.box = {
      lower: limits.lower.map((v, n) => v * chain.factors[n]),
      upper: limits.upper.map((v, n) => v * chain.factors[n]),
      allows: (from, to) => this.shortened(from, to),
    };
  }

  si(axes) {
    return axes.map((v, n) => v * this.chain.factors[n]);
  }

  shown(x) {
    return x.map((v, n) => v / this.chain.factors[n]);
  }

  /** Return the axes that a solver may move. */
  get free() {
    return this.chain.axes.map((_, n) => n).filter((n) => !this.chain.axes[n].held);
  }

  /** Return the end of a step, drawn back until sums and drives are inside their limits. */
  shortened(from, to) {
    if (!this.limits.sums.length && !this.limits.drives.length) return to;
    let end = to;
    for (let n = 0; n < 12; n += 1) {
      if (this.limits.inside(this.shown(end))) return end;
      end = from.map((v, k) => (v + end[k]) / 2);
    }
    return from;
  }

  /**
   * Return the solutions of a pose: every branch inside the limits, the nearest to the start first.
   * @param {number[]} T tool in the workpiece frame
   * @param {number[]} start axis values; those of held axes stay
   * @param {{task: string, free: number[]}} how what is solved for, if not the task of the kinematic
   * @returns {{status: string, axes: number[], branches: number[][], family: boolean}}
   */
  solve(T, start, how = {}) {
    const task = how.task || this.chain.data.task;
    const free = how.free || this.free;
    if (this.chain.data.loops && !how.task) {
      const closed = closedBranches(this, T, start);
      if (closed) return this.sorted(closed, start);
    }
    return this.search(poseError(this.chain, T, task), start, free, TASK_ROWS[task]);
  }

  /** Return the solutions of an error function; see `solve`. */
  search(error, start, free, rows) {
    if (free.length > rows) return this.nearest(error, start, free);
    const found = [];
    const next = this.starts(start, free);
    let best = null;
    for (let n = 0, idle = 0; n < MOST_STARTS && (idle < STARTS || !found.length); n += 1, idle += 1) {
      const end = descend(error, next(n), free);
      if (best === null || end.size < best.size) best = end;
      const x = end.met ? this.settled(error, end.x, start, free) : null;
      if (x !== null && !found.some((other) => this.same(x, other))) {
        found.push(x);
        idle = -1;
      }
    }
    if (found.length) return this.sorted(found, start);
    const end = descend(error, this.si(start), free, this.box);
    const status = best.stalled ? "stalled" : "unreachable";
    return { status, axes: this.beside(end.x, start), branches: [], family: false };
  }

  /** Return the solution of a redundant kinematic near the start; the others are a continuous family. */
  nearest(error, start, free) {
    const next = this.starts(start, free);
    let best = null;
    for (let n = 0; n < STARTS; n += 1) {
      const end = descend(error, next(n), free, this.box);
      if (end.met) return { status: "ok", axes: this.beside(end.x, start), branches: [this.beside(end.x, start)], family: true };
      if (best === null || end.size < best.size) best = end;
    }
    const open = descend(error, this.si(start), free);
    const status = open.met ? "limits" : best.stalled ? "stalled" : "unreachable";
    return { status, axes: this.beside(open.met ? open.x : best.x, start), branches: [], family: true };
  }

  /** Return the solutions (SI) by whether they are inside the limits, the nearest to the start first. */
  sorted(found, start) {
    const x0 = this.si(start);
    const distance = (x) => Math.hypot(...x.map((v, n) => v - x0[n]));
    const shown = found.sort((a, b) => distance(a) - distance(b)).map((x) => this.beside(x, start));
    const branches = shown.filter((axes) => this.limits.inside(axes)).map((axes) => this.limits.clamped(axes));
    if (branches.length) return { status: "ok", axes: branches[0], branches, family: false };
    if (shown.length) return { status: "limits", axes: shown[0], branches: [], family: false };
    return { status: "unreachable", axes: start.slice(), branches: [], family: false };
  }

  /** Return SI values in mm and degrees; axes that did not move have exactly the value of the start. */
  beside(x, start) {
    const x0 = this.si(start);
    return this.shown(x).map((v, n) => (x[n] === x0[n] ? start[n] : v));
  }

  /** Return the function n → where the n-th descent starts: the start itself, then anywhere within limits and a turn. */
  starts(start, free) {
    const x0 = this.si(start);
    const draw = random(20240229);
    return (n) => {
      if (n === 0) return x0;
      const x = x0.slice();
      free.forEach((k) => {
        const axis = this.chain.axes[k];
        const wide = axis.kind === "rotary" ? Math.PI : 10;
        const low = Math.max(this.box.lower[k], -wide);
        const high = Math.min(this.box.upper[k], wide);
        const [from, to] = low < high ? [low, high] : [this.box.lower[k], this.box.upper[k]];
        x[k] = from + (to - from) * draw();
      });
      return x;
    };
  }

  /** Return a solution with whole turns as near to the start as the limits permit; of a family the one at the start. */
  settled(error, x, start, free) {
    const x0 = this.si(start);
    const turned = this.wound(x, x0, free);
    const { J } = error(turned);
    const { values, right } = singular(J.map((row) => free.map((k) => row[k])));
    if (values[values.length - 1] > LOST) return turned;
    // Where one axis moves nothing by itself, or two undo each other, the first keeps its place.
    const most = Math.max(...right.map(Math.abs));
    const loose = free[right.findIndex((v) => Math.abs(v) > 0.7 * most)];
    const kept = turned.slice();
    kept[loose] = Math.min(Math.max(x0[loose], this.box.lower[loose]), this.box.upper[loose]);
    const end = descend(error, kept, free.filter((k) => k !== loose));
    return end.met ? this.wound(end.x, x0, free) : turned;
  }

  wound(x, x0, free) {
    const turn = 2 * Math.PI;
    const slack = 2e-8; // what still counts as inside
    return x.map((v, k) => {
      if (!this.periodic.has(k) || !free.includes(k)) return v;
      let near = v + turn * Math.round((x0[k] - v) / turn);
      if (near > this.box.upper[k] + slack) near -= turn * Math.ceil((near - this.box.upper[k] - slack) / turn);
      if (near < this.box.lower[k] - slack) near += turn * Math.ceil((this.box.lower[k] - slack - near) / turn);
      return near;
    });
  }

  same(a, b) {
    const turn = 2 * Math.PI;
    return a.every((v, n) => {
      const off = v - b[n];
      return Math.abs(this.periodic.has(n) ? off - turn * Math.round(off / turn) : off) < SAME;
    });
  }

  /** Return where a branch goes when its pose moves a little, or null where it ends. */
  follow(T, axes, how = {}) {
    const free = how.free || this.free;
    const end = descend(poseError(this.chain, T, how.task || this.chain.data.task), this.si(axes), free, null, 12);
    const reached = this.beside(end.x, axes);
    return end.met && this.limits.inside(reached) ? reached : null;
  }

  /** Tell whether a pose is met from axis values on where no limit stops them. */
  reaches(T, axes, how = {}) {
    const free = how.free || this.free;
    return descend(poseError(this.chain, T, how.task || this.chain.data.task), this.si(axes), free).met;
  }

  /** Return the place inside the limits nearest to a pose, from axis values on: what a dragged machine can do. */
  approach(T, axes, how = {}) {
    const free = how.free || this.free;
    const error = poseError(this.chain, T, how.task || this.chain.data.task);
    const end = descend(error, this.si(axes), free, this.box, 30);
    return { axes: this.beside(end.x, axes), met: end.met };
  }
}
