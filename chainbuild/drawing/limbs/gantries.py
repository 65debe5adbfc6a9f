"""A gantry: runways on posts, a bridge, a carriage and the ram that an arm hangs from."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import Body, Part
from chainbuild.chain.elements import BASE_LINK, Joint
from chainbuild.drawing.limbs.pieces import Extent, block, upright
from chainbuild.drawing.limbs.plan import UPRIGHT
from chainbuild.drawing.limbs.seats import Seat
from chainbuild.drawing.site import Site

_Z: Final = np.array([0.0, 0.0, 1.0])


def gantry(site: Site, slides: Sequence[Joint], mount: Vector, seat: Seat) -> list[Body]:
    """Return the bodies of a gantry down to where an arm hangs.

    Args:
        site: The site.
        slides: Its linear axes from the floor.
        mount: (3,) the lower end of the ram, where the arm hangs [m].
        seat: Seat of the arm's first joint.
    """
    return _Gantry(site, slides, mount, seat).bodies()


class _Gantry:
    """Measures of a gantry, in a frame with x along its bridge's way, y along the bridge, z up."""

    def __init__(self, site: Site, slides: Sequence[Joint], mount: Vector, seat: Seat) -> None:
        self.site, self.slides, self.seat = site, slides, seat
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
        # The bridge lies over the highest place of the arm's foot and shoulder.
        self.below = max(self.hang + 0.4 * r, float(seat.place[2]) + 1.7 * r) + self.strokes[2][1]
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

    def _box(self, link: str, part: Part, x: Extent, y: Extent, z: Extent) -> Body:
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
        high = self.top + 1.6 * h - self.strokes[2][0]
        ram = self.slides[-1].child
        bodies.append(self._box(ram, "ram", (-h, h), (-h, h), (self.hang, high)))
        return bodies
