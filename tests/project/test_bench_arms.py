"""What `make bench-arms` counts: the truth about all branches is found without any solver, and each is judged by it."""

from __future__ import annotations

import json
import runpy
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.bench.arms import measure as measuring
from tests.bench.arms.geometry import OTHER, SPHERICAL, Arm, calibrated, errors, prebuilt_arm, rotation, turn_vectors
from tests.bench.arms.measure import KINDS, RIGHT_ANGLES, Findings, joint_values, measure
from tests.bench.arms.peers import OURS, PLAIN, Peer, eaik, opw, ours, peers, robot_of
from tests.bench.arms.truth import SAME, clusters, distance, is_right, isolation, truths
from tests.kit.paths import ROOT

RNG = np.random.default_rng(5)


def palletizer() -> Arm:
    """Return an arm with a spherical wrist, its lengths invented."""
    y, z, x = np.eye(3)[[1, 2, 0]]
    points = np.array([[0, 0, 0], [0.1, 0, 0.4], [0.1, 0, 0.9], [0.6, 0, 0.95], [0.6, 0, 0.95], [0.6, 0, 0.95]])
    M = np.eye(4)
    M[:3, :3], M[:3, 3] = rotation(np.array([0.0, 0.5 * np.pi, 0.0])), [0.7, 0.0, 0.95]
    return Arm("palletizer", SPHERICAL, False, np.array([z, y, y, x, y, x]), points, M)


ARM = palletizer()
Q = np.array([0.3, -0.5, 0.4, 0.6, 0.8, -1.0])
T = ARM.pose(Q)


def all_of(arm: Arm, q: np.ndarray, starts: int = 80) -> np.ndarray:
    """Return all isolated branches of the pose at joint values, by descents alone."""
    (truth,) = truths(arm, arm.pose(q)[None], q[None], [], np.random.default_rng(0), starts)
    return truth.branches


BRANCHES = all_of(ARM, Q)


@pytest.mark.parametrize("arm", [ARM, calibrated(ARM)], ids=lambda arm: arm.name)
def test_chainbuild_is_given_the_same_arm(arm: Arm) -> None:
    robot = robot_of(arm)
    for q in RNG.uniform(-3.0, 3.0, (5, 6)):
        assert np.abs(robot.fk(np.degrees(q)) - arm.pose(q)).max() < 1e-12


def test_the_jacobian_is_how_the_pose_moves() -> None:
    R, t, J = ARM.kinematics(Q[None])
    for i, step in enumerate(1e-6 * np.eye(6)):
        R2, t2, _ = ARM.kinematics((Q + step)[None])
        moved = np.concatenate([(t2 - t)[0], turn_vectors(R2 @ R.transpose(0, 2, 1))[0]])
        assert np.abs(moved / 1e-6 - J[0, :, i]).max() < 1e-5


def test_turns_of_every_size_are_measured() -> None:
    for angle in (0.0, 1e-12, 0.3, np.pi - 1e-7):
        v = angle * np.array([0.6, 0.0, 0.8])
        assert np.abs(turn_vectors(rotation(v)[None])[0] - v).max() < 1e-8
    assert np.linalg.norm(turn_vectors(np.diag([1.0, -1.0, -1.0])[None])[0]) == pytest.approx(np.pi)


def test_a_calibrated_arm_is_near_its_own_and_always_the_same() -> None:
    one, two = calibrated(ARM), calibrated(ARM)
    assert np.array_equal(one.M, two.M) and np.array_equal(one.axes, two.axes)
    assert one.family == SPHERICAL and one.calibrated and one.name == "palletizer calibrated"
    assert 1e-4 < np.abs(one.axes - ARM.axes).max() < 0.02
    assert 1e-5 < np.abs(one.points - ARM.points).max() < 0.01
    A, B, C = one.points[3:]
    assert min(np.linalg.norm(A - B), np.linalg.norm(B - C)) > 1e-6  # the wrist's axes do not meet any more


def test_descents_alone_find_all_eight_branches() -> None:
    assert len(BRANCHES) == 8
    (without,) = truths(ARM, T[None], Q[None], [[BRANCHES]], np.random.default_rng(0), 1)
    assert len(without.branches) == 8 and without.alone <= 1
    assert all(np.abs(ARM.pose(q) - T).max() < 1e-11 for q in BRANCHES)
    assert all(len(all_of(ARM, q)) == 8 for q in BRANCHES[1:4])
    found = ours(ARM, plain=True)
    rows = found.joints(found.solve(T), T)
    assert len(rows) == 8 and all(distance(rows, q).min() < 1e-7 for q in BRANCHES)


