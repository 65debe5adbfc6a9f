"""Run the benchmarks and write tests/bench/results.md and .json: `python -m tests.bench [--quick]`."""

from __future__ import annotations

import argparse
import json
import platform
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path

import numpy as np

from chainbuild.solve import compiled
from tests.bench.machines import Machine, machines
from tests.bench.measure import Row, batches, compare, refusals
from tests.bench.singular import largest_steps

REFERENCE = "roboticstoolbox ik_LM"
SINGULAR = ("KR 6 R700", "kr6r900", "tx2_60")


def main() -> int:
    """Measure everything and write the tables."""
    parser = argparse.ArgumentParser(prog="python -m tests.bench", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer targets and rounds")
    parser.add_argument("-o", "--output", type=Path, default=Path(__file__).parent / "results.md")
    options = parser.parse_args()
    count, rounds, many = (200, 1, 5_000) if options.quick else (1000, 5, 100_000)
    if not compiled.available():
        print("numba is not installed: the compiled path is measured as the plain one")
    parts = [head(count, rounds)]
    with tempfile.TemporaryDirectory() as folder:
        found = list(machines(Path(folder)))
        rows: list[Row] = []
        for machine in found:
            print(f"single poses: {machine.name}", file=sys.stderr)
            rows += compare(machine, count, rounds)
        parts += [solver_table(rows), other_tables(found, many)]
    options.output.write_text("\n".join(parts), "utf-8")
    options.output.with_suffix(".json").write_text(json.dumps([asdict(row) for row in rows], indent=1) + "\n", "utf-8")
    print(f"wrote {options.output}")
    return 0


def head(count: int, rounds: int) -> str:
    """Return what the numbers are."""
    return f"""# Benchmark

{count} random targets a machine over the whole range of its axes; an answer counts as found where Pinocchio meets the
pose within 1e-6 m and 1e-6 rad inside the limits. One run, one core, Python {platform.python_version()},
{platform.system()} {platform.machine()}; median of {rounds} rounds. Times vary with the computer: the ratios count.
"""


def markdown(columns: tuple[str, ...], rows: list[tuple[object, ...]]) -> str:
    """Return a Markdown table."""
    lines = ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def solver_table(rows: list[Row]) -> str:
    """Return the table of solvers: cold, warm, found; times as ratios to the reference where it is there."""
    cells = []
    reference = {row.machine: row for row in rows if row.solver == REFERENCE}
    for row in rows:
        base = reference.get(row.machine)

        def ratio(value: float, of: float | None) -> str:
            return f"{value:.0f} µs" if of is None else f"{value:.0f} µs ({value / of:.2f})"

        median, p95, warm = (None, None, None) if base is None else (base.median, base.p95, base.warm)
        share = f"{100 * row.found:.2f} %" + (f", {row.wrong} wrong" if row.wrong else "")
        times = (ratio(row.median, median), ratio(row.p95, p95), ratio(row.warm, warm))
        cells.append((row.machine, row.solver, *times, share))
    columns = ("machine", "solver", "cold, median", "cold, 95 %", "warm, median", "found")
    return f"## Single poses (in brackets: times that of {REFERENCE})\n\n" + markdown(columns, cells)


def other_tables(found: list[Machine], many: int) -> str:
    """Return the tables of batches, refusals and singular paths."""
    batch_rows, refusal_rows, path_rows = [], [], []
    for machine in found:
        print(f"batches, refusals, paths: {machine.name}", file=sys.stderr)
        if compiled.available():
            batch_rows.append((machine.name, *(f"{v:.2f} µs" for v in batches(machine, many).values())))
        refusal_rows.append((machine.name, *(f"{value:.2f} ms" for value in refusals(machine).values())))
        if machine.name in SINGULAR:
            ours, best = (np.array(steps) for steps in largest_steps(machine))
            path_rows.append((machine.name, len(ours), f"{ours.max():.1f}°", f"{(ours / best).max():.2f}"))
    return "\n".join(
        (
            f"## Batches of {many} poses, a pose\n",
            markdown(("machine", "forward, NumPy", "inverse, cold, one core", "inverse along a path"), batch_rows),
            "## Refusing what cannot be reached, median, with the reason and the nearest pose\n",
            markdown(("machine", "beyond reach", "orientation impossible"), refusal_rows),
            "## Lines of the tool through a wrist singularity, against a search over all branches\n",
            markdown(("machine", "paths", "largest step of an axis", "worst ratio to the best possible"), path_rows),
        )
    )


if __name__ == "__main__":
    sys.exit(main())
