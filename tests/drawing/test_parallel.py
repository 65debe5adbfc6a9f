"""Machines with closed loops: their bodies hang together, keep clear of one another and end where the loops close."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import chainbuild
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.bodies.body import BASE_COLOUR, PART_COLOUR, WORKPIECE_SIDE, Body
from chainbuild.chain.bodies.shapes import machine_size, shown_limits
from chainbuild.chain.elements import BASE_LINK, Chain
from chainbuild.chain.poses import frame_placement
from chainbuild.drawing.machine import drawn_bodies
from chainbuild.drawing.site import Site
from chainbuild.frames import translation
from tests.kit.drawings import corners, ends, gap, gaps_between, home_and_middle, islands, nearest, overlaps, placements
from tests.kit.twincat_files import chain_of

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
# A tripod whose platform is small for its rods: counts of HD1 (of Z), HD5, HD6, HD7 by index.
SMALL = {0: 800_000, 4: 4_200_000, 5: 300_000, 6: 6_500_000}
# Shifts and turns of a platform or table that no casting stands for.
VIRTUAL = {f"platform_{letter}_link" for letter in "xy"} | {f"table_{letter}_link" for letter in "zxyab"}
# Parts that touch faces: neither stands inside the other, and there is no gap.
TOUCHING = {
    "tripod_kin12": "carriage guide, guide column, column bed, beam column, table bed, workpiece table, "
    "housing platform, spindle platform, spindle tool",
    "tripod_table_kin209": "carriage guide, guide column, column bed, beam column, pedestal bed, workpiece table",
    "delta_kin37": "housing plate, housing joint, post beam, post bed, workpiece bed, spindle platform",
    "rod_table_kin19": "carriage guide, column guide, column bed, slide bridge, bridge guide, post guide, post bed, "
    "workpiece table, spindle slide",
    "lambda_kin21": "carriage guide, carriage joint, guide beam, post beam, post bed, workpiece bed",
}
CONTACT = 1e-5  # m: bodies that touch, to the last digits of coal
FACE = 1e-4  # m: likewise where a cylinder lies on a face
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
def test_faces_touch(name: str) -> None:
    chain, bodies = drawn(name)
    for axes in home_and_middle(chain):
        for pair in TOUCHING[name].split(", "):
            one, other = pair.split()
            gaps = nearest(chain, bodies, one, other, axes)
            assert gaps == pytest.approx(np.zeros(len(gaps)), abs=FACE), pair


@pytest.mark.parametrize(("name", "choice"), [*((name, "") for name in MACHINES), *VARIANTS])
def test_the_bed_is_below_everything(name: str, choice: str) -> None:
    chain, bodies = drawn(name, choice)
    site = Site(chain)
    bed = min(parts(bodies, "bed"), key=lambda body: site.bounds(body)[0, 2])
    thick = bed.dimensions[2 if bed.kind == "box" else 1]
    assert min(site.bounds(body)[0, 2] for body in bodies if body is not bed) == pytest.approx(
        site.bounds(bed)[0, 2] + thick, abs=CONTACT
    )


@pytest.mark.parametrize("name", MACHINES[:4])
def test_forks_hold_the_pins(name: str) -> None:
    """Both cheeks, or both bars of a lever, have the pin of the rod in them, and the rod's ball between them."""
    chain, bodies = drawn(name)
    home = home_and_middle(chain)[0]
    radius = min(body.dimensions[0] for body in parts(bodies, "rod"))
    cheeks = [body for body in parts(bodies, "cheek", "lever") if body.link.startswith(("Z", "J"))]
    bars = [cheek for cheek in cheeks if min(cheek.dimensions) < 1.2 * radius]
    assert len(bars) == 6
    pins = [body for body in parts(bodies, "joint") if body.kind == "cylinder" and body.link.endswith("_swing_link")]
    balls = [body for body in parts(bodies, "joint") if body.kind == "sphere"]
    assert (gaps_between(chain, bars, pins, home).min(axis=1) < -0.7 * radius).all()
    assert gaps_between(chain, bars, balls, home).min() > 0.3 * radius