def test_what_is_missed_and_what_is_wrong() -> None:
    turned = BRANCHES + 2.0 * np.pi * RNG.integers(-1, 2, BRANCHES.shape)
    inaccurate = BRANCHES + 2e-7
    lacking = np.vstack([BRANCHES[:2], BRANCHES[3:], BRANCHES[3:4] + 1e-5])
    answers = [[turned], [inaccurate], [lacking], [np.empty((0, 6))], [None]]
    (truth,) = truths(ARM, T[None], Q[None], answers, np.random.default_rng(1), 20)
    assert len(truth.branches) == 8 and not truth.touching
    assert 4 <= truth.alone <= 8  # of 20 starts
    assert type(truth.alone) is int  # as JSON takes it
    assert [len(missed) for missed in truth.missed] == [0, 0, 1, 8, 0]
    assert truth.wrong == [0, 0, 1, 0, 0]
    assert truth.right == [8, 8, 7, 0, 0]
    assert distance(truth.branches[truth.missed[2][0]], BRANCHES[2]) < 1e-9


def test_position_and_turn_both_count() -> None:
    e = np.eye(6)
    shifted, rolled = 1e-5 * (e[1] - e[2]), 2e-6 * e[5]  # axes 2 and 3 are parallel; the tool stands on axis 6
    place, turn, _ = errors(ARM, np.array([Q + 1e3 * shifted, Q + 1e3 * rolled]), np.array([T, T]))
    assert np.linalg.norm(turn[0]) < 1e-12 > np.linalg.norm(place[1])
    assert is_right(ARM, np.array([Q, Q + shifted, Q + rolled, Q + 0.4 * rolled]), T).tolist() == [
        True,
        False,
        False,
        True,
    ]


def test_the_twin_beside_a_stretched_arm_is_missed() -> None:
    line = np.arctan2(0.05, 0.5) - 0.5 * np.pi  # of axis 3, with the wrist in line with the upper arm
    q = np.array([0.3, 0.2, line + 0.004, 0.6, 0.8, -1.0])
    twins = all_of(ARM, q)
    near = np.sort(distance(twins, q))
    assert near[0] < 1e-9 and 1e-3 < near[1] < 0.02
    lacking = twins[distance(twins, q) != near[1]]
    (truth,) = truths(ARM, ARM.pose(q)[None], q[None], [[twins], [lacking]], np.random.default_rng(1))
    assert [len(missed) for missed in truth.missed] == [0, 1]
    assert distance(truth.branches[truth.missed[1][0]], q) == pytest.approx(near[1], rel=1e-6)


def test_branches_that_touch_are_not_counted_as_missed() -> None:
    stretched = np.array([0.3, -0.5, 0.4, 0.6, 0.0, -1.0])  # axes 4 and 6 in line: a curve of solutions
    (truth,) = truths(ARM, ARM.pose(stretched)[None], stretched[None], [[np.empty((0, 6))]], np.random.default_rng(1))
    assert truth.touching
    assert 0 < len(truth.branches) == len(truth.missed[0]) < 8
    assert isolation(ARM, truth.branches).min() > 1e-5 > isolation(ARM, stretched[None])[0]


def test_near_ones_are_one_branch_and_others_are_not() -> None:
    near = Q + 0.5 * SAME
    assert len(clusters(np.array([Q, near, Q + 2.0 * np.pi]))) == 1
    assert len(clusters(np.array([Q, Q + 2.0 * SAME]))) == 2


def test_poses_are_beside_right_angles_by_what_their_name_says() -> None:
    q = {kind: joint_values(ARM, kind, 20) for kind in KINDS}
    assert np.array_equal(q[RIGHT_ANGLES], joint_values(ARM, RIGHT_ANGLES, 20))
    for kind, off in zip(KINDS[1:], (0.0, 1e-3, 1e-6), strict=True):
        turns = q[kind] / (0.5 * np.pi)
        away = np.linalg.norm((turns - turns.round()) * (0.5 * np.pi), axis=1)
        assert away == pytest.approx(np.full(20, off), rel=1e-3, abs=1e-12)


def test_every_solver_is_counted_at_the_same_poses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measuring, "_PLAIN_EACH", 2)
    exact = ours(ARM, plain=True)
    worse = Peer("worse", exact.prepare, exact.solve, lambda found, T: exact.joints(found, T)[1:] + 0.01)
    first = Peer(OURS, exact.prepare, exact.solve, exact.joints)
    solvers = [first, exact, worse, *(peer for peer in (eaik(ARM), opw(ARM)) if peer is not None)]
    findings = Findings()
    measure(ARM, solvers, 4, findings, KINDS[:2])
    assert {key[3] for key in findings.tallies} == {OURS, PLAIN, "worse", "EAIK", "py-opw-kinematics"}
    for (family, off, kind, name), tally in findings.tallies.items():
        assert (family, off) == (SPHERICAL, False) and kind in KINDS
        assert tally.poses == len(tally.times) == len(tally.ours) == (2 if name == PLAIN else 4)
        assert 0.0 < tally.summary()["median"] <= tally.summary()["p95"]
        assert tally.isolated >= 8
        if name == "worse":
            assert tally.missed == tally.isolated and tally.wrong > 0 and tally.nothing == 4
        else:
            assert tally.missed == tally.wrong == tally.nothing == 0, name
    assert not findings.misses


