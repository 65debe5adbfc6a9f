"""Verdicts of a control on paths, against formulas of this file: nothing of the functions that vanish is used here.

kr6r900 and irb2600 by the dimensions of their data sheets; Jacobians are differences of poses.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

import chainbuild
from chainbuild.analysis.path.motion import motion_of
from chainbuild.analysis.vanishing.lows import Low
from chainbuild.analysis.verdicts import judging
from chainbuild.analysis.verdicts.controlmeasure import MEASURES, factor_of_measure, measure_of_factor
from chainbuild.analysis.verdicts.sampledzones import joined
from chainbuild.analysis.verdicts.thresholds import Thresholds, assess, thresholds_of
from chainbuild.analysis.verdicts.zones import zones
from chainbuild.errors import ChainbuildError

ON = "$MC_MM_NUM_SINGULARITY_BLOCKS=1"
# Column, upper arm, elbow to wrist point along and across the forearm, wrist point to flange [mm].
ARMS = {"kr6r900": (25.0, 455.0, 420.0, 35.0, 80.0), "irb2600": (150.0, 700.0, 795.0, 115.0, 85.0)}
HERE = {"kr6r900": (10.0, -80.0, 100.0, 20.0), "irb2600": (10.0, 20.0, 10.0, 20.0)}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("handled")


@pytest.fixture(scope="module")
def arm(folder) -> Callable[..., chainbuild.Robot]:
    """Return a maker of shipped machines with lines added to their file."""

    @cache
    def made(name: str, extra: str = ON, **choices: str) -> chainbuild.Robot:
        text = chainbuild.load(name).path.read_text("utf-8").replace("M17", f"{extra}\nM17")
        file = folder / f"{name}{abs(hash(extra))}.tea"
        file.write_text(text, "utf-8")
        return chainbuild.Robot(chainbuild.load(file).chain(conventions=choices))

    return made


def length(name: str) -> float:
    """The characteristic length [m]: all offsets from the first joint to the flange."""
    column, upper, fore, across, hand = ARMS[name]
    return (column + upper + math.hypot(fore, across) + hand) / 1000.0


def singular_values(robot: chainbuild.Robot, size: float, axes: np.ndarray) -> np.ndarray:
    """Singular values of the Jacobian, from differences of poses, lengths divided by `size`."""
    step = 1e-4
    T, J = robot.fk(axes), np.empty((6, 6))
    for n in range(6):
        moved = np.array(axes, dtype=float)
        moved[n] += step
        ahead = robot.fk(moved)
        moved[n] -= 2.0 * step
        behind = robot.fk(moved)
        J[:3, n] = (ahead.translation - behind.translation) / size
        S = (ahead.rotation - behind.rotation) @ T.rotation.T
        J[3:, n] = S[2, 1], S[0, 2], S[1, 0]
    return np.linalg.svd(J / (2.0 * math.radians(step)), compute_uv=False)


def by_hand(robot: chainbuild.Robot, name: str, measure: str, axes: np.ndarray) -> float:
    """A measure near A5 = 0, far from elbow and shoulder."""
    if measure == "one_minus_cosine":
        return 1.0 - abs(math.cos(math.radians(axes[4])))
    values = singular_values(robot, length(name), axes)
    product = float(np.prod(values))
    return {"smallest": float(values[-1]), "product": product, "determinant_squared": product**2}[measure]


def threshold_share(value: Callable[[float], float], limit: float, inside: float, outside: float) -> float:
    """The share between two places at which a value reaches a limit."""
    for _ in range(50):
        middle = (inside + outside) / 2.0
        inside, outside = (middle, outside) if value(middle) <= limit else (inside, middle)
    return inside


def wrist_block(name: str) -> np.ndarray:
    """A block through A5 = 0 at 0.4 of it, all axes moving."""
    begin = np.array([*HERE[name], -24.0, 30.0])
    return np.array([begin, begin + [5.0, 3.0, -4.0, 2.0, 60.0, -8.0]])


SPEC = {  # A5 [deg] at 2e-6 and at 1e-3 on kr6r900, from … to over its positions
    "one_minus_cosine": ((0.114, 0.115), (2.56, 2.57)),
    "smallest": ((0.0003, 0.0008), (0.16, 0.38)),
    "product": ((0.0009, 0.003), (0.4, 1.4)),
    "determinant_squared": ((0.6, 2.0), (14.0, 52.0)),
}


@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("name", ARMS)
def test_zones_of_the_wrist_by_hand(name: str, measure: str, arm) -> None:
    rows = wrist_block(name)
    for n, (extra, level) in enumerate(((ON, "singular"), (f"{ON}\n$SN_SINGULARITY_THRESHOLD=1e-3", "singular"))):
        robot = arm(name, extra, singularity_measure=measure)
        limit = (2e-6, 1e-3)[n]
        found = chainbuild.singularity_verdicts(robot, rows)
        assert (found.measure, found.threshold, found.handled) == (measure, limit, True)
        assert found.proven == (measure != "smallest")
        (block,) = found.blocks
        (part,) = block.parts
        assert (block.row, block.level) == (0, level)

        def value(t: float, robot: chainbuild.Robot = robot) -> float:
            return by_hand(robot, name, measure, rows[0] + t * (rows[1] - rows[0]))

        begin, end = (threshold_share(value, limit, 0.4, outer) for outer in (0.0, 1.0))
        # Differences of poses carry 1e-10 of a singular value; 2e-6 is a hundredth of a percent of that away.
        assert part.begin.share == pytest.approx(begin, abs=1e-4 * (end - begin) + 1e-12)
        assert part.end.share == pytest.approx(end, abs=1e-4 * (end - begin) + 1e-12)
        assert part.least.share == pytest.approx(0.4, abs=1e-9)
        if name == "kr6r900":
            low, high = SPEC[measure][n]
            assert 0.95 * low <= (part.end.axes[4] - part.begin.axes[4]) / 2.0 <= 1.05 * high


@pytest.mark.parametrize("measure", MEASURES)
def test_the_least_value_of_a_block_that_passes_aside(measure: str, arm) -> None:
    robot = arm("irb2600", f"{ON}\n$SN_MIN_DIST_TO_SINGULARITY=0.05", singularity_measure=measure)
    begin = np.array([*HERE["irb2600"], 1.0, 30.0])
    (block,) = chainbuild.singularity_verdicts(robot, [begin, begin + [0.0, 0.0, 0.0, 0.0, 30.0, 0.0]]).blocks
    assert block.level == "watched"
    assert block.parts[0].least.axes[4] == pytest.approx(1.0)
    assert block.value == pytest.approx(by_hand(robot, "irb2600", measure, begin), rel=1e-6)


def test_parts_of_several_kinds_are_put_together() -> None:
    wide, inner = Low(0.2, 0.8, (), 0.5, 0.3), Low(0.3, 0.4, (0.35,), 0.35, 0.0)
    touching, apart = Low(0.8, 0.85, (), 0.82, 0.1), Low(0.9, 1.0, (1.0,), 1.0, 0.0)
    first, last = joined([apart, inner, touching, wide])
    assert first == Low(0.2, 0.85, (0.35,), 0.35, 0.0)
    assert last == apart


def wrist_point(robot: chainbuild.Robot, name: str, axes: np.ndarray) -> np.ndarray:
    T = robot.fk(axes)
    return T.translation - ARMS[name][4] / 1000.0 * T.rotation[:, 2]


@pytest.mark.parametrize("name", ARMS)
def test_zones_of_the_shoulder_by_hand(name: str, arm) -> None:
    """The wrist point within √(m·(2 - m)) lengths of axis 1, which it passes while axis 2 alone leans back."""
    robot = arm(name)
    begin = np.array(
        {"kr6r900": (20.0, -150.0, 90.0, 30.0, 50.0, 0.0), "irb2600": (20.0, -60.0, 0.0, 30.0, 50.0, 0.0)}[name]
    )
    rows = np.array([begin, begin + [0.0, 60.0, 0.0, 0.0, 0.0, 0.0]])
    found = chainbuild.singularity_verdicts(robot, rows)
    (block,) = found.blocks
    (part,) = block.parts
    assert (found.proven, block.level) == (True, "singular")
    for place in (part.begin, part.end):
        distance = float(np.hypot(*wrist_point(robot, name, place.axes)[:2]))
        assert distance == pytest.approx(math.sqrt(2e-6 * (2.0 - 2e-6)) * length(name), rel=1e-6)
    assert float(np.hypot(*wrist_point(robot, name, part.least.axes)[:2])) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("name", ARMS)
def test_zones_of_the_elbow_by_hand(name: str, arm) -> None:
    """The stretched arm ± acos(1 - m) of A3; the wrist point is farthest from axis 2 there."""
    robot = arm(name)
    column, upper, fore, across, _ = ARMS[name]
    begin = np.array(
        {"kr6r900": (0.0, -40.0, -25.0, 20.0, 50.0, 0.0), "irb2600": (0.0, 40.0, -75.0, 20.0, 50.0, 0.0)}[name]
    )
    rows = np.array([begin, begin + [0.0, 0.0, 40.0 if name == "kr6r900" else -40.0, 0.0, 0.0, 0.0]])
    (block,) = chainbuild.singularity_verdicts(robot, rows).blocks
    (part,) = block.parts
    angle = math.degrees(math.acos(1.0 - 2e-6))
    assert abs(part.end.axes[2] - part.begin.axes[2]) == pytest.approx(2.0 * angle, rel=1e-6)
    height = {"kr6r900": 400.0, "irb2600": 445.0}[name]
    reached = wrist_point(robot, name, part.least.axes) - np.array([column, 0.0, height]) / 1000.0
    assert np.linalg.norm(reached) == pytest.approx((upper + math.hypot(fore, across)) / 1000.0, abs=1e-9)


def aimed(robot: chainbuild.Robot, name: str, off: float = 0.0) -> np.ndarray:
    """Two rows whose line passes A5 = `off` [deg] in its middle."""
    T = robot.fk([*HERE[name], off, 30.0])
    poses = []
    for sign in (-1.0, 1.0):
        pose = T.copy()
        turn = sign * np.array([0.1, 0.2, -0.1])
        angle = float(np.linalg.norm(turn))
        K = np.cross(np.eye(3), turn / angle).T
        pose.rotation = T.rotation @ (np.eye(3) + math.sin(angle) * K + (1.0 - math.cos(angle)) * K @ K)
        pose.translation = T.translation + sign * np.array([0.05, 0.02, 0.03])
        poses.append(pose)
    first = robot.ik(poses[0], start=[*HERE[name], 15.0, 30.0])
    last = robot.ik(poses[1], start=first.axes)
    assert first.success
    assert last.success
    return np.array([first.axes, last.axes])


@pytest.mark.parametrize(
    ("name", "measure"),
    [("kr6r900", "one_minus_cosine"), ("irb2600", "one_minus_cosine"), ("irb2600", "product"), ("kr6r900", "smallest")],
)
def test_lines_aimed_through_the_wrist(name: str, measure: str, arm) -> None:
    """The zone is a thousandth of the block or less; at both its ends the measure by hand is the threshold."""
    robot = arm(name, singularity_measure=measure)
    rows = aimed(robot, name)
    found = zones(motion_of(robot, rows, "cp"), measure, 2e-6)
    assert found.proven == (measure == "one_minus_cosine")
    (part,) = found.parts[0]
    assert part.begin < 0.5 < part.end
    axes = motion_of(robot, rows, "cp").axes(np.zeros(2, dtype=np.intp), np.array([part.begin, part.end]))
    for row in axes:
        assert by_hand(robot, name, measure, row) == pytest.approx(2e-6, rel=1e-3)


def test_a_line_that_passes_the_wrist_aside_is_watched(arm) -> None:
    robot = arm("kr6r900")
    rows = aimed(robot, "kr6r900", 1.0)
    found = chainbuild.singularity_verdicts(robot, rows, between="cp")
    (block,) = found.blocks
    assert (found.proven, block.level, block.alarm) == (True, "watched", None)
    assert block.value <= 1.0 - math.cos(math.radians(1.0))
    shift = robot.fk(rows[1]).translation - robot.fk(rows[0]).translation
    assert block.length_mm == pytest.approx(1000.0 * np.linalg.norm(shift), rel=1e-9)


@pytest.mark.parametrize(("measure", "limit"), [*zip(MEASURES, (1e-3, 3e-7, 5e-4, 0.02), strict=True)])
@pytest.mark.parametrize("name", ARMS)
def test_zones_of_random_blocks(name: str, measure: str, limit: float, arm) -> None:
    """Places looked at densely are in a zone where the measure is low there, and only there."""
    robot = arm(name)
    rows = np.random.default_rng(4).uniform(-70.0, 70.0, (26, 6)) + [0.0, -60.0, 60.0, 0.0, 0.0, 0.0]
    motion = motion_of(robot, rows, "ptp")
    found = zones(motion, measure, limit)
    assert found.parts
    size, shares = length(name), np.linspace(0.0, 1.0, 41)
    seen = {True: 0, False: 0}
    for block in range(25):
        parts = found.parts.get(block, [])
        for t in shares.tolist():
            axes = rows[block] + t * (rows[block + 1] - rows[block])
            value = dense(robot, name, measure, size, axes)
            if abs(value - limit) > 1e-6 * limit:
                inside = any(part.begin <= t <= part.end for part in parts)
                assert inside == (value < limit), (block, t, value)
                seen[inside] += 1
    assert min(seen.values()) > 3


def dense(robot: chainbuild.Robot, name: str, measure: str, size: float, axes: np.ndarray) -> float:
    """A measure anywhere: Pinocchio's Jacobian, and for one_minus_cosine lengths and angles of this arm."""
    if measure != "one_minus_cosine":
        J = robot.jacobian(axes)
        J[:3] /= size
        values = np.linalg.svd(J, compute_uv=False)
        product = float(abs(np.linalg.det(J)))
        return {"smallest": float(values[-1]), "product": product, "determinant_squared": product**2}[measure]
    _, _, fore, across, _ = ARMS[name]
    far = float(np.hypot(*wrist_point(robot, name, axes)[:2]))
    stretch = axes[2] if name == "kr6r900" else axes[2] + 90.0
    elbow = math.sin(math.radians(stretch) - math.atan2(across, fore))
    s = min(abs(math.sin(math.radians(axes[4]))), abs(elbow), far / size)
    return 1.0 - math.sqrt(1.0 - s * s)