def arm_end(site: Site, arm: Body) -> Vector:
    """Return where a level arm of a platform ends, seen from its middle."""
    T = site.links[arm.link] @ arm.T_link_body
    return T[:3, 3] + T[:3, 0] * arm.dimensions[0] / 2


@pytest.mark.parametrize("name", MACHINES[:4])
def test_balls_sit_in_the_platform(name: str) -> None:
    """Their middles are outside, above a platform that hangs and below a table that stands."""
    chain, bodies = drawn(name)
    site = Site(chain)
    (plate,) = [body for body in parts(bodies, "platform", "table") if body.kind == "cylinder" and on_rods(chain, body)]
    T = site.links[plate.link] @ plate.T_link_body
    radius = min(body.dimensions[0] for body in parts(bodies, "rod"))
    for loop in chain.loops:
        pin = site.frame(loop.frame_b)[:3, 3]
        height = abs(float(pin[2] - T[2, 3])) - plate.dimensions[1] / 2
        assert height == pytest.approx(0.8 * radius, abs=1e-6)
        if plate.part == "table":
            over = plate.dimensions[0] - np.linalg.norm(pin[:2] - T[:2, 3])
        else:  # an arm of the platform reaches to each pin
            ends = [arm_end(site, body) for body in parts(bodies, "lever") if body.link == plate.link]
            over = min(float(np.linalg.norm(end[:2] - pin[:2])) for end in ends)
        assert over == pytest.approx(1.5 * radius, abs=1e-6)
        assert (pin[2] > T[2, 3]) == (name != "rod_table_kin19")


def test_a_platform_that_is_not_in_the_middle_at_home() -> None:
    """One carriage starts 100 mm higher: the hub stays in the middle of the pins, and has no bracket."""
    chain, _ = drawn("tripod_kin12")
    chain = replace(chain, axes=(replace(chain.axes[0], lower=800.0), *chain.axes[1:]))
    bodies, site = drawn_bodies(chain), Site(chain)
    (plate,), (spindle,) = parts(bodies, "platform"), parts(bodies, "spindle")
    assert np.hypot(*site.tip[:2]) > 0.05
    assert plate.dimensions[0] == pytest.approx(0.62 * 0.09, abs=1e-6)
    assert spindle.dimensions[0] == pytest.approx(3 * 0.0104, abs=1e-6)
    assert not parts(bodies, "arm")
    for body in (plate, spindle):
        assert (site.links[body.link] @ body.T_link_body)[:2, 3] == pytest.approx(site.tip[:2], abs=1e-6)
    for lever in parts(bodies, "lever"):  # from the middle to 1.5 radii of a rod beyond its pin
        assert lever.dimensions[0] == pytest.approx(0.09 + 1.5 * 0.0104, abs=1e-6)
    assert len(islands(chain, bodies, site.home, GAP)) == 1
    (slim,) = parts(drawn("delta_kin37")[1], "spindle")
    assert slim.dimensions[0] == pytest.approx(3 * 0.0052, abs=1e-6)


def test_bodies_have_right_angles_where_hinges_lean() -> None:
    """With its table axis at 49 degrees at home the machine is stood up along another axis, and its hinges lean."""
    counts = {4: 4_000_000, 5: 600_000, 6: 8_000_000, 37: 488_713}
    lines = [f"trafo[0].param[{n}] {value}" for n, value in counts.items()]
    for body in drawn_bodies(chain_of(["trafo[0].id 209", *lines])):
        R = body.T_link_body[:3, :3]
        np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-9)


