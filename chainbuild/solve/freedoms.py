"""The box a solver searches in: limits, whole turns, random starts, a bound on the reach."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.elements import Chain

if TYPE_CHECKING:
    import pinocchio as pin

    from chainbuild.robot.robot import Robot

Vector = NDArray[np.float64]

_ENDLESS_START = math.pi  # random starts of axes without end are drawn from ± this
_START_STAGGER = 0.07  # default start: the middle of the limits, moved by this share so that no two axes line up
_INSIDE_SLACK = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class Box:
    """Limits of some axes in SI.

    Attributes:
        lower: (n,) lower limits, -inf where endless.
        upper: (n,) upper limits, +inf where endless.
        periodic: (n,) True where a whole turn leads to the same pose.
        names: Axis names.
    """

    lower: Vector
    upper: Vector
    periodic: NDArray[np.bool_]
    names: tuple[str, ...]

    def into(self, y: Vector) -> Vector:
        """Return y with periodic axes outside their limits moved by whole turns to the nearest place inside."""
        outside = self.periodic & ((y < self.lower) | (y > self.upper))
        if not outside.any():
            return y
        y = y.copy()
        for n in np.flatnonzero(outside):
            bound = self.lower[n] if y[n] < self.lower[n] else self.upper[n]
            turns = math.ceil(abs(bound - y[n]) / math.tau)
            moved = y[n] + math.copysign(turns * math.tau, bound - y[n])
            if self.lower[n] <= moved <= self.upper[n]:
                y[n] = moved
        return y

    def clamp(self, y: Vector) -> Vector:
        """Return y cut to the limits."""
        return np.minimum(np.maximum(y, self.lower), self.upper)

    def inside(self, y: Vector) -> bool:
        """Return whether y keeps the limits."""
        return bool(((y >= self.lower - _INSIDE_SLACK) & (y <= self.upper + _INSIDE_SLACK)).all())

    def names_outside(self, y: Vector) -> list[str]:
        """Return the names of the axes whose limits y violates."""
        outside = (y < self.lower - _INSIDE_SLACK) | (y > self.upper + _INSIDE_SLACK)
        return [name for name, out in zip(self.names, outside, strict=True) if out]

    def nearest(self, y: Vector, wanted: Vector) -> Vector:
        """Return y with periodic axes moved by whole turns as near as the limits allow to `wanted`."""
        y = y.copy()
        for n in np.flatnonzero(self.periodic):
            turns = round((wanted[n] - y[n]) / math.tau)
            step = 1 if turns < 0 else -1
            while turns and not self.lower[n] <= y[n] + turns * math.tau <= self.upper[n]:
                turns += step
            y[n] += turns * math.tau
        return y

    def random(self, rng: np.random.Generator) -> Vector:
        """Return a random point inside the limits."""
        lower = np.where(np.isfinite(self.lower), self.lower, -_ENDLESS_START)
        upper = np.where(np.isfinite(self.upper), self.upper, _ENDLESS_START)
        point: Vector = lower + (upper - lower) * rng.random(len(lower))
        return point


@dataclass(frozen=True, slots=True, eq=False)
class Freedoms:
    """What a robot's axes may do, prepared once a robot.

    Attributes:
        box: Limits of all axes.
        middle: (n_axes,) the default start [SI].
        si_factors: (n_axes,) mm and degrees to SI.
        reach: Bound on the distance between the origins of workpiece and tool frame [m].
    """

    box: Box
    middle: Vector
    si_factors: Vector
    reach: float

    def within(self, free: NDArray[np.intp]) -> Box:
        """Return the box of some axes."""
        if len(free) == len(self.box.lower):
            return self.box
        names = tuple(self.box.names[n] for n in free)
        return Box(self.box.lower[free], self.box.upper[free], self.box.periodic[free], names)

    def out_of_reach(self, target: pin.SE3) -> str:
        """Return why a target is certainly too far away, or an empty string."""
        distance = float(np.linalg.norm(target.translation))
        if distance <= self.reach:
            return ""
        reach = f"the kinematic reaches {self.reach * 1000:.1f} mm"
        return f"too far: {distance * 1000:.1f} mm from the workpiece frame, {reach}"


_prepared: WeakKeyDictionary[Robot, Freedoms] = WeakKeyDictionary()


def freedoms_of(robot: Robot) -> Freedoms:
    """Return the freedoms of a robot, prepared at first use."""
    found = _prepared.get(robot)
    if found is None:
        found = _prepared[robot] = _prepare(robot)
    return found


def _prepare(robot: Robot) -> Freedoms:
    axes = robot.axes
    factors = robot.kinematics.si_factors
    lower = np.array([-math.inf if a.endless else a.lower for a in axes]) * factors
    upper = np.array([math.inf if a.endless else a.upper for a in axes]) * factors
    box = Box(lower, upper, periodic_axes(robot.chain), tuple(a.name for a in axes))
    span_low = np.where(np.isfinite(lower), lower, -_ENDLESS_START)
    span_high = np.where(np.isfinite(upper), upper, _ENDLESS_START)
    stagger = _START_STAGGER * np.where(np.arange(len(axes)) % 2 == 0, 1.0, -1.0)
    middle = (span_low + span_high) / 2.0 + stagger * np.minimum(span_high - span_low, math.tau)
    return Freedoms(box, middle, factors, _reach(robot))


def periodic_axes(chain: Chain) -> NDArray[np.bool_]:
    """Return for each axis whether a whole turn of it leads to the same pose.

    True where the axis turns revolute joints only, each by a whole number of turns.
    """
    if not isinstance(chain.axis_map, AffineMap):
        periodic = getattr(chain.axis_map, "periodic", ())
        return np.array([axis.name in periodic for axis in chain.axes])
    A = chain.axis_map.A
    revolute = np.array([joint.kind == "revolute" for joint in chain.joints])
    result = np.zeros(len(chain.axes), dtype=bool)
    for n, axis in enumerate(chain.axes):
        moved = A[:, n] != 0.0
        whole = np.abs(A[:, n] - np.round(A[:, n])) < _INSIDE_SLACK
        result[n] = axis.kind == "rotary" and bool((revolute[moved] & whole[moved]).all())
    return result


def _reach(robot: Robot) -> float:
    """Return the sum of all fixed offsets and linear ranges between workpiece and tool frame [m]."""
    chain = robot.chain
    total = sum(float(np.linalg.norm(chain.frame(tip).T_link_frame[:3, 3])) for tip in ("tool", "workpiece"))
    lower, upper = robot.model.lowerPositionLimit, robot.model.upperPositionLimit
    for n, joint in enumerate(chain.joints):
        total += float(np.linalg.norm(joint.T_parent_joint[:3, 3]))
        if joint.kind == "prismatic":
            total += max(abs(float(lower[n])), abs(float(upper[n])))
    return total * (1.0 + 1e-9) + 1e-9
