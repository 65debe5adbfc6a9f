"""Swept limits against planar geometry by hand, and what is said about the limits of a file."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import chainbuild
from chainbuild.analysis.collision.parallelogram import swept_limits
from chainbuild.analysis.collision.sweep import sweep
from chainbuild.chain.bodies.geometry import Geometry, RodData, Shape
from chainbuild.chain.elements import Chain
from chainbuild.collision.model import CollisionModel
from chainbuild.errors import ChainbuildError
from tests.kit.planar import edge, segment_distance, turned

ARM, CRANK, TOP = 1.1, 0.30, 0.85  # m: upper arm, crank, height of the shoulder of parallelogram_nr
SHOULDER_X, FORE_X, FORE_Z = 0.4, 1.25, 0.25
R_ARM, R_ROD, R_COLUMN, R_FORE = 0.09, 0.04, 0.12, 0.10
COLUMN = (-0.05, -0.35, 0.30, -0.35)  # x, z of both ends of the column's body, in its frame
BASE = (0.0, 0.1, 0.0, 0.45)


def with_bodies(lower: float, upper: float) -> Chain:
    """The shipped arm with bodies of round numbers and limits of its angle."""
    chain = chainbuild.load("parallelogram_nr").chain()

    def capsule(x0: float, z0: float, x1: float, z1: float, radius: float) -> Shape:
        return Shape("capsule", points=(x0, 0.0, z0, x1, 0.0, z1), radius=radius)

    shapes = {
        "base": (capsule(*BASE, 0.2),),
        "A1_link": (capsule(*COLUMN, R_COLUMN),),
        "A2_link": (capsule(0.0, 0.0, ARM, 0.0, R_ARM),),
    }
    shapes["A3_link"] = (capsule(0.0, 0.0, FORE_X, FORE_Z, R_FORE),)
    geometry = Geometry(shapes=shapes, rod_data=RodData(crank=CRANK, radius=R_ROD))
    (limit,) = chain.constraints
    return replace(chain, geometry=geometry, constraints=(replace(limit, lower=lower, upper=upper),))


def free_by_hand(a2: float) -> tuple[float, float]:
    """The free angle A2 + A3 + 180 at a value of A2, in the plane of the arm: x forwards, z up.

    Machine zero: upper arm upright; A2 leans it forwards. The elbow's angle is between upper arm and forearm, 0 folded.
    """
    shoulder = np.array([SHOULDER_X, TOP])
    up = turned((0.0, 1.0), a2)
    elbow = shoulder + ARM * up

    def collides(angle: float) -> bool:
        # The forearm's frame is pitched by 180 - angle against the upper arm's; its end lies (x, z) in that frame.
        pitch = a2 - 90.0 + (180.0 - angle)
        end = elbow + turned((FORE_X, FORE_Z), pitch)
        along = (end - elbow) / np.linalg.norm(end - elbow)
        crank = shoulder - CRANK * along
        rod = crank, crank + ARM * up
        column = np.array(COLUMN[:2]) + [0.0, TOP], np.array(COLUMN[2:]) + [0.0, TOP]
        base = np.array(BASE[:2]), np.array(BASE[2:])
        lever = elbow, elbow - CRANK * along
        pairs = [
            (rod, (shoulder, elbow), R_ROD + R_ARM),
            (rod, column, R_ROD + R_COLUMN),
            (rod, base, R_ROD + 0.2),
            ((shoulder, crank), base, R_ROD + 0.2),
            ((elbow, end), column, R_FORE + R_COLUMN),
            ((elbow, end), base, R_FORE + 0.2),
            ((elbow, end), (shoulder, crank), R_FORE + R_ROD),
        ]
        del lever  # the overlay's bodies of the forearm take the place of the drawn lever
        return any(segment_distance(*first, *second) <= radii for first, second, radii in pairs)

    free = next(float(a) for a in sorted(np.arange(2.0, 179.0), key=lambda a: abs(a - 90.0)) if not collides(float(a)))
    low = high = free
    while not collides(low):
        low -= 0.25
    while not collides(high):
        high += 0.25
    return edge(collides, low + 0.25, low), edge(collides, high - 0.25, high)


def test_swept_limits_of_a_parallelogram_agree_with_planar_geometry() -> None:
    report = swept_limits(chainbuild.Robot(with_bodies(30.0, 150.0)), steps=10)
    assert not report.drawn
    assert report.blocked == ()
    assert (report.over, report.moved) == ("A2", "A3")
    seen = set()
    for interval in report.intervals:
        low, high = free_by_hand(interval.over)
        assert interval.lower == pytest.approx(low, abs=0.01)
        assert interval.upper == pytest.approx(high, abs=0.01)
        seen |= {interval.lower_pair, interval.upper_pair}
    assert len(seen) > 1  # the arm limits some, the column others
    assert report.proposal is not None
    low = max(interval.lower or 0.0 for interval in report.intervals)
    high = min(interval.upper or 0.0 for interval in report.intervals)
    assert low <= report.proposal[0] < low + 0.011
    assert high - 0.011 < report.proposal[1] <= high
    first, second = report.machine_data()
    assert first == f"N62964 $MC_ROBX_SW_LIMITS_PARALLEL[0]={report.proposal[0]:.2f}"
    assert second.startswith("N62964 $MC_ROBX_SW_LIMITS_PARALLEL[1]=")


def test_verdicts_on_the_limits_of_a_file() -> None:
    fitting = swept_limits(chainbuild.Robot(with_bodies(30.0, 150.0)), steps=7).proposal
    assert fitting is not None
    low, high = fitting
    assert swept_limits(chainbuild.Robot(with_bodies(low, high)), steps=7).verdicts == ("the limits are right",)
    wide = swept_limits(chainbuild.Robot(with_bodies(low - 3.0, high + 3.0)), steps=7).verdicts
    assert len(wide) == 2
    assert all("too wide" in verdict and "touch" in verdict for verdict in wide)
    tight = swept_limits(chainbuild.Robot(with_bodies(low + 12.0, high - 7.0)), steps=7).verdicts
    assert tight == (
        "the lower limit is too tight: 12.0° of the free angle are lost",
        "the upper limit is too tight: 7.0° of the free angle are lost",
    )


def test_without_rods_in_the_way_the_dead_points_end_the_range() -> None:
    chain = with_bodies(30.0, 150.0)
    thin = dict.fromkeys(("base", "A1_link", "A2_link", "A3_link"), 0.001)
    geometry = Geometry(radii=thin, rod_data=RodData(crank=CRANK, radius=0.001, sideways=0.5))
    links = tuple(replace(link, radius=thin.get(link.name)) for link in chain.links)
    report = swept_limits(chainbuild.Robot(replace(chain, geometry=geometry, links=links)), steps=3)
    for interval in report.intervals:
        assert interval.lower is not None
        assert interval.upper is not None
        # Folded, the forearm meets the crank at the shoulder just before crank and rod are in line.
        assert interval.upper - interval.lower == pytest.approx(180.0, abs=0.3)
        assert interval.upper_pair is None


def test_only_parallelograms_have_such_limits() -> None:
    with pytest.raises(ChainbuildError, match="no limits on a parallelogram's angle"):
        swept_limits(chainbuild.Robot.load("kr6r900"))
    with pytest.raises(ChainbuildError, match="too few values of axis 2"):
        swept_limits(chainbuild.Robot(with_bodies(30.0, 150.0)), steps=1)


def test_any_axis_over_any_other() -> None:
    model = CollisionModel(chainbuild.Robot.load("palletiser_kin96"))
    found = sweep(model, "G3", "G2", values=np.linspace(-40.0, 85.0, 9).tolist())
    assert (found.moved, found.over, found.unit_moved, found.unit_over) == ("G3", "G2", "deg", "deg")
    assert len(found.intervals) == 9
    lower, upper = -20.0, 60.0
    for one in found.intervals:
        assert one.lower is not None
        assert one.upper is not None
        at = np.array([0.0, one.over, 0.0, 0.0])
        for value, pair, limit in ((one.lower, one.lower_pair, lower), (one.upper, one.upper_pair, upper)):
            at[2] = value
            assert not model.collides(at)
            if pair is None:
                assert value == limit
                continue
            at[2] = value + np.sign(limit - value) * 0.01
            assert model.collides(at)
    assert any(one.upper_pair for one in found.intervals)


def test_sweeps_that_make_no_sense() -> None:
    model = CollisionModel(chainbuild.Robot.load("palletiser_kin96"))
    with pytest.raises(ChainbuildError, match="no axis 'B7'"):
        sweep(model, "B7", "G2")
    with pytest.raises(ChainbuildError, match="against itself"):
        sweep(model, "G2", "G2")
    with pytest.raises(ChainbuildError, match="empty"):
        sweep(model, "G3", "G2", bounds=(10.0, 10.0))
    everywhere = Geometry(shapes={"base": (Shape("box", size=(9.0, 9.0, 9.0)),)})
    blocked = CollisionModel(chainbuild.Robot(replace(model.robot.chain, geometry=everywhere)), [("base", "G3_link")])
    (one,) = sweep(blocked, "G3", "G2", values=[0.0]).intervals
    assert (one.lower, one.upper) == (None, None)


def test_a_body_that_is_only_drawn_makes_no_machine_data() -> None:
    """The upper arm decides the lower end: without its dimensions the proposal is an estimate."""
    chain = with_bodies(30.0, 150.0)
    given = swept_limits(chainbuild.Robot(chain), steps=5)
    assert (given.drawn, given.touching) == ((), ())
    assert len(given.machine_data()) == 2
    shapes = {link: shapes for link, shapes in chain.geometry.shapes.items() if link != "A2_link"}
    links = tuple(replace(link, radius=0.09) if link.name == "A2_link" else link for link in chain.links)
    guessed = swept_limits(
        chainbuild.Robot(replace(chain, links=links, geometry=replace(chain.geometry, shapes=shapes))), steps=5
    )
    assert guessed.drawn == ("A2_link",)
    assert guessed.proposal == pytest.approx(given.proposal, abs=0.02)
    assert guessed.machine_data() == ()
    thin = replace(chain, geometry=replace(chain.geometry, rod_data=RodData(crank=CRANK)))
    assert "rod_link" in swept_limits(chainbuild.Robot(thin), steps=3).drawn


def test_values_without_a_free_angle_and_bodies_that_touch_at_home() -> None:
    chain = with_bodies(30.0, 150.0)

    def with_base(*shape: Shape) -> Chain:
        return replace(chain, geometry=replace(chain.geometry, shapes={**chain.geometry.shapes, "base": shape}))

    # A block behind the arm, where the crank and the rod are only while the arm leans back.
    behind = swept_limits(chainbuild.Robot(with_base(Shape("sphere", points=(-0.6, 0.0, 1.6), radius=0.35))), steps=5)
    assert behind.touching == ()
    assert behind.blocked
    assert behind.proposal is None
    assert behind.machine_data() == ()
    assert behind.verdicts[-1].startswith("no angle is free at A2 = ")
    around = swept_limits(chainbuild.Robot(with_base(Shape("sphere", points=(0.0, 0.0, 0.9), radius=0.3))), steps=3)
    assert ("base", "rod_link") in {tuple(sorted(pair)) for pair in around.touching}
    assert all("touch at home" in verdict for verdict in around.verdicts)
    assert around.machine_data() == ()
