"""Suggestions for a mistyped name: the known names, the most similar first."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from typing import Final

_ALIKE: Final = 0.6  # the cutoff that difflib itself takes
_SHOWN: Final = 12  # fit on one or two lines of a message
_LONGEST: Final = 80  # characters of a name that are compared: a longer one is not a typing error


def closest(name: str, known: Iterable[str]) -> str | None:
    """Return the known name most similar to a given one, or None where none is similar.

    Case is ignored, and a name without its unit matches.

    >>> closest("RA1", ["A1", "A2"]), closest("x", ["qx", "x_mm"]), closest("a1", ["A1"]), closest("speed", ["A1"])
    ('A1', 'x_mm', 'A1', None)
    """
    found = _by_likeness(name, list(known))
    return found[0] if found else None


def listed(name: str, known: Sequence[str], shown: int = _SHOWN, *, called: Sequence[str] | None = None) -> str:
    """Return known names as a list for a message: the most similar to a name first, a limited number.

    >>> listed("C", ["A", "B", "c"])
    'c, A, B'
    >>> listed("irb26000", ["arm", "irb2600", "tx2"], shown=2)
    'irb2600, arm, … (3 in all)'

    Args:
        name: What was given.
        known: The known names, as the message shows them.
        shown: Largest number of names.
        called: The names to compare with, one for each of `known`; None: `known` itself.
    """
    words = known if called is None else called
    alike = [known[n] for word in _by_likeness(name, words) for n, one in enumerate(words) if one == word]
    names = list(dict.fromkeys([*alike, *known]))
    more = [f"… ({len(names)} in all)"] if len(names) > shown else []
    return ", ".join([*names[:shown], *more])


def and_joined(names: Sequence[str]) -> str:
    """Return several names as a sentence lists them.

    >>> and_joined(["A4"]), and_joined(["A4", "A6"]), and_joined(["A2", "A3", "A5"])
    ('A4', 'A4 and A6', 'A2, A3 and A5')
    """
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last


def _by_likeness(name: str, known: Sequence[str]) -> list[str]:
    sought = name.strip().lower()[:_LONGEST]
    same = [one for one in known if sought in (one.lower(), one.lower().rpartition("_")[0])]
    folded: dict[str, list[str]] = {}
    for one in known:
        folded.setdefault(one.lower(), []).append(one)
    alike = difflib.get_close_matches(sought, folded, n=_SHOWN, cutoff=_ALIKE)
    return list(dict.fromkeys([*same, *(one for match in alike for one in folded[match])]))
