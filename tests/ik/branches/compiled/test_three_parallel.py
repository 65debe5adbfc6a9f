"""Three parallel axes compiled: the sets of the plain solver at every pose it is sure of, doubt where it must be."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.assemble import Element, rotary, shift, turn
from chainbuild.frames import rot_x
from chainbuild.ik.branches.arms.parallel_axes import parallel_arm, three_parallel_constants
from chainbuild.ik.branches.arms.three_parallel import ThreeParallelAxes
from chainbuild.ik.branches.compiled.constants import COLUMNS, ROWS
from chainbuild.ik.branches.compiled.entries import FORMS
from chainbuild.ik.branches.compiled.quick import quick_branches
from chainbuild.ik.branches.core.branches import Branches
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.core.serial import Serial
from chainbuild.ik.branches.every import every_branch
from chainbuild.ik.request import IkRequest
from chainbuild.tolerances import ROTATION_MATRIX
from tests.kit.arms45 import limited
from tests.kit.compare import same_turns
from tests.kit.draws import random_axes
from tests.kit.parallel_arms import (
    MADE,
    WRISTS,
    apart,
    made_arm,
    pose_by_hand,
    random_parallel_arm,
    same_solutions,
    smallest_singular_value,
    solutions,
    unit,
    with_signs,
)
from tests.kit.robots import robot_from

NOTHING = (0.0,) * 6
ARM_OF_TWO_LINKS: list[Element] = [
    shift(z=89.2), rotary("A1", "z"), rotary("A2", "y"), shift(z=425.0), rotary("A3", "y"), shift(z=392.0),
    rotary("A4", "y"), shift(y=109.0), rotary("A5", "z"), shift(z=94.65), rotary("A6", "y"), shift(y=82.3),
]  # fmt: skip


def compiled(serial: Serial, targets: list[Matrix]) -> list[list[Vector] | None]:
    """Return the joint values of poses, None where the compiled form is not sure."""
    constants = three_parallel_constants(serial)
    assert constants is not None
    values, counts = np.full((len(targets), ROWS, COLUMNS), -1.0), np.empty(len(targets), np.int64)
    FORMS["three parallel axes"](constants, np.array(targets), ROTATION_MATRIX, np.zeros(6), values, counts)
    return [None if n < 0 else list(rows[:n, :6]) for rows, n in zip(values, counts.tolist(), strict=True)]


def plain(serial: Serial, T: Matrix) -> list[Vector]:
    arm = parallel_arm(serial)
    assert arm is not None
    return solutions(serial, T, (values for values, _ in ThreeParallelAxes(arm).solve(T, NOTHING)[0]))


def right_with(serial: Serial, q: Vector) -> list[Vector]:
    """Return what the plain solver finds where it keeps the values."""
    arm = parallel_arm(serial)
    assert arm is not None
    return [values for values, _ in ThreeParallelAxes(arm).solve(pose_by_hand(serial, q), q.tolist())[0]]


def compared(serial: Serial, values: Matrix, within: float = 1e-6) -> int:
    """Compare the branches of the poses of joint values (n, 6) with the plain solver; return of how many it is sure."""
    targets = [pose_by_hand(serial, q) for q in values]
    found = compiled(serial, targets)
    for T, rows in zip(targets, found, strict=True):
        if rows is None:
            continue
        right = solutions(serial, T, rows, within=max(1e-9, 1e-2 * within))
        assert same_solutions(rows, right, within)
        assert same_solutions(rows, plain(serial, T), within)
    return sum(rows is not None for rows in found)


@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("wrist", WRISTS)
def test_the_sets_of_the_plain_solver(wrist: str, backwards: bool) -> None:
    rng, sure = np.random.default_rng(21), 0
    for _ in range(20):
        serial = random_parallel_arm(rng, wrist, backwards=backwards)
        sure += compared(serial, rng.uniform(-3.1, 3.1, (10, 6)))
    assert sure >= 199


@pytest.mark.parametrize("name", MADE)
def test_arms_as_they_are_made_with_any_signs(name: str) -> None:
    rng, sure = np.random.default_rng(22), 0
    for _ in range(8):
        serial = with_signs(made_arm(name), rng.choice((-1.0, 1.0), 6).tolist())
        sure += compared(serial, rng.uniform(-math.pi, math.pi, (10, 6)))
    assert sure == 80


@pytest.mark.slow
def test_thousands_of_poses() -> None:
    rng, sure = np.random.default_rng(23), 0
    for name in MADE:
        sure += compared(made_arm(name), rng.uniform(-math.pi, math.pi, (1000, 6)))
    for wrist in WRISTS:
        for n in range(30):
            sure += compared(random_parallel_arm(rng, wrist, backwards=n % 2 == 0), rng.uniform(-3.1, 3.1, (50, 6)))
    assert sure > 0.998 * 7500


@pytest.mark.parametrize("gap", [1e-8, 1e-6, 1e-4, 1e-2])
def test_axes_that_nearly_meet(gap: float) -> None:
    rng, sure = np.random.default_rng(24), 0
    for _ in range(10):
        *rest, five, six = random_parallel_arm(rng, "meeting").screws
        six = replace(six, point=six.point + gap * unit(np.cross(five.direction, six.direction)))
        sure += compared(Serial((*rest, five, six), np.eye(4)), rng.uniform(-3.0, 3.0, (6, 6)))
    assert sure >= 58


def test_right_angles_and_what_is_beside_them() -> None:
    rng, regular, sure = np.random.default_rng(25), 0, 0
    for _ in range(10):
        serial = made_arm("UR5") if rng.random() < 0.5 else made_arm("CR5").reversed()
        values = np.radians(rng.integers(-3, 5, (20, 6)) * 45.0)
        values += rng.normal(size=(20, 6)) * (rng.random((20, 6)) < 0.5) * 10.0 ** rng.uniform(-9.0, -1.0, (20, 1))
        regular += sum(smallest_singular_value(serial, q) > 1e-2 for q in values)
        sure += compared(serial, values, within=1e-4)  # where branches nearly meet half of the digits is lost
    assert sure > 0
    assert sure >= 0.9 * regular


def test_of_two_bends_in_one_family_one_is_told() -> None:
    """Followed step by step by the plain path, which leaves the same families and isolated branches."""
    robot, rng, families = robot_from(ARM_OF_TWO_LINKS), np.random.default_rng(30), 0
    for _ in range(12):
        axes = random_axes(robot, rng)
        axes[4] = 0.0
        T = robot.fk(axes)
        quick = quick_branches(robot, T.homogeneous, None, None)
        if not isinstance(quick, Branches):
            continue
        plain_ones = every_branch(BranchQuery.of(IkRequest.of(robot, T))).branches
        told = [[bool(len(one)) for one in found.free_directions] for found in (quick, plain_ones)]
        assert sorted(told[0]) == sorted(told[1])
        families += sum(told[0])
    assert families >= 6


# Axes 3 and 4 [degrees] where axis 5 is 0: the circle of axis 6 touches the outer or the inner end of the links' reach,
# leaves it on one side, or never.
CIRCLES = {
    "touches the outer end": (0.0, 180.0),
    "touches the inner end": (180.0, 0.0),
    "touches the inner end from inside": (180.0, 180.0),
    "leaves it": (60.0, 0.0),
    "stays within it": (150.0, 70.0),
    "from the outer end": (0.0, 90.0),
    "from the inner end": (180.0, 90.0),
}


@pytest.mark.parametrize("circle", CIRCLES)
def test_a_free_axis_6_moves_to_where_the_links_reach_and_bends_cross_where_it_touches(circle: str) -> None:
    robot, rng, moved = limited(robot_from(ARM_OF_TWO_LINKS), every=(-180.0, 180.0)), np.random.default_rng(31), 0
    for _ in range(8):
        axes = np.array([*rng.uniform(-170.0, 170.0, 2), *CIRCLES[circle], 0.0, rng.uniform(-170.0, 170.0)])
        T, start = robot.fk(axes), rng.uniform(-170.0, 170.0, 6)
        quick = quick_branches(robot, T.homogeneous, start, None)
        assert isinstance(quick, Branches)
        wanted = every_branch(BranchQuery.of(IkRequest.of(robot, T, start))).branches
        assert len(quick) == len(wanted)
        for n, found in enumerate(quick.axes):
            gaps = [np.abs(np.sin(np.radians(found - other) / 2.0)).max() for other in wanted.axes]
            same = int(np.argmin(gaps))
            assert gaps[same] < 1e-6
            assert quick.free_axes[n] == wanted.free_axes[same]
            one, other = quick.free_directions[n], wanted.free_directions[same]
            assert one.shape == other.shape
            if len(one):
                assert float(one[0] @ other[0]) == pytest.approx(1.0, abs=1e-6)
                moved += abs(found[5] - start[5]) > 1e-6
    assert (moved > 0) == circle.startswith(("leaves", "from"))


@pytest.mark.parametrize("beside", [0.0, 5.0])
def test_where_only_one_value_of_axis_6_leads_there_the_branch_is_isolated(beside: float) -> None:
    """Stretched links and hand, though axis 6 is parallel to the three."""
    robot = limited(robot_from(ARM_OF_TWO_LINKS), every=(-180.0, 180.0))
    axes = np.array([20.0, -30.0, 0.0, 0.0, 0.0, 70.0])
    found = robot.ik_all(robot.fk(axes), axes + [beside, 0.0, 0.0, 0.0, 0.0, 10.0 * beside])
    (stretched,) = (branch for branch in found if same_turns(robot, branch.axes, axes, 0.01))
    assert len(stretched.free_directions) == 0


@pytest.mark.parametrize("circle", [name for name in CIRCLES if name.startswith("touches")])
def test_where_the_bends_cross_the_plain_path_looks(circle: str) -> None:
    """Two directions are lost there, which together leave the turn of the tool as it is: ones are across them."""
    robot = limited(robot_from(ARM_OF_TWO_LINKS), every=(-180.0, 180.0))
    axes = np.array([20.0, -30.0, *CIRCLES[circle], 0.0, 70.0])
    T = robot.fk(axes)
    assert not isinstance(quick_branches(robot, T.homogeneous, axes, None), Branches)
    (crossing,) = (branch for branch in robot.ik_all(T, axes) if branch.free_axes)
    assert len(crossing.free_directions) == 2


@pytest.mark.parametrize("carries_workpiece", [False, True])
def test_a_robot_has_the_branches_of_the_plain_path(carries_workpiece: bool) -> None:
    arm = [
        shift(z=89.2), rotary("A1", "z"), rotary("A2", "y"), shift(y=-20.0, z=425.0), rotary("A3", "-y"),
        shift(z=392.0), rotary("A4", "y"), shift(y=93.0), rotary("A5", "z"), shift(z=94.65), rotary("A6", "y"),
        shift(y=82.3),
    ]  # fmt: skip
    robot = robot_from([shift(x=700.0), turn(rot_x(90.0))], arm) if carries_workpiece else robot_from(arm)
    assert robot.plan().name == "three parallel axes"
    rng = np.random.default_rng(29)
    for _ in range(20):
        axes = random_axes(robot, rng)
        T = robot.fk(axes)
        quick = quick_branches(robot, T.homogeneous, None, None)
        assert isinstance(quick, Branches)
        assert any(same_turns(robot, branch.axes, axes) for branch in quick)
        plain_ones = every_branch(BranchQuery.of(IkRequest.of(robot, T))).branches
        for ours, theirs in zip(quick.axes, plain_ones.axes, strict=True):
            assert same_turns(robot, ours, theirs)


def test_stretched_and_folded_links_are_one_branch_or_two_close_ones() -> None:
    rng = np.random.default_rng(26)
    serial = made_arm("UR5")
    for value in (0.0, math.pi):
        for beside in (0.0, 1e-9, 1e-6, 2e-5, 1e-3):
            q = rng.uniform(-3.0, 3.0, 6)
            q[2] = value + beside
            rows = compiled(serial, [pose_by_hand(serial, q)])[0]
            assert rows is not None
            near = [row for row in rows if apart(row, q) < max(1e-4, 40.0 * beside)]
            assert len(near) == 2 or beside < 1e-7
            assert min(apart(row, q) for row in near) < 1e-6
            assert beside > 1e-7 or max(apart(row, q) for row in near) < 1e-6


def families(serial: Serial, q: Vector) -> list[tuple[Vector, int, int]] | None:
    """Return of the pose of joint values the rows, their free joint and their family; None where it is not sure."""
    constants = three_parallel_constants(serial)
    assert constants is not None
    values, counts = np.empty((1, ROWS, COLUMNS)), np.empty(1, np.int64)
    T = pose_by_hand(serial, q)
    FORMS["three parallel axes"](constants, T[None], ROTATION_MATRIX, q, values, counts)
    if counts[0] < 0:
        return None
    return [(row[:6], int(row[6]), int(row[7])) for row in values[0, : counts[0]]]


@pytest.mark.parametrize("long", [0.0, 0.4])
@pytest.mark.parametrize("backwards", [False, True])
def test_where_axis_6_is_parallel_to_the_three_it_keeps_its_value(backwards: bool, long: float) -> None:
    """Which bends are of one family is found by turning axis 6 once around: they meet where the links are straight."""
    rng = np.random.default_rng(27)
    *rest, six = made_arm("UR5").screws
    serial = Serial((*rest, replace(six, point=six.point + long * rest[4].direction)), np.eye(4))
    if backwards:
        serial = serial.reversed()
    last, fifth, middle = (0, 1, 3) if backwards else (5, 4, 2)
    kinds, sure = set(), 0
    for _ in range(30):
        q = rng.uniform(-3.0, 3.0, 6)
        q[fifth] = 0.0 if rng.random() < 0.5 else math.pi
        rows = families(serial, q)
        if rows is None:
            continue
        sure += 1
        T = pose_by_hand(serial, q)
        loose = [(row, family) for row, free, family in rows if free == last]
        assert {free for _, free, _ in rows} <= {-1, last}
        assert min(apart(row, q) for row, _ in loose) < 1e-6
        arcs = turned_once_around(serial, q, last, fifth, middle)
        assert len({family if family >= 0 else -n for n, (_, family) in enumerate(loose, start=1)}) == len(arcs)
        for row, family in loose:
            assert np.abs(pose_by_hand(serial, row) - T).max() < 1e-9
            assert (family >= 0) == any(arc == "both" for arc in arcs)
        kinds.add(tuple(sorted(arcs)))
    assert sure >= 28
    assert kinds >= {("one", "one"), ("both",)} if long == 0.0 else {("both",), ("both", "both")}


def turned_once_around(serial: Serial, q: Vector, last: int, fifth: int, middle: int) -> list[str]:
    """Return the families of a pose whose joint 6 is parallel to the three, by the plain solver at 120 values of it.

    "one" and "one" if it has two bends all around; "both" for every arc of values at which there are any.
    """
    arm = parallel_arm(serial)
    assert arm is not None
    T, reached = pose_by_hand(serial, q), []
    for angle in np.arange(120) * math.tau / 120.0:
        keep = q.copy()
        keep[last] = angle
        found = [
            v
            for v, _ in ThreeParallelAxes(arm).solve(T, keep.tolist())[0]
            if abs(math.remainder(v[last] - angle, math.tau)) < 1e-9
        ]
        reached.append(any(abs(math.remainder(v[fifth] - q[fifth], math.tau)) < 1e-6 for v in found))
    starts = sum(here and not before for here, before in zip(reached, [reached[-1], *reached[:-1]], strict=True))
    return ["one", "one"] if all(reached) else ["both"] * starts


def test_it_is_not_sure_where_the_wrist_leaves_angle_6_open_but_for_digits() -> None:
    *rest, six = made_arm("UR5").screws
    serial = Serial(
        (*rest, replace(six, point=six.point + 0.05 * unit(np.cross(rest[4].direction, six.direction)))), np.eye(4)
    )
    rng = np.random.default_rng(28)
    for value in (0.0, math.pi, 2e-5):
        for q in rng.uniform(-3.0, 3.0, (5, 6)):
            q[4] = value
            assert compiled(serial, [pose_by_hand(serial, q)]) == [None]


def test_what_is_out_of_reach_is_left_to_the_plain_solver() -> None:
    serial = made_arm("UR5")
    T = pose_by_hand(serial, np.ones(6))
    T[:3, 3] *= 10.0
    assert compiled(serial, [T]) == [None]


def test_where_every_angle_1_has_its_angle_5_it_is_not_sure() -> None:
    rng = np.random.default_rng(27)
    for wrist in ("meeting", "apart"):
        for _ in range(10):
            serial = random_parallel_arm(rng, wrist)
            _, a, b, c, five, six = serial.screws
            there = Serial((a, b, c), np.eye(4)).pose(rng.uniform(-2.0, 2.0, 3))
            serial = Serial((replace(five.transformed(there), joint=0), a, b, c, five, six), serial.M)
            assert compiled(serial, [there @ six.T(0.4) @ serial.M]) == [None]
