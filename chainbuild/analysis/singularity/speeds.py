"""Axis speeds that a motion of the tool requires, and the alarm they raise near singularities.

The speed of axis i for the worst direction of a shift of 1 m/s (a turn of 1 rad/s) is the length of row i of the
pseudoinverse of the Jacobian, its columns of shifts (turns).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.analysis.singularity.measures import scaling_of
from chainbuild.arrays import Vector
from chainbuild.chain.elements import Axis
from chainbuild.errors import ChainbuildError
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.shown import compact
from chainbuild.units import si_factor

Motion = Literal["shift", "turn"]

_LOST: Final = 1e-9  # scaled singular values below this require infinite speed


@compact
@dataclass(frozen=True, slots=True)
class AxisSpeed:
    """The speed that an axis needs.

    Attributes:
        axis: The axis.
        needed: mm/s or deg/s; inf at a singularity.
        limit: Its speed limit, if known.
    """

    axis: Axis
    needed: float
    limit: float | None

    @property
    def excessive(self) -> bool:
        """Whether the limit is known and exceeded."""
        return self.limit is not None and self.needed > self.limit


@compact
@dataclass(frozen=True, slots=True)
class SpeedReport:
    """Speeds of all axes for one motion of the tool.

    Attributes:
        motion: "shift" without a turn, or "turn" about the tool point.
        tool_speed: Given speed of the tool [mm/s, deg/s], in the worst direction for each axis.
        axes: One for each axis, in channel order.
        possible: Largest speed of the tool in every direction that all axes with known limits can follow [mm/s,
            deg/s]; None if no limit is known.
        alarm: Alarm of the control if an axis exceeds its limit, such as 75324 for ROBX, else None.
    """

    motion: Motion
    tool_speed: float
    axes: tuple[AxisSpeed, ...]
    possible: float | None
    alarm: int | None


def speeds(
    robot: Mechanism,
    axes: ArrayLike,
    tool_speed: float,
    direction: ArrayLike | None = None,
    motion: Motion = "shift",
) -> SpeedReport:
    """Return the axis speeds for a shift of the tool without a turn, or for a turn about the tool point.

    Args:
        robot: The robot.
        axes: (n_axes,) axis values, mm and degrees.
        tool_speed: Speed of the tool [mm/s, deg/s].
        direction: (3,) direction of the motion in the tool frame; None: for each axis the worst one.
        motion: "shift" or "turn".

    Raises:
        ChainbuildError: the speed is not a finite number above 0, or the direction is 0.
        AxisValueError: wrong number of axis values, or a non-finite value.
    """
    if not (np.isfinite(tool_speed) and tool_speed > 0.0):
        raise ChainbuildError("wrong tool speed", parameter="speed", permitted="a finite number above 0")
    asked = si_factor("linear" if motion == "shift" else "rotary")
    shown = np.array([si_factor(axis.kind) for axis in robot.axes])
    factors = _per_speed(robot, axes, direction, motion) * asked / shown
    rows = tuple(
        AxisSpeed(axis, float(factor * tool_speed), axis.max_speed)
        for axis, factor in zip(robot.axes, factors, strict=True)
    )
    bounds = [a.max_speed / f for a, f in zip(robot.axes, factors.tolist(), strict=True) if a.max_speed and f > 0.0]
    watch = robot.chain.singularity_watch
    alarm = watch.speed_alarm if watch is not None and any(row.excessive for row in rows) else None
    return SpeedReport(motion, tool_speed, rows, min(bounds) if bounds else None, alarm)


def _per_speed(robot: Mechanism, axes: ArrayLike, direction: ArrayLike | None, motion: Motion) -> Vector:
    """Return the speeds of the axes (n_axes,) in SI for 1 m/s or 1 rad/s of the tool."""
    scaling = scaling_of(robot)
    U, values, Vt = np.linalg.svd(scaling.apply(robot.jacobian(axes)), full_matrices=False)
    # What 1 m/s along (1 rad/s about) x, y, z of the tool frame is in the scaled task; rows outside the task are free.
    moves = np.zeros((len(values), 3))
    held = (scaling.rows < 3) == (motion == "shift")
    moves[:, scaling.rows[held] % 3] = U[held].T / (scaling.length if motion == "shift" else 1.0)
    result = np.zeros(len(robot.axes))
    lost = values < _LOST
    with np.errstate(divide="ignore", invalid="ignore"):
        needed = (Vt[~lost].T / values[~lost]) @ moves[~lost]
    # In a lost direction the axes that run away need infinite speed.
    endless = (np.abs(Vt[lost]).T @ np.abs(moves[lost])) > _LOST
    if direction is None:
        worst = np.linalg.norm(needed, axis=1)
        worst[endless.any(axis=1)] = np.inf
    else:
        along = np.asarray(direction, dtype=float)
        size = float(np.linalg.norm(along)) if along.shape == (3,) else 0.0
        if not (np.isfinite(size) and size > 0.0):
            raise ChainbuildError("wrong direction of motion", permitted="three finite numbers, not all 0")
        worst = np.abs(needed @ (along / size))
        worst[(endless & (np.abs(along) > 0.0)).any(axis=1)] = np.inf
    linear = np.array([robot.axes[n].kind == "linear" for n in scaling.columns])
    result[scaling.columns] = worst * np.where(linear, scaling.length, 1.0)
    return result
