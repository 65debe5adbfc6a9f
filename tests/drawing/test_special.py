"""Lathes, the eccentric disc, the SCARA and the lever: drawn as what they are, clear of one another, in one piece."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.bodies.body import BASE_COLOUR, PART_COLOUR, WORKPIECE_SIDE, Body
from chainbuild.chain.bodies.shapes import machine_size, shown_limits
from chainbuild.chain.elements import BASE_LINK, Chain
from chainbuild.chain.poses import frame_placement
from chainbuild.drawing.machine import drawn_bodies
from chainbuild.drawing.site import Site
from tests.kit.drawings import corners, ends, gap, gaps_between, home_and_middle, islands, nearest, overlaps, placements
from tests.kit.kin_robots import robot_of
from tests.kit.kin_types import build

SHIPPED = ("c_face_kin14", "cyl_2rot_kin202", "scara_kin36", "lever_kin85", "eccentric_disc_kin205")
# Head offsets in mm of machines that no shipped file shows: number and what is new about them.
BUILT: dict[str, dict[int | str, float]] = {
    "13": {1: 60.0},
    "13 beside the axis": {1: 60.0, 4: 20.0},
    "202 to the right": {1: 80.0, 10: 1.0},
    "202 off the zero": {1: 80.0, 6: 50.0, 7: 30.0, 8: -40.0},
    "205 about X": {1: 50.0, 2: 80.0, 17: 1.0},
    "205 off the zero": {1: 50.0, 2: 80.0, 6: 50.0, 7: 30.0, 8: -40.0, 16: 1.0},
    "36 off the zero": {1: 100.0, 2: 325.0, 3: 225.0, 4: 50.0, 5: 20.0},
    "36 with absolute angles": {1: 100.0, 2: 325.0, 3: 225.0, 7: 1.0},
    "85 with a short lever": {1: 800.0, 2: 200.0},
}
MACHINES = (*SHIPPED, *BUILT)
LATHES = ("c_face_kin14", "cyl_2rot_kin202", "13", "13 beside the axis", "202 to the right", "202 off the zero")
# Parts that touch faces: neither stands inside the other, and there is no gap.
BEFORE_A_COLUMN = "slide ram, slide guide, guide column, column bed"
LATHE = f"{BEFORE_A_COLUMN}, table housing, workpiece table, cheek table, cheek workpiece"
TOUCHING = {
    "c_face_kin14": f"{LATHE}, spindle ram, spindle tool",
    "cyl_2rot_kin202": f"{LATHE}, ram housing",
    "scara_kin36": "foot bed, column foot, column joint, housing joint, workpiece bed, tool ram",
    "lever_kin85": "carriage guide, guide bed, cheek carriage, workpiece bed, spindle lever, spindle tool",
    "eccentric_disc_kin205": f"{BEFORE_A_COLUMN}, plate ram, tool plate, workpiece bed",
    "13": LATHE,
    "13 beside the axis": LATHE,
    "202 to the right": f"{LATHE}, ram housing",
    "202 off the zero": f"{LATHE}, ram housing",
    "205 about X": f"{BEFORE_A_COLUMN}, plate ram, tool plate",
    "85 with a short lever": "carriage guide, guide bed, cheek carriage, spindle lever, spindle tool",
}
FACE = 1e-4  # m: as exact as coal is where a cylinder lies on a face
CONTACT = 1e-5  # m: bodies that touch, to the last digits of coal
GAP = 1e-3  # m: a gap that no picture shows


@cache
def drawn(name: str) -> tuple[Chain, tuple[Body, ...]]:
    if name in BUILT:
        chain = build(int(name.split(maxsplit=1)[0]), BUILT[name]).robot.chain
    else:
        chain = chainbuild.load(name).chain()
    return chain, drawn_bodies(chain)


def parts(bodies: tuple[Body, ...], *names: str) -> list[Body]:
    return [body for body in bodies if body.part in names]


@pytest.mark.parametrize("name", MACHINES)
def test_nothing_runs_into_anything(name: str) -> None:
    chain, bodies = drawn(name)
    for axes in home_and_middle(chain):
        assert overlaps(chain, bodies, axes, CONTACT) == []


@pytest.mark.parametrize("name", MACHINES)
def test_everything_hangs_together_wherever_it_goes(name: str) -> None:
    chain, bodies = drawn(name)
    low, high = shown_limits(chain)
    for axes in (*home_and_middle(chain), low, high):
        assert len(islands(chain, bodies, axes, GAP)) == 1


@pytest.mark.parametrize("name", SHIPPED)
def test_no_corner_of_the_limits_drives_the_tool_into_the_part(name: str) -> None:
    """Nor into what holds the part, the bed or the column."""
    chain, bodies = drawn(name)
    tools = parts(bodies, "tool", "spindle")
    others = parts(bodies, "workpiece", "table", "bed", "column", "carriage")
    for axes in corners(chain):
        assert gaps_between(chain, tools, others, axes).min() > 0.0


@pytest.mark.parametrize("name", TOUCHING)
def test_faces_touch(name: str) -> None:
    chain, bodies = drawn(name)
    for axes in home_and_middle(chain):
        for pair in TOUCHING[name].split(", "):
            one, other = pair.split()
            gaps = nearest(chain, bodies, one, other, axes)
            assert gaps, pair
            assert gaps == pytest.approx(np.zeros(len(gaps)), abs=FACE), pair


@pytest.mark.parametrize("name", MACHINES)
def test_the_bed_is_below_everything_and_under_every_foot(name: str) -> None:
    chain, bodies = drawn(name)
    site = Site(chain)
    (bed,) = parts(bodies, "bed")
    top = site.bounds(bed)[0, 2] + bed.dimensions[2]
    others = [body for body in bodies if body is not bed]
    assert min(site.bounds(body)[0, 2] for body in others) == pytest.approx(top, abs=CONTACT)
    standing = [body for body in others if body.link == BASE_LINK and site.bounds(body)[0, 2] < top + CONTACT]
    for along in np.eye(3)[:2]:
        low, high = span(bed, bed.T_link_body, along)
        for body in standing:
            a, b = span(body, body.T_link_body, along)
            assert low <= a + 1e-6
            assert b <= high + 1e-6


@pytest.mark.parametrize("name", ["c_face_kin14", "cyl_2rot_kin202", "eccentric_disc_kin205", "205 about X"])
def test_the_ram_never_leaves_its_saddle(name: str) -> None:
    """It is held over the whole height of the saddle, and head or disc stay below that."""
    chain, bodies = drawn(name)
    (ram,), (saddle,) = parts(bodies, "ram"), parts(bodies, "slide")
    others = [body for body in bodies if body.part in ("plate", "spindle", "tool") or body.link == "YQ_link"]
    column = parts(bodies, "column")
    for axes in corners(chain):
        a, b = (span(body, placements(chain, [body], axes)[0], np.eye(3)[2]) for body in (ram, saddle))
        assert a[0] < b[0]
        assert b[1] < a[1]
        assert gaps_between(chain, [saddle, *column], others, axes).min() > 1e-3


def test_the_stroke_ends_where_the_column_does() -> None:
    """Guide and column are as wide as the saddle and its stroke, the column as high as the saddle."""
    for name in ("c_face_kin14", "cyl_2rot_kin202", "eccentric_disc_kin205"):
        _, bodies = drawn(name)
        (guide,), (column,), (saddle,) = parts(bodies, "guide"), parts(bodies, "column"), parts(bodies, "slide")
        x, _, z = np.eye(3)
        assert span(column, column.T_link_body, x) == pytest.approx(span(guide, guide.T_link_body, x), abs=1e-6)
        top = span(saddle, saddle.T_link_body, z)
        inner = span(guide, guide.T_link_body, z)
        assert span(column, column.T_link_body, z)[1] == pytest.approx(top[1], abs=1e-5)
        assert top[0] < inner[0] < inner[1] < top[1]


def test_a_lever_that_points_backwards_is_drawn_in_a_mirror() -> None:
    """C from 100 to 260 degrees: the part stands at the other end of the slide."""
    chain, bodies = drawn("lever_kin85")
    axes = (chain.axes[0], replace(chain.axes[1], lower=100.0, upper=260.0))
    axes = (replace(axes[0], lower=-300.0), axes[1])
    back = replace(chain, axes=axes)
    mirrored = drawn_bodies(back)
    (part,), (guide,), (bed,) = (parts(mirrored, name) for name in ("workpiece", "guide", "bed"))
    x = np.eye(3)[0]
    assert span(part, part.T_link_body, x)[1] < span(guide, guide.T_link_body, x)[0]
    assert span(guide, guide.T_link_body, x) == pytest.approx((-0.3 - 0.12, 0.5 + 0.12), abs=1e-6)
    assert span(bed, bed.T_link_body, x)[0] < span(part, part.T_link_body, x)[0]
    for place in home_and_middle(back):
        assert overlaps(back, mirrored, place, CONTACT) == []
        assert len(islands(back, mirrored, place, GAP)) == 1
    (own,), (rail,) = parts(bodies, "workpiece"), parts(bodies, "guide")
    assert span(own, own.T_link_body, x)[0] > span(rail, rail.T_link_body, x)[1]


@pytest.mark.parametrize("name", MACHINES)
def test_every_link_has_a_body(name: str) -> None:
    chain, bodies = drawn(name)
    assert {link.name for link in chain.links} == {body.link for body in bodies}


@pytest.mark.parametrize("name", MACHINES)
def test_measures_are_lengths(name: str) -> None:
    for body in drawn(name)[1]:
        assert all(np.isfinite(size) and size > 0.0 for size in body.dimensions)
        assert np.isfinite(body.T_link_body).all()


@pytest.mark.parametrize("number", [13, 14, 36, 85, 202, 205])
def test_any_offsets_are_drawn(number: int) -> None:
    chain = robot_of(number).chain
    bodies = drawn_bodies(chain)
    assert {link.name for link in chain.links} == {body.link for body in bodies}
    assert all(np.isfinite(size) and size > 0.0 for body in bodies for size in body.dimensions)
    assert len(islands(chain, bodies, home_and_middle(chain)[0], GAP)) == 1


@pytest.mark.parametrize("name", MACHINES)
def test_the_tool_ends_at_the_tip(name: str) -> None:
    chain, bodies = drawn(name)
    for axes in home_and_middle(chain):
        ((_, end),) = ends(chain, bodies, "tool", axes).values()
        assert end == pytest.approx(frame_placement(chain, "tool", axes)[:3, 3], abs=1e-6)
    assert {body.part for body in bodies if body.origin == "data"} <= {"tool", "lever"}


@pytest.mark.parametrize("name", MACHINES)
def test_slides_stay_on_their_guides(name: str) -> None:
    """A guide is as long as the stroke and what slides on it."""
    chain, bodies = drawn(name)
    low, high = shown_limits(chain)
    for guide in parts(bodies, "guide"):
        slide = next(body for body in bodies if body.part in ("slide", "carriage"))
        joint = next(joint for joint in chain.joints if joint.child == slide.link)
        along = joint.T_parent_joint[:3, :3] @ joint.direction
        spans = [span(slide, placements(chain, [slide], axes)[0], along) for axes in (low, high)]
        whole = min(a for a, _ in spans), max(b for _, b in spans)
        assert span(guide, guide.T_link_body, along) == pytest.approx(whole, abs=1e-5)


def span(body: Body, T: np.ndarray, along: np.ndarray) -> tuple[float, float]:
    size = (
        body.dimensions if body.kind == "box" else (2 * body.dimensions[0], 2 * body.dimensions[0], body.dimensions[1])
    )
    half = float(np.abs(along @ T[:3, :3]) @ np.array(size)) / 2
    middle = float(along @ T[:3, 3])
    return middle - half, middle + half


@pytest.mark.parametrize("name", LATHES)
def test_the_spindle_turns_chuck_and_part_about_its_axis(name: str) -> None:
    chain, bodies = drawn(name)
    spindle = chain.joints[-1]
    assert spindle.child == chain.frame("workpiece").link
    axis = spindle.T_parent_joint[:2, 3]
    low, high = shown_limits(chain)
    (part,), (chuck,), (stock,) = (
        parts(bodies, "workpiece"),
        parts(bodies, "table"),
        [body for body in parts(bodies, "housing") if body.link == BASE_LINK],
    )
    for body in (part, chuck):
        assert body.link == spindle.child
        assert body.kind == "cylinder"
        for axes in (low, high):
            assert placements(chain, [body], axes)[0][:2, 3] == pytest.approx(axis, abs=1e-6)
    assert chuck.colour in WORKPIECE_SIDE
    assert part.colour == PART_COLOUR
    heights = [placements(chain, [body], low)[0][2, 3] for body in (stock, chuck, part)]
    assert heights == sorted(heights)
    jaws = [T[:2, 3] - axis for T in placements(chain, parts(bodies, "cheek"), low)]
    assert np.sum(jaws, axis=0) == pytest.approx([0.0, 0.0], abs=1e-6)
    half = (part.dimensions[0] + 0.95 * chuck.dimensions[0]) / 2
    assert [float(np.linalg.norm(jaw)) for jaw in jaws] == [pytest.approx(half, abs=1e-6)] * 3


def test_a_level_tool_turns_the_part_and_an_upright_one_faces_it() -> None:
    """The part of a turning machine stands beside the tip over a good part of the stroke, others end below it."""
    for name, beside in (("cyl_2rot_kin202", True), ("c_face_kin14", False), ("13", False)):
        chain, bodies = drawn(name)
        axes = home_and_middle(chain)[0]
        (part,) = parts(bodies, "workpiece")
        top = placements(chain, [part], axes)[0][2, 3] + part.dimensions[1] / 2
        lowest = min(frame_placement(chain, "tool", corner)[2, 3] for corner in corners(chain))
        assert (top > lowest + 0.1) == beside
        assert beside or top < lowest


@pytest.mark.parametrize("stroke", [500.0, 100.0])
def test_a_turned_part_is_as_long_as_the_stroke_or_nine_radii(stroke: float) -> None:
    chain, _ = drawn("cyl_2rot_kin202")
    axes = tuple(replace(axis, upper=stroke) if axis.name == "ZQ" else axis for axis in chain.axes)
    bodies = drawn_bodies(replace(chain, axes=axes))
    (part,), (chuck,) = parts(bodies, "workpiece"), parts(bodies, "table")
    radius, length = part.dimensions
    assert radius == pytest.approx(0.6 * 0.04, abs=1e-6)
    assert length == pytest.approx(min(9 * radius, stroke / 1000 + 2 * radius), abs=2e-6)
    spindle = 0.06 * max(stroke / 1000, machine_size(chain), 0.28)
    assert chuck.dimensions[0] == pytest.approx(1.9 * max(radius, spindle), abs=1e-6)


def test_a_faced_part_is_as_wide_as_the_tip_goes() -> None:
    _, bodies = drawn("c_face_kin14")
    (part,), (chuck,) = parts(bodies, "workpiece"), parts(bodies, "table")
    assert part.dimensions == (pytest.approx(0.4 * 0.25, abs=1e-6), pytest.approx(0.4 * 0.25, abs=1e-6))
    assert chuck.dimensions[0] == pytest.approx(1.9 * 0.1, abs=1e-6)


def test_the_tool_that_crosses_the_spindle_faces_the_part() -> None:
    """An 80 mm longer tool of the turning machine reaches past the axis: nothing can stand beside it."""
    chain = chainbuild.load("cyl_2rot_kin202").chain(tool_length_mm=80.0)
    bodies = drawn_bodies(chain)
    for axes in home_and_middle(chain):
        assert overlaps(chain, bodies, axes, CONTACT) == []


def test_the_column_of_a_lathe_is_behind() -> None:
    for name in ("c_face_kin14", "cyl_2rot_kin202", "eccentric_disc_kin205"):
        _, bodies = drawn(name)
        (column,), (ram,) = parts(bodies, "column"), parts(bodies, "ram")
        assert column.T_link_body[1, 3] > ram.T_link_body[1, 3]
        assert column.link == BASE_LINK
        assert column.colour == BASE_COLOUR


@pytest.mark.parametrize("name", ["eccentric_disc_kin205", "205 about X", "205 off the zero"])
def test_the_disc_turns_about_its_middle_and_holds_the_tool_off_it(name: str) -> None:
    chain, bodies = drawn(name)
    (disc,) = parts(bodies, "plate")
    joint = next(joint for joint in chain.joints if joint.child == disc.link)
    middle, flange = disc.T_link_body[:3, 3], chain.frame("flange").T_link_frame[:3, 3]
    assert np.cross(middle, joint.direction) == pytest.approx(np.zeros(3), abs=1e-6)
    assert abs(disc.T_link_body[:3, 2] @ joint.direction) == pytest.approx(1.0)
    off = np.linalg.norm(np.cross(flange, joint.direction))
    assert off == pytest.approx(0.08, abs=1e-6)
    assert disc.dimensions[0] == pytest.approx(1.35 * off, abs=1e-6)
    # The tool sits on the face of the disc, which is between it and the ram.
    assert abs((flange - middle) @ joint.direction) == pytest.approx(disc.dimensions[1] / 2, abs=2e-6)


def test_the_ram_holds_an_upright_disc_in_its_middle() -> None:
    chain, bodies = drawn("205 about X")
    site = Site(chain)
    (disc,), (ram,) = parts(bodies, "plate"), parts(bodies, "ram")
    low, high = site.bounds(ram)[:, 2]
    middle = float((site.links[disc.link] @ disc.T_link_body)[2, 3])
    assert low < middle - 0.4 * ram.dimensions[0]
    assert middle < high
    assert site.bounds(ram)[0, 0] == pytest.approx(site.bounds(disc)[1, 0], abs=1e-6)


def test_a_disc_without_tool_length_has_its_tool_in_it() -> None:
    chain = build(205, {2: 80.0, 16: 1.0}).robot.chain
    bodies = drawn_bodies(chain)
    axes = home_and_middle(chain)[0]
    ((start, end),) = ends(chain, bodies, "tool", axes).values()
    assert end == pytest.approx(frame_placement(chain, "tool", axes)[:3, 3], abs=1e-6)
    assert start[2] > end[2]


@pytest.mark.parametrize("length", [0.0, 100.0])
def test_the_ram_begins_above_tool_and_spindle(length: float) -> None:
    """Where the data put the slide, and 2.5 radii of the spindle above the tip at least."""
    chain = chainbuild.load("c_face_kin14").chain(tool_length_mm=length)
    bodies, site = drawn_bodies(chain), Site(chain)
    (ram,), (spindle,) = parts(bodies, "ram"), parts(bodies, "spindle")
    assert spindle.dimensions[0] == pytest.approx(0.06 * 0.45, abs=1e-6)
    under = max(0.0, float(site.tip[2]) + 2.5 * spindle.dimensions[0])
    assert site.bounds(ram)[0, 2] == pytest.approx(under, abs=1e-6)


@pytest.mark.parametrize("length", [80.0, 30.0])
def test_the_tool_sticks_out_of_its_turret(length: float) -> None:
    chain = build(202, {1: length}).robot.chain
    axes = (replace(chain.axes[0], lower=120.0, upper=400.0, assumed=False), *chain.axes[1:])
    axes = tuple(replace(a, lower=0.0, upper=500.0, assumed=False) if a.name.startswith("Z") else a for a in axes)
    chain = replace(chain, axes=axes)
    (turret,) = [body for body in parts(drawn_bodies(chain), "housing") if body.link != BASE_LINK]
    assert turret.dimensions[0] == pytest.approx(1.2 * min(0.06 * 0.5, 0.45 * length / 1000), abs=1e-6)
    assert turret.dimensions[0] < length / 1000


@pytest.mark.parametrize("name", ["scara_kin36", "36 off the zero", "36 with absolute angles"])
def test_the_arms_of_a_scara_reach_from_axis_to_axis(name: str) -> None:
    chain, bodies = drawn(name)
    arms = parts(bodies, "arm")
    assert [arm.link for arm in arms] == ["C1_link", "C2_link"]
    assert [round(arm.dimensions[0], 6) for arm in arms] == [0.325, 0.225]
    assert [arm.dimensions[1] for arm in arms] == [pytest.approx(2 * 0.16 * 0.225, abs=1e-6)] * 2
    site = Site(chain)
    for arm, joint, after in zip(arms, site.tool_path, site.tool_path[1:], strict=False):
        T = site.links[arm.link] @ arm.T_link_body
        half = T[:3, 0] * arm.dimensions[0] / 2
        assert (T[:3, 3] - half)[:2] == pytest.approx(site.origin(joint)[:2], abs=1e-6)
        assert (T[:3, 3] + half)[:2] == pytest.approx(site.origin(after)[:2], abs=1e-6)


def test_the_arms_of_a_scara_are_above_what_the_quill_lifts() -> None:
    chain, bodies = drawn("scara_kin36")
    high = shown_limits(chain)[1]
    first, second = parts(bodies, "arm")
    under = placements(chain, [first], high)[0][2, 3] - first.dimensions[2] / 2
    assert under > frame_placement(chain, "flange", high)[2, 3]
    assert placements(chain, [second], high)[0][2, 3] > placements(chain, [first], high)[0][2, 3]
    (ram,) = parts(bodies, "ram")
    for axes in (shown_limits(chain)[0], high):  # the quill never leaves the second arm
        low_end, top = (placements(chain, [ram], axes)[0][2, 3] + sign * ram.dimensions[1] / 2 for sign in (-1, 1))
        assert low_end < under
        assert top > placements(chain, [second], axes)[0][2, 3] + second.dimensions[2] / 2


@pytest.mark.parametrize("name", ["lever_kin85", "85 with a short lever"])
def test_the_lever_swings_between_the_cheeks_of_its_tower(name: str) -> None:
    chain, bodies = drawn(name)
    (lever,) = parts(bodies, "lever")
    assert lever.origin == "data"
    way = chain.frame("tool").T_link_frame[:3, 3]
    along = way / np.linalg.norm(way)
    half = lever.dimensions[0] / 2
    assert lever.T_link_body[:3, 0] == pytest.approx(along, abs=1e-9)
    assert np.linalg.norm(lever.T_link_body[:3, 3] + half * along) == pytest.approx(0.8 * np.linalg.norm(way), abs=2e-6)
    assert np.cross(lever.T_link_body[:3, 3], along) == pytest.approx(np.zeros(3), abs=1e-6)
    cheeks = parts(bodies, "cheek")
    (pin,) = parts(bodies, "joint")
    assert pin.dimensions[1] == pytest.approx(2.4 * lever.dimensions[1], abs=2e-6)
    assert pin.T_link_body[:3, 3] == pytest.approx(np.zeros(3), abs=1e-9)
    assert abs(pin.T_link_body[1, 2]) == pytest.approx(1.0)
    for axes in corners(chain):
        (T, *places) = placements(chain, [lever, *cheeks], axes)
        assert min(gap(lever, T, cheek, place) for cheek, place in zip(cheeks, places, strict=True)) > 0.0
        sides = [place[1, 3] - T[1, 3] for place in places]
        assert sides[0] == pytest.approx(-sides[1], abs=1e-6)


@pytest.mark.parametrize(
    ("name", "values", "limits"),
    [
        ("36", {1: 100.0, 2: 325.0, 3: 225.0}, {"C1": (-130.0, 130.0), "C2": (5.0, 145.0), "Z": (0.0, 300.0)}),
        ("85", {1: 300.0, 2: 600.0}, {"X": (-500.0, 500.0), "C": (-80.0, 80.0)}),
        ("205", {1: 50.0, 2: 80.0, 16: 1.0}, {"X": (-200.0, 200.0), "C": (5.0, 175.0), "Z": (-150.0, 100.0)}),
    ],
)
def test_a_tip_that_goes_below_the_zero_lowers_the_bed(
    name: str, values: dict[int | str, float], limits: dict[str, tuple[float, float]]
) -> None:
    """The bed is nine hundredths of the extent below the lowest tip, and the part takes six tenths of that."""
    chain = build(int(name), values).robot.chain
    axes = tuple(
        replace(a, lower=limits[a.name][0], upper=limits[a.name][1], assumed=False) if a.name in limits else a
        for a in chain.axes
    )
    chain = replace(chain, axes=axes)
    bodies, site = drawn_bodies(chain), Site(chain)
    lowest = min(frame_placement(chain, "tool", corner)[2, 3] for corner in corners(chain))
    assert lowest < 0.0
    slides = [(b - a) / 1000 for key, (a, b) in limits.items() if key in "XZ"]
    room = 0.09 * max(machine_size(chain), *slides)
    (bed,), (part,) = parts(bodies, "bed"), parts(bodies, "workpiece")
    top = site.bounds(bed)[1, 2]
    assert top == pytest.approx(lowest - room, abs=1e-5)
    assert site.bounds(part)[:, 2] == pytest.approx((top, top + min(0.6 * room, part.dimensions[0])), abs=1e-5)
    if name == "85":
        (guide,), (carriage,) = parts(bodies, "guide"), parts(bodies, "carriage")
        assert site.bounds(guide)[:, 2] == pytest.approx((top, top + 0.13 * room), abs=1e-5)
        assert site.bounds(carriage)[1, 2] == pytest.approx(top + 0.45 * room, abs=1e-5)


def test_the_bed_of_a_lathe_reaches_under_headstock_and_column() -> None:
    """The tool that points to the right comes from the other side: there the headstock is beyond the column."""
    chain, _ = drawn("202 to the right")
    axes = tuple(replace(a, lower=-400.0, upper=-120.0, assumed=False) if a.name == "XQ" else a for a in chain.axes)
    chain = replace(chain, axes=axes)
    bodies, site = drawn_bodies(chain), Site(chain)
    (bed,), (column,) = parts(bodies, "bed"), parts(bodies, "column")
    (stock,) = [body for body in parts(bodies, "housing") if body.link == BASE_LINK]
    edge = 0.06 * max(
        machine_size(chain), *(site.stroke(joint)[1] - site.stroke(joint)[0] for joint in site.tool_path[:2])
    )
    assert site.bounds(stock)[1, 0] > site.bounds(column)[1, 0]
    assert site.bounds(bed)[:, 0] == pytest.approx(
        (site.bounds(column)[0, 0] - edge, site.bounds(stock)[1, 0] + edge), abs=1e-5
    )
    assert site.bounds(bed)[:, 1] == pytest.approx(
        (site.bounds(stock)[0, 1] - edge, site.bounds(column)[1, 1]), abs=1e-5
    )
    for place in home_and_middle(chain):
        assert overlaps(chain, bodies, place, CONTACT) == []


def test_the_part_stands_where_the_lever_reaches_and_the_slide_does_not() -> None:
    chain, bodies = drawn("lever_kin85")
    (part,), (carriage,) = parts(bodies, "workpiece"), parts(bodies, "carriage")
    high = shown_limits(chain)[1]
    T, place = placements(chain, [part, carriage], high)
    assert gap(part, T, carriage, place) > 0.0
    reach = max(frame_placement(chain, "tool", axes)[0, 3] for axes in corners(chain))
    assert T[0, 3] < reach
    assert part.T_link_body[2, 3] == pytest.approx(part.dimensions[2] / 2, abs=1e-6)  # on the bed, at the zero


@pytest.mark.parametrize(
    ("name", "link", "part"), [("scara_kin36", "C1_link", "arm"), ("lever_kin85", "C_link", "lever")]
)
def test_a_given_radius_is_drawn(name: str, link: str, part: str) -> None:
    chain, _ = drawn(name)
    links = tuple(replace(entry, radius=0.02) if entry.name == link else entry for entry in chain.links)
    body = next(b for b in drawn_bodies(replace(chain, links=links)) if b.link == link and b.part == part)
    assert body.dimensions[1] == 0.04
