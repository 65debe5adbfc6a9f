"""What compiled descents are made of: the turn that is left, least-squares steps, weakest directions."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numba
import numpy as np
import pinocchio as pin
import pytest

from chainbuild.ik.branches.compiled import axes
from chainbuild.ik.search.compiled import kernels, least_squares


@cache
def from_python(inner: Any) -> Callable[..., Any]:
    """Return an inner function as one that Python can call."""
    called: Callable[..., Any] = numba.njit(inner.py_func)
    return called


ANGLES = (0.0, 1e-14, 1e-9, 1e-5, 9.9e-3, 1.01e-2, 0.05, 0.3, 1.5, 2.0, 3.1, np.pi - 1e-9, np.pi)


@pytest.mark.parametrize("angle", ANGLES)
def test_the_turn_that_is_left(angle: float) -> None:
    rng, turn = np.random.default_rng(3), from_python(kernels.rotation_vector)
    for _ in range(20):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        R = pin.exp3(rng.normal(size=3))
        T, target, error = np.eye(4)[:3].copy(), np.eye(4), np.empty(6)
        T[:, :3], target[:3, :3] = R, R @ pin.exp3(angle * axis)
        turn(T, target, error, np.empty(9))
        wanted = angle * axis
        off = min(np.abs(error[3:] - wanted).max(), np.abs(error[3:] + wanted).max() if angle == np.pi else np.inf)
        assert off < 4e-16 * max(1.0, angle / 1e-2) + (2e-8 if angle > 3.1 else 0.0)


@pytest.mark.parametrize("rows", [1, 2, 3, 5, 6])
@pytest.mark.parametrize("columns", [1, 3, 5, 6, 7, 8])
@pytest.mark.parametrize("damping", [1e-14, 1e-3, 1.0])
def test_damped_steps(rows: int, columns: int, damping: float) -> None:
    rng, step_of = np.random.default_rng(4), from_python(least_squares.damped_step)
    size = max(columns, 6)
    for _ in range(10):
        J, error, step = rng.normal(size=(6, columns)), rng.normal(size=6), np.empty(columns)
        step_of(rows, J, error, np.empty((size, size)), np.empty(size), step, damping)
        used, left = J[:rows], error[:rows]
        wanted = used.T @ np.linalg.solve(used @ used.T + damping * np.eye(rows), left)
        if columns < rows:
            wanted = np.linalg.solve(used.T @ used + damping * np.eye(columns), used.T @ left)
        np.testing.assert_allclose(step, wanted, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("n", [1, 2, 3, 6, 8])
def test_a_factorisation_serves_again(n: int) -> None:
    rng = np.random.default_rng(5)
    first, again = (from_python(each) for each in (least_squares.solve_in_place, least_squares.solve_again))
    for _ in range(20):
        A = rng.normal(size=(n, n))
        A = A @ A.T + 0.1 * np.eye(n)
        H, one, other = A.copy(), rng.normal(size=n), rng.normal(size=n)
        x, y = one.copy(), other.copy()
        first(H, x, n)
        again(H, y, n)
        np.testing.assert_allclose(A @ x, one, atol=1e-9)
        np.testing.assert_allclose(A @ y, other, atol=1e-9)
        np.testing.assert_allclose(1.0 / np.prod(np.diag(H)), np.linalg.det(A), rtol=1e-9)


def test_the_weakest_direction() -> None:
    rng, weakest = np.random.default_rng(6), from_python(axes.weakest)
    for n in (3, 5, 6):
        U, V = (np.linalg.qr(rng.normal(size=(size, size)))[0] for size in (6, n))
        strengths = np.array([3.0, 2.0, 1.5, 1.2, 1.0, 1.0])[:n]
        strengths[-2:] = 0.3, 1e-3
        room = axes.FinishRoom(
            np.empty((3, 4)), np.empty((6, n)), np.empty(6), np.empty(9), np.empty((6, 2)), U[:, :n] * strengths @ V.T,
            np.empty((6, 6)), np.empty(6), np.empty(n), np.empty(n), np.empty((2, n)),
        )  # fmt: skip
        v, others, second = np.empty(n), np.empty((2, n)), np.empty(n)
        assert weakest(room, 6, n, others, 0.0, v) == pytest.approx(1e-3, rel=1e-6)
        assert abs(v @ V[:, -1]) == pytest.approx(1.0, abs=1e-9)
        others[0] = v
        assert weakest(room, 6, n, others, 1.0, second) == pytest.approx(0.3, rel=1e-2)
        assert abs(second @ V[:, -2]) > 0.99


def test_an_iteration_towards_the_weakest_direction_keeps_its_side() -> None:
    """A walk along a valley would turn back in every step."""
    rng, inverted = np.random.default_rng(7), from_python(axes.inverted)
    J = rng.normal(size=(6, 6)) @ np.diag([1.0, 1.0, 1.0, 1.0, 1.0, 1e-3])
    room = axes.FinishRoom(
        np.empty((3, 4)), np.empty((6, 6)), np.empty(6), np.empty(9), np.empty((6, 2)), J, np.empty((6, 6)),
        np.empty(6), np.empty(6), np.empty(6), np.empty((2, 6)),
    )  # fmt: skip
    for side in (1.0, -1.0):
        v = side * np.array([0.1, -0.2, 0.1, 0.3, 0.2, 0.9])
        inverted(room, 6, 6, np.empty((1, 6)), 0.0, v)
        assert side * v[5] > 0.99
