"""Doubtful poses of general arms: no branch missing that descents from everywhere find, whatever is next to it."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from chainbuild.chain.assemble import Fixed, Mark, Move
from chainbuild.chain.elements import Axis
from chainbuild.ik.branches.compiled.constants import COLUMNS, ROWS, UNSURE
from chainbuild.ik.branches.compiled.doubtful.settle import Doubtful, settled
from chainbuild.ik.branches.compiled.forms import compiled_entries, quick_form
from chainbuild.ik.branches.compiled.quick import quick_branches
from chainbuild.ik.branches.core.branches import Branches
from chainbuild.robot import Robot
from tests.bench.arms.geometry import OTHER, Arm
from tests.bench.arms.peers import robot_of
from tests.bench.arms.truth import distance, isolation, truths
from tests.kit.chains import chain_from
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


def from_one(name: str, T: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return the solutions of a pose (4, 4) that joint values (6,) alone lead to."""
    form, x0 = quick_form(robot(name), None, None)
    assert form is not None
    values, places = np.zeros((1, 32, COLUMNS)), np.empty((64, 9))
    values[0, 0, :6] = q
    curves = np.empty((1024, 6)), np.empty(1024, np.int64), np.empty(64, np.int64), np.zeros(5, np.int64)
    count = compiled_entries().beside_pose(*form.axes, T, x0, values, np.array([1]), 1e-9, *curves, places, 0)
    return places[:count, :6]


def test_a_branch_beside_a_fold_is_found_from_the_other_one() -> None:
    """Both from either: the one is ahead of the direction in which the tool hardly moves, the other behind."""
    arm, found = arms()["ur5 calibrated"], 0
    for _, T in doubtful_poses("ur5 calibrated", 1e-3, 80):
        rows = np.radians(robot("ur5 calibrated").ik_all(T).axes)
        for n, row in enumerate(rows):
            apart = distance(rows, row)
            near = np.flatnonzero((apart > 1e-4) & (apart < 0.05))
            if (
                len(near) == 1
                and distance(rows, rows[near[0]])[n] == apart[near[0]]
                and isolation(arm, row[None])[0] < 2e-3
            ):
                found += 1
                assert distance(from_one("ur5 calibrated", T, row), rows[near[0]]).min() < 1e-6
    assert found >= 4


def test_zeros_and_couplings_of_axes_are_those_of_the_axes_found() -> None:
    arm, names = arms()["crx calibrated"], [f"A{n + 1}" for n in range(6)]
    axes = [Axis(name, "rotary", "deg", -180.0, 180.0, assumed=False, endless=True) for name in names]
    offsets, tool = np.array([10.0, -20.0, 30.0, 15.0, -25.0, 5.0]), []
    for name, axis, shift_m, offset in zip(names, arm.axes, arm.offsets(), offsets, strict=False):
        drive = {name: 1.0} | ({"A2": -1.0} if name == "A3" else {})
        tool += [Fixed(shifted(shift_m)), Move(name, "revolute", tuple(axis.tolist()), drive, float(offset))]
    last = shifted(arm.offsets()[6])
    last[:3, :3] = arm.M[:3, :3]
    coupled = Robot(chain_from(axes, [*tool, Mark("flange"), Fixed(last)]))
    for _, T in doubtful_poses("crx calibrated", 1e-3, 60)[:4]:
        wanted = np.radians(robot("crx calibrated").ik_all(T).axes)
        joints = coupled.ik_all(T).axes + offsets
        joints[:, 2] -= joints[:, 1] - offsets[1]
        assert len(joints) == len(wanted)
        assert all(distance(np.radians(joints), row).min() < 1e-6 for row in wanted)


def shifted(shift_m: np.ndarray) -> np.ndarray:
    T = np.eye(4)
    T[:3, 3] = shift_m * 1e3
    return T


def test_curves_of_general_arms_tell_their_direction() -> None:
    """A step along the direction leaves the tool in place to the second order."""
    curves = 0
    for name in ("jaco", "crx", "gofa"):
        arm = arms()[name]
        for q in drawn(name, 0.0, 12):
            T = arm.pose(q)
            for row in robot(name).ik_all(T):
                places = np.radians(row.axes)
                if isolation(arm, places[None])[0] > 1e-7:
                    assert not len(row.free_directions)
                for direction in row.free_directions:
                    curves += 1
                    assert np.abs(arm.pose(places + 1e-4 * direction) - T).max() < 1e-7
    assert curves >= 3


