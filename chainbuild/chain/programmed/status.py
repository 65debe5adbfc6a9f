"""Status & turn, the numbers that name the branch of a six-axis articulated arm (KIN_TYP manual 3.3.3): IS and IT."""

from __future__ import annotations

import re
from numbers import Integral
from typing import Final

from chainbuild.errors import ChainbuildError

# Bits of the pose status, as KIN_TYP 45 numbers them.
WRIST_BEHIND: Final = 1
WRIST_IN_FRONT: Final = 2
HAND_NEGATIVE: Final = 4

MOST_STATUS: Final = 7  # all three bits
MOST_TURN: Final = 63  # one bit for each of six axes
HAND_AXIS: Final = 4  # place of axis 5 among the axes

_DECIMAL: Final = re.compile(r"0*(\d{1,2})(?:\.0*)?", re.ASCII)  # also 2.0: so pandas writes a column with gaps
_BINARY: Final = re.compile(r"(?:0b|0?2#|'B(?=[01]+'))([01]{1,6})'?", re.IGNORECASE | re.ASCII)
_PERMITTED: Final = "0 … {most}, decimal or binary (0b10, 'B10', 2#10)"


def parse_status(text: str) -> int | None:
    """Return the pose status (IS) that a text gives, or None for an empty text.

    >>> parse_status("2"), parse_status("0b010"), parse_status("'B010'"), parse_status(" ")
    (2, 2, 2, None)

    Raises:
        ChainbuildError: not a whole number of 0 … 7, decimal or binary.
    """
    return _parsed(text, "is", "status", MOST_STATUS)


def parse_turn(text: str) -> int | None:
    """Return the turn (IT) that a text gives, or None for an empty text.

    >>> parse_turn("34"), parse_turn("0b100010"), parse_turn("2#100010")
    (34, 34, 34)

    Raises:
        ChainbuildError: not a whole number of 0 … 63, decimal or binary.
    """
    return _parsed(text, "it", "turn", MOST_TURN)


def check_status_turn(status: object, turn: object) -> tuple[int, int | None]:
    """Return status and turn as integers.

    Raises:
        ChainbuildError: one of them is no integer or out of range, the turn is given without the status, or both
            contradict each other about the sign of axis 5.
    """
    if status is None:
        text = "a turn (IT) needs the pose status (IS) beside it"
        raise ChainbuildError(text, parameter="status", permitted=f"0 … {MOST_STATUS}")
    bits = _whole(status, "status", "IS", MOST_STATUS)
    if turn is None:
        return bits, None
    signs = _whole(turn, "turn", "IT", MOST_TURN)
    negative = bool(bits & HAND_NEGATIVE)
    if bool(signs >> HAND_AXIS & 1) != negative:
        said, other = ("< 0", ">= 0") if negative else (">= 0", "< 0")
        raise ChainbuildError(
            f"status {bits} (IS) says axis 5 {said}, turn {signs} (IT) says axis 5 {other}",
            parameter="turn",
            permitted=f"turn {signs ^ 1 << HAND_AXIS}, or status {bits ^ HAND_NEGATIVE}",
        )
    return bits, signs


def _parsed(text: str, parameter: str, word: str, most: int) -> int | None:
    stripped = text.strip()
    if not stripped:
        return None
    value = -1
    for pattern, base in ((_DECIMAL, 10), (_BINARY, 2)):
        found = pattern.fullmatch(stripped)
        value = value if found is None else int(found.group(1), base)
    if not 0 <= value <= most:
        permitted = _PERMITTED.format(most=most)
        raise ChainbuildError(f"'{stripped[:40]}' is no {word}", parameter=parameter, permitted=permitted)
    return value


def _whole(value: object, parameter: str, letters: str, most: int) -> int:
    number = int(value) if isinstance(value, Integral) and not isinstance(value, bool) else -1
    if not 0 <= number <= most:
        text = f"{parameter} ({letters}) is {value!r}"
        raise ChainbuildError(text, parameter=parameter, permitted=f"whole numbers of 0 … {most}")
    return number
