"""Singularities along lines of the tip, the branch kept: aimed lines are found, clear ones are clear."""

from __future__ import annotations

import numpy as np
import pytest

import chainbuild
from chainbuild.analysis.path.motion import motion_of
from chainbuild.analysis.singularity.names import NEAR_FACTOR
from chainbuild.robot import Robot
from tests.kit.aimed_lines import KINDS, lines_of, pose_between

ARMS = ("kr6r900", "tx2_60", "irb2600")


def check_aimed(name: str, kind: str, count: int, rows: int, seed: int) -> None:
    lines, rng = lines_of(name), np.random.default_rng(seed)
    for n in range(count):
        path, share, first, last = lines.aimed(kind, rng, rows)
        report = chainbuild.path_report(lines.robot, path, between="cp")
        assert report.proven, n
        zeros = [m for s in report.stretches for m in s.minima if m.singular and s.kind == kind]
        assert len(zeros) == 1, (n, len(zeros))
        (zero,) = zeros
        off = abs((zero.place.row + zero.place.share) / (rows - 1) - share)
        # Where W touches the cylinder of a sideways offset h the factor is a root: the 1e-9 m that Newton's method
        # leaves are √(2·h·1e-9 m)/L, 6e-6 for h = 20 mm, and a line on which it hardly changes has no sharper place.
        left = abs(lines.functions(np.array([zero.place.axes]))[0, KINDS.index(kind)])
        assert off < 1e-6 or (kind == "shoulder" and left < 6e-6), (n, off, left)
        assert not any(m.singular for s in report.stretches for m in s.minima if s.kind != kind), n
        for stretch in report.stretches:
            for place in (stretch.begin, stretch.end, *(m.place for m in stretch.minima)):
                check_place(lines.robot, place, first, last, rows)
                signs = np.sign(lines.functions(np.array([path[0], place.axes])))
                others = [k for k, one in enumerate(KINDS) if one != kind]
                assert (signs[0] == signs[1])[others].all(), (n, "another branch")


def check_place(robot: Robot, place: chainbuild.PathPlace, first: np.ndarray, last: np.ndarray, rows: int) -> None:
    """The axes of a place have the pose that the line has there."""
    T = pose_between(first, last, (place.row + place.share) / (rows - 1))
    assert np.isfinite(place.axes).all()
    assert np.abs(robot.fk(place.axes).homogeneous - T).max() < 2e-6
    length = float(np.linalg.norm(T[:3, 3] - first[:3, 3]))
    assert place.path_mm == pytest.approx(length * 1000.0, abs=1e-6)


@pytest.mark.parametrize("rows", [2, 51])
@pytest.mark.parametrize("kind", ["wrist", "shoulder"])
@pytest.mark.parametrize("name", ARMS)
def test_lines_through_singularities_are_found(name: str, kind: str, rows: int) -> None:
    check_aimed(name, kind, 2 if rows == 2 else 1, rows, 1)


def test_between_two_singularities_the_branch_of_the_rows_is_found() -> None:
    """The wrist point touches the cylinder about axis 1 that its sideways offset keeps it out of; the wrist follows."""
    lines = lines_of("tx2_60")
    path = np.array([
        [-76.26709798, -115.07362568, -111.49142135, -79.68469721, 33.82622792, -162.83395986],
        [126.3703801, -109.78561767, -104.127511, 50.15051213, 67.89364774, -59.83733103],
    ])  # fmt: skip
    first, last = lines.robot.fk_batch(path)
    t = np.array([0.275, 0.28, 0.3, 0.31, 0.32, 0.324, 0.325, 0.33])
    axes = motion_of(lines.robot, path, "cp").axes(np.zeros(len(t), dtype=np.intp), t)
    expected = np.array([pose_between(first, last, float(x)) for x in t])
    assert np.abs(lines.robot.fk_batch(axes) - expected).max() < 2e-6
    assert (np.sign(lines.functions(axes)) == np.sign(lines.functions(path[:1]))).all()


@pytest.mark.slow
@pytest.mark.parametrize("rows", [2, 51])
@pytest.mark.parametrize("kind", ["wrist", "shoulder"])
@pytest.mark.parametrize("name", ARMS)
def test_many_lines_through_singularities_are_found(name: str, kind: str, rows: int) -> None:
    check_aimed(name, kind, 300, rows, 2)


def check_clear(name: str, count: int, samples: int, seed: int) -> None:
    lines, rng = lines_of(name), np.random.default_rng(seed)
    clear = 0
    while clear < count:
        rows, values = lines.random(rng, samples)
        least = np.abs(values).min(axis=0)
        if not ((least > NEAR_FACTOR) & (least < 1.05 * NEAR_FACTOR)).any():
            report = chainbuild.path_report(lines.robot, rows, between="cp")
            kinds = {s.kind for s in report.stretches}
            assert report.proven and not report.leaves
            low = {kind for kind, value in zip(KINDS, least, strict=True) if value < NEAR_FACTOR}
            far = {kind for kind, value in zip(KINDS, least, strict=True) if value > 1.05 * NEAR_FACTOR}
            assert low <= kinds, (least, kinds)
            assert not kinds & far, (least, kinds)
            clear += not low


