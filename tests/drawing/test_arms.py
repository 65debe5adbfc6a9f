"""Robots as they are drawn: solid, in one piece, at the places that machine data give."""

from __future__ import annotations

from functools import cache
from itertools import combinations
from typing import Final

import coal
import numpy as np
import pytest

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import Body
from chainbuild.chain.bodies.linkage import rod_loops
from chainbuild.chain.bodies.rods import pinned_links
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.elements import Chain
from chainbuild.chain.poses import link_placements
from chainbuild.drawing.arms import arm_bodies
from chainbuild.drawing.shown import shown_chain
from chainbuild.drawing.site import Site
from chainbuild.robot import Robot

ROBOTS: Final = (
    "kr6r900", "kr6r900_2", "irb2600", "tx2_60", "comau_calibrated", "parallelogram_nr", "arm_nn", "arm_nr5", "arm_rr",
    "scara_cc", "scara_sc", "cylinder_cs", "gantry_ss", "palletiser_nr4", "palletiser_kin96", "palletiser_kin213",
    "linear_robot_kin206", "irb2600_track", "irb2600_table", "robot_xy_unit_kin210", "gantry_robot_kin210",
    "robot_tilting_table_kin210", "irb2600_flange", "robot_head_kin210",
)  # fmt: skip
RODS: Final = ("parallelogram_nr", "palletiser_kin96")
CASES: Final = (*((name, False) for name in ROBOTS), *((name, True) for name in RODS))

_DEPTH: Final = 5e-4  # m: bodies that lie against each other overlap by rounding to micrometres, and by a calibration
_GAP: Final = 1e-3  # m: what is closer than a millimetre looks like one piece
_ON: Final = 1e-6  # m: bodies are rounded to micrometres


@cache
def drawn(name: str, rods: bool) -> tuple[Chain, Site, tuple[Body, ...]]:
    chain = Robot.load(name).chain
    if rods:
        chain = shown_chain(chain)
    site = Site(chain)
    return chain, site, tuple(arm_bodies(site))


def shape(body: Body) -> coal.ShapeBase:
    if body.kind == "box":
        return coal.Box(*body.dimensions)
    return coal.Cylinder(*body.dimensions) if body.kind == "cylinder" else coal.Sphere(*body.dimensions)


def placed(chain: Chain, axes: Vector, bodies: tuple[Body, ...]) -> list[coal.CollisionObject]:
    links = link_placements(chain, chain.axis_map.q(axes))
    objects = []
    for body in bodies:
        T = links[body.link] @ body.T_link_body
        objects.append(coal.CollisionObject(shape(body), coal.Transform3s(T[:3, :3], T[:3, 3])))
    return objects


def joined(chain: Chain) -> set[frozenset[str]]:
    """Pairs of links with a joint or a pin between them."""
    carrier = {frame.name: frame.link for frame in chain.frames}
    pairs = {frozenset((joint.parent, joint.child)) for joint in chain.joints}
    pairs |= {frozenset(pair) for pair in pinned_links(chain)}
    return pairs | {frozenset((carrier[loop.frame_a], carrier[loop.frame_b])) for loop in rod_loops(chain)}


def depth(a: coal.CollisionObject, b: coal.CollisionObject) -> float:
    request, result = coal.CollisionRequest(), coal.CollisionResult()
    if not coal.collide(a, b, request, result):
        return 0.0
    return abs(float(result.getContact(0).penetration_depth))


def gap(a: coal.CollisionObject, b: coal.CollisionObject) -> float:
    return float(coal.distance(a, b, coal.DistanceRequest(), coal.DistanceResult()))


def overlap(a: coal.CollisionObject, b: coal.CollisionObject, margin: float) -> bool:
    """Whether the boxes around two bodies come closer than a margin, to save the exact question."""
    for one in (a, b):
        one.computeAABB()
    low, high = a.getAABB(), b.getAABB()
    return bool(np.all(low.min_ <= high.max_ + margin) and np.all(high.min_ <= low.max_ + margin))


@pytest.mark.parametrize(("name", "rods"), CASES)
def test_links_keep_clear_of_each_other(name: str, rods: bool) -> None:
    chain, site, bodies = drawn(name, rods)
    low, high = shown_limits(chain)
    allowed = joined(chain)
    for axes in (site.home, (low + high) / 2.0):
        objects = placed(chain, axes, bodies)
        for (a, one), (b, other) in combinations(zip(bodies, objects, strict=True), 2):
            if a.link != b.link and frozenset((a.link, b.link)) not in allowed and overlap(one, other, 0.0):
                deep = depth(one, other)
                assert deep <= _DEPTH, (a.link, a.part, b.link, b.part, deep, axes)


@pytest.mark.parametrize(("name", "rods"), CASES)
def test_a_robot_is_one_piece(name: str, rods: bool) -> None:
    chain, site, bodies = drawn(name, rods)
    objects = placed(chain, site.home, bodies)
    reached, waiting = {0}, [0]
    while waiting:
        n = waiting.pop()
        near = [
            m
            for m in range(len(bodies))
            if m not in reached and overlap(objects[n], objects[m], _GAP) and gap(objects[n], objects[m]) <= _GAP
        ]
        reached.update(near)
        waiting.extend(near)
    assert [(b.link, b.part) for n, b in enumerate(bodies) if n not in reached] == []


@pytest.mark.parametrize(("name", "rods"), CASES)
def test_every_link_on_the_way_to_the_tool_has_a_body(name: str, rods: bool) -> None:
    chain, site, bodies = drawn(name, rods)
    below = {joint.child for joint in site.workpiece_path} - {joint.child for joint in site.tool_path}
    links = {link.name for link in chain.links} - below
    assert {body.link for body in bodies} == links
    for body in bodies:
        assert all(0.0 < size < np.inf for size in body.dimensions), body
        assert np.isfinite(body.T_link_body).all()
