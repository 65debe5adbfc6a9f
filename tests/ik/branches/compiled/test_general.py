"""Six rotary joints in any arrangement, compiled: the plain path's branches, and none missing where it is sure."""

from __future__ import annotations

import math
from functools import cache
from pathlib import Path
from typing import Any
from zlib import crc32

import numba
import numpy as np
import pytest

from chainbuild.ik.branches.compiled.constants import COLUMNS, ROWS, UNSURE
from chainbuild.ik.branches.compiled.entries import FORMS
from chainbuild.ik.branches.compiled.general import constants, eigen, solutions
from chainbuild.ik.branches.compiled.general.constants import general_constants
from chainbuild.ik.branches.compiled.general.eigen import eigenvalues_of
from chainbuild.ik.branches.core.serial import Screw, Serial
from chainbuild.ik.branches.elimination.elimination import elimination
from chainbuild.ik.search.compiled import kernels
from chainbuild.ik.search.compiled.entries import kept_jit
from chainbuild.ik.search.compiled.kernels import FAST
from chainbuild.tolerances import ROTATION_MATRIX
from tests.bench.arms.geometry import OTHER, Arm
from tests.bench.arms.truth import descend, isolation
from tests.kit.general_arms import DRAWN, arm_of, at_random, calibrated, rounded
from tests.kit.parallel_arms import pose_by_hand

Rows = np.ndarray
SAME = 1e-4  # rad: branches nearer than this are one
WEAKEST = 5e-6  # rad by which solutions of a sure pose may be off where the arm is nearly singular, at most
KINDS = ("at random", 90.0, 45.0, 30.0)  # of joint values: at random, or multiples of an angle


def _kept(fingerprint: int) -> Any:
    """Return the eigenvalues' code as a function that Python may call, its machine code kept on disk."""

    @kept_jit(**FAST)
    def eigenvalues(A, n, real, imaginary):
        """Find the eigenvalues of the first n rows and columns of A (n + 1, n + 1)."""
        return eigenvalues_of(A, n + 0 * fingerprint, real, imaginary)

    return eigenvalues


EIGENVALUES = _kept(crc32(b"".join(Path(str(m.__file__)).read_bytes() for m in (eigen, kernels))))


def compiled(packed: np.ndarray, targets: np.ndarray) -> list[tuple[Rows, bool]]:
    """Return the joint values (k, 6) of poses (N, 4, 4), and whether the form is sure of them."""
    values, counts = np.full((len(targets), ROWS, COLUMNS), np.nan), np.empty(len(targets), np.int64)
    FORMS["general"](packed, np.ascontiguousarray(targets), ROTATION_MATRIX, np.zeros(6), values, counts)
    kept = np.where(counts < 0, UNSURE - counts, counts)
    return [(rows[:n, :6], bool(count >= 0)) for rows, n, count in zip(values, kept, counts, strict=True)]


def apart(row: np.ndarray, others: Rows) -> float:
    """Return how far joint values (6,) are from the nearest of others (k, 6), whole turns aside [rad]."""
    return float((2.0 * np.abs(np.sin((others - row) / 2.0))).max(axis=1).min(initial=math.inf))


def truth_arm(serial: Serial) -> Arm:
    """Return an arm as the NumPy formulas of the bench take it."""
    axes, points = (np.array([getattr(s, part) for s in serial.screws]) for part in ("direction", "point"))
    return Arm("", OTHER, False, axes, points, serial.M)


def plain(serial: Serial, T: np.ndarray, within: float) -> Rows:
    """Return the plain elimination's solutions of a pose, once each; what lies between two that nearly meet is none."""
    near = [values for values, _ in solver_of(serial).solve(T, np.zeros(6))]
    near = [values for values in near if np.abs(pose_by_hand(serial, values) - T).max() < within]
    if not near:
        return np.empty((0, 6))
    settled, left = descend(truth_arm(serial), np.array(near), np.array([T] * len(near)))
    found = np.empty((0, 6))
    for values in settled[left < 1e-12]:
        if apart(values, found) > SAME:
            found = np.vstack((found, values))
    return found


