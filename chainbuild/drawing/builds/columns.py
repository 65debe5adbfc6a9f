"""Carriages on columns: tripods and the table on rods."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.chain.bodies.body import JOINT_COLOUR, Body, Colour
from chainbuild.chain.elements import BASE_LINK
from chainbuild.drawing.builds.bed import level_box
from chainbuild.drawing.builds.struts import BALL, CHEEK, GAP, LUG, Arm
from chainbuild.drawing.site import Site

# In radii of a rod, outwards from its pin.
_FRONT: Final = 2.6  # front of the carriage: clear of the ball
_BACK: Final = 5.0  # its back, on the guide
_GUIDE: Final = 6.0  # back of the guide, front of the column
_COLUMN: Final = 12.0  # back of the column
_HALF_WIDTH: Final = 5.0  # of carriage and column
_RISE: Final = 7.0  # how far a carriage reaches away from the rods
_FOOT: Final = 3.0  # from the guide's or the rod's lower end to the floor
_BEAM: Final = 2.5  # half the section of a beam on the columns


def column_bodies(site: Site, arms: list[Arm], floor: float, colour: Colour) -> list[Body]:
    """Return carriages, guides and columns on a floor; beams between the columns where the rods hang.

    Args:
        site: The machine.
        arms: Its arms.
        floor: z of the floor [m].
        colour: Of the carriages.
    """
    top = max(float(arm.at(0.0, 0.0, _heights(site, arm)[1])[2]) for arm in arms)
    bodies = [body for arm in arms for body in _column(site, arm, floor, top, colour)]
    if not arms[0].hangs:
        return bodies
    heads = [arm.at((_GUIDE + _COLUMN) / 2, 0.0, 0.0) for arm in arms]
    half = _BEAM * arms[0].radius
    between = zip(heads, [*heads[1:], heads[0]], strict=True)
    beams = [level_box(site, BASE_LINK, "beam", ends, half, (top, top + 2 * half)) for ends in between]
    return [*bodies, *beams]


def under_arms(site: Site, arms: list[Arm]) -> float:
    """Return the z [m] of a floor under every carriage and rod, however low all go together."""
    lowest = []
    for arm in arms:
        hanging = min(float(arm.end[2] - arm.start[2]) / arm.radius, 0.0)
        lowest.append(float(arm.at(0.0, 0.0, _heights(site, arm)[0] + hanging - _FOOT)[2]))
    return min(lowest)


def column_reach(arms: list[Arm]) -> float:
    """Return how far from the middle of the machine its columns end [m]."""
    return float(np.hypot(*arms[0].at(_COLUMN, _HALF_WIDTH, 0.0)[:2]))


def _column(site: Site, arm: Arm, floor: float, top: float, colour: Colour) -> list[Body]:
    link, (low, high) = arm.joint.child, _heights(site, arm)
    bottom, rise = (-LUG, _RISE) if arm.hangs else (-_RISE, LUG)
    foot, head = ((z - float(arm.start[2])) / arm.radius for z in (floor, top))
    wide, slim = _HALF_WIDTH, _HALF_WIDTH / 2
    return [
        arm.box(site, link, "carriage", (_FRONT, -wide, bottom), (_BACK, wide, rise), colour=colour),
        arm.box(site, link, "cheek", (-BALL, -CHEEK, -LUG), (_FRONT, -GAP, LUG), colour=colour),
        arm.box(site, link, "cheek", (-BALL, GAP, -LUG), (_FRONT, CHEEK, LUG), colour=colour),
        arm.box(site, BASE_LINK, "guide", (_BACK, -slim, low), (_GUIDE, slim, high), colour=JOINT_COLOUR),
        arm.box(site, BASE_LINK, "column", (_GUIDE, -wide, foot), (_COLUMN, wide, head)),
    ]


def _heights(site: Site, arm: Arm) -> tuple[float, float]:
    """Return how far the carriage of an arm reaches down and up from home over its stroke, in radii of its rod."""
    upwards = float(site.direction(arm.joint)[2])
    ends = [upwards * end / arm.radius for end in site.stroke(arm.joint)]
    below, above = (LUG, _RISE) if arm.hangs else (_RISE, LUG)
    return min(ends) - below, max(ends) + above
