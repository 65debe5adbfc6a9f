"""Random machine tools as someone might build them: strokes, head and table of sensible sizes, tip above table."""

from __future__ import annotations

import numpy as np

from chainbuild.chain.assemble import Element, linear, mark, rotary, shift
from chainbuild.chain.elements import Chain
from tests.kit.drawn_robots import axis, build

HEADS = ("", "A", "B", "C", "CA", "CB", "BA", "AB", "CS", "S")
TABLES = ("", "C", "A", "B", "AC", "BC", "CAC")
CARRIED = ("", "", "X", "Y", "XY", "YX", "Z")
DIRECTIONS = {"A": "x", "B": "y", "C": "z"}


def random_tool(rng: np.random.Generator) -> Chain:
    """Return a random machine tool; S is a slanted axis."""
    strokes = {"X": rng.uniform(400, 4000), "Y": rng.uniform(300, 2500), "Z": rng.uniform(250, 1200)}
    head, table, carried = (str(rng.choice(names)) for names in (HEADS, TABLES, CARRIED))
    on_tool = [name for name in "XYZ" if name not in carried]
    if rng.random() < 0.3:
        rng.shuffle(on_tool)
    limits, tool = [], [linear(name, name.lower()) for name in on_tool]
    for name in "XYZ":
        side = "workpiece" if name in carried else "tool"
        ends = (-strokes[name], 0.0) if name == "Z" else (-strokes[name] / 2, strokes[name] / 2)
        limits.append(axis(name, *ends, side))
    small = min(strokes.values())
    tool += _head(rng, head, 0.1 * small)
    limits += [axis(f"{letter}{n}", -100.0, 100.0) for n, letter in enumerate(head)]
    # Down to where the plate stays below the tip at the lowest of Z.
    below = strokes["Z"] * rng.uniform(1.05, 1.6) + 0.1 * small * (len(head) + 3)
    workpiece: list[Element] = [linear(name, name.lower(), sign=-1.0) for name in carried]
    workpiece += [shift(z=-below), *_table(rng, table, 0.06 * small)]
    limits += [axis(f"{letter}T{n}", -100.0, 100.0, "workpiece") for n, letter in enumerate(table)]
    return build("random", limits, tool, tuple(workpiece)).chain


def _head(rng: np.random.Generator, letters: str, size: float) -> list[Element]:
    found: list[Element] = []
    for n, letter in enumerate(letters):
        slanted = (0.0, 0.6, 0.8)
        found += [shift(z=-rng.uniform(0.8, 2.0) * size), rotary(f"{letter}{n}", DIRECTIONS.get(letter, slanted))]
        if rng.random() < 0.3:
            found.append(shift(x=rng.uniform(-0.5, 0.5) * size))
    return [*found, shift(z=-rng.uniform(0.8, 2.0) * size), mark("flange"), shift(z=-rng.uniform(0.2, 1.0) * size)]


def _table(rng: np.random.Generator, letters: str, size: float) -> list[Element]:
    found: list[Element] = []
    for n, letter in enumerate(letters):
        found += [rotary(f"{letter}T{n}", DIRECTIONS[letter]), shift(z=rng.uniform(-1.0, 1.0) * size)]
    return found
