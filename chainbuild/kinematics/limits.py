"""Inside the limits or not: the one answer, for axes, for sums of axes and for drives.

Axis values are rounded, sums of them more so. A value counts as inside up to `tolerances.LIMIT_SLACK` beyond its
limit, in mm and degrees, and in metres and radians by the same amount turned into SI; solvers return such a value
as its limit. Software limits belong to the drives. Where a drive stands at its axis value, both are one; where a gear
or a map lies between them, the drive is looked at by itself: an affine one is a sum of axes, any other is computed.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.drives import AffineDrives, DriveLimit, DriveMap
from chainbuild.chain.elements import Axis, Chain
from chainbuild.chain.names import DRIVE_SUFFIX
from chainbuild.chain.sums import AxisConstraint
from chainbuild.shown import two_lines
from chainbuild.tolerances import LIMIT_SLACK


@dataclass(frozen=True, slots=True, eq=False)
class Limits:
    """The limits of a chain, in mm and degrees.

    Attributes:
        axes: The axes.
        lower: (n_axes,) lower limits, -inf where an axis is endless.
        upper: (n_axes,) upper limits, +inf where it is.
        sums: Limits on sums of axes, those of drives behind a gear among them.
        drive_map: What the drives stand at, where they have limits of their own; else None.
        drives: Limits of drives that do not stand at their axis values.
        curved: Whether some of these are no sums of axes.
        together: Indices of the axes that take part in sums or in drives of several axes.
        from_drives: Index of an axis, and -1 or 1 → the drive that its lower or upper limit comes from.
    """

    axes: tuple[Axis, ...]
    lower: Vector
    upper: Vector
    sums: tuple[AxisConstraint, ...]
    drive_map: DriveMap | None
    drives: tuple[DriveLimit, ...]
    curved: bool
    together: frozenset[int]
    from_drives: dict[tuple[int, int], str]

    def __repr__(self) -> str:
        axes = (f"{axis.name} {axis.range[0]:.6g} … {axis.range[1]:.6g} {axis.unit}" for axis in self.axes)
        sums = (f"{limit.name} {limit.lower:.6g} … {limit.upper:.6g}" for limit in self.plain_sums)
        drives = (f"{self.drive_name(one)} {one.lower:.6g} … {one.upper:.6g}" for one in self.drives)
        return two_lines(f"<Limits: {', '.join((*axes, *sums, *drives))}>")

    @classmethod
    def of(cls, chain: Chain) -> Limits:
        """Return the limits of a chain."""
        lower = np.array([-math.inf if axis.endless else axis.range[0] for axis in chain.axes])
        upper = np.array([math.inf if axis.endless else axis.range[1] for axis in chain.axes])
        limited = tuple(one for one in chain.drive_limits if one.bounded)
        drives = chain.drives or AffineDrives.shifted(len(chain.axes), {}) if limited else None
        return cls(
            chain.axes,
            lower,
            upper,
            (*chain.constraints, *_drive_sums(chain.axes, drives, limited)),
            drives,
            limited,
            curved=drives is not None and not isinstance(drives, AffineDrives),
            together=_together(chain, drives, limited),
            from_drives={} if drives is None else _ends_from_drives(chain.axes, drives, limited),
        )

    @property
    def plain_sums(self) -> tuple[AxisConstraint, ...]:
        """The limits on sums of axes that are not those of a drive."""
        return self.sums[: len(self.sums) - len(self.drives)] if not self.curved else self.sums

    def drive_name(self, limit: DriveLimit) -> str:
        """Return the name of a drive, such as "A_drive"."""
        return drive_name(self.axes[limit.axis])

    def outside(self, values: Vector) -> list[int]:
        """Return the indices of the axes that values (n_axes,) put beyond their limits; not a number is outside."""
        # Plain floats: for a handful of axes quicker than arrays.
        rows = enumerate(zip(values.tolist(), self.lower.tolist(), self.upper.tolist(), strict=True))
        return [n for n, (value, low, high) in rows if not low - LIMIT_SLACK <= value <= high + LIMIT_SLACK]

    def broken_sums(self, values: Vector) -> tuple[AxisConstraint, ...]:
        """Return the limits on sums of axes that values (n_axes,) violate."""
        return tuple(limit for limit in self.sums if limit.margin(values) < -LIMIT_SLACK)

    def broken_drives(self, values: Vector) -> list[tuple[DriveLimit, float]]:
        """Return the limits of drives that values (n_axes,) violate, each with its drive's value."""
        if self.drive_map is None:
            return []
        at = self.drive_map.drives(values).tolist()
        found = ((one, at[one.axis]) for one in self.drives)
        return [(o, v) for o, v in found if not o.lower - LIMIT_SLACK <= v <= o.upper + LIMIT_SLACK]

    def breaks_together(self, values: Vector) -> bool:
        """Return whether values (n_axes,) violate a limit on a sum of axes or on a drive."""
        return bool(self.sums and self.broken_sums(values)) or bool(self.curved and self.broken_drives(values))

    def violated(self, values: Vector) -> tuple[str, ...]:
        """Return the names of the axes beyond their limits, then of the sums and the drives that are.

        An axis whose limit is that of its drive is named by the drive.
        """
        if not self.sums and not self.curved:
            return tuple(self.axes[n].name for n in self.outside(values))
        return tuple(name for name, _ in self.violations(values))

    def violations(self, values: Vector) -> tuple[tuple[str, str], ...]:
        """Return the name of each violated limit and what is wrong, in words; see `violated`."""
        axes = [(self.axes[n].name, self.in_words(n, float(values[n]))) for n in self.own_outside(values)]
        return (*axes, *self.joint_violations(values))

    def joint_violations(self, values: Vector) -> tuple[tuple[str, str], ...]:
        """Return the name of each violated limit on a sum of axes or a drive, and what is wrong, in words."""
        sums = [(limit.name, limit.label) for limit in self.plain_sums if limit.margin(values) < -LIMIT_SLACK]
        drives = [(self.drive_name(one), self._drive_in_words(one, at)) for one, at in self.broken_drives(values)]
        return (*sums, *drives)

    def own_outside(self, values: Vector) -> list[int]:
        """Return the indices of the axes beyond a limit that is not that of a drive named for it."""
        outside = self.outside(values)
        if not outside or not self.from_drives:
            return outside
        names = {self.drive_name(one) for one, _ in self.broken_drives(values)}
        sides = {n: -1 if values[n] < self.lower[n] else 1 for n in outside}
        return [n for n in outside if self.from_drives.get((n, sides[n])) not in names]

    def words(self, values: Vector) -> str:
        """Return what is wrong with values (n_axes,): axes beyond their limits, sums and drives; empty: nothing."""
        sums = {limit.name: f"outside the limits of {limit.label}" for limit in self.plain_sums}
        return "; ".join(sums.get(name, words) for name, words in self.violations(values))

    def inside_rows(self, rows: Matrix) -> NDArray[np.bool_]:
        """Return (N,) whether rows (N, n_axes) are inside all limits; not a number is outside."""
        inside = np.asarray(((rows >= self.lower - LIMIT_SLACK) & (rows <= self.upper + LIMIT_SLACK)).all(axis=1))
        for limit in self.sums:
            total = rows @ np.array(limit.sum.coefficients) + limit.sum.offset
            inside = inside & (total >= limit.lower - LIMIT_SLACK) & (total <= limit.upper + LIMIT_SLACK)
        if self.curved:
            inside[inside] = [not self.broken_drives(row) for row in rows[inside]]
        return inside

    def is_beyond(self, values: Vector) -> bool:
        """Return whether values (n_axes,) put an axis beyond its limit, be it by rounding."""
        rows = zip(values.tolist(), self.lower.tolist(), self.upper.tolist(), strict=True)
        return not all(low <= value <= high for value, low, high in rows)

    def onto(self, values: Vector) -> Vector:
        """Return values (n_axes,) with every axis beyond its limit moved onto it."""
        return np.minimum(np.maximum(values, self.lower), self.upper)

    def in_words(self, n: int, value: float) -> str:
        """Return what is wrong with a value of axis n, such as "A3 is 170.2, outside -120 … 156 deg"."""
        axis = self.axes[n]
        lower, upper = axis.range
        return f"{axis.name} is {value:.6g}, outside {lower:g} … {upper:g} {axis.unit}"

    def _drive_in_words(self, limit: DriveLimit, value: float) -> str:
        if math.isnan(value):
            return f"{self.drive_name(limit)} has no value there"
        unit = self.axes[limit.axis].unit
        return f"{self.drive_name(limit)} is {value:.6g}, outside {limit.lower:g} … {limit.upper:g} {unit}"


