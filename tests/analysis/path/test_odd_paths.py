"""Paths that are odd: empty, still, interrupted, huge, over the border of a chunk; and what is refused."""

from __future__ import annotations

import pickle
import tracemalloc
import warnings
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import chainbuild
from chainbuild.errors import ChainbuildError
from chainbuild.machines import shipped
from chainbuild.robot import Robot

MODES = ("ptp", "cp", "rows")
CLEAR = np.array([0.0, -60.0, 80.0, 10.0, 40.0, 20.0])
FAR = {"arm_nn", "arm_rr", "arm_nr5"}  # sampled: slow, and no other code than the palletiser's


@pytest.fixture(scope="module")
def kuka() -> Robot:
    return Robot.load("kr6r900")


def told(report: chainbuild.PathReport) -> list[tuple[object, ...]]:
    return [
        (s.kind, s.begin.label, s.end.label, s.proven, s.throughout, tuple(m.place.label for m in s.minima))
        for s in report.stretches
    ]


@pytest.mark.parametrize("between", MODES)
def test_few_rows(kuka: Robot, between: chainbuild.Between) -> None:
    none = chainbuild.path_report(kuka, np.empty((0, 6)), between=between)
    assert (none.rows, none.length_mm, none.stretches, len(none.smallest)) == (0, 0.0, (), 0)
    one = chainbuild.path_report(kuka, CLEAR, between=between)
    assert (one.rows, one.length_mm, one.stretches, one.violations) == (1, 0.0, (), ())
    beyond = CLEAR.copy()
    beyond[4] = 0.0
    beyond[0] = 171.0
    alone = chainbuild.path_report(kuka, [beyond], between=between)
    assert [s.kind for s in alone.stretches] == ["wrist"] and [v.name for v in alone.violations] == ["A1"]
    still = chainbuild.path_report(kuka, [beyond] * 4, between=between)
    assert still.length_mm == pytest.approx(0.0, abs=1e-9)
    assert {s.kind for s in still.stretches} == {"wrist"} and {v.name for v in still.violations} == {"A1"}
    if between != "rows":
        (stretch,) = still.stretches
        assert (stretch.begin.label, stretch.end.label, stretch.throughout) == ("1", "4", True)


@pytest.mark.parametrize("between", ["ptp", "cp"])
def test_a_path_that_stays_in_the_singularity(kuka: Robot, between: chainbuild.Between) -> None:
    rows = np.repeat(CLEAR[None], 5, axis=0)
    rows[:, 0] = np.linspace(0.0, 40.0, 5)
    rows[:, 3:] = 0.0
    if between == "cp":  # along the arm: the wrist stays stretched
        rows[:, 0] = 0.0
    report = chainbuild.path_report(kuka, rows, between=between)
    wrist = [s for s in report.stretches if s.kind == "wrist"]
    assert [(s.begin.label, s.end.label, s.throughout) for s in wrist] == [("1", "5", True)]
    assert wrist[0].minima[0].singular


@pytest.mark.parametrize("between", MODES)
def test_gaps_part_a_path(kuka: Robot, between: chainbuild.Between) -> None:
    gap = np.full(6, np.nan)
    low = CLEAR.copy()
    low[4] = 0.0
    rows = np.array([gap, gap, low, CLEAR, gap, CLEAR, low, gap, low, gap, gap])
    report = chainbuild.path_report(kuka, rows, between=between)
    assert report.gaps == (0, 1, 4, 7, 9, 10) and report.rows == 11
    assert (np.isnan(report.smallest) == np.isin(np.arange(11), report.gaps)).all()
    zeros = [m.place.label for s in report.stretches for m in s.minima if m.singular]
    assert zeros == ["3", "7", "9"]
    alone = report.stretches[-1]
    assert (alone.begin.label, alone.end.label) == ("9", "9")
    assert alone.begin.path_mm == pytest.approx(report.length_mm)
    assert chainbuild.path_report(kuka, np.array([gap, gap]), between=between).gaps == (0, 1)