def folded() -> tuple[np.ndarray, np.ndarray]:
    """Return joint values of the crx with axis 4 on axis 1, and how these turn against one another: the tool stays."""
    right = math.pi / 2.0
    return np.array([0.4, -right, -right, -1.1, -right, -right]), np.array([1.0, 0.0, 0.0, -1.0, 0.0, 0.0])


def test_a_curve_is_one_branch_the_place_nearest_to_the_start() -> None:
    arm, (q, along) = arms()["crx"], folded()
    T = arm.pose(q)
    for turn in (-2.0, 0.3, 1.7):
        place = q + turn * along
        assert np.abs(arm.pose(place) - T).max() < 1e-12
        found = robot("crx").ik_all(T, start=np.degrees(place))
        assert isinstance(quick_branches(robot("crx"), T, np.degrees(place), None), Branches)
        assert np.abs(np.radians(found[0].axes) - place).max() < 1e-6
        curved = [row for row in found if len(row.free_directions)]
        assert len(curved) == 1
        assert abs(curved[0].free_directions[0] @ along) == pytest.approx(math.sqrt(2.0), abs=1e-6)
        assert curved[0].free_directions[0][0] > 0.0
    # From anywhere the nearest place is the one across from the start.
    aside = q + 0.2 * np.abs(along)
    found = [row for row in robot("crx").ik_all(T, start=np.degrees(aside)) if len(row.free_directions)]
    assert np.abs(np.radians(found[0].axes) - q).max() < 1e-6


def within(arm: Arm, lower: float, upper: float) -> Robot:
    """Return an arm whose axis 1 has limits."""
    chain = robot_of(arm).chain
    first = replace(chain.axes[0], lower=lower, upper=upper, endless=False)
    return Robot(replace(chain, axes=(first, *chain.axes[1:])))


@pytest.mark.parametrize("width", [12.0, 3.0])
def test_a_curve_is_found_wherever_limits_leave_a_piece_of_it(width: float) -> None:
    """Steps along a curve are longer than such a piece; the last digits of the pose decide where they end."""
    arm, (q, along) = arms()["crx"], folded()
    rng = np.random.default_rng(8)
    for lower in range(-180, 180, 40):
        narrow = within(arm, lower, lower + width)
        T, start = arm.pose(q), np.degrees(q)
        T[:3] += 1e-15 * rng.normal(size=(3, 4))
        start[0] = lower + 1.0
        curved = [np.radians(row.axes) for row in narrow.ik_all(T, start=start) if len(row.free_directions)]
        # Beside it there may be what nearly is another one: it keeps the pose to 1e-9 m.
        off = [math.remainder(x[3] - q[3] - along[3] * (x[0] - q[0]), math.tau) for x in curved]
        assert min(map(abs, off), default=math.inf) < 1e-6, lower


@pytest.mark.parametrize("common", [0.1, 0.5, 3.0])
def test_a_curve_is_found_where_two_ranges_have_a_corner_in_common(common: float) -> None:
    """Axes 1 and 4 turn alike along the curve; their ranges overlap by tenths of a degree of it, next to the pose's."""
    arm, (q, along) = arms()["crx"], folded()
    first, fourth = np.degrees(q[[0, 3]])
    ways = np.sign(along[[0, 3]])
    chain = robot_of(arm).chain
    axes = list(chain.axes)
    for n, middle, way in ((0, first, ways[0]), (3, fourth, -ways[1])):
        ends = sorted((middle - 5.0 * way, middle + common * way))
        axes[n] = replace(axes[n], lower=ends[0], upper=ends[1], endless=False)
    narrow = Robot(replace(chain, axes=tuple(axes)))
    T = arm.pose(q)
    for start in (None, np.degrees(q), np.zeros(6)):
        found = narrow.ik_all(T, start=start)
        assert any(len(branch.free_directions) for branch in found), start


