// How close axis values are to a singular position, in numbers and in words; see analysis/singularity.
import { singular, transposed, rotate, multiply, inverse } from "cb/linear";

const EXACT = 1e-6; // below this nothing is "nearly"
const ALONG_AXIS = 0.985; // cosine of 10 degrees: such a direction is called by its axis
const SHARE = 0.4; // parts of a motion below this share are not mentioned
const RUNS = 0.2; // axes below this share of the fastest do not run away
const NEAR = 0.05; // the sentence is shown below this value

const ROWS = { pose: [0, 1, 2, 3, 4, 5], position: [0, 1, 2] };

/** Return the Jacobian in the controller's task, without units: lengths by the machine's length, held axes left out. */
function scaledJacobian(chain, J) {
  const { length, task, toolColumn } = chain.data;
  const rows = ROWS[task] || [0, 1, 2, 3, 4, 5].filter((row) => row !== 3 + toolColumn);
  const columns = chain.axes.map((_, n) => n).filter((n) => !chain.axes[n].held);
  const scaled = rows.map((row) => columns.map((n) => {
    return J[row][n] / (row < 3 ? length : 1) * (chain.axes[n].kind === "linear" ? length : 1);
  }));
  return { scaled, rows, columns };
}

/**
 * Return the measures at axis values, or null where there is no pose.
 * @returns {{values: number[], smallest: number, sentence: string}}
 */
export function measure(chain, axes) {
  const J = chain.jacobian(axes);
  if (J === null || !J.every((row) => row.every(Number.isFinite))) return null;
  const { scaled, rows, columns } = scaledJacobian(chain, J);
  const { values, right, left } = singular(scaled);
  // The vector of a vanishing value is exact on the longer side only.
  const lostShares = scaled.length <= columns.length ? singular(transposed(scaled)).right : left;
  const least = values[values.length - 1];
  const smallest = chain.data.loops ? Math.min(least, 1 / values[0]) : least;
  const lost = [0, 0, 0, 0, 0, 0];
  rows.forEach((row, n) => { lost[row] = lostShares[n]; });
  const names = runaway(right).map((n) => chain.names[columns[n]]);
  return { values, smallest, sentence: sentenceOf(chain, smallest, least, lost, names) };
}

function runaway(right) {
  const sizes = right.map(Math.abs);
  const most = Math.max(...sizes);
  return sizes.map((_, n) => n).sort((a, b) => sizes[b] - sizes[a]).filter((n) => sizes[n] > RUNS * most);
}

function sentenceOf(chain, smallest, least, lost, names) {
  if (smallest >= NEAR) return "No motion of the tool is lost.";
  const nearly = smallest < EXACT ? "" : "nearly ";
  const moved = names.length > 1 ? `${names.slice(0, -1).join(", ")} and ${names[names.length - 1]}` : names[0];
  if (smallest < least) return `Singular: the platform is ${nearly}loose, it moves without the axes.`;
  const runs = names.length > 1 ? "run" : "runs";
  return `Singular: ${lostMotion(chain, lost)} is ${nearly}lost; ${moved} ${runs} away.${remarkOf(chain)}`;
}

/** Return when that matters on a machine that is programmed by its rotary axes. */
function remarkOf(chain) {
  return chain.data.solvesLinear ? " With the rotary axes programmed the linear ones alone follow, and nothing is lost." : "";
}

/** Return which motion is lost, such as "rotation about the flange's Y". */
function lostMotion(chain, lost) {
  const { tool, flange } = chain.data.frames;
  const same = tool.link === flange.link;
  const back = same ? multiply(inverse(flange.T), tool.T) : null;
  const [shift, turn] = [lost.slice(0, 3), lost.slice(3)].map((v) => (same ? rotate(back, v) : v));
  const frame = same ? "flange" : "tool";
  const parts = [
    [Math.hypot(...turn), `rotation about ${direction(turn, frame)}`],
    [Math.hypot(...shift), `motion along ${direction(shift, frame)}`],
  ].filter(([size]) => size > SHARE);
  parts.sort((a, b) => b[0] - a[0]);
  return parts.map(([, text]) => text).join(" together with ") || "one motion";
}

function direction(vector, frame) {
  const size = Math.hypot(...vector) || 1;
  const unit = vector.map((v) => v / size);
  const best = [0, 1, 2].reduce((most, n) => (Math.abs(unit[n]) > Math.abs(unit[most]) ? n : most), 0);
  if (Math.abs(unit[best]) > ALONG_AXIS) return `the ${frame}'s ${"XYZ"[best]}`;
  const sign = unit[best] > 0 ? 1 : -1;
  return `(${unit.map((v) => `${Number((sign * v).toFixed(2)) + 0}`).join(", ")}) in the ${frame} frame`;
}
