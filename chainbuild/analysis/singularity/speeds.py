"""Axis speeds that a motion of the tool requires, and the alarm they raise near singularities.

The speed of axis i for the worst direction of a shift of 1 m/s (a turn of 1 rad/s) is the length of row i of the
pseudoinverse of the Jacobian, its columns of shifts (turns).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.analysis.singularity.measures import jacobian_at, scaling_of
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.elements import Axis
from chainbuild.errors import ChainbuildError
from chainbuild.kinematics.limits import drive_name
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.shown import fields_shown
from chainbuild.units import si_factor

Motion = Literal["shift", "turn"]

_LOST: Final = 1e-9  # scaled singular values below this require infinite speed


@dataclass(frozen=True, slots=True)
class AxisSpeed:
    """The speed that an axis or its drive needs.

    Attributes:
        axis: The axis.
        needed: mm/s or deg/s; inf at a singularity.
        limit: Its speed limit, if known.
        of_drive: True for the drive of the axis, where it does not stand at the axis value.
    """

    __repr__ = fields_shown

    axis: Axis
    needed: float
    limit: float | None
    of_drive: bool = False

    @property
    def name(self) -> str:
        """Name of the axis, or of its drive."""
        return drive_name(self.axis) if self.of_drive else self.axis.name

    @property
    def excessive(self) -> bool:
        """Whether the limit is known and exceeded."""
        return self.limit is not None and self.needed > self.limit


@dataclass(frozen=True, slots=True)
class SpeedReport:
    """Speeds of all axes for one motion of the tool.

    Attributes:
        motion: "shift" without a turn, or "turn" about the tool point.
        tool_speed: Given speed of the tool [mm/s, deg/s], in the worst direction for each axis.
        axes: One for each axis, in channel order.
        possible: Largest speed of the tool in every direction that all axes and drives with known limits can follow
            [mm/s, deg/s]; None if no limit is known.
        alarm: Alarm of the control if an axis exceeds its limit, such as 75324 for ROBX, else None.
        drives: One for each drive that does not stand at its axis value.
    """

    __repr__ = fields_shown

    motion: Motion
    tool_speed: float
    axes: tuple[AxisSpeed, ...]
    possible: float | None
    alarm: int | None
    drives: tuple[AxisSpeed, ...] = ()


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
    count = len(robot.axes)
    factors = _per_speed(robot, np.eye(count), axes, direction, motion) * asked / shown
    rows = tuple(
        AxisSpeed(axis, float(factor * tool_speed), axis.max_speed)
        for axis, factor in zip(robot.axes, factors, strict=True)
    )
    drives: tuple[AxisSpeed, ...] = ()
    if robot.chain.drives is not None:
        behind = _per_speed(robot, _drive_rates(robot, axes), axes, direction, motion) * asked / shown
        limits = {limit.axis: limit.max_speed for limit in robot.chain.drive_limits}
        drives = tuple(
            AxisSpeed(robot.axes[n], float(behind[n] * tool_speed), limits.get(n), of_drive=True)
            for n in robot.chain.drives.differing
        )
    bounds = [row.limit / row.needed * tool_speed for row in (*rows, *drives) if row.limit and row.needed > 0.0]
    watch = robot.chain.singularity_watch
    alarm = watch.speed_alarm if watch is not None and any(row.excessive for row in (*rows, *drives)) else None
    return SpeedReport(motion, tool_speed, rows, min(bounds) if bounds else None, alarm, drives)


def _drive_rates(robot: Mechanism, axes: ArrayLike) -> Matrix:
    """Return the derivative (n_axes, n_axes) of the drives by the axes, SI by SI; 0 where there are none."""
    values = robot.axis_values(axes)
    if robot.chain.drives is None:
        return np.eye(len(values))
    rates = robot.chain.drives.derivative(values)
    return np.where(np.isfinite(rates), rates, 0.0)


def _per_speed(robot: Mechanism, rates: Matrix, axes: ArrayLike, direction: ArrayLike | None, motion: Motion) -> Vector:
    """Return the speeds of axes or drives (n_axes,) in SI for 1 m/s or 1 rad/s of the tool.

    Args:
        robot: The robot.
        rates: (n_axes, n_axes) derivative of what moves by the axes, SI by SI.
        axes: Axis values.
        direction: Direction of the tool's motion, or None for the worst one of each.
        motion: "shift" or "turn".
    """
    scaling = scaling_of(robot)
    U, values, Vt = np.linalg.svd(scaling.apply(jacobian_at(robot, axes)), full_matrices=False)
    # What 1 m/s along (1 rad/s about) x, y, z of the tool frame is in the scaled task; rows outside the task are free.
    moves = np.zeros((len(values), 3))
    held = (scaling.rows < 3) == (motion == "shift")
    moves[:, scaling.rows[held] % 3] = U[held].T / (scaling.length if motion == "shift" else 1.0)
    linear = np.array([robot.axes[n].kind == "linear" for n in scaling.columns])
    moving = rates[:, scaling.columns] * np.where(linear, scaling.length, 1.0)
    lost = values < _LOST
    with np.errstate(divide="ignore", invalid="ignore"):
        needed = moving @ ((Vt[~lost].T / values[~lost]) @ moves[~lost])
    # In a lost direction the axes that run away need infinite speed.
    running = (np.abs(Vt[lost]).T @ np.abs(moves[lost])) > _LOST
    endless = (moving != 0.0) @ running
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
    return np.asarray(worst, dtype=float)
