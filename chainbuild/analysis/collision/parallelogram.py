"""The limit angles of a parallelogram (MD62964): swept with its rods, compared with the file, and proposed.

ROBX manual 5.3.21 monitors one angle, q3DH − q2DH, which is a sum of axes 2 and 3. Here the arms, the rods and the
housing move as bodies, and the sweep finds the contact-free interval of that angle at each value of axis 2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.analysis.collision.paths import pair_weights
from chainbuild.analysis.collision.sweep import FreeInterval, free_interval
from chainbuild.arrays import Vector
from chainbuild.chain.bodies.geometry import Geometry
from chainbuild.chain.bodies.rods import CRANK, LEVEL_LINKS, ROD, ROD_END, ROD_PIN, has_rods, with_rods
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.elements import Chain
from chainbuild.chain.sums import AxisConstraint
from chainbuild.collision.model import CollisionModel, LinkPair
from chainbuild.errors import ChainbuildError
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.progress import Progress, counting
from chainbuild.shown import number, two_lines

_STEPS: Final = 37  # values of axis 2: every 5 degrees of a range of half a turn
_HALF_TURN: Final = 180.0  # degrees: a linkage moves half a turn of its crank between dead points
_REFINEMENTS: Final = 4  # halvings of a step: a sixteenth of it
# The file's limits count as too tight only if they waste more than this.
_CONSERVATIVE_DEG: Final = 0.5
_PRECISION_DEG: Final = 0.01  # what limits are proposed in, rounded inwards


@dataclass(frozen=True, slots=True)
class LimitReport:
    """Swept limits of the parallelogram's angle.

    Attributes:
        over: Name of axis 2, which is swept.
        moved: Name of axis 3, which moves.
        intervals: Free intervals of the angle [deg] over axis 2.
        given: Limits of the file [deg].
        proposal: Limits that hold at every value of axis 2 [deg], rounded inwards; None if there are none,
            or if bodies are wrong.
        blocked: Values of axis 2 without a free position.
        verdicts: Judgements of the file's limits, one sentence each.
        drawn: Links that decide the proposal and have default dimensions: then the limits are an estimate.
        touching: Pairs of links that touch at home, axes at 0 or else in the middle of their limits: bodies are wrong.
    """

    over: str
    moved: str
    intervals: tuple[FreeInterval, ...]
    given: tuple[float, float]
    proposal: tuple[float, float] | None
    blocked: tuple[float, ...]
    verdicts: tuple[str, ...]
    drawn: tuple[str, ...]
    touching: tuple[LinkPair, ...]

    def __repr__(self) -> str:
        given, free = (
            "none" if ends is None else f"{number(ends[0])} … {number(ends[1])} deg"
            for ends in (self.given, self.proposal)
        )
        return two_lines(
            f"<LimitReport {self.moved} over {self.over}: file {given}, proposal {free}; {'; '.join(self.verdicts)}>"
        )

    def machine_data(self) -> tuple[str, ...]:
        """Return the proposal as lines of machine data; none where bodies are wrong or not given."""
        if self.proposal is None or self.drawn:
            return ()
        return tuple(f"N62964 $MC_ROBX_SW_LIMITS_PARALLEL[{n}]={v:.2f}" for n, v in enumerate(self.proposal))


def swept_limits(robot: Mechanism, *, steps: int = _STEPS, progress: Progress = False) -> LimitReport:
    """Return the limits of a parallelogram's angle by sweeping its bodies.

    Args:
        robot: A robot whose chain limits a parallelogram's angle. Without rods in its overlay it gets default rods.
        steps: Number of values of axis 2 over its limits.
        progress: True: a bar on standard error; a function: called with the values done and all values.

    Raises:
        ChainbuildError: the chain has no such limit, or `steps` is below 2.
    """
    constraint = _constraint(robot.chain)
    if steps < 2:
        raise ChainbuildError("too few values of axis 2", parameter="steps", permitted="at least 2 values")
    geometry = robot.chain.geometry
    if not has_rods(robot.chain):
        robot = Mechanism(with_rods(robot.chain, geometry.rod_data))
    search = _Search(robot, constraint)
    values = np.linspace(*search.range_over, steps)
    found: dict[float, FreeInterval] = {}
    with counting(steps, progress, "positions") as advance:
        for value in sorted(values.tolist(), key=lambda v: abs(v - search.start_over)):
            found[value] = search.interval(value, found)
            advance(1)
    _refine(search, found)
    intervals = tuple(found[value] for value in sorted(found))
    given = (constraint.lower, constraint.upper)
    blocked = tuple(interval.over for interval in intervals if interval.lower is None)
    axes = robot.axes
    over, moved = axes[search.o].name, axes[search.m].name
    touching = search.touching_at_home()
    proposal = None if touching or blocked else _proposal(intervals)
    told = tuple(_touching_words(pair, search) for pair in touching)
    verdicts = told or _verdicts(intervals, given, proposal, over)
    drawn = _drawn_links(geometry, search.model, intervals)
    return LimitReport(over, moved, intervals, given, proposal, blocked, verdicts, drawn, touching)


def _constraint(chain: Chain) -> AxisConstraint:
    for constraint in chain.constraints:
        if sum(factor != 0.0 for factor in constraint.sum.coefficients) == 2:
            return constraint
    raise ChainbuildError(
        "the kinematic has no limits on a parallelogram's angle",
        permitted="ROBX data with $MC_ROBX_SPECIAL_KIN=2 (MD62964)",
        hint="`limits --axis A --over B` sweeps one axis of any machine over another",
    )


class _Search:
    """Finds free intervals of the angle at values of axis 2."""

    def __init__(self, robot: Mechanism, constraint: AxisConstraint) -> None:
        chain = robot.chain
        self.sum = constraint.sum
        elbow = next(joint.name for joint in chain.joints if joint.child == chain.frame(ROD_PIN).link)
        names = [axis.name for axis in chain.axes]
        driving = [n for n, factor in enumerate(self.sum.coefficients) if factor != 0.0]
        # Axis 3 has the elbow's name, the other axis of the sum is axis 2.
        self.m = next((n for n in driving if names[n] == elbow), driving[-1])
        self.o = next(n for n in driving if n != self.m)
        self.model = CollisionModel(robot, _arm_pairs(robot, self.m))
        lower, upper = shown_limits(chain)
        self.range_over = float(lower[self.o]), float(upper[self.o])
        self.base: Vector = (lower + upper) / 2.0
        self.start_over = float(self.base[self.o])
        self._crank_axis = next(joint.direction for joint in chain.joints if joint.name == CRANK)
        self._given = constraint.lower, constraint.upper
        self.middle = (constraint.lower + constraint.upper) / 2.0

    @property
    def home(self) -> Vector:
        """Axis values at 0, or in the middle of limits that exclude it; axis 3 where the angle is inside its limits."""
        lower, upper = shown_limits(self.model.robot.chain)
        home = np.where((lower <= 0.0) & (upper >= 0.0), 0.0, self.base)
        if not self._given[0] <= self.sum.value(home) <= self._given[1]:
            home[self.m] = self._moved(float(home[self.o]), self.middle)
        return np.asarray(home, dtype=float)

    def touching_at_home(self) -> tuple[LinkPair, ...]:
        """Return the pairs of links that touch at home."""
        found = zip(self.model.pairs, self.model.distances(self.home).tolist(), strict=True)
        return tuple(dict.fromkeys(self.model.links_of(pair) for pair, distance in found if distance <= 0.0))

    def interval(self, over: float, known: dict[float, FreeInterval]) -> FreeInterval:
        """Return the free interval of the angle [deg] at a value of axis 2, following its known neighbour."""
        middle = self.middle
        free = [i for i in known.values() if i.lower is not None]
        if free:
            near = min(free, key=lambda i: abs(i.over - over))
            middle = ((near.lower or 0.0) + (near.upper or 0.0)) / 2.0
        seed = self._moved(over, middle)
        found = free_interval(self.model, self.m, self.o, self.base, over, seed, self._dead_points(over))
        if found.lower is None or found.upper is None:
            return found
        ends = [(self._angle(over, found.lower), found.lower_pair), (self._angle(over, found.upper), found.upper_pair)]
        (low, below), (high, above) = sorted(ends, key=lambda end: end[0])
        return FreeInterval(over, low, high, below, above)

    def _dead_points(self, over: float) -> tuple[float, float]:
        """Return the values of axis 3 between which the linkage can move: at either end crank and rod are in line."""
        middle = self._moved(over, self.middle)
        at, beyond = self._crank_angle(over, middle), self._crank_angle(over, middle + 1.0)
        sense = 1.0 if (beyond - at + _HALF_TURN) % (2.0 * _HALF_TURN) > _HALF_TURN else -1.0
        past = at % _HALF_TURN
        ends = middle - sense * past, middle + sense * (_HALF_TURN - past)
        return min(ends), max(ends)

    def _crank_angle(self, over: float, moved: float) -> float:
        """Return the angle from the crank to the rod about the crank's axis [deg]."""
        axes = self.base.copy()
        axes[self.o], axes[self.m] = over, moved
        places = self.model.robot.frame_placements(axes)
        about = places[CRANK].rotation @ self._crank_axis
        crank = places[ROD].translation - places[CRANK].translation
        rod = places[ROD_END].translation - places[ROD].translation
        crank, rod = crank - about * (about @ crank), rod - about * (about @ rod)
        return math.degrees(math.atan2(float(about @ np.cross(crank, rod)), float(crank @ rod)))

    def _angle(self, over: float, moved: float) -> float:
        axes = self.base.copy()
        axes[self.o], axes[self.m] = over, moved
        return self.sum.value(axes)

    def _moved(self, over: float, angle: float) -> float:
        return (angle - self._angle(over, 0.0)) / self.sum.coefficients[self.m]