@pytest.mark.parametrize(("lower", "upper"), [(60.0, 90.0), (-95.0, -70.0), (150.0, 170.0), (-170.0, -160.0)])
def test_of_a_curve_the_place_inside_the_limits_that_is_nearest_counts(lower: float, upper: float) -> None:
    """Of axis 1 a piece is left, whose end next to the start is nearest; the start itself is outside."""
    arm, (q, along) = arms()["crx"], folded()
    T, start = arm.pose(q), np.degrees(q)
    narrow = within(arm, lower, upper)
    start[0] = lower + 2.0
    found = narrow.ik_all(T, start=start)
    assert isinstance(quick_branches(narrow, T, start, None), Branches)
    curved = [row for row in found if len(row.free_directions)]
    assert len(curved) == 1
    first, fourth = np.radians(curved[0].axes[[0, 3]])
    assert lower <= curved[0].axes[0] <= upper
    assert math.remainder(fourth - q[3] - along[3] * (first - q[0]), math.tau) == pytest.approx(0.0, abs=1e-6)
    assert np.abs(narrow.fk(curved[0].axes).homogeneous - T).max() < 1e-9
    # No place of the curve inside the limits is nearer to the start: a thousand of them, whole turns aside.
    places = np.linspace(math.radians(lower), math.radians(upper), 1001)
    turned = q[3] + along[3] * (places - q[0])
    apart = np.hypot(places - math.radians(start[0]), np.remainder(turned - q[3] + math.pi, math.tau) - math.pi)
    ours = math.hypot(first - math.radians(start[0]), math.remainder(fourth - q[3], math.tau))
    assert ours < apart.min() + 2e-3


def test_many_poses_have_the_branches_of_each() -> None:
    poses = [T for _, T in doubtful_poses("crx", 1e-3, 40)][:6]
    assert len(poses) == 6
    together = robot("crx").ik_all_batch(np.array(poses))
    for T, rows in zip(poses, together, strict=True):
        alone = robot("crx").ik_all(T).axes
        known = rows[np.isfinite(rows).all(axis=1)]
        assert len(known) == len(alone)
        assert max(distance(np.radians(known), np.radians(row)).min() for row in alone) < 1e-9


def test_solutions_on_a_curve_tell_their_direction() -> None:
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
    _, T = doubtful_poses(name, 1e-8, 40)[0]
    form, x0 = quick_form(robot(name), None, None)
    assert form is not None
    known = settled(form, T, x0, *written(name, T))
    assert not isinstance(known, Doubtful)
    branches = np.radians(known[2][0, : known[0]])
    nowhere = compiled_entries().FORMS | {"general": lambda *room: room[-1].fill(UNSURE)}
    monkeypatch.setattr(compiled_entries(), "FORMS", nowhere)
    found = settled(form, T, x0, np.empty((ROWS, COLUMNS)), UNSURE)
    assert isinstance(found, Doubtful)
    assert not len(found.places)
    assert len(found.near) == 1
    assert all(distance(branches, place).min() < 1e-5 for place in found.near)


def test_one_pair_is_enough_at_the_end_of_the_reach(monkeypatch: pytest.MonkeyPatch) -> None:
    """On one side the form finds all branches, on the other it is sure of none."""
    entries, looks = compiled_entries(), []
    real = entries.beside_pose
    monkeypatch.setattr(entries, "beside_pose", lambda *room: looks.append(room[5].tolist()) or real(*room))
    seen = 0
    for q, T in doubtful_poses("crx", 0.0, 200):
        looks.clear()
        found = np.radians(robot("crx").ik_all(T).axes)
        if len(looks) == 2 and 0 in (looks[0][1], looks[1][0]):
            seen += 1
            assert distance(found, q).min() < 1e-4
    assert seen >= 5


def written(name: str, T: np.ndarray) -> tuple[np.ndarray, int]:
    """Return what the form writes for a pose."""
    form, x0 = quick_form(robot(name), None, None)
    assert form is not None
    values, counts = np.empty((1, ROWS, COLUMNS)), np.empty(1, np.int64)
    form.write_values(T[None], x0, values, counts)
    return values[0], int(counts[0])


def test_a_pose_out_of_reach_has_no_branches() -> None:
    far = np.eye(4)
    far[:3, 3] = 30.0
    found = quick_branches(robot("jaco"), far, None, None)
    assert isinstance(found, Doubtful)
    assert len(found.places) == 0
    assert len(robot("jaco").ik_all(far)) == 0
