"""Random chains that are degenerate on purpose: right angles, coinciding points, axes through the TCP."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.chain.assemble import Element, linear, rotary, shift
from chainbuild.chain.elements import Axis
from chainbuild.robot import Robot
from tests.kit.chains import chain_from

KINDS: Final = ("right angles", "random", "zero")  # of the axis values that make a pose
_RIGHT: Final = (
    (1.0, 0.0, 0.0),
    (0.0, 1.0, 0.0),
    (0.0, 0.0, 1.0),
    (-1.0, 0.0, 0.0),
    (0.0, -1.0, 0.0),
    (0.0, 0.0, -1.0),
)
_ASKEW: Final = (45.0, 60.0)  # degrees from a right one
_LENGTHS: Final = (0.0, 0.0, 0.0, 0.0, 100.0, 100.0, 200.0)  # mm: equal ones and none are frequent
_WIDE: Final = 1e5  # mm and degrees: no limit is in the way


@dataclass(frozen=True)
class Case:
    """A chain, and axis values that make its pose."""

    robot: Robot
    axes: np.ndarray
    text: str


def degenerate_case(seed: int) -> Case:
    """Return the chain of a seed, three to six axes, with axis values for its pose."""
    rng = np.random.default_rng([1260, seed])
    count = 3 + seed % 4
    carried = int(rng.integers(1, count)) if rng.random() < 0.25 else 0
    slides = rng.random(count) < rng.choice([0.0, 0.2, 0.5])
    told: list[str] = []
    moves: list[list[Element]] = []
    axes = []
    for n, slide in enumerate(slides):
        name, direction = f"{'X' if slide else 'A'}{n + 1}", _direction(rng)
        moves.append([_shift(rng), (linear if slide else rotary)(name, direction)])
        kind = "linear" if slide else "rotary"
        axes.append(Axis(name, kind, "mm" if slide else "deg", -_WIDE, _WIDE, False))
        told.append(f"{name} {np.round(direction, 3).tolist()}")
    # The last axis through the TCP, or a tool with an offset.
    tip = [shift()] if rng.random() < 0.4 else [_shift(rng)]
    workpiece = [element for move in moves[:carried] for element in move]
    tool = [element for move in moves[carried:] for element in move] + tip
    kind = KINDS[seed // 4 % len(KINDS)]
    robot = Robot(chain_from(axes, tool, workpiece))
    return Case(robot, _values(rng, slides, kind), f"{seed}: {kind}, {carried} carry the workpiece, {'; '.join(told)}")


def _direction(rng: np.random.Generator) -> tuple[float, float, float]:
    one = np.array(_RIGHT[int(rng.integers(6))])
    if rng.random() < 0.15:
        other = np.roll(one, 1)
        angle = np.radians(rng.choice(_ASKEW))
        one = np.cos(angle) * one + np.sin(angle) * other
    return float(one[0]), float(one[1]), float(one[2])


def _shift(rng: np.random.Generator) -> Element:
    return shift(*(float(value) for value in rng.choice(_LENGTHS, 3)))


def _values(rng: np.random.Generator, slides: np.ndarray, kind: str) -> np.ndarray:
    if kind == "zero":
        return np.zeros(len(slides))
    if kind == "random":
        return np.where(slides, rng.uniform(-300.0, 300.0, len(slides)), rng.uniform(-175.0, 175.0, len(slides)))
    return np.where(slides, 100.0, 90.0) * rng.integers(-1, 3, len(slides))
