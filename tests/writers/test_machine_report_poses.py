"""Check poses of a report: inside all limits, away from singular positions and bodies; each tells an error."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import chainbuild
from chainbuild.analysis.singularity.measures import smallest_value
from chainbuild.chain.poses import frame_placement, link_placements
from chainbuild.collision.model import CollisionModel
from chainbuild.collision.solids import solids_of
from chainbuild.frames import rot_about, transform
from chainbuild.robot import Robot
from chainbuild.writers.machine_report.checkform import bodies_in_words, check_chapter, tool_in_words
from chainbuild.writers.machine_report.checkposes import CheckPoses, check_poses, moved_both_ways
from chainbuild.writers.machine_report.document.blocks import Bullets, TableBlock

# An arm, limits on a sum, drives behind a gear and behind spatial angles, a table, held axes, a lift, closed loops.
NAMES = [
    "kr6r900", "parallelogram_nr", "geared_head_kin28", "cardan_head_kin59", "ac_table_kin58", "irb2600_table",
    "gantry_robot_kin210", "tripod_kin12", "rotated_head_kin70",
]  # fmt: skip


@cache
def robot(name: str) -> Robot:
    return Robot.load(name)


@cache
def poses(name: str) -> CheckPoses:
    return check_poses(robot(name))


def way(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    return start + np.linspace(0.0, 1.0, 41)[:, None] * (end - start)


@pytest.mark.parametrize("name", NAMES)
def test_every_pose_is_safe(name: str) -> None:
    found, machine = poses(name), robot(name)
    bodies = CollisionModel(machine)
    assert len(found.poses) == found.wanted == max(10, len(machine.axes) + 3)
    for pose in found.poses:
        assert machine.violated_limits(pose.axes) == ()
        assert smallest_value(machine, pose.axes) > 0.05
        assert not bodies.collides(pose.axes)
        assert np.isfinite(machine.drives(pose.axes)).all()
        assert np.isfinite(machine.fk(pose.axes).homogeneous).all()
        np.testing.assert_array_equal(pose.axes, np.round(pose.axes))


@pytest.mark.parametrize("name", NAMES)
def test_the_straight_ways_are_free(name: str) -> None:
    found, machine = poses(name), robot(name)
    bodies = CollisionModel(machine)
    starts = [found.poses[0].axes] if found.home is None else [found.poses[0].axes, found.home]
    for start in starts:
        for pose in found.poses:
            for row in way(start, pose.axes):
                assert machine.violated_limits(row) == ()
                assert not bodies.collides(row)


def lowest_point(machine: Robot, axes: np.ndarray) -> float:
    """Return the lowest height [m] of the capsules behind the first joint, and of the tool, in the base."""
    chain = machine.chain
    links = link_placements(chain, chain.axis_map.q(axes))
    heights = [float(frame_placement(chain, "tool", axes)[2, 3])]
    for solid in solids_of(chain):
        if solid.kind == "capsule" and solid.link not in ("base", chain.joints[0].child):
            T = links[solid.link] @ solid.T_link_solid
            heights += [T[2, 3] + side * T[2, 2] * solid.size[1] / 2.0 - solid.size[0] for side in (-1.0, 1.0)]
    return min(heights)


@pytest.mark.parametrize("name", ["palletiser_nr4", "kr6r900_2"])
def test_nothing_comes_below_the_floor(name: str) -> None:
    """The base stands at 0, and these arms at home above it."""
    found, machine = poses(name), robot(name)
    assert found.floor == 0.0
    for start in (found.poses[0].axes, np.zeros(len(machine.axes))):
        for pose in found.poses:
            assert min(lowest_point(machine, row) for row in way(start, pose.axes)[::4]) > -1e-3
    assert "; nothing comes below Z 0 mm of the base." in bullets(name).items[1].parts[0]


def test_a_machine_that_hangs_below_its_base_has_its_floor_at_home() -> None:
    machine = robot("kr6r900")
    base = replace(
        machine.chain.joints[0], T_parent_joint=transform(rot_about([1.0, 0.0, 0.0], 180.0), [0.0, 0.0, -0.4])
    )
    hanging = Robot(replace(machine.chain, joints=(base, *machine.chain.joints[1:])))
    found = check_poses(hanging)
    assert found.floor == pytest.approx(lowest_point(hanging, np.zeros(6)), abs=0.02)  # a ball counts, too
    assert len(found.poses) == found.wanted
    assert poses("ac_table_kin58").floor is None


def test_the_form_says_which_bodies_were_looked_at() -> None:
    """No data place bodies of a table machine that could touch: to say that none does would be no help."""
    assert poses("ac_table_kin58").watched == ()
    said = [item.parts[0] for item in bullets("ac_table_kin58").items]
    assert "Collisions were NOT looked for" in said[1]
    assert "collisions" not in said[2]
    said = [item.parts[0] for item in bullets("tripod_kin12").items]
    assert "These bodies, assumed by rule, do not touch: platform_z_link, Z1_swing_link, Z1_lean_link," in said[1]
    assert "free of collisions of these bodies" in said[2]


def test_the_form_says_with_which_tool_its_poses_are() -> None:
    assert (
        bullets("kr6r900")
        .items[0]
        .parts[0]
        .endswith("the tool is that of this report: none, the TCP is in the flange.")
    )
    chain = robot("kr6r900").chain
    tool = transform(rot_about([0.0, 1.0, 0.0], 30.0), [0.1, 0.0, -0.0255])
    frames = tuple(
        replace(one, T_link_frame=one.T_link_frame @ tool) if one.name == "tool" else one for one in chain.frames
    )
    said = tool_in_words(replace(chain, frames=frames)).replace("\u00a0", " ")
    assert said == "TCP at X 100 mm, Z -25.5 mm of the flange, its axes turned by 30°"


def test_bodies_are_said_to_come_from_where_they_do() -> None:
    chain = robot("kr6r900").chain
    given = replace(chain, geometry=replace(chain.geometry, shapes={"base": ()}))
    assert bodies_in_words(chain) == "assumed by rule"
    assert bodies_in_words(given) == "given by the overlay, else assumed by rule"
    assert bodies_in_words(replace(given, dialect="URDF")) == "given by the URDF"


@pytest.mark.parametrize("name", NAMES)
def test_each_axis_is_moved_alone_and_to_both_sides(name: str) -> None:
    found = poses(name)
    first = found.poses[0].axes
    for pose in found.poses:
        moved = np.flatnonzero(pose.axes != first)
        assert pose.moved is None or moved.tolist() == [pose.moved]
    assert {pose.moved for pose in found.poses} == {None, *range(len(first))}
    assert moved_both_ways(found.poses).all()


def test_axes_that_bodies_hold_to_one_side_are_named() -> None:
    name = "cac_table_kin64"
    both = moved_both_ways(poses(name).poses)
    lacking = [axis.name for axis, has in zip(robot(name).axes, both, strict=True) if not has]
    assert 0 < len(lacking) < len(both)
    said = next(item.parts[0] for item in bullets(name).items if "to both sides" in item.parts[0])
    assert re.findall(r"\b[A-Z]\d?\b", said.removeprefix("No safe poses move ")) == lacking


def bullets(name: str) -> Bullets:
    return next(block for block in check_chapter(robot(name), poses(name)).blocks if isinstance(block, Bullets))


def form(name: str) -> TableBlock:
    return next(block for block in check_chapter(robot(name), poses(name)).blocks if isinstance(block, TableBlock))


@pytest.mark.parametrize("name", NAMES)
def test_the_form_says_what_the_control_displays(name: str) -> None:
    machine, table = robot(name), form(name)
    start = table.head.index("") + 1
    assert len(table.rows) == 2 * len(poses(name).poses)
    for pose, upper, lower in zip(poses(name).poses, table.rows[::2], table.rows[1::2], strict=True):
        shown = machine.display(pose.axes)
        columns = [column for column in shown if column not in {axis.name for axis in machine.axes if axis.held}]
        np.testing.assert_allclose([float(cell) for cell in upper[start:-1]], [shown[c] for c in columns], atol=5.1e-4)
        assert [cell for cell in lower if cell] == ["shown"]
        values = [cell.split("\u00a0") for cell in upper[2].split(", ")]
        assert [name for name, *_ in values] == [axis.name for axis in machine.axes]
        np.testing.assert_allclose([float(v[1].rstrip("°")) for v in values], pose.axes, atol=0.0)


def test_drives_stand_in_the_form_where_they_are_elsewhere() -> None:
    machine, table = robot("geared_head_kin28"), form("geared_head_kin28")
    assert table.head[3] == "DRIVES"
    pose = poses("geared_head_kin28").poses[0]
    drives = [float(cell.split("\u00a0")[1].rstrip("°")) for cell in table.rows[0][3].split(", ")]
    np.testing.assert_allclose(drives, machine.drives(pose.axes), atol=5.1e-4)
    assert "DRIVES" not in form("kr6r900").head


@pytest.mark.parametrize("n", range(6))
def test_a_reversed_axis_shows_where_it_alone_is_moved(n: int) -> None:
    """What the control would show with the direction of one axis reversed in its data is not what is expected."""
    machine = chainbuild.load("kr6r900")
    datum = next(one for one in machine.geometry() if one.name == f"$MC_ROBX_AXES_DIR[{n}]")
    wrong = Robot(machine.with_values({datum: -datum.value}).chain())
    pose = next(one for one in poses("kr6r900").poses if one.moved == n)
    first = poses("kr6r900").poses[0].axes
    moved = [one.fk(first).actInv(one.fk(pose.axes)) for one in (robot("kr6r900"), wrong)]
    assert not moved[0].isApprox(moved[1], 1e-3)


def test_the_poses_are_the_same_every_time() -> None:
    again = check_poses(Robot.load("parallelogram_nr"))
    for one, other in zip(poses("parallelogram_nr").poses, again.poses, strict=True):
        np.testing.assert_array_equal(one.axes, other.axes)


def test_home_that_is_not_safe_is_told() -> None:
    for name, why in (
        ("parallelogram_nr", "it violates the limits of parallelogram angle"),
        ("oblique_head_kin11", "B_link and A_link touch there"),
    ):
        assert poses(name).home is None
        told = next(item.parts[0] for item in bullets(name).items if "Find your own way to pose 1" in item.parts[0])
        assert why in told


def test_a_machine_that_is_singular_everywhere_has_no_poses() -> None:
    """A second turn about the first axis' line loses a freedom in every position."""
    machine = chainbuild.load("kr6r900")
    zero = {one: 0.0 for one in machine.geometry() if "DHPAR4_5ALPHA" in one.name}
    lost = Robot(machine.with_values(zero).trial_chain())
    found = check_poses(lost)
    assert found.poses == ()
    assert "No safe pose was found" in check_chapter(lost, found).blocks[0].parts[0]
