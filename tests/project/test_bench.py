"""What the benchmark makes of its numbers: marks are judged from one run, peers that are missing are named."""

from __future__ import annotations

import builtins
import json
import runpy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.bench import branches, peers
from tests.bench.branches import OURS, BranchRow, judged, one_by_one, over_arrays
from tests.bench.loops import DELTA, FUNCTION, MANY, ONE, ONE_ROD, SERIAL, SIX_RODS, loop_times
from tests.bench.machines import Machine, machines
from tests.bench.marks import BLOCKS, COMPILED, PATH, PLAIN, REFERENCE, Mark, Results, marks
from tests.bench.measure import Row
from tests.bench.tables import mark_table, page
from tests.kit.paths import ROOT


@pytest.fixture(scope="module")
def kuka(tmp_path_factory: pytest.TempPathFactory) -> Machine:
    return next(m for m in machines(tmp_path_factory.mktemp("urdf")) if m.name == "kr6r900")


def results(**changed: float) -> Results:
    """Return the results of two machines, six and seven axes, that meet every mark; values of the second changed."""
    found = Results(axes={"six": 6, "seven": 7})
    for name in found.axes:
        values = {
            "median": 10.0,
            "p95": 20.0,
            "found": 1.0,
            "plain": 90.0,
            "path": 2.0,
            "block": 40.0,
            "refusal": 0.5,
            "singular": 1.1,
        }
        values |= changed if name == "seven" else {}
        found.rows += [
            Row(name, REFERENCE, 50.0, 100.0, 1.0, 0, 10.0),
            Row(name, COMPILED, values["median"], values["p95"], values["found"], 0, 9.0),
            Row(name, PLAIN, values["plain"], 300.0, 1.0, 0, 50.0),
            Row(name, "optik", 100.0, 300.0, 1.0, 0, 50.0),
        ]
        found.batches[name] = {"forward, NumPy": 0.3, "inverse, cold, one core": 11.0, PATH: values["path"]}
        found.batches[name] |= dict.fromkeys(BLOCKS, values["block"])
        found.refusals[name] = {"beyond reach": 0.2, "orientation impossible": values["refusal"]}
        found.singular[name] = (12, 30.0, values["singular"])
    found.loops = {
        DELTA: {ONE: 6.0, MANY: 0.2, ONE_ROD: 50.0, SIX_RODS: changed.get("six_rods", 80.0), FUNCTION: 1.2},
        "tripod": {ONE: changed.get("tripod", 6.5), MANY: changed.get("tripods", 0.3)},
        SERIAL: {ONE: 6.2, MANY: 0.9},
    }
    found.arrays = [BranchRow("six", OURS, 0.3, 5.0, 1.0, 0), BranchRow("six", "chainbuild, NumPy", 1.8, 5.0, 1.0, 0)]
    found.branches = [BranchRow("six", "chainbuild ik_all (spherical wrist)", 100.0, 5.0, 1.0, 0)]
    return found


def by_name(found: Results, start: str) -> Mark:
    (mark,) = [mark for mark in marks(found) if mark.wanted.startswith(start)]
    return mark


def test_marks_that_are_met_and_those_not_measured() -> None:
    answers = {mark.wanted: mark.met for mark in marks(results())}
    missing = [name for name, met in answers.items() if met is None]
    assert [name.rsplit(" of ")[-1] for name in missing] == [
        "dynibo + restarts",
        "TRAC-IK (pytracik)",
        "pink (daqp)",
        "mink (daqp)",
    ]
    assert all(met for met in answers.values() if met is not None)
    assert all(mark.met is None and mark.answer == "not measured" for mark in marks(Results()))


@pytest.mark.parametrize(
    ("change", "mark", "value"),
    [
        ({"median": 15.5}, "compiled, cold median ≤ 0.3", "0.31 ×"),
        ({"p95": 26.0}, "compiled, cold 95 %", "0.26 ×"),
        ({"path": 5.1}, "path, a pose", "0.51 ×"),
        ({"block": 61.0}, "path_report", "61 µs"),
        ({"found": 0.999}, "compiled, found", "99.9 %"),
        ({"plain": 126.0}, "plain, cold median ≤ 2.5", "2.52 ×"),
        ({"plain": 101.0}, "plain, cold median ahead of optik", "1.01 ×"),
        ({"refusal": 1.01}, "refusal", "1.01 ms"),
        ({"singular": 1.31}, "through a wrist singularity", "1.31 ×"),
    ],
)
def test_one_machine_that_misses_a_mark_is_named(change: dict[str, float], mark: str, value: str) -> None:
    assert by_name(results(), mark).met
    found = by_name(results(**change), mark)
    assert (found.met, found.machine, found.value) == (False, "seven", value)
    assert f"| seven | {value} | **no** |" in mark_table(results(**change))


