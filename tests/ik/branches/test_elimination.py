"""Six joints of any kind: every solution, against a published count, other libraries and scipy's rotations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from py_opw_kinematics import KinematicModel
from py_opw_kinematics import Robot as OpwRobot
from scipy.spatial.transform import RigidTransform, Rotation

import chainbuild
from chainbuild.comparison.eaik_model import eaik_answers, eaik_robot
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.core.serial import Screw, Serial
from chainbuild.ik.branches.elimination.conformal import arrow, coefficients, motion
from chainbuild.ik.branches.elimination.eliminant import is_among
from chainbuild.ik.branches.elimination.elimination import elimination
from chainbuild.ik.request import IkRequest
from tests.kit.general_arms import DRAWN, arm_of, calibrated
from tests.kit.robots import ur5

Rows = list[np.ndarray]


def denavit_hartenberg(theta: float, a: float, d: float, alpha: float) -> np.ndarray:
    c, s, ca, sa = math.cos(theta), math.sin(theta), math.cos(alpha), math.sin(alpha)
    return np.array([[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]])


# Manseur and Doty 1989, "A robot manipulator with 16 real inverse kinematic solution sets".
A, D, ALPHA = (0.3, 1.0, 0.0, 1.5, 0.0, 0.0), (0.0, 0.0, 0.2, 0.0, 0.0, 0.0), np.radians([90, 1, 90, 1, 90, 1])
SIXTEEN = np.array(
    [
        [-0.760117, -0.641689, 0.102262, -1.140165],
        [0.133333, 0.0, 0.991071, 0.0],
        [-0.635966, 0.766965, 0.085558, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ]
)


def manseur_doty(q: np.ndarray) -> np.ndarray:
    T = np.eye(4)
    for n in range(6):
        T = T @ denavit_hartenberg(q[n], A[n], D[n], ALPHA[n])
    return T


def by_hand(screws: list[Screw], M: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return the pose of a row of screws by scipy's rotations."""
    T = np.eye(4)
    for screw, value in zip(screws, q, strict=True):
        step = np.eye(4)
        if screw.kind == "prismatic":
            step[:3, 3] = value * screw.direction
        else:
            step[:3, :3] = Rotation.from_rotvec(value * screw.direction).as_matrix()
            step[:3, 3] = screw.point - step[:3, :3] @ screw.point
        T = T @ step
    return T @ M


def apart(one: np.ndarray, other: np.ndarray, screws: tuple[Screw, ...]) -> float:
    turns = np.array([screw.kind == "revolute" for screw in screws])
    off = one - other
    off[turns] = np.remainder(off[turns] + np.pi, 2.0 * np.pi) - np.pi
    return float(np.abs(off).max())


def exact(serial: Serial, T: np.ndarray, within: float = 1e-7) -> Rows:
    """Return the solutions, once each."""
    solver = elimination(serial)
    assert solver is not None
    found: Rows = []
    for values, _ in solver.solve(T, np.zeros(6)):
        close = np.abs(by_hand(list(serial.screws), serial.M, values) - T).max() < within
        if close and all(apart(values, other, serial.screws) > 1e-4 for other in found):
            found.append(values)
    return found


def same_sets(ours: Rows, theirs: Rows, screws: tuple[Screw, ...], within: float = 1e-6) -> bool:
    return all(
        any(apart(row, other, screws) < within for other in others)
        for rows, others in ((ours, theirs), (theirs, ours))
        for row in rows
    )


def test_an_arrow_moves_as_its_matrix_says() -> None:
    rng = np.random.default_rng(0)
    for _ in range(20):
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = Rotation.random(random_state=rng).as_matrix(), rng.normal(size=3)
        p, direction = rng.normal(size=3), rng.normal(size=3)
        moved = arrow(T[:3, :3] @ p + T[:3, 3], T[:3, :3] @ direction)
        np.testing.assert_allclose(motion(T) @ arrow(p, direction), moved, atol=1e-12)


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_a_joint_is_of_the_first_degree(kind) -> None:
    rng = np.random.default_rng(1)
    direction = rng.normal(size=3)
    screw = Screw(kind, direction / np.linalg.norm(direction), rng.normal(size=3), 0)
    parts = coefficients(screw)
    for value in rng.uniform(-3.0, 3.0, 5):
        powers = np.exp(1j * value * np.array([-1, 0, 1])) if kind == "revolute" else value ** np.arange(3)
        np.testing.assert_allclose(np.tensordot(powers, parts, 1), motion(screw.T(value)), atol=1e-12)


def test_sixteen_solutions() -> None:
    screws, T = [], np.eye(4)
    for n in range(6):
        screws.append(Screw("revolute", T[:3, 2].copy(), T[:3, 3].copy(), n))
        T = T @ denavit_hartenberg(0.0, A[n], D[n], ALPHA[n])
    u, _, v = np.linalg.svd(SIXTEEN[:3, :3])  # printed to six digits
    target = SIXTEEN.copy()
    target[:3, :3] = u @ v
    found = exact(Serial(tuple(screws), T), target)
    assert len(found) == 16
    for q in found:
        assert np.abs(manseur_doty(q) - target).max() < 1e-9


def test_the_sets_that_eaik_finds() -> None:
    robot = ur5()
    serial = BranchQuery.of(IkRequest.of(robot, robot.fk(np.zeros(6)))).serial()
    theirs = eaik_robot(serial)
    rng = np.random.default_rng(2)
    for _ in range(60):
        T = serial.pose(rng.uniform(-np.pi, np.pi, 6))
        answers = [row for row, approximate in eaik_answers(theirs, serial, T) if not approximate]
        assert same_sets(exact(serial, T), answers, serial.screws)