@pytest.mark.parametrize("height", [40.0, 0.0])
def test_the_top_of_the_table_is_the_zero_of_the_workpiece(height: float) -> None:
    """Or above it, where the zero is in the plate of the table (HD5 = 0)."""
    values = {0: 800_000, 1: 5_000_000, 2: 1_500_000, 3: 3_000_000, 4: height * 10_000}
    lines = ["trafo[0].id 19", *(f"trafo[0].param[{n}] {value:.0f}" for n, value in values.items())]
    chain = chain_of(lines, conventions={"kin19_guide": "radial_planes"})
    for lift in (0.0, 30.0):  # of one carriage at home: the table is tilted
        first = next(n for n, axis in enumerate(chain.axes) if axis.name == "Z1")
        limits = [(-760.0, -690.0) if axis.name[0] == "Z" else (-250.0, 250.0) for axis in chain.axes]
        limits[first] = limits[first][0], limits[first][1] - lift
        pairs = zip(chain.axes, limits, strict=True)
        axes = tuple(replace(axis, lower=low, upper=high, assumed=False) for axis, (low, high) in pairs)
        bodies = drawn_bodies(replace(chain, axes=axes))
        (table,), (part,) = parts(bodies, "table"), parts(bodies, "workpiece")
        pin = chain.frame("Z1_pin").T_link_frame[:3, 3]
        zero, radius = chain.frame("workpiece").T_link_frame, 0.008
        top = max(float(zero[2, 3]), float(pin[2]) + 3 * radius)
        under = table.T_link_body[2, 3] - table.dimensions[1] / 2
        assert table.T_link_body[2, 3] + table.dimensions[1] / 2 == pytest.approx(top, abs=2e-6)
        assert under == pytest.approx(pin[2] + 0.8 * radius, abs=2e-6)
        assert table.T_link_body[:2, 3] == pytest.approx(zero[:2, 3], abs=1e-9)
        assert table.dimensions[0] == pytest.approx(0.15 + 1.5 * radius, abs=1e-6)
        assert abs(table.T_link_body[2, 2]) == pytest.approx(1.0)
        assert part.T_link_body[:3, :3] == pytest.approx(np.eye(3), abs=1e-9)
        assert part.T_link_body[2, 3] - part.dimensions[2] / 2 == pytest.approx(top, abs=2e-6)


@pytest.mark.parametrize("length", [0.0, 200.0])
def test_the_head_on_a_bridge_is_above_its_tool(length: float) -> None:
    """As high as the data put the slide, and 2.5 radii of the spindle above the tip at least."""
    chain = chainbuild.load("rod_table_kin19").chain(tool_length_mm=length)
    (head,) = parts(drawn_bodies(chain), "slide")
    site = Site(chain)
    under = max(0.0, float(site.tip[2]) + 2.5 * 0.055 * machine_size(chain))
    assert site.bounds(head)[0, 2] == pytest.approx(under, abs=1e-6)


def on_rods(chain: Chain, body: Body) -> bool:
    return body.link in {chain.frame(loop.frame_b).link for loop in chain.loops}


ROOM = {"delta_kin37": 0.13 * 0.04}


@pytest.mark.parametrize("name", MACHINES[:4])
def test_rods_are_slim(name: str) -> None:
    for body in parts(drawn(name)[1], "rod"):
        # Those of the delta robot are slimmer: its pins are 40 mm from the middle, and the pairs must not meet.
        assert body.dimensions[0] == pytest.approx(min(0.016 * body.dimensions[1], ROOM.get(name, 1.0)), abs=1e-6)


def test_balls_of_a_small_platform_keep_clear_of_one_another() -> None:
    """Pins 30 mm from the middle: the rods are as slim as leaves room between the balls, whatever their length."""
    chain = chain_of(["trafo[0].id 12", *(f"trafo[0].param[{n}] {v}" for n, v in SMALL.items())])
    bodies = drawn_bodies(chain)
    rods = parts(bodies, "rod")
    assert {body.dimensions[0] for body in rods} == {0.0039}
    starts = zip(chain.axes, (800.0, 700.0, 700.0), strict=True)
    aside = replace(chain, axes=tuple(replace(axis, lower=low, upper=1100.0, assumed=False) for axis, low in starts))
    assert np.hypot(*Site(aside).tip[:2]) > 0.05
    assert {body.dimensions[0] for body in parts(drawn_bodies(aside), "rod")} == {0.0039}
    axes = np.full(3, 700.0)
    balls = [body for body in bodies if body.kind == "sphere"]
    assert len(balls) == 12
    assert gaps_between(chain, balls, balls, axes)[~np.eye(12, dtype=bool)].min() > 0.005