@pytest.mark.parametrize(
    ("change", "mark", "machine", "value"),
    [
        ({"six_rods": 91.0}, "closed loops, Newton, six rods", DELTA, "91 µs"),
        ({"tripod": 7.0}, "closed loops, fk no slower", "tripod", "1.13 ×"),
        ({"tripods": 0.61}, "closed loops, fk_batch", "tripod", "0.61 µs"),
    ],
)
def test_marks_of_closed_loops(change: dict[str, float], mark: str, machine: str, value: str) -> None:
    assert by_name(results(), mark).met
    found = by_name(results(**change), mark)
    assert (found.met, found.machine, found.value) == (False, machine, value)


def test_closed_loops_are_timed() -> None:
    times = loop_times(many=200, rounds=1)
    assert set(times[DELTA]) == {ONE, MANY, ONE_ROD, SIX_RODS, FUNCTION}
    assert all(value > 0.0 for kinds in times.values() for value in kinds.values())
    assert times[DELTA][FUNCTION] < times[DELTA][ONE]
    assert "| delta_kin37 | 6.00 µs | 0.20 µs |" in page(results(), 10, 1, 100)


def test_six_and_seven_axes_have_marks_of_their_own() -> None:
    found = results(median=19.0)  # 0.38: enough for six axes
    assert by_name(found, "compiled, cold median ≤ 0.4").met
    assert by_name(found, "compiled, cold median ≤ 0.3").met is False


def test_a_wrong_branch_misses_its_mark() -> None:
    found = results()
    found.branches.append(BranchRow("seven", "chainbuild ik_all (three parallel axes)", 100.0, 5.0, 1.0, 2))
    assert by_name(found, "all branches: none wrong") == Mark("all branches: none wrong", "seven", "2", False)
    assert "5.00, 2 wrong" in page(found, 10, 1, 100)


def test_branches_are_judged_by_forward_kinematics(kuka: Machine) -> None:
    axes = kuka.axes(20, seed=0)
    targets = list(kuka.robot.fk_batch(axes))
    right = [kuka.robot.q(row)[None] for row in axes]
    assert judged(kuka, "it", 1.0, targets, right).wrong == 0
    off = [q + np.array([0.0, 0.0, 0.0, 0.0, 0.0, 3e-6]) for q in right]
    row = judged(kuka, "it", 1.0, targets, off)
    assert (row.wrong, row.found, row.branches) == (20, 0.0, 0.0)
    turned = [q + 2.0 * np.pi * np.eye(6)[0] for q in right]
    assert judged(kuka, "it", 1.0, targets, turned).found == 1.0


def test_closed_forms_find_the_same_branches(kuka: Machine) -> None:
    rows = [*one_by_one(kuka, 30), *over_arrays(kuka, 300)]
    assert [row.solver for row in rows] == [
        "chainbuild ik_all (spherical wrist)",
        "chainbuild ik_all_batch, compiled, of one pose",
        "EAIK",
        "py-opw-kinematics",
        "chainbuild, compiled",
        "chainbuild, NumPy",
        "py-opw-kinematics (reach, one thread)",
    ]
    assert all(row.found == 1.0 and row.wrong == 0 for row in rows)
    assert len({row.branches for row in rows[:4]}) == len({row.branches for row in rows[4:]}) == 1


def test_missing_peers_are_named(
    kuka: Machine, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    real = builtins.__import__
    gone = {"mink", "pink", "eaik", "py_opw_kinematics", "roboticstoolbox", "optik", "dynibo", "trac_ik"}

    def without(name: str, *rest: object) -> object:
        if name.partition(".")[0] in gone:
            raise ImportError(name=name)
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    assert [name for name, _ in peers.solvers(kuka)] == [COMPILED, PLAIN]
    assert all(name.startswith("chainbuild") for name, _ in branches.solvers(kuka))
    said = capsys.readouterr().out
    assert all(f"({name} is not installed)" in said for name in gone)


def test_an_unknown_machine_is_refused(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tests.bench", "--machine", "nothing", "-o", str(tmp_path / "r.md")]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert ended.returncode == 2 and "there is no machine nothing" in ended.stderr


def test_the_readme_leaves_cells_empty_where_a_solver_did_not_run(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [
        {"machine": "one", "solver": REFERENCE, "median": 50.0, "found": 1.0},
        {"machine": "two", "solver": REFERENCE, "median": 40.0, "found": 1.0},
        {"machine": "two", "solver": "mink (daqp)", "median": 80.0, "found": 0.995},
    ]
    generate = runpy.run_path(str(ROOT / "docs/generate.py"))
    monkeypatch.setattr(json, "loads", lambda _: rows)
    assert "| mink (daqp) |  | 2.00, 99.5 % |" in generate["solvers"]()
