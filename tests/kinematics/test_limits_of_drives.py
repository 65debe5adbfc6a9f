"""Limits of drives and sums, and the ranges they leave to the axes, against trying every place."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from chainbuild import AffineDrives, AxisConstraint, AxisSum, DriveLimit, Robot
from chainbuild.chain.assemble import rotary, shift
from chainbuild.chain.elements import Axis, Chain
from chainbuild.kinematics.limits import Limits
from chainbuild.kinematics.ranges import range_beside, with_ranges, within_reach
from chainbuild.tolerances import LIMIT_SLACK
from tests.kit.robots import make_chain


def hinges(*ranges: tuple[float, float] | None) -> Chain:
    """Return a chain of hinges A, B, …, endless ones where no range is given."""
    names = "ABC"[: len(ranges)]
    elements = [element for name in names for element in (rotary(name, "z"), shift(x=100.0))]
    chain = make_chain(elements, [], " ".join(names))
    axes = [
        replace(axis, endless=True) if ends is None else replace(axis, lower=ends[0], upper=ends[1])
        for axis, ends in zip(chain.axes, ranges, strict=True)
    ]
    return chain.with_axes(tuple(axes))


def geared(chain: Chain, row: list[float], offset: float, lower: float, upper: float) -> Chain:
    """Return the chain with limits of the first drive, which stands at row·axes + offset."""
    A, b = np.eye(len(row)), np.zeros(len(row))
    A[0], b[0] = row, offset
    return replace(chain, drives=AffineDrives(A, b), drive_limits=(DriveLimit(0, lower, upper),))


@dataclass(frozen=True, eq=False)
class Bent:
    """The first drive stands at a bent function of the first axis and a factor times the second."""

    law: Callable[[float], float]
    factor: float = 0.0

    @property
    def follows(self) -> NDArray[np.bool_]:
        return np.array([[True, self.factor != 0.0], [False, True]])

    differing, turning, reach = (0,), (1,), {0: (-90.0, 90.0)}

    def drives(self, axes: np.ndarray) -> np.ndarray:
        return np.array([self.law(float(axes[0])) + self.factor * axes[1], axes[1]])

    def derivative(self, axes: np.ndarray) -> np.ndarray:
        raise NotImplementedError

    def refusal(self, axes: np.ndarray) -> None:
        return None


def test_an_endless_axis_is_nowhere_outside() -> None:
    limits = Limits.of(hinges(None, (-20.0, 30.0)))
    for value in (-1e5, 0.0, 1e5):
        assert limits.outside(np.array([value, 0.0])) == []
        assert limits.outside(np.array([value, 30.0 + 0.5 * LIMIT_SLACK])) == []
        assert limits.outside(np.array([value, -20.0 - 0.5 * LIMIT_SLACK])) == []
        assert limits.outside(np.array([value, -20.0 - 2.0 * LIMIT_SLACK])) == [1]


@pytest.mark.parametrize(("beyond", "broken"), [(-1.0, False), (0.0, False), (0.5, False), (2.0, True)])
def test_sums_on_the_limit_and_just_beyond(beyond: float, broken: bool) -> None:
    total = AxisConstraint("sum", AxisSum((1.0, 1.0), 5.0), -20.0, 30.0)
    limits = Limits.of(replace(hinges((-90.0, 90.0), (-90.0, 90.0)), constraints=(total,)))
    for value in (25.0 + beyond * LIMIT_SLACK, -25.0 - beyond * LIMIT_SLACK):
        values = np.array([value, 0.0])
        assert bool(limits.broken_sums(values)) == broken
        assert bool(limits.joint_violations(values)) == broken
        assert limits.violated(values) == (("sum",) if broken else ())


@pytest.mark.parametrize(("beyond", "broken"), [(-1.0, False), (0.0, False), (0.5, False), (2.0, True)])
def test_bent_drives_on_the_limit_and_just_beyond(beyond: float, broken: bool) -> None:
    chain = hinges((-90.0, 90.0), (-90.0, 90.0))
    limits = Limits.of(replace(chain, drives=Bent(abs), drive_limits=(DriveLimit(0, 20.0, 60.0),)))
    for value in (60.0 + beyond * LIMIT_SLACK, -20.0 + beyond * LIMIT_SLACK):
        assert [one.axis for one, _ in limits.broken_drives(np.array([value, 0.0]))] == ([0] if broken else [])


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_an_end_that_is_that_of_a_drive_is_named_by_the_drive(sense: float) -> None:
    """A_drive = ±2·A + B/2 within -100 … 80: with B at its ends A turns from -95 to 85, or from -85 to 95."""
    least, most = (-95.0, 85.0) if sense > 0.0 else (-85.0, 95.0)
    for lower, upper in itertools.product((least, least + 15.0), (most, most - 15.0)):
        chain = hinges((lower, upper), (-180.0, 180.0))
        limits = Limits.of(geared(chain, [2.0 * sense, 0.5], 0.0, -100.0, 80.0))
        ends = {(0, side) for side, end in ((-1, lower), (1, upper)) if end in (least, most)}
        assert limits.from_drives == dict.fromkeys(ends, "A_drive")
        for side, end in ((-1, lower), (1, upper)):
            for b in (-180.0, 180.0):
                values = np.array([end + side, b])
                drive = 2.0 * sense * values[0] + 0.5 * b
                wrong = ("A_drive",) if not -100.0 <= drive <= 80.0 else ()
                assert limits.violated(values) == (wrong if (0, side) in ends else ("A", *wrong))


@pytest.mark.parametrize("seed", range(12))
def test_the_range_at_the_middle_of_the_others(seed: int) -> None:
    """What of each axis' own range leaves the drive inside its limits, tried in steps of a twentieth of a degree."""
    rng = np.random.default_rng(seed)
    ends = [tuple(sorted(rng.uniform(-180.0, 180.0, 2))) for _ in range(3)]
    row, offset = rng.uniform(0.5, 2.0, 3) * rng.choice([-1.0, 1.0], 3), float(rng.uniform(-40.0, 40.0))
    middle = np.mean(ends, axis=1)
    at_middle = float(row @ middle) + offset
    chain = geared(hinges(*ends), row.tolist(), offset, at_middle - 30.0, at_middle + 50.0)
    found, lost = with_ranges(chain)
    assert lost == ()
    for n, axis in enumerate(found.axes):
        places = np.arange(*ends[n], 0.05)
        inside = places[np.abs(at_middle + row[n] * (places - middle[n]) - (at_middle + 10.0)) <= 40.0]
        assert (axis.lower, axis.upper) == pytest.approx((inside[0], inside[-1]), abs=0.05)
        assert axis.widest == ends[n]