def test_huge_moves(kuka: Robot) -> None:
    rows = np.array([CLEAR, CLEAR])
    rows[0, 4], rows[1, 4] = -2700.0, 2700.0
    report = chainbuild.path_report(kuka, rows)
    zeros = [m.place.share * 5400.0 - 2700.0 for s in report.stretches for m in s.minima if m.singular]
    assert np.abs(np.array(zeros) - np.arange(-2700.0, 2701.0, 180.0)).max() < 1e-5


@pytest.mark.parametrize("between", ["ptp", "cp"])
def test_turns_of_half_a_revolution(kuka: Robot, between: chainbuild.Between) -> None:
    rows = np.array([CLEAR, CLEAR, CLEAR])
    rows[1, 5] += 180.0
    rows[2, 5] += 360.0
    report = chainbuild.path_report(kuka, rows, between=between)
    assert not report.stretches and report.proven
    assert report.length_mm < (1e-6 if between == "cp" else 100.0)


@pytest.mark.parametrize("name", ["irb2600_track", "irb2600_table", "irb2600_flange"])
@pytest.mark.parametrize("between", ["ptp", "cp"])
def test_held_axes_that_move_are_told(name: str, between: chainbuild.Between) -> None:
    robot = Robot.load(name)
    rows = np.zeros((3, len(robot.axes)))
    arm = [n for n, axis in enumerate(robot.axes) if not axis.held]
    rows[:, arm] = [0.0, -10.0, 10.0, 10.0, 40.0, 20.0]
    rows[1, arm[0]], rows[2, arm[0]] = 2.0, 4.0
    still = chainbuild.path_report(robot, rows, between=between)
    rows[2, [n for n, axis in enumerate(robot.axes) if axis.held]] = 5.0
    moved = chainbuild.path_report(robot, rows, between=between)
    assert still.proven and moved.proven == (between == "ptp")
    assert moved.stretches == () and bool(moved.remarks) == (between == "cp")


def random_rows(robot: Robot, count: int) -> np.ndarray:
    lower = np.array([max(axis.lower, -400.0) for axis in robot.axes])
    upper = np.array([min(axis.upper, 400.0) for axis in robot.axes])
    lower, upper = np.minimum(lower, upper), np.maximum(lower, upper)
    rows = np.random.default_rng(3).uniform(lower, upper, (count, len(lower)))
    rows[:, [axis.held for axis in robot.axes]] = 0.0
    return rows


def check_machine(name: str, count: int) -> None:
    robot = Robot.load(name)
    rows = random_rows(robot, 2 * count)
    rows[1::2] = rows[::2] + 0.1 * (rows[1::2] - rows[::2])
    rows = np.insert(rows, range(2, 2 * count, 2), np.nan, axis=0)
    for between in MODES:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            options = chainbuild.PathOptions(feed_mm_min=6000.0)
            report = chainbuild.path_report(robot, rows, between=between, options=options)
        assert report.rows == 3 * count - 1 and len(report.smallest) == report.rows
        assert np.isfinite(report.length_mm) and report.seconds == pytest.approx(report.length_mm / 100.0)
        for stretch in report.stretches:
            assert 0.0 <= stretch.length_mm <= report.length_mm and stretch.minima
            assert all(np.isfinite(m.value) and m.sentence for m in stretch.minima)
        if between != "rows" and report.length_mm > 0.0:
            assert all(np.isfinite(s.speed.needed) and s.speed.needed >= 0.0 for s in report.speeds)
        assert told(pickle.loads(pickle.dumps(report))) == told(report)


@pytest.mark.parametrize("name", [name for name in shipped() if name not in FAR])
def test_every_machine(name: str) -> None:
    check_machine(name, 2)


@pytest.mark.slow
@pytest.mark.parametrize("name", shipped())
def test_every_machine_with_many_rows(name: str) -> None:
    check_machine(name, 12)


