// The open chain between the tips of a closed one, whose branches are found as those of any arm: `closedAxes` of
// `cb/loops` then tells which axis values close the loops there. Joints between the tips, each with an axis of its own:
// the twin of `_opened` in Python's `ik/branches/closed.py`.

import { metres, radians } from "cb/units";

const WIDE = 10; // times the limits assumed for axes: what no axis drives has none
const ASSUMED = { linear: 10000, rotary: 360 }; // mm, deg
const SI = { linear: metres(1), rotary: radians(1) };

/**
 * Return the data of the open chain, or null where a held axis keeps the way between the tips from being free.
 *
 * data: chain with loops; tips: indices of the joints between its tips, in the order of the chain.
 */
export function openedChain(data, tips) {
  const joints = tips.map((n) => data.joints[n]);
  const axes = joints.map((joint) => data.axes.find((axis) => axis.name === joint.name) ?? freeAxis(joint));
  if (data.axes.some((axis) => axis.held && !axes.includes(axis))) return null;
  // Links that are left, the base first, at new places.
  const kept = data.links.map((_, n) => n).filter((n) => n === 0 || joints.some((joint) => joint.child === n));
  const place = (link) => kept.indexOf(link);
  const frames = Object.entries(data.frames).filter(([, frame]) => kept.includes(frame.link));
  return {
    ...data,
    axes,
    links: kept.map((n) => data.links[n]),
    joints: joints.map((joint) => ({ ...joint, parent: place(joint.parent), child: place(joint.child) })),
    frames: Object.fromEntries(frames.map(([name, frame]) => [name, { ...frame, link: place(frame.link) }])),
    map: oneByOne(axes.map((axis) => SI[axis.kind])),
    drives: null,
    driveLimits: [],
    sums: [],
    loops: false,
  };
}

// An axis for a joint that no axis drives alone.
function freeAxis(joint) {
  const kind = joint.kind === "revolute" ? "rotary" : "linear";
  const bound = WIDE * ASSUMED[kind];
  return {
    name: joint.name,
    generic: joint.name,
    kind,
    unit: kind === "linear" ? "mm" : "deg",
    lower: -bound,
    upper: bound,
    shown: [-bound, bound],
    assumed: true,
    endless: false,
    held: false,
    carries: "tool",
  };
}

// The map of axes that are joint values but for their units.
function oneByOne(factors) {
  const identity = factors.map((_, n) => factors.map((_unused, m) => Number(n === m)));
  return { class: "AffineMap", A: identity, b: factors.map(() => 0), si_factors: factors, back: identity };
}
