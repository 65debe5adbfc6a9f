"""Values written down by hand for what poses, Jacobians and steps are made of: one flipped sign fails one of them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from chainbuild import AffineDrives, AxisConstraint, AxisSum, DriveLimit, Robot
from chainbuild.chain.assemble import linear, rotary, shift
from chainbuild.chain.axismap import AffineMap, random_axis_values
from chainbuild.chain.programmed.display import Display
from chainbuild.frames import rot_about, rot_y, rot_z
from chainbuild.kinematics.displayed import raised_and_turned, vector_of_angles
from chainbuild.kinematics.evaluation import tilt
from chainbuild.kinematics.limits import Limits
from chainbuild.kinematics.newton import damped_step, shrinking
from chainbuild.kinematics.product import slides_at
from chainbuild.kinematics.task_error import DampedSteps, TaskError
from chainbuild.tolerances import LIMIT_SLACK
from tests.kit.robots import make_chain

LETTERS = ("x", "y", "z")


@pytest.mark.parametrize("sign", ["", "-"])
@pytest.mark.parametrize("letter", LETTERS)
def test_a_joint_along_each_direction(letter: str, sign: str) -> None:
    along = np.eye(3)[LETTERS.index(letter)] * (-1.0 if sign else 1.0)
    slide, hinge = linear("A", f"{sign}{letter}"), rotary("A", f"{sign}{letter}")
    for move in (slide, hinge):
        chain = make_chain([move], [], "A")
        # As drawn: assembling turns the joint round where its sign says so, a chain of a URDF need not.
        joint = replace(chain.joints[0], direction=along, T_parent_joint=np.eye(4))
        value = 0.3 if move is slide else math.radians(30.0)
        pose = Robot(replace(chain, joints=(joint,))).kinematics.pose(np.array([value]))
        shifted = along * value if move is slide else np.zeros(3)
        turned = np.eye(3) if move is slide else rot_about(along, 30.0)
        np.testing.assert_allclose(pose.translation, shifted, atol=1e-15)
        np.testing.assert_allclose(pose.rotation, turned, atol=1e-15)


def test_the_reach_of_an_arm_holds_its_full_length() -> None:
    arm = Robot(make_chain([rotary("A", "z"), shift(x=300.0), rotary("B", "z"), shift(x=200.0)], [], "A B"))
    assert 0.5 <= arm.kinematics.reach <= 0.5 + 1e-8


def test_an_affine_map_there_and_back() -> None:
    """q1 = 2·X + 0.1 m, q2 = C/2 − X + 0.5 rad, by the axis values X = 300 mm and C = 90 degrees."""
    affine = AffineMap.of(np.array([[2.0, 0.0], [-1.0, 0.5]]), np.array([0.1, 0.5]), ("linear", "rotary"))
    joints = np.array([0.7, math.pi / 4.0 + 0.2])
    assert affine.q(np.array([300.0, 90.0])) == pytest.approx(joints, abs=1e-15)
    assert affine.axes(joints) == pytest.approx([300.0, 90.0], abs=1e-12)


class NeverClosing:
    """A map that knows of no place where it closes, or of one beyond the box."""

    def __init__(self, drawn: np.ndarray | None) -> None:
        self.drawn = drawn

    def drawn_axes(self, rng: np.random.Generator, lower: np.ndarray, upper: np.ndarray) -> np.ndarray | None:
        return self.drawn


@pytest.mark.parametrize("drawn", [None, np.array([2.0, 500.0, 0.0]), np.array([2.0, 40.0, -900.0])])
def test_values_are_drawn_from_the_box_where_nothing_closes(drawn: np.ndarray | None) -> None:
    lower, upper = np.array([1.0, 30.0, -70.0]), np.array([5.0, 90.0, 200.0])
    affine = AffineMap.of(np.eye(3), np.zeros(3), ("linear",) * 3)
    for axis_map in (NeverClosing(drawn), affine):
        rows = random_axis_values(axis_map, np.random.default_rng(3), lower, upper, 60)
        assert ((rows >= lower) & (rows <= upper)).all()
        assert (np.ptp(rows, axis=0) > 0.8 * (upper - lower)).all()


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_the_smallest_turn_to_a_direction(axis: int) -> None:
    rng = np.random.default_rng(axis)
    for _ in range(20):
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        turn = tilt(direction, axis)
        assert turn[axis] == 0.0
        length = float(np.linalg.norm(turn))
        assert length == pytest.approx(math.acos(direction[axis]), abs=1e-12)
        assert rot_about(turn, math.degrees(length))[:, axis] == pytest.approx(direction, abs=1e-12)


@pytest.mark.parametrize("task", ["pose", "direction", "position"])
@pytest.mark.parametrize("name", ["kr6r900", "ac_table_kin58"])
def test_the_error_is_the_motion_that_is_left(name: str, task: str) -> None:
    """A target 1e-6 away: the error is the Jacobian times that way, up to its square."""
    robot = Robot.load(name)
    kinematics = robot.kinematics
    x = np.array([0.3, -0.4, 0.5, 0.6, 0.7, -0.8])[: len(robot.axes)]
    way = np.array([1.0, -2.0, 3.0, 2.0, -1.0, 1.5])[: len(robot.axes)] * 1e-6
    target = kinematics.pose(kinematics.q(x + way))
    error, J = kinematics.residual(target, task)(x)
    assert error == pytest.approx(J @ way, abs=1e-10)
    assert np.abs(error).max() > 1e-6


def test_si_values_of_a_nonlinear_map() -> None:
    """What solvers iterate on is the robot's own pose at the same axis values, for many rows as for one."""
    robot = Robot.load("cardan_head_kin59")
    assert robot.kinematics.product is None
    rows = np.array([[100.0, -200.0, 300.0, 40.0, 30.0], [1.0, 2.0, 3.0, -50.0, -20.0]])
    for row in rows:
        x = row * np.array([1e-3, 1e-3, 1e-3, math.pi / 180.0, math.pi / 180.0])
        np.testing.assert_allclose(robot.kinematics.q(x), robot.q(row), atol=1e-14)
        steps = 1e-6 * np.eye(5)
        slopes = [(robot.kinematics.q(x + step) - robot.kinematics.q(x - step)) / 2e-6 for step in steps]
        np.testing.assert_allclose(robot.kinematics.dq_dx(x), np.array(slopes).T, atol=1e-8)
    poses = robot.fk_batch(rows)
    assert poses.shape == (2, 4, 4)
    for pose, row in zip(poses, rows, strict=True):
        np.testing.assert_array_equal(pose, robot.fk(row).homogeneous)


