"""Check poses of a report: inside all limits, away from singular positions and bodies; each tells an error."""

from __future__ import annotations

import re
from functools import cache

import numpy as np
import pytest

import chainbuild
from chainbuild.analysis.singularity.measures import smallest_value
from chainbuild.collision.model import CollisionModel
from chainbuild.robot import Robot
from chainbuild.writers.machine_report.checkform import check_chapter
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