def drive_name(axis: Axis) -> str:
    """Return the name of an axis' drive, also that of its column in tables."""
    return f"{axis.name}{DRIVE_SUFFIX}"


def _together(chain: Chain, drives: DriveMap | None, limits: tuple[DriveLimit, ...]) -> frozenset[int]:
    """Return the indices of the axes that take part in sums or in the limited drives."""
    rows = [np.array(limit.sum.coefficients) != 0.0 for limit in chain.constraints]
    if drives is not None:
        rows += [drives.follows[one.axis] for one in limits]
    return frozenset(int(n) for row in rows for n in np.flatnonzero(row))


def _drive_sums(
    axes: tuple[Axis, ...], drives: DriveMap | None, limits: tuple[DriveLimit, ...]
) -> tuple[AxisConstraint, ...]:
    """Return the limits of drives behind a gear as limits on sums of axes."""
    if not isinstance(drives, AffineDrives):
        return ()
    return tuple(
        AxisConstraint(drive_name(axes[one.axis]), drives.total(one.axis), one.lower, one.upper) for one in limits
    )


def _ends_from_drives(
    axes: tuple[Axis, ...], drives: DriveMap, limits: tuple[DriveLimit, ...]
) -> dict[tuple[int, int], str]:
    """Return which ends of axes are limits of drives: those of a drive that follows the axis alone or affinely."""
    found: dict[tuple[int, int], str] = {}
    ends = np.array([axis.range for axis in axes])
    for one in limits:
        moving = np.flatnonzero(drives.follows[one.axis])
        if len(moving) != 1 and not isinstance(drives, AffineDrives):
            continue
        for n in moving.tolist():
            for side, end in zip((-1, 1), ends[n], strict=True):
                box = ends.copy()
                box[n] = end
                # Over the box an affine drive is least and most where each axis is at one of its ends.
                corners = np.array(list(itertools.product(*(box[m] for m in moving))))
                values = np.repeat(box[None, :, 0], len(corners), axis=0)
                values[:, moving] = corners
                at = [float(drives.drives(row)[one.axis]) for row in values]
                if abs(min(at) - one.upper) <= LIMIT_SLACK or abs(max(at) - one.lower) <= LIMIT_SLACK:
                    found[n, side] = drive_name(axes[one.axis])
    return found
