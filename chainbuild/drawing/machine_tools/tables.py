"""What carries the workpiece: plate, cradle and slides, from the part downwards, and the part itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.bodies.body import JOINT_COLOUR, PART_COLOUR, Body, Origin, Part
from chainbuild.chain.elements import BASE_LINK, Joint
from chainbuild.drawing.site import UP, Site, upright_frame

_UPRIGHT: Final = 0.94  # cosine: what turns about a steeper axis is a faceplate
_LEVEL: Final = 0.35  # sine: what turns about a flatter axis is a cradle
_PLATE_SHARE: Final = 0.45  # radius of the plate over the shorter half stroke
_BESIDE_SHARE: Final = 0.12  # likewise over the machine's size, where no slide tells
_BOARD: Final = 0.8  # half the width of a table that does not turn about itself, over half its length
PART_WIDTH: Final = 0.7  # over the plate's radius
PART_HEIGHT: Final = 0.6  # over what the tip leaves above the plate: the tip never touches it at the lowest
_GAP: Final = 1e-3  # m: a tip at rest stands this much above the plate
_PEDESTAL: Final = 0.85  # of what stands on it
_LEAST_ROOM: Final = 0.02  # m above the plate, below which there is no room for a part


@dataclass
class WorkTable:
    """What carries the workpiece.

    Attributes:
        radius: Radius of the plate [m].
        foot: Lowest point (3,) of it, in its middle: where a pedestal of the base goes on.
        half: Half of its widths (2,) along x and y, strokes included [m].
        bodies: Its bodies.
    """

    radius: float
    foot: Vector
    half: Vector
    bodies: list[Body] = field(default_factory=list)


def leading_slides(path: Sequence[Joint]) -> tuple[Joint, ...]:
    """Return the linear joints at the start of a path."""
    count = next((n for n, joint in enumerate(path) if joint.kind != "prismatic"), len(path))
    return tuple(path[:count])


def _upwards(direction: Vector) -> Vector:
    return direction if direction @ UP > 0.0 else -direction


def plate_radius(site: Site) -> float:
    """Return the radius [m] of a plate that fits the strokes of a machine tool, or the size of a robot."""
    given = site.chain.geometry.stand.table
    if given is not None:
        return given / 2
    strokes = [
        (high - low) / 2
        for joint in (*leading_slides(site.tool_path), *site.workpiece_path)
        if joint.kind == "prismatic" and abs(site.direction(joint) @ UP) < _UPRIGHT
        for low, high in (site.stroke(joint),)
    ]
    turns = sum(joint.kind == "revolute" for joint in site.tool_path)
    if not strokes or turns > 3:
        return _BESIDE_SHARE * site.size
    return _PLATE_SHARE * min(strokes)


def lowest(site: Site, height: float) -> float:
    """Return how low [m] something at a height beside the tip at home gets, by upright slides, over the workpiece."""
    return height + sum(low for low, _ in _rises(site))


def _rises(site: Site) -> list[tuple[float, float]]:
    """Return by how much [m] each upright slide may lift the tip over the workpiece from home, down and up."""
    found = []
    for sign, path in ((1.0, site.tool_path), (-1.0, site.workpiece_path)):
        for joint in path:
            rise = sign * float(site.direction(joint) @ UP)
            if joint.kind == "prismatic" and abs(rise) > _UPRIGHT:
                low, high = sorted(rise * value for value in site.stroke(joint))
                found.append((low, high))
    return found


def _plate_height(site: Site, tip: float) -> float:
    """Return the height [m] of the plate's top: the workpiece frame's, but below the tip at home and in the middle."""
    middle = tip + sum((low + high) / 2 for low, high in _rises(site))
    return min(float(site.T_workpiece[2, 3]), min(tip, middle) - _GAP)


def table_beside(site: Site, robot: Sequence[Body]) -> list[Body]:
    """Return what carries the workpiece beside a robot, and the floor under both; nothing where the base does.

    Args:
        site: The machine.
        robot: What is drawn of the robot.
    """
    if not site.workpiece_path:
        return []
    table = worktable(site, float(site.tip[2]))
    boxes = np.array([site.bounds(body) for body in robot if body.link == BASE_LINK])
    foot = float(boxes[:, 0, 2].min())
    on_floor = boxes[boxes[:, 0, 2] < foot + _GAP]
    low, high = on_floor[:, 0].min(axis=0), on_floor[:, 1].max(axis=0)
    floor = min(foot, float(table.foot[2]) - 0.1 * table.radius)
    bodies = [*table.bodies, *pedestal(site, table, floor)]
    if foot - floor > _GAP:
        bodies.append(site.box(BASE_LINK, "pedestal", (*low[:2], floor), (*high[:2], foot)))
    half = _PEDESTAL * table.half
    low, high = np.minimum(low[:2], table.foot[:2] - half), np.maximum(high[:2], table.foot[:2] + half)
    edge = 0.2 * table.radius
    slab = site.box(BASE_LINK, "bed", (*(low - edge), floor - 0.15 * table.radius), (*(high + edge), floor))
    return [*bodies, slab]


def standing(site: Site) -> list[Body]:
    """Return what carries the workpiece, down to the floor in its own place; nothing where the base does."""
    if not site.workpiece_path:
        return []
    table = worktable(site, float(site.tip[2]))
    return [*table.bodies, *pedestal(site, table, min(0.0, float(table.foot[2]) - 0.1 * table.radius))]


def pedestal(site: Site, table: WorkTable, floor: float) -> list[Body]:
    """Return the base's pedestal from the floor [m] to a table."""
    if table.foot[2] - floor < 1e-4:
        return []
    half = np.append(_PEDESTAL * table.half, 0.0)
    low = np.array([table.foot[0], table.foot[1], floor])
    return [site.box(BASE_LINK, "pedestal", low - half, table.foot + half)]


