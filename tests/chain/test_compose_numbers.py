"""What composition counts: groups of partials, zeros of reversed joints, axes of drives, signs in sums."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from chainbuild.chain.assemble import assemble, linear, mark, rotary, shift
from chainbuild.chain.compose import beside, displaced, follow, stack
from chainbuild.chain.drives import AffineDrives, DriveLimit, DrivesSideBySide
from chainbuild.chain.elements import Axis, Chain
from chainbuild.chain.poses import pose
from chainbuild.frames import rot_x, transform


def table(offset_deg: float, offset_mm: float = 0.0) -> Chain:
    """A slide and a rotary table under a quill, whose axes have zeros of their own."""
    axes = (
        Axis("Z", "linear", "mm", -500.0, 500.0, False),
        Axis("Y", "linear", "mm", -500.0, 500.0, False),
        Axis("C", "rotary", "deg", -170.0, 170.0, False),
    )
    tool = [shift(z=300.0), linear("Z", "z"), mark("flange"), shift(x=5.0)]
    under = [
        linear("Y", "y", offset_mm=offset_mm),
        shift(x=70.0),
        rotary("C", "z", offset_deg=offset_deg),
        shift(y=20.0),
    ]
    body = assemble(axes, tool, under)
    return Chain("table", "table", "test", "test", body.links, body.joints, body.frames, axes, body.axis_map, "rpy")


def groups(chain: Chain) -> list[int]:
    return [partial.group for partial in chain.partials]


def test_groups_are_numbered_on(arm: Chain, scara: Chain) -> None:
    head = stack(scara, np.eye(4), arm)
    assert groups(head) == [0, 0]
    followed = follow(head, workpiece_of=arm)
    assert groups(followed) == [0, 0, 1]
    assert groups(beside(followed, scara)) == [0, 0, 1, 2]
    assert groups(beside(beside(arm, scara), followed)) == [0, 1, 2, 2, 3]
    assert groups(beside(followed, beside(beside(arm, scara), scara))) == [0, 0, 1, 2, 3, 4]


def test_first_axes_of_partials_follow_one_another(arm: Chain, scara: Chain) -> None:
    whole = beside(follow(stack(scara, np.eye(4), arm), workpiece_of=scara), arm)
    assert [partial.first_axis for partial in whole.partials] == [0, 4, 10, 14]
    assert len(whole.axes) == 20


@pytest.mark.parametrize(("offset_deg", "offset_mm"), [(0.0, 0.0), (30.0, 0.0), (0.0, 40.0), (-75.0, -12.5)])
def test_a_carried_table_keeps_the_zeros_of_its_axes(arm: Chain, offset_deg: float, offset_mm: float) -> None:
    guest = table(offset_deg, offset_mm)
    assert bool(offset_deg or offset_mm) == any(joint.zero for joint in guest.joints)
    T = transform(rot_x(25.0), (0.1, -0.2, 0.3))
    on, mine = np.array([10.0, -80.0, 70.0, 20.0, 30.0, 40.0]), np.array([12.0, -34.0, 56.0])
    stacked = pose(stack(arm, T, guest), np.concatenate([on, mine]))
    assert np.abs(stacked - pose(arm, on) @ T @ pose(guest, mine)).max() < 1e-12
    followed = pose(follow(arm, workpiece_of=guest), np.concatenate([on, mine]))
    assert np.abs(followed - np.linalg.inv(pose(guest, mine)) @ pose(arm, on)).max() < 1e-12


def test_reversed_joints_show_the_zeros_they_are_drawn_at(arm: Chain) -> None:
    """Seen from the workpiece, table joints turn against their drawing; where that stands is the same place."""
    guest = table(30.0)
    whole = stack(arm, np.eye(4), guest)
    own = {joint.name: joint for joint in guest.joints}
    for joint in whole.joints:
        if joint.name in own:
            assert joint.zero == own[joint.name].zero
    turned = next(joint for joint in whole.joints if joint.name == "C")
    assert turned.direction.tolist() == (-own["C"].direction).tolist()
    assert not np.signbit(turned.direction[turned.direction == 0.0]).any()


def test_limits_of_drives_stay_with_their_axes(arm: Chain, scara: Chain) -> None:
    limited = replace(
        scara,
        drives=AffineDrives.shifted(4, {1: 10.0, 3: -20.0}),
        drive_limits=(DriveLimit(1, -30.0, 40.0), DriveLimit(3, -50.0, 60.0, 70.0)),
    )
    names = [scara.axes[n].name for n in (1, 3)]
    for whole, first in ((stack(arm, np.eye(4), limited), 6), (stack(limited, np.eye(4), arm), 0)):
        assert [one.axis for one in whole.drive_limits] == [first + 1, first + 3]
        assert [whole.axes[one.axis].generic or whole.axes[one.axis].name for one in whole.drive_limits] == [
            scara.axes[n].generic or name for n, name in zip((1, 3), names, strict=True)
        ]
        assert whole.drives is not None
        moved = whole.drives.drives(np.zeros(10))
        assert moved.nonzero()[0].tolist() == [first + 1, first + 3]
        assert moved[[first + 1, first + 3]].tolist() == [10.0, -20.0]


def test_an_end_of_a_drive_that_is_not_given_is_no_limit() -> None:
    assert (DriveLimit(0).lower, DriveLimit(0).upper) == (-np.inf, np.inf)
    assert not DriveLimit(0, max_speed=5.0).bounded
    assert DriveLimit(0, upper=5.0).bounded


def test_drives_side_by_side_count_on() -> None:
    class Reaching(AffineDrives):
        @property
        def reach(self) -> dict[int, tuple[float, float]]:
            return {1: (-80.0, 90.0)}

    first, second = Reaching(np.eye(3), np.zeros(3)), Reaching(np.diag([1.0, 0.0]), np.array([0.0, 5.0]))
    both = DrivesSideBySide(first, second, 3)
    assert both.turning == (0, 1, 2, 3)
    assert both.differing == (4,)
    assert both.reach == {1: (-80.0, 90.0), 4: (-80.0, 90.0)}


def test_a_displaced_stack_displaces_its_lowest(arm: Chain, scara: Chain) -> None:
    T = transform(rot_x(25.0), (0.1, -0.2, 0.3))
    moved = displaced(stack(scara, np.eye(4), arm), T)
    assert np.array_equal(moved.partials[0].T_carrier_mcs, T)
    assert np.array_equal(moved.partials[1].T_carrier_mcs, np.eye(4))
