"""A gantry: runways on posts, a bridge, a carriage and the ram that an arm hangs from."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import Body, Part
from chainbuild.chain.elements import BASE_LINK, Joint
from chainbuild.drawing.limbs.pieces import Range, block, upright
from chainbuild.drawing.limbs.seats import UPRIGHT, Seat
from chainbuild.drawing.site import Site

_Z: Final = np.array([0.0, 0.0, 1.0])


def gantry(site: Site, slides: Sequence[Joint], mount: Vector, seat: Seat, *, foot: bool) -> list[Body]:
    """Return the bodies of a gantry down to where an arm hangs.

    Args:
        site: The site.
        slides: Its linear axes from the floor.
        mount: (3,) where the arm hangs [m].
        seat: Seat of the arm's first joint.
        foot: Whether the arm has a foot of its own; else the ram reaches down to its first joint.
    """
    return _Gantry(site, slides, mount, seat, foot).bodies()


class _Gantry:
    """Measures of a gantry, in a frame with x along its bridge's way, y along the bridge, z up."""

    def __init__(self, site: Site, slides: Sequence[Joint], mount: Vector, seat: Seat, foot: bool) -> None:
        self.site, self.slides, self.seat, self.foot = site, slides, seat, foot
        level = [joint for joint in slides if abs(site.direction(joint)[2]) < UPRIGHT]
        self.lift = next((joint for joint in slides if joint not in level), None)
        self.travel = level[0] if len(level) > 1 else None
        self.cross = level[-1] if level else None
        y = site.direction(self.cross) if self.cross is not None else np.eye(3)[1]
        self.R = upright(np.cross(y, _Z))
        self.at = np.array([mount[0], mount[1], 0.0])
        self.hang = float(mount[2])
        r = self.r = seat.radius
        self.strokes = [self._stroke(joint, n) for n, joint in ((0, self.travel), (1, self.cross), (2, self.lift))]
        self.half = max(0.6 * r, 0.05 * (self.strokes[2][1] - self.strokes[2][0]))
        h = self.half
        self.sleeve = 1.5 * h
        self.beam = 3.2 * h  # height of the bridge
        # The bridge hangs over the highest place of the arm's foot.
        self.below = float(mount[2]) + self.strokes[2][1] + 0.4 * r
        self.top = self.below + self.beam
        # Beside the ram, which passes the bridge.
        self.bridge = (-self.sleeve - 2.4 * h, -self.sleeve)
        margin = max(4.0 * r, 0.08 * (self.strokes[1][1] - self.strokes[1][0]))
        self.sides = (self.strokes[1][0] - margin, self.strokes[1][1] + margin)

    def _stroke(self, joint: Joint | None, n: int) -> tuple[float, float]:
        if joint is None:
            return 0.0, 0.0
        d = float((self.R.T @ self.site.direction(joint))[n])
        low, high = sorted(end * d for end in self.site.stroke(joint))
        return low, high

    def _box(self, link: str, part: Part, x: Range, y: Range, z: Range) -> Body:
        return block(self.site, link, part, self.R, self.at, x, y, z)

    def bodies(self) -> list[Body]:
        """Return its bodies."""
        return [*self._runways(), *self._bridge(), *self._carriage()]

    def _runways(self) -> list[Body]:
        """Return what stands on the floor: runways on posts, or the posts of a fixed beam."""
        h = self.half
        if self.travel is None:
            x = self.bridge
            ends = [(x, (side - 1.2 * h, side + 1.2 * h)) for side in self.sides]
            return [self._box(BASE_LINK, "post", *end, (self._floor(), self.below)) for end in ends]
        low = self.strokes[0][0] + self.bridge[0] - 3.0 * h
        high = self.strokes[0][1] + self.bridge[1] + 3.0 * h
        deep = self.below - 2.0 * h
        bodies = []
        count = 2 + int((high - low) / (2.2 * (self.below - self._floor())))
        for side in self.sides:
            y = (side - 0.9 * h, side + 0.9 * h)
            bodies.append(self._box(BASE_LINK, "beam", (low, high), y, (deep, self.below)))
            for middle in np.linspace(low + 1.0 * h, high - 1.0 * h, count):
                x = (float(middle - 0.8 * h), float(middle + 0.8 * h))
                bodies.append(self._box(BASE_LINK, "post", x, (y[0] + 0.1 * h, y[1] - 0.1 * h), (self._floor(), deep)))
        return bodies

    def _floor(self) -> float:
        lowest = min(self.site.tip[2], self.seat.place[2]) + self.strokes[2][0]
        return min(0.0, float(lowest) - self.r)

    def _bridge(self) -> list[Body]:
        """Return the beam that the carriage runs on, with trucks where it runs on runways."""
        h, link = self.half, self.travel.child if self.travel is not None else BASE_LINK
        y = (self.sides[0] - 1.2 * h, self.sides[1] + 1.2 * h)
        bodies = [self._box(link, "bridge", self.bridge, y, (self.below, self.top))]
        if self.travel is not None:
            x = (self.bridge[0] - 1.6 * h, self.bridge[1] + 1.6 * h)
            for side in self.sides:
                ends = (side - 1.2 * h, side + 1.2 * h)
                bodies.append(self._box(link, "carriage", x, ends, (self.below, self.below + 1.2 * h)))
        return bodies

    def _carriage(self) -> list[Body]:
        """Return the carriage on the bridge and the ram through it."""
        h, s = self.half, self.sleeve
        link = self.cross.child if self.cross is not None else BASE_LINK
        bodies = [
            self._box(link, "carriage", (-s, s), (-1.6 * s, 1.6 * s), (self.below, self.top)),
            self._box(link, "carriage", (self.bridge[0], s), (-1.6 * s, 1.6 * s), (self.top, self.top + 0.8 * h)),
        ]
        end = self.hang if self.foot else float(self.seat.place[2])
        high = self.top + 1.6 * h - self.strokes[2][0]
        ram = self.slides[-1].child
        bodies.append(self._box(ram, "ram", (-h, h), (-h, h), (end, high)))
        return bodies
