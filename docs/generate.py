"""Write the generated tables of README.md and docs/; `make docs`. A test checks that they have not drifted.

A table stands between `<!-- table: NAME -->` and `<!-- end -->`; everything else of a page is written by hand.
"""

from __future__ import annotations

import json
import re
import runpy
import sys
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import chainbuild
from chainbuild.convention import Choices, conventions
from chainbuild.findings import finding_kinds
from chainbuild.formats.twincat.recipes.recipe import Params
from chainbuild.formats.twincat.types.displays import display_of
from chainbuild.ik.plan import plan_of

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT / "docs"))
import json_tables  # noqa: E402
import machine_pictures  # noqa: E402

_DOCS = ("arms", "branches", "conventions", "findings", "json", "kinematics", "machines", "robx", "tables")
PAGES = ("README.md", *(f"docs/{name}.md" for name in _DOCS))
_COLUMNS = 2  # of the contact sheet: two machines with two pictures each fit a page
_WIDTH = 200  # pixels of its pictures
_ALONE = 300  # pixels of a picture that stands alone
_BLOCK = re.compile(r"(<!-- table: (?P<name>[\w-]+) -->\n).*?(<!-- end -->)", re.DOTALL)


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a Markdown table."""
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += [
        "| " + " | ".join(str(cell).replace("|", "\\|").replace("\n", " ") for cell in row) + " |" for row in rows
    ]
    return "\n".join(lines) + "\n"


def machines() -> str:
    """Return the contact sheet of the shipped machines."""
    cells = []
    for name in chainbuild.shipped():
        machine = chainbuild.load(name)
        entry = machine.kinematics()[0]
        axes = " ".join(axis.name for axis in machine.chain().axes)
        files = [path for path in machine_pictures.of_machine(name) if (ROOT / "docs" / path).exists()]
        pictures = "".join(f'<img src="{path}" alt="{machine.title}" width="{_WIDTH}">' for path in files)
        text = f"<b><code>{name}</code></b><br>{machine.title}<br>{entry.type}<br>{axes}"
        cells.append(f'<td align="center" valign="top">{pictures}<br>{text}</td>')
    rows = [cells[n : n + _COLUMNS] for n in range(0, len(cells), _COLUMNS)]
    return "<table>\n" + "".join("<tr>\n" + "\n".join(row) + "\n</tr>\n" for row in rows) + "</table>\n"


def types() -> str:
    """Return the table of KIN_TYPs."""
    rows = []
    for number, entry in chainbuild.catalogue().items():
        title = f"[{entry.title}](coupling.md)" if entry.listed else entry.title
        axes = " ".join(axis.name for axis in entry.axes) or ("as listed" if entry.listed else "")
        orientation = "as listed" if entry.orientation == "listed" else entry.orientation
        rows.append((number, title, entry.family, axes, orientation, entry.manual))
    return table(("KIN_TYP", "title", "family", "axes in channel order", "orientation", "source"), rows)


def displays() -> str:
    """Return what each KIN_TYP displays beside the position, types with the same in one row."""
    groups: dict[tuple[str, str, str], list[int]] = {}
    for number, entry in chainbuild.catalogue().items():
        if entry.listed:
            continue
        params = Params(entry.data)
        display = display_of(params, params.axes, "ypr", Choices())
        names = [axis.name for axis in params.axes]
        by_axes = display.kind == "axes" and not display.columns
        columns = [names[n] for n in display.axes] if by_axes else list(display.columns)
        shown = ", ".join(f"`{column}`" for column in columns) or "nothing"
        # A table's axes beside struts: the struts are linear axes, but not along the coordinates.
        beside_struts = entry.family == "parallel"
        if by_axes and not beside_struts and all(params.axes[n].kind == "linear" for n in display.solved):
            shown = "its rotary axes by name" if columns else shown
            solved = "the linear axes alone, exactly"
        else:
            solved = ", ".join(names[n] for n in display.solved) or "all axes"
        shown += "; y_mm may be left out" if display.plane_xz else ""
        groups.setdefault((shown, solved, "the side of the start" if display.keeps_side else ""), []).append(number)
    rows = [(", ".join(map(str, numbers)), *words) for words, numbers in groups.items()]
    return table(("KIN_TYP", "beside x_mm, y_mm, z_mm", "`ik` solves for", "keeps"), rows)


def type_parameters() -> str:
    """Return one table of parameters for each KIN_TYP."""
    parts = []
    for number, entry in sorted(chainbuild.catalogue().items()):
        rows = [(f"HD{r.n}", f"`{r.name}`", r.unit or r.kind, f"{r.default:g}", r.effect, r.meaning) for r in entry.hd]
        parts.append(f"\n### KIN_TYP {number}: {entry.title}\n\n{entry.summary}\n")
        if (picture := machine_pictures.of_type(number)) is not None:
            parts.append(f'<img src="{picture}" alt="KIN_TYP {number}" width="{_ALONE}">\n')
        if rows:
            parts.append(table(("HD", "name", "unit", "default", "acts on", "meaning"), rows))
    return "\n".join(parts)


def convention_table() -> str:
    """Return every convention with its choices."""
    parts = []
    for name, c in sorted(conventions().items()):
        choices = "\n".join(
            f"- `{choice}`{' (default)' if choice == c.default else ''}: {meaning}"
            for choice, meaning in c.choices.items()
        )
        mark = "inferred" if c.mark == "I" else "open"
        parts.append(
            f"### `{name}`\n\n{c.question} ({mark}; {', '.join(c.applies)}; {c.source})\n\n{choices}\n\n"
            f"Why {'the' if c.default else 'no'} default: {c.why}\n\nHow to verify: {c.verify}\n"
        )
    return "\n".join(parts)


def findings() -> str:
    """Return the register of findings."""
    kinds = sorted(finding_kinds().values(), key=lambda kind: kind.code)
    told = {"named": "in full", "counted": "counted", "listed": ""}
    rows = ((k.code, k.severity, k.title, "refused" if k.severity == "error" else told[k.told]) for k in kinds)
    return table(("number", "severity", "meaning", "other commands"), rows)


def robx_combinations() -> str:
    """Return what becomes of every arrangement, number of axes and wrist of the ROBX transformation."""
    rows = runpy.run_path(str(ROOT / "docs/robx_combinations.py"))["rows"]
    return table(("MAIN_AXES", "axis 4 to the last rotary basic axis", "4 axes", "5 axes", "6 axes"), rows())


def solvers() -> str:
    """Return the table of inverse kinematics against its peers, as `make bench` measured it."""
    rows = json.loads((ROOT / "tests/bench/results.json").read_text("utf-8"))
    names = list(dict.fromkeys(row["machine"] for row in rows))
    base = {row["machine"]: row["median"] for row in rows if row["solver"] == "roboticstoolbox ik_LM"}
    cells: dict[str, dict[str, str]] = {}
    for row in rows:
        found = "" if row["found"] == 1.0 else f", {100 * row['found']:.1f} %"
        ratio = row["median"] / base[row["machine"]]
        cells.setdefault(row["solver"], {})[row["machine"]] = f"{ratio:.2f}{found}"
    # A solver that does not take a machine leaves its cell empty.
    return table(("cold, median", *names), [(name, *(row.get(m, "") for m in names)) for name, row in cells.items()])


def methods() -> str:
    """Return which shipped machines `ik_all` answers by which method."""
    found: dict[str, list[str]] = {}
    for name in chainbuild.shipped():
        found.setdefault(plan_of(chainbuild.Robot.load(name)).name, []).append(f"`{name}`")
    note = {"search": "search, unless axes are held"}
    return table(
        ("method", "machines"), ((note.get(method, method), ", ".join(names)) for method, names in found.items())
    )


def robx_methods() -> str:
    """Return by which method `ik_all` answers for every arrangement of the ROBX transformation."""
    rows = runpy.run_path(str(ROOT / "docs/robx_combinations.py"))["method_rows"]
    return table(("MAIN_AXES", "axis 4 to the last rotary basic axis", "4 axes", "5 axes", "6 axes"), rows())


def arms(part: str) -> str:
    """Return a part of what `make bench-arms` has measured: every branch of many arms, every solver side by side."""
    found = runpy.run_path(str(ROOT / "docs/arms_tables.py"))[part]()
    return found if isinstance(found, str) else table(*found)


TABLES: dict[str, Callable[[], str]] = {
    "machines": machines,
    "types": types,
    "displays": displays,
    "type-parameters": type_parameters,
    "conventions": convention_table,
    "findings": findings,
    "robx-combinations": robx_combinations,
    "solvers": solvers,
    "methods": methods,
    "robx-methods": robx_methods,
    "arms-run": lambda: arms("run"),
    "arms-missed": lambda: arms("missed"),
    "arms-times": lambda: arms("times"),
    "arms-line": lambda: arms("line"),
    "json": lambda: json_tables.json_documents(table),
}


def filled(text: str) -> str:
    """Return a page with its tables made anew."""
    return _BLOCK.sub(lambda match: match[1] + "\n" + TABLES[match["name"]]() + "\n" + match[3], text)


def main() -> int:
    """Write all pages and pictures."""
    machine_pictures.write_all()
    for page in PAGES:
        path = ROOT / page
        path.write_text(filled(path.read_text("utf-8")), "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
