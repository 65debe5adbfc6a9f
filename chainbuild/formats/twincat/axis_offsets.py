"""Axis offsets of the active tool, `wz[i].ax_versatz[j]` (P-TOOL-00006), while a transformation is active.

They act on the axes that the transformation leaves alone: with RTCP those behind the first three, which are rotary. The
tool is then where the axis with its offset puts it, so the offset belongs into the pose. On the first three axes and on
every axis of a complete transformation they do not act (KIN_TYP manual 1).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import AffineMap, AxisMap, named_map, periodic_of, refusal_of
from chainbuild.chain.drives import AffineDrives, DriveMap, named_drives
from chainbuild.chain.elements import Axis, Chain
from chainbuild.chain.fold import folded
from chainbuild.convention import Choices
from chainbuild.errors import ChainbuildError
from chainbuild.findings import Collector
from chainbuild.formats.twincat.coupling.coupling import is_rtcp
from chainbuild.formats.twincat.lists.config import RawValue
from chainbuild.formats.twincat.lists.source import Source
from chainbuild.units import deg_from_raw

_TRANSFORMED: Final = 3  # axes that every transformation moves: the Cartesian ones
_SENSE: Final = "tool_axis_offset"


def with_axis_offsets(chain: Chain, source: Source, choose: Choices, collector: Collector) -> Chain:
    """Return the chain of the first transformation step with the axis offsets of the active tool.

    Args:
        chain: The chain, its axes in channel order.
        source: The kinematic and the active tool.
        choose: Conventions; `tool_axis_offset` is used where an offset acts.
        collector: Takes a finding for every offset other than 0 on an axis of the chain.
    """
    offsets = source.tool.axis_offsets if source.tool else {}
    given = {k: entry for k, entry in offsets.items() if entry.value and k < len(chain.axes)}
    acting = {k: entry for k, entry in given.items() if k >= _TRANSFORMED and is_rtcp(source.trafo)}
    for k, entry in given.items():
        if k not in acting:
            _tell_idle(k, entry, source, collector)
    return _shifted(chain, acting, choose, collector) if acting else chain


def _tell_idle(k: int, entry: RawValue, source: Source, collector: Collector) -> None:
    if k < _TRANSFORMED:
        text = f"{entry.name} has no effect while the transformation is active: the first three axes take none"
        hint = "enter it among the kinematic offsets of the tool, kinematic.param[j] (P-TOOL-00009)"
    else:
        kind = f"KIN_TYP {source.trafo.type} is a complete transformation"
        text = f"{entry.name} has no effect: {kind}, which moves all axes"
        hint = None
    collector.add("CB418", text, span=entry.span, parameter=entry.name, hint=hint)


def _shifted(chain: Chain, acting: Mapping[int, RawValue], choose: Choices, collector: Collector) -> Chain:
    choice = choose[_SENSE]
    sign = {"plus": 1.0, "minus": -1.0, "ignored": 0.0}[choice]
    shift = np.zeros(len(chain.axes))
    for k, entry in acting.items():
        axis, offset = chain.axes[k], deg_from_raw(entry.value)
        shift[k] = sign * offset
        stands = f"it stands at its value {'+' if shift[k] > 0 else '-'} {abs(offset):g} deg"
        text = f"{entry.name} acts on axis {axis.name}: {stands if sign else 'it is ignored as chosen'}"
        collector.add(
            "CB418", text, span=entry.span, parameter=entry.name, hint=f"its sense is open: convention {_SENSE}"
        )
    if not shift.any():
        return chain
    axes = tuple(_shifted_reach(axis, off) for axis, off in zip(chain.axes, shift.tolist(), strict=True))
    chain = replace(chain.with_axes(axes), drives=_shifted_drives(chain.drives, shift))
    if not isinstance(chain.axis_map, AffineMap):
        return replace(chain, axis_map=ShiftedMap(chain.axis_map, shift))
    return _folded(chain, chain.axis_map, shift)


def _folded(chain: Chain, axis_map: AffineMap, shift: Vector) -> Chain:
    """Return the chain with the offsets in the placement of joints that one axis alone drives, else in the map."""
    b, joints = axis_map.b + axis_map.A @ (shift * axis_map.si_factors), list(chain.joints)
    for n, row in enumerate(axis_map.A):
        (driving,) = np.nonzero(row)
        if len(driving) == 1 and row[driving[0]] == 1.0 and shift[driving[0]]:
            joints[n] = folded(joints[n], 1.0, float(shift[driving[0]]))
            b[n] = axis_map.b[n]
    return replace(chain, joints=tuple(joints), axis_map=replace(axis_map, b=b))


def _shifted_reach(axis: Axis, shift: float) -> Axis:
    """Return an axis whose limits, where its type knows how far it reaches, are those of the values it is given."""
    free = Axis.unlimited(axis.name, axis.kind)
    if (axis.lower, axis.upper) == (free.lower, free.upper):
        return axis
    return replace(axis, lower=axis.lower - shift, upper=axis.upper - shift)


def _shifted_drives(drives: DriveMap | None, shift: Vector) -> DriveMap:
    """Return what the drives stand at where they follow the axes as these stand, not as they are programmed."""
    if drives is None:
        return AffineDrives.shifted(len(shift), dict(enumerate(shift.tolist())))
    if isinstance(drives, AffineDrives):
        return AffineDrives(drives.A, drives.drives(shift))
    return ShiftedDrives(drives, shift)


@dataclass(frozen=True, slots=True, eq=False)
class ShiftedMap:
    """A map whose axes stand at their values plus an offset.

    Attributes:
        inner: The map of the axes as they stand.
        shift: (n_axes,) offsets, mm and degrees.
    """

    inner: AxisMap
    shift: Vector

    def q(self, axes: Vector) -> Vector:
        """Return the joint values of axis values."""
        return self.inner.q(axes + self.shift)

    def axes(self, q: Vector) -> Vector:
        """Return the axis values of joint values."""
        return self.inner.axes(q) - self.shift

    def dq_daxes(self, axes: Vector) -> Matrix:
        """Return the derivative, SI by SI."""
        return self.inner.dq_daxes(axes + self.shift)

    def refusal(self, axes: Vector) -> ChainbuildError | None:
        """Return why there are no joint values, or None."""
        return refusal_of(self.inner, axes + self.shift)

    def q_bounds(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector]:
        """Return bounds of the joint values."""
        return self.inner.q_bounds(lower + self.shift, upper + self.shift)

    @property
    def periodic(self) -> tuple[int, ...]:
        """Indices of the axes whose whole turn leads to the same pose: an offset changes none."""
        return periodic_of(self.inner)

    def named(self, names: Sequence[str]) -> ShiftedMap:
        """Return the map that names the axes by other names."""
        return replace(self, inner=named_map(self.inner, names))


@dataclass(frozen=True, slots=True, eq=False)
class ShiftedDrives:
    """Drives of axes that stand at their values plus an offset.

    Attributes:
        inner: The drives of the axes as they stand.
        shift: (n_axes,) offsets, mm and degrees.
    """

    inner: DriveMap
    shift: Vector

    @property
    def follows(self) -> NDArray[np.bool_]:
        """(n_axes, n_axes) True where a drive moves with an axis."""
        return self.inner.follows

    @property
    def differing(self) -> tuple[int, ...]:
        """Those of the inner drives, and the drives of axes with an offset."""
        return tuple(sorted({*self.inner.differing, *np.flatnonzero(self.shift).tolist()}))

    @property
    def turning(self) -> tuple[int, ...]:
        """Indices of the drives that turn on with their own axis."""
        return self.inner.turning

    @property
    def reach(self) -> Mapping[int, tuple[float, float]]:
        """Index of an axis → the programmed values beyond which the drives have no place."""
        shift = self.shift.tolist()
        return {n: (low - shift[n], high - shift[n]) for n, (low, high) in self.inner.reach.items()}

    def drives(self, axes: Vector) -> Vector:
        """Return the drive values of axis values."""
        return self.inner.drives(axes + self.shift)

    def derivative(self, axes: Vector) -> Matrix:
        """Return the derivative, SI by SI."""
        return self.inner.derivative(axes + self.shift)

    def refusal(self, axes: Vector) -> ChainbuildError | None:
        """Return why there are no drive values, or None."""
        return self.inner.refusal(axes + self.shift)

    def named(self, names: Sequence[str]) -> ShiftedDrives:
        """Return the drives that name the axes by other names."""
        return replace(self, inner=named_drives(self.inner, names))
