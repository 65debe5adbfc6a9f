"""Six rotary axes through EAIK, which knows every arm that subproblems decompose (extra `analytic`)."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from chainbuild.arrays import Matrix, Vector

if TYPE_CHECKING:
    from chainbuild.ik.branches.core.serial import ArmSolver, Serial, Solution

_TRIALS: Final = 4  # poses at which EAIK is put to the test
_SEED: Final = 7  # any: the same poses every time
_SAME: Final = 1e-6  # m and rad: what EAIK misses where nothing is singular is far below


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


def _is_right(robot: Any, serial: Serial) -> bool:
    """Return whether EAIK's answers are solutions at some poses, and hold the values that these were computed from.

    Of some arms EAIK 1.2.2 returns wrong values, without a mark: those with three parallel axes of which one counts the
    other way.
    """
    rng = np.random.default_rng(_SEED)
    for values in rng.uniform(-2.5, 2.5, (_TRIALS, 6)):
        target = serial.pose(values)
        answers = eaik_answers(robot, serial, target)
        off = [np.abs(serial.pose(row) - target).max() for row, approximate in answers if not approximate]
        known = any(np.abs(np.sin((row - values) / 2.0)).max() < _SAME for row, _ in answers)
        if not known or max(off, default=0.0) > _SAME:
            return False
    return True


def eaik_answers(robot: Any, serial: Serial, target: Matrix) -> list[tuple[Vector, bool]]:
    """Return EAIK's joint values (6,) for a pose, and which of them EAIK marks as best approximations.

    At the edge of the reach, where branches meet, some of these are exact but for rounding.

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


def eaik_solver(serial: Serial, otherwise: ArmSolver | None) -> ArmSolver | None:
    """Return the solver of six rotary axes through EAIK, or None, also where EAIK's answers are wrong.

    Args:
        serial: Six screws.
        otherwise: Solver used in addition if EAIK returns approximations or nothing: at some poses whose branches
            coincide it misses them.
    """
    robot = eaik_robot(serial)
    if robot is None or not _is_right(robot, serial):
        return None

    def solve(target: Matrix, keep: Sequence[float]) -> list[Solution]:
        answers = eaik_answers(robot, serial, target)
        found: list[Solution] = [(row, (False,) * 6) for row, _ in answers]
        doubtful = not answers or any(approximate for _, approximate in answers)
        return found + otherwise(target, keep) if doubtful and otherwise is not None else found

    return solve
