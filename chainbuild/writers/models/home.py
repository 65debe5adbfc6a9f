"""Where written files begin, and which joints determine the others."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.elements import Chain
from chainbuild.chain.followers import axis_joints_first
from chainbuild.errors import ChainbuildError

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Mechanism

_RIGHT: Final = 1e-9  # factors below this are rounding


def home(robot: Mechanism) -> Vector:
    """Return axis values (n_axes,), mm and degrees, at which the file begins: zero, or the nearest limit, if it closes.

    Raises:
        ChainbuildError: no pose is found.
    """
    from chainbuild.kinematics.closure import closing_axes

    lower, upper = np.array([axis.range for axis in robot.axes]).T
    found: Vector = np.clip(0.0, lower, upper)
    if np.isfinite(robot.chain.axis_map.q(found)).all():
        return found
    closing = closing_axes(robot, np.random.default_rng(5), 1)
    if not len(closing):
        raise ChainbuildError("no position within the limits has a pose")
    first: Vector = np.round(closing[0], 3)
    return first if np.isfinite(robot.chain.axis_map.q(first)).all() else closing[0]


def leading_joints(chain: Chain, axis_map: AffineMap) -> list[int]:
    """Return joints that together determine every other: those named after axes first."""
    lead: list[int] = []
    for n in axis_joints_first(chain):
        if np.linalg.matrix_rank(axis_map.A[[*lead, n]], tol=_RIGHT) > len(lead):
            lead.append(n)
    return lead
