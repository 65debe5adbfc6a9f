"""Subproblems: every root found, none invented, degenerate cases named with the angle kept."""

from __future__ import annotations

import math

import numpy as np
import pytest

from chainbuild import frames
from chainbuild.ik.branches.core import subproblems as sub
from tests.kit.draws import unit

X, Y, Z = np.eye(3)


def apart(a: float, b: float) -> float:
    return abs(math.remainder(a - b, math.tau))


def test_rotation_agrees_with_the_frames_room() -> None:
    rng = np.random.default_rng(0)
    for _ in range(50):
        k, angle, p = unit(rng), rng.uniform(-math.pi, math.pi), rng.normal(size=3)
        wanted = frames.rot_about(k, math.degrees(angle))
        np.testing.assert_allclose(sub.rotation(k, angle), wanted, atol=1e-14)
        np.testing.assert_allclose(sub.rotate(k, angle, p), wanted @ p, atol=1e-14)


def test_half_open() -> None:
    assert sub.half_open(-math.pi) == math.pi
    assert sub.half_open(3 * math.pi) == pytest.approx(math.pi)
    assert sub.half_open(-7.0) == pytest.approx(-7.0 + math.tau)


def test_one_turn() -> None:
    rng = np.random.default_rng(1)
    for _ in range(500):
        k, p, angle = unit(rng), rng.normal(size=3), rng.uniform(-math.pi, math.pi)
        turn = sub.subproblem_1(k, p, sub.rotate(k, angle, p))
        assert not turn.free
        assert turn.miss < 1e-12
        assert apart(turn.angle, angle) < 1e-10


def test_one_turn_says_how_far_it_misses() -> None:
    turn = sub.subproblem_1(Z, np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 3.0]))
    assert turn.angle == pytest.approx(math.pi / 2)
    assert turn.miss == pytest.approx(3.0)


def test_one_turn_on_the_axis_is_free() -> None:
    turn = sub.subproblem_1(Z, Z, Z, keep=0.7)
    assert (turn.angle, turn.free, turn.miss) == (0.7, True, 0.0)
    off = sub.subproblem_1(Z, Z, -Z, keep=0.7)
    assert off.free
    assert off.miss == pytest.approx(2.0)


def test_two_turns_find_both_pairs() -> None:
    rng = np.random.default_rng(2)
    for _ in range(1000):
        k1, k2, p = unit(rng), unit(rng), rng.normal(size=3)
        first, second = rng.uniform(-math.pi, math.pi, 2)
        q = sub.rotate(k1, first, sub.rotate(k2, second, p))
        pairs = sub.subproblem_2(k1, k2, p, q)
        assert len(pairs) == 2
        for pair in pairs:
            np.testing.assert_allclose(sub.rotate(k1, pair.first, sub.rotate(k2, pair.second, p)), q, atol=1e-11)
        assert min(apart(pair.first, first) + apart(pair.second, second) for pair in pairs) < 1e-5
        assert apart(pairs[0].first, pairs[1].first) + apart(pairs[0].second, pairs[1].second) > 1e-9


def test_two_turns_of_a_c_a_head() -> None:
    # KIN_TYP manual 1.4 prints the pair C0 A45 and C180 A-45 for one direction.
    q = frames.rot_x(45.0) @ Z
    pairs = {(round(math.degrees(p.first)) % 360, round(math.degrees(p.second))) for p in sub.subproblem_2(Z, X, Z, q)}
    assert pairs == {(0, 45), (180, -45)}


def test_two_turns_out_of_range() -> None:
    tilted = np.array([0.0, math.sin(0.5), math.cos(0.5)])
    # The inner axis is 0.5 rad off the outer one: no direction leaves the cone of 1 rad about Z.
    assert sub.subproblem_2(Z, tilted, Z, X) == ()
    edge = np.array([math.sin(1.0), 0.0, math.cos(1.0)])
    (only,) = sub.subproblem_2(Z, tilted, Z, edge)
    np.testing.assert_allclose(sub.rotate(Z, only.first, sub.rotate(tilted, only.second, Z)), edge, atol=1e-9)
    assert apart(only.second, math.pi) < 1e-4


def test_two_turns_need_equal_lengths() -> None:
    assert sub.subproblem_2(Z, X, Z, 1.1 * Z) == ()