def turning(name: str, a5: float, end_a5: float, way_mm: float, robot: chainbuild.Robot) -> np.ndarray:
    """Two rows between which axis 1 turns, so that the tip moves on a circle by `way_mm` where axis 5 stays."""
    begin = np.array([0.0, *HERE[name][1:3], 0.0, a5, 0.0])
    radius = float(np.hypot(*robot.fk(begin).translation[:2])) * 1000.0
    return np.array([begin, [math.degrees(way_mm / radius), *begin[1:4], end_a5, 0.0]])


@pytest.mark.parametrize("choice", ["whole_block", "stretch"])
def test_30_mm_are_too_long(choice: str, arm) -> None:
    robot = arm("kr6r900", singular_block=choice)
    for way, alarm in ((29.99, None), (30.0, 75327), (30.01, 75327)):
        (block,) = chainbuild.singularity_verdicts(robot, turning("kr6r900", 0.0, 0.0, way, robot)).blocks
        assert (block.level, block.alarm) == ("singular", alarm)
        assert block.length_mm == pytest.approx(way, abs=1e-9)


def test_a_long_singular_part_is_no_singular_block(arm) -> None:
    """A5 from 0.05° to 1°: singular up to 0.1146°, that is 6.8 % of 940 mm."""
    for choice, alarm in (("whole_block", None), ("stretch", 75327)):
        robot = arm("kr6r900", singular_block=choice)
        found = chainbuild.singularity_verdicts(robot, turning("kr6r900", 0.05, 1.0, 940.0, robot))
        (block,) = found.blocks
        assert (block.level, block.alarm, found.singular_block) == ("singular", alarm, choice)
        assert found.alarms == ((alarm,) if alarm else ())
        (part,) = block.parts
        assert part.length_mm == pytest.approx(940.0 * (math.degrees(math.acos(1.0 - 2e-6)) - 0.05) / 0.95, rel=1e-3)
        assert (part.begin.label, part.end.row) == ("1", 0)
        back = chainbuild.singularity_verdicts(robot, turning("kr6r900", 0.05, 1.0, 940.0, robot)[::-1])
        assert back.alarms == found.alarms
        short = chainbuild.singularity_verdicts(robot, turning("kr6r900", 0.05, 1.0, 400.0, robot))
        assert short.alarms == ()  # 27 mm


