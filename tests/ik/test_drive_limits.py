"""Limits of drives are kept by every solver: compared with all solutions of the same machine without them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from chainbuild import ChainbuildError, IkOptions, Robot
from tests.kit.machine_files import machine_file

LINEAR = "[limits]\nX = [-3000, 3000]\nY = [-3000, 3000]\nZ = [-3000, 3000]\n"
MACHINES = {
    # A_drive = 2·A + C/2: a sum of axes, searched by compiled code
    28: ("param[12] 2\nparam[11] 1\nparam[13] 1\nparam[14] 1\nparam[15] 2\nparam[16] 1\nparam[0] 1000000",
         "C = [-360, 360]\n[limits.drives]\nA = [-100, 100]\n"),
    59: ("param[6] 450000\nparam[0] 1000000", "[limits.drives]\nA = [-90, 120]\nC = [-40, 130]\n"),
    60: ("param[6] 500000\nparam[0] 1000000", "C = [-170, 90]\n[limits.drives]\nB = [-100, 60]\nC = [-120, 90]\n"),
    70: ("param[0] 1000000\nparam[8] 1\nparam[9] 1", "[limits.drives]\nB = [-45, 60]\nA = [-40, 50]\n"),
    # machine axes behind an affine axis map: compiled code does not know their limits
    76: ("param[5] 200000\nparam[6] 650000\nparam[0] 1000000",
         "A = [-90, 90]\n[limits.drives]\nA = [-40, 50]\nC = [-45, 60]\n"),
}  # fmt: skip
SLACK = 1e-6
POSES = 20
HELD = {70: {"CV": 25.0}}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("drives")


class Drawn:
    """A machine with poses drawn over the range of its axes, and what the drives permit of each."""

    def __init__(self, folder: Path, kin_typ: int) -> None:
        parameters, overlay = MACHINES[kin_typ]
        rows = "".join(f"trafo[0].{line}\n" for line in parameters.splitlines())
        path = machine_file(folder, f"trafo[0].id {kin_typ}\n{rows}Ende\n", LINEAR + overlay)
        self.robot, self.held = Robot.load(path), HELD.get(kin_typ)
        chain = self.robot.chain
        axes = tuple(replace(a, lower=a.range[0], upper=a.range[1], widest=None) for a in chain.axes)
        free = Robot(replace(chain, drive_limits=()).with_axes(axes))
        rng = np.random.default_rng(kin_typ)
        low, high = np.array([axis.range for axis in chain.axes]).T
        low[:3], high[:3] = -1000.0, 1000.0
        values = low + (high - low) * rng.random((POSES, len(low)))
        if self.held:
            values[:, 5] = self.held["CV"]
        self.poses = [free.fk(row) for row in values]
        found = [free.ik_all(T, held=self.held, windings=True).axes for T in self.poses]
        self.possible = np.array([any(map(self.permits, rows)) for rows in found])

    def permits(self, axes: np.ndarray) -> bool:
        """Whether axis values keep all limits, asked of the data and not of `Limits`."""
        try:
            drives = self.robot.drives(axes)
        except ChainbuildError:  # 76: the machine axes do not lean so far
            return False
        kept = all(one.lower - SLACK <= drives[one.axis] <= one.upper + SLACK for one in self.robot.chain.drive_limits)
        own = [axis.range for axis in self.robot.axes]
        return kept and all(low - SLACK <= v <= high + SLACK for v, (low, high) in zip(axes, own, strict=True))

    def judged(self, rows: list[np.ndarray | None]) -> tuple[int, int]:
        """Return how many possible poses have no answer; answers that break a limit fail at once."""
        for row in rows:
            assert row is None or self.permits(row), row
        solved = np.array([row is not None for row in rows])
        return int((self.possible & ~solved).sum()), int((solved & ~self.possible).sum())


@cache
def drawn(folder: Path, kin_typ: int) -> Drawn:
    return Drawn(folder, kin_typ)


def each(**options: object) -> Callable[[Drawn], list[np.ndarray | None]]:
    def solve(machine: Drawn) -> list[np.ndarray | None]:
        results = [machine.robot.ik(T, held=machine.held, **options) for T in machine.poses]  # type: ignore[arg-type]
        return [one.axes if one.success else None for one in results]

    return solve


def all_of(machine: Drawn) -> list[np.ndarray | None]:
    found = [machine.robot.ik_all(T, held=machine.held).axes for T in machine.poses]
    assert all(machine.permits(row) for rows in found for row in rows)
    return [rows[0] if len(rows) else None for rows in found]


def batch(machine: Drawn, times: int = 1) -> list[np.ndarray | None]:
    table = machine.robot.ik_batch(machine.poses * times, held=machine.held)
    return [table[n].axes if table[n].success else None for n in range(POSES)]


def path(machine: Drawn) -> list[np.ndarray | None]:
    table = machine.robot.ik_path(machine.poses, held=machine.held)
    return [table[n].axes if table[n].success else None for n in range(POSES)]


SOLVERS: dict[str, Callable[[Drawn], list[np.ndarray | None]]] = {
    "ik": each(),
    "ik plain": each(options=IkOptions(compiled=False)),
    "ik damped": each(solver="damped"),
    "ik analytic": each(solver="analytic"),
    "ik_all": all_of,
    "ik_batch": batch,
    "ik_batch, many": lambda machine: batch(machine, 10),
    "ik_path": path,
}


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("kin_typ", [28, 59, 60, pytest.param(70, marks=pytest.mark.slow), 76])
def test_every_solver_keeps_the_limits_of_drives(folder: Path, kin_typ: int, solver: str) -> None:
    machine = drawn(folder, kin_typ)
    assert machine.possible.any()
    assert machine.judged(SOLVERS[solver](machine)) == (0, 0)


@pytest.mark.parametrize("kin_typ", [28, 59, 60, 76])
def test_a_refusal_names_the_drive_and_its_value(folder: Path, kin_typ: int) -> None:
    machine = drawn(folder, kin_typ)
    refused = [T for T, possible in zip(machine.poses, machine.possible, strict=True) if not possible]
    for T in refused[:5]:
        found = machine.robot.ik(T)
        assert found.status == "limits"
        assert any(name.endswith("_drive") for name in found.violated)
        assert "_drive is " in found.reason or "_drive has no value there" in found.reason


def test_a_path_does_not_run_through_the_limit_of_a_drive(folder: Path) -> None:
    """76: the machine axis reaches its limit on the way, C and A are free to go on."""
    robot = drawn(folder, 76).robot
    poses = [robot.fk([0, 0, 0, 20.0, a]) for a in np.linspace(0.0, 80.0, 50)]
    table = robot.ik_path(poses, start=np.zeros(5))
    for n in range(len(poses)):
        assert not table[n].success or drawn(folder, 76).permits(table[n].axes)
    assert table[0].success
    assert not table[49].success
    assert table[49].violated == ("A_drive",) or "drive" in table[49].reason