def _arm_pairs(robot: Mechanism, moved: int) -> list[LinkPair]:
    """Return the pairs of housing, column, arms and rods that an axis moves against one another.

    Links that the forearm carries are not part of the parallelogram; its angle cannot separate pairs that axis 3 does
    not move.
    """
    chain = robot.chain
    carrier = {joint.child: joint.parent for joint in chain.joints}
    links = [chain.frame(ROD_PIN).link, f"{CRANK}_link", f"{ROD}_link"]
    link = links[0]
    while link in carrier:
        link = carrier[link]
        if link not in LEVEL_LINKS:
            links.append(link)
    model = CollisionModel(robot)
    rates = pair_weights(model, np.ones(len(chain.joints))) @ np.abs(chain.axis_map.dq_daxes(np.zeros(len(chain.axes))))
    pairs = [model.links_of(pair) for pair, rate in zip(model.pairs, rates[:, moved], strict=True) if rate > 0.0]
    return [pair for pair in dict.fromkeys(pairs) if set(pair) <= set(links)]


def _refine(search: _Search, found: dict[float, FreeInterval]) -> None:
    """Halve the steps around the values that decide the proposal."""
    for _ in range(_REFINEMENTS):
        free = [i for i in found.values() if i.lower is not None]
        if not free:
            return
        worst = [max(free, key=lambda i: i.lower or 0.0).over, min(free, key=lambda i: i.upper or 0.0).over]
        values = sorted(found)
        for value in worst:
            n = values.index(value)
            for other in values[max(n - 1, 0) : n + 2]:
                middle = (value + other) / 2.0
                if middle not in found:
                    found[middle] = search.interval(middle, found)


