"""Questions of a page to the robot in Python: forward and inverse kinematics."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from chainbuild.errors import ChainbuildError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from chainbuild.arrays import Matrix
    from chainbuild.robot import Robot


def answered(robot: Robot, question: Mapping[str, Any]) -> dict[str, Any]:
    """Return the answer to a question; what is refused is told in words under "refused".

    Args:
        robot: The robot.
        question: "id", and "fk" (axis values, mm and degrees), or "ik" or "ik_all" (16 numbers of a pose row by row, in
            metres) and "start" (axis values).

    Returns:
        "id", and "fk": 16 numbers; or "ik": status, axes and errors (m, rad), null
        where there is none; or "ik_all": the axis values of every
        branch, nearest first, and whether they are all.
    """
    found: dict[str, Any] = {"id": question["id"]}
    try:
        if "fk" in question:
            return {**found, "fk": robot.fk(question["fk"]).homogeneous.ravel().tolist()}
        if "ik" in question:
            result = robot.ik(_pose(question["ik"]), question["start"])
            return {
                **found,
                "ik": {
                    "status": result.status,
                    "axes": [_told(value) for value in result.axes.tolist()],
                    "position_error": _told(result.position_error),
                    "rotation_error": _told(result.rotation_error),
                },
            }
        branches = robot.ik_all(_pose(question["ik_all"]), question["start"])
        return {**found, "ik_all": [branch.axes.tolist() for branch in branches]}
    except ChainbuildError as error:
        return {**found, "refused": str(error)}


def _told(value: float) -> float | None:
    """Return a number as JSON has it."""
    return value if math.isfinite(value) else None


def _pose(numbers: list[float]) -> Matrix:
    if len(numbers) != 16:
        raise ChainbuildError(f"expected a pose of 16 numbers, got {len(numbers)}")
    return np.array(numbers, dtype=np.float64).reshape(4, 4)
