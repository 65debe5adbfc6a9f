"""An arm of closed loops: its rod, the pin on which it swings, and the measures of what drives it.

Every length of an arm's castings is a multiple of the radius of its rod. Where the platform never turns, each arm has
two rods, as tripods and delta robots have to keep it level. The pair shears as the platform moves aside, which no fixed
body does: both are of one link, and follow the line between them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.bodies.body import JOINT_COLOUR, Body, Colour, Origin, Part
from chainbuild.chain.elements import BASE_LINK, Chain, Joint
from chainbuild.drawing.site import UP, Site
from chainbuild.shown import fields_shown

# In radii of a rod.
BALL: Final = 1.6  # a joint's ball is thicker than the rod
GAP: Final = 2.3  # half the fork that holds a pin: the ball fits, and the rod may lean by 30°
CHEEK: Final = 3.1  # half its outer width
PAIR: Final = CHEEK + 2.0  # half the distance of two rods: their balls clear the fork between them
LUG: Final = 1.4  # half its height

_ROD: Final = 0.016  # radius over length of a rod: slim, but to be seen in a small picture
_ROD_AT_PIN: Final = 0.2  # of the way from a platform's middle to its pins: balls beside one another stay apart
_PAIR_AT_PIN: Final = 0.13  # likewise for two rods
_PIN: Final = 0.8  # radii of a rod: of the pin on which it swings
_EDGE: Final = 4.0  # likewise: height of the foot, and how far it reaches beyond what stands on it
_UPRIGHT: Final = 1e-6  # sine to the vertical: nothing tells which way an upright hinge faces

_Place = tuple[float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Arm:
    """An arm of closed loops at home.

    Attributes:
        joint: The joint that its axis drives.
        swing: Link behind the first passive joint.
        rod: Link of the rod: that behind the last passive joint.
        start: Where the rod begins (3,).
        end: Where it ends, at the pin of the platform.
        R: (3, 3) columns: horizontally outwards, along the hinge, up.
        radius: Of the rod [m].
        pair: Whether two rods beside the line from start to end keep the platform from turning.
    """

    __repr__ = fields_shown

    joint: Joint
    swing: str
    rod: str
    start: Vector
    end: Vector
    R: Matrix
    radius: float
    pair: bool

    @property
    def hangs(self) -> bool:
        """Whether the rod leads downwards."""
        return bool(self.end[2] < self.start[2])

    def at(self, out: float, aside: float, up: float) -> Vector:
        """Return a place (3,) given from the start of the rod in its radii: outwards, along the hinge, up."""
        return np.asarray(self.start + self.R @ (self.radius * np.array([out, aside, up])))

    def box(
        self, site: Site, link: str, part: Part, low: _Place, high: _Place, *,
        colour: Colour | None = None, origin: Origin = "drawn",
    ) -> Body:  # fmt: skip
        """Return a box between two such places."""
        a, b = self.radius * np.array(low), self.radius * np.array(high)
        return site.box(link, part, a, b, self.R, self.start, colour=colour, origin=origin)


def platform_of(chain: Chain) -> str | None:
    """Return the link on which several loops end; None where there is none."""
    ends = [chain.frame(name).link for loop in chain.loops for name in (loop.frame_a, loop.frame_b)]
    return next((link for link in ends if ends.count(link) > 1), None)


def arms_of(site: Site, platform: str) -> list[Arm]:
    """Return the arms that end at a platform, in the order of their loops."""
    chain, arms = site.chain, []
    driven = [axis.name for axis in chain.axes]
    for loop in chain.loops:
        rods = [name for name in (loop.frame_a, loop.frame_b) if chain.frame(name).link != platform]
        path = site.path_to(chain.frame(rods[0]).link)
        if path[0].name in driven:
            level = all(joint.kind == "prismatic" for joint in site.path_to(platform))
            arms.append(_arm(site, path, site.frame(rods[0])[:3, 3], site.links[platform][:3, 3], level))
    return arms


def _arm(site: Site, path: tuple[Joint, ...], end: Vector, middle: Vector, pair: bool) -> Arm:
    start, hinge, rod = site.links[path[1].child][:3, 3], site.direction(path[1]), path[-1].child
    pin = float(np.hypot(*(end - middle)[:2]))
    default = min(_ROD * float(np.linalg.norm(end - start)), (_PAIR_AT_PIN if pair else _ROD_AT_PIN) * pin)
    across = np.cross(hinge, UP)
    level = float(np.linalg.norm(across))
    across = across / level if level > _UPRIGHT else np.array([1.0, 0.0, 0.0])
    R = np.column_stack([across, np.cross(UP, across), UP])  # a hinge that leans is drawn level
    return Arm(path[0], path[1].child, rod, start, end, R, site.radius(rod, default), pair)


def rod_bodies(site: Site, arm: Arm, colour: Colour) -> list[Body]:
    """Return a rod, or a pair of them, with balls at the ends, and the pin on which it swings."""
    r, half = arm.radius, (PAIR if arm.pair else CHEEK)
    pin = arm.at(0.0, -half, 0.0), arm.at(0.0, half, 0.0)
    bodies = [site.cylinder(arm.swing, "joint", *pin, _PIN * r, colour=JOINT_COLOUR)]
    across = arm.R[:, 1] * (PAIR * r)
    for aside in (-across, across) if arm.pair else (np.zeros(3),):
        start, end = arm.start + aside, arm.end + aside
        bodies += [
            site.cylinder(arm.rod, "rod", start, end, r, colour=colour, origin="drawn" if arm.pair else "data"),
            site.ball(arm.rod, "joint", start, BALL * r, colour=JOINT_COLOUR),
            site.ball(arm.rod, "joint", end, BALL * r, colour=JOINT_COLOUR),
        ]
    if arm.pair:
        ends = arm.end - across, arm.end + across
        bodies.append(site.cylinder(arm.rod, "joint", *ends, _PIN * r, colour=JOINT_COLOUR))
    return bodies


def round_foot(site: Site, floor: float, reach: float, arm: Arm) -> Body:
    """Return the disc on which a machine stands.

    Args:
        site: The machine.
        floor: z of its top [m].
        reach: How far from the middle something stands on it [m].
        arm: An arm, for how thick it is.
    """
    edge = _EDGE * arm.radius
    return site.cylinder(BASE_LINK, "bed", (0.0, 0.0, floor - edge), (0.0, 0.0, floor), reach + edge)
