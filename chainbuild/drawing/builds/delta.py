"""Levers that motors under a plate turn: the delta robot, hung from posts."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.chain.bodies.body import JOINT_COLOUR, TOOL_SIDE, Body, Part
from chainbuild.chain.elements import BASE_LINK
from chainbuild.drawing.builds.bed import level_box
from chainbuild.drawing.builds.struts import CHEEK, GAP, LUG, Arm, round_foot
from chainbuild.drawing.site import Site

# In radii of a rod.
_MOTOR: Final = 3.5  # a motor, and how far the plate is above its axis
_MOTOR_LENGTH: Final = 11.0  # as long as motor and gear look right
_BEARING: Final = 2.5  # on the other side of the lever
_HUB: Final = 2.6  # of the lever: thinner than the motor
_WEB: Final = 4.0  # the web between its two bars ends before the elbow: there the rod swings
_WEB_HALF: Final = 0.8  # half the height of the web: the bars show beside it
_PLATE: Final = 3.0  # its thickness
_POSTS: Final = 6.0  # from the stretched levers to the posts
_POST: Final = 2.5  # half the section of posts and beams


def delta_bodies(site: Site, arms: list[Arm], floor: float) -> list[Body]:
    """Return motors, levers, the plate above them, and what it hangs from.

    Args:
        site: The machine.
        arms: Its arms.
        floor: z of the floor [m].
    """
    return [*(body for arm in arms for body in _lever(site, arm)), *_gallows(site, arms, floor)]


def _lever(site: Site, arm: Arm) -> list[Body]:
    """Return a lever of two bars between which the rod swings, its hub, motor and bearing."""
    link, r, hinge = arm.joint.child, arm.radius, arm.R[:, 1]
    axis = site.origin(arm.joint)
    length = float(np.linalg.norm(arm.start - axis))
    out = (arm.start - axis) / length
    R = np.column_stack([out, hinge, np.cross(out, hinge)])

    def bar(sides: tuple[float, float], end: float, half: float) -> Body:
        a, b = (0.0, r * sides[0], -r * half), (end, r * sides[1], r * half)
        return site.box(link, "lever", a, b, R, axis, colour=TOOL_SIDE[0], origin="data")

    def round_part(name: str, part: Part, radius: float, start: float, end: float) -> Body:
        colour = TOOL_SIDE[0] if name == link else JOINT_COLOUR
        return site.cylinder(name, part, axis + start * r * hinge, axis + end * r * hinge, radius * r, colour=colour)

    return [
        bar((-CHEEK, -GAP), length, LUG),
        bar((GAP, CHEEK), length, LUG),
        bar((-GAP, GAP), length - _WEB * r, _WEB_HALF),
        round_part(link, "joint", _HUB, -CHEEK, CHEEK),
        round_part(BASE_LINK, "housing", _MOTOR, CHEEK, CHEEK + _MOTOR_LENGTH),
        round_part(BASE_LINK, "housing", _MOTOR, -CHEEK, -CHEEK - _BEARING),
    ]


def _gallows(site: Site, arms: list[Arm], floor: float) -> list[Body]:
    """Return the plate over the motors, posts between the arms beyond their reach, and a foot."""
    arm = arms[0]
    r, axis = arm.radius, site.origin(arm.joint)
    under, half, inner = float(axis[2]) + _MOTOR * r, _POST * r, float(np.hypot(*axis[:2]))
    reach = inner + float(np.linalg.norm(arm.start - axis)) + _POSTS * r
    bodies = [site.cylinder(BASE_LINK, "plate", (0.0, 0.0, under), (0.0, 0.0, under + _PLATE * r), inner)]
    for one in arms:
        out = -one.R[:, 0]  # opposite to an arm is between the two others
        ends = np.zeros(3), (reach + half) * out
        bodies.append(level_box(site, BASE_LINK, "beam", ends, half, (under, under + 2 * half)))
        ends = (reach - half) * out, (reach + half) * out
        bodies.append(level_box(site, BASE_LINK, "post", ends, half, (floor, under)))
    return [*bodies, round_foot(site, floor, reach, arm)]
