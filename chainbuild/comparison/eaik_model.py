"""Six rotary axes as EAIK's model, which knows every arm that subproblems decompose (extra `analytic`)."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.ik.branches.core.serial import Serial


def eaik_robot(serial: Serial) -> Any | None:
    """Return EAIK's model of six rotary axes, or None where EAIK is not installed or does not know the arm.

    EAIK's joints turn about H in the frame of joint value 0; P leads from axis to axis, the last one to the tool.
    """
    if len(serial.screws) != 6 or any(screw.kind != "revolute" for screw in serial.screws):
        return None
    try:
        eaik = import_module("eaik.IK_HP")
    except ImportError:
        return None
    H = np.array([screw.direction for screw in serial.screws])
    points = np.array([np.zeros(3), *(screw.point for screw in serial.screws), serial.M[:3, 3]])
    robot: Any = eaik.HPRobot(H, np.diff(points, axis=0))
    return robot if robot.hasKnownDecomposition() else None


def eaik_answers(robot: Any, serial: Serial, target: Matrix) -> list[tuple[Vector, bool]]:
    """Return EAIK's joint values (6,) for a pose, and which of them EAIK marks as best approximations.

    At the edge of the reach, where branches meet, some of these are exact but for rounding. Of some arms EAIK 1.2.2
    returns wrong values, without a mark: those with three parallel axes of which one counts the other way.

    Args:
        robot: EAIK's model.
        serial: The chain it was built from.
        target: (4, 4) tool in the workpiece frame [m].
    """
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = target[:3, :3] @ serial.M[:3, :3].T, target[:3, 3]
    found = robot.IK(pose)
    rows = np.asarray(found.Q, dtype=float).reshape(-1, 6)
    marked = np.asarray(found.is_LS, dtype=bool).reshape(-1).tolist()
    return [(row, approximate) for row, approximate in zip(rows, marked, strict=True) if np.isfinite(row).all()]
