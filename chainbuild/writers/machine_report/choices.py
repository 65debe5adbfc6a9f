"""The chapters on what the manuals leave open, and on findings."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import PurePath
from typing import TYPE_CHECKING

from chainbuild.writers.machine_report.document.blocks import (
    Chapter,
    Heading,
    Paragraph,
    ReportBlock,
    TableBlock,
    Verbatim,
    table_block,
)
from chainbuild.writers.machine_report.document.page import TICK

if TYPE_CHECKING:
    from chainbuild.convention import UsedConvention
    from chainbuild.findings import Finding


def conventions_chapter(used: Iterable[UsedConvention]) -> Chapter:
    """Return the chapter on conventions: those without default first, then open ones, then inferred ones."""
    ordered = sorted(
        used, key=lambda one: (bool(one.convention.default), one.convention.mark != "?", one.convention.name)
    )
    return Chapter("What the manuals leave open", list(_convention_blocks(ordered)))


def _convention_blocks(used: list[UsedConvention]) -> Iterator[ReportBlock]:
    if not used:
        yield Paragraph.of("Nothing that shapes this machine: no convention was asked.")
        return
    yield Paragraph.of(
        "Each point is settled by a convention, and each can be verified at the machine. A wrong one is switched by ",
        Verbatim("--convention NAME=CHOICE"),
        " or in the overlay; the report is then made anew.",
    )
    for one in used:
        convention = one.convention
        how = "chosen; there is no default" if not convention.default else "chosen" if one.by_user else "default"
        open_ = "open in the manual" if convention.mark == "?" else "inferred"
        yield Heading((Verbatim(convention.name), f": {one.choice} ({how}; {open_})"))
        rows = [
            ["Question", convention.question],
            ["In force", f"{one.choice}: {convention.choices.get(one.choice, '')}"],
        ]
        rows += [["Or", f"{name}: {meaning}"] for name, meaning in convention.choices.items() if name != one.choice]
        rows += [
            ["Why" if convention.default else "Why no default", convention.why],
            ["At the machine", convention.verify],
            ["Source", convention.source],
            ["Verified", f"{TICK} as in force   {TICK} otherwise:"],
        ]
        yield TableBlock(("", ""), rows, "facts")


def findings_chapter(findings: Iterable[Finding]) -> Chapter:
    """Return the chapter on findings."""
    rows = [[one.code, one.severity, _place(one), _text(one), one.hint or ""] for one in findings]
    if not rows:
        return Chapter("Findings", [Paragraph.of("None.")])
    return Chapter("Findings", [table_block(("Number", "Severity", "Where", "What", "Hint"), rows)])


def _place(finding: Finding) -> str:
    span = finding.span
    if span is None:
        return ""
    # Reports are passed on: the name of the file, not its folder.
    name = PurePath(span.file).name
    return Verbatim(f"{name}:{span.line}" if span.line else name)


def _text(finding: Finding) -> str:
    permitted = f"; permitted: {finding.permitted}" if finding.permitted else ""
    alarm = f" (controller alarm {finding.alarm})" if finding.alarm else ""
    return f"{finding.text}{permitted}{alarm}"
