"""When two answers are the same."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from chainbuild.robot import Robot


def same_turns(robot: Robot, found: np.ndarray, wanted: np.ndarray, tolerance: float = 1e-6) -> bool:
    """Tell whether axis values agree to a tolerance, whole turns of rotary axes apart."""
    turn = np.array([360.0 if axis.kind == "rotary" else 1e12 for axis in robot.axes])
    return bool(np.abs((found - wanted + turn / 2.0) % turn - turn / 2.0).max() < tolerance)


def assert_jacobian_is_the_derivative(robot: Robot, rows: np.ndarray) -> None:
    """Compare the Jacobian at each row of axis values with central differences of the pose, to 1e-6."""
    step = 1e-4
    for axes in rows:
        J, T = robot.jacobian(axes), robot.fk(axes)
        for n, axis in enumerate(robot.axes):
            moved = np.eye(len(axes))[n] * step
            si = step * (1e-3 if axis.kind == "linear" else np.pi / 180.0)
            ahead, behind = (pin.log6(T.actInv(robot.fk(axes + s * moved))).vector for s in (1.0, -1.0))
            assert (ahead - behind) / (2.0 * si) == pytest.approx(J[:, n], abs=1e-6)
