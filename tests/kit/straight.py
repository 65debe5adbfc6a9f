"""Which joints one axis alone drives, told by the axis map's answers and by nothing else."""

from __future__ import annotations

import numpy as np

from chainbuild.chain.elements import Chain
from chainbuild.units import si_factor

Vector = np.ndarray


def sample_axes(chain: Chain, count: int = 6, seed: int = 5) -> list[Vector]:
    """Return axis values within limits at which all joints have values."""
    rng = np.random.default_rng(seed)
    lower = np.array([max(axis.lower, -2000.0) for axis in chain.axes])
    upper = np.array([min(axis.upper, 2000.0) for axis in chain.axes])
    found: list[Vector] = []
    while len(found) < count:
        axes = lower + (upper - lower) * rng.uniform(0.02, 0.98, len(lower))
        if np.isfinite(chain.axis_map.q(axes)).all():
            found.append(axes)
    return found


def straight_joints(chain: Chain) -> dict[int, int]:
    """Return for every joint that one axis of its kind alone drives, everywhere with factor ±1, which axis that is."""
    kinds = {"revolute": "rotary", "prismatic": "linear"}
    rows = np.array([chain.axis_map.dq_daxes(axes) for axes in sample_axes(chain)])
    found = {}
    for n, joint in enumerate(chain.joints):
        (driving,) = np.nonzero(np.abs(rows[:, n]).max(axis=0))
        same = bool((rows[:, n] == rows[0, n]).all())
        alone = len(driving) == 1 and same and abs(rows[0, n, driving[0]]) == 1.0
        if alone and chain.axes[driving[0]].kind == kinds[joint.kind]:
            found[n] = int(driving[0])
    return found


def check_joint_values(chain: Chain, axes_of: dict[str, str] | None = None) -> int:
    """Check that the value of each such joint is the value of its axis in SI, found by name; return how many there are.

    Args:
        chain: The chain.
        axes_of: Joint → axis where the names differ.
    """
    straight = straight_joints(chain)
    names = [axis.name for axis in chain.axes]
    for axes in sample_axes(chain):
        q = chain.axis_map.q(axes)
        rows = chain.axis_map.dq_daxes(axes)
        for n, k in straight.items():
            joint = chain.joints[n].name
            assert names[k] == (axes_of or {}).get(joint, joint), f"{chain.name}: {joint} is driven by {names[k]}"
            assert rows[n, k] == 1.0, f"{chain.name}: {joint} is reversed"
            assert q[n] == axes[k] * si_factor(chain.axes[k].kind), f"{chain.name}: {joint} has an offset"
    return len(straight)