@cache
def solver_of(serial: Serial) -> Any:
    solver = elimination(serial)
    assert solver is not None
    return solver


@cache
def arms() -> dict[str, Serial]:
    """Return arms by name: as drawn, calibrated, rounded, in no order at all."""
    rng = np.random.default_rng(1)
    made = {"random": at_random(rng)}
    for name, steps in DRAWN.items():
        made[f"{name} calibrated"] = arm_of(calibrated(steps, rng))
    for name in ("jaco", "crx", "gofa", "sixteen", "spun"):
        made[name] = arm_of(DRAWN[name])
        made[f"{name} rounded"] = arm_of(rounded(DRAWN[name], 4))
    return made


@cache
def packed_of(name: str) -> np.ndarray:
    packed = general_constants(arms()[name])
    assert packed is not None
    return packed


def joint_values(kind: str | float, count: int, rng: np.random.Generator, beside: float = 0.0) -> np.ndarray:
    """Return joint values (count, 6), at random or multiples of an angle [deg], and all of them a little beside."""
    if isinstance(kind, str):
        return rng.uniform(-math.pi, math.pi, (count, 6))
    right = np.radians(kind) * rng.integers(0, round(360.0 / kind), (count, 6))
    return np.asarray(right + beside * rng.normal(size=(count, 6)))


def check(name: str, q: np.ndarray) -> int:
    """Compare the kernel with plain elimination at joint values (N, 6); return at how many poses it is sure."""
    serial = arms()[name]
    targets = np.array([serial.pose(row) for row in q])
    sure_of = 0
    for row, target, (found, sure) in zip(q, targets, compiled(packed_of(name), targets), strict=True):
        if not sure:
            continue
        for values in found:
            assert np.abs(pose_by_hand(serial, values) - target).max() < 1e-8
        sure_of += 1
        assert apart(row, found) < WEAKEST
        theirs = plain(serial, target, within=1e-8)
        assert len(found) >= len(theirs)
        for values in theirs:
            assert apart(values, found) < SAME
    return sure_of


QUICK = ("random", "ur5 calibrated", "kr6 calibrated", "jaco", "crx calibrated", "gofa rounded", "sixteen")


@pytest.mark.parametrize("name", QUICK)
def test_the_branches_of_plain_elimination(name: str) -> None:
    assert check(name, joint_values("at random", 6, np.random.default_rng(2))) >= 5


@pytest.mark.parametrize("name", ["crx", "spun"])
def test_nothing_is_missing_at_right_angles(name: str) -> None:
    assert check(name, joint_values(90.0, 60, np.random.default_rng(3))) <= 30  # most of these are singular
    assert check(name, joint_values(30.0, 8, np.random.default_rng(4), beside=1e-3)) >= 4


@pytest.mark.parametrize(("name", "share"), [("kr6 calibrated", 0.98), ("ur5 calibrated", 0.9175)])
def test_calibrated_arms_are_solved_surely_where_the_nominal_ones_are_singular(name: str, share: float) -> None:
    # Seven of the second arm's need one of the last three openings, seven a complex eigenvalue beside the real ones.
    serial, q = arms()[name], joint_values(90.0, 400, np.random.default_rng(10))
    answers = compiled(packed_of(name), np.array([serial.pose(row) for row in q]))
    assert sum(sure for _, sure in answers) >= share * len(q)
    assert all(not sure or apart(row, found) < WEAKEST for row, (found, sure) in zip(q, answers, strict=True))
    assert check(name, q[:8]) >= 6


def test_no_pose_is_sure_where_solutions_are_a_curve() -> None:
    serial, q = arms()["sixteen"], joint_values(90.0, 200, np.random.default_rng(12))
    singular = q[isolation(truth_arm(serial), q) < 1e-9]
    assert len(singular) > 50
    answers = compiled(packed_of("sixteen"), np.array([serial.pose(row) for row in singular]))
    assert not any(sure for _, sure in answers)