def test_two_turns_singular_outer_axis_is_kept() -> None:
    (only,) = sub.subproblem_2(Z, X, Z, Z, keep=(1.2, 0.4))
    assert only.first_free
    assert not only.second_free
    assert (only.first, only.second) == (1.2, 0.0)
    (down,) = sub.subproblem_2(Z, X, Z, -Z, keep=(1.2, 0.4))
    assert down.first_free
    assert apart(down.second, math.pi) < 1e-12


def test_two_turns_vector_on_the_inner_axis() -> None:
    (only,) = sub.subproblem_2(Z, X, X, Y, keep=(1.2, 0.4))
    assert (only.first_free, only.second_free) == (False, True)
    assert (only.first, only.second) == (pytest.approx(math.pi / 2), 0.4)
    assert sub.subproblem_2(Z, X, X, Z) == ()


def test_two_turns_about_parallel_axes() -> None:
    (only,) = sub.subproblem_2(Z, -Z, X, Y, keep=(0.0, 0.4))
    np.testing.assert_allclose(sub.rotate(Z, only.first, sub.rotate(-Z, only.second, X)), Y, atol=1e-15)
    assert only.second == 0.4
    assert only.second_free
    (both,) = sub.subproblem_2(Z, Z, Z, Z, keep=(0.1, 0.4))
    assert both == sub.TwoTurns(0.1, 0.4, True, True)
    assert sub.subproblem_2(Z, Z, X, np.array([0.0, 0.6, 0.8])) == ()


def test_distance() -> None:
    rng = np.random.default_rng(3)
    for _ in range(500):
        k, p, q, angle = unit(rng), rng.normal(size=3), rng.normal(size=3), rng.uniform(-math.pi, math.pi)
        distance = float(np.linalg.norm(q - sub.rotate(k, angle, p)))
        turns = sub.subproblem_3(k, p, q, distance)
        assert min(apart(turn.angle, angle) for turn in turns) < 1e-5
        for turn in turns:
            assert np.linalg.norm(q - sub.rotate(k, turn.angle, p)) == pytest.approx(distance, abs=1e-9)


def test_distance_out_of_range_touching_and_free() -> None:
    two_x = 2.0 * X
    assert sub.subproblem_3(Z, X, two_x, 3.1) == ()
    assert sub.subproblem_3(Z, X, two_x, 0.9) == ()
    assert sub.subproblem_3(Z, X, two_x, 1.0) == (sub.Turn(0.0),)
    (far,) = sub.subproblem_3(Z, X, two_x, 3.0)
    assert apart(far.angle, math.pi) < 1e-12
    assert sub.subproblem_3(Z, Z, two_x, math.sqrt(5.0), keep=0.3) == (sub.Turn(0.3, True),)
    assert sub.subproblem_3(Z, Z, two_x, 2.0) == ()
    # Both at a height of their own, and the other one on the axis.
    assert sub.subproblem_3(Z, 2.0 * Z, 4.0 * X + 5.0 * Z, 5.0, keep=0.3) == (sub.Turn(0.3, True),)
    assert sub.subproblem_3(Z, 4.0 * X + 5.0 * Z, 2.0 * Z, 5.0, keep=0.3) == (sub.Turn(0.3, True),)
    assert sub.subproblem_3(Z, 4.0 * X + 5.0 * Z, -2.0 * Z, 5.0) == ()


def test_parts_across_an_axis() -> None:
    np.testing.assert_allclose(sub.perpendicular_part(Z, 2.0 * X - 3.0 * Z), 2.0 * X)


def test_height() -> None:
    rng = np.random.default_rng(4)
    for _ in range(500):
        k, p, h, angle = unit(rng), rng.normal(size=3), unit(rng), rng.uniform(-math.pi, math.pi)
        d = float(h @ sub.rotate(k, angle, p))
        turns = sub.subproblem_4(k, p, h, d)
        assert min(apart(turn.angle, angle) for turn in turns) < 1e-5
        for turn in turns:
            assert h @ sub.rotate(k, turn.angle, p) == pytest.approx(d, abs=1e-9)


def test_height_out_of_range_and_free() -> None:
    assert sub.subproblem_4(Z, X, Y, 1.1) == ()
    assert sub.subproblem_4(Z, X, Z, 0.0, keep=0.3) == (sub.Turn(0.3, True),)
    assert sub.subproblem_4(Z, X, Z, 0.1) == ()
    (top,) = sub.subproblem_4(Z, X, Y, 1.0)
    assert top.angle == pytest.approx(math.pi / 2)
