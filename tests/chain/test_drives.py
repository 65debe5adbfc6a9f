"""Drives as data: affine maps, side by side, and through the composition of chains."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from chainbuild import AffineDrives, DriveLimit, Robot, follow, stack
from chainbuild.chain.drives import DrivesSideBySide, joined_drives
from chainbuild.kinematics.limits import Limits

GEAR = AffineDrives(np.array([[1.0, 0.0], [0.5, 2.0]]), np.array([0.0, 7.0]))


def geared() -> Robot:
    """The C/A head of 28: A_drive = 2·A + 0.5·C."""
    chain = Robot.load("geared_head_kin28").chain
    return Robot(chain.with_drive_limits((DriveLimit(4, -100.0, 100.0, 60.0),)))


def test_an_affine_map() -> None:
    axes = np.array([10.0, -3.0])
    drives = GEAR.drives(axes)
    assert drives.tolist() == [10.0, 6.0]
    assert GEAR.differing == (1,)
    assert GEAR.follows.tolist() == [[True, False], [True, True]]
    assert GEAR.turning == (0, 1)
    assert GEAR.total(1).value(axes) == 6.0


def test_a_drive_has_no_limit_where_none_is_given() -> None:
    robot = Robot.load("ca_head_kin9")
    limits = Limits.of(robot.chain.with_drive_limits((DriveLimit(4, upper=30.0),)))
    for value, broken in ((-1e6, False), (29.0, False), (31.0, True)):
        assert bool(limits.broken_drives(np.array([0.0, 0.0, 0.0, 0.0, value]))) is broken
    assert (DriveLimit(4).lower, DriveLimit(4).upper, DriveLimit(4).bounded) == (-np.inf, np.inf, False)


def test_two_maps_side_by_side() -> None:
    assert joined_drives(None, 2, None, 3) is None
    joined = joined_drives(None, 1, GEAR, 2)
    assert isinstance(joined, AffineDrives)
    assert joined.drives(np.array([5.0, 10.0, -3.0])).tolist() == [5.0, 10.0, 6.0]
    apart = DrivesSideBySide(GEAR, AffineDrives.shifted(1, {0: 180.0}), 2)
    axes = np.array([10.0, -3.0, 4.0])
    assert apart.drives(axes).tolist() == [10.0, 6.0, 184.0]
    assert apart.differing == (1, 2)
    assert apart.derivative(axes).tolist() == [[1, 0, 0], [0.5, 2, 0], [0, 0, 1]]
    assert apart.follows.tolist() == [[True, False, False], [True, True, False], [False, False, True]]
    assert apart.turning == (0, 1, 2)


def test_a_reach_keeps_its_axis_behind_another_chain() -> None:
    """By 2.29 sin(A/2) is sin HD7 at most: with HD7 = 45 degrees A reaches 90."""
    head = Robot.load("cardan_head_kin59").chain.drives
    assert head is not None
    assert DrivesSideBySide(GEAR, head, 2).reach == {6: pytest.approx((-90.0, 90.0))}
    assert DrivesSideBySide(head, GEAR, 5).reach == {4: pytest.approx((-90.0, 90.0))}


@pytest.mark.parametrize("other", ["cardan_head_kin59", "ac_table_kin58", "irb2600"])
def test_composition_keeps_the_drives(other: str) -> None:
    """Each part's drives follow its own axes, whichever comes first, and limits go with them."""
    head, part = geared(), Robot.load(other)
    offset = np.eye(4)
    for whole, first, second in (
        (Robot(stack(part.chain, offset, head.chain)), part, head),
        (Robot(stack(head.chain, offset, part.chain)), head, part),
        (Robot(follow(head.chain, workpiece_of=part.chain)), head, part),
    ):
        rng = np.random.default_rng(3)
        for _ in range(5):
            a, b = rng.uniform(-40.0, 40.0, len(first.axes)), rng.uniform(-40.0, 40.0, len(second.axes))
            expected = np.concatenate([first.drives(a), second.drives(b)])
            assert whole.drives(np.concatenate([a, b])) == pytest.approx(expected, abs=1e-12)
        place = 4 if first is head else len(first.axes) + 4
        assert [(one.axis, one.upper) for one in whole.chain.drive_limits] == [(place, 100.0)]
        values = np.zeros(len(whole.axes))
        values[place] = 60.0
        assert whole.violated_limits(values) == (f"{whole.axes[place].name}_drive",)


def test_partials_get_their_drives_limits() -> None:
    head = geared()
    whole = stack(head.chain, np.eye(4), head.chain)
    assert [one.axis for one in whole.drive_limits] == [4, 9]
    moved = whole.with_drive_limits((DriveLimit(9, -50.0, 50.0),))
    assert [partial.chain.drive_limits for partial in moved.partials] == [(), (DriveLimit(4, -50.0, 50.0),)]


def test_without_limits_of_drives_nothing_is_looked_at() -> None:
    robot = Robot.load("geared_head_kin28")
    assert Limits.of(robot.chain).drives == ()
    assert robot.limits.sums == ()
    plain = Robot.load("ca_head_kin9")
    assert plain.chain.drives is None
    assert plain.drives([1, 2, 3, 4, 5]).tolist() == [1, 2, 3, 4, 5]


def test_drives_in_si() -> None:
    robot = Robot.load("geared_head_kin28")
    si = robot.drives([0.001, 0.002, 0.003, np.radians(10.0), np.radians(20.0)], units="si")
    assert si == pytest.approx([0.001, 0.002, 0.003, np.radians(10.0), np.radians(45.0)], abs=1e-15)


def test_the_repr_of_an_axis_says_that_its_range_depends() -> None:
    axis = replace(Robot.load("ca_head_kin9").axes[4], widest=(-200.0, 200.0))
    assert "depends on others" in repr(axis)
    assert axis.range == (-200.0, 200.0)


def test_a_limit_of_a_drive_at_its_axis_value_counts_too() -> None:
    plain = Robot.load("ca_head_kin9")
    robot = Robot(plain.chain.with_drive_limits((DriveLimit(4, -10.0, 10.0),)))
    assert robot.violated_limits([0, 0, 0, 0, 11]) == ("A_drive",)
    assert robot.ik(plain.fk([0, 0, 0, 0, 20])).status == "limits"