def test_the_sets_that_an_ortho_parallel_arm_has() -> None:
    oracle = OpwRobot(KinematicModel(a1=25.0, a2=-35.0, b=0.0, c1=400.0, c2=455.0, c3=420.0, c4=80.0))
    signs, zero = np.array([-1.0, 1.0, 1.0, -1.0, 1.0, -1.0]), np.array([0.0, 90.0, 0.0, 0.0, 0.0, 0.0])
    robot = chainbuild.Robot.load("kr6r900")
    serial = BranchQuery.of(IkRequest.of(robot, robot.fk(np.zeros(6)))).serial()
    rng = np.random.default_rng(3)
    for _ in range(60):
        T = robot.fk(rng.uniform(-170.0, 170.0, 6)).homogeneous
        pose = T.copy()
        pose[:3, 3] *= 1000.0
        axes = (np.array(oracle.inverse(RigidTransform.from_matrix(pose))) - zero) * signs
        theirs = [robot.q(row) for row in axes]
        assert same_sets(exact(serial, T), theirs, serial.screws, within=1e-5)


def random_row(kinds: str, rng: np.random.Generator) -> Serial:
    screws = []
    for n, kind in enumerate(kinds):
        direction = rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        screws.append(Screw("revolute" if kind == "r" else "prismatic", direction, rng.normal(size=3), n))
    M = np.eye(4)
    M[:3, :3], M[:3, 3] = Rotation.random(random_state=rng).as_matrix(), rng.normal(size=3)
    return Serial(tuple(screws), M)


@pytest.mark.parametrize("kinds", ["rrrrrr", "prrrrr", "rrrprr", "rrrrrp", "pprrrr", "rpprrr", "prrprr", "pprprr"])
def test_rows_in_no_order_at_all(kinds: str) -> None:
    rng = np.random.default_rng(4)
    for _ in range(10):
        serial = random_row(kinds, rng)
        q = rng.uniform(-2.0, 2.0, 6)
        found = exact(serial, by_hand(list(serial.screws), serial.M, q))
        assert min(apart(q, other, serial.screws) for other in found) < 1e-6
        assert len(found) % 2 == 0  # a closed curve crosses an even number of times


def test_where_the_row_stands_does_not_matter() -> None:
    rng = np.random.default_rng(5)
    serial = random_row("rrrrrr", rng)
    far = np.eye(4)
    far[:3, :3], far[:3, 3] = Rotation.random(random_state=rng).as_matrix(), (40.0, -30.0, 5.0)
    moved = Serial(
        tuple(
            Screw(s.kind, far[:3, :3] @ s.direction, far[:3, :3] @ s.point + far[:3, 3], s.joint) for s in serial.screws
        ),
        far @ serial.M,
    )
    q = rng.uniform(-2.0, 2.0, 6)
    near, away = exact(serial, serial.pose(q)), exact(moved, moved.pose(q))
    assert len(near) == len(away) > 0
    assert same_sets(near, away, serial.screws)


def test_nothing_reaches_what_is_too_far() -> None:
    serial = random_row("rrrrrr", np.random.default_rng(6))
    T = np.eye(4)
    T[:3, 3] = (100.0, 0.0, 0.0)
    assert exact(serial, T) == []


def test_an_arm_without_six_joints_of_use_is_refused() -> None:
    serial = random_row("rrrrrr", np.random.default_rng(7))
    twice = Serial((*serial.screws[:5], serial.screws[4]), serial.M)
    assert elimination(twice) is None
    assert elimination(Serial(serial.screws[:5], serial.M)) is None


def test_whole_turns_of_rotary_joints_make_no_difference() -> None:
    turns, one = np.array([True, False]), np.array([0.5, 0.2])
    assert is_among(one, [[9.0, 9.0], one + [4.0 * math.pi, 0.0]], turns, 1e-6)
    assert not is_among(one, [one + [0.0, 4.0 * math.pi]], turns, 1e-6)
    assert not is_among(one, [one + [1e-3, 0.0], one + [0.0, 1e-3]], turns, 1e-6)
    assert not is_among(one, [], turns, 1e-6)


def test_solutions_with_many_digits_are_read_once() -> None:
    # Nearly a spherical wrist: two solutions of one wrist position have nearly the same first three joints.
    rng = np.random.default_rng(14)
    serial = arm_of(calibrated(DRAWN["irb120"], rng))
    solver = elimination(serial)
    assert solver is not None
    for q in rng.uniform(-math.pi, math.pi, (8, 6)):
        T = by_hand(list(serial.screws), serial.M, q)
        rows = exact(serial, T)
        assert min(apart(row, q, serial.screws) for row in rows) < 1e-6
        assert len(solver.solve(T, np.zeros(6))) <= 2 * len(rows)


@pytest.mark.parametrize("name", ["irb120", "kr6"])
def test_solutions_with_few_digits_are_kept(name: str) -> None:
    """Nearly singular: of some solutions there are only readings with few digits, which Newton's steps bring there."""
    rng = np.random.default_rng(15)
    serial = arm_of(calibrated(DRAWN[name], rng))
    solver, lost = elimination(serial), 0
    assert solver is not None
    for q in np.radians(90.0 * rng.integers(0, 4, (40, 6))):
        rows = [values for values, _ in solver.solve(by_hand(list(serial.screws), serial.M, q), np.zeros(6))]
        lost += min(apart(row, q, serial.screws) for row in rows) > 1e-3
    assert lost <= 3  # as many as the equations lose; ten and more with the exact readings alone