def test_the_alarm_belongs_to_blocks_whatever_stands_beside_them(arm) -> None:
    """A watched row at each end does not take the alarm away, nor do rows far from it hide a crossing."""
    robot = arm("kr6r900")
    path = np.array(
        [[a1, -80.0, 100.0, 0.0, a5, 0.0] for a1, a5 in ((0, 20), (1, 1), (2, 0), (8, 0), (9, 1), (10, 20))]
    )
    found = chainbuild.singularity_verdicts(robot, path)
    assert [(b.row, b.level, b.alarm) for b in found.blocks] == [
        (0, "watched", None),
        (1, "singular", None),
        (2, "singular", 75327),
        (3, "singular", None),
        (4, "watched", None),
    ]
    crossing = path[:2].copy()
    crossing[:, 4] = -8.0, 8.0
    (block,) = chainbuild.singularity_verdicts(robot, crossing).blocks
    assert (block.level, block.parts[0].least.share) == ("singular", pytest.approx(0.5))


@pytest.mark.parametrize(
    ("name", "extra", "says"),
    [
        ("kr6r900", "", "is not in the file"),
        ("kr6r900", "$MC_MM_NUM_SINGULARITY_BLOCKS=0", "MD28592 $MC_MM_NUM_SINGULARITY_BLOCKS is 0"),
        ("scara_cc", ON, "it needs 6 robot axes, here are 4"),
    ],
)
def test_without_the_function_there_is_no_75327(name: str, extra: str, says: str, arm) -> None:
    robot = arm(name, extra)
    if name == "kr6r900":
        rows = [[0, -80, 100, 0, 0, 0], [8, -80, 100, 0, 0, 0], [9, -80, 100, 0, 1, 0], [10, -80, 100, 0, 2, 0]]
    else:
        rows = elbow_rows(robot)
    found = chainbuild.singularity_verdicts(robot, rows)
    assert found.handled is False
    assert says in found.sentence
    assert "10911" in found.sentence
    assert found.alarms == (10911,)
    assert {block.level for block in found.blocks} == {"singular"}
    if name == "kr6r900":
        assert [block.row for block in found.blocks] == [0, 1]


