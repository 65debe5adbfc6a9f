"""Doubtful poses of general arms: no branch missing that descents from everywhere find, whatever is next to it."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from chainbuild.ik.branches.compiled import forms
from chainbuild.ik.branches.compiled.forms import quick_form
from chainbuild.ik.branches.compiled.quick import Doubtful, quick_branches
from chainbuild.robot import Robot
from tests.bench.arms.geometry import OTHER, Arm
from tests.bench.arms.peers import robot_of
from tests.bench.arms.truth import distance, isolation, truths
from tests.kit.general_arms import DRAWN, arm_of, calibrated

FAR = math.radians(30.0)


@cache
def arms() -> dict[str, Arm]:
    found = {}
    for name, steps in DRAWN.items():
        off = calibrated(steps, np.random.default_rng(40))
        for kind, serial in (("", arm_of(steps)), (" calibrated", arm_of(off))):
            axes, points = (np.array([getattr(s, part) for s in serial.screws]) for part in ("direction", "point"))
            found[name + kind] = Arm(name + kind, OTHER, bool(kind), axes, points, serial.M)
    return found


@cache
def robot(name: str) -> Robot:
    return robot_of(arms()[name])


def drawn(name: str, beside: float, count: int) -> np.ndarray:
    """Return joint values (count, 6) at right angles and a little beside."""
    rng = np.random.default_rng([41, *name.encode()])
    away = rng.normal(size=(count, 6))
    right: np.ndarray = rng.integers(-1, 3, (count, 6)) * (math.pi / 2.0)
    return right + beside * away / np.linalg.norm(away, axis=1, keepdims=True)


def missing(name: str, q: np.ndarray) -> tuple[int, int, int]:
    """Return of the poses of joint values (n, 6) how many isolated branches there are, are missing, and are wrong."""
    arm = arms()[name]
    T = np.array([arm.pose(row) for row in q])
    rows = [np.radians(robot(name).ik_all(pose).axes) for pose in T]
    judged = truths(arm, T, q, [rows], np.random.default_rng(42))
    known, missed = sum(len(one.branches) for one in judged), sum(len(one.missed[0]) for one in judged)
    return known, missed, sum(one.wrong[0] for one in judged)


QUICK = ("jaco", "crx", "gofa calibrated", "ur5 calibrated", "kr6 calibrated")


@pytest.mark.parametrize("beside", [0.0, 1e-6, 1e-3])
@pytest.mark.parametrize("name", QUICK)
def test_no_branch_is_missing_at_right_angles_and_beside_them(name: str, beside: float) -> None:
    known, missed, wrong = missing(name, drawn(name, beside, 5))
    assert known > 10
    assert (missed, wrong) == (0, 0)


@pytest.mark.slow
@pytest.mark.parametrize("beside", [0.0, 1e-6, 1e-3])
@pytest.mark.parametrize("name", [f"{name}{kind}" for name in DRAWN for kind in ("", " calibrated")])
def test_no_branch_is_missing_anywhere(name: str, beside: float) -> None:
    known, missed, wrong = missing(name, drawn(name, beside, 120))
    assert known > 200
    assert (missed, wrong) == (0, 0)


def doubtful_poses(name: str, beside: float, count: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return joint values and poses of which the form alone is not sure."""
    form, x0 = quick_form(robot(name), None, None)
    assert form is not None
    found = []
    for q in drawn(name, beside, count):
        T = arms()[name].pose(q)
        room = np.empty((1, 32, 6)), np.empty((1, 32, 6)), np.empty((1, 32, 6)), np.empty(1, np.int64)
        if form.write(T[None], x0, *room)[0] < 0:
            found.append((q, T))
    return found


def test_a_branch_beside_a_fold_is_found_from_the_other_one() -> None:
    arm, found = arms()["ur5 calibrated"], 0
    for q, T in doubtful_poses("ur5 calibrated", 1e-3, 60):
        form, x0 = quick_form(robot("ur5 calibrated"), None, None)
        assert form is not None
        places, isolated = form.places_at(T, x0)
        if isolated and isolation(arm, q[None])[0] < 3e-4:
            found += 1
            assert distance(places, q).min() < 1e-6
            apart = distance(places, q)
            assert np.sort(apart)[1] < 0.1  # the branch on the other side
    assert found >= 1


def test_many_poses_have_the_branches_of_each() -> None:
    poses = [T for _, T in doubtful_poses("crx", 1e-3, 40)][:6]
    assert len(poses) == 6
    together = robot("crx").ik_all_batch(np.array(poses))
    for T, rows in zip(poses, together, strict=True):
        alone = robot("crx").ik_all(T).axes
        known = rows[np.isfinite(rows).all(axis=1)]
        assert len(known) == len(alone)
        assert max(distance(np.radians(known), np.radians(row)).min() for row in alone) < 1e-9


def test_solutions_on_a_curve_are_left_to_the_plain_path_which_tells_their_direction() -> None:
    """A stretched wrist, whose axes 4 and 6 turn against one another; calibrated, they no longer do."""
    arm = arms()["kr6 calibrated"]
    straight = arms()["kr6"]
    q = np.array([0.3, -1.0, 0.7, 0.4, 0.0, -0.8])
    found = robot("kr6").ik_all(straight.pose(q))
    curves = [row for row in found if len(row.free_directions)]
    assert curves
    assert not any(len(row.free_directions) for row in robot("kr6 calibrated").ik_all(arm.pose(q)))


def test_what_no_pose_beside_finds_is_searched_for(monkeypatch: pytest.MonkeyPatch) -> None:
    name = "jaco"
    _, T = doubtful_poses(name, 1e-3, 40)[0]
    form, x0 = quick_form(robot(name), None, None)
    assert form is not None
    known, _ = form.places_at(T, x0)
    nowhere = forms._entries().FORMS | {"general": lambda *room: room[-1].fill(-3)}
    monkeypatch.setattr(forms._entries(), "FORMS", nowhere)
    places, _ = form.places_at(T, x0)
    assert len(places)
    assert all(distance(known, place).min() < 1e-5 for place in places)


def test_a_pose_out_of_reach_has_no_branches() -> None:
    far = np.eye(4)
    far[:3, 3] = 30.0
    found = quick_branches(robot("jaco"), far, None, None)
    assert isinstance(found, Doubtful)
    assert len(found.places) == 0
    assert len(robot("jaco").ik_all(far)) == 0
