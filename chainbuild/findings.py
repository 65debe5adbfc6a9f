"""Numbered findings of a machine file and the collector that gathers or raises them."""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import resources
from typing import Final, Literal

from chainbuild.errors import ChainbuildError, MachineDataError, Span
from chainbuild.html import html_table, html_text
from chainbuild.shown import two_lines

Severity = Literal["info", "warning", "error"]
# What a command that only uses a machine says of a finding: all of it, that there is one more, nothing.
Told = Literal["named", "counted", "listed"]


@dataclass(frozen=True, slots=True)
class FindingKind:
    """Kind of a finding: severity, a title without particulars, and when it is told.

    Attributes:
        code: Its number.
        severity: error refuses the file.
        title: What it is about.
        told: Where a machine is only used: named with its text (what was chosen among several), counted, or listed by
            `check` and `info` alone (nothing to do about it).
        convention: The convention that it speaks of, which makes it untrue when it is chosen; "parameter": the one that
            its parameter names.
        includes: The number of a warning that this one says with more words at the same place.
    """

    code: str
    severity: Severity
    title: str
    told: Told = "counted"
    convention: str | None = None
    includes: str | None = None


@dataclass(frozen=True, slots=True)
class Finding:
    """One remark on a file: number, severity, text, place and what to do about it."""

    code: str
    severity: Severity
    text: str
    span: Span | None = None
    hint: str | None = None
    parameter: str | None = None
    permitted: str | None = None
    alarm: int | None = None

    def __str__(self) -> str:
        where = f"{self.span}: " if self.span else ""
        more = f" (controller alarm {self.alarm})" if self.alarm else ""
        hint = f" — {self.hint}" if self.hint else ""
        return f"{where}{self.code} {self.severity}: {self.text}{more}{hint}"

    def __repr__(self) -> str:
        return two_lines(f"<Finding {self}>")


class Findings(tuple[Finding, ...]):
    """Findings in the order in which they were made: a tuple that shows itself as a table."""

    __slots__ = ()

    @property
    def counts(self) -> dict[Severity, int]:
        """How many there are of each severity that occurs, the worst first."""
        order: tuple[Severity, ...] = ("error", "warning", "info")
        found = {severity: sum(finding.severity == severity for finding in self) for severity in order}
        return {severity: count for severity, count in found.items() if count}

    def __repr__(self) -> str:
        told = ", ".join(f"{count} {severity}" for severity, count in self.counts.items())
        codes = ", ".join(dict.fromkeys(finding.code for finding in self))
        return two_lines(f"<Findings: {told} ({codes})>" if self else "<Findings: none>")

    def _repr_html_(self) -> str:
        rows = [(f.code, f.severity, f.span or "", f.text, f.hint or "") for f in self]
        return html_table(("Finding", "Severity", "Where", "What", "Hint"), rows) if rows else html_text("no findings")


NO_FINDINGS: Final = Findings()
# When a finding is told, where the register does not say.
_TOLD: Final[Mapping[Severity, Told]] = {"error": "counted", "warning": "counted", "info": "listed"}


@cache
def finding_kinds() -> Mapping[str, FindingKind]:
    """Return the register of all finding numbers."""
    raw = tomllib.loads(resources.files("chainbuild").joinpath("data/findings.toml").read_text("utf-8"))
    return {code: FindingKind(code, **{"told": _TOLD[row["severity"]], **row}) for code, row in raw.items()}


def once(findings: Iterable[Finding], refusal: ChainbuildError | None = None) -> Findings:
    """Return findings, each once, without those that another, or the refusal beside them, includes.

    Args:
        findings: What was found, in order.
        refusal: An error that is told beside the findings.
    """
    different = list(dict.fromkeys(findings))
    said = [(one.code, one.span) for one in different]
    said += [(refusal.code, refusal.span)] if refusal is not None and refusal.code is not None else []
    included = {(finding_kinds()[code].includes, span) for code, span in said}
    return Findings(one for one in different if (one.code, one.span) not in included)


def still_true(findings: Iterable[Finding], chosen: Collection[str]) -> Findings:
    """Return the findings that do not go when conventions are chosen, whatever the choice.

    Args:
        findings: What was found without the choice.
        chosen: Names of the conventions chosen.
    """

    def settled(one: Finding) -> bool:
        about = finding_kinds()[one.code].convention
        return (one.parameter if about == "parameter" else about) in chosen

    return Findings(one for one in findings if not settled(one))


@dataclass(slots=True)
class Collector:
    """Gathers findings; a strict collector raises at the first error, a lenient one continues.

    Attributes:
        strict: True: an error is raised. False: it is kept as a finding and reading goes on.
        findings: What was found, in order.
    """

    strict: bool = True
    findings: list[Finding] = field(default_factory=list)

    def add(
        self,
        code: str,
        text: str,
        *,
        span: Span | None = None,
        hint: str | None = None,
        parameter: str | None = None,
        permitted: str | None = None,
        alarm: int | None = None,
        error: type[ChainbuildError] = MachineDataError,
    ) -> None:
        """Record a finding under its number; its severity comes from the register.

        Raises:
            ChainbuildError: the class given by `error`, where the number is an error and the collector is strict.
        """
        severity = finding_kinds()[code].severity
        if severity == "error" and self.strict:
            raise error(text, span=span, hint=hint, parameter=parameter, permitted=permitted, alarm=alarm, code=code)
        self.findings.append(Finding(code, severity, text, span, hint, parameter, permitted, alarm))

    def add_error(self, error: ChainbuildError) -> None:
        """Record an exception that a lenient caller has caught."""
        self.findings.append(
            Finding(
                error.code or "CB001",
                "error",
                error.message,
                error.span,
                error.hint,
                error.parameter,
                error.permitted,
                error.alarm,
            )
        )


def refuse_errors(findings: Iterable[Finding]) -> None:
    """Raise the first error among findings that a lenient collector has kept.

    Raises:
        MachineDataError: with everything that the finding says.
    """
    for finding in findings:
        if finding.severity == "error":
            raise MachineDataError(
                finding.text,
                span=finding.span,
                parameter=finding.parameter,
                permitted=finding.permitted,
                alarm=finding.alarm,
                hint=finding.hint,
                code=finding.code,
            )