def test_held_axes_move_what_the_free_ones_search() -> None:
    robot = Robot.load("kr6r900")
    kinematics, free = robot.kinematics, np.array([0, 2, 3, 4, 5])
    x = np.array([0.0, -0.9, 0.0, 0.0, 0.0, 0.0])
    y = np.array([0.1, 1.1, 0.3, 0.4, 0.5])
    axes = np.insert(y, 1, -0.9)
    target = robot.fk(np.degrees(axes)).homogeneous
    task = TaskError(kinematics, free, x, np.ones(6), -1, -1)
    assert task.error_of(target)(y)[0] == pytest.approx(np.zeros(6), abs=1e-12)
    assert task.misses(y, target, None) == pytest.approx((0.0, 0.0), abs=1e-12)


def test_damped_steps_of_one_row_and_one_column() -> None:
    """J = (3, 4): JᵀJ has the one eigenvalue 25; with damping 5 the step is Jᵀ·error / 30."""
    row, column = np.array([[3.0, 4.0]]), np.array([[3.0], [4.0]])
    for step in (damped_step(row, np.array([10.0]), 5.0), DampedSteps(1, 2).step(row, np.array([10.0]), 5.0)):
        assert step == pytest.approx([1.0, 4.0 / 3.0])
    for step in (damped_step(column, np.array([1.0, 2.0]), 5.0), DampedSteps(2, 1).step(column, np.array([1, 2]), 5.0)):
        assert step == pytest.approx([11.0 / 30.0])
    assert shrinking(0.5, 1e-3)(np.zeros(1), np.array([2.0])) == pytest.approx(2.001)


@pytest.mark.parametrize(("rows", "columns"), [(3, 5), (5, 3), (3, 3)])
def test_damped_steps_by_the_definition(rows: int, columns: int) -> None:
    rng = np.random.default_rng(rows)
    J, error, damping = rng.normal(size=(rows, columns)), rng.normal(size=rows), 3.0
    expected = np.linalg.inv(J.T @ J + damping * np.eye(columns)) @ J.T @ error
    assert damped_step(J, error, damping) == pytest.approx(expected, abs=1e-12)
    assert DampedSteps(rows, columns).step(J, error, damping) == pytest.approx(expected, abs=1e-12)


