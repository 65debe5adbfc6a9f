"""When two answers are the same."""

from __future__ import annotations

import numpy as np

from chainbuild.robot import Robot


def same_turns(robot: Robot, found: np.ndarray, wanted: np.ndarray) -> bool:
    """Tell whether axis values agree to 1e-6, whole turns of rotary axes apart."""
    turn = np.array([360.0 if axis.kind == "rotary" else 1e12 for axis in robot.axes])
    return bool(np.abs((found - wanted + turn / 2.0) % turn - turn / 2.0).max() < 1e-6)