def test_a_tool_beside_the_platform_hangs_on_a_bracket() -> None:
    """200 mm to the side (HD2): the spindle is under a bracket, and still ends at the tip."""
    chain = chain_of(["trafo[0].id 12", *(f"trafo[0].param[{n}] {v}" for n, v in (SMALL | {1: 2_000_000}).items())])
    bodies = drawn_bodies(chain)
    site = Site(chain)
    bracket = next(body for body in parts(bodies, "arm"))
    end = site.links[bracket.link] @ bracket.T_link_body @ np.array([bracket.dimensions[0] / 2, 0.0, 0.0, 1.0])
    assert end[:2] == pytest.approx(site.tip[:2], abs=1e-6)
    axes = site.home
    assert nearest(chain, bodies, "spindle", "arm", axes) == pytest.approx([0.0], abs=CONTACT)
    assert not parts(drawn("tripod_kin12")[1], "arm")


def test_columns_of_other_strokes_end_at_one_height() -> None:
    """The longest stroke decides: the ring lies on all three columns."""
    chain, _ = drawn("tripod_kin12")
    axes = (replace(chain.axes[0], upper=1300.0), *chain.axes[1:])
    longer = replace(chain, axes=axes)
    bodies = drawn_bodies(longer)
    site = Site(longer)
    tops = {round(float(body.T_link_body[2, 3] + body.dimensions[2] / 2), 6) for body in parts(bodies, "column")}
    assert len(tops) == 1
    assert min(site.bounds(beam)[0, 2] for beam in parts(bodies, "beam")) == pytest.approx(tops.pop(), abs=1e-6)
    assert max(site.bounds(guide)[1, 2] for guide in parts(bodies, "guide")) == pytest.approx(
        max(site.bounds(column)[1, 2] for column in parts(bodies, "column")), abs=1e-6
    )
    guides = sorted(body.dimensions[2] for body in parts(bodies, "guide"))
    assert guides[2] - guides[0] == pytest.approx(0.2, abs=2e-6)
    assert guides[1] == pytest.approx(guides[0], abs=2e-6)


def test_a_ring_joins_the_columns() -> None:
    """Each beam lies on two columns, and each column carries two beams."""
    chain, bodies = drawn("tripod_kin12")
    home = home_and_middle(chain)[0]
    table = np.abs(gaps_between(chain, parts(bodies, "beam"), parts(bodies, "column"), home)) < CONTACT
    assert np.sum(table, axis=0).tolist() == np.sum(table, axis=1).tolist() == [2, 2, 2]


@pytest.mark.parametrize("first", [-810.0, -900.0])
def test_the_floor_is_under_hanging_rods(first: float) -> None:
    """Carriages above the table: the rods end 477 mm lower, and 4.4 radii of a rod over the floor at the lowest."""
    chain, _ = drawn("rod_table_kin19", "kin19_carriages=above")
    limits = {"Z1": first}
    axes = tuple(replace(axis, lower=limits.get(axis.name, axis.lower)) for axis in chain.axes)
    other = replace(chain, axes=axes)
    (bed,) = parts(drawn_bodies(other), "bed")
    rods = 0.5**2 - 0.15**2
    lowest = first / 1000 - rods**0.5 - 4.4 * 0.008
    assert Site(other).bounds(bed)[1, 2] == pytest.approx(lowest, abs=1e-5)


