"""The constants that `opw_branches` works with, measured on a robot and confirmed against its forward kinematics."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from chainbuild import tolerances
from chainbuild.arrays import Matrix
from chainbuild.chain.axismap import AffineMap
from chainbuild.frames import inverse
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.opw.formulas import CONSTANTS, confirmed, constant_rows
from chainbuild.ik.branches.opw.parameters import OpwArm, opw_arm
from chainbuild.ik.branches.vectors.axes import axis_constants
from chainbuild.ik.branches.vectors.operands import product
from chainbuild.ik.request import IkRequest
from chainbuild.kinematics.mechanism import Mechanism

_SHORTEST: Final = 1e-6  # upper arm and forearm of at least this [m]
_WHOLE: Final = 1e-9  # a determinant so near to 1 is one but for rounding: axes and joints make the same turns
_SAMPLES: Final = 16  # any wrong constant shows in the first one
_EXACT: Final = 1e-9  # permitted error of samples [m, rad]


def opw_constants(mechanism: Mechanism, *, limits: bool) -> Matrix | None:
    """Return the constants (n, 6) of a robot, see `opw_branches.CONSTANTS`; None if the closed form does not apply.

    Args:
        mechanism: The mechanism.
        limits: False: ignore the limits.
    """
    axis_map = mechanism.chain.axis_map
    if not isinstance(axis_map, AffineMap) or len(mechanism.axes) != 6 or mechanism.chain.loops:
        return None
    query = BranchQuery.of(IkRequest(mechanism, np.eye(4)))
    serial = query.serial()
    arm = opw_arm(serial)
    if arm is None or not query.periodic.all():
        return None
    together = sorted(mechanism.limits.together)
    if limits and (query.upper - query.lower >= math.tau)[together].any():
        return None  # another whole turn of an axis may keep a limit on a sum
    joints = [screw.joint for screw in serial.screws]
    A, b, factors = axis_map.A[joints], axis_map.b[joints], axis_map.si_factors
    forearm = math.hypot(arm.parameters["a2"], arm.parameters["c3"])
    # With a gear, whole turns of joints are no whole turns of axes.
    if abs(abs(float(np.linalg.det(A))) - 1.0) > _WHOLE or min(arm.parameters["c2"], forearm) < _SHORTEST:
        return None
    parts = _filled(arm, arm.signs[:, None] * A * factors, arm.signs * b + arm.offsets, query, limits)
    constants = np.concatenate([np.asarray(parts[name], dtype=float).reshape(-1, 6) for name in CONSTANTS])
    return constants if _confirmed(mechanism, constants) else None


def _filled(arm: OpwArm, back: Matrix, zero: Matrix, query: BranchQuery, limits: bool) -> dict[str, object]:
    """Return the constants by name; back and zero lead from axis values to angles."""
    p, factors = arm.parameters, query.mechanism.kinematics.si_factors
    forearm, bend = math.hypot(p["a2"], p["c3"]), math.atan2(p["a2"], p["c3"])
    wanted = query.x0 / factors
    first, _, _, fourth, _, _ = back @ wanted + zero
    near = (tolerances.IK_POSITION_M**2, tolerances.IK_ROTATION_RAD**2)
    return {
        "base": inverse(arm.T_base_arm)[:3],
        "flange": inverse(arm.T_flange_tool)[:3],
        "lengths": (p["a1"], p["b"], p["c1"], p["c2"], forearm, forearm * forearm),
        "bend": (bend, math.cos(bend), math.sin(bend), p["a2"], p["c3"], 0.0),
        "keep": (math.cos(first), math.sin(first), math.cos(fourth), math.sin(fourth), 0.0, 0.0),
        "tip": (*arm.T_flange_tool[:3, 3], *near, 0.0),
        **axis_constants(query, back, zero, wanted, limits=limits),
    }


def _confirmed(mechanism: Mechanism, constants: Matrix) -> bool:
    """Return whether the formulas that confirm branches match the robot's forward kinematics, on random axis values."""
    base, flange, arm, _, backward, _ = constant_rows(constants)
    axes = np.random.default_rng(0).uniform(-170.0, 170.0, (_SAMPLES, 6))
    T = mechanism.fk_batch(axes)[:, :3].reshape(_SAMPLES, 12).T
    M = product(product(base, T), flange)
    strict = (*arm[:3], (*arm[3][:3], _EXACT**2, _EXACT**2))
    return bool(np.all(confirmed(axes.T, M, strict, backward)))