def _proposal(intervals: tuple[FreeInterval, ...]) -> tuple[float, float] | None:
    free = [(i.lower, i.upper) for i in intervals if i.lower is not None and i.upper is not None]
    if not free:
        return None
    lower = math.ceil(max(low for low, _ in free) / _PRECISION_DEG - 1e-9) * _PRECISION_DEG
    upper = math.floor(min(high for _, high in free) / _PRECISION_DEG + 1e-9) * _PRECISION_DEG
    return (round(lower, 2), round(upper, 2)) if lower < upper else None


def _touching_words(pair: LinkPair, search: _Search) -> str:
    home, axes = search.home, search.model.robot.axes
    at = ", ".join(f"{axes[n].name} = {home[n]:.4g}°" for n in (search.o, search.m))
    return f"{pair[0]} and {pair[1]} touch at home ({at}): the bodies are wrong; set them in [geometry] of the overlay"


def _drawn_links(geometry: Geometry, model: CollisionModel, intervals: tuple[FreeInterval, ...]) -> tuple[str, ...]:
    """Return the links that end any free interval and whose dimensions the overlay does not give."""
    pairs = [pair for interval in intervals for pair in (interval.lower_pair, interval.upper_pair) if pair]
    rods = (f"{CRANK}_link", f"{ROD}_link") if geometry.rod_data.crank and geometry.rod_data.radius else ()
    known = {*geometry.shapes, *geometry.radii, *rods}
    link_of = {solid.name: solid.link for solid in model.solids}
    return tuple(link for link in dict.fromkeys(link_of[name] for pair in pairs for name in pair) if link not in known)


def _verdicts(
    intervals: tuple[FreeInterval, ...], given: tuple[float, float], proposal: tuple[float, float] | None, over: str
) -> tuple[str, ...]:
    said = []
    free = [i for i in intervals if i.lower is not None and i.upper is not None]
    low = max(free, key=lambda i: i.lower or 0.0, default=None)
    high = min(free, key=lambda i: i.upper or 0.0, default=None)
    if low is not None and low.lower is not None and given[0] < low.lower - _PRECISION_DEG:
        said.append(_too_wide("lower", given[0], low.lower, low.over, low.lower_pair, over))
    if high is not None and high.upper is not None and given[1] > high.upper + _PRECISION_DEG:
        said.append(_too_wide("upper", given[1], high.upper, high.over, high.upper_pair, over))
    if proposal is not None:
        for name, wasted in (("lower", given[0] - proposal[0]), ("upper", proposal[1] - given[1])):
            if wasted > _CONSERVATIVE_DEG:
                said.append(f"the {name} limit is too tight: {wasted:.1f}° of the free angle are lost")
    if not free:
        return ("no position is free: the bodies overlap everywhere; set radii or shapes in the overlay",)
    blocked = [i.over for i in intervals if i.lower is None]
    if blocked:
        values = " … ".join(f"{value:.4g}°" for value in dict.fromkeys((min(blocked), max(blocked))))
        said.append(
            f"no angle is free at {over} = {values}: the limits of {over} are too wide, or the bodies are wrong"
        )
    return tuple(said) or ("the limits are right",)


def _too_wide(side: str, given: float, end: float, at: float, pair: LinkPair | None, over: str) -> str:
    touching = f"{pair[0]} and {pair[1]} touch" if pair else "the linkage reaches its dead point"
    return f"the {side} limit {given:g}° is too wide: at {over} = {at:.4g}° {touching} at {end:.2f}°"