def test_posts_stand_beyond_the_stretched_levers() -> None:
    """Six radii of a rod beyond them, under the ends of the beams."""
    _, bodies = drawn("delta_kin37")
    r = 0.0052
    for post, beam in zip(parts(bodies, "post"), parts(bodies, "beam"), strict=True):
        place = post.T_link_body[:3, 3]
        assert np.hypot(*place[:2]) == pytest.approx(0.15 + 0.2 + 6 * r, abs=1e-6)
        out = place * (1.0, 1.0, 0.0) / np.hypot(*place[:2])
        assert span(beam, beam.T_link_body, out) == pytest.approx((0.0, 0.35 + 8.5 * r), abs=1e-5)


def test_levers_turn_clear_of_plate_and_motors() -> None:
    """Motor and bearing sit beside the lever, plate and beams above it, over the whole range."""
    chain, bodies = drawn("delta_kin37")
    fixed = parts(bodies, "plate", "beam", "post", "housing")
    for axes in corners(chain):
        assert gaps_between(chain, parts(bodies, "lever"), fixed, axes).min() > -CONTACT
    motors = [body for body in parts(bodies, "housing") if body.dimensions[1] > 0.05]
    assert len(motors) == 3
    assert max(body.dimensions[1] for body in parts(bodies, "housing") if body not in motors) < 0.03


@pytest.mark.parametrize("strokes", [(), ((-50.0, 50.0), (-50.0, 50.0)), ((-700.0, 400.0), (-400.0, 700.0))])
def test_the_bridge_carries_the_tool_over_the_whole_range(strokes: tuple[tuple[float, float], ...]) -> None:
    """Over long strokes, and over short ones beyond the columns of the table."""
    chain, _ = drawn("rod_table_kin19")
    slides = tuple(replace(axis, lower=a, upper=b) for axis, (a, b) in zip(chain.axes[:2], strokes, strict=False))
    chain = replace(chain, axes=(*slides, *chain.axes[len(slides) :]))
    bodies, site = drawn_bodies(chain), Site(chain)
    (slide,), (bridge,) = parts(bodies, "slide"), parts(bodies, "bridge")
    rails = [body for body in parts(bodies, "guide") if body.dimensions[0] > body.dimensions[2]]
    assert len(rails) == 2
    moves = [axes for axes in corners(chain) if (axes[2:] == site.home[2:]).all()]
    assert len(moves) == 9
    for axes in moves:
        assert overlaps(chain, bodies, axes, CONTACT) == []
        places = placements(chain, [slide, bridge, *rails], axes)
        x, y = np.eye(3)[:2]
        for inner, T, outer, P, along in (
            (slide, places[0], bridge, places[1], y),
            (bridge, places[1], rails[0], places[2], x),
            (bridge, places[1], rails[1], places[3], x),
        ):
            a, b = span(inner, T, along), span(outer, P, along)
            assert b[0] <= a[0] + 1e-9
            assert a[1] <= b[1] + 1e-9
        assert gaps_between(chain, [bridge], rails, axes) == pytest.approx(np.zeros((1, 2)), abs=CONTACT)
    assert gaps_between(chain, parts(bodies, "post"), parts(bodies, "column"), site.home).min() > 0.0


def other_lambda() -> Chain:
    """The lambda with a longer tool and a ram whose home is in the middle of its stroke, 350 mm lower."""
    chain = chainbuild.load("lambda_kin21").chain(tool_length_mm=75.0)
    return replace(chain, axes=tuple(replace(a, lower=-250.0, upper=50.0) if a.name == "Z" else a for a in chain.axes))


