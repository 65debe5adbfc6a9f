"""Random machines whose singular positions are known in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from chainbuild.chain.assemble import Element, linear, mark, rotary, shift
from chainbuild.chain.elements import Axis
from chainbuild.robot import Robot
from chainbuild.units import unit_of
from tests.kit.chains import chain_from

Vector = np.ndarray


def axis(name: str, bound: float = 180.0, **more: object) -> Axis:
    """Return an axis of the given limits both ways, linear where its name begins with X, Y or Z."""
    kind = "linear" if name[0] in "XYZ" else "rotary"
    return Axis(name, kind, unit_of(kind), -bound, bound, False, **more)  # type: ignore[arg-type]


@dataclass(frozen=True)
class OrthoArm:
    """An ortho-parallel arm with a spherical wrist; lengths in mm, named as Brandstötter names them."""

    a1: float
    a2: float
    b: float
    c1: float
    c2: float
    c3: float
    c4: float

    @classmethod
    def random(cls, rng: np.random.Generator, lateral: bool) -> OrthoArm:
        """Draw an arm, with an offset to the side where asked."""
        a1, a2, c1 = rng.uniform(-200, 300), rng.uniform(-150, 150), rng.uniform(200, 800)
        c2, c3, c4 = rng.uniform(300, 1200), rng.uniform(300, 1200), rng.uniform(50, 250)
        return cls(a1, a2, rng.uniform(30, 150) if lateral else 0.0, c1, c2, c3, c4)

    def robot(self) -> Robot:
        """Return the arm with a tool of 60 mm."""
        tool = [
            shift(z=self.c1), rotary("A1", "z"), shift(x=self.a1), rotary("A2", "y"), shift(z=self.c2),
            rotary("A3", "y"), shift(x=self.a2, y=self.b), rotary("A4", "z"), shift(z=self.c3), rotary("A5", "y"),
            rotary("A6", "z"), shift(z=self.c4), mark("flange"), shift(z=60.0),
        ]  # fmt: skip
        return Robot(chain_from([axis(f"A{n}") for n in range(1, 7)], tool))

    def wrist(self, q: Vector) -> float:
        """Sine of the fifth joint."""
        return math.sin(q[4])

    def elbow(self, q: Vector) -> float:
        """Sine of the angle between upper arm and the line from the elbow to the wrist point."""
        return math.sin(q[2] + math.atan2(self.a2, self.c3))

    def shoulder(self, q: Vector) -> float:
        """Distance of the wrist point from axis 1 in the plane of the arm [m]."""
        fore, angle = math.hypot(self.a2, self.c3), math.atan2(self.a2, self.c3)
        return (self.a1 + self.c2 * math.sin(q[1]) + fore * math.sin(q[1] + q[2] + angle)) / 1000.0

    def onto(self, kind: str, q: Vector, rng: np.random.Generator) -> Vector | None:
        """Return q moved to the singularity, or None where this arm cannot reach it from there."""
        q = q.copy()
        fore, angle = math.hypot(self.a2, self.c3), math.atan2(self.a2, self.c3)
        if kind == "wrist":
            q[4] = 0.0
        elif kind == "elbow":
            q[2] = -angle + (math.pi if rng.random() < 0.3 else 0.0)
        else:
            sine = -(self.a1 + self.c2 * math.sin(q[1])) / fore
            if abs(sine) > 0.98:
                return None
            q[2] = math.asin(sine) - q[1] - angle
        return q

    def others(self, kind: str, q: Vector) -> float:
        """Return the smallest of the other two functions: how far from a double singularity."""
        size = (abs(self.c2) + abs(self.c3)) / 1000.0
        values = {"wrist": self.wrist(q), "elbow": self.elbow(q), "shoulder": self.shoulder(q) / size}
        return min(abs(value) for name, value in values.items() if name != kind)


def mill(name: str, rng: np.random.Generator) -> tuple[Robot, int]:
    """Return a machine by its letters ("CA head", "AC table", …) with random offsets, and the axis that tilts."""
    letters, place = name.split()
    order = list(letters)

    def offset() -> Element:
        return shift(*rng.uniform(-200, 200, 3))

    slides = [linear(letter, letter.lower()) for letter in "XYZ"]
    turns: list[Element] = []
    for letter in order:
        turns += [offset(), rotary(letter, {"A": "x", "B": "y", "C": "z"}[letter])]
    axes = [axis(letter, 1000.0) for letter in "XYZ"]
    if place == "head":
        axes += [axis(letter) for letter in order]
        robot = Robot(chain_from(axes, [*slides, *turns, offset()]))
    else:
        axes += [axis(letter, carries="workpiece") for letter in order]
        robot = Robot(chain_from(axes, [*slides, offset()], [*turns, offset()]))
    tilting = order[1] if place == "head" else order[0]
    return robot, next(n for n, a in enumerate(robot.axes) if a.name == tilting)
