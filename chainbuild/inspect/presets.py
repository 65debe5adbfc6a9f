"""Poses that the page offers by name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from chainbuild.arrays import Vector
    from chainbuild.kinematics.mechanism import Mechanism


def presets_of(robot: Mechanism, rest: Vector) -> list[dict[str, Any]]:
    """Return the named poses of a page.

    Args:
        robot: The robot.
        rest: (n_axes,) axis values at which the page opens, mm and degrees.
    """
    zero = np.zeros(len(robot.axes))
    return [
        {"name": "start", "title": "Start", "axes": rest.tolist(), "note": ""},
        {"name": "zero", "title": "Axes zero", "axes": zero.tolist(), "note": ""},
    ]