@pytest.mark.parametrize("other", [False, True])
def test_the_ram_of_the_lambda_stays_in_its_housing(other: bool) -> None:
    """The bed is under every tip, the arm above all that hangs from the ram."""
    chain = other_lambda() if other else drawn("lambda_kin21")[0]
    bodies = drawn_bodies(chain)
    (bed,), (ram,), (housing,) = parts(bodies, "bed"), parts(bodies, "ram"), parts(bodies, "housing")
    arms = [body for body in parts(bodies, "arm") if body.link == "theta_link"]
    hand = [body for body in bodies if body.link == "C_link"]
    x, y, z = np.eye(3)
    (x0, x1), (y0, y1) = (span(bed, bed.T_link_body, along) for along in (x, y))
    for axes in corners(chain):
        tip = frame_placement(chain, "tool", axes)[:3, 3]
        assert x0 < tip[0] < x1
        assert y0 < tip[1] < y1
        places = placements(chain, [ram, housing], axes)
        a, b = (span(body, T, z) for body, T in zip((ram, housing), places, strict=True))
        assert a[0] < b[0]
        assert b[1] < a[1]
        assert places[0][:2, 3] == pytest.approx(places[1][:2, 3], abs=1e-6)
        assert gaps_between(chain, arms, hand, axes).min() > 0.02


@pytest.mark.parametrize("other", [False, True])
def test_the_hand_of_the_lambda_reaches_from_the_ram_to_over_the_tip(other: bool) -> None:
    chain = other_lambda() if other else drawn("lambda_kin21")[0]
    bodies, site = drawn_bodies(chain), Site(chain)
    own = [body for body in bodies if body.link == "C_link"]
    (arm,), (neck,), (tool,) = ([body for body in own if body.part == part] for part in ("arm", "joint", "tool"))
    low, high = site.bounds(arm)[:, 2]
    assert site.bounds(neck)[:, 2] == pytest.approx((low, site.links["C_link"][2, 3]), abs=1e-6)
    assert site.tip[2] < low < high < site.links["C_link"][2, 3]
    ends_of_arm = [site.links["C_link"] @ arm.T_link_body @ (sign * arm.dimensions[0] / 2, 0, 0, 1) for sign in (-1, 1)]
    assert ends_of_arm[0][:2] == pytest.approx(site.links["C_link"][:2, 3], abs=1e-6)
    assert ends_of_arm[1][:2] == pytest.approx(site.tip[:2], abs=1e-6)
    assert site.bounds(tool)[1, 2] > site.tip[2]


def test_a_tool_under_the_ram_of_the_lambda_needs_no_hand() -> None:
    values = {0: 1_000_000, 1: 9_000_000, 2: 9_000_000, 3: 15_000_000, 4: 1_200_000, 6: -11_000_000}
    chain = chain_of(["trafo[0].id 21", *(f"trafo[0].param[{n}] {value}" for n, value in values.items())])
    limits = {"X1": (-900.0, -450.0), "X2": (450.0, 850.0), "Z": (100.0, 400.0), "C": (-180.0, 180.0)}
    axes = tuple(replace(a, lower=limits[a.name][0], upper=limits[a.name][1], assumed=False) for a in chain.axes)
    chain = replace(chain, axes=axes)
    bodies = drawn_bodies(chain)
    assert {body.part for body in bodies if body.link == "C_link"} == {"joint", "spindle", "tool"}
    home = home_and_middle(chain)[0]
    assert len(islands(chain, bodies, home, GAP)) == 1
    assert overlaps(chain, bodies, home, CONTACT) == []


def test_the_legs_of_the_lambda_stand_beyond_its_guides() -> None:
    chain, bodies = drawn("lambda_kin21")
    site = Site(chain)
    (beam,), guides, posts = parts(bodies, "beam"), parts(bodies, "guide"), parts(bodies, "post")
    left, right = site.bounds(beam)[:, 0]
    inner = min(site.bounds(guide)[0, 0] for guide in guides), max(site.bounds(guide)[1, 0] for guide in guides)
    assert [site.bounds(post)[:, 0].tolist() for post in posts] == [
        pytest.approx([left, inner[0]], abs=1e-5),
        pytest.approx([inner[1], right], abs=1e-5),
    ]