@pytest.mark.parametrize("factor", [2.0, -0.5])
@pytest.mark.parametrize("others", [(0.5, -0.25), (0.0, 0.0), (1.5, 0.0)])
def test_the_widest_range_of_an_axis_without_limits_of_its_own(factor: float, others: tuple[float, float]) -> None:
    """It is widest where each of the others is at one of its ends."""
    ends = [(-20.0, 50.0), (-90.0, 40.0)]
    chain = hinges((0.0, 1.0), *ends)
    chain = geared(chain, [factor, *others], 7.0, -80.0, 110.0)
    chain = chain.with_axes((Axis.unlimited("A", "rotary"), *chain.axes[1:]))
    rests = [float(np.dot(others, corner)) + 7.0 for corner in itertools.product(*ends)]
    places = [(end - rest) / factor for rest in rests for end in (-80.0, 110.0)]
    found, _ = with_ranges(chain)
    assert found.axes[0].range == pytest.approx((min(places), max(places)))
    rest = float(np.dot(others, np.mean(ends, axis=1))) + 7.0
    at_middle = sorted((end - rest) / factor for end in (-80.0, 110.0))
    assert (found.axes[0].lower, found.axes[0].upper) == pytest.approx(at_middle)
    assert not found.axes[0].assumed


def test_limits_of_two_drives_that_follow_one_axis() -> None:
    """A_drive = A, B_drive = A + B: A is 10 at most and B anything that A, between -30 and 20, makes up for."""
    chain = hinges((-30.0, 20.0), (0.0, 1.0))
    chain = chain.with_axes((chain.axes[0], Axis.unlimited("B", "rotary")))
    drives = AffineDrives(np.array([[1.0, 0.0], [1.0, 1.0]]), np.zeros(2))
    chain = replace(chain, drives=drives, drive_limits=(DriveLimit(0, -40.0, 10.0), DriveLimit(1, -100.0, 60.0)))
    found, _ = with_ranges(chain)
    assert (found.axes[0].lower, found.axes[0].upper) == (-30.0, 10.0)
    assert found.axes[0].widest == (-30.0, 20.0)  # its own: beyond 10 it is the drive that is named
    assert found.axes[1].widest == (-120.0, 90.0)


