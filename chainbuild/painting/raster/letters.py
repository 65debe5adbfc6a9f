"""Letters made of strokes, as on technical drawings: pictures of pixels need no fonts of the system."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import Final

from chainbuild.painting.views import Spot

# Strokes of each letter: corners as two digits, x and y on a grid where letters stand on y = 2, x-heights end at 7 and
# capitals at 9. "~": rounded; "o": rounded and closed.
_BOWL: Final = "o07 02 42 47"
_STROKES: Final = {
    "A": "02 29 42|15 35", "B": "02 09|~09 29 49 46 26 06|~06 26 46 42 22 02", "C": "~48 49 09 02 42 43",
    "D": "02 09|~09 19 49 42 12 02", "E": "49 09 02 42|06 36", "F": "49 09 02|06 36", "G": "~48 49 09 02 42 45|45 25",
    "H": "02 09|42 49|06 46", "I": "02 09", "J": "~39 32 02 03", "K": "02 09|49 05|16 42", "L": "09 02 42",
    "M": "02 09 25 49 42", "N": "02 09 42 49", "O": "o09 02 42 49", "P": "02 09|~09 29 49 45 25 05",
    "Q": "o09 02 42 49|24 51", "R": "02 09|~09 29 49 45 25 05|25 42", "S": "~48 49 09 06 46 42 02 03",
    "T": "09 49|29 22", "U": "~09 02 42 49", "V": "09 22 49", "W": "09 12 27 32 49", "X": "02 49|09 42",
    "Y": "09 26 49|26 22", "Z": "09 49 02 42",
    "a": f"{_BOWL}|47 42", "b": f"09 02|{_BOWL}", "c": "~46 47 07 02 42 43", "d": f"49 42|{_BOWL}",
    "e": "~43 42 02 07 47 45|45 05", "f": "~39 19 12|07 37", "g": f"{_BOWL}|~47 40 00 01", "h": "09 02|~05 07 47 42",
    "i": "02 07|09 09", "j": "~17 10 00|19 19", "k": "09 02|37 04|15 32", "l": "09 02",
    "m": "02 07|~05 07 37 32|~35 37 67 62", "n": "02 07|~05 07 47 42", "o": _BOWL, "p": f"07 00|{_BOWL}",
    "q": f"47 40|{_BOWL}", "r": "02 07|~05 07 37", "s": "~46 47 07 05 44 42 02 03", "t": "~19 12 32|07 37",
    "u": "~07 02 42|47 42", "v": "07 22 47", "w": "07 12 25 32 47", "x": "02 47|07 42", "y": "07 22|47 10",
    "z": "07 47 02 42",
    "0": "o09 02 32 39", "1": "17 29 22", "2": "~08 09 49 46 02|02 42", "3": "~08 09 49 46 16|~16 46 42 02 03",
    "4": "32 39 04 44", "5": "49 09 06|~06 46 42 02 03", "6": "~48 49 09 02 42 46 06 04", "7": "09 49 12",
    "8": "o06 09 49 46|o06 02 42 46", "9": "~03 02 42 49 09 05 45 47",
    "=": "06 36|04 34", "-": "05 35", "−": "05 35", "+": "05 45|27 23", "_": "01 41", "[": "29 09 00 20",
    "]": "09 29 20 00", "(": "~29 08 01 20", ")": "~09 28 21 00", ".": "02 02", ",": "13 01", ":": "03 03|06 06",
    "/": "02 49", "°": "o07 09 29 27", " ": "",
}  # fmt: skip
_UNKNOWN: Final = "02 09 39 32 02"  # a box, for what is no letter here
_GAP: Final = 2.0  # of the grid, between letters
_SPACE: Final = 2.0  # width of a blank, likewise
_GRID: Final = 0.1  # of the size of a text: a line of the grid


def text_width(text: str) -> float:
    """Return the width of a text, in multiples of its size."""
    return _GRID * (sum(_width(letter) + _GAP for letter in text) - _GAP)


def text_strokes(text: str, x: float, y: float, size: float) -> Iterator[list[Spot]]:
    """Yield the strokes of a text in pixels, y downwards.

    Args:
        text: The text.
        x: Where it begins.
        y: Where its letters stand.
        size: Its size.
    """
    unit = _GRID * size
    for letter in text:
        for stroke in _corners(letter):
            yield [(x + unit * a, y - unit * (b - 2.0)) for a, b in stroke]
        x += unit * (_width(letter) + _GAP)


def _width(letter: str) -> float:
    return max((a for stroke in _corners(letter) for a, _ in stroke), default=_SPACE)


def _corners(letter: str) -> list[list[Spot]]:
    strokes = []
    for word in filter(None, _STROKES.get(letter, _UNKNOWN).split("|")):
        corners = [(float(pair[0]), float(pair[1])) for pair in word.lstrip("~o").split()]
        if word[0] == "o":
            # Closed in the middle of a side, where there is nothing to round.
            (a, b), (c, d) = corners[0], corners[-1]
            seam = ((a + c) / 2.0, (b + d) / 2.0)
            corners = _rounded([seam, *corners, seam])
        elif word[0] == "~":
            corners = _rounded(corners)
        strokes.append(corners)
    return strokes


def _rounded(corners: Sequence[Spot]) -> list[Spot]:
    """Return a line whose corners are cut, twice; its ends stay."""
    line = list(corners)
    for _ in range(2):
        inner = []
        for (a, b), (c, d) in pairwise(line):
            inner += [(0.75 * a + 0.25 * c, 0.75 * b + 0.25 * d), (0.25 * a + 0.75 * c, 0.25 * b + 0.75 * d)]
        line = [line[0], *inner[1:-1], line[-1]] if len(line) > 2 else line
    return line
