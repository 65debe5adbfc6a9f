"""Closed loops beside a serial arm: the closed form, Newton from a near state, forward kinematics of one and many."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from chainbuild import Robot
from chainbuild.kinematics.closure import Closure, closing_axes, closure_of
from tests.kit.six_rods import SixRods

MACHINES = ("tripod_kin12", "tripod_table_kin209", "delta_kin37", "lambda_kin21")
DELTA, SERIAL = "delta_kin37", "kr6r900"
HD = {4: 40.0, 5: 150.0, 6: 500.0, 7: 200.0}  # of the shipped delta robot, mm
ONE_ROD, SIX_RODS = "Newton, one rod an arm", "Newton, six rods"
FUNCTION, ONE, MANY = "closed form", "fk", "fk_batch"
_STATES = 200
_LEAST_DEG, _MOST_DEG = 0.1, 2.0  # steps of the levers from one state to the next


def loop_times(many: int = 20_000, rounds: int = 9) -> dict[str, dict[str, float]]:
    """Return µs by machine and kind; the serial arm's `fk` is among them."""
    found: dict[str, dict[str, float]] = {}
    for name in (*MACHINES, SERIAL):
        robot = Robot.load(name)
        rows = closing_axes(robot, np.random.default_rng(3), _STATES)
        batch = np.tile(rows, (max(many // len(rows), 1), 1))
        found[name] = {
            ONE: each(lambda row, r=robot: r.fk(row), rows, rounds),
            MANY: each(lambda _, r=robot, b=batch: r.fk_batch(b), rows[:1], rounds) / len(batch),
        }
    delta = Robot.load(DELTA)
    rows = closing_axes(delta, np.random.default_rng(4), _STATES)
    found[DELTA] |= newton(delta, rows, rounds) | {FUNCTION: function(delta, rows, rounds)}
    return found


def each(work: Callable[[np.ndarray], object], rows: np.ndarray, rounds: int) -> float:
    """Return the least time of one call over some rounds over all rows, in µs."""
    times = []
    for _ in range(rounds + 1):  # the first warms up
        begin = time.perf_counter()
        for row in rows:
            work(row)
        times.append(time.perf_counter() - begin)
    return min(times) / len(rows) * 1e6


def function(delta: Robot, rows: np.ndarray, rounds: int) -> float:
    """Return the time of the common point of three balls alone."""
    axis_map = delta.chain.axis_map
    ends = [tuple(arm.place(v) for arm, v in zip(axis_map.arms, row, strict=True)) for row in rows.tolist()]  # type: ignore[attr-defined]
    lists = np.empty(len(ends), dtype=object)
    lists[:] = ends
    return each(axis_map.common, lists, rounds)  # type: ignore[attr-defined]


def newton(delta: Robot, rows: np.ndarray, rounds: int) -> dict[str, float]:
    """Return the time of Newton's method from the passive joints of a state 0.1 to 2 degrees away."""
    rng, six = np.random.default_rng(5), SixRods(HD)
    steps = rng.uniform(_LEAST_DEG, _MOST_DEG, rows.shape) * rng.choice([-1.0, 1.0], rows.shape)
    passive = np.array(closure_of(delta).passive)

    def timed(closure: Closure, q: Callable[[np.ndarray], np.ndarray], free: np.ndarray) -> float:
        starts = []
        for row, step in zip(rows, steps, strict=True):
            start = q(row + step)
            start[free] = q(row)[free]
            starts.append(start)
        polished = [closure.polished(start, free) for start in starts]
        wanted = [q(row + step) for row, step in zip(rows, steps, strict=True)]
        assert np.abs(np.array(polished) - wanted).max() < 1e-8
        return each(lambda start: closure.polished(start, free), np.array(starts), rounds)

    return {
        ONE_ROD: timed(closure_of(delta), delta.q, passive),
        SIX_RODS: timed(six.closure, lambda axes: six.q(delta, axes), six.passive),
    }
