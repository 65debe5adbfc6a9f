"""A drawing as solids in space: which bodies run into one another, which touch, where they end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import coal
import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild.chain.bodies.body import Body
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.elements import BASE_LINK, Chain
from chainbuild.chain.poses import link_placements

TOUCHING = 1e-3  # m: a gap that no picture shows


@dataclass(frozen=True)
class Overlap:
    """Two bodies in one another: their links and parts, and how deep [m]."""

    one: str
    other: str
    depth: float


class Scene:
    """The bodies of a machine at any axis values."""

    def __init__(self, chain: Chain, bodies: Sequence[Body]) -> None:
        self.chain = chain
        self.bodies = tuple(bodies)
        self._solids = [_solid(body) for body in self.bodies]
        links = {frame.name: frame.link for frame in chain.frames}
        self._joined = {frozenset((joint.parent, joint.child)) for joint in chain.joints}
        self._joined |= {frozenset((links[loop.frame_a], links[loop.frame_b])) for loop in chain.loops}

    def home(self) -> NDArray[np.float64]:
        """Axis values at 0, or at the limit next to it."""
        low, high = shown_limits(self.chain)
        return np.clip(np.zeros(len(low)), low, high)

    def middle(self) -> NDArray[np.float64]:
        """Axis values in the middle of their limits."""
        low, high = shown_limits(self.chain)
        middle: NDArray[np.float64] = (low + high) / 2.0
        return middle

    def closes(self, axes: ArrayLike) -> bool:
        """Whether the loops close there."""
        return bool(np.isfinite(self.chain.axis_map.q(np.asarray(axes, dtype=float))).all())

    def placed(self, axes: ArrayLike) -> list[NDArray[np.float64]]:
        """Placements (4, 4) of the bodies in the base."""
        links = link_placements(self.chain, self.chain.axis_map.q(np.asarray(axes, dtype=float)))
        return [links[body.link] @ body.T_link_body for body in self.bodies]

    def overlaps(self, axes: ArrayLike, allowed: float) -> list[Overlap]:
        """Bodies of links that neither a joint nor a loop joins, in one another by more than is allowed [m]."""
        placed = [coal.Transform3s(T[:3, :3], T[:3, 3]) for T in self.placed(axes)]
        found = []
        for a, b in combinations(range(len(self.bodies)), 2):
            one, other = self.bodies[a], self.bodies[b]
            if one.link == other.link or frozenset((one.link, other.link)) in self._joined:
                continue
            depth = -self._distance(a, b, placed)
            if depth > allowed:
                found.append(Overlap(f"{one.link} {one.part}", f"{other.link} {other.part}", depth))
        return found

    def islands(self, axes: ArrayLike) -> list[str]:
        """Bodies that no chain of touching bodies joins with the first body of the base."""
        placed = [coal.Transform3s(T[:3, :3], T[:3, 3]) for T in self.placed(axes)]
        todo = [next(n for n, body in enumerate(self.bodies) if body.link == BASE_LINK)]
        left = set(range(len(self.bodies))) - set(todo)
        while todo:
            here = todo.pop()
            near = {n for n in left if self._distance(here, n, placed) <= TOUCHING}
            left -= near
            todo += sorted(near)
        return [f"{self.bodies[n].link} {self.bodies[n].part}" for n in sorted(left)]

    def ends(self, part: str, axes: ArrayLike) -> dict[str, NDArray[np.float64]]:
        """The two ends (2, 3) of the cylinders of a part in the base, by link."""
        found = {}
        for body, T in zip(self.bodies, self.placed(axes), strict=True):
            if body.part == part and body.kind == "cylinder":
                half = T[:3, 2] * body.dimensions[1] / 2.0
                found[body.link] = np.array([T[:3, 3] - half, T[:3, 3] + half])
        return found

    def _distance(self, a: int, b: int, placed: Sequence[coal.Transform3s]) -> float:
        result = coal.DistanceResult()
        return float(
            coal.distance(self._solids[a], placed[a], self._solids[b], placed[b], coal.DistanceRequest(), result)
        )


def _solid(body: Body) -> coal.ShapeBase:
    if body.kind == "box":
        return coal.Box(*body.dimensions)
    return coal.Sphere(*body.dimensions) if body.kind == "sphere" else coal.Cylinder(*body.dimensions)