def elbow_rows(robot: chainbuild.Robot) -> np.ndarray:
    """A stretched SCARA that turns by far more than 30 mm: the axis that stretches it is where the pole is."""
    middle = np.array([(axis.lower + axis.upper) / 2.0 for axis in robot.axes])
    shares = np.linspace(-170.0, 170.0, 3401)
    volumes = []
    for value in shares.tolist():
        axes = middle.copy()
        axes[2] = value
        volumes.append(np.linalg.svd(robot.jacobian(axes), compute_uv=False)[-1])
    rows = np.array([middle, middle])
    rows[:, 2] = shares[int(np.argmin(volumes))]
    rows[1, 1] += 60.0
    rows[0, 2] -= 1.0
    rows[1, 2] += 1.0
    return rows


def test_axes_too_fast_raise_10910_where_there_is_no_function(arm) -> None:
    robot = chainbuild.Robot.load("kr6r900")  # with the speeds of its overlay
    rows = aimed(robot, "kr6r900", 0.5)
    slow = chainbuild.singularity_verdicts(robot, rows, between="cp", feed_mm_min=1.0)
    assert slow.alarms == ()
    fast = chainbuild.singularity_verdicts(robot, rows, between="cp", feed_mm_min=6000.0)
    assert fast.alarms == (10910,)
    assert "A4" in {one.speed.name for one in fast.excessive}
    assert all(one.speed.needed > one.speed.limit for one in fast.excessive)
    assert chainbuild.singularity_verdicts(arm("kr6r900"), rows, between="cp", feed_mm_min=6000.0).excessive == ()
    with pytest.raises(ChainbuildError, match="feed"):
        chainbuild.singularity_verdicts(robot, rows, feed_mm_min=-1.0)


