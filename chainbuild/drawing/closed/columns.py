"""Carriages on columns: tripods and the table on rods."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import JOINT_COLOUR, Body, Colour
from chainbuild.chain.elements import BASE_LINK
from chainbuild.drawing.closed.struts import BALL, CHEEK, GAP, Arm
from chainbuild.drawing.site import UP, Site

# In radii of a rod, away from its pin.
_LUG: Final = 1.4  # half the height of the fork that holds the pin
_FRONT: Final = 2.6  # front of the carriage: clear of the ball
_BACK: Final = 5.0  # its back, on the guide
_GUIDE: Final = 6.0  # back of the guide, front of the column
_COLUMN: Final = 12.0  # back of the column
_HALF_WIDTH: Final = 5.0  # of carriage and column
_RISE: Final = 7.0  # how far a carriage reaches away from the rods
_FOOT: Final = 3.0  # from the guide's lower end to the floor


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
    if arms[0].hangs:
        bodies += _ring(site, arms, top)
    return bodies


def under_arms(site: Site, arms: list[Arm]) -> float:
    """Return the z [m] of a floor under every carriage and rod, however low all go together."""
    lowest = []
    for arm in arms:
        low = _heights(site, arm)[0]
        rod = min(float(arm.end[2] - arm.start[2]) / arm.radius, 0.0)
        lowest.append(float(arm.at(0.0, 0.0, low + rod - _FOOT)[2]))
    return min(lowest)


def column_reach(site: Site, arms: list[Arm]) -> float:
    """Return how far from the middle of the machine its columns end [m]."""
    middle = site.links[BASE_LINK][:3, 3]
    corners = [arm.at(_COLUMN, _HALF_WIDTH, 0.0) - middle for arm in arms]
    return max(float(np.linalg.norm(corner[:2])) for corner in corners)


def _column(site: Site, arm: Arm, floor: float, top: float, colour: Colour) -> list[Body]:
    link, (low, high) = arm.joint.child, _heights(site, arm)
    bottom, rise = (-_LUG, _RISE) if arm.hangs else (-_RISE, _LUG)
    foot, head = ((z - float(arm.start[2])) / arm.radius for z in (floor, top))
    wide, slim = _HALF_WIDTH, 0.5 * _HALF_WIDTH
    return [
        arm.box(site, link, "carriage", (_FRONT, -wide, bottom), (_BACK, wide, rise), colour=colour),
        arm.box(site, link, "cheek", (-BALL, -CHEEK, -_LUG), (_FRONT, -GAP, _LUG), colour=colour),
        arm.box(site, link, "cheek", (-BALL, GAP, -_LUG), (_FRONT, CHEEK, _LUG), colour=colour),
        arm.box(site, BASE_LINK, "guide", (_BACK, -slim, low), (_GUIDE, slim, high), colour=JOINT_COLOUR),
        arm.box(site, BASE_LINK, "column", (_GUIDE, -wide, foot), (_COLUMN, wide, head)),
    ]


def _heights(site: Site, arm: Arm) -> tuple[float, float]:
    """Return how far the carriage of an arm reaches down and up from home over its stroke, in radii of its rod."""
    upwards = float(site.direction(arm.joint)[2])
    ends = [upwards * end / arm.radius for end in site.stroke(arm.joint)]
    below, above = (_LUG, _RISE) if arm.hangs else (_RISE, _LUG)
    return min(ends) - below, max(ends) + above


def _ring(site: Site, arms: list[Arm], top: float) -> list[Body]:
    """Return the beams that lie on the columns from one to the next."""
    heads = [arm.at(0.5 * (_GUIDE + _COLUMN), 0.0, 0.0) for arm in arms]
    return [beam(site, a, b, top, arms[0].radius) for a, b in zip(heads, [*heads[1:], heads[0]], strict=True)]


def beam(site: Site, a: Vector, b: Vector, z: float, radius: float) -> Body:
    """Return a beam over two places (3,), its underside at z [m]; `radius` of a rod gives its section."""
    along = (b - a) * (1.0, 1.0, 0.0)
    length = float(np.linalg.norm(along))
    R = np.column_stack([along / length, np.cross(UP, along / length), UP])
    start = R.T @ a
    half, high = 2.5 * radius, 5.0 * radius
    low = start[0] - half, start[1] - half, z
    return site.box(BASE_LINK, "beam", low, (start[0] + length + half, start[1] + half, z + high), R)