def test_beside_an_endless_axis_a_drive_leaves_everything() -> None:
    chain = geared(hinges((0.0, 1.0), None), [1.0, 0.5], 0.0, -80.0, 110.0)
    free = Axis.unlimited("A", "rotary")
    found, _ = with_ranges(chain.with_axes((free, chain.axes[1])))
    assert found.axes[0].widest == (free.lower, free.upper)
    assert (found.axes[0].lower, found.axes[0].upper) == (-80.0, 110.0)


@pytest.mark.parametrize(("bend", "expected"), [(40.0, (60.0, 160.0)), (60.0, (-60.0, 40.0))])
def test_of_two_stretches_the_one_nearer_to_the_middle(bend: float, expected: tuple[float, float]) -> None:
    """|A - bend| within 20 … 120 with A in -100 … 200, whose middle is 50; to the last digit inside."""
    chain = hinges((-100.0, 200.0), (-10.0, 10.0))
    law = lambda a: abs(a - bend)  # noqa: E731
    found, _ = with_ranges(replace(chain, drives=Bent(law), drive_limits=(DriveLimit(0, 20.0, 120.0),)))
    ends = (found.axes[0].lower, found.axes[0].upper)
    assert ends == pytest.approx(expected, abs=1e-12)
    assert all(20.0 <= law(end) <= 120.0 for end in ends)


def test_a_bent_drive_that_is_inside_everywhere() -> None:
    chain = hinges((-100.0, 200.0), (-10.0, 10.0))
    found, _ = with_ranges(replace(chain, drives=Bent(math.sin), drive_limits=(DriveLimit(0, -2.0, 2.0),)))
    assert (found.axes[0].lower, found.axes[0].upper) == (-100.0, 200.0)


def test_the_ends_of_a_bent_range_are_inside_to_the_last_digit() -> None:
    law = lambda a: a + a**3 / 3e4  # noqa: E731
    for most in np.linspace(10.1, 60.7, 40):
        limits = (DriveLimit(0, -most / 3.0, most),)
        found, _ = with_ranges(replace(hinges((-100.0, 200.0), (-1.0, 1.0)), drives=Bent(law), drive_limits=limits))
        lower, upper = found.axes[0].lower, found.axes[0].upper
        assert law(upper) <= most < law(math.nextafter(upper, math.inf) + 1e-13)
        assert law(math.nextafter(lower, -math.inf) - 1e-13) < -most / 3.0 <= law(lower)


@pytest.mark.parametrize("stands", [-170.0, 0.0, 170.0])
def test_the_range_of_a_turn_does_not_depend_on_where_it_stands(stands: float) -> None:
    """The cardanic head's C has no limits but those of its drive, C - atan2(cos 45°·sin(m/2), cos(m/2)), m of A."""
    chain = Robot.load("cardan_head_kin59").chain.with_drive_limits((DriveLimit(3, -150.0, 100.0),))
    free = Axis.unlimited("C", "rotary")
    chain = chain.with_axes((*chain.axes[:3], replace(free, widest=(free.lower, free.upper)), chain.axes[4]))
    lean = 60.0
    machine = 2.0 * math.asin(math.sin(math.radians(lean / 2.0)) / math.sin(math.pi / 4.0))
    off = math.degrees(math.atan2(math.cos(math.pi / 4.0) * math.sin(machine / 2.0), math.cos(machine / 2.0)))
    found = range_beside(chain, 3, np.array([0.0, 0.0, 0.0, stands, lean]))
    assert found == pytest.approx((-150.0 + off, 100.0 + off), abs=1e-9)


def test_limits_on_the_reach_are_not_narrowed() -> None:
    chain = replace(hinges((-90.0, 90.0), (-1.0, 1.0)), drives=Bent(math.sin))
    for over, narrowed in ((-1.0, ()), (0.0, ()), (1e-10, ()), (1e-3, (0,))):
        for lower, upper in ((-90.0 - over, 80.0), (-80.0, 90.0 + over)):
            axis = replace(chain.axes[0], lower=lower, upper=upper)
            found, told = within_reach(chain.with_axes((axis, chain.axes[1])))
            assert told == narrowed
            assert (found.axes[0].lower, found.axes[0].upper) == (max(lower, -90.0), min(upper, 90.0))
