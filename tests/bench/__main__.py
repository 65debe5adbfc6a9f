"""Run the benchmarks and write results.md and .json: `python -m tests.bench [--quick] [--machine NAME]`."""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path

import numpy as np

from chainbuild.ik.search.compiled import packing as compiled
from tests.bench.branches import one_by_one, over_arrays
from tests.bench.loops import loop_times
from tests.bench.machines import Machine, machines
from tests.bench.marks import Results, marks
from tests.bench.measure import batches, compare, refusals
from tests.bench.singular import largest_steps
from tests.bench.tables import page

SINGULAR = ("KR 6 R700", "kr6r900", "tx2_60")


def main() -> int:
    """Measure everything and write the tables."""
    options = parser().parse_args()
    count, rounds, many = (200, 1, 5_000) if options.quick else (1000, 5, 100_000)
    if not compiled.available():
        print("numba is not installed: the compiled path is measured as the plain one")
    results = Results()
    with tempfile.TemporaryDirectory() as folder:
        found = [m for m in machines(Path(folder)) if not options.machine or m.name in options.machine]
        if not found:
            print(f"there is no machine {', '.join(options.machine)}", file=sys.stderr)
            return 2
        for machine in found:
            results.axes[machine.name] = len(machine.robot.axes)
            print(f"single poses: {machine.name}", file=sys.stderr)
            results.rows += compare(machine, count, rounds)
        for machine in found:
            print(f"branches, batches, refusals, paths: {machine.name}", file=sys.stderr)
            measure_others(results, machine, count, many)
    if not options.machine:
        print("closed loops", file=sys.stderr)
        results.loops = loop_times(many // 5)
    options.output.write_text(page(results, count, rounds, many), "utf-8")
    rows = json.dumps([asdict(row) for row in results.rows], indent=1)
    options.output.with_suffix(".json").write_text(rows + "\n", "utf-8")
    print(f"wrote {options.output}")
    missed = [mark.wanted for mark in marks(results) if mark.met is False]
    print("\n".join(("marks not met:", *missed)) if missed else "every mark that was measured is met")
    return 0


def parser() -> argparse.ArgumentParser:
    """Return the command line."""
    found = argparse.ArgumentParser(prog="python -m tests.bench", description=__doc__)
    found.add_argument("--quick", action="store_true", help="fewer targets and rounds")
    found.add_argument("--machine", action="append", help="only this machine; may be given several times")
    found.add_argument("-o", "--output", type=Path, default=Path(__file__).parent / "results.md")
    return found


def measure_others(results: Results, machine: Machine, count: int, many: int) -> None:
    """Measure all branches, batches, refusals and singular paths of a machine."""
    results.branches += one_by_one(machine, count)
    results.arrays += over_arrays(machine, many)
    results.batches[machine.name] = batches(machine, many)
    results.refusals[machine.name] = refusals(machine)
    if machine.name in SINGULAR:
        ours, best = (np.array(steps) for steps in largest_steps(machine))
        results.singular[machine.name] = len(ours), float(ours.max()), float((ours / best).max())


if __name__ == "__main__":
    sys.exit(main())
