"""Outputs of notebooks compared: the same but for rounding, which differs between processors."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import groupby

from nbformat import NotebookNode

NUMBER = re.compile(r"[-−]?\d+(?:\.\d*)?(?:e[-+]?\d+)?")
SVG = "image/svg+xml"
PIXEL = 0.02  # in the units of a picture, which are points, tenths of a pixel or pixels: nothing that is seen


def texts(cell: NotebookNode) -> Iterator[tuple[str, str]]:
    """Yield what a cell shows: the kind of each output, and its text; what a kernel printed in pieces as one."""
    outputs = cell.get("outputs", [])
    for name, group in groupby(outputs, key=lambda output: output.get("name", "")):
        if name:
            yield name, "".join(output.text for output in group)
            continue
        for output in group:
            yield from sorted(output.data.items())


def step(number: str) -> float:
    """Return one unit of the last digit that is printed; 0 for a whole number, which is no measurement."""
    digits, _, power = number.partition("e")
    whole = "." not in digits and not power
    return 0.0 if whole else 10.0 ** (int(power or 0) - len(digits.partition(".")[2]))


def value(number: str) -> float:
    return float(number.replace("−", "-"))


def same(kind: str, before: str, after: str) -> bool:
    """Tell whether two outputs say the same: every word and whole number, others but for one unit of the last digit."""
    words = [" ".join(NUMBER.sub(" 0 ", text).split()) for text in (before, after)]
    if words[0] != words[1]:
        return False
    numbers = zip(NUMBER.findall(before), NUMBER.findall(after), strict=True)
    if kind == SVG:
        return all(a == b or abs(value(a) - value(b)) <= PIXEL for a, b in numbers)
    return all(a == b or abs(value(a) - value(b)) <= 1.000001 * max(step(a), step(b)) for a, b in numbers)


def stale(committed: NotebookNode, fresh: NotebookNode) -> list[str]:
    """Return what a run shows otherwise than what is committed, a line each."""
    found = []
    for number, (old, new) in enumerate(zip(committed.cells, fresh.cells, strict=True)):
        before, after = list(texts(old)), list(texts(new))
        if [kind for kind, _ in before] != [kind for kind, _ in after]:
            found.append(f"cell {number}: {[kind for kind, _ in before]} became {[kind for kind, _ in after]}")
            continue
        found += [
            f"cell {number}, {kind}:\n{old_text[:500]}\nbecame\n{new_text[:500]}"
            for (kind, old_text), (_, new_text) in zip(before, after, strict=True)
            if not same(kind, old_text, new_text)
        ]
    return found