@pytest.mark.parametrize("name", ["gofa rounded", "sixteen rounded", "jaco rounded"])
def test_solutions_of_sure_poses_are_settled(name: str) -> None:
    """Nearly singular arms: along their weakest direction a small residual is far from the solution."""
    q = joint_values(90.0, 1000, np.random.default_rng(13), beside=1e-6)
    answers = compiled(packed_of(name), np.array([arms()[name].pose(row) for row in q]))
    assert sum(sure for _, sure in answers) > 100
    assert all(not sure or apart(row, found) < WEAKEST for row, (found, sure) in zip(q, answers, strict=True))


def test_two_branches_of_one_hidden_value() -> None:
    # Two eigenvalues coincide here; Newton steps from a mixture of their branches end at branches of others.
    q = np.radians([[0.0, 90.0, 270.0, 0.0, 270.0, 270.0]])
    check("sixteen", q)


def test_two_branches_that_meet_are_no_complex_pair() -> None:
    # Rounding makes two real eigenvalues a complex pair, farther from the real ones than its share would be.
    check("sixteen rounded", np.radians([[90.0, 90.0, 0.0, 270.0, 90.0, 0.0]]))


@pytest.mark.slow
@pytest.mark.parametrize("name", list(arms()))
def test_the_branches_of_plain_elimination_everywhere(name: str) -> None:
    rng = np.random.default_rng(5)
    assert check(name, joint_values("at random", 150, rng)) >= 145
    for kind in KINDS[1:]:
        for beside in (0.0, 1e-6, 1e-3):
            check(name, joint_values(kind, 40, rng, beside))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_calibrated_arms(seed: int) -> None:
    rng = np.random.default_rng([6, seed])
    for name, steps in DRAWN.items():
        serial = arm_of(calibrated(steps, rng))
        packed = general_constants(serial)
        assert packed is not None, name
        # As many poses as its own joint values can be looked for in: the plain path takes a thousand times as long.
        for kind, share in (("at random", 0.99), (45.0, 0.95), (90.0, 0.9)):
            q = joint_values(kind, 500, rng)
            answers = compiled(packed, np.array([serial.pose(row) for row in q]))
            assert sum(sure for _, sure in answers) >= share * len(q)
            for row, (found, sure) in zip(q, answers, strict=True):
                assert not sure or apart(row, found) < WEAKEST


