"""Compiled closed forms against the plain path: the same branches wherever they are sure, and mostly they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild.chain.assemble import Element, linear, rotary, shift, turn
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.sums import AxisConstraint, AxisSum
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.frames import transform
from chainbuild.ik.branches.compiled.forms import quick_form
from chainbuild.ik.branches.compiled.quick import quick_branches
from chainbuild.ik.branches.core.branches import Branches
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.core.subproblems import rotation
from chainbuild.ik.branches.every import every_branch
from chainbuild.ik.request import IkRequest
from chainbuild.ik.search.compiled import packing
from chainbuild.machines import shipped
from chainbuild.robot import Robot
from tests.kit.draws import random_axes, unit
from tests.kit.robots import arm, robot_from

WRISTS: dict[str, list[Element]] = {
    "square": [rotary("A4", "x"), rotary("A5", "y"), rotary("A6", "x"), shift(x=80.0, y=7.0)],
    "inclined": [rotary("A4", "x"), rotary("A5", (0.6, 0.8, 0.0)), rotary("A6", (0.8, 0.0, 0.6)), shift(z=80.0)],
}
ARMS: dict[str, list[Element]] = {
    "parallel second and third": [
        rotary("A1", "z"), shift(25.0, 11.0, 400.0), rotary("A2", "y"), shift(z=455.0), rotary("A3", "-y"),
        shift(420.0, 13.0, 35.0),
    ],
    "parallel first and second": [
        rotary("A1", "z"), shift(x=400.0), rotary("A2", "z"), shift(x=300.0), rotary("A3", "y"),
        shift(150.0, 0.0, 40.0),
    ],
    "first two meet": [
        rotary("A1", "z"), rotary("A2", "y"), shift(300.0, 20.0), rotary("A3", "x"), shift(40.0, 250.0, 10.0),
    ],
    "last two meet": [
        rotary("A1", "z"), shift(300.0, 20.0), rotary("A2", "y"), rotary("A3", "x"), shift(40.0, 250.0, 10.0),
    ],
    "no two parallel, none meet": [
        rotary("A1", "z"), shift(30.0, 20.0, 400.0), rotary("A2", (0.1, 0.9, 0.0)), shift(z=455.0),
        rotary("A3", (0.0, -0.9, 0.2)), shift(420.0, 13.0, 35.0),
    ],
}  # fmt: skip


# The axis that is 0 where the tool stands along the other rotary axis.
STRETCHED = {
    "ac_table_kin58": "A", "ca_head_kin9": "A", "gantry_ss": "A5", "irb2600_table": "A5", "kr6r900": "A5",
}  # fmt: skip

# Plans that have no compiled form, and machines beside them: a slide in the arm, nonlinear axis maps.
PLAIN_PLANS = {"single wrist axis", "position", "parallel arm", "struts", "search", "elimination"}
PLAIN = {"arm_rr", "cardan_head_kin59", "plasma_head_kin25", "rotated_head_kin70"}


def plain(robot: Robot, T: object, start: object = None, held: object = None) -> np.ndarray:
    """Return what the plain path finds."""
    return every_branch(BranchQuery.of(IkRequest.of(robot, T, start, held))).branches.axes


def agree(robot: Robot, poses: list[np.ndarray], start: np.ndarray | None = None, within: float = 1e-6) -> int:
    """Compare the compiled branches of poses with the plain ones; return how many poses were sure."""
    sure = 0
    for T in poses:
        quick = quick_branches(robot, np.ascontiguousarray(T), start, None)
        if not isinstance(quick, Branches):
            continue
        sure += 1
        wanted = plain(robot, T, start)
        assert len(quick) == len(wanted)
        for axes in quick.axes:
            assert np.abs(wanted - axes).max(axis=1).min() < within
            assert np.abs(robot.fk(axes).homogeneous - T)[:3, 3].max() < 1e-9
        far = [np.linalg.norm((axes - (start if start is not None else 0)) * robot.kinematics.si_factors) for axes in
               quick.axes] if start is not None else []  # fmt: skip
        assert far == sorted(far)
    return sure


@pytest.mark.parametrize("name", shipped())
def test_the_same_branches_as_the_plain_path(name: str) -> None:
    robot = chainbuild.Robot.load(name)
    assert (quick_form(robot, None, None)[0] is None) == (name in PLAIN or robot.plan().name in PLAIN_PLANS)
    if name in PLAIN or robot.plan().name in PLAIN_PLANS:
        return
    rng = np.random.default_rng(5)
    rows = [random_axes(robot, rng) for _ in range(12)]
    poses = [robot.fk(row).homogeneous for row in rows]
    assert agree(robot, poses) == len(poses)
    assert agree(robot, poses[:3], start=rows[0] + rng.uniform(-9.0, 9.0, len(rows[0]))) == 3
    square = [robot.fk(np.round(row / 90.0) * 90.0 + rng.normal(size=len(row)) * 1e-4).homogeneous for row in rows]
    assert agree(robot, square) > 0


@pytest.mark.parametrize("hand", WRISTS)
@pytest.mark.parametrize("name", ARMS)
@pytest.mark.parametrize("carries", ["tool", "workpiece"])
def test_every_arrangement_of_an_arm(name: str, hand: str, carries: str) -> None:
    """In a random place, with a random tool, carrying the tool or the workpiece."""
    rng = np.random.default_rng(8)
    about = [turn(rotation(unit(rng), float(rng.uniform(-3.0, 3.0))))]
    elements = [*about, shift(*rng.uniform(-300.0, 300.0, 3)), *ARMS[name], *WRISTS[hand], *about]
    robot = robot_from(elements) if carries == "tool" else robot_from([shift(1.0, 2.0, 3.0)], elements)
    rows = [random_axes(robot, rng) for _ in range(15)]
    poses = [robot.fk(row).homogeneous for row in rows]
    assert agree(robot, poses) == len(poses)
    for row, T in zip(rows, poses, strict=True):
        found = quick_branches(robot, T, None, None)
        assert isinstance(found, Branches)
        assert np.abs(np.sin(np.radians(found.axes - row) / 2.0)).max(axis=1).min() < 1e-9
        assert found.method == "spherical wrist"


@pytest.mark.parametrize("rotaries", [("z",), ("z", "y"), ("z", (0.6, 0.0, 0.8)), ("z", "y", "x")])
@pytest.mark.parametrize("carries", ["tool", "workpiece", "both"])
def test_every_arrangement_of_three_linear_axes(rotaries: tuple[object, ...], carries: str) -> None:
    rng = np.random.default_rng(9)
    slides = [linear("X1", "x"), linear("Y2", (0.0, 0.8, 0.6)), linear("Z3", "z")]
    turns: list[Element] = []
    for n, axis in enumerate(rotaries):
        turns += [rotary("BCD"[n], axis), shift(*rng.uniform(-200.0, 200.0, 3))]  # type: ignore[arg-type]
    tip = [shift(10.0, 20.0, 130.0)]
    parts = {
        "tool": ([*slides, *turns, *tip], []),
        "workpiece": (tip, [*slides, *turns]),
        "both": ([*slides, *tip], turns),
    }
    robot = robot_from(*parts[carries])
    rows = [random_axes(robot, rng) for _ in range(15)]
    poses = [robot.fk(row).homogeneous for row in rows]
    assert agree(robot, poses) == len(poses)
    for row, T in zip(rows, poses, strict=True):
        found = quick_branches(robot, T, None, None)
        assert isinstance(found, Branches)
        assert found.method == "direct"
        assert np.abs(found.axes - row).max(axis=1).min() < 1e-7


def test_near_singular_poses_are_right_or_left_to_the_plain_path() -> None:
    """A stretched wrist, a stretched elbow, the wrist above axis 1, from 1e-2 down to 1e-12 radians beside."""
    robot = arm()
    rng = np.random.default_rng(2)
    singular = [[20.0, -60.0, 80.0, 30.0, 0.0, 40.0], [20.0, -60.0, 4.763641690726178, 30.0, 50.0, 40.0]]
    sure = 0
    for row in singular:
        for distance in 10.0 ** -np.arange(2.0, 13.0):
            axes = np.array(row) + np.degrees(distance) * unit_of(rng, 6)
            sure += agree(robot, [robot.fk(axes).homogeneous], within=1e-2)  # of two that nearly coincide one is kept
    assert 14 <= sure <= 22  # some of the nearest are left to the plain path


@pytest.mark.parametrize("distance", [2.2e-8, 3e-8, 6e-8, 1e-7, 3e-7])
@pytest.mark.parametrize("wrist", [1.0, -1.0])
def test_wrists_that_are_nearly_stretched_are_sure(distance: float, wrist: float) -> None:
    """As many branches as a thousandth beside, their own among them, and none on a curve."""
    robot, rng = arm(), np.random.default_rng(7)
    for _ in range(20):
        axes = random_axes(robot, rng)
        axes[4] = np.degrees(1e-3)
        wanted = quick_branches(robot, robot.fk(axes).homogeneous, None, None)
        axes[4] = wrist * np.degrees(distance)
        T = robot.fk(axes)
        found = quick_branches(robot, T.homogeneous, None, None)
        assert isinstance(wanted, Branches)
        assert isinstance(found, Branches)
        assert len(found) == len(wanted)
        assert not any(len(free) for free in found.free_directions)
        apart = np.abs((found.axes - axes + 180.0) % 360.0 - 180.0)
        assert apart.max(axis=1).min() < np.degrees(2e-14 / distance)  # a hundred roundings of T
        for row in found.axes:
            missed = pin.log6(T.inverse() * robot.fk(row))
            assert max(np.abs(missed.vector)) < 1e-12


@pytest.mark.parametrize("name", sorted(STRETCHED))
def test_free_axes_are_told_as_by_the_plain_path(name: str) -> None:
    """A stretched wrist, a tool along the rotary axis: one of a family, with its free axis and direction."""
    assert families_told(chainbuild.Robot.load(name), STRETCHED[name]) > 3


def test_the_free_axis_of_an_arm_that_carries_the_workpiece() -> None:
    """Seen from the tool its wrist comes first: the axis that is free is another one."""
    elements = [*ARMS["parallel second and third"], *WRISTS["square"]]
    assert families_told(robot_from([shift(1.0, 2.0, 3.0)], elements), "A5") > 3


def test_axes_that_count_from_elsewhere() -> None:
    """Constants between joint and axis values, axis 6 that follows axis 5: also where the wrist is stretched."""
    A = arm().chain.axis_map.dq_daxes(np.zeros(6)).copy()
    A[5, 4] = A[5, 5]
    axis_map = AffineMap.of(A, np.array([0.1, -0.2, 0.3, 0.4, 0.5, -0.6]), ["rotary"] * 6)
    robot = Robot(replace(arm().chain, axis_map=axis_map))
    rng = np.random.default_rng(3)
    for bent in (rng.uniform(10.0, 60.0), -float(np.degrees(0.5))):
        axes = np.array([10.0, -60.0, 80.0, 30.0, bent, 40.0])
        T, start = robot.fk(axes).homogeneous, axes + rng.uniform(-5.0, 5.0, 6)
        quick = quick_branches(robot, T, start, None)
        assert isinstance(quick, Branches)
        np.testing.assert_allclose(quick.axes, plain(robot, T, start), atol=1e-6)
        assert len(quick) > 0


def families_told(robot: Robot, stretched: str) -> int:
    """Compare compiled and plain branches where an axis is 0; return how many of them go on."""
    rng = np.random.default_rng(7)
    lower, upper = (np.array([getattr(axis, end) for axis in robot.axes]) for end in ("lower", "upper"))
    told = 0
    for _ in range(6):
        axes = lower + (upper - lower) * rng.uniform(0.3, 0.7, len(lower))
        axes[robot.labels.names.index(stretched)] = 0.0
        axes[[n for n, axis in enumerate(robot.axes) if axis.held]] = 0.0
        T, start = robot.fk(axes).homogeneous, axes + rng.uniform(-5.0, 5.0, len(axes))
        start[[n for n, axis in enumerate(robot.axes) if axis.held]] = 0.0
        quick = quick_branches(robot, T, start, None)
        wanted = every_branch(BranchQuery.of(IkRequest.of(robot, T, start))).branches
        if not isinstance(quick, Branches):
            continue
        np.testing.assert_allclose(quick.axes, wanted.axes, atol=1e-6)
        assert quick.free_axes == wanted.free_axes
        for one, other in zip(quick.free_directions, wanted.free_directions, strict=True):
            assert one.shape == other.shape
            if len(one):
                told += 1
                assert float(one[0] @ other[0]) == pytest.approx(1.0, abs=1e-9)
                moved = axes_of(quick.axes, quick.free_directions) + 1e-4 * one[0] / robot.kinematics.si_factors
                distance, angle = robot.kinematics.errors(moved * robot.kinematics.si_factors, pin.SE3(T), robot.task)
                assert max(distance, angle) < 1e-7
    return told


def axes_of(axes: np.ndarray, directions: tuple[np.ndarray, ...]) -> np.ndarray:
    """Return the first branch that goes on."""
    return axes[next(n for n, one in enumerate(directions) if len(one))]


def unit_of(rng: np.random.Generator, n: int) -> np.ndarray:
    v = rng.normal(size=n)
    return v / np.linalg.norm(v)


def test_poses_on_a_limit_are_left_to_the_plain_path() -> None:
    robot = arm()
    axes = [170.0, -60.0, 80.0, 30.0, 50.0, 40.0]
    found = robot.ik_all(robot.fk(axes))
    assert np.abs(found.axes - axes).max(axis=1).min() < 1e-7
    assert all(robot.violated_limits(branch.axes) == () for branch in found)


def test_limits_on_sums_are_kept() -> None:
    sums = AxisConstraint("A2 + A3", AxisSum((0.0, 1.0, 1.0, 0.0, 0.0, 0.0), 5.0), -40.0, 60.0)
    robot = Robot(replace(arm().chain, constraints=(sums,)))
    rng = np.random.default_rng(4)
    poses = [arm().fk(random_axes(arm(), rng)).homogeneous for _ in range(40)]
    assert agree(robot, poses) > 30
    counts = [(len(robot.ik_all(T)), len(arm().ik_all(T))) for T in poses]
    assert sum(one < other for one, other in counts) > 10
    # Where another whole turn of an axis might keep the limit, the plain path decides.
    wound = replace(sums, name="A5 + A6", sum=AxisSum((0.0, 0.0, 0.0, 0.0, 1.0, 1.0), 0.0), lower=100.0, upper=400.0)
    robot = Robot(replace(arm().chain, constraints=(wound,)))
    quick = [quick_branches(robot, T, None, None) for T in poses]
    assert any(not isinstance(found, Branches) for found in quick)
    agree(robot, poses)


def test_held_axes_have_their_own_form() -> None:
    robot = chainbuild.Robot.load("irb2600_track")
    rng = np.random.default_rng(6)
    for place in (0.0, 1500.0):
        axes = random_axes(robot, rng)
        axes[6] = place
        T = robot.fk(axes).homogeneous
        found = quick_branches(robot, T, None, {"EX1": place})
        assert isinstance(found, Branches)
        assert (found.axes[:, 6] == place).all()
        wanted = plain(robot, T, None, {"EX1": place})
        assert np.abs(found.axes - wanted).max() < 1e-7
    with pytest.raises(AxisValueError, match="no axis 'EX9'"):
        quick_branches(robot, T, None, {"EX9": 1.0})


def test_a_pose_that_is_not_rigid_is_refused_alike() -> None:
    robot = arm()
    bent = robot.fk([10.0, -60.0, 80.0, 30.0, 50.0, 40.0]).homogeneous
    bent[0, 0] += 0.1
    with pytest.raises(ChainbuildError) as quick:
        quick_branches(robot, bent, None, None)
    with pytest.raises(ChainbuildError) as slow:
        plain(robot, bent)
    assert quick.value.message == slow.value.message


def test_without_numba_the_plain_path_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(packing, "available", lambda: False)
    robot = arm()
    T = robot.fk([10.0, -60.0, 80.0, 30.0, 50.0, 40.0])
    assert quick_form(robot, None, None)[0] is None
    assert len(robot.ik_all(T)) == 4


def test_subproblems_agree_with_the_plain_ones() -> None:
    import numba

    from chainbuild.ik.branches.compiled import small
    from chainbuild.ik.branches.core import subproblems

    @numba.njit
    def two(k1, k2, p, q):
        return small.two_turns((k1[0], k1[1], k1[2]), (k2[0], k2[1], k2[2]), (p[0], p[1], p[2]), (q[0], q[1], q[2]))

    @numba.njit
    def height(k, p, h, d):
        return small.to_height((k[0], k[1], k[2]), (p[0], p[1], p[2]), (h[0], h[1], h[2]), d)

    rng = np.random.default_rng(1)
    met = 0
    for _ in range(300):
        k1, k2, p = unit(rng), unit(rng), unit(rng) * rng.uniform(0.1, 3.0)
        a, b = rng.uniform(-3.0, 3.0, 2)
        q = rotation(k1, a) @ rotation(k2, b) @ p
        count, *angles, sure = two(k1, k2, p, q)
        assert (count, sure) == (2, True)
        for first, second in (angles[:2], angles[2:]):
            assert np.abs(rotation(k1, first) @ rotation(k2, second) @ p - q).max() < 1e-9
        assert min(np.abs(np.sin((np.array(pair) - (a, b)) / 2.0)).max() for pair in (angles[:2], angles[2:])) < 1e-9
        d = rng.uniform(-2.0, 2.0)
        count, one, other, sure = height(k1, p, k2, d)
        wanted = subproblems.subproblem_4(k1, p, k2, d)
        assert count == len(wanted)
        for found, turned in zip((one, other), wanted, strict=False):
            assert np.sin((found - turned.angle) / 2.0) == pytest.approx(0.0, abs=1e-9)
        met += count
    assert met > 200


def test_the_answer_is_that_of_another_closed_form() -> None:
    """A hand formula for the wrist: the angle between the axes around it, from the pose alone."""
    robot = robot_from([*ARMS["parallel second and third"], *WRISTS["square"]])
    axes = np.array([12.0, -40.0, 70.0, 25.0, 55.0, -31.0])
    T = robot.fk(axes).homogeneous
    found = quick_branches(robot, T, None, None)
    assert isinstance(found, Branches)
    for row in found.axes:
        arm_part = transform(rotation(np.array([0.0, 0.0, 1.0]), np.radians(row[0])), [0.0, 0.0, 0.0])[:3, :3]
        bend = rotation(np.array([0.0, 1.0, 0.0]), np.radians(row[1] - row[2]))
        inner = (arm_part @ bend).T @ T[:3, :3]
        assert np.cos(np.radians(row[4])) == pytest.approx(inner[0, 0], abs=1e-12)
