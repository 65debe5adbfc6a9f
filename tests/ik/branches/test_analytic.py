"""Every branch of arms in closed form: none missing, none wrong; what has no closed form says so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from py_opw_kinematics import KinematicModel
from py_opw_kinematics import Robot as OpwRobot
from scipy.spatial.transform import RigidTransform

import chainbuild
from chainbuild.chain.assemble import Element, linear, rotary, shift, turn
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.sums import AxisConstraint, AxisSum
from chainbuild.comparison.eaik_model import eaik_answers, eaik_robot
from chainbuild.errors import ChainbuildError
from chainbuild.frames import rot_y
from chainbuild.ik.branches.core.branches import collect
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.every import ik_all
from chainbuild.ik.branches.multistart import multistart_branches
from chainbuild.ik.request import IkRequest
from chainbuild.robot import Robot
from tests.kit.compare import same_turns
from tests.kit.draws import random_axes
from tests.kit.kin_robots import ALL, NOT_DIRECT, poses, robot_of
from tests.kit.robots import arm, arm_elements, robot_from, table_machine, ur5

METHODS = {
    13: "position", 14: "position", 36: "single wrist axis", 45: "spherical wrist", 85: "position",
    96: "parallel arm", 202: "single wrist axis", 203: "position", 205: "position", 206: "elimination",
    208: "elimination", 213: "three parallel axes",
}  # fmt: skip


def wrist() -> list[Element]:
    return [rotary("A4", "x"), rotary("A5", "y"), rotary("A6", "x"), shift(x=80.0, y=7.0)]


def inclined_wrist() -> list[Element]:
    return [rotary("A4", "x"), rotary("A5", (0.6, 0.8, 0.0)), rotary("A6", (0.8, 0.0, 0.6)), shift(x=80.0, y=7.0)]


POSITIONERS: dict[str, list[Element]] = {
    "articulated": [
        rotary("A1", "z"), shift(25.0, 11.0, 400.0), rotary("A2", "y"), shift(z=455.0), rotary("A3", "-y"),
        shift(420.0, 13.0, 35.0),
    ],
    "stretched to the side": [
        rotary("A1", "z"), shift(x=25.0), rotary("A2", "y"), shift(x=455.0), rotary("A3", "y"), shift(x=420.0),
    ],
    "parallel first": [
        rotary("A1", "z"), shift(x=400.0), rotary("A2", "z"), shift(x=300.0), rotary("A3", "y"),
        shift(x=150.0, z=40.0),
    ],
    "meeting first": [
        rotary("A1", "z"), rotary("A2", "y"), shift(x=300.0, y=20.0), rotary("A3", "x"), shift(40.0, 250.0, 10.0),
    ],
    "slide and parallel turns": [
        linear("Z1", "y"), shift(x=100.0), rotary("A2", "y"), shift(x=350.0), rotary("A3", "y"), shift(x=300.0),
    ],
    "turns before the slide": [
        rotary("A1", "z"), shift(x=350.0), rotary("A2", "z"), shift(x=300.0), linear("Z3", (0.0, 0.6, 0.8)),
        shift(x=20.0),
    ],
    "two slides and a turn": [
        linear("Z1", "z"), linear("Y2", "y"), shift(x=200.0), rotary("A3", "y"), shift(x=310.0, z=40.0),
    ],
    "turn and two slides": [
        rotary("A1", "z"), linear("Z2", "z"), shift(x=200.0), linear("X3", "x"), shift(y=30.0),
    ],
    "slide, turn, slide": [
        linear("Z1", "z"), rotary("A2", "z"), linear("X3", "x"), shift(x=300.0, y=30.0),
    ],
}  # fmt: skip


def check(robot: Robot, count: int, *, at_least: int = 1, seed: int = 3) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(count):
        axes = random_axes(robot, rng)
        target = robot.fk(axes)
        found = ik_all(robot, target)
        assert len(found) >= at_least
        assert any(same_turns(robot, branch.axes, axes) for branch in found)
        for branch in found:
            assert np.abs(robot.fk(branch.axes).homogeneous - target.homogeneous).max() < 1e-9
            assert robot.violated_limits(branch.axes) == ()


@pytest.mark.parametrize("kin", NOT_DIRECT)
def test_the_method_of_every_type(kin: int) -> None:
    assert robot_of(kin).plan().name == METHODS[kin]


def test_direct_types_say_so() -> None:
    assert {robot_of(kin).plan().name for kin in ALL if kin not in (*NOT_DIRECT, 98)} == {"direct"}


@pytest.mark.parametrize("name", POSITIONERS)
@pytest.mark.parametrize("hand", [wrist, inclined_wrist])
def test_spherical_wrists(name: str, hand) -> None:
    robot = robot_from([*POSITIONERS[name], *hand()])
    assert robot.plan().name == "spherical wrist"
    check(robot, 40)


@pytest.mark.parametrize("name", ["articulated", "turns before the slide"])
def test_the_robot_carries_the_workpiece(name: str) -> None:
    robot = robot_from([shift(500.0, 100.0, 300.0), turn(rot_y(30.0))], [*POSITIONERS[name], *wrist()])
    assert robot.plan().name == "spherical wrist"
    check(robot, 40)


@pytest.mark.parametrize("kin", [36, 45, 96, 202, 203, 205, 13])
def test_arms_and_cylindrical_machines(kin: int) -> None:
    robot = robot_of(kin)
    for axes in poses(robot, 60):
        found = ik_all(robot, robot.fk(axes))
        assert any(same_turns(robot, branch.axes, axes) for branch in found)
        assert all(branch.position_error < 1e-9 and branch.rotation_error < 1e-9 for branch in found)


@pytest.mark.parametrize(
    "name", ["palletiser_kin213", "palletiser_kin96", "scara_kin36", "kr6r900", "irb2600", "tx2_60"]
)
def test_shipped_arms(name: str) -> None:
    robot = chainbuild.Robot.load(name)
    assert robot.plan().name not in ("search", "elimination")
    check(robot, 60)


def test_all_branches_of_an_independent_closed_form() -> None:
    oracle = OpwRobot(KinematicModel(a1=25.0, a2=-35.0, b=0.0, c1=400.0, c2=455.0, c3=420.0, c4=80.0))
    signs, zero = np.array([-1.0, 1.0, 1.0, -1.0, 1.0, -1.0]), np.array([0.0, 90.0, 0.0, 0.0, 0.0, 0.0])
    robot = chainbuild.Robot.load("kr6r900")
    wide = Robot(robot.chain.with_axes(tuple(chainbuild.Axis.unlimited(a.name, a.kind) for a in robot.axes)))
    rng = np.random.default_rng(4)
    for _ in range(200):
        target = wide.fk(rng.uniform(-170.0, 170.0, 6))
        pose = target.homogeneous.copy()
        pose[:3, 3] *= 1000.0
        theirs = (np.array(oracle.inverse(RigidTransform.from_matrix(pose))) - zero) * signs
        ours = np.array([branch.axes for branch in ik_all(wide, target)])
        assert len(ours) in (2, 4, 8)
        for mine, other in ((ours, theirs), (theirs, ours)):
            for row in mine:
                assert min(np.abs((row - o + 180.0) % 360.0 - 180.0).max() for o in other) < 1e-4


def test_order_and_whole_turns() -> None:
    robot = arm()
    start = np.array([10.0, -80.0, 70.0, 20.0, 40.0, 300.0])
    found = ik_all(robot, robot.fk(start), start)
    np.testing.assert_allclose(found[0].axes, start, atol=1e-9)
    factors = robot.kinematics.si_factors
    distances = [np.linalg.norm((branch.axes - start) * factors) for branch in found]
    assert distances == sorted(distances)
    every = ik_all(robot, robot.fk(start), start, windings=True)
    assert len(every) > len(found)
    assert any(np.abs(branch.axes - start + [0, 0, 0, 0, 0, 360.0]).max() < 1e-6 for branch in every)


def test_the_wrist_singularity_keeps_a4() -> None:
    robot = arm()
    found = ik_all(robot, robot.fk([10.0, -80.0, 70.0, 20.0, 0.0, 30.0]), [10.0, -80.0, 70.0, 5.0, 3.0, 0.0])
    assert found[0].free_axes == ("A4",)
    np.testing.assert_allclose(found[0].axes, [10.0, -80.0, 70.0, 5.0, 0.0, 45.0], atol=1e-8)


def test_three_parallel_axes_need_no_spherical_wrist() -> None:
    robot = ur5()
    assert robot.plan().name == "three parallel axes"
    check(robot, 60)


def test_restarts_find_as_much_on_three_parallel_axes() -> None:
    robot = ur5()
    for axes in poses(robot, 4):
        query = BranchQuery.of(IkRequest.of(robot, robot.fk(axes)))
        complete = ik_all(robot, query.target)
        gathered = collect(query, ((x, ()) for x in multistart_branches(query))).branches
        for ours, theirs in ((complete, gathered), (gathered, complete)):
            for branch in ours:
                assert any(same_turns(robot, other.axes, branch.axes) for other in theirs)


def test_right_angles_at_which_eaik_finds_nothing() -> None:
    elements: list[Element] = [
        rotary("A1", "z"), shift(x=200.0), rotary("A2", "y"), shift(x=500.0), rotary("A3", "y"), shift(x=400.0),
        rotary("A4", "y"), shift(30.0), rotary("A5", "-z"), shift(70.0), rotary("A6", "y"), shift(y=80.0),
    ]  # fmt: skip
    chain = robot_from(elements).chain
    robot = Robot(chain.with_axes(tuple(chainbuild.Axis.unlimited(a.name, a.kind) for a in chain.axes)))
    assert robot.plan().name == "three parallel axes"
    rng, missed = np.random.default_rng(1), 0
    known = BranchQuery.of(IkRequest.of(robot, robot.fk(np.zeros(6)))).serial()
    for _ in range(60):
        axes = np.round(rng.uniform(-2.0, 2.0, 6)) * 90.0
        target = robot.fk(axes)
        if np.linalg.svd(robot.jacobian(axes), compute_uv=False)[-1] < 1e-2:
            continue
        alone = eaik_answers(eaik_robot(known), known, target.homogeneous)
        missed += not any(same_turns(robot, np.degrees(q), axes) for q, _ in alone)
        assert any(same_turns(robot, branch.axes, axes) for branch in ik_all(robot, target, axes))
    assert missed > 0


def without_closed_form() -> Robot:
    """Return an arm of seven joints for six axes: two of them turn together."""
    elements: list[Element] = [*arm_elements()[:-1], rotary("A7", (0.6, 0.0, 0.8)), shift(x=50.0)]
    robot = robot_from(elements)
    A = np.eye(7)[:, :6]
    A[6, 1] = 0.5
    return Robot(replace(robot.chain, axes=robot.axes[:6], axis_map=AffineMap.of(A, np.zeros(7), ["rotary"] * 6)))


def test_seven_joints_are_left_to_restarts() -> None:
    robot = without_closed_form()
    assert robot.plan().name == "search"
    axes = poses(robot, 1)[0]
    assert any(same_turns(robot, branch.axes, axes) for branch in ik_all(robot, robot.fk(axes)))
    with pytest.raises(ChainbuildError, match="no closed form"):
        robot.ik(robot.fk(axes), solver="analytic")


def test_held_axes_leave_a_row_that_is_solved() -> None:
    robot = arm()
    axes = np.array([10.0, -80.0, 70.0, 20.0, 40.0, 30.0])
    for held, method in (({"A4": 20.0}, "elimination"), ({"A2": -80.0, "A4": 20.0}, "single wrist axis")):
        assert robot.plan(held or ()).name == method
        found = ik_all(robot, robot.fk(axes), axes, held=held)
        assert any(same_turns(robot, branch.axes, axes) for branch in found)
        assert len(ik_all(robot, robot.fk(axes + [0.0, 0.0, 0.0, 1.0, 0.0, 1.0]), axes, held=held)) == 0


def test_a_direction_is_met_with_every_turn_about_it() -> None:
    robot = robot_from([*arm_elements()[:-4], shift(80.0, 30.0, 20.0), turn(rot_y(40.0))])
    assert (len(robot.axes), robot.task, robot.plan().name) == (5, "direction", "elimination")
    turned = 0
    for axes in poses(robot, 10):
        target = robot.fk(axes)
        found = ik_all(robot, target)
        turned += sum(np.abs(robot.fk(branch.axes).rotation - target.rotation).max() > 1e-3 for branch in found)
        assert any(same_turns(robot, branch.axes, axes) for branch in found)
    assert turned > 0


def test_too_many_axes_are_refused() -> None:
    robot = robot_from([linear("X1", "x"), *arm_elements()])
    with pytest.raises(ChainbuildError, match="there are infinitely many solutions"):
        ik_all(robot, robot.fk(np.zeros(7)))
    axes = np.array([100.0, 10.0, -80.0, 70.0, 20.0, 40.0, 30.0])
    found = ik_all(robot, robot.fk(axes), held={"X1": 100.0})
    assert any(same_turns(robot, branch.axes, axes) for branch in found)


def test_a_direction_needs_no_whole_rotation() -> None:
    robot = robot_of(202)
    for axes in poses(robot, 5):
        target = robot.fk(axes)
        spun = pin.SE3(target.rotation @ pin.rpy.rpyToMatrix(0.0, 0.0, 1.0), target.translation)
        found = ik_all(robot, spun, axes)
        assert any(same_turns(robot, branch.axes, axes) for branch in found)


def test_one_answer_with_a_reason() -> None:
    robot = arm()
    start = [0.0, -80.0, 70.0, 20.0, 40.0, 30.0]
    assert robot.ik(robot.fk(start), start, solver="analytic").success
    outside = robot.ik(robot.fk([0.0, 100.0, 0.0, 0.0, 30.0, 0.0]), solver="analytic")
    assert (outside.success, outside.status) == (False, "limits")
    assert "A2" in outside.reason or "A3" in outside.reason
    far = robot.ik(pin.SE3(np.eye(3), np.array([5.0, 0.0, 0.0])), solver="analytic")
    assert (far.success, far.status) == (False, "unreachable")
    assert far.position_error > 1.0


def test_coupled_limits_are_kept() -> None:
    robot = arm()
    limit = AxisConstraint("elbow", AxisSum((0.0, 1.0, 1.0, 0.0, 0.0, 0.0), 0.0), -30.0, 30.0)
    narrow = Robot(replace(robot.chain, constraints=(limit,)))
    axes = np.array([10.0, -80.0, 70.0, 20.0, 40.0, 30.0])
    found = ik_all(narrow, robot.fk(axes))
    assert 0 < len(found) < len(ik_all(robot, robot.fk(axes)))
    assert all(-30.0 <= branch.axes[1] + branch.axes[2] <= 30.0 for branch in found)


def test_table_machines_answer_through_the_same_door() -> None:
    robot = table_machine()
    axes = np.array([10.0, 20.0, 30.0, 40.0, 50.0])
    found = ik_all(robot, robot.fk(axes), axes)
    assert found[0].method == "direct"
    np.testing.assert_allclose(found[0].axes, axes, atol=1e-9)
