// Inside the limits or not: axes, sums of axes, drives; see kinematics/limits.py.
import { driveMap } from "cb/drives";

const SLACK = 1e-6; // mm and degrees: so little beyond counts as inside

const low = (value) => (value === null ? -Infinity : value);
const high = (value) => (value === null ? Infinity : value);
const within = (value, limit) => low(limit.lower) - SLACK <= value && value <= high(limit.upper) + SLACK;

export class Limits {
  constructor(chain) {
    this.axes = chain.axes;
    this.sums = chain.data.sums;
    this.drives = chain.data.driveLimits;
    this.map = driveMap(chain.data.drives);
    this.lower = chain.axes.map((axis) => low(axis.lower));
    this.upper = chain.axes.map((axis) => high(axis.upper));
  }

  /** Return what the drives stand at. */
  driveValues(axes) {
    return this.map.drives(axes);
  }

  /** Return the indices of the axes outside their own limits. */
  outside(axes) {
    return axes.map((_, n) => n).filter((n) => !within(axes[n], this.axes[n]));
  }

  /** Return the names of the axes, sums and drives that are outside their limits. */
  violated(axes) {
    const drives = this.drives.length ? this.driveValues(axes) : [];
    const broken = this.drives.filter((one) => !within(drives[one.axis], one)).map((one) => one.name);
    // An axis whose own limit is that of its drive is named by the drive.
    const own = this.outside(axes).filter((n) => !broken.includes(`${this.axes[n].name}_drive`));
    const sums = this.sums.filter((sum) => !within(sumOf(sum, axes), sum)).map((sum) => sum.name);
    return [...own.map((n) => this.axes[n].name), ...sums, ...broken];
  }

  inside(axes) {
    return this.violated(axes).length === 0;
  }

  /** Return the values with every axis beyond its own limit moved onto it. */
  clamped(axes) {
    return axes.map((v, n) => Math.min(Math.max(v, this.lower[n]), this.upper[n]));
  }
}

/** Return the value of a sum of axes. */
export const sumOf = (sum, axes) => sum.coefficients.reduce((total, c, n) => total + c * axes[n], sum.offset);
