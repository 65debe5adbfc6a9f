"""Speeds that the motion of a path needs of axes and drives."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.analysis.path.collect import BlockRun, Point
from chainbuild.analysis.path.motion import StraightMotion
from chainbuild.analysis.path.places import PathPlace, PathSpeed
from chainbuild.analysis.singularity.speeds import AxisSpeed
from chainbuild.analysis.vanishing.tracing import Blocks
from chainbuild.arrays import Matrix, Vector
from chainbuild.kinematics.mechanism import Mechanism

_STILL_MM: Final = 1e-9  # way of the tip over a block that is none: rounding of a metre is 1e-13


def drive_rates(robot: Mechanism, axes: Vector, rates: Vector) -> Vector:
    """Return the rates (n_axes,) of the drives for rates (n_axes,) of the axes, both in mm and degrees."""
    drives = robot.chain.drives
    if drives is None:
        return rates
    factors = robot.kinematics.si_factors
    behind = drives.derivative(axes)
    found = (behind @ (np.where(np.isfinite(rates), rates, 0.0) * factors)) / factors
    found[((behind != 0.0) & ~np.isfinite(rates)).any(axis=1)] = np.inf
    return np.asarray(found)


def speeds_at(robot: Mechanism, point: Point, tool_speed: float) -> tuple[AxisSpeed, ...]:
    """Return the speeds that the motion at a place needs, at a speed of the tip [mm/s], else of its turn [deg/s]."""
    per_block = point.tip_mm if point.tip_mm > _STILL_MM else point.turn_deg
    if not per_block > 0.0:
        return ()
    return _speeds(robot, point.place.axes, point.rates * (tool_speed / per_block))


def _speeds(robot: Mechanism, axes: Vector, rates: Vector) -> tuple[AxisSpeed, ...]:
    if not np.isfinite(axes).all():
        return ()
    found = [AxisSpeed(axis, abs(rate), axis.max_speed) for axis, rate in zip(robot.axes, rates.tolist(), strict=True)]
    if robot.chain.drives is not None:
        limits = {limit.axis: limit.max_speed for limit in robot.chain.drive_limits}
        behind = np.abs(drive_rates(robot, axes, rates)).tolist()
        found += [
            AxisSpeed(robot.axes[n], behind[n], limits.get(n), of_drive=True) for n in robot.chain.drives.differing
        ]
    return tuple(found)


class SpeedWatch:
    """Follows the speeds of axes and drives along a path at a feed."""

    def __init__(self, robot: Mechanism, mm_per_second: float) -> None:
        self.robot, self.feed = robot, mm_per_second
        self.without_way = 0
        self._largest: dict[str, PathSpeed] = {}

    def take(self, chunk: BlockRun, ways_mm: Vector, close: tuple[Blocks, Vector]) -> None:
        """Take a chunk.

        Args:
            chunk: The blocks.
            ways_mm: (N,) way of the tip over each.
            close: Block and share of the places closest to singularities.
        """
        moving = np.flatnonzero(ways_mm > _STILL_MM)
        self.without_way += len(ways_mm) - len(moving)
        straight = isinstance(chunk.motion, StraightMotion)
        blocks, shares = moving, np.zeros(len(moving))
        if not straight:
            inner = ways_mm[close[0]] > _STILL_MM
            blocks = np.concatenate([moving, moving, close[0][inner]])
            shares = np.concatenate([shares, np.ones(len(moving)), close[1][inner]])
        if not len(blocks):
            return
        rates, tips, _ = chunk.motion.speeds(blocks, shares)
        # Axes that change evenly share the time of the whole block; along a line the tip has the feed everywhere.
        per_block = ways_mm[blocks] if straight else tips
        self._keep(chunk, blocks, shares, rates * (self.feed / per_block)[:, None])

    def _keep(self, chunk: BlockRun, blocks: Blocks, shares: Vector, rates: Matrix) -> None:
        rows = np.abs(rates)
        drives = self.robot.chain.drives
        axes = chunk.motion.axes(blocks, shares) if drives is not None else None
        columns = {axis.name: (axis, rows[:, n], axis.max_speed, False) for n, axis in enumerate(self.robot.axes)}
        if drives is not None and axes is not None:
            limits = {limit.axis: limit.max_speed for limit in self.robot.chain.drive_limits}
            behind = np.abs([drive_rates(self.robot, at, rate) for at, rate in zip(axes, rates, strict=True)])
            for n in drives.differing:
                one = AxisSpeed(self.robot.axes[n], 0.0, limits.get(n), of_drive=True)
                columns[one.name] = (one.axis, behind[:, n], one.limit, True)
        for name, (axis, values, limit, of_drive) in columns.items():
            known = np.where(np.isfinite(values) | np.isinf(values), values, -1.0)
            best = int(known.argmax())
            speed = AxisSpeed(axis, float(known[best]), limit, of_drive)
            before = self._largest.get(name)
            begin, end = (before.begin, before.end) if before else (None, None)
            if speed.excessive:
                fast = np.unique(blocks[known > (limit or 0.0)])
                begin = begin or chunk.places([int(fast[0])], [0.0])[0]
                end = chunk.places([int(fast[-1])], [1.0])[0]
            if before is not None and before.speed.needed >= speed.needed:
                self._largest[name] = PathSpeed(before.speed, before.place, begin, end)
            else:
                place: PathPlace = chunk.places([int(blocks[best])], [float(shares[best])])[0]
                self._largest[name] = PathSpeed(speed, place, begin, end)

    def finish(self) -> tuple[PathSpeed, ...]:
        """Return the largest speeds, axes first."""
        return tuple(self._largest.values())