def part_on(site: Site, link: str, foot: Vector, width: float, height: float, R: Matrix | None = None) -> list[Body]:
    """Return the part on a plate or bed: what the overlay says, else a block; none where there is no room.

    Args:
        site: The machine.
        link: Link that carries it.
        foot: Point (3,) on which it stands.
        width: Its width where the overlay says nothing [m].
        height: Its height likewise: what the lowest tip leaves.
        R: (3, 3) axes of a table that is not level; None: the site's.
    """
    given = site.chain.geometry.stand.part
    edges = (width, width, height) if given is None else given
    if min(edges) <= (PART_HEIGHT * _LEAST_ROOM if given is None else 0.0):
        return []
    half = np.array([edges[0] / 2, edges[1] / 2, 0.0])
    origin: Origin = "drawn" if given is None else "data"
    return [site.box(link, "workpiece", -half, half + edges[2] * UP, R, foot, colour=PART_COLOUR, origin=origin)]


def worktable(site: Site, tip: float) -> WorkTable:
    """Return what carries the workpiece, from the plate down to the base.

    Args:
        site: The machine.
        tip: Height [m] of the lowest point of head and tool at home.
    """
    return _Drawing(site, site.workpiece_path, tip).table


class _Drawing:
    """Builds a table downwards. `foot` is the middle of what the part drawn last stands on."""

    def __init__(self, site: Site, joints: Sequence[Joint], tip: float) -> None:
        self.site, self.tip = site, tip
        self.R = plate_radius(site)
        self.bodies: list[Body] = []
        self.top = _plate_height(site, tip)
        self.foot = np.array([*site.T_workpiece[:2, 3], self.top])
        self.half = np.full(2, self.R)
        last, thick = joints[-1], 0.16 * self.R
        along = site.direction(last)
        if last.kind == "revolute" and abs(along @ UP) > _UPRIGHT:  # a disc that turns about itself
            self.foot = self._on_axis(last, self.top)
            plate = self.foot - thick * _upwards(along)
            self.bodies.append(site.cylinder(last.child, "table", plate, self.foot, self.R, origin="data"))
        else:
            Q = upright_frame(along) if abs(along @ UP) < _UPRIGHT else np.eye(3)
            plate = self.foot - thick * Q[:, 2]
            low, high = (-self.R, -_BOARD * self.R, -thick), (self.R, _BOARD * self.R, 0.0)
            self.bodies.append(site.box(last.child, "table", low, high, Q, self.foot, origin="data"))
        self._part(last.child)
        self.foot = plate
        for joint in reversed(joints):
            self._joint(joint)
        self.table = WorkTable(self.R, self.foot, self.half, self.bodies)

    def _on_axis(self, joint: Joint, height: float) -> Vector:
        """Return the point (3,) of an axis at a height [m]."""
        axis, along = self.site.origin(joint), self.site.direction(joint)
        point: Vector = axis + along * ((height - axis[2]) / along[2])
        return point

    def _part(self, link: str) -> None:
        room = lowest(self.site, self.tip) - self.top
        height = min(PART_HEIGHT * room, 0.9 * self.R)
        self.bodies += part_on(self.site, link, self.foot, PART_WIDTH * self.R, height)

    def _joint(self, joint: Joint) -> None:
        along = self.site.direction(joint)
        rise = abs(float(along @ UP))
        if joint.kind == "prismatic":
            if rise > _UPRIGHT:
                self._lift(joint)
            else:
                self._slide(joint, along)
        elif rise > _UPRIGHT:
            self._housing(joint)
        elif rise < _LEVEL:
            self._cradle(joint, along)
        else:
            self._slanted(joint, along)

    def _housing(self, joint: Joint) -> None:
        """Draw the housing of an upright axis on the parent; the child is a plate, or gets one."""
        site, R = self.site, self.R
        up, start = _upwards(site.direction(joint)), self._on_axis(joint, float(self.foot[2]))
        if any(body.link == joint.child and body.part == "table" for body in self.bodies):
            radius, height = 0.75 * R, 0.35 * R
        else:
            radius, height = 1.05 * float(self.half.max()), 0.3 * R
            plate = start - 0.16 * R * up
            self.bodies.append(site.cylinder(joint.child, "plate", plate, start, radius))
            start = plate
        end = start - height * up
        self.bodies.append(site.cylinder(joint.parent, "housing", end, start, 0.85 * radius))
        self.half = np.maximum(self.half, radius) + np.abs((end - self.foot)[:2])
        self.foot = end

    def _cradle(self, joint: Joint, along: Vector) -> None:
        """Draw a cradle with cheeks up to the axis on the child, bearings and foot on the parent."""
        site, R = self.site, self.R
        Q = upright_frame(along)
        axis = self.site.origin(joint)
        centre = axis + along * float((self.foot - axis) @ along)
        reach, off = float(self.half.max()), float((self.foot - centre) @ Q[:, 1])
        under = float((self.foot - centre) @ Q[:, 2])  # of the cradle's top, seen from the axis
        floor = under - 0.2 * R
        inner, outer = 1.08 * reach, 1.08 * reach + 0.22 * R

        def box(link: str, part: Part, x: tuple[float, float], y: float, z: tuple[float, float]) -> None:
            self.bodies.append(site.box(link, part, (x[0], -y, z[0]), (x[1], y, z[1]), Q, centre))

        across = abs(off) + 0.55 * R
        box(joint.child, "cradle", (-outer, outer), across, (floor, under))
        low, high = min(floor, -0.3 * R), max(under, 0.3 * R)
        for sign in (-1.0, 1.0):
            box(joint.child, "cheek", (sign * inner, sign * outer), 0.4 * R, (low, high))
        journal, end = outer + 0.25 * R, outer + 0.55 * R
        for sign in (-1.0, 1.0):
            # Through the bearing: the axis that tilts is seen from outside.
            ends = centre + sign * outer * along, centre + sign * (end + 0.06 * R) * along
            self.bodies.append(site.cylinder(joint.child, "joint", *ends, 0.18 * R, colour=JOINT_COLOUR))
        across = abs(off) + reach
        swept = float(np.hypot(across, max(abs(floor), abs(self.top - axis[2])))) + 0.06 * R
        for sign in (-1.0, 1.0):
            box(joint.parent, "post", (sign * (journal - 0.2 * R), sign * end), 0.42 * R, (-swept - 0.2 * R, 0.38 * R))
        box(joint.parent, "bed", (-end, end), 0.6 * R, (-swept - 0.3 * R, -swept))
        self.foot = centre - (swept + 0.3 * R) * Q[:, 2]
        self.half = np.abs(Q[:2, 0]) * end + np.abs(Q[:2, 1]) * (across + 0.1 * R)
        self.top = float(axis[2]) + swept

    def _slanted(self, joint: Joint, along: Vector) -> None:
        """Draw a disc on the child and a housing on the parent, both about a slanted axis."""
        site, R = self.site, self.R
        down = -along if along @ UP > 0.0 else along
        axis = site.origin(joint)
        drop = max(float(axis[2] - self.foot[2]) / -float(down @ UP), 0.0)
        centre = axis + drop * down
        self.bodies.append(site.cylinder(joint.child, "neck", self.foot, centre + 0.2 * R * down, 0.5 * R))
        self.bodies.append(
            site.cylinder(joint.child, "plate", centre + 0.2 * R * down, centre + 0.4 * R * down, 0.8 * R)
        )
        end = centre + 1.1 * R * down
        self.bodies.append(site.cylinder(joint.parent, "housing", centre + 0.4 * R * down, end, 0.8 * R))
        foot = end - 0.6 * R * UP
        self.bodies.append(site.cylinder(joint.parent, "pedestal", foot, end, 0.55 * R))
        self.foot = foot
        self.half = np.maximum(self.half, np.abs((end - self.foot)[:2]) + R)

    def _slide(self, joint: Joint, along: Vector) -> None:
        """Draw a slide on the child and its guideway over the whole stroke on the parent."""
        site, R = self.site, self.R
        Q = upright_frame(along)
        low, high = site.stroke(joint)
        thick, half = 0.22 * R, 0.75 * R
        a, b = (-R, -1.05 * half, -thick), (R, 1.05 * half, 0.0)
        self.bodies.append(site.box(joint.child, "slide", a, b, Q, self.foot))
        a, b = (low - R, -0.8 * half, -2.0 * thick), (high + R, 0.8 * half, -thick)
        self.bodies.append(site.box(joint.parent, "guide", a, b, Q, self.foot))
        self.foot = self.foot + Q @ np.array([(low + high) / 2, 0.0, -2.0 * thick])
        reach = np.abs(Q[:2, 0]) * ((high - low) / 2 + R) + np.abs(Q[:2, 1]) * half
        self.half = np.maximum(self.half, reach)

    def _lift(self, joint: Joint) -> None:
        """Draw a pillar on the child and the sleeve on the parent that it rises from, over the whole stroke."""
        site, R = self.site, self.R
        rise = float(site.direction(joint) @ UP)
        low, high = sorted(rise * value for value in site.stroke(joint))
        half = np.array([1.0, 1.0, 0.0]) * R
        pillar = self.foot - (high - low + 0.3 * R) * UP
        self.bodies.append(site.box(joint.child, "slide", pillar - 0.45 * half, self.foot + 0.45 * half))
        top, bottom = self.foot + (low - 0.1 * R) * UP, self.foot + (2 * low - high - 0.4 * R) * UP
        self.bodies.append(site.box(joint.parent, "column", bottom - 0.62 * half, top + 0.62 * half))
        self.foot = bottom