def test_slides_of_more_rows_than_are_worked_on_at_a_time() -> None:
    """The workpiece turns on a table: the derivative by X, Y, Z in its frame is what 10 mm of each change."""
    robot = Robot.load("ac_table_kin58")
    kinematics, slides = robot.kinematics, np.array([0, 1, 2])
    rows = np.random.default_rng(1).uniform(-50.0, 50.0, (5000, 5))
    places, rates = slides_at(kinematics.product, rows, kinematics.si_factors, slides)
    assert np.abs(places - robot.fk_batch(rows)[:, :3, 3]).max() < 1e-14
    for n in slides:
        moved = rows.copy()
        moved[:, n] += 10.0
        assert np.abs(robot.fk_batch(moved)[:, :3, 3] - places - 0.01 * rates[:, :, n]).max() < 1e-14


@pytest.mark.parametrize(("beyond", "inside"), [(0.0, True), (0.5, True), (2.0, False)])
def test_rows_on_the_limit_and_just_beyond(beyond: float, inside: bool) -> None:
    chain = Robot.load("ac_table_kin58").chain
    total = AxisConstraint("sum", AxisSum((0.0, 0.0, 0.0, 1.0, 1.0), 5.0), -20.0, 30.0)
    axes = (*chain.axes[:3], replace(chain.axes[3], lower=-90.0, upper=45.0), chain.axes[4])
    limits = Limits.of(replace(chain, axes=axes, constraints=(total,)))
    off = beyond * LIMIT_SLACK
    rows = np.zeros((4, 5))
    rows[:, 3:] = (-90.0 - off, 90.0), (45.0 + off, -45.0), (10.0, 15.0 + off), (-10.0, -15.0 - off)
    assert limits.inside_rows(rows).tolist() == [inside] * 4


def test_the_factors_of_pitch_and_turn() -> None:
    """R = Rz(a)·Ry(B)·Rz(C − a); a of the palletiser is its first axis."""
    robot = Robot.load("palletiser_kin213")
    for axes in ([20.0, 0.0, 0.0, 30.0, 0.0], [-70.0, 5.0, -5.0, 10.0, 40.0]):
        values = np.array(axes[: len(robot.axes)])
        a = math.degrees(math.atan2(*robot.frame_placements(values)[robot.chain.joints[0].child].rotation[1::-1, 0]))
        assert abs(a) == pytest.approx(abs(axes[0]))
        expected = rot_z(a) @ rot_y(25.0) @ rot_z(35.0 - a)
        np.testing.assert_allclose(raised_and_turned(robot.chain, values, 25.0, 35.0), expected, atol=1e-14)


def test_two_angles_turn_z_unless_said_otherwise() -> None:
    display = Display("direction", ("c_deg", "a_deg"), letters="CA")
    assert vector_of_angles(display, (0.0, 0.0)).tolist() == [0.0, 0.0, 1.0]
    assert vector_of_angles(display, (90.0, 30.0)) == pytest.approx([0.5, 0.0, math.sqrt(0.75)])


def test_rows_inside_limits_of_sums_and_drives() -> None:
    """A + B of 30 at most and, where it counts, a drive at A − B of −20 at least."""
    chain = Robot.load("ac_table_kin58").chain
    total = AxisConstraint("sum", AxisSum((0.0, 0.0, 0.0, 1.0, 1.0), 0.0), -math.inf, 30.0)
    rows = np.array([[0, 0, 0, 10, 15], [0, 0, 0, 10, 25], [0, 0, 0, -15, 10], [0, 0, 0, 200, -190]], dtype=float)
    summed = Limits.of(replace(chain, constraints=(total,)))
    assert summed.inside_rows(rows).tolist() == [True, False, True, False]
    A = np.eye(5)
    A[3, 4] = -1.0
    geared = replace(chain, drives=AffineDrives(A, np.zeros(5)), drive_limits=(DriveLimit(3, lower=-20.0),))
    assert Limits.of(geared).inside_rows(rows).tolist() == [True, True, False, False]


def test_a_bent_drive_is_looked_at_row_by_row() -> None:
    """By 2.29 the drive stands at 2·asin(sin(A/2)/sin 45°): 42.94° at A = 30, 145.66° at 85."""
    chain = Robot.load("cardan_head_kin59").chain
    limits = Limits.of(chain.with_drive_limits((DriveLimit(4, -100.0, 100.0),)))
    rows = np.zeros((3, 5))
    rows[:, 4] = 30.0, 85.0, -85.0
    assert limits.curved
    assert limits.inside_rows(rows).tolist() == [True, False, False]
