"""Singularities between rows joined by straight axes, against a dense search over products of exponentials."""

from __future__ import annotations

import numpy as np
import pytest

import chainbuild
from chainbuild.analysis.singularity.names import NEAR_FACTOR
from chainbuild.robot import Robot
from tests.kit.aimed_lines import shoulder_size
from tests.kit.screw_paths import ArmOracle, Blocks, Function, Screws, dense, dense_zeros, pole_sine, touching

ARMS = ("kr6r900", "tx2_60", "irb2600")
POLES = ("ca_head_kin9", "ac_table_kin58")
KINDS = ("wrist", "elbow", "shoulder")
FEW, MANY = 15, 2000


def limits(robot: Robot) -> tuple[np.ndarray, np.ndarray]:
    lower = np.array([max(axis.lower, -360.0) for axis in robot.axes])
    return lower, np.array([min(axis.upper, 360.0) for axis in robot.axes])


def random_blocks(robot: Robot, count: int, seed: int) -> Blocks:
    lower, upper = limits(robot)
    rng = np.random.default_rng(seed)
    begins = rng.uniform(lower, upper, (count, len(lower)))
    ends = rng.uniform(lower, upper, (count, len(lower)))
    short = rng.uniform(size=count) < 0.5
    ends[short] = begins[short] + 0.15 * (ends[short] - begins[short])
    return Blocks(begins, ends)


