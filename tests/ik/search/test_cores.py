"""Rows on all cores: every row once, errors passed on, calls from two threads at once."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import numpy as np
import pytest

pytest.importorskip("numba")

import numba

import chainbuild
from chainbuild.ik.search.compiled.cores import on_all_cores
from tests.kit.draws import random_axes
from tests.kit.robots import arm


@pytest.mark.parametrize("cores", [1, 3])
@pytest.mark.parametrize("count", [0, 1, 7, 8, 20])
def test_every_row_is_written_once(monkeypatch: pytest.MonkeyPatch, count: int, cores: int) -> None:
    monkeypatch.setattr(numba.config, "NUMBA_NUM_THREADS", cores)
    written = np.zeros(count, int)

    def write(part: slice) -> None:
        assert part.stop - part.start <= 7
        written[part] += 1

    on_all_cores(write, count, 7)
    assert (written == 1).all()


def test_as_many_cores_as_numba_may_take(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba.config, "NUMBA_NUM_THREADS", 3)
    together = Barrier(3, timeout=20.0)  # passed only by three calls at once
    on_all_cores(lambda _: together.wait(), 3, 1)


def test_what_a_call_raises_is_raised(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba.config, "NUMBA_NUM_THREADS", 2)
    with pytest.raises(ZeroDivisionError):
        on_all_cores(lambda part: 1 // (part.start - 4), 8, 2)


def test_threads_of_the_caller_may_solve_at_once() -> None:
    robot, rng = arm(), np.random.default_rng(3)
    targets = robot.fk_batch(np.array([random_axes(robot, rng) for _ in range(700)]))
    alone, every = robot.ik_batch(targets).axes, chainbuild.ik_all_batch(robot, targets)
    with ThreadPoolExecutor(4) as threads:
        tables = [threads.submit(robot.ik_batch, targets) for _ in range(4)]
        branches = [threads.submit(chainbuild.ik_all_batch, robot, targets) for _ in range(4)]
    for table, found in zip(tables, branches, strict=True):
        np.testing.assert_array_equal(table.result().axes, alone)
        np.testing.assert_array_equal(found.result(), every)
