"""Self-collision of a robot on coal: booleans, pairs, distances with witness points.

The only module that queries coal. Links that a joint connects never count as colliding, nor do pairs that touch
at every position: the bodies are drawn so that they overlap there.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from threading import local
from typing import Any, Final, TypeAlias

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from chainbuild.arrays import Vector
from chainbuild.chain.axismap import random_axis_values
from chainbuild.chain.bodies.rods import pinned_links
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.elements import BASE_LINK
from chainbuild.collision.solids import solids_of
from chainbuild.errors import ChainbuildError
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.shown import length_shown, two_lines

LinkPair: TypeAlias = tuple[str, str]

_PROBES: Final = 64  # positions at which a pair must touch to count as always touching
_SEED: Final = 11  # any: the same pairs are watched every time


@dataclass(frozen=True, slots=True, eq=False)
class Distance:
    """The distance between two bodies.

    Attributes:
        pair: Names of the bodies.
        distance: [m]; negative: how deep they overlap.
        points: (2, 3) the nearest points, first body's first, in the base frame [m].
    """

    pair: LinkPair
    distance: float
    points: NDArray[np.float64]

    def __repr__(self) -> str:
        how = "apart" if self.distance >= 0.0 else "deep in one another"
        return two_lines(f"<Distance {' – '.join(self.pair)}: {length_shown(abs(self.distance))} {how}>")


class _Scratch(local):
    """Working memory of coal and Pinocchio, one for each thread.

    Attributes:
        found: The results of the last query.
        parts: Arguments of a query: model, data, bodies, results.
        around: Likewise with meshes in their hulls; None: there is no mesh.
    """

    def __init__(self, model: pin.Model, bodies: pin.GeometryModel, hulls: pin.GeometryModel | None) -> None:
        self.found = pin.GeometryData(bodies)
        self.parts = model, model.createData(), bodies, self.found
        self.around = None if hulls is None else (model, self.parts[1], hulls, pin.GeometryData(hulls))


class CollisionModel:
    """The bodies of a robot and the watched pairs. Threads may share it; it pickles as its robot and pairs.

    Args:
        robot: The robot.
        watched: Pairs of links to check; None: all but links that a joint connects, those that the overlay
            ignores, and those that touch at every position.

    Attributes:
        robot: The robot.
        solids: Its bodies.
        pairs: The pairs watched, by index of the bodies.
        always: Pairs of links left out because they touch at every position probed.

    Raises:
        FileAccessError: a mesh cannot be read or makes no body; see `solids_of`.
        ChainbuildError: a watched link does not exist.
    """

    def __init__(self, robot: Mechanism, watched: Iterable[LinkPair] | None = None) -> None:
        self.robot = robot
        self._given = None if watched is None else tuple(watched)
        self._shape = (len(robot.axes),)
        self.solids = solids_of(robot.chain)
        self._joint_of = {BASE_LINK: 0} | {joint.child: n + 1 for n, joint in enumerate(robot.chain.joints)}
        self.always: tuple[LinkPair, ...] = ()
        if self._given is not None:
            self._watch(self._chosen(self._given))
            return
        self._watch(self._possible())
        self.always = self._touching_everywhere()
        touching = {frozenset(pair) for pair in self.always}
        self._watch([pair for pair in self.pairs if frozenset(self.links_of(pair)) not in touching])

    def __repr__(self) -> str:
        left_out = f", {len(self.always)} left out" if self.always else ""
        counts = f"{len(self.solids)} bodies, {len(self.pairs)} pairs watched{left_out}"
        return two_lines(f"<CollisionModel of {self.robot.name}: {counts}>")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.robot, self._given)

    def links_of(self, pair: tuple[int, int]) -> LinkPair:
        """Return the links of a pair of bodies."""
        return self.solids[pair[0]].link, self.solids[pair[1]].link

    def pairs_by_link(self) -> tuple[LinkPair, ...]:
        """Return the pairs of links that are watched, each once."""
        return tuple(dict.fromkeys(self.links_of(pair) for pair in self.pairs))

    def collides(self, axes: ArrayLike) -> bool:
        """Return whether any watched pair touches at axis values (n_axes,), mm and degrees."""
        scratch = self._scratch
        return bool(pin.computeCollisions(*scratch.parts, self._q(axes), True))

    def colliding_pairs(self, axes: ArrayLike) -> tuple[LinkPair, ...]:
        """Return the names of the watched pairs of bodies that touch."""
        scratch = self._scratch
        pin.computeCollisions(*scratch.parts, self._q(axes), False)
        results = scratch.found.collisionResults
        return tuple(self._names(n) for n in range(len(self.pairs)) if results[n].isCollision())

    def touching_at_home(self) -> tuple[LinkPair, ...]:
        """Return the watched pairs of links that touch with every axis at 0, or at the limit next to it."""
        lower, upper = shown_limits(self.robot.chain)
        found = zip(self.pairs, self.distances(np.clip(0.0, lower, upper)).tolist(), strict=True)
        return tuple(dict.fromkeys(self.links_of(pair) for pair, distance in found if distance <= 0.0))

    def nearest(self, axes: ArrayLike) -> Distance | None:
        """Return the smallest distance of all watched pairs; None where none is watched."""
        if not self.pairs:
            return None
        return self._distance(self._nearest_pair(self._q(axes)))

    def smallest_at(self, q: Vector) -> float:
        """Return the smallest distance [m] at joint values (n_q,), SI: the fastest query; inf without a pair."""
        if not self.pairs:
            return math.inf
        best = self._nearest_pair(q)
        return float(self._scratch.found.distanceResults[best].min_distance)

    def distances(self, axes: ArrayLike) -> Vector:
        """Return the distances (n_pairs,) [m] of all watched pairs, in the order of `pairs`.

        Those of two capsules have a closed form. coal iterates for other bodies, from where its last query ended, and
        stops within 1e-6 m: the same axes may give distances that differ by that order.
        """
        scratch = self._scratch
        pin.computeDistances(*scratch.parts, self._q(axes))
        return np.array([result.min_distance for result in scratch.found.distanceResults])

    def distance_table(self, axes: ArrayLike) -> tuple[Distance, ...]:
        """Return all watched pairs with their distances and nearest points, the smallest first."""
        self.distances(axes)
        return tuple(sorted((self._distance(n) for n in range(len(self.pairs))), key=lambda d: d.distance))

    def _q(self, axes: ArrayLike) -> Vector:
        values = np.asarray(axes, dtype=float)
        if values.shape != self._shape or not math.isfinite(values.sum()):
            return self.robot.q(axes)  # raises the reason
        return self.robot.chain.axis_map.q(values)

    def _nearest_pair(self, q: Vector) -> int:
        """Measure the pair with the smallest distance, and return its number.

        A mesh is no nearer than its hull: pairs whose hulls are farther apart than meshes already measured, which
        takes a hundred times as long, are left out.
        """
        scratch = self._scratch
        if scratch.around is None:
            return int(pin.computeDistances(*scratch.parts, q))
        pin.computeDistances(*scratch.around, q)
        bounds = np.array([result.min_distance for result in scratch.around[3].distanceResults])
        pin.updateGeometryPlacements(*scratch.parts)
        best, least = 0, math.inf
        for n in np.argsort(bounds, kind="stable").tolist():
            if bounds[n] >= least:
                break
            distance = float(pin.computeDistance(scratch.parts[2], scratch.found, n).min_distance)
            if distance < least:
                best, least = n, distance
        return best

    def _names(self, n: int) -> LinkPair:
        a, b = self.pairs[n]
        return self.solids[a].name, self.solids[b].name

    def _distance(self, n: int) -> Distance:
        result = self._scratch.found.distanceResults[n]
        points = np.array([result.getNearestPoint1(), result.getNearestPoint2()])
        return Distance(self._names(n), float(result.min_distance), points)

    def _watch(self, pairs: list[tuple[int, int]]) -> None:
        self.pairs = tuple(pairs)
        meshes = any(solid.around is not solid.geometry for solid in self.solids)
        hulls = self._bodies([solid.around for solid in self.solids]) if meshes else None
        self._scratch = _Scratch(self.robot.model, self._bodies([solid.geometry for solid in self.solids]), hulls)

    def _bodies(self, geometries: Iterable[Any]) -> pin.GeometryModel:
        """Return the solids with some geometries, and the pairs watched."""
        model = pin.GeometryModel()
        for solid, geometry in zip(self.solids, geometries, strict=True):
            placement = pin.SE3(solid.T_link_solid)
            model.addGeometryObject(pin.GeometryObject(solid.name, self._joint_of[solid.link], placement, geometry))
        for a, b in self.pairs:
            model.addCollisionPair(pin.CollisionPair(a, b))
        return model

    def _chosen(self, watched: tuple[LinkPair, ...]) -> list[tuple[int, int]]:
        known = {link.name for link in self.robot.chain.links}
        for name in {link for pair in watched for link in pair} - known:
            raise ChainbuildError(f"the kinematic has no link '{name}'", permitted=", ".join(sorted(known)))
        wanted = {frozenset(pair) for pair in watched}
        return [pair for pair in self._all() if frozenset(self.links_of(pair)) in wanted]

    def _all(self) -> list[tuple[int, int]]:
        count = len(self.solids)
        indices = [(a, b) for a in range(count) for b in range(a + 1, count)]
        return [pair for pair in indices if len(set(self.links_of(pair))) == 2]

    def _possible(self) -> list[tuple[int, int]]:
        left_out = {frozenset((joint.parent, joint.child)) for joint in self.robot.chain.joints}
        left_out |= {frozenset(pair) for pair in self.robot.chain.geometry.ignore}
        left_out |= {frozenset(pair) for pair in pinned_links(self.robot.chain)}
        return [pair for pair in self._all() if frozenset(self.links_of(pair)) not in left_out]

    def _touching_everywhere(self) -> tuple[LinkPair, ...]:
        lower, upper = shown_limits(self.robot.chain)
        rng = np.random.default_rng(_SEED)
        touching = np.ones(len(self.pairs), dtype=bool)
        for _ in range(_PROBES):
            self.colliding_pairs(random_axis_values(self.robot.chain.axis_map, rng, lower, upper)[0])
            results = self._scratch.found.collisionResults
            touching &= np.array([result.isCollision() for result in results], dtype=bool)
        links = {self.links_of(self.pairs[n]): None for n in np.flatnonzero(touching)}
        return tuple(links)


def bodies_of(robot: Mechanism, given: CollisionModel | None) -> CollisionModel:
    """Return the bodies of a robot: those given, else all with every pair that can collide, prepared once.

    Raises:
        ChainbuildError: those given are another robot's.
    """
    if given is None:
        return robot.prepared("bodies", lambda: CollisionModel(robot))
    if given.robot.chain is not robot.chain:
        raise ChainbuildError(
            "the bodies were made of another robot",
            parameter="bodies",
            permitted="a CollisionModel of this robot",
        )
    return given
