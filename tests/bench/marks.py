"""The marks of the benchmark, judged on one run: what was wanted, the worst machine, its value, met or not."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from tests.bench.branches import OURS, BranchRow
from tests.bench.loops import DELTA, FUNCTION, MANY, ONE, ONE_ROD, SERIAL, SIX_RODS
from tests.bench.measure import Row

REFERENCE = "roboticstoolbox ik_LM"
COMPILED, PLAIN = "chainbuild, compiled", "chainbuild, plain"
BEHIND = ("optik", "dynibo + restarts", "TRAC-IK (pytracik)", "pink (daqp)", "mink (daqp)")
FORWARD, COLD, PATH = "forward, NumPy", "inverse, cold, one core", "inverse along a path"

BLOCKS = ("clear block, straight axes", "clear block, line")


@dataclass
class Results:
    """Everything one run measured.

    Attributes:
        rows: Single poses.
        branches: All branches, a pose a call.
        arrays: All branches over arrays.
        batches: µs a pose by machine and kind, see `measure.batches`.
        refusals: ms by machine and kind, see `measure.refusals`.
        singular: Paths, largest step of an axis [deg], and worst ratio to the best possible, by machine.
        axes: Number of axes by machine.
        loops: µs by machine and kind, see `loops.loop_times`.
    """

    rows: list[Row] = field(default_factory=list)
    branches: list[BranchRow] = field(default_factory=list)
    arrays: list[BranchRow] = field(default_factory=list)
    batches: dict[str, dict[str, float]] = field(default_factory=dict)
    refusals: dict[str, dict[str, float]] = field(default_factory=dict)
    singular: dict[str, tuple[int, float, float]] = field(default_factory=dict)
    axes: dict[str, int] = field(default_factory=dict)
    loops: dict[str, dict[str, float]] = field(default_factory=dict)

    def row(self, machine: str, solver: str) -> Row | None:
        """Return what a solver did on a machine, or None where it was not there."""
        return next((row for row in self.rows if (row.machine, row.solver) == (machine, solver)), None)

    def compared(self, ours: str, theirs: str, value: Callable[[Row], float]) -> dict[str, float]:
        """Return by machine how many times their value ours is."""
        found = {}
        for machine in self.axes:
            us, them = self.row(machine, ours), self.row(machine, theirs)
            if us is not None and them is not None:
                found[machine] = value(us) / value(them)
        return found


@dataclass(frozen=True)
class Mark:
    """One mark: the machine that is farthest from it, its value with unit, and whether all machines meet it.

    None stands for what was not measured.
    """

    wanted: str
    machine: str
    value: str
    met: bool | None

    @property
    def answer(self) -> str:
        """Met, in a word."""
        return "not measured" if self.met is None else "yes" if self.met else "**no**"


def most(wanted: str, limit: float, values: dict[str, float], unit: str = "") -> Mark:
    """Return the mark that no machine may be above a limit."""
    if not values:
        return Mark(wanted, "", "", None)
    worst = max(values, key=lambda name: values[name])
    return Mark(wanted, worst, f"{values[worst]:.3g}{unit}", all(value <= limit for value in values.values()))


def least(wanted: str, limit: float, values: dict[str, float], unit: str = "") -> Mark:
    """Return the mark that no machine may be below a limit."""
    if not values:
        return Mark(wanted, "", "", None)
    worst = min(values, key=lambda name: values[name])
    return Mark(wanted, worst, f"{values[worst]:.5g}{unit}", all(value >= limit for value in values.values()))


def marks(results: Results) -> list[Mark]:
    """Return all marks of a run."""
    return [*single_marks(results), *plain_marks(results), *other_marks(results), *loop_marks(results)]


def single_marks(results: Results) -> Iterable[Mark]:
    """Yield the marks of the compiled solver on single poses and paths."""
    cold = results.compared(COMPILED, REFERENCE, lambda row: row.median)
    for count, word, limit in ((6, "six", 0.4), (7, "seven", 0.3)):
        some = {name: value for name, value in cold.items() if results.axes[name] == count}
        yield most(f"compiled, cold median ≤ {limit} × {REFERENCE}, {word} axes", limit, some, " ×")
    tails = results.compared(COMPILED, REFERENCE, lambda row: row.p95)
    yield most(f"compiled, cold 95 % ≤ a quarter of {REFERENCE}'s", 0.25, tails, " ×")
    paths = {}
    for name, batch in results.batches.items():
        them = results.row(name, REFERENCE)
        if them is not None and PATH in batch:
            paths[name] = batch[PATH] / them.warm
    yield most(f"path, a pose ≤ 0.5 × {REFERENCE} warm", 0.5, paths, " ×")
    for solver in (COMPILED, PLAIN):
        found = {row.machine: 100.0 * row.found for row in results.rows if row.solver == solver}
        yield least(f"{solver.split(', ')[1]}, found 100 % (a wrong answer is not found)", 100.0, found, " %")


def plain_marks(results: Results) -> Iterable[Mark]:
    """Yield the marks of the solver without a compiler."""
    cold = results.compared(PLAIN, REFERENCE, lambda row: row.median)
    yield most(f"plain, cold median ≤ 2.5 × {REFERENCE}", 2.5, cold, " ×")
    for peer in BEHIND:
        against = results.compared(PLAIN, peer, lambda row: row.median)
        yield most(f"plain, cold median ahead of {peer}", 1.0, against, " ×")


def other_marks(results: Results) -> Iterable[Mark]:
    """Yield the marks of batches, refusals and singular paths."""
    six = {name: batch for name, batch in results.batches.items() if results.axes[name] == 6}
    cold = {name: batch[COLD] for name, batch in six.items() if COLD in batch}
    yield most("batch, cold ≤ 12 µs a pose and core, six axes", 12.0, cold, " µs")
    forward = {name: batch[FORWARD] for name, batch in results.batches.items()}
    yield most("forward kinematics ≤ 0.7 µs a pose, NumPy", 0.7, forward, " µs")
    kinds = results.batches.items()
    blocks = {name: max(batch.get(kind, 0.0) for kind in BLOCKS) for name, batch in kinds if BLOCKS[0] in batch}
    yield most("path_report, a clear block ≤ 60 µs", 60.0, blocks, " µs")
    arrays = [row for row in results.arrays if row.solver == OURS]
    yield most("all branches over arrays ≤ 0.5 µs a pose", 0.5, {row.machine: row.median for row in arrays}, " µs")
    wrong: dict[str, float] = {}
    for row in (*results.branches, *results.arrays):
        if row.solver.startswith("chainbuild"):
            wrong[row.machine] = wrong.get(row.machine, 0.0) + row.wrong
    yield most("all branches: none wrong", 0.0, wrong)
    slowest = {name: max(kinds.values()) for name, kinds in results.refusals.items()}
    yield most("refusal ≤ 1 ms, median", 1.0, slowest, " ms")
    ratios = {name: ratio for name, (_, _, ratio) in results.singular.items()}
    yield most("through a wrist singularity ≤ 1.3 × the least possible step", 1.3, ratios, " ×")


def loop_marks(results: Results) -> Iterable[Mark]:
    """Yield the marks of closed loops, all of one run."""
    delta = results.loops.get(DELTA, {})
    for kind, limit in ((ONE_ROD, 60.0), (SIX_RODS, 90.0), (FUNCTION, 2.0)):
        found = {DELTA: delta[kind]} if kind in delta else {}
        yield most(f"closed loops, {kind} ≤ {limit:g} µs", limit, found, " µs")
    serial = results.loops.get(SERIAL, {}).get(ONE)
    others = {name: times for name, times in results.loops.items() if name != SERIAL}
    ratios = {} if serial is None else {name: times[ONE] / serial for name, times in others.items()}
    yield most(f"closed loops, fk no slower than that of {SERIAL} (1.1 ×: noise)", 1.1, ratios, " ×")
    yield most("closed loops, fk_batch ≤ 0.6 µs a pose", 0.6, {name: t[MANY] for name, t in others.items()}, " µs")
