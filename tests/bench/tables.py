"""The page of the benchmark."""

from __future__ import annotations

import platform

from tests.bench.branches import BranchRow
from tests.bench.loops import FUNCTION, MANY, ONE, ONE_ROD, SIX_RODS
from tests.bench.marks import BLOCKS, REFERENCE, Results, marks
from tests.bench.measure import Row


def page(results: Results, count: int, rounds: int, many: int) -> str:
    """Return the whole page."""
    parts = [head(count, rounds), mark_table(results), solver_table(results.rows)]
    return "\n".join((*parts, branch_tables(results, many), other_tables(results, many), loop_table(results)))


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


def mark_table(results: Results) -> str:
    """Return the table of marks met and not met."""
    rows: list[tuple[object, ...]] = [(m.wanted, m.machine, m.value, m.answer) for m in marks(results)]
    return "## Marks\n\n" + markdown(("mark", "worst machine", "value", "met"), rows)


def solver_table(rows: list[Row]) -> str:
    """Return the table of solvers: cold, warm, found; times as ratios to the reference where it is there."""
    cells: list[tuple[object, ...]] = []
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


def branch_tables(results: Results, many: int) -> str:
    """Return the tables of all branches."""
    columns = ("machine", "solver", "a pose", "branches inside the limits", "poses with one")
    return "\n".join(
        (
            "## All branches of a pose, one call each, median\n",
            markdown(columns, [branch_cells(row, 1) for row in results.branches]),
            f"## All branches of {many} poses in one call: processor time of one core, a pose\n",
            markdown(columns, [branch_cells(row, 2) for row in results.arrays]),
        )
    )


def branch_cells(row: BranchRow, digits: int) -> tuple[object, ...]:
    """Return a row of a table of branches; wrong ones keep the limits and miss the pose."""
    wrong = f", {row.wrong} wrong" if row.wrong else ""
    share = f"{100 * row.found:.1f} %"
    return row.machine, row.solver, f"{row.median:.{digits}f} µs", f"{row.branches:.2f}{wrong}", share


def other_tables(results: Results, many: int) -> str:
    """Return the tables of batches, refusals and singular paths."""
    kinds = ("forward, NumPy", "inverse, cold, one core", "inverse along a path", *BLOCKS)
    batches: list[tuple[object, ...]] = [
        (name, *(f"{batch[kind]:.2f} µs" if kind in batch else "" for kind in kinds))
        for name, batch in results.batches.items()
    ]
    refusals: list[tuple[object, ...]] = [
        (name, *(f"{value:.2f} ms" for value in found.values())) for name, found in results.refusals.items()
    ]
    paths: list[tuple[object, ...]] = [
        (name, count, f"{largest:.1f}°", f"{ratio:.2f}") for name, (count, largest, ratio) in results.singular.items()
    ]
    return "\n".join(
        (
            f"## Batches of {many} poses, a pose\n",
            markdown(("machine", *kinds), batches),
            "## Refusing what cannot be reached, median, with the reason and the nearest pose\n",
            markdown(("machine", "beyond reach", "orientation impossible"), refusals),
            "## Lines of the tool through a wrist singularity, against a search over all branches\n",
            markdown(("machine", "paths", "largest step of an axis", "worst ratio to the best possible"), paths),
        )
    )


def loop_table(results: Results) -> str:
    """Return the table of closed loops, a serial arm among them."""
    kinds = (ONE, MANY, FUNCTION, ONE_ROD, SIX_RODS)
    rows: list[tuple[object, ...]] = [
        (name, *(f"{times[kind]:.2f} µs" if kind in times else "" for kind in kinds))
        for name, times in results.loops.items()
    ]
    return "## Closed loops, a pose; Newton from 0.1 to 2 degrees away\n\n" + markdown(("machine", *kinds), rows)
