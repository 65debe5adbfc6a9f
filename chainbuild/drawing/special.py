"""Machines with a rule of their own: lathes, the eccentric disc, the SCARA, the lever on a slide."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import JOINT_COLOUR, Body
from chainbuild.chain.elements import BASE_LINK
from chainbuild.drawing.bed import bed_height, part_block, tips, tool_bodies
from chainbuild.drawing.lathes import disc_bodies, lathe_bodies
from chainbuild.drawing.site import UP, Site

_ARM: Final = 0.16  # half the width of a SCARA's arms over the length of the shorter one
_ARM_HEIGHT: Final = 2.0  # their height over half their width
_FOOT: Final = 2.2  # half the width of the foot over half that of the arms
_LEVER: Final = 0.05  # half the section of a lever over its length
_TIP: Final = 0.8  # of the lever: from there on it is tool
_SLIDE: Final = 0.2  # half the length of the slide under a lever over the lever's length
_STACK: Final = 0.45  # of the room below the lever's tip: height of guide and slide, over which it passes
_PART: Final = 0.2  # width of the part over the reach


def special_bodies(site: Site) -> list[Body]:
    """Return the bodies of a machine with a rule of its own."""
    if site.workpiece_path:
        return lathe_bodies(site)
    kinds = [joint.kind for joint in site.tool_path]
    if kinds == ["prismatic", "revolute"]:
        return _lever(site)
    return _scara(site) if kinds[0] == "revolute" else disc_bodies(site)


def _scara(site: Site) -> list[Body]:
    """Return column, two arms and the quill of a SCARA; the arms are above all that the quill lifts."""
    shoulder, elbow, quill, wrist = site.tool_path
    a, b, c = (site.links[joint.child][:3, 3] for joint in (shoulder, elbow, wrist))
    lengths = [float(np.linalg.norm((far - near)[:2])) for near, far in ((a, b), (b, c))]
    w = site.radius(shoulder.child, _ARM * min(lengths))
    height, (low, high) = _ARM_HEIGHT * w, sorted(float(site.direction(quill)[2]) * end for end in site.stroke(quill))
    first = float(c[2]) + high + w
    second = first + height
    lowest = float(tips(site)[:, 2].min())
    bed = bed_height(site, lowest)
    x, y = a[:2]
    top = second + height - low + w
    reach, foot = sum(lengths), _FOOT * w
    return [
        site.box(BASE_LINK, "foot", (x - foot, y - foot, bed), (x + foot, y + foot, bed + w)),
        site.cylinder(BASE_LINK, "column", (x, y, bed + w), (x, y, first), 1.2 * w),
        *_level_arm(site, shoulder.child, a, b, (first, second), w),
        *_level_arm(site, elbow.child, b, c, (second, second + height), 0.9 * w),
        site.cylinder(elbow.child, "housing", (*b[:2], second + height), (*b[:2], second + 1.6 * height), 0.7 * w),
        site.cylinder(quill.child, "ram", c, (*c[:2], top), 0.4 * w, colour=JOINT_COLOUR),
        *tool_bodies(site, c, 0.55 * w),
        site.box(
            BASE_LINK, "bed", (x - 2.0 * foot, y - 0.6 * reach, bed - w), (x + reach + foot, y + 0.6 * reach, bed)
        ),
        *part_block(site, BASE_LINK, (*site.tip[:2], bed), _PART * reach, lowest - bed),
    ]  # fmt: skip


def _level_arm(site: Site, link: str, a: Vector, b: Vector, heights: tuple[float, float], w: float) -> list[Body]:
    """Return a level arm with round ends from one upright axis to the next."""
    along = (b - a) * (1.0, 1.0, 0.0)
    length = float(np.linalg.norm(along))
    R = np.column_stack([along / length, np.cross(UP, along / length), UP])
    x, y, _ = R.T @ a
    low, high = heights
    return [
        site.box(link, "arm", (x, y - w, low), (x + length, y + w, high), R),
        site.cylinder(link, "joint", (*a[:2], low), (*a[:2], high), 1.15 * w),
        site.cylinder(link, "joint", (*b[:2], low), (*b[:2], high), w),
    ]


def _lever(site: Site) -> list[Body]:
    """Return a slide with a forked tower, and the lever that swings in the fork."""
    slide, joint = site.tool_path
    d, pivot, tip = site.direction(slide), site.origin(joint), site.tip
    back = np.cross(UP, d)
    if float((tip - pivot) @ d) < 0.0:
        d, back = -d, -back
    R = np.column_stack([d, back, UP])
    length = float(np.linalg.norm(tip - pivot))
    w = site.radius(joint.child, _LEVER * length)
    lowest = float(tips(site)[:, 2].min())
    bed = bed_height(site, lowest)
    x, y, z = R.T @ pivot
    half, stack = _SLIDE * length, _STACK * (lowest - bed)
    runs = [float(site.direction(slide) @ d) * end for end in site.stroke(slide)]
    left, right = x + min(runs) - half, x + max(runs) + half
    deck, low, gap, wide = bed + stack, bed + 0.3 * stack, 1.2 * w, 2.4 * w
    width = _PART * length
    along = (tip - pivot) / length
    turned = np.column_stack([along, np.cross(_upwards(along, back), along), _upwards(along, back)])
    lever = turned.T @ pivot
    place = R @ (right + 0.7 * width, y, bed)
    return [
        site.box(joint.child, "lever", lever - w, lever + np.array([_TIP * length, w, w]), turned, origin="data"),
        site.cylinder(joint.child, "joint", pivot - wide * back, pivot + wide * back, 1.6 * w, colour=JOINT_COLOUR),
        *tool_bodies(site, pivot + _TIP * length * along, 0.7 * w),
        site.box(slide.child, "cheek", (x - 2.0 * w, y - wide, deck), (x + 2.0 * w, y - gap, z + 2.0 * w), R),
        site.box(slide.child, "cheek", (x - 2.0 * w, y + gap, deck), (x + 2.0 * w, y + wide, z + 2.0 * w), R),
        site.box(slide.child, "carriage", (x - half, y - 1.3 * wide, low), (x + half, y + 1.3 * wide, deck), R),
        site.box(BASE_LINK, "guide", (left, y - wide, bed), (right, y + wide, low), R, colour=JOINT_COLOUR),
        site.box(BASE_LINK, "bed", (left - w, y - 2.0 * wide, bed - w), (right + 1.4 * width, y + 2.0 * wide, bed), R),
        *part_block(site, BASE_LINK, place, width, lowest - bed),
    ]


def _upwards(along: Vector, back: Vector) -> Vector:
    """Return the direction across a lever in its plane."""
    return np.asarray(np.cross(along, back))
