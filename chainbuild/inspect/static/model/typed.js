// From a pose as the controller displays it to axis values; see ik/displayed.py.
import { fromAngles } from "cb/angles";
import { displayed, displayColumns } from "cb/display";
import { cross, multiply, turnAbout } from "cb/linear";
import { shownError } from "cb/descent";

const UNITS = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

/**
 * Return the solutions for displayed values.
 * @param {Solver} solver
 * @param {Object<string, number>} shown every column of the display
 * @param {number[]} start axis values; held axes take their displayed value
 */
export function solveDisplayed(solver, shown, start) {
  const { chain } = solver;
  const { display, factors, task } = chain.data;
  const begin = start.map((v, n) => (chain.axes[n].held ? shown[chain.names[n]] : v));
  const place = ["x_mm", "y_mm", "z_mm"].map((name) => shown[name] / 1000);
  const values = chain.data.displayColumns.map((name) => shown[name]);
  if (display.kind === "axes") return byAxes(solver, place, values, begin);
  if (display.kind === "angles" && values.length === 3 && task === "pose" && !chain.data.followsC) {
    return solver.solve(fromAngles(factors, values, place), begin);
  }
  if (display.kind === "position") return solver.solve(at(place), begin, { task: "position" });
  if (display.kind === "vector" || display.kind === "direction") {
    const tool = display.kind === "vector" ? unit(values) : vectorOf(display, values);
    return solver.solve(pointing(tool, chain.data.toolColumn, place), begin, { task: "direction" });
  }
  return byColumns(solver, shown, begin);
}

/** Return the axes that are solved for while those that are displayed have the values given. */
function byAxes(solver, place, values, begin) {
  const { display } = solver.chain.data;
  const axes = begin.slice();
  display.axes.forEach((n, k) => { axes[n] = values[k]; });
  const others = solver.free.filter((n) => !display.axes.includes(n));
  const free = display.solved.length ? display.solved : others;
  return solver.solve(at(place), axes, { task: "position", free });
}

/** Return the axes at which every displayed value is met: for angles of which some follow from the position. */
function byColumns(solver, shown, begin) {
  const { chain } = solver;
  const columns = displayColumns(chain).filter((name) => !chain.names.includes(name));
  const values = (x) => {
    const got = displayed(chain, solver.shown(x));
    return got && columns.map((name) => got[name]);
  };
  const error = shownError(values, columns.map((name) => shown[name]), chain.factors);
  return solver.search(error, begin, solver.free, columns.length);
}

const at = ([x, y, z]) => [1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z, 0, 0, 0, 1];

function unit(v) {
  const size = Math.hypot(...v);
  return v.map((one) => one / size);
}

function vectorOf({ letters, along }, angles) {
  const turns = [...letters].map((letter, n) => turnAbout(UNITS["ABC".indexOf(letter)], (angles[n] * Math.PI) / 180));
  const T = multiply(turns[0], turns[1]);
  const n = "xyz".indexOf(along);
  return [T[n], T[4 + n], T[8 + n]];
}

/** Return a pose whose tool axis, x or z, is a direction. */
function pointing(tool, column, [x, y, z]) {
  const least = [0, 1, 2].reduce((best, n) => (Math.abs(tool[n]) < Math.abs(tool[best]) ? n : best), 0);
  const aside = unit(cross(UNITS[least], tool));
  const third = cross(tool, aside);
  const [a, b, c] = column === 0 ? [tool, aside, third] : [aside, third, tool];
  return [a[0], b[0], c[0], x, a[1], b[1], c[1], y, a[2], b[2], c[2], z, 0, 0, 0, 1];
}