def test_setting_data_of_the_file_count(arm) -> None:
    assert thresholds_of(chainbuild.load("kr6r900_2").chain()) is None
    limits = thresholds_of(chainbuild.load("kr6r900").chain())
    assert limits is not None
    assert (limits.threshold, limits.clearance, limits.iter_limit_deg, limits.given) == (2e-6, 1e-3, 3.0, ())
    own = "$SN_SINGULARITY_THRESHOLD=1e-5\n$SN_MIN_DIST_TO_SINGULARITY=1e-2"
    rows = wrist_block("kr6r900")
    on, off = (chainbuild.singularity_verdicts(arm("kr6r900", f"{extra}\n{own}"), rows) for extra in (ON, ""))
    assert (on.threshold, on.clearance) == (1e-5, 1e-2)
    assert "recommended" not in on.sentence
    assert "SD41671 0.01 has no effect" in off.sentence
    (part,) = on.blocks[0].parts
    assert part.end.axes[4] == pytest.approx(math.degrees(math.acos(1.0 - 1e-5)), rel=1e-6)


def test_gaps_and_chunks_change_nothing(arm, monkeypatch) -> None:
    robot = arm("kr6r900")
    rows = np.random.default_rng(9).uniform(-40.0, 40.0, (12, 6)) + [0.0, -60.0, 60.0, 0.0, 0.0, 0.0]
    whole = chainbuild.singularity_verdicts(robot, rows)
    assert len(whole.blocks) > 4
    monkeypatch.setattr(judging, "_CHUNK", 3)
    apart = chainbuild.singularity_verdicts(robot, rows)
    assert [block.row for block in apart.blocks] == [block.row for block in whole.blocks]
    ways = [[p.begin.path_mm for b in found.blocks for p in b.parts] for found in (whole, apart)]
    assert ways[0] == pytest.approx(ways[1], abs=1e-9)
    rows[6] = np.nan
    cut = chainbuild.singularity_verdicts(robot, rows)
    assert [block.row for block in cut.blocks] == [block.row for block in whole.blocks if block.row not in (5, 6)]
    assert chainbuild.singularity_verdicts(robot, rows[:1]).blocks == ()


