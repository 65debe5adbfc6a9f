"""Joints that follow one other joint: what URDF writes as `<mimic>`."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.elements import Chain

_PARALLEL: Final = 1e-9  # factors below this are rounding


def followers(chain: Chain) -> dict[str, tuple[str, float, float]]:
    """Return for each joint that always follows one other: the other's name, the factor and the offset, SI.

    Joints follow one another where the same axes drive them in the same proportion. Of such joints the one that bears
    the name of an axis is followed, else the first. Where the axis map is nonlinear none is known.

    Args:
        chain: The chain.
    """
    if not isinstance(chain.axis_map, AffineMap):
        return {}
    A, b, joints = chain.axis_map.A, chain.axis_map.b, chain.joints
    found: dict[str, tuple[str, float, float]] = {}
    leaders: list[int] = []
    for n in axis_joints_first(chain):
        for m in leaders:
            factor = float(A[n] @ A[m] / (A[m] @ A[m]))
            if factor and np.allclose(A[n], factor * A[m], rtol=0, atol=_PARALLEL):
                found[joints[n].name] = (joints[m].name, factor, float(b[n] - factor * b[m]))
                break
        else:
            if A[n].any():
                leaders.append(n)
    return {joint.name: found[joint.name] for joint in joints if joint.name in found}


def axis_joints_first(chain: Chain) -> list[int]:
    """Return the indices of the joints, those that bear the name of an axis before the others."""
    axes = {axis.name for axis in chain.axes}
    return sorted(range(len(chain.joints)), key=lambda n: (chain.joints[n].name not in axes, n))