def test_the_arms_of_the_lambda_ride_on_top_of_the_carriages() -> None:
    chain, bodies = drawn("lambda_kin21")
    (rod,) = parts(bodies, "rod")
    assert rod.dimensions == (pytest.approx(0.022 * 0.9, abs=1e-6), pytest.approx(0.9, abs=1e-6))
    arms = parts(bodies, "arm", "rod")
    for axes in home_and_middle(chain):
        assert gaps_between(chain, parts(bodies, "carriage"), arms, axes).min() > 0.01
    (elbow,) = [body for body in bodies if body.kind == "sphere"]
    main = [body for body in parts(bodies, "arm") if body.link == "theta_link"]
    assert (gaps_between(chain, [elbow], main, home_and_middle(chain)[0]) < -0.02).all()


def test_the_bed_follows_a_workpiece_below_the_tips() -> None:
    """A zero 50 mm lower is the table's top; one above the lowest tip, or far below, is not."""
    chain, _ = drawn("tripod_kin12")
    for zero, follows in ((-0.05, True), (0.03, True), (0.05, False), (-3.0, False)):
        frames = tuple(
            replace(frame, T_link_frame=translation(z=zero)) if frame.name == "workpiece" else frame
            for frame in chain.frames
        )
        other = replace(chain, frames=frames)
        bodies = drawn_bodies(other)
        (table,) = parts(bodies, "table")
        height = table.T_link_body[2, 3] + table.dimensions[1] / 2
        assert height == pytest.approx(zero if follows else 0.06 - 0.09 * machine_size(other), abs=1e-5)
        (part,) = parts(bodies, "workpiece")
        assert part.dimensions[2] == pytest.approx(min(0.6 * (0.06 - height), part.dimensions[0]), abs=1e-5)


def test_the_overlay_gives_the_part() -> None:
    chain, _ = drawn("tripod_kin12")

    def part_of(edges: tuple[float, float, float]) -> list[Body]:
        geometry = replace(chain.geometry, stand=replace(chain.geometry.stand, part=edges))
        return parts(drawn_bodies(replace(chain, geometry=geometry)), "workpiece")

    (part,) = part_of((0.1, 0.2, 0.03))
    assert (part.dimensions, part.origin) == ((0.1, 0.2, 0.03), "data")
    assert part_of((0.1, 0.2, 0.0)) == []


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
    """The middle of a pair does, where there is one; the rods of a pair are parallel, and their balls at their ends."""
    chain, bodies = drawn(name)
    for axes in (home_and_middle(chain)[0], *reached(chain, 2)):
        placed = list(zip(bodies, placements(chain, bodies, axes), strict=True))
        for loop in chain.loops:
            link = chain.frame(loop.frame_a).link
            rods = [rod_ends(body, T) for body, T in placed if body.part == "rod" and body.link == link]
            assert len(rods) == (1 if name in ("rod_table_kin19", "lambda_kin21") else 2)
            start, end = np.mean(rods, axis=0)
            for frame in (loop.frame_a, loop.frame_b):
                assert end == pytest.approx(frame_placement(chain, frame, axes)[:3, 3], abs=1e-6)
            assert np.ptp([b - a for a, b in rods], axis=0) == pytest.approx(np.zeros(3), abs=1e-6)
            balls = [T[:3, 3] for body, T in placed if body.kind == "sphere" and body.link == link]
            assert balls == [pytest.approx(place, abs=1e-6) for rod in rods for place in rod]
            swing = f"{loop.name.removesuffix('_rod')}_swing_link"
            assert np.linalg.norm(start - swing_origin(chain, swing, axes)) < 1e-6


def rod_ends(body: Body, T: Matrix) -> Matrix:
    """Return both ends (2, 3) of a rod."""
    half = T[:3, 2] * body.dimensions[1] / 2
    return np.array([T[:3, 3] - half, T[:3, 3] + half])


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
        if (axes == home)[turned].all():
            assert gaps_between(chain, [part], tools, axes).min() > 0.0


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
    rod, *_ = [body for body in drawn_bodies(replace(chain, links=links)) if body.link == link and body.part == "rod"]
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