def test_an_arm_of_unknown_functions_is_sampled(arm) -> None:
    """NN: its basic axes have no known singularities; a zone of a thousandth of a degree of A5 is found even so."""
    robot = arm("arm_nn", ON)
    begin = np.array([20.0, -40.0, 50.0, 30.0, -20.0, 10.0])
    found = chainbuild.singularity_verdicts(robot, [begin, begin + [1.0, 2.0, 1.0, 3.0, 50.0, 2.0]])
    assert (found.measure, found.proven) == ("smallest", False)
    (block,) = found.blocks
    (part,) = block.parts
    assert (block.level, part.least.axes[4]) == ("singular", pytest.approx(0.0, abs=1e-6))
    assert 0.0 < part.end.axes[4] - part.begin.axes[4] < 2e-3


def test_judgements_of_positions() -> None:
    robot = chainbuild.Robot.load("kr6r900")

    def at(a5: float) -> list[float]:
        return [0.0, -80.0, 100.0, 0.0, a5, 0.0]

    limits = Thresholds()
    found = [assess(robot, at(a5), limits) for a5 in (0.0, 0.11, 0.12, 2.5, 2.6, 10.0)]
    assert [one.level for one in found] == ["singular", "singular", "watched", "watched", "clear", "clear"]
    assert [one.hand_limit for one in found] == [True] * 5 + [False]
    assert found[4].hand_deg == pytest.approx(2.6)
    assert assess(robot, at(1.0), Thresholds(lacks="off")).level == "clear"
    for measure in MEASURES:
        one = assess(robot, at(2.0), Thresholds(measure=measure))
        assert (one.measure, one.value) == (
            measure,
            pytest.approx(by_hand(robot, "kr6r900", measure, np.array(at(2.0)))),
        )


def test_factors_and_measures() -> None:
    for s in (1e-12, 1e-3, 0.5, 1.0):
        assert factor_of_measure(measure_of_factor(s)) == pytest.approx(s, rel=1e-12)
    assert measure_of_factor(1e-12) == pytest.approx(5e-25)
    assert measure_of_factor(math.sin(0.3)) == pytest.approx(1.0 - math.cos(0.3))
    assert (factor_of_measure(2.0), factor_of_measure(-1.0)) == (1.0, 0.0)


def test_what_cannot_be_judged_is_refused(arm) -> None:
    robot = arm("kr6r900")
    with pytest.raises(ChainbuildError, match="KIN_TYP 45"):
        chainbuild.singularity_verdicts(chainbuild.Robot.load("kr6r900_2"), np.zeros((2, 6)))
    with pytest.raises(ChainbuildError, match="motion"):
        chainbuild.singularity_verdicts(robot, np.zeros((2, 6)), between="rows")  # type: ignore[arg-type]
    with pytest.raises(ChainbuildError, match="shape"):
        chainbuild.singularity_verdicts(robot, np.zeros((2, 5)))
