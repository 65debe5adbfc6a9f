"""Three joints that place a point, two that do: every row, by scipy's rotations; counts of the quartic."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from chainbuild.ik.branches.arms.positioner import positioner
from chainbuild.ik.branches.arms.two_joints import reach_by_two
from chainbuild.ik.branches.core.roots import real_angles, real_lengths
from chainbuild.ik.branches.core.serial import Screw
from tests.kit.draws import unit

X, Y, Z = np.eye(3)
ROWS = ["".join(kinds) for kinds in itertools.product("pr", repeat=3)]


def moved(screws: list[Screw], q: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Return where screws take a point, by scipy."""
    for screw, value in zip(screws[::-1], q[::-1], strict=True):
        if screw.kind == "prismatic":
            p = p + value * screw.direction
        else:
            p = Rotation.from_rotvec(value * screw.direction).apply(p - screw.point) + screw.point
    return p


def row(kinds: str, directions: list[np.ndarray], points: list[np.ndarray]) -> list[Screw]:
    names = {"r": "revolute", "p": "prismatic"}
    return [Screw(names[k], d, p, n) for n, (k, d, p) in enumerate(zip(kinds, directions, points, strict=True))]


def off(one: np.ndarray, other: np.ndarray, kinds: str) -> float:
    difference = np.array(one) - other
    turns = np.array([kind == "r" for kind in kinds])
    difference[turns] = np.remainder(difference[turns] + np.pi, 2.0 * np.pi) - np.pi
    return float(np.abs(difference).max())


def round_trip(screws: list[Screw], kinds: str, rng: np.random.Generator) -> int:
    """Find the values again that brought a point to its place; return how many solutions there are."""
    p, q = rng.normal(size=3), rng.uniform(-2.0, 2.0, 3)
    place = moved(screws, q, p)
    reach = positioner(screws)
    assert reach is not None
    found = reach(p, place, (0.0, 0.0, 0.0))
    for values in found:
        assert np.abs(moved(screws, np.array(values), p) - place).max() < 1e-7
    assert min(off(np.array(values), q, kinds) for values in found) < 1e-6
    return len(found)


@pytest.mark.parametrize("kinds", ROWS)
def test_axes_in_no_order_at_all(kinds: str) -> None:
    rng = np.random.default_rng(1)
    counts = set()
    for _ in range(40):
        screws = row(kinds, [unit(rng) for _ in range(3)], [rng.normal(size=3) for _ in range(3)])
        counts.add(round_trip(screws, kinds, rng))
    assert counts <= ({1} if kinds == "ppp" else {2} if kinds.count("r") == 1 else {2, 4})


@pytest.mark.parametrize("kinds", ["prr", "rpr", "rrp", "rrr"])
@pytest.mark.parametrize("offset", [0.0, 0.2])
def test_square_axes_that_meet_or_not(kinds: str, offset: float) -> None:
    # The spherical arm RR and the arm NN of ROBX, with and without the length A.
    rng = np.random.default_rng(2)
    for _ in range(40):
        round_trip(row(kinds, [Z, Y, X], [0.0 * X, offset * X, offset * X + 0.3 * Y]), kinds, rng)


@pytest.mark.parametrize(
    ("kinds", "directions"),
    [("ppr", [Z, Y, X]), ("rpp", [X, Y, Z]), ("prp", [X, Z, Y]), ("rrr", [Z, Z, Z]), ("ppp", [X, Y, X])],
)
def test_what_stays_in_a_plane_is_refused(kinds: str, directions: list[np.ndarray]) -> None:
    assert positioner(row(kinds, directions, [0.0 * X, 0.3 * X, 0.1 * Y])) is None


def test_what_stays_on_a_sphere_is_refused() -> None:
    assert positioner(row("rrr", [Z, Y, X], [0.0 * X, 0.0 * X, 2.0 * X])) is None


def test_a_point_on_the_last_axis_keeps_it() -> None:
    screws = row("rrr", [Z, Y, X], [0.0 * X, 0.2 * X, 0.3 * Z])
    p = np.array([0.7, 0.0, 0.3])
    reach = positioner(screws)
    assert reach is not None
    found = reach(p, moved(screws, np.array([0.4, -0.5, 1.0]), p), (0.0, 0.0, 0.9))
    assert found
    assert {values[2] for values in found} == {0.9}


@pytest.mark.parametrize("kinds", ["pp", "pr", "rp", "rr"])
@pytest.mark.parametrize("special", ["skew", "parallel", "meeting"])
def test_two_joints(kinds: str, special: str) -> None:
    if (kinds, special) == ("pp", "parallel"):
        assert reach_by_two(*row("pp", [X, X], [0.0 * X, 0.0 * X]), X, 2.0 * X, (0.0, 0.0)) == []
        return
    rng = np.random.default_rng(3)
    for _ in range(40):
        a, b = unit(rng), unit(rng)
        one = rng.normal(size=3)
        screws = row(kinds, [a, a if special == "parallel" else b], [one, one if special == "meeting" else -one])
        p, q = rng.normal(size=3), rng.uniform(-2.0, 2.0, 2)
        found = reach_by_two(screws[0], screws[1], p, moved(screws, q, p), (0.0, 0.0))
        assert min(off(np.array(pair), q, kinds) for pair in found) < 1e-6


def test_real_roots() -> None:
    # cos(2t) + 0.5·cos(t − 1) changes its sign four times.
    def f(t: np.ndarray) -> np.ndarray:
        return np.cos(2.0 * t) + 0.5 * np.cos(t - 1.0)

    dense = np.linspace(-np.pi, np.pi, 10001)
    found = real_angles(f, 2)
    assert len(found) == np.count_nonzero(np.diff(np.sign(f(dense))))
    assert np.abs(f(np.array(found))).max() < 1e-12
    assert sorted(real_lengths(lambda x: (x - 3.0) * (x + 0.5) * (x * x + 1.0), 4, 2.0)) == pytest.approx([-0.5, 3.0])
    assert real_angles(lambda t: np.cos(t) + 2.0, 1) == []
    assert real_angles(lambda t: 0.0 * t, 2) == []
    touching = real_angles(lambda t: 1.0 - np.cos(t), 1)
    assert touching
    assert max(abs(t) for t in touching) < 1e-6