def reported(robot: Robot, blocks: Blocks, kind: str) -> list[tuple[int, float]]:
    """Return block and share of the zeros of the report."""
    report = chainbuild.path_report(robot, blocks.rows())
    assert report.proven and not report.leaves
    found = []
    for stretch in report.stretches:
        assert stretch.proven and stretch.begin.row == stretch.end.row
        for minimum in stretch.minima if stretch.kind == kind else ():
            assert stretch.begin.share <= minimum.place.share <= stretch.end.share
            assert minimum.singular == (minimum.value == 0.0)
            if minimum.singular:
                found.append((minimum.place.row // 3, minimum.place.share))
    return sorted(found)


def check_zeros(robot: Robot, value: Function, kind: str, blocks: Blocks) -> None:
    wanted, found = dense_zeros(value, blocks), reported(robot, blocks, kind)
    assert wanted, "the blocks show nothing"
    assert [block for block, _ in found] == [block for block, _ in wanted]
    assert max(abs(a - b) for (_, a), (_, b) in zip(found, wanted, strict=True)) < 1e-6


def function_of(robot: Robot, kind: str) -> Function:
    oracle = ArmOracle(Screws.of(robot))
    return lambda axes: oracle.values(kind, axes)


@pytest.mark.parametrize("name", ARMS)
def test_screws_are_the_robot(name: str) -> None:
    robot = Robot.load(name)
    axes = random_blocks(robot, 20, 3).ends
    _, _, tip, tool = Screws.of(robot).lines(axes)
    T = robot.fk_batch(axes)
    assert np.abs(tip - T[:, :3, 3]).max() < 1e-13 and np.abs(tool - T[:, :3, :3]).max() < 1e-13


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ARMS)
def test_every_zero_of_an_arm_is_found(name: str, kind: str) -> None:
    robot = Robot.load(name)
    check_zeros(robot, function_of(robot, kind), kind, random_blocks(robot, FEW, 10))


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", ARMS)
def test_every_zero_of_an_arm_is_found_in_many_blocks(name: str, kind: str) -> None:
    robot = Robot.load(name)
    check_zeros(robot, function_of(robot, kind), kind, random_blocks(robot, MANY, 20))


@pytest.mark.parametrize("name", POLES)
def test_every_pole_is_found(name: str) -> None:
    robot = Robot.load(name)
    check_zeros(robot, pole_sine(robot), "pole", random_blocks(robot, FEW, 11))


@pytest.mark.slow
@pytest.mark.parametrize("name", POLES)
def test_every_pole_is_found_in_many_blocks(name: str) -> None:
    robot = Robot.load(name)
    check_zeros(robot, pole_sine(robot), "pole", random_blocks(robot, MANY, 21))


def check_clear(name: str, count: int, seed: int) -> None:
    """Blocks that a dense search finds far from all singularities, by a hair's breadth or more, have no stretch."""
    robot, clear = Robot.load(name), []
    oracle = ArmOracle(Screws.of(robot))
    size = shoulder_size(robot)
    while sum(len(block.begins) for block in clear) < count:
        blocks = random_blocks(robot, max(count // 2, 100), seed)
        blocks = Blocks(blocks.begins, blocks.begins + 0.2 * (blocks.ends - blocks.begins))
        seed += 1
        least = np.full(len(blocks.begins), np.inf)
        for kind in KINDS:
            found = np.abs(dense(lambda axes, kind=kind: oracle.values(kind, axes), blocks, 201)).min(axis=1)
            least = np.minimum(least, found / (size if kind == "shoulder" else 1.0))
        far = least > NEAR_FACTOR * 1.001
        clear.append(Blocks(blocks.begins[far], blocks.ends[far]))
        nearly = (least > NEAR_FACTOR * 0.9) & (least < NEAR_FACTOR * 0.999)
        close = Blocks(blocks.begins[nearly], blocks.ends[nearly])
        if len(close.begins):
            stretches = chainbuild.path_report(robot, close.rows()).stretches
            assert {one.begin.row // 3 for one in stretches} == set(range(len(close.begins)))
    begins = np.concatenate([block.begins for block in clear])[:count]
    ends = np.concatenate([block.ends for block in clear])[:count]
    report = chainbuild.path_report(robot, Blocks(begins, ends).rows())
    assert report.stretches == () and report.proven


def test_clear_blocks_are_clear() -> None:
    check_clear("tx2_60", 60, 50)


@pytest.mark.slow
@pytest.mark.parametrize("name", ARMS)
def test_many_clear_blocks_are_clear(name: str) -> None:
    check_clear(name, 10_000, 90)


def check_touches(name: str, count: int, seed: int) -> None:
    """An extremum of the shoulder's function in the middle of a block: touched, just missed, just crossed."""
    robot = Robot.load(name)
    value, size, rng = function_of(robot, "shoulder"), shoulder_size(robot), np.random.default_rng(seed)
    for depth in (0.0, 1e-10, -1e-10, 1e-8, -1e-8):
        blocks, places = touching(value, limits(robot), rng, count, depth * size)
        report = chainbuild.path_report(robot, blocks.rows())
        own = [s for s in report.stretches if s.kind == "shoulder"]
        for n in range(count):
            here = [m for s in own for m in s.minima if s.begin.row == 3 * n]
            minima = [m for m in here if abs(m.place.share - places[n]) < 0.02]
            assert minima, (depth, n)
            zeros = [m for m in minima if m.singular]
            if depth > 0.0:
                (one,) = minima
                assert not one.singular and abs(one.value - depth) < 1e-12
                assert abs(one.place.share - places[n]) < 1e-6
            elif depth < 0.0:
                low, high = sorted(m.place.share for m in zeros)
                assert low < places[n] < high, (depth, n)
            else:
                assert 1 <= len(zeros) <= 2
                assert max(abs(m.place.share - places[n]) for m in zeros) < 1e-6


@pytest.mark.parametrize("name", ARMS)
def test_touches_are_decided_right(name: str) -> None:
    check_touches(name, 1, 31)


@pytest.mark.slow
@pytest.mark.parametrize("name", ARMS)
def test_many_touches_are_decided_right(name: str) -> None:
    check_touches(name, 400, 32)


@pytest.mark.parametrize("name", ["kr6r900", "ca_head_kin9"])
def test_more_rows_on_the_way_change_nothing(name: str) -> None:
    robot, rng = Robot.load(name), np.random.default_rng(8)
    rows = random_blocks(robot, 5, 12).begins
    shares = [np.concatenate([[0.0], np.sort(rng.uniform(0.05, 0.95, 3))]) for _ in range(4)]
    parts = [rows[n] + s[:, None] * (rows[n + 1] - rows[n]) for n, s in enumerate(shares)]
    places = np.concatenate([*(n + s for n, s in enumerate(shares)), [4.0]])
    plain = chainbuild.path_report(robot, rows)
    split = chainbuild.path_report(robot, np.concatenate([*parts, rows[4:]]))

    def ends(report: chainbuild.PathReport, at: np.ndarray) -> list[tuple[str, float, float, int]]:
        def where(place: chainbuild.PathPlace) -> float:
            row = min(place.row, len(at) - 2)
            return float(at[row] + (place.share + place.row - row) * (at[row + 1] - at[row]))

        parts = report.stretches
        return sorted((s.kind, where(s.begin), where(s.end), sum(m.singular for m in s.minima)) for s in parts)

    before, after = ends(plain, np.arange(5.0)), ends(split, places)
    assert [(one[0], one[3]) for one in before] == [(one[0], one[3]) for one in after] and before
    assert np.abs(np.array([one[1:3] for one in before]) - [one[1:3] for one in after]).max() < 1e-8
    assert plain.length_mm == pytest.approx(split.length_mm, rel=1e-3)