@pytest.mark.parametrize("between", ["ptp", "cp"])
def test_a_stretch_over_the_border_of_a_chunk_is_one(kuka: Robot, between: chainbuild.Between) -> None:
    """The same path begun at different rows: what is found does not depend on where chunks end."""
    rows = np.repeat(CLEAR[None], 1060, axis=0)
    rows[:, 4] = np.linspace(52.0, -1.8, 1060)  # 0 at row 1024.5
    if between == "cp":
        rows[:, 4] = np.abs(rows[:, 4]) + 0.01
    rows[:, 0] = np.linspace(0.0, 5.0, 1060)
    report = chainbuild.path_report(kuka, rows, between=between)
    shifted = chainbuild.path_report(kuka, rows[500:], between=between)
    (one,) = report.stretches
    (other,) = shifted.stretches
    assert one.begin.row < 1023 and one.end.row > 1024
    assert one.begin.row == other.begin.row + 500 and one.begin.share == pytest.approx(other.begin.share, abs=1e-8)
    assert one.end.label == "1060" and other.end.label == "560"
    assert len(one.minima) == len(other.minima)
    assert one.length_mm == pytest.approx(other.length_mm, rel=1e-9)


def test_a_violation_over_the_border_of_a_chunk_is_one(kuka: Robot) -> None:
    rows = np.repeat(CLEAR[None], 2060, axis=0)
    rows[:, 0] = np.linspace(0.0, 190.0, 2060)
    (one,) = chainbuild.path_report(kuka, rows).violations
    assert one.begin.row + one.begin.share == pytest.approx(170.0 / 190.0 * 2059.0, abs=1e-6)
    assert one.end.label == one.worst.label == "2060" and one.excess == pytest.approx(20.0)


def test_iterables_and_threads_give_the_same(kuka: Robot) -> None:
    rows = random_rows(kuka, 12)
    plain = chainbuild.path_report(kuka, rows)
    assert told(chainbuild.path_report(kuka, (row for row in rows))) == told(plain) and plain.stretches
    assert told(chainbuild.path_report(kuka, rows.tolist())) == told(plain)
    fresh = Robot.load("kr6r900")
    with ThreadPoolExecutor(4) as pool:
        for found in pool.map(lambda _: chainbuild.path_report(fresh, rows), range(6)):
            assert told(found) == told(plain)


@pytest.mark.parametrize(
    "options",
    [
        {"near": 0.0}, {"near": 1.0}, {"near": np.nan}, {"smallest": -1.0}, {"smallest": np.inf},
        {"feed_mm_min": 0.0}, {"feed_mm_min": np.inf}, {"tool_speed_mm": -1.0}, {"tool_speed_mm": np.nan},
    ],
)  # fmt: skip
def test_wrong_options_are_refused(kuka: Robot, options: dict[str, float]) -> None:
    with pytest.raises(ChainbuildError, match="wrong"):
        chainbuild.path_report(kuka, [CLEAR], options=chainbuild.PathOptions(**options))


def test_wrong_rows_are_refused(kuka: Robot) -> None:
    partly = CLEAR.copy()
    partly[2] = np.nan
    for rows in ([CLEAR[:5]], [CLEAR, CLEAR[:5]], [partly], [CLEAR + np.inf], iter([CLEAR, CLEAR[:5]])):
        with pytest.raises(ChainbuildError, match="finite axis values"):
            chainbuild.path_report(kuka, rows)
    with pytest.raises(ChainbuildError, match="unknown motion"):
        chainbuild.path_report(kuka, [CLEAR], between="line")  # type: ignore[arg-type]


@pytest.mark.slow
@pytest.mark.parametrize("between", ["ptp", "cp"])
def test_memory_does_not_grow_with_the_path(kuka: Robot, between: chainbuild.Between) -> None:
    def peak(count: int) -> int:
        rows = (CLEAR + [20.0 * np.sin(n / 300.0), 0.0, 0.0, 0.0, 5.0 * np.sin(n / 170.0), 0.0] for n in range(count))
        tracemalloc.start()
        report = chainbuild.path_report(kuka, rows, between=between)
        found = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert report.rows == count
        return found

    peak(3_000)
    assert peak(100_000) < peak(5_000) + 20 * 100_000  # the smallest singular value of each row is kept
