"""Machines with closed loops: their bodies hang together, keep clear of one another and end where the loops close."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import chainbuild
from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import BASE_COLOUR, PART_COLOUR, WORKPIECE_SIDE, Body
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.elements import BASE_LINK, Chain
from chainbuild.chain.poses import frame_placement
from chainbuild.drawing.machine import drawn_bodies
from tests.kit.drawings import corners, ends, gap, home_and_middle, islands, overlaps, placements

MACHINES = ("tripod_kin12", "tripod_table_kin209", "delta_kin37", "rod_table_kin19", "lambda_kin21")
# What the conventions leave open turns columns over, to another side, or adds links.
VARIANTS = (
    ("tripod_kin12", "kin12_carriages=below"),
    ("tripod_kin12", "kin12_azimuth=deg_90"),
    ("tripod_kin12", "kin12_numbering=cw"),
    ("delta_kin37", "kin37_azimuth=deg_0"),
    ("rod_table_kin19", "kin19_carriages=above"),
    ("rod_table_kin19", "kin19_guide=centre_on_axis"),
    ("lambda_kin21", "kin21_side=right"),
    ("lambda_kin21", "kin21_slides=x2_carries_c"),
)
# Shifts and turns of a platform or table that no casting stands for.
VIRTUAL = {f"platform_{letter}_link" for letter in "xy"} | {f"table_{letter}_link" for letter in "zxyab"}
CONTACT = 1e-5  # m: bodies that touch, to the last digits of coal
GAP = 1e-3  # m: a gap that no picture shows


@cache
def drawn(name: str, choice: str = "") -> tuple[Chain, tuple[Body, ...]]:
    conventions = dict([choice.split("=")]) if choice else None
    chain = chainbuild.load(name).chain(conventions=conventions)
    return chain, drawn_bodies(chain)


def reached(chain: Chain, count: int) -> list[Vector]:
    """Positions inside the limits that the loops reach, the same every time."""
    low, high = shown_limits(chain)
    rng = np.random.default_rng(5)
    found: list[Vector] = []
    while len(found) < count:
        axes = low + (high - low) * rng.random(len(low))
        if np.isfinite(chain.axis_map.q(axes)).all():
            found.append(axes)
    return found


def parts(bodies: tuple[Body, ...], *names: str) -> list[Body]:
    return [body for body in bodies if body.part in names]


@pytest.mark.parametrize("name", MACHINES)
def test_nothing_runs_into_anything(name: str) -> None:
    chain, bodies = drawn(name)
    for axes in (*home_and_middle(chain), *reached(chain, 3)):
        assert overlaps(chain, bodies, axes, CONTACT) == []


@pytest.mark.parametrize(("name", "choice"), VARIANTS)
def test_nor_do_the_machines_that_conventions_make(name: str, choice: str) -> None:
    chain, bodies = drawn(name, choice)
    for axes in home_and_middle(chain):
        assert overlaps(chain, bodies, axes, CONTACT) == []
    assert len(islands(chain, bodies, home_and_middle(chain)[0], GAP)) == 1


@pytest.mark.parametrize("name", MACHINES)
def test_everything_hangs_together(name: str) -> None:
    """At home, in the middle, and wherever else: what holds a link never lets go of it."""
    chain, bodies = drawn(name)
    for axes in (*home_and_middle(chain), *reached(chain, 2)):
        assert len(islands(chain, bodies, axes, GAP)) == 1


@pytest.mark.parametrize("name", MACHINES)
def test_every_link_that_is_a_casting_has_a_body(name: str) -> None:
    chain, bodies = drawn(name)
    assert {link.name for link in chain.links} - {body.link for body in bodies} <= VIRTUAL


def test_links_of_a_guide_have_bodies() -> None:
    """The table whose middle stays on the axis is held by two links, which start from a post that rises with it."""
    chain, bodies = drawn("rod_table_kin19", "kin19_guide=centre_on_axis")
    bare = {link.name for link in chain.links} - {body.link for body in bodies}
    assert bare == {"table_a_link", "table_b_link"}


@pytest.mark.parametrize(("name", "choice"), [*((name, "") for name in MACHINES), *VARIANTS])
def test_measures_are_lengths(name: str, choice: str) -> None:
    for body in drawn(name, choice)[1]:
        assert all(np.isfinite(size) and size > 0.0 for size in body.dimensions)
        assert np.isfinite(body.T_link_body).all()


@pytest.mark.parametrize("name", MACHINES[:4])
def test_rods_reach_from_hinge_to_pin(name: str) -> None:
    chain, bodies = drawn(name)
    for axes in (home_and_middle(chain)[0], *reached(chain, 2)):
        rods = ends(chain, bodies, "rod", axes)
        assert len(rods) == len(chain.loops)
        for loop in chain.loops:
            start, end = rods[chain.frame(loop.frame_a).link]
            for frame in (loop.frame_a, loop.frame_b):
                assert end == pytest.approx(frame_placement(chain, frame, axes)[:3, 3], abs=1e-6)
            swing = f"{loop.name.removesuffix('_rod')}_swing_link"
            balls = [
                T[:3, 3]
                for body, T in zip(bodies, placements(chain, bodies, axes), strict=True)
                if body.kind == "sphere" and body.link == chain.frame(loop.frame_a).link
            ]
            assert balls == [pytest.approx(start, abs=1e-6), pytest.approx(end, abs=1e-6)]
            place = np.linalg.norm(start - swing_origin(chain, swing, axes))
            assert place < 1e-6


def swing_origin(chain: Chain, link: str, axes: Vector) -> Vector:
    mark = replace(chain.frames[0], name="mark", link=link, T_link_frame=np.eye(4))
    return np.asarray(frame_placement(replace(chain, frames=(*chain.frames, mark)), "mark", axes)[:3, 3])


@pytest.mark.parametrize("choice", ["", "kin21_side=right", "kin21_slides=x2_carries_c"])
def test_crossing_rods_meet_over_the_loop(choice: str) -> None:
    """The plane's height is in no machine data: the rods are level, above the tool, and end over the loop's frames."""
    chain, bodies = drawn("lambda_kin21", choice)
    for axes in home_and_middle(chain):
        ((start, end),) = ends(chain, bodies, "rod", axes).values()
        frames = [frame_placement(chain, name, axes)[:3, 3] for name in ("C_rod_end", "B_rod_end")]
        for frame in frames:
            assert end[:2] == pytest.approx(frame[:2], abs=1e-6)
        assert start[2] == pytest.approx(end[2], abs=1e-9)
        assert end[2] > frame_placement(chain, "tool", axes)[2, 3]
    assert {body.origin for body in parts(bodies, "rod", "arm")} == {"drawn"}


@pytest.mark.parametrize("name", MACHINES)
@pytest.mark.parametrize("length", [0.0, 75.0])
def test_the_tool_ends_at_the_tip(name: str, length: float) -> None:
    chain = chainbuild.load(name).chain(tool_length_mm=length)
    bodies = drawn_bodies(chain)
    axes = home_and_middle(chain)[0]
    ((start, end),) = ends(chain, bodies, "tool", axes).values()
    tool = frame_placement(chain, "tool", axes)
    assert end == pytest.approx(tool[:3, 3], abs=1e-6)
    assert (start - end) @ tool[:3, 2] == pytest.approx(np.linalg.norm(start - end), abs=1e-9)
    if length:
        assert np.linalg.norm(start - end) == pytest.approx(length / 1000.0, abs=2e-6)
    assert [body.origin for body in parts(bodies, "tool")] == ["data"]


@pytest.mark.parametrize("name", MACHINES)
def test_what_the_data_tell_is_marked(name: str) -> None:
    _, bodies = drawn(name)
    told = {body.part for body in bodies if body.origin == "data"}
    assert told <= {"rod", "lever", "tool", "table"}
    drawn_parts = {body.part for body in bodies if body.origin == "drawn"}
    assert drawn_parts >= {"bed", "workpiece"}


@pytest.mark.parametrize("name", MACHINES)
def test_carriages_stay_on_their_guides(name: str) -> None:
    """A guide is as long as the stroke and the carriage: never shorter, and not much longer."""
    chain, bodies = drawn(name)
    low, high = shown_limits(chain)
    for carriage in parts(bodies, "carriage"):
        index = next(n for n, axis in enumerate(chain.axes) if f"{axis.name}_link" == carriage.link)
        joint = next(joint for joint in chain.joints if joint.child == carriage.link)
        along = joint.T_parent_joint[:3, :3] @ joint.direction
        spans = [span(carriage, placed_alone(chain, carriage, end[index]), along) for end in (low, high)]
        ends_of_carriage = min(a for a, _ in spans), max(b for _, b in spans)
        guides = [
            span(guide, guide.T_link_body, along)
            for guide in parts(bodies, "guide")
            if gap(guide, guide.T_link_body, carriage, placed_alone(chain, carriage, low[index])) <= GAP
        ]
        assert any(np.allclose(guide, ends_of_carriage, atol=1e-5) for guide in guides)


def placed_alone(chain: Chain, body: Body, value: float) -> Vector:
    """Place of a body on a slide of the base, whatever the others do."""
    joint = next(joint for joint in chain.joints if joint.child == body.link)
    assert joint.parent == BASE_LINK
    T = np.eye(4)
    T[:3, 3] = joint.direction * value / 1000.0
    return np.asarray(joint.T_parent_joint @ T @ body.T_link_body)


def span(body: Body, T: Vector, along: Vector) -> tuple[float, float]:
    half = float(np.abs(along @ T[:3, :3]) @ np.array(body.dimensions)) / 2
    middle = float(along @ T[:3, 3])
    return middle - half, middle + half


@pytest.mark.parametrize("name", MACHINES)
def test_the_part_is_where_the_tool_comes_from_above(name: str) -> None:
    """It stands under the tip at home, and no corner of the limits drives the tool into it as it stands there."""
    chain, bodies = drawn(name)
    (part,) = parts(bodies, "workpiece")
    assert part.colour == PART_COLOUR
    home = home_and_middle(chain)[0]
    T, tip = placements(chain, [part], home)[0], frame_placement(chain, "tool", home)[:3, 3]
    assert T[:2, 3] == pytest.approx(tip[:2], abs=1e-6)
    assert T[2, 3] + part.dimensions[2] / 2 < tip[2]
    tools = [body for body in bodies if body.part in ("tool", "spindle", "platform")]
    turned = [axis.kind == "rotary" and axis.carries == "workpiece" for axis in chain.axes]
    for axes in corners(chain):
        if (axes != home)[turned].any():
            continue
        places = placements(chain, [part, *tools], axes)
        assert min(gap(part, places[0], tool, place) for tool, place in zip(tools, places[1:], strict=True)) > 0.0


@pytest.mark.parametrize("name", MACHINES)
def test_colours_tell_the_sides(name: str) -> None:
    _, bodies = drawn(name)
    for body in parts(bodies, "bed", "post", "column", "beam"):
        if body.link == BASE_LINK:
            assert body.colour == BASE_COLOUR
    moved = [body for body in parts(bodies, "rod", "carriage", "platform", "cradle") if body.link != BASE_LINK]
    below = {body.colour in WORKPIECE_SIDE for body in moved if body.part != "cradle"}
    assert below == {name == "rod_table_kin19"}


@pytest.mark.parametrize(("name", "link"), [("tripod_kin12", "Z2_lean_link"), ("lambda_kin21", "phi_link")])
def test_a_given_radius_is_drawn(name: str, link: str) -> None:
    chain, _ = drawn(name)
    links = tuple(replace(entry, radius=0.004) if entry.name == link else entry for entry in chain.links)
    (rod,) = [body for body in drawn_bodies(replace(chain, links=links)) if body.link == link and body.part == "rod"]
    assert rod.dimensions[0] == 0.004


def test_levers_are_as_long_as_the_data_say() -> None:
    _, bodies = drawn("delta_kin37")
    bars = [body for body in parts(bodies, "lever") if max(body.dimensions) == pytest.approx(0.2, abs=1e-6)]
    assert sorted(body.link for body in bars) == sorted(2 * ["J1_link", "J2_link", "J3_link"])


def test_what_a_tool_reaches_is_inside_the_frame() -> None:
    """Columns and posts stand around the platform, and the beams over it."""
    for name in ("tripod_kin12", "delta_kin37"):
        chain, bodies = drawn(name)
        tips = np.array([frame_placement(chain, "tool", axes)[:3, 3] for axes in corners(chain)])
        for body in parts(bodies, "column", "post"):
            away = body.T_link_body[:2, 3]
            assert np.linalg.norm(away) > np.linalg.norm(tips[:, :2], axis=1).max()
        assert min(body.T_link_body[2, 3] for body in parts(bodies, "beam", "plate")) > tips[:, 2].max()
