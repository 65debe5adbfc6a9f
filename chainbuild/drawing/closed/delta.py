"""Levers that motors under a plate turn: the delta robot, hung from posts."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.chain.bodies.body import JOINT_COLOUR, TOOL_SIDE, Body
from chainbuild.chain.elements import BASE_LINK
from chainbuild.drawing.closed.columns import beam
from chainbuild.drawing.closed.struts import CHEEK, GAP, Arm, round_foot
from chainbuild.drawing.site import UP, Site

# In radii of a rod.
_MOTOR: Final = 3.5  # a motor, and how far the plate is above its axis
_MOTOR_LENGTH: Final = 11.0
_BEARING: Final = 2.5  # on the other side of the lever
_HUB: Final = 2.6  # of the lever
_LEVER: Final = 1.4  # half its height
_WEB: Final = 4.0  # the web between its two bars ends before the elbow: there the rod swings
_PLATE: Final = 3.0  # its thickness
_POSTS: Final = 6.0  # from the stretched levers to the posts


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
    link, r, hinge = arm.joint.child, arm.radius, arm.R[:, 1] * arm.radius
    axis = site.origin(arm.joint)
    length = float(np.linalg.norm(arm.start - axis)) / r
    out = (arm.start - axis) / (length * r)
    R = np.column_stack([out, arm.R[:, 1], np.cross(out, arm.R[:, 1])])
    base, half = R.T @ axis / r, _LEVER

    def bar(low: tuple[float, float], end: float, height: float) -> Body:
        a, b = base + np.array([0.0, low[0], -height]), base + np.array([end, low[1], height])
        return site.box(link, "lever", r * a, r * b, R, colour=TOOL_SIDE[0], origin="data")

    return [
        bar((-CHEEK, -GAP), length, half),
        bar((GAP, CHEEK), length, half),
        bar((-GAP, GAP), length - _WEB, 0.6 * half),
        site.cylinder(link, "joint", axis - CHEEK * hinge, axis + CHEEK * hinge, _HUB * r, colour=TOOL_SIDE[0]),
        site.cylinder(
            BASE_LINK, "housing", axis + CHEEK * hinge, axis + (CHEEK + _MOTOR_LENGTH) * hinge, _MOTOR * r,
            colour=JOINT_COLOUR,
        ),
        site.cylinder(
            BASE_LINK, "housing", axis - CHEEK * hinge, axis - (CHEEK + _BEARING) * hinge, _MOTOR * r,
            colour=JOINT_COLOUR,
        ),
    ]  # fmt: skip


def _gallows(site: Site, arms: list[Arm], floor: float) -> list[Body]:
    """Return the plate over the motors, posts between the arms beyond their reach, and a foot."""
    r, middle = arms[0].radius, site.links[BASE_LINK][:3, 3]
    axes = [site.origin(arm.joint) for arm in arms]
    under = max(float(axis[2]) for axis in axes) + _MOTOR * r
    inner = max(float(np.linalg.norm((axis - middle)[:2])) for axis in axes)
    outer = max(
        float(np.linalg.norm((axis - middle)[:2]) + np.linalg.norm(arm.start - axis))
        for axis, arm in zip(axes, arms, strict=True)
    )
    plate = (*middle[:2], under), (*middle[:2], under + _PLATE * r)
    bodies = [site.cylinder(BASE_LINK, "plate", *plate, inner)]
    for arm in arms:
        R = np.column_stack([-arm.R[:, 0], -arm.R[:, 1], UP])  # opposite to an arm is between the two others
        x, y, _ = R.T @ middle
        place = x + outer + _POSTS * r
        end = R @ (place, y, under)
        bodies.append(beam(site, middle, end, under, r))
        half = 2.5 * r
        bodies.append(site.box(BASE_LINK, "post", (place - half, y - half, floor), (place + half, y + half, under), R))
    return [*bodies, round_foot(site, floor, outer + _POSTS * r, arms[0])]
