"""Robots as they are drawn: solid, in one piece, at the places that machine data give."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import combinations, pairwise, product
from typing import Final

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
from chainbuild.drawing.site import Site
from chainbuild.drawing.tracks import footing
from chainbuild.errors import MachineDataError
from chainbuild.frames import rot_z, transform
from chainbuild.robot import Robot
from tests.kit import drawn_robots as hand_made
from tests.kit.drawn_arms import CASES, FILE, PINNED, SHIPPED, drawn, extents_mm, pose
from tests.kit.robots import ur5
from tests.kit.robx_files import KIND, NR6, chain_of
from tests.kit.solid_bodies import depth, gap, overlap, placed

_DEPTH: Final = 5e-4  # m: bodies that lie against each other overlap by rounding to micrometres, and by a calibration
_GAP: Final = 1e-3  # m: what is closer than a millimetre looks like one piece
_ON: Final = 1e-6  # m: bodies are rounded to micrometres


def joined(chain: Chain) -> set[frozenset[str]]:
    """Pairs of links with a joint or a pin between them."""
    carrier = {frame.name: frame.link for frame in chain.frames}
    pairs = {frozenset((joint.parent, joint.child)) for joint in chain.joints}
    pairs |= {frozenset(pair) for pair in pinned_links(chain)}
    return pairs | {frozenset((carrier[loop.frame_a], carrier[loop.frame_b])) for loop in rod_loops(chain)}


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


def lines(chain: Chain, axes: Vector, bodies: tuple[Body, ...], link: str) -> list[tuple[Vector, Vector]]:
    """A point and the direction of the axis of every cylinder of a link."""
    T_link = link_placements(chain, chain.axis_map.q(axes))[link]
    own = [T_link @ body.T_link_body for body in bodies if body.link == link and body.kind == "cylinder"]
    return [(T[:3, 3], T[:3, 2]) for T in own]


def on_line(p: Vector, d: Vector, others: list[tuple[Vector, Vector]]) -> bool:
    return any(np.linalg.norm(np.cross(d, e)) < 1e-6 and np.linalg.norm(np.cross(q - p, d)) < 1e-5 for q, e in others)


@pytest.mark.parametrize(("name", "rods"), CASES)
def test_housings_turn_about_the_axes_of_their_joints(name: str, rods: bool) -> None:
    chain, site, bodies = drawn(name, rods)
    axes = pose(chain, 7)
    links = link_placements(chain, chain.axis_map.q(axes))
    turned = {joint.child for joint in site.tool_path if joint.kind == "revolute"}
    for joint in site.tool_path:
        if joint.kind == "prismatic" or "level_plate" in (joint.name, joint.parent.removesuffix("_link")):
            continue
        T = links[joint.parent] @ joint.T_parent_joint
        p, d = T[:3, 3], T[:3, :3] @ joint.direction
        assert on_line(p, d, lines(chain, axes, bodies, joint.child)), joint.name
        if joint.parent in turned:
            assert on_line(p, d, lines(chain, axes, bodies, joint.parent)), joint.name


@pytest.mark.parametrize("name", SHIPPED)
def test_flange_and_tool_end_where_data_say(name: str) -> None:
    chain, site, bodies = drawn(name, False)
    tool = chain.frame("tool").link
    ends = []
    for body in bodies:
        if body.link == tool and body.part in ("tool", "flange") and body.origin == "data":
            T = site.links[tool] @ body.T_link_body
            ends += [T[:3, 3] + side * body.dimensions[1] / 2.0 * T[:3, 2] for side in (-1.0, 1.0)]
    places = [site.tip] + ([site.frame("flange")[:3, 3]] if chain.frame("flange").link == tool else [])
    for place in places:
        assert min(float(np.linalg.norm(end - place)) for end in ends) < _ON
    with_tool = float(np.linalg.norm(places[-1] - site.tip)) > _ON or len(places) == 1
    assert any(body.part == "tool" for body in bodies) == with_tool


@pytest.mark.parametrize("name", SHIPPED)
def test_housings_get_thinner_towards_the_tip(name: str) -> None:
    radii = [seat.radius for seat in footing(drawn(name, False)[1]).seats]
    assert all(a >= b for a, b in pairwise(radii))
    assert radii[0] > 1.2 * radii[-1]


def test_what_data_place_is_marked() -> None:
    bodies = drawn("kr6r900", False)[2]
    by_rule = {(body.link, body.part) for body in bodies if body.origin == "drawn"}
    by_data = {(body.link, body.part) for body in bodies if body.origin == "data"}
    assert {("A2_link", "yoke"), ("A3_link", "housing"), ("A4_link", "arm"), ("A6_link", "flange")} <= by_data
    assert {("base", "foot"), ("A1_link", "neck"), ("A2_link", "joint"), ("A4_link", "joint")} <= by_rule - by_data


def test_radii_of_the_overlay_are_drawn() -> None:
    chain = drawn("kr6r900", False)[0]
    links = tuple(replace(link, radius=0.0777) if link.name == "A3_link" else link for link in chain.links)
    site = Site(replace(chain, links=links))
    assert 0.0777 in [body.dimensions[0] for body in arm_bodies(site) if body.kind == "cylinder"]
    assert footing(site).seats[2].radius == 0.0777


@pytest.mark.parametrize("build", [hand_made.arm, hand_made.scara, ur5], ids=["arm", "scara", "ur5"])
def test_arms_that_no_file_describes(build: Callable[[], Robot]) -> None:
    chain = build().chain
    site = Site(chain)
    bodies = tuple(arm_bodies(site))
    assert {body.link for body in bodies} == {link.name for link in chain.links}
    objects = placed(chain, site.home, bodies)
    for (a, one), (b, other) in combinations(zip(bodies, objects, strict=True), 2):
        if a.link != b.link and frozenset((a.link, b.link)) not in joined(chain) and overlap(one, other, 0.0):
            assert depth(one, other) <= _DEPTH, (a.link, a.part, b.link, b.part)


@pytest.mark.parametrize("main", range(1, 8))
def test_arms_without_lengths_still_have_bodies_to_see(main: int) -> None:
    kinds = [1 if letter == "L" else 3 for letter in KIND[main]]
    read = 0
    for (wrist, count), a, b, flange in product(((1, 4), (2, 6)), (0, 300), (0, 300), (0, 90)):
        data: dict[str, float | Sequence[float]] = {
            "MAIN_AXES": main,
            "WRIST_AXES": wrist,
            "NUM_AXES": count,
            "AXES_TYPE": (*kinds, 3, 3, 3)[:count],
        }
        lengths = {
            "TIRORO_POS": (0, 0, a),
            "MAIN_LENGTH_AB": (a, b),
            "TX3P3_POS": (b, 0, 0),
            "TFLWP_POS": (0, 0, flange),
        }
        try:
            chain = chain_of({**NR6, **data, **lengths})
        except MachineDataError:
            continue
        read += 1
        bodies = arm_bodies(Site(chain))
        assert {body.link for body in bodies} == {link.name for link in chain.links}
        assert all(0.0 < size < np.inf for body in bodies for size in body.dimensions)
    assert read > 3


@pytest.mark.parametrize("name", PINNED)
def test_every_link_is_as_large_as_it_was(name: str) -> None:
    """Where a rule changed on purpose: `python -m tests.kit.drawn_arms` writes the file anew; look at the pictures."""
    known = json.loads(FILE.read_text("utf-8"))[name]
    spans = extents_mm(name)
    assert spans.keys() == known.keys()
    for link, span in spans.items():
        assert span == pytest.approx(known[link], abs=0.3), link


@pytest.mark.parametrize("name", ["arm", "scara"])
def test_a_robot_looks_the_same_wherever_it_stands(name: str) -> None:
    chain = hand_made.ROBOTS[name]().chain
    first = chain.joints[0]
    assert first.parent == "base"
    move = transform(rot_z(30.0), np.array([0.7, -1.1, 0.0]))
    joints = (replace(first, T_parent_joint=move @ first.T_parent_joint), *chain.joints[1:])
    here, there = Site(chain), Site(replace(chain, joints=joints))
    for one, other in zip(arm_bodies(here), arm_bodies(there), strict=True):
        assert one.dimensions == pytest.approx(other.dimensions, abs=2.0 * _ON)
        a, b = move @ here.links[one.link] @ one.T_link_body, there.links[other.link] @ other.T_link_body
        if one.part != "foot":  # its plate lies along the site
            np.testing.assert_allclose(a[:3, 3], b[:3, 3], atol=2.0 * _ON)
