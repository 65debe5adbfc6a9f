"""Drawn bodies as coal geometry: what overlaps, what touches, what stands alone."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from typing import Any

import coal
import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.bodies.body import Body
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.elements import Chain
from chainbuild.chain.poses import link_placements
from chainbuild.drawing.machine import drawn_bodies
from chainbuild.painting.raster.sight import render
from chainbuild.painting.stage import Stage, framed
from chainbuild.painting.views import View

COARSE = (480, 360)  # pixels: what cannot be seen there is hidden or too small
ALLOWED = 5e-4  # m: bodies that touch, rounded to micrometres and measured by an iteration
REACH = 1e-3  # m: what is nearer hangs together


def solid(body: Body) -> Any:
    """Return the geometry of a body."""
    if body.kind == "box":
        return coal.Box(*body.dimensions)
    if body.kind == "sphere":
        return coal.Sphere(body.dimensions[0])
    return coal.Cylinder(*body.dimensions)


def placements(chain: Chain, bodies: Iterable[Body], axes: Vector) -> list[Matrix]:
    """Return where bodies are at axis values."""
    placed = link_placements(chain, chain.axis_map.q(axes))
    return [placed[body.link] @ body.T_link_body for body in bodies]


def home_and_middle(chain: Chain) -> tuple[Vector, Vector]:
    """Return the axis values of the two positions that drawings have to be right in."""
    low, high = shown_limits(chain)
    return np.clip(np.zeros(len(low)), low, high), (low + high) / 2


def gap(one: Body, T_one: Matrix, other: Body, T_other: Matrix) -> float:
    """Return the distance of two bodies [m]; negative: how deep they overlap."""
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    places = [coal.Transform3s(T[:3, :3], T[:3, 3]) for T in (T_one, T_other)]
    return float(coal.distance(solid(one), places[0], solid(other), places[1], request, result))


def joined(chain: Chain) -> set[frozenset[str]]:
    """Return the pairs of links that a joint or a loop connects."""
    pairs = {frozenset((joint.parent, joint.child)) for joint in chain.joints}
    links = {frame.name: frame.link for frame in chain.frames}
    return pairs | {frozenset((links[loop.frame_a], links[loop.frame_b])) for loop in chain.loops}


def overlaps(chain: Chain, bodies: Sequence[Body], axes: Vector, allowed: float) -> list[tuple[str, str, float]]:
    """Return bodies of links that nothing joins, and that overlap deeper than allowed [m]."""
    placed, together = placements(chain, bodies, axes), joined(chain)
    found = []
    for (a, A), (b, B) in itertools.combinations(zip(bodies, placed, strict=True), 2):
        if a.link == b.link or frozenset((a.link, b.link)) in together:
            continue
        depth = -gap(a, A, b, B)
        if depth > allowed:
            found.append((f"{a.link} {a.part}", f"{b.link} {b.part}", round(depth, 4)))
    return found


def islands(chain: Chain, bodies: Sequence[Body], axes: Vector, reach: float) -> list[list[str]]:
    """Return the groups of bodies that hang together with gaps up to a reach [m]."""
    placed = placements(chain, bodies, axes)
    group = list(range(len(bodies)))

    def root(n: int) -> int:
        while group[n] != n:
            n = group[n]
        return n

    for a, b in itertools.combinations(range(len(bodies)), 2):
        if root(a) != root(b) and gap(bodies[a], placed[a], bodies[b], placed[b]) <= reach:
            group[root(b)] = root(a)
    groups: dict[int, list[str]] = {}
    for n, body in enumerate(bodies):
        groups.setdefault(root(n), []).append(f"{body.link} {body.part}")
    return sorted(groups.values(), key=len)


def bare_links(chain: Chain, bodies: Sequence[Body]) -> list[str]:
    """Return the links without any body, but those that only carry the freedoms of a platform."""
    seen = {body.link for body in bodies}
    axes = {axis.name for axis in chain.axes}
    passive = {joint.child for joint in chain.joints if chain.loops and joint.name not in axes}
    return [link.name for link in chain.links if link.name not in seen | passive]


def check_laws(chain: Chain) -> None:
    """Check the laws that hold for the drawing of every machine."""
    bodies = drawn_bodies(chain)
    home, middle = home_and_middle(chain)
    for axes in (home, middle):
        assert overlaps(chain, bodies, axes, ALLOWED) == []
    assert len(islands(chain, bodies, home, REACH)) == 1
    assert bare_links(chain, bodies) == []
    assert all(is_sound(body) for body in bodies)


def is_sound(body: Body) -> bool:
    """Return whether a body has a size and a place, and says where both come from."""
    finite = np.isfinite(body.T_link_body).all() and np.isfinite(body.dimensions).all()
    return bool(finite and min(body.dimensions) > 0.0 and body.origin in ("data", "drawn"))


def ends(chain: Chain, bodies: Sequence[Body], part: str, axes: Vector) -> dict[str, Matrix]:
    """Return both ends (2, 3) of the cylinders of a part in the base, by the link that carries them."""
    found = {}
    for body, T in zip(bodies, placements(chain, bodies, axes), strict=True):
        if body.part == part and body.kind == "cylinder":
            half = T[:3, 2] * body.dimensions[1] / 2
            found[body.link] = np.array([T[:3, 3] - half, T[:3, 3] + half])
    return found


def corners(chain: Chain) -> list[Vector]:
    """Return the axis values of every combination of home and both limits at which the loops close."""
    low, high = shown_limits(chain)
    home = home_and_middle(chain)[0]
    choices = [sorted({a, b, c}) for a, b, c in zip(low, high, home, strict=True)]
    found = [np.array(axes) for axes in itertools.product(*choices)]
    return [axes for axes in found if np.isfinite(chain.axis_map.q(axes)).all()]


def gaps_between(chain: Chain, ones: Sequence[Body], others: Sequence[Body], axes: Vector) -> Matrix:
    """Return the distances (n, m) [m] of bodies to others."""
    left = list(zip(ones, placements(chain, ones, axes), strict=True))
    right = list(zip(others, placements(chain, others, axes), strict=True))
    return np.array([[gap(a, A, b, B) for b, B in right] for a, A in left])


def nearest(chain: Chain, bodies: Sequence[Body], part: str, other: str, axes: Vector) -> list[float]:
    """Return for each body of a part its distance [m] to the nearest body of another part."""
    ones, others = ([body for body in bodies if body.part == name] for name in (part, other))
    table = gaps_between(chain, ones, others, axes)
    nearest_ones: list[float] = table.min(axis=1).tolist()
    return nearest_ones


def body_pixels(stage: Stage, view: View, near: bool = False) -> list[int]:
    """Return how many pixels of a small picture show each body of a stage, the tool end alone or all of it."""
    window = framed(stage.tool_end if near else stage.bodies, view, *COARSE)
    shown = render(stage.bodies, view, window).bodies
    return np.bincount(shown.ravel() + 1, minlength=len(stage.bodies) + 1)[1:].tolist()
