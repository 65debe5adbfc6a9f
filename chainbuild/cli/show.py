"""What commands print: tables for people, JSON for programs, warnings and progress on stderr."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TextIO

from rich import box
from rich.console import Console
from rich.table import Table as RichTable
from rich.text import Text

from chainbuild.cli.process import check_interrupt
from chainbuild.errors import ChainbuildError
from chainbuild.files import open_atomic, printable
from chainbuild.findings import Collector, Finding, finding_kinds
from chainbuild.progress import DUMB, Item, above_bars, bars_shown, counting, without_bars

if TYPE_CHECKING:
    from chainbuild.chain.bodies.geometry import Geometry
    from chainbuild.chain.elements import Chain
    from chainbuild.tables.reader import Table

STDOUT: Final = Path("-")  # of an output
_WIDTH_WITHOUT_TERMINAL: Final = 200  # characters: rows of a log file are not folded
_ROWS_BETWEEN_UPDATES: Final = 256  # to ask for the place in the file at every row would cost more than the row
_NOT_FORCED: Final = ("", "0", "false", "no")  # values of FORCE_COLOR that force nothing
_COLOURS: Final = {"error": "bold red", "warning": "yellow", "info": "dim"}


class _Console(Console):
    """A console that escapes control characters and leaves a closed pipe to the caller."""

    def render_str(self, text: str, **options: Any) -> Text:
        """Return a text for the terminal, on one line: a `lines_shown` may have several."""
        return super().render_str(printable(text, lines=False), **options)

    def print(self, *objects: Any, **options: Any) -> None:
        """Print, a bar out of the way."""
        with above_bars():
            super().print(*objects, **options)

    def on_broken_pipe(self) -> None:
        """Go on as `print` does, where rich would end the process with 1."""
        raise BrokenPipeError


def console(stream: TextIO | None = None) -> Console:
    """Return a console that prints text literally: brackets in machine data are no markup, escapes no commands."""
    target = stream or sys.stdout
    wide = None if target.isatty() or "COLUMNS" in os.environ else _WIDTH_WITHOUT_TERMINAL
    return _Console(file=target, width=wide, markup=False, highlight=False, emoji=False, **colours_of(target))


def help_console() -> Console:
    """Return the console on which the parser prints help and the version."""
    return Console(**colours_of(sys.stdout))


def colours_of(stream: TextIO) -> dict[str, Any]:
    """Return whether rich may use colours and other styles on a stream, as arguments of its console.

    NO_COLOR, whatever it is, wins; then TERM=dumb; then FORCE_COLOR, by which a file or pipe gets them, too; else a
    terminal does.
    """
    wanted = os.environ.get("FORCE_COLOR", "").lower() not in _NOT_FORCED
    plain = bool(os.environ.get("NO_COLOR")) or os.environ.get("TERM", "") in DUMB or not (wanted or stream.isatty())
    # Without a colour system rich writes no escape sequence at all, not even for bold.
    return {"force_terminal": not plain, "color_system": None if plain else "auto"}


def empty_table(title: str, *columns: str) -> RichTable:
    """Return an empty table that wraps long cells."""
    result = RichTable(
        title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0)
    )
    for column in columns:
        result.add_column(column, overflow="fold")
    return result


def shown_number(value: float | str | None) -> str:
    """Return a value of machine data as text."""
    if value is None:
        return "–"
    return f"{value:.10g}" if isinstance(value, float) else str(value)


def lines_shown(texts: Iterable[str]) -> Text:
    """Return texts for one cell of a table, one a line."""
    return Text("\n".join(printable(text, lines=False) for text in texts))


def say(text: object, end: str = "\n", *, lines: bool = False) -> None:
    """Print a line on stdout, or several, control characters escaped."""
    with above_bars():
        print(printable(str(text), lines=lines), end=end)


def print_json(name: str, data: Mapping[str, Any] | Sequence[Mapping[str, Any]]) -> None:
    """Print data as JSON on stdout, or several of a kind as an array; each says which schema describes it.

    Args:
        name: Name of the schema, a file of `data/schemas`.
        data: The data.
    """
    schema = {"schema": schema_id(name)}
    document = {**schema, **data} if isinstance(data, Mapping) else [{**schema, **one} for one in data]
    with above_bars():
        print(json.dumps(document, indent=2, allow_nan=False).replace("\x7f", "\\u007f"))


def schema_id(name: str) -> str:
    """Return the identifier of a schema with its version, such as ``chainbuild:info:1``."""
    text = resources.files("chainbuild").joinpath(f"data/schemas/{name}.json").read_text("utf-8")
    return str(json.loads(text)["$id"])


def finding_data(finding: Finding) -> dict[str, Any]:
    """Return a finding for JSON."""
    span = finding.span
    return {
        "code": finding.code,
        "severity": finding.severity,
        "text": finding.text,
        "file": span.file if span else None,
        "line": span.line or None if span else None,
        "column": span.column if span and span.line else None,
        "parameter": finding.parameter,
        "permitted": finding.permitted,
        "alarm": finding.alarm,
        "hint": finding.hint,
    }


def error_data(error: ChainbuildError) -> dict[str, Any]:
    """Return an error for JSON, with the keys of a finding."""
    collector = Collector(strict=False)
    collector.add_error(error)
    return finding_data(collector.findings[0])


def refusal_data(error: ChainbuildError, code: int) -> dict[str, Any]:
    """Return for JSON that a command ends with an error, and with which exit code."""
    data = error_data(error)
    # A wrong command line is no finding on a file.
    return {"refused": True, "exit_code": code, "error": data if code == 1 else {**data, "code": None}}


def print_findings(findings: Iterable[Finding]) -> None:
    """Print findings on stdout, one per line."""
    out = console()
    for finding in findings:
        more = f"; permitted: {finding.permitted}" if finding.permitted else ""
        out.print(f"{finding}{more}", style=_COLOURS[finding.severity], soft_wrap=True)


def announce(findings: Iterable[Finding], check: str) -> None:
    """Print on stderr which of several was chosen and, in one line, the number of warnings.

    Args:
        findings: What was found.
        check: Command that lists everything.
    """
    warnings = 0
    for finding in findings:
        told = finding_kinds()[finding.code].told
        if told == "named":
            note(str(finding))
        elif told == "counted":
            warnings += 1
    if warnings:
        note(f"{counted_findings(warnings)}: {check}")


def counted_findings(warnings: int) -> str:
    """Return the number of warnings in words."""
    return f"{warnings} finding{'s' * (warnings != 1)} (warning{'s' * (warnings != 1)})"


def note(text: str) -> None:
    """Print a line on stderr."""
    with above_bars():
        print(printable(text, lines=False), file=sys.stderr)


def note_undrawn(geometry: Geometry) -> None:
    """Print which links have meshes that cannot be read, if any have."""
    from chainbuild.drawing.given import undrawn_meshes

    if links := undrawn_meshes(geometry):
        note(f"meshes of {', '.join(links)} cannot be read: these links are drawn by rule")


def note_lighter(chain: Chain) -> None:
    """Print that a page shows meshes with fewer triangles than they have, if it does."""
    from chainbuild.drawing.machine import drawn_bodies
    from chainbuild.inspect.scene import MOST_TRIANGLES

    count = sum(len(body.surface.corners) for body in drawn_bodies(chain) if body.surface is not None)
    if count > MOST_TRIANGLES:
        note(f"the meshes have {count:,} triangles: the page merges near vertices until {MOST_TRIANGLES:,} are left")


@contextmanager
def output(path: Path | None) -> Iterator[TextIO]:
    """Open the output of a command: a file that appears only on success, or stdout (None, or "-")."""
    if path is None or path == STDOUT:
        with without_bars() if sys.stdout.isatty() else nullcontext():
            yield sys.stdout
        return
    with open_atomic(path) as stream:
        yield stream


def with_progress(items: Iterable[Item], source: Table, what: str) -> Iterator[Item]:
    """Yield the rows of a table and show the progress on stderr, if that is a terminal.

    Args:
        items: The rows.
        source: The table they come from.
        what: What is being done.
    """
    if not sys.stderr.isatty():
        for item in items:
            check_interrupt()
            yield item
        return
    with counting(source.size, bars_shown(), what) as advance:
        last = 0
        for count, item in enumerate(items):
            check_interrupt()
            if count % _ROWS_BETWEEN_UPDATES == 0:
                advance(source.position - last)
                last = source.position
            yield item
