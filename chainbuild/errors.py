"""Errors: where input is refused, what is permitted, which alarm the controller raises."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

_SHOWN_LINE_LENGTH: Final = 160  # characters: more would fold on every terminal


@dataclass(frozen=True, slots=True)
class Span:
    """A place in an input file.

    Attributes:
        file: File name as the user gave it.
        line: Line number, counted from 1; 0 where the whole file is meant.
        column: Column number, counted from 1.
        text: The line itself, shortened, for display.
    """

    file: str
    line: int = 0
    column: int = 1
    text: str = ""

    def __str__(self) -> str:
        return f"{self.file}:{self.line}" if self.line else self.file

    def __repr__(self) -> str:
        return f"<Span {self}>"


class ChainbuildError(Exception):
    """Input that chainbuild refuses, with everything needed to correct it.

    Args:
        message: What is wrong, as a sentence without a trailing full stop.
        span: Where in which file.
        parameter: The machine datum, column, key or option at fault.
        permitted: What would have been accepted.
        alarm: Number of the alarm or error the controller raises for the same fault.
        hint: What to do about it.
        code: Number of the finding (``CB101`` …) where the fault has one.
    """

    def __init__(
        self,
        message: str,
        *,
        span: Span | None = None,
        parameter: str | None = None,
        permitted: str | None = None,
        alarm: int | None = None,
        hint: str | None = None,
        code: str | None = None,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.span = span
        self.parameter = parameter
        self.permitted = permitted
        self.alarm = alarm
        self.hint = hint
        self.code = code

    @property
    def file(self) -> str | None:
        """File the error points at, or None."""
        return self.span.file if self.span else None

    @property
    def line(self) -> int | None:
        """Line the error points at (from 1), or None."""
        return self.span.line if self.span and self.span.line else None

    def __str__(self) -> str:
        parts = [self.message]
        if self.parameter and self.parameter not in self.message:
            parts.append(f"parameter {self.parameter}")
        if self.permitted:
            parts.append(f"permitted: {self.permitted}")
        if self.alarm:
            parts.append(f"controller alarm {self.alarm}")
        if self.hint:
            parts.append(self.hint)
        head = f"{self.span}: " if self.span else ""
        return head + "; ".join(parts)

    def marked_line(self) -> str:
        """Return the offending line with a mark under the spot, or an empty string."""
        if self.span is None or not self.span.text:
            return ""
        text = self.span.text[:_SHOWN_LINE_LENGTH]
        spot = min(max(self.span.column, 1), len(text) + 1) - 1
        return f"    {text}\n    {' ' * spot}^"


class FileAccessError(ChainbuildError):
    """A file cannot be read or written, or is not text."""


class OverwriteError(FileAccessError):
    """An output is one of the inputs, by whatever name."""


class FileContentError(FileAccessError):
    """A file is there but holds no text that could be read: empty, binary, too large or a line too long."""


class ParseError(ChainbuildError):
    """A line of machine data, CSV or overlay does not follow its syntax."""


class MachineDataError(ChainbuildError):
    """A machine datum is missing, out of range or contradicts another."""


class UnsupportedKinematicError(ChainbuildError):
    """The kinematic is known but not built by this version, or not known at all."""


class ConventionError(ChainbuildError):
    """A convention or one of its choices does not exist."""


class AxisValueError(ChainbuildError):
    """Axis values have the wrong count or are not finite."""


class TableError(ChainbuildError):
    """A CSV table lacks a column, names an unknown one or has a field that is not a number."""


class OverlayError(ChainbuildError):
    """The overlay file holds an unknown key or a value of the wrong kind."""


class ChainError(ChainbuildError):
    """A chain contradicts itself: a duplicate name, a link without parent, a singular axis map."""
