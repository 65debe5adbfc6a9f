"""Files gone wrong in many ways: structured mutants of a good text, the same ones in every run."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

WILD = (
    "", " ", "0", "-0.0", "-1", "1", "2", "1e-320", "1e-12", "1e7", "1e10", "1e16", "-1e16", "1e308", "-1e308", "1e999",
    "nan", "inf", "-inf", "0x10", "1_000", "1,5", "99999999999999999999", "-", "+", ".", "e", "0 0 0", "1 2 3", "0 1",
    "true", "false", "null", "2030-01-01", "tool", "workpiece", "universe", "base", "flange", "status", "A_drive", "A1",
    "C", "base_link", "fixed", "revolute", "continuous", "prismatic", "floating", "planar", "${x}", "é", "𝔘", "\ufeff",
    "\x00", "\x7f", "\u2028", "\t", '"', "'", "<", ">", "&", "&amp;", "[", "]", "{", "}", "=", "#", ";", ",", "\\",
    "x" * 300,
)  # fmt: skip
# Numbers, words, and single marks: what a structured change replaces as a whole.
_TOKEN = re.compile(r"-?\d[\d.eE+-]*|\w+|[^\w\s]")


def mutants(text: str, count: int, seed: int) -> Iterator[str]:
    """Yield changed texts: tokens replaced, exchanged, dropped or doubled, lines dropped, doubled, moved or cut."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        changed = text
        for _ in range(int(rng.integers(1, 4))):
            changed = _CHANGES[int(rng.integers(len(_CHANGES)))](changed, rng)
        yield changed


def _spots(text: str, rng: np.random.Generator) -> tuple[re.Match[str], re.Match[str]] | None:
    found = list(_TOKEN.finditer(text))
    if not found:
        return None
    first, second = sorted(int(n) for n in rng.integers(len(found), size=2))
    return found[first], found[second]


def _replaced(text: str, rng: np.random.Generator) -> str:
    spots = _spots(text, rng)
    if spots is None:
        return text
    return text[: spots[0].start()] + WILD[int(rng.integers(len(WILD)))] + text[spots[0].end() :]


def _exchanged(text: str, rng: np.random.Generator) -> str:
    spots = _spots(text, rng)
    if spots is None or spots[0].start() == spots[1].start():
        return text
    a, b = spots
    return text[: a.start()] + b.group() + text[a.end() : b.start()] + a.group() + text[b.end() :]


def _copied(text: str, rng: np.random.Generator) -> str:
    """Put one token in the place of another: names that occur twice, values of another datum."""
    spots = _spots(text, rng)
    return text if spots is None else text[: spots[0].start()] + spots[1].group() + text[spots[0].end() :]


def _dropped(text: str, rng: np.random.Generator) -> str:
    spots = _spots(text, rng)
    return text if spots is None else text[: spots[0].start()] + text[spots[0].end() :]


def _line_changed(text: str, rng: np.random.Generator) -> str:
    lines = text.split("\n")
    n, m = (int(k) for k in rng.integers(len(lines), size=2))
    line = lines[n]
    how = int(rng.integers(4))
    if how == 0:
        del lines[n]
    elif how == 1:
        lines.insert(m, line)
    elif how == 2:
        lines[n], lines[m] = lines[m], line
    else:
        lines[n] = line[: int(rng.integers(len(line) + 1))]
    return "\n".join(lines)


def _cut(text: str, rng: np.random.Generator) -> str:
    return text[: int(rng.integers(len(text) + 1))]


_CHANGES = (_replaced, _replaced, _replaced, _exchanged, _copied, _copied, _dropped, _line_changed, _line_changed, _cut)