@pytest.mark.parametrize("name", ARMS)
def test_clear_lines_are_clear(name: str) -> None:
    check_clear(name, 1, 15, 5)


@pytest.mark.slow
@pytest.mark.parametrize("name", ARMS)
def test_many_clear_lines_are_clear(name: str) -> None:
    check_clear(name, 1000, 101, 6)


def vector_between(first: np.ndarray, last: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return the vectors (n, 3) at shares of the great circle between two."""
    angle = np.arctan2(np.linalg.norm(np.cross(first, last)), first @ last)
    return (np.sin((1.0 - t) * angle)[:, None] * first + np.sin(t * angle)[:, None] * last) / np.sin(angle)


def check_poles(name: str, count: int, aimed: bool, seed: int) -> None:
    """A tool vector as the target turns on the great circle, whatever both rotary axes do."""
    robot, rng = Robot.load(name), np.random.default_rng(seed)
    column, zero = robot.chain.tool_column, np.zeros(len(robot.axes))
    bending = 4 if name == "ca_head_kin9" else 3
    turning = 7 - bending
    pole = robot.fk(zero).homogeneous[:3, column]
    for _ in range(count):
        rows = rng.uniform(-300.0, 300.0, (2, 5))
        rows[:, bending] = rng.uniform(5.0, 60.0, 2)
        rows[:, turning] = rng.uniform(-170.0, 170.0, 2)
        if aimed:
            rows[1, turning] = rows[0, turning] + rng.choice([180.0, -180.0])
        vectors = robot.fk_batch(rows)[:, :3, column]
        t = np.linspace(0.0, 1.0, 20001)
        sine = np.linalg.norm(np.cross(vector_between(vectors[0], vectors[1], t), pole), axis=1)
        report = chainbuild.path_report(robot, rows, between="cp")
        assert report.proven and all(s.kind == "pole" and s.of_vector for s in report.stretches)
        if sine.min() > NEAR_FACTOR * 1.0001:
            assert not report.stretches
            continue
        if sine.min() > NEAR_FACTOR * 0.9999:
            continue
        (stretch,) = report.stretches
        (minimum,) = stretch.minima
        assert minimum.singular == aimed
        normal = np.cross(*vectors)
        inside = 0 < sine.argmin() < len(t) - 1  # else the great circle comes closest beyond the rows
        least = abs(normal @ pole) / np.linalg.norm(normal) if inside else sine.min()
        assert abs(minimum.value - least) < 1e-9
        assert abs(minimum.place.share - t[sine.argmin()]) < 1e-4
        if aimed:
            assert abs(minimum.place.share - rows[0, bending] / rows[:, bending].sum()) < 1e-6
        (low,) = np.nonzero(sine <= NEAR_FACTOR)
        assert abs(stretch.begin.share - t[low[0]]) < 1e-4 and abs(stretch.end.share - t[low[-1]]) < 1e-4


@pytest.mark.parametrize("aimed", [True, False])
@pytest.mark.parametrize("name", ["ca_head_kin9", "ac_table_kin58"])
def test_vectors_through_the_pole_are_found(name: str, aimed: bool) -> None:
    check_poles(name, 10, aimed, 3)


@pytest.mark.slow
@pytest.mark.parametrize("aimed", [True, False])
@pytest.mark.parametrize("name", ["ca_head_kin9", "ac_table_kin58"])
def test_many_vectors_through_the_pole_are_found(name: str, aimed: bool) -> None:
    check_poles(name, 300 if aimed else 3000, aimed, 4)


def check_leaves(name: str, count: int, seed: int) -> None:
    """Reorienting a stretched arm pushes its wrist point out: where it leaves the reach, by the triangle's sides."""
    lines, rng = lines_of(name), np.random.default_rng(seed)
    left = 0
    for _ in range(40 * count):
        axes, first, last = lines.bulging(rng)
        signs = np.sign(lines.functions(axes[None])[0])
        signs[1] = rng.choice([-1.0, 1.0])
        rows = lines.rows(first, last, np.array([0.0, 1.0]), signs, axes)
        if rows is None:
            continue
        t, beyond = np.linspace(0.0, 1.0, 200), lines.reach(axes)
        out = beyond(np.array([pose_between(first, last, float(x)) for x in t])) > 0.0
        report = chainbuild.path_report(lines.robot, rows, between="cp")
        if not out.any():
            assert not report.leaves
            continue
        n = int(out.argmax())
        low, high = t[n - 1], t[n]
        for _ in range(45):
            middle = (low + high) / 2.0
            is_out = beyond(pose_between(first, last, middle)[None])[0] > 0.0
            low, high = (low, middle) if is_out else (middle, high)
        assert len(report.leaves) == 1
        (place,) = report.leaves
        assert abs(place.share - low) < 1e-6
        left += 1
        if left == count:
            return
    raise AssertionError(f"only {left} lines leave the reach")


@pytest.mark.parametrize("name", ["kr6r900", "tx2_60"])
def test_where_a_line_leaves_the_reach(name: str) -> None:
    check_leaves(name, 1, 9)


@pytest.mark.slow
@pytest.mark.parametrize("name", ARMS)
def test_where_many_lines_leave_the_reach(name: str) -> None:
    check_leaves(name, 100, 10)