def test_approximations_of_eaik_count_where_they_are_right() -> None:
    peer = eaik(ARM)
    assert peer is not None
    marked = SimpleNamespace(Q=np.array([Q, Q + 1e-3, Q + 1e-3]), is_LS=np.array([True, True, False]))
    assert np.array_equal(peer.joints(marked, T), [Q + 1e-3, Q])


def test_what_chainbuild_misses_can_be_looked_at() -> None:
    exact = ours(ARM, plain=True)
    findings = Findings()
    measure(
        ARM,
        [Peer(OURS, exact.prepare, exact.solve, lambda found, T: exact.joints(found, T)[1:])],
        1,
        findings,
        KINDS[:1],
    )
    (missed,) = findings.misses
    assert (missed["arm"], missed["kind"], missed["pose"], missed["wrong"]) == ("palletizer", KINDS[0], 0, 0)
    assert missed["q"] == joint_values(ARM, KINDS[0], 1)[0].tolist()
    assert len(missed["missed"]) == 1 and np.abs(ARM.pose(missed["missed"][0]) - ARM.pose(missed["q"])).max() < 1e-8


def test_solvers_that_are_missing_are_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("eaik.IK_HP", "py_opw_kinematics"):
        monkeypatch.setitem(sys.modules, name, None)
    assert [peer.name for peer in peers(ARM, None)] == [OURS, PLAIN]
    said = capsys.readouterr().err
    assert "skipped: eaik" in said and "skipped: opw" in said


def test_an_arm_is_taken_from_the_matrices_of_a_module() -> None:
    module = SimpleNamespace(
        _JOINT_AXES=ARM.axes,
        _JOINT_T_LEFTS=[shift(offset) for offset in ARM.offsets()[:6]],
        _JOINT_T_RIGHTS=[np.eye(4)] * 5 + [shift(ARM.offsets()[6]) @ turned(ARM.M)],
    )
    arm = prebuilt_arm("palletizer_ik", "non-Pieper 6R", module)
    assert (arm.name, arm.family) == ("palletizer", OTHER)
    assert np.abs(arm.pose(Q) - T).max() < 1e-12
    assert prebuilt_arm("a_ik", "Pieper 6R, spherical wrist", module).family == SPHERICAL


def shift(offset: np.ndarray) -> np.ndarray:
    found = np.eye(4)
    found[:3, 3] = offset
    return found


def turned(M: np.ndarray) -> np.ndarray:
    found = np.eye(4)
    found[:3, :3] = M[:3, :3]
    return found


def pages(folder: Path, monkeypatch: pytest.MonkeyPatch, rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the tables of the pages for a run with these rows."""
    found = runpy.run_path(str(ROOT / "docs/arms_tables.py"))
    report = {
        "date": "2026-01-02", "computer": "a computer", "minutes": 3.5, "versions": {"ssik": "8.2.0"}, "arms": 2,
        "poses_each": 5, "touching": 3, "alone": 152, "rows": rows,
    }  # fmt: skip
    file = folder / "arms.json"
    file.write_text(json.dumps(report), "utf-8")
    monkeypatch.setitem(found["report"].__globals__, "FILE", file)
    return found


def row(family: str, solver: str, median: float, ours_median: float, **counts: int) -> dict[str, Any]:
    zero = {"poses": 10, "isolated": 80, "missed": 0, "wrong": 0, "nothing": 0}
    times = {"median": median, "p95": 2.0 * median, "ours_median": ours_median, "ours_p95": 2.5 * ours_median}
    return {"family": family, "calibrated": False, "kind": "random", "solver": solver} | zero | counts | times


def test_the_pages_tell_what_the_run_has_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [
        row("one", OURS, 10.0, 10.0),
        row("one", "ssik", 30.0, 10.0, missed=2, wrong=1, nothing=1),
        row("two", OURS, 20.0, 20.0, missed=1),
        row("two", "ssik", 22.0, 20.0),
        row("two", "EAIK", 5.0, 20.0),
    ]
    found = pages(tmp_path, monkeypatch, rows)
    head, lines = found["missed"]()
    assert head == ["arms", "poses", OURS, "ssik", "EAIK"]
    assert lines[0] == ["one", "random", "0 of 80", "2 of 80, 1 wrong, 1 poses without an answer", ""]
    assert lines[1] == ["two", "random", "1 of 80", "0 of 80", "0 of 80"]
    assert found["times"]()[1] == [
        ["one", "random", "10 / 20", "30 / 60", "", "3.00 / 2.40"],
        ["two", "random", "20 / 40", "22 / 44", "5 / 10", "1.10 / 0.88"],
    ]
    said = found["verdict"]()
    assert "misses 1 of 160 isolated branches and returns 0 wrong ones" in said
    assert "in the median of 2 and in the 95 % of 1 of 2 classes" in said
    assert "2 arms, nominal and calibrated, 5 poses of each kind: 20 poses" in found["run"]()
    assert "160 isolated branches, of which random starts alone found 95.00 %" in found["run"]()
    assert said in found["line"]()
