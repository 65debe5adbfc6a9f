"""Transformations of two steps: the coordinates that the first gives are the axis values of the second.

The steps are numbered in the direction of the forward transformation: step 0 turns the axis values of the machine into
programmed coordinates, step 1 takes these for the axis values of its own kinematic. The chain is that of step 1, moved
through step 0 by the axis map.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np

from chainbuild import frames
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import AxisMap, named_map, refusal_of
from chainbuild.chain.elements import Chain
from chainbuild.chain.fold import reach
from chainbuild.chain.names import renamed
from chainbuild.chain.poses import angle_rates, pose, pose_jacobian
from chainbuild.chain.programmed.display import POSE_ANGLES, Display
from chainbuild.errors import ChainbuildError, UnsupportedKinematicError
from chainbuild.findings import Collector
from chainbuild.formats.twincat.coupling.coupling import is_rtcp
from chainbuild.formats.twincat.lists.config import Trafo
from chainbuild.formats.twincat.types.catalogue import catalogue
from chainbuild.formats.twincat.types.displays import by_rotary_axes
from chainbuild.units import AxisKind, mm_from_m, si_factor

_POSITION: Final = 3  # values ahead of the angles: X, Y, Z
_NEWTON_STEPS: Final = 50  # at most: from inside the limits a few are enough
_CLOSE: Final = 1e-11  # m and rad: what rounding may leave


def two_steps(first: Chain, first_trafo: Trafo, second: Chain, second_trafo: Trafo, collector: Collector) -> Chain:
    """Return the chain of two transformation steps: first's axes, second's pose.

    Args:
        first: Chain of step 0, next to the machine.
        first_trafo: Its configuration.
        second: Chain of step 1.
        second_trafo: Its configuration.
        collector: Takes findings.

    Raises:
        UnsupportedKinematicError: step 0 gives no coordinates that step 1 could take for its axis values.
    """
    coordinates = _coordinates(first, first_trafo)
    kinds = coordinates.kinds
    wanted = tuple(axis.kind for axis in second.axes)
    if wanted != kinds[: len(wanted)]:
        raise UnsupportedKinematicError(
            f"KIN_TYP {second_trafo.type} takes {_units(wanted)}, KIN_TYP {first_trafo.type} gives {_units(kinds)}",
            span=second_trafo.span, parameter=f"{second_trafo.prefix}.id", permitted="steps that fit", code="CB460",
        )  # fmt: skip
    text = f"KIN_TYP {second_trafo.type} takes the coordinates of KIN_TYP {first_trafo.type} as its axis values"
    hint = "joints are those of the second step, which no drive moves by itself"
    collector.add("CB459", text, span=second_trafo.span, hint=hint)
    axis_map = TwoStepMap(coordinates, second.axis_map, len(wanted), len(second.joints))
    return replace(
        second,
        kinematic=f"{first.kinematic} below {second.kinematic}",
        axes=first.axes,
        axis_map=axis_map.named([axis.name for axis in first.axes]),
        display=_outer(coordinates, second),
        drives=first.drives,
    )


def _outer(coordinates: Coordinates, second: Chain) -> Display:
    """Return what is displayed: what the outer step displays, its rotary axes being those that step 0 passes on."""
    display = second.display
    if display.kind == "axes" and coordinates.orientation == "axes":
        linear = by_rotary_axes(coordinates.chain.axes).solved
        return replace(display, solved=linear)
    kept = display.kind not in {"axes", "plane"} and not display.follows
    return replace(display, solved=(), keeps_side=False) if kept else POSE_ANGLES


def _coordinates(chain: Chain, trafo: Trafo) -> Coordinates:
    known = catalogue().get(trafo.type)
    if known is not None and known.orientation == "complete":
        return Coordinates(chain, "angles")
    if not is_rtcp(trafo):
        raise UnsupportedKinematicError(
            f"KIN_TYP {trafo.type} as a complete transformation cannot precede a second step", span=trafo.span,
            parameter=f"{trafo.prefix}.rtcp", permitted="1", code="CB460",
        )  # fmt: skip
    return Coordinates(chain, "axes")


def _units(kinds: tuple[AxisKind, ...]) -> str:
    return " ".join("mm" if kind == "linear" else "deg" for kind in kinds)


@dataclass(frozen=True, slots=True, eq=False)
class Coordinates:
    """The programmed coordinates of a kinematic as a function of its axis values, in channel order.

    Attributes:
        chain: The kinematic.
        orientation: "axes": position, then the axes behind the third as they are; "angles": position, then A, B, C.
    """

    chain: Chain
    orientation: Literal["axes", "angles"]

    @property
    def kinds(self) -> tuple[AxisKind, ...]:
        """What each coordinate is."""
        axes = self.chain.axes
        tail: list[AxisKind] = [axis.kind for axis in axes[_POSITION:]]
        if self.orientation == "angles" and tail:
            tail = ["rotary", "rotary", "rotary"]
        return ("linear", "linear", "linear", *tail)

    def values(self, axes: Vector) -> Vector:
        """Return the coordinates of axis values, mm and degrees on both sides."""
        T = pose(self.chain, axes)
        position = [mm_from_m(float(value)) for value in T[:3, 3]]
        if self.orientation == "axes":
            return np.array([*position, *axes[_POSITION:]])
        angles = frames.angles_from_matrix(self.chain.angle_mode, T[:3, :3])
        return np.array([*position, *angles][: len(self.kinds)])

    def derivative(self, axes: Vector) -> Matrix:
        """Return the derivative of the coordinates by the axes, SI by SI."""
        J = pose_jacobian(self.chain, axes)
        if self.orientation == "axes":
            tail = np.eye(len(axes))[_POSITION:]
            return np.vstack([J[:3], tail])
        if len(self.kinds) == _POSITION:
            return J[:3]
        mode = self.chain.angle_mode
        angles = frames.angles_from_matrix(mode, pose(self.chain, axes)[:3, :3])
        return np.vstack([J[:3], np.linalg.pinv(angle_rates(mode, angles)) @ J[3:]])


@dataclass(frozen=True, slots=True, eq=False)
class TwoStepMap:
    """Joint values of step 1 from the axis values of step 0.

    Attributes:
        coordinates: The coordinates that step 0 gives.
        second: The map of step 1.
        taken: How many of the coordinates step 1 takes.
        n_q: Number of joints.
    """

    coordinates: Coordinates
    second: AxisMap
    taken: int
    n_q: int

    def q(self, axes: Vector) -> Vector:
        """Return the joint values of axis values; not a number where step 0 has none."""
        if refusal_of(self.coordinates.chain.axis_map, axes) is not None:
            return np.full(self.n_q, np.nan)
        return self.second.q(self.coordinates.values(axes)[: self.taken])

    def axes(self, q: Vector) -> Vector:
        """Return the axis values of joint values, by Newton's method from the middle of the limits.

        Raises:
            ChainbuildError: step 0 does not reach the coordinates, or not from there.
        """
        chain = self.coordinates.chain
        factors = np.array([si_factor(axis.kind) for axis in chain.axes])
        scale = np.array([si_factor(kind) for kind in self.coordinates.kinds[: self.taken]])
        wanted = self.second.axes(q)
        # Off the middle by an odd share: an arm stretched out has no derivative to follow.
        values = np.array([axis.lower + 0.537 * (axis.upper - axis.lower) for axis in chain.axes])
        for _ in range(_NEWTON_STEPS):
            error = (wanted - self.coordinates.values(values)[: self.taken]) * scale
            if self.coordinates.orientation == "angles":  # axes that are passed on keep their turns
                rotary = scale == si_factor("rotary")
                error[rotary] = np.remainder(error[rotary] + np.pi, 2 * np.pi) - np.pi
            if float(np.abs(error).max()) < _CLOSE:
                return values
            J = self.coordinates.derivative(values)[: self.taken]
            values = values + (np.linalg.pinv(J, rcond=1e-9) @ error) / factors
        raise ChainbuildError("no axis values of the first transformation step found for these joint values")

    def refusal(self, axes: Vector) -> ChainbuildError | None:
        """Return why one of the steps has no joint values, or None."""
        first = refusal_of(self.coordinates.chain.axis_map, axes)
        return first or refusal_of(self.second, self.coordinates.values(axes)[: self.taken])

    def named(self, names: Sequence[str]) -> TwoStepMap:
        """Return the map that names the axes of the machine, and those that step 0 passes on, by other names."""
        coordinates = replace(self.coordinates, chain=renamed(self.coordinates.chain, names))
        if coordinates.orientation == "angles":
            return replace(self, coordinates=coordinates)
        passed_on = ("X", "Y", "Z", *names[_POSITION:])
        return replace(self, coordinates=coordinates, second=named_map(self.second, passed_on))

    def dq_daxes(self, axes: Vector) -> Matrix:
        """Return the derivative, SI by SI; 0 where step 0 has no joint values."""
        if refusal_of(self.coordinates.chain.axis_map, axes) is not None:
            return np.zeros((self.n_q, len(axes)))
        values = self.coordinates.values(axes)[: self.taken]
        return self.second.dq_daxes(values) @ self.coordinates.derivative(axes)[: self.taken]

    def q_bounds(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector]:
        """Return bounds of the joint values: step 0 reaches no farther than its lengths and strokes add up to."""
        chain = self.coordinates.chain
        bound = np.array([mm_from_m(reach(chain, *chain.axis_map.q_bounds(lower, upper)))] * _POSITION)
        turn = np.full(self.taken, 180.0)  # of as many angles as are taken at most
        ends = (lower[_POSITION:], upper[_POSITION:]) if self.coordinates.orientation == "axes" else (-turn, turn)
        below, above = np.concatenate([-bound, ends[0]]), np.concatenate([bound, ends[1]])
        return self.second.q_bounds(below[: self.taken], above[: self.taken])
