"""Values of a parameter list: numbers, whole numbers and strings, each with the comments that may follow."""

from __future__ import annotations

import math
import re
from typing import Final

from chainbuild import tolerances
from chainbuild.errors import MachineDataError, ParseError, Span
from chainbuild.units import raw_from_mm

_NUMBER: Final = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
_HEX: Final = re.compile(r"0[xX][0-9a-fA-F]+")
_COMMA: Final = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?", re.ASCII)
_NOT_FINITE: Final = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)
# After a number everything behind a blank is comment; comments opened without a blank are tolerated.
_TOKEN_END: Final = re.compile(r"[\s(#;]")
_STRING_COMMENT: Final = re.compile(r"\(|(?<=\s)#")
_HUGE_RAW: Final = raw_from_mm(tolerances.HUGE_AXIS_VALUE)


def real_number(raw: str, name: str, span: Span) -> float:
    """Return a finite number.

    Args:
        raw: Everything after the parameter's name.
        name: Parameter, for messages.
        span: Place of the value.

    Raises:
        ParseError: not a number, a decimal comma, or not finite.
        MachineDataError: larger than any machine.
    """
    token = _TOKEN_END.split(raw, maxsplit=1)[0]
    if _NUMBER.fullmatch(token):
        value = float(token)
    elif _HEX.fullmatch(token):
        # Longer ones overflow a float; they are refused as too large below.
        value = float(int(token, 16)) if len(token) <= 18 else math.inf
    else:
        raise _no_number(raw, token, name, span)
    if abs(value) > _HUGE_RAW:
        raise MachineDataError(
            f"the value of {name} is too large: {token[:40]}", span=span, parameter=name, code="CB204",
            permitted=f"at most {_HUGE_RAW:g} counts in size",
        )  # fmt: skip
    return value + 0.0


def _no_number(raw: str, token: str, name: str, span: Span) -> ParseError:
    hint = None
    if not raw:
        text = f"{name} has no value"
    elif raw.startswith("="):
        text = f"{name} has a `=` before its value"
        hint = "name and value are separated by blanks only"
    elif _COMMA.fullmatch(token):
        text = f"the value of {name} has a decimal comma: {token[:40]}"
        hint = "write a decimal point"
    elif _NOT_FINITE.fullmatch(token):
        text = f"the value of {name} is not finite: {token[:40]}"
    else:
        text = f"the value of {name} is not a number: {token[:40]!r}"
    return ParseError(text, span=span, parameter=name, permitted="a finite number", hint=hint, code="CB202")


def whole_number(raw: str, name: str, span: Span, lowest: int, highest: int) -> int:
    """Return a whole number within bounds.

    Raises:
        ParseError: not a number.
        MachineDataError: not whole or out of bounds.
    """
    value = real_number(raw, name, span)
    if value != int(value) or not lowest <= value <= highest:
        raise MachineDataError(
            f"{name} is {value:g}", span=span, parameter=name, permitted=f"a whole number from {lowest} to {highest}",
            code="CB204",
        )  # fmt: skip
    return int(value)


def text(raw: str, name: str, span: Span) -> str:
    """Return a string, with or without quotes, without the comment that `(` opens.

    >>> text("LINEAR (first in line", "", Span("x"))
    'LINEAR'
    >>> text('"LIN (1)" (comment', "", Span("x"))
    'LIN (1)'

    Raises:
        ParseError: missing, or a quote is not closed.
    """
    if raw[:1] in ('"', "'"):
        end = raw.find(raw[0], 1)
        if end < 0:
            raise ParseError(f"the string of {name} has no closing quote", span=span, parameter=name, code="CB209")
        value = raw[1:end].strip()
    else:
        value = _STRING_COMMENT.split(raw, maxsplit=1)[0].strip()
    if not value and raw[:2] not in ('""', "''"):
        raise ParseError(f"{name} has no value", span=span, parameter=name, permitted="a string", code="CB209")
    return value
