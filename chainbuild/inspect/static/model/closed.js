// Every branch of a closed chain: the open way from workpiece to tool first, then each strut alone; see
// ik/branches/closed.py.
import { Chain } from "cb/chain";
import { Limits } from "cb/limits";

const FAR = 100000; // mm and degrees: joints that no axis drives alone have no limits of their own
const MET = 1e-8; // m and rad

/** Return the solutions (SI) of a chain with loops for a pose, or null where its map does not tell how they close. */
export function closedBranches(solver, T, start) {
  const { chain } = solver;
  const { map, data } = chain;
  if (!map.closing || data.axes.some((axis) => axis.held)) return null;
  const found = [];
  jointValues(solver, T, start).forEach((q) => {
    product(map.closing(q)).forEach((axes) => {
      const reached = chain.fk(axes);
      const x = solver.wound(solver.si(axes), solver.si(start), solver.free);
      if (reached && meets(reached, T, data) && !found.some((other) => solver.same(x, other))) found.push(x);
    });
  });
  return found;
}

function jointValues(solver, T, start) {
  const { chain } = solver;
  const { data, map } = chain;
  if (map.posed) return [map.posed(T, data.frames.tool.T, data.frames.workpiece.T)];
  const open = opened(chain);
  const at = new Chain(open);
  const inner = new solver.constructor(at, new Limits(at));
  const q0 = chain.q(start);
  const from = data.between.map((n, k) => (Number.isFinite(q0[n]) ? q0[n] / at.factors[k] : 0));
  const result = inner.solve(T, from);
  return (result.branches.length ? result.branches : [result.axes]).map((axes) => {
    const q = new Array(data.joints.length).fill(0);
    inner.si(axes).forEach((v, k) => { q[data.between[k]] = v; });
    return q;
  });
}

/** Return the data of the open chain: the joints between the tips, each with an axis of its own. */
function opened(chain) {
  const { data } = chain;
  const joints = data.between.map((n) => data.joints[n]);
  const axes = joints.map((joint) => {
    const own = data.axes.find((axis) => axis.name === joint.name);
    const kind = joint.kind === "revolute" ? "rotary" : "linear";
    return own || { name: joint.name, kind, lower: -FAR, upper: FAR, held: false };
  });
  const unity = joints.map((_, n) => joints.map((__, m) => (n === m ? 1 : 0)));
  const factors = axes.map((axis) => (axis.kind === "linear" ? 1e-3 : Math.PI / 180));
  const map = { class: "AffineMap", A: unity, b: joints.map(() => 0), si_factors: factors, back: unity };
  const periodic = axes.map((_, n) => n).filter((n) => axes[n].kind === "rotary");
  return { ...data, joints, axes, map, periodic, loops: false, drives: null, driveLimits: [], sums: [] };
}

function product(lists) {
  return lists.reduce((rows, values) => rows.flatMap((row) => values.map((value) => [...row, value])), [[]]);
}

function meets(reached, T, { task, toolColumn }) {
  const near = (n) => Math.abs(reached[n] - T[n]) < MET;
  if (![3, 7, 11].every(near)) return false;
  if (task === "position") return true;
  const columns = task === "pose" ? [0, 1, 2] : [toolColumn];
  return columns.every((c) => [0, 4, 8].every((row) => near(row + c)));
}
