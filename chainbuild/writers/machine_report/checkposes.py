"""Ten positions to drive to before a transformation is switched on: safe, apart, and each axis moved alone.

A first position is sought from which every axis can be moved both ways; each axis is then moved alone, and further
positions move all of them, each to the side on which it was not yet. All are whole degrees and millimetres, inside all
limits, away from singular positions and from bodies, above the floor of a machine that stands on it, and so are the
straight ways of the axes from home and from the first position.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.analysis.collision.paths import first_contact
from chainbuild.analysis.singularity.locks import notices
from chainbuild.analysis.singularity.measures import measure_batch, smallest_value
from chainbuild.chain.axismap import AffineMap, random_axis_values
from chainbuild.chain.bodies.rods import has_rods
from chainbuild.chain.bodies.shapes import machine_size, shown_limits
from chainbuild.chain.elements import BASE_LINK
from chainbuild.chain.poses import link_placements
from chainbuild.closest import and_joined
from chainbuild.collision.model import bodies_of
from chainbuild.drawing.site import home_of
from chainbuild.errors import ChainbuildError
from chainbuild.shown import fields_shown

if TYPE_CHECKING:
    from chainbuild.arrays import Matrix, Vector
    from chainbuild.collision.model import CollisionModel
    from chainbuild.collision.solids import Solid
    from chainbuild.kinematics.mechanism import Mechanism

_BEGINNINGS: Final = 4  # tried where an axis cannot be moved both ways
_COUNT: Final = 10  # fit on a page
_MORE: Final = 3  # beside those that move one axis each: machines of many axes get more than ten
_SMALLEST: Final = 0.06  # smallest scaled singular value: a little above where singularities are named, 0.05
_GOOD: Final = 0.2  # above which a position gains nothing by it
_CLEARANCE: Final = 0.01  # share of the machine's size between bodies, but at most
_WIDEST: Final = 0.02  # m
_FLAT: Final = 1e-6  # m: what stands on the floor is not below it
_NEIGHBOURS: Final = 40  # positions by which bodies that are never farther apart are told
_EDGE: Final = 0.05  # share of an axis' range kept free at its ends
_SEED: Final = 4  # any: the same machine gives the same poses
# Positions among which the first is chosen, how many of the best of them are looked at for collisions, which share of
# its usual step an axis has left to both sides, and what a way of all axes over their whole ranges costs, as a share of
# what a good singular value gains.
_NEAR_HOME: Final = (600, 60, 1.0, 2.0)
_ANYWHERE: Final = (600, 60, 1.0, 0.0)
_THOROUGH: Final = (2500, 2500, 0.2, 2.0)
# Which shares of the axes go to the side they went to before, and which share moves at all, in the order tried.
_MIXES: Final = ((0.0, 1.0), (0.25, 1.0), (0.5, 1.0), (0.2, 0.5), (0.0, 0.25))
_TRIED: Final = 60  # of positions that move all axes, looked at for collisions
_SHARES: Final = (1.0, 0.6, 0.3, 1.6, 0.15)  # of the usual step of an axis, in the order in which they are tried
_USUAL: Final = {"rotary": 30.0, "linear": 100.0}  # degrees, mm: seen well, and no long way
_SHORT: Final = 0.25  # of an axis' range: the usual step at most
_FINE: Final = 20.0  # steps of whole degrees or mm in a range below which tenths are taken
_ROUND: Final = 5.0  # the first position stands at multiples of this many steps
_SAMPLES: Final = 24  # positions of a way looked at for the floor, and for the rest where an axis map is not affine
_SCORE_PLACES: Final = 3  # of a score: the last bit must not decide between two positions


@dataclass(frozen=True, slots=True, eq=False)
class CheckPose:
    """A position.

    Attributes:
        axes: (n_axes,) axis values, mm and degrees.
        moved: Index of the axis that alone stands elsewhere than in the first pose; None: several do, or none.
    """

    __repr__ = fields_shown

    axes: Vector
    moved: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class CheckPoses:
    """The positions of a form.

    Attributes:
        poses: The positions, the first one first; none where nothing safe was found.
        wanted: How many there should be.
        home: (n_axes,) the home position from which all of them are reached on straight ways; None: they are not.
        reason: Why they are not reached from home; else empty.
        watched: Links between which collisions were looked for; none: the data place no two bodies that could touch.
        floor: Height in the base [m] below which nothing comes; None: nobody knows where the floor is.
    """

    __repr__ = fields_shown

    poses: tuple[CheckPose, ...]
    wanted: int
    home: Vector | None
    reason: str = ""
    watched: tuple[str, ...] = ()
    floor: float | None = None


def check_poses(robot: Mechanism) -> CheckPoses:
    """Return positions to compare with the control, the same for the same robot."""
    wanted = max(_COUNT, len(robot.axes) + _MORE)
    search = _Search(robot)
    home, reason = search.home()
    best = search.best(home, wanted)
    if not best and home is not None:
        home, reason = None, "no straight way of the axes leads from there to a safe position"
        best = search.best(None, wanted)
    seen = {link for pair in search.bodies.pairs_by_link() for link in pair}
    watched = tuple(link for link in (BASE_LINK, *(joint.child for joint in robot.chain.joints)) if link in seen)
    return CheckPoses(tuple(best), wanted, home, reason, watched, search.floor.height)


def moved_both_ways(poses: Sequence[CheckPose]) -> NDArray[np.bool_]:
    """Return (n_axes,) which axes stand both above and below their values in the first position."""
    rows = np.array([pose.axes for pose in poses])
    both: NDArray[np.bool_] = (rows > rows[0]).any(axis=0) & (rows < rows[0]).any(axis=0)
    return both


class _Floor:
    """The plane below which nothing comes: the base's, or that which a machine that hangs reaches at home.

    Attributes:
        height: Its height in the base [m]; None: the base has no body, and nobody knows where the floor is.
    """

    def __init__(self, robot: Mechanism, bodies: CollisionModel) -> None:
        self.chain = robot.chain
        # What turns on the base stays where it is.
        still = {BASE_LINK, *(joint.child for joint in robot.chain.joints if joint.parent == BASE_LINK)}
        self.moving = [(solid.link, *_points(solid)) for solid in bodies.solids if solid.link not in still]
        home = home_of(robot.chain)
        stands = any(solid.link == BASE_LINK for solid in bodies.solids)
        self.height = min(0.0, 0.0 if home is None else self.lowest(home)) if stands else None

    def lowest(self, axes: Vector) -> float:
        """Return the height [m] in the base of the lowest point of the bodies that move, or of the tool."""
        links = link_placements(self.chain, self.chain.axis_map.q(axes))
        tool = self.chain.frame("tool")
        moving = [points @ links[link][2] - radius for link, points, radius in self.moving]
        return float(np.concatenate([[(links[tool.link] @ tool.T_link_frame)[2, 3]], *moving]).min())

    def clear(self, rows: Matrix) -> bool:
        """Return whether nothing comes below it at positions (n, n_axes)."""
        return self.height is None or all(self.lowest(row) >= self.height - _FLAT for row in rows)


def _points(solid: Solid) -> tuple[Matrix, float]:
    """Return points (n, 4) and a radius [m] about them that hold a body, in the axes of its link, with ones behind."""
    solid.geometry.computeLocalAABB()
    box, radius = solid.geometry.aabb_local, 0.0
    sides = np.array([box.min_, box.max_])
    if solid.kind == "capsule":
        radius = solid.size[0]
        sides = np.array([0.0, 0.0, solid.size[1] / 2.0]) * [[-1.0], [1.0]]
    picked = np.array([[sides[i, 0], sides[j, 1], sides[k, 2], 1.0] for i, j, k in np.ndindex(2, 2, 2)])
    return picked @ solid.T_link_solid.T, radius


class _Search:
    """What counts as safe, and the search for such positions."""

    def __init__(self, robot: Mechanism) -> None:
        self.robot = robot
        self.bodies = bodies_of(robot, None)
        self.floor = _Floor(robot, self.bodies)
        lower, upper = shown_limits(robot.chain)
        self.clearance = self._clearances(lower, upper)
        self.range = upper - lower
        self.low, self.high = lower + _EDGE * self.range, upper - _EDGE * self.range
        kinds = [axis.kind for axis in robot.axes]
        coarse = np.array([10.0 ** min(0, math.floor(math.log10(span / _FINE))) for span in self.range])
        self.unit = np.where(self.range > 0.0, coarse, 1.0)
        usual = np.minimum([_USUAL[kind] for kind in kinds], _SHORT * self.range)
        self.usual = np.maximum(np.floor(usual / self.unit), 1.0) * self.unit
        self.rng = np.random.default_rng(_SEED)

    def _clearances(self, lower: Vector, upper: Vector) -> Vector:
        """Return the distance (n_pairs,) [m] to keep between the bodies of each pair: less between close neighbours."""
        usual = min(_CLEARANCE * machine_size(self.robot.chain), _WIDEST)
        rows = random_axis_values(self.robot.chain.axis_map, np.random.default_rng(_SEED), lower, upper, _NEIGHBOURS)
        most = np.max([self.bodies.distances(row) for row in rows], axis=0) if self.bodies.pairs else np.zeros(0)
        return np.clip(most / 2.0, 0.0, usual)

    def home(self) -> tuple[Vector | None, str]:
        """Return home where it is inside the limits and free of collisions; else None, and what is wrong with it."""
        home = home_of(self.robot.chain)
        if home is None:
            return None, "the machine has no pose there"
        if violated := self.robot.violated_limits(home):
            return None, f"it violates the limits of {and_joined(violated)}"
        if touching := self.bodies.colliding_pairs(home):
            return None, f"{and_joined(touching[0])} touch there, as their bodies are assumed"
        return home, ""

    def best(self, home: Vector | None, wanted: int) -> list[CheckPose]:
        """Return the positions that move the most axes both ways, of some to begin with; none where none is safe."""
        best: tuple[int, list[CheckPose]] = (-1, [])
        for first in self.firsts(home):
            starts = [first] if home is None else [first, home]
            poses = [CheckPose(first), *self.single(first, starts)]
            known = [pose.axes for pose in poses]
            poses += [CheckPose(axes) for axes in self.together(first, known, starts, wanted - len(poses))]
            value = len(poses) + int(moved_both_ways(poses).sum())
            if value > best[0]:
                best = value, poses
            if value >= wanted + len(first):
                break
        return best[1]

    def firsts(self, home: Vector | None) -> Iterator[Vector]:
        """Yield positions to begin with, the best first: far from singular positions, not far from home."""
        missing = True
        for how in (_NEAR_HOME, _ANYWHERE):
            for axes in islice(self._firsts(home, *how), _BEGINNINGS):
                missing = False
                yield axes
        if missing:
            yield from islice(self._firsts(home, *_THOROUGH), _BEGINNINGS)

    def _firsts(self, home: Vector | None, count: int, tried: int, room: float, far: float) -> Iterator[Vector]:
        robot = self.robot
        middle = home_of(robot.chain) if home is None else home
        if middle is None:
            middle = (self.low + self.high) / 2.0
        drawn = random_axis_values(robot.chain.axis_map, self.rng, self.low, self.high, count)
        share = self.rng.uniform(0.0, 1.0, drawn.shape)
        share[::2] **= 2  # some near home, some anywhere
        share[::3] = 1.0
        rows = middle + share * (drawn - middle)
        rows = np.clip(rows, self.low + room * self.usual, self.high - room * self.usual)
        step = np.where(self.range / self.unit > _FINE * _ROUND, _ROUND, 1.0) * self.unit
        rows = self._candidates(self._rounded(rows, step))
        if not len(rows):
            return
        smallest = measure_batch(robot, rows).smallest
        span = np.where(self.range > 0.0, self.range, 1.0)
        score = np.minimum(smallest / _GOOD, 1.0) - far * (np.abs(rows - middle) / span).mean(axis=1)
        order = np.argsort(-score.round(_SCORE_PLACES), kind="stable")
        for n in order[:tried].tolist():
            if self._safe(rows[n]) and (home is None or self._free(home, rows[n])):
                yield np.asarray(rows[n])

    def single(self, first: Vector, starts: list[Vector]) -> Iterator[CheckPose]:
        """Yield for every axis the position in which it alone stands elsewhere than in the first one."""
        for n in range(len(first)):
            sign = 1.0 if n % 2 == 0 else -1.0
            for share in _SHARES:
                found = next(filter(lambda axes: self._reached(axes, starts), self._moved(first, n, share, sign)), None)
                if found is not None:
                    yield CheckPose(found, n)
                    break

    def _moved(self, first: Vector, n: int, share: float, sign: float) -> Iterator[Vector]:
        for side in (sign, -sign):
            axes = first.copy()
            steps = max(1.0, round(share * float(self.usual[n] / self.unit[n])))
            axes[n] = round(float(axes[n] + side * steps * self.unit[n]), 9) + 0.0
            if self.low[n] <= axes[n] <= self.high[n]:
                yield axes

    def together(self, first: Vector, known: list[Vector], starts: list[Vector], count: int) -> Iterator[Vector]:
        """Yield positions in which all axes stand elsewhere, first of all where they did not stand yet."""
        found = list(known)
        for _ in range(count):
            axes = self._next(first, found, starts)
            if axes is None:
                return
            found.append(axes)
            yield axes

    def _next(self, first: Vector, found: list[Vector], starts: list[Vector]) -> Vector | None:
        sides = np.array([np.sign(axes - first) for axes in found])
        # The side on which an axis stood less often.
        rarer = np.where((sides > 0.0).sum(axis=0) <= (sides < 0.0).sum(axis=0), 1.0, -1.0)
        for flips, share in _MIXES:
            flipped = self.rng.uniform(0.0, 1.0, (_TRIED, len(first))) < flips
            moving = self.rng.uniform(0.0, 1.0, (_TRIED, len(first))) < share
            signs = np.where(flipped, -rarer, rarer) * moving
            steps = np.round(self.rng.uniform(0.4, 1.3, signs.shape) * self.usual / self.unit)
            rows = self._rounded(first + signs * np.maximum(steps, 1.0) * self.unit, self.unit)
            for axes in self._candidates(rows):
                if not any((axes == one).all() for one in found) and self._reached(axes, starts):
                    return np.asarray(axes)
        return None

    def _rounded(self, rows: Matrix, step: Vector) -> Matrix:
        rounded: Matrix = np.round(np.round(rows / step) * step, 9) + 0.0
        return rounded

    def _candidates(self, rows: Matrix) -> Matrix:
        """Return those of positions that are inside the limits, have a pose and are not close to a singular one."""
        inside = ((rows >= self.low) & (rows <= self.high)).all(axis=1) & self.robot.limits.inside_rows(rows)
        rows = rows[inside]
        if not isinstance(self.robot.chain.axis_map, AffineMap):
            rows = rows[[bool(np.isfinite(self.robot.chain.axis_map.q(row)).all()) for row in rows]]
        if not len(rows):
            return rows
        kept: Matrix = rows[measure_batch(self.robot, rows).smallest >= _SMALLEST]
        return kept

    def _reached(self, axes: Vector, starts: list[Vector]) -> bool:
        return self._safe(axes) and all(self._free(start, axes) for start in starts)

    def _safe(self, axes: Vector) -> bool:
        """Return whether a position is inside all limits, shown unambiguously, not singular, and clear of bodies."""
        robot = self.robot
        if not self.floor.clear(axes[None, :]):
            return False
        if self.bodies.pairs and not (self.bodies.distances(axes) > self.clearance).all():
            return False
        try:
            if robot.violated_limits(axes) or not smallest_value(robot, axes) >= _SMALLEST:
                return False
            robot.drives(axes)
            # Angles that turn about the same line may be shown in more than one way.
            shown = robot.chain.display.kind == "angles" or has_rods(robot.chain)
            if shown and any(True for _ in notices(robot, axes)):
                return False
        except ChainbuildError:
            return False
        return True

    def _free(self, start: Vector, end: Vector) -> bool:
        """Return whether all axes can move straight from one position to another, inside the limits."""
        rows = start + np.linspace(0.0, 1.0, _SAMPLES)[:, None] * (end - start)
        if not self.floor.clear(rows):
            return False
        if isinstance(self.robot.chain.axis_map, AffineMap) and not self.robot.limits.curved:
            # Limits on axes and sums of them hold between two positions where they hold at both.
            return first_contact(self.robot, np.array([start, end]), bodies=self.bodies) is None
        if not self.robot.limits.inside_rows(rows).all():
            return False
        closed = all(np.isfinite(self.robot.chain.axis_map.q(row)).all() for row in rows)
        return closed and not any(self.bodies.collides(row) for row in rows)
