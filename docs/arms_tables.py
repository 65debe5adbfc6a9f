"""The tables of arms.md and the line of README.md from what `make bench-arms` has measured."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

FILE = Path(__file__).parent.parent / "tests/bench/arms.json"
OURS, PEER = "chainbuild", "ssik"
Row = dict[str, Any]


def report() -> Row:
    """Return what was measured."""
    found: Row = json.loads(FILE.read_text("utf-8"))
    return found


def classes(rows: Sequence[Row]) -> list[tuple[str, bool, str]]:
    """Return the classes in the order in which they were measured, nominal arms first."""
    found = dict.fromkeys((row["family"], row["calibrated"], row["kind"]) for row in rows)
    return sorted(found, key=lambda key: key[1])


def by_class(rows: Sequence[Row]) -> dict[tuple[str, bool, str], dict[str, Row]]:
    """Return the rows of each class by solver."""
    return {
        key: {row["solver"]: row for row in rows if (row["family"], row["calibrated"], row["kind"]) == key}
        for key in classes(rows)
    }


def solvers(rows: Sequence[Row]) -> list[str]:
    """Return the names of all solvers."""
    return list(dict.fromkeys(row["solver"] for row in rows))


def head(key: tuple[str, bool, str]) -> list[str]:
    """Return the cells that name a class."""
    family, calibrated, kind = key
    return [f"{family}, calibrated" if calibrated else family, kind]


def missed() -> tuple[list[str], list[list[str]]]:
    """Return branches missed and rows wrong, of how many, for each class and solver."""
    rows = report()["rows"]
    names = solvers(rows)
    lines = []
    for key, found in by_class(rows).items():
        cells = []
        for name in names:
            row = found.get(name)
            if row is None:
                cells.append("")
                continue
            more = [f"{row['wrong']:,} wrong"] if row["wrong"] else []
            more += [f"{row['nothing']:,} poses without an answer"] if row["nothing"] else []
            cells.append(", ".join([f"{row['missed']:,} of {row['isolated']:,}", *more]))
        lines.append([*head(key), *cells])
    return ["arms", "poses", *names], lines


def times() -> tuple[list[str], list[list[str]]]:
    """Return median and 95 % [µs] for each class and solver; ssik also as a multiple of chainbuild at its poses."""
    rows = report()["rows"]
    names = solvers(rows)
    lines = []
    for key, found in by_class(rows).items():
        cells = [f"{found[n]['median']:,.0f} / {found[n]['p95']:,.0f}" if n in found else "" for n in names]
        peer = found.get(PEER)
        ratio = f"{peer['median'] / peer['ours_median']:.2f} / {peer['p95'] / peer['ours_p95']:.2f}" if peer else ""
        lines.append([*head(key), *cells, ratio])
    return ["arms", "poses", *names, "ssik : chainbuild"], lines


def run() -> str:
    """Return when, where and with what it was measured, and what was wanted."""
    found = report()
    rows = found["rows"]
    versions = ", ".join(f"{name} {number}" for name, number in found["versions"].items())
    poses = sum(row["poses"] for row in rows if row["solver"] == OURS)
    alone = 100.0 * found["alone"] / isolated(rows)
    return (
        f"{found['date']}, {found['computer']}, one core, {found['minutes']:g} minutes; {versions}. {found['arms']}"
        f" arms, nominal and calibrated, {found['poses_each']} poses of each kind: {poses:,} poses,"
        f" {isolated(rows):,} isolated branches, of which random starts alone found {alone:.2f} %."
        f" {found['touching']:,} poses have solutions beside these that are not isolated.\n\n{verdict()}\n"
    )


def isolated(rows: Sequence[Row]) -> int:
    """Return the number of isolated branches."""
    return sum(row["isolated"] for row in rows if row["solver"] == OURS)


def verdict() -> str:
    """Return how chainbuild did: branches missed, rows wrong, classes in which it is quicker than ssik."""
    rows = report()["rows"]
    mine = [row for row in rows if row["solver"] == OURS]
    theirs = [row for row in rows if row["solver"] == PEER]
    lacks, wrong = (sum(row[word] for row in mine) for word in ("missed", "wrong"))
    median, tail = (sum(row[f"ours_{word}"] < row[word] for row in theirs) for word in ("median", "p95"))
    return (
        f"chainbuild's `ik_all` misses {lacks:,} of {isolated(rows):,} isolated branches and returns {wrong:,} wrong"
        f" ones; it is quicker than ssik in the median of {median} and in the 95 % of {tail} of {len(theirs)} classes"
        " of arms and poses."
    )


def line() -> str:
    """Return the line of the README."""
    return (
        f"All branches of the {report()['arms']} six-axis arms of ssik, nominal and calibrated, at random, right-angled"
        f" and near-singular poses ([every class, every solver](docs/arms.md), `make bench-arms`): {verdict()}\n"
    )