def test_sixteen_branches() -> None:
    # Manseur and Doty 1989, "A robot manipulator with 16 real inverse kinematic solution sets".
    serial = arms()["sixteen"]
    target = np.array([
        [-0.760117, -0.641689, 0.102262, -1.140165],
        [0.133333, 0.0, 0.991071, 0.0],
        [-0.635966, 0.766965, 0.085558, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ])  # fmt: skip
    u, _, v = np.linalg.svd(target[:3, :3])  # printed to six digits
    target[:3, :3] = u @ v
    ((found, sure),) = compiled(packed_of("sixteen"), target[None])
    assert sure
    assert len(found) == 16
    for n, values in enumerate(found):
        assert np.abs(pose_by_hand(serial, values) - target).max() < 1e-9
        assert apart(values, np.delete(found, n, axis=0)) > SAME


def test_no_branch_is_told_surely_only_where_nothing_leads_to_the_pose() -> None:
    far = np.eye(4)
    far[:3, 3] = 100.0
    ((found, sure),) = compiled(packed_of("random"), far[None])
    assert len(found) == 0
    assert sure


@pytest.mark.parametrize("name", ["ur5 calibrated", "jaco", "crx"])
def test_a_pose_just_out_of_reach(name: str) -> None:
    """Beside poses of a stretched arm; those that are told to have no branch have none."""
    serial, rng, none = arms()[name], np.random.default_rng(11), 0
    q = joint_values(90.0, 200, rng)
    targets = np.array([serial.pose(row) for row in q])
    targets[:, :3, 3] += 10.0 ** -rng.uniform(3.0, 7.0, (len(q), 1)) * rng.normal(size=(len(q), 3))
    for row, target, (found, sure) in zip(q, targets, compiled(packed_of(name), targets), strict=True):
        if sure and not len(found):
            none += 1
            starts = row + 0.03 * rng.normal(size=(30, 6))
            assert descend(truth_arm(serial), starts, np.array([target] * 30))[1].min() > 1e-9
    assert none >= 4


def test_a_wrong_sign_is_noticed() -> None:
    serial = arms()["gofa rounded"]
    q = joint_values("at random", 20, np.random.default_rng(7))
    targets = np.array([serial.pose(row) for row in q])
    packed = packed_of("gofa rounded")
    wrong = packed.copy()
    for n in range(int(wrong[0])):
        row = constants.OPENINGS + n * constants.PER_OPENING + constants.LEFT
        wrong[row : row + 27] *= -1.0  # one of the fourteen equations
    known = [
        sum(apart(row, found) < 1e-6 for row, (found, _) in zip(q, compiled(one, targets), strict=True))
        for one in (packed, wrong)
    ]
    assert known[0] == len(q)
    assert known[1] < len(q) // 2


def test_what_is_no_such_arm() -> None:
    screws = arms()["random"].screws
    slide = Screw("prismatic", screws[2].direction, screws[2].point, 2)
    M = np.eye(4)
    assert general_constants(Serial((*screws[:2], slide, *screws[3:]), M)) is None
    assert general_constants(Serial(screws[:5], M)) is None
    assert general_constants(Serial((*screws[:5], screws[4]), M)) is None


def eigenvalues(A: np.ndarray) -> np.ndarray:
    n = len(A)
    room, real, imaginary = np.full((n + 1, n + 1), np.nan), np.empty(n), np.empty(n)
    room[:n, :n] = A
    assert EIGENVALUES(room, n, real, imaginary)
    return np.asarray(real + 1j * imaginary)


def farthest(ours: np.ndarray, theirs: np.ndarray) -> float:
    """Return the largest distance when each of ours takes the nearest of theirs that is left."""
    left, worst = list(theirs), 0.0
    for one in ours:
        n = int(np.argmin(np.abs(np.array(left) - one)))
        worst = max(worst, abs(left.pop(n) - one))
    return worst


@pytest.mark.parametrize("size", [3, 16, 20])
def test_eigenvalues_are_those_of_lapack(size: int) -> None:
    rng = np.random.default_rng(8)
    for scale in (1e-3, 1.0, 1e3):
        A = scale * rng.normal(size=(size, size))
        for matrix in (A, A + A.T, A - A.T, A * rng.uniform(0.0, 1.0, size)):
            assert farthest(eigenvalues(matrix), np.linalg.eigvals(matrix)) < 1e-11 * size * scale


@pytest.mark.parametrize("order", [2, 3, 4])
def test_eigenvalues_of_defective_matrices(order: int) -> None:
    rng = np.random.default_rng(9)
    values = 0.5 * (np.arange(16) // order) - 1.0
    block = np.diag(values) + np.diag([float((n + 1) % order > 0) for n in range(15)], 1)
    for _ in range(5):
        Q, _ = np.linalg.qr(rng.normal(size=(16, 16)))
        found = eigenvalues(Q @ block @ Q.T)
        assert farthest(found, values) < 10.0 * 1e-15 ** (1.0 / order)
        for value in np.unique(values):  # the mean of a cluster is exact
            cluster = found[np.abs(found - value) < 0.25]
            assert len(cluster) == np.sum(values == value)
            assert abs(cluster.mean() - value) < 1e-10


def test_what_is_no_matrix_of_numbers_does_not_settle() -> None:
    room, values = np.full((4, 4), np.nan), np.empty(3)
    assert not EIGENVALUES(room, 3, values, values.copy())
    assert list(eigenvalues(np.zeros((16, 16)))) == [0.0] * 16


def test_how_far_off_a_solution_is_the_next_step_tells() -> None:
    """Pivots do not: here all of them are 1, and the weakest singular value is a thirtieth."""
    regular = numba.njit(solutions.is_regular.py_func)
    J = np.eye(6, 7) - np.triu(np.ones((6, 7)), 1)
    for residual, is_settled in ((5e-8, True), (2e-7, False)):
        J[:, 6] = residual  # the step is up to 32 times as long
        assert regular(J.copy()) is is_settled
    J[5, 5] = 1e-7
    J[:, 6] = 0.0
    assert not regular(J), "on a curve, or next to another"
