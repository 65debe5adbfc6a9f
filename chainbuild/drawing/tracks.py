"""What a robot stands on or hangs from: a foot on the floor, a track, cross slides, a lifting column, a gantry."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import Body
from chainbuild.chain.bodies.rods import LEVEL_PLATE
from chainbuild.chain.elements import BASE_LINK, Joint
from chainbuild.drawing.limbs.gantries import gantry
from chainbuild.drawing.limbs.lifts import STAGE, LiftColumn, stand, tracks
from chainbuild.drawing.limbs.links import arm_to
from chainbuild.drawing.limbs.plan import UPRIGHT, ArmPlan
from chainbuild.drawing.limbs.seats import Seat, seats_of
from chainbuild.drawing.site import Site
from chainbuild.shown import fields_shown

_Z: Final = np.array([0.0, 0.0, 1.0])
# Shares of the radius of the arm's first joint, as robots are built.
_FOOT_ROOM: Final = 0.8  # least height of a foot
_TALL: Final = 3.0  # from the track to the shoulder at least, where the track lies on the floor
_CARRIAGE: Final = 1.7  # half the length of a carriage


@dataclass(frozen=True, slots=True, eq=False)
class Footing:
    """What carries an arm, and where its joints sit on it.

    Attributes:
        seats: Seats of the arm's joints.
        bodies: Bodies of the links below the first of them.
    """

    __repr__ = fields_shown

    seats: Sequence[Seat]
    bodies: Sequence[Body]


def footing(site: Site) -> Footing:
    """Return what carries the arm of a robot, and the seats of the arm's joints."""
    path = [joint for joint in site.tool_path if joint.name != LEVEL_PLATE]  # it only carries the forearm's axis
    slides = list(takewhile(lambda joint: joint.kind == "prismatic", path))
    lifts = [n for n, joint in enumerate(slides) if abs(site.direction(joint)[2]) > UPRIGHT]
    # What lies beyond the first lifting axis, and the last joint whatever it is, belongs to the arm.
    slides = slides[: min([*(n + 1 for n in lifts[:1]), len(slides), len(path) - 1])]
    carrier = slides[-1].child if slides else BASE_LINK
    plan = ArmPlan(site, path[len(slides) :], _mount(site, carrier))
    if slides and _hangs(plan):
        return _hung(site, slides, plan)
    if slides and abs(site.direction(slides[-1])[2]) > UPRIGHT:
        return _lifted(site, slides, plan)
    r = plan.radii[0]
    raised = plan.mount + STAGE * r * len(slides) * _Z
    if not _has_base(site, carrier) and plan.ahead(0)[2] - raised[2] > _TALL * r:
        plan = plan.standing_at(raised)  # the track lies on the floor where the robot is tall enough for it
    plan = plan.standing_at(_with_room(plan))
    seats = seats_of(plan)
    c = _CARRIAGE * r
    under = tracks(site, slides, plan.mount, ((-c, c), (-c, c)), r)
    return Footing(seats, [*under, *stand(site, carrier, plan.mount, seats[0])])


def _hangs(plan: ArmPlan) -> bool:
    """Return whether an arm hangs from what carries it."""
    lowest = min(plan.points[0][2], plan.ahead(0)[2])
    return bool(lowest < plan.mount[2] - 0.5 * plan.radii[0]) and plan.kinds[0] != "stack"


def _hung(site: Site, slides: Sequence[Joint], plan: ArmPlan) -> Footing:
    """Return a gantry; a robot hangs from it by its foot, a wrist alone is the end of its ram."""
    seats, robot, link = seats_of(plan), plan.kinds.count("hinge") > 1, slides[-1].child
    first = seats[0]
    if robot:
        return Footing(seats, [*gantry(site, slides, plan.mount, first), *stand(site, link, plan.mount, first)])
    in_line = first.kind == "roll" and abs(first.axis[2]) > UPRIGHT
    end = first.place if in_line else first.corner + 1.3 * first.radius * _Z
    ram = np.array([plan.mount[0], plan.mount[1], end[2]])
    return Footing(seats, [*gantry(site, slides, ram, first), *([] if in_line else arm_to(site, link, ram, first))])


def _lifted(site: Site, slides: Sequence[Joint], plan: ArmPlan) -> Footing:
    """Return a column, on the floor or on a track; a robot stands on what it lifts, a SCARA is held by it."""
    beside = plan.kinds[0] in ("stack", "ram")
    if not beside:
        plan = plan.standing_at(_with_room(plan))
    seats = seats_of(plan)
    column = LiftColumn(site, slides, plan.mount, seats[0], beside=beside)
    r, h = plan.radii[0], column.half
    under = tracks(site, slides[:-1], column.foot, ((-_CARRIAGE * r, _CARRIAGE * r), (-1.5 * h, 1.5 * h)), r)
    on_top = [] if beside else stand(site, slides[-1].child, plan.mount, seats[0])
    return Footing(seats, [*under, *column.bodies(), *on_top])


def _has_base(site: Site, carrier: str) -> bool:
    return any(frame.link == carrier and frame.name.endswith("base") for frame in site.chain.frames)


def _mount(site: Site, carrier: str) -> Vector:
    """Return where an arm is fixed to the link that carries it: where machine data say so, else its origin."""
    for frame in site.chain.frames:
        if frame.link == carrier and frame.name.endswith("base"):
            place: Vector = site.frame(frame.name)[:3, 3]
            return place
    origin: Vector = site.links[carrier][:3, 3]
    return origin


def _with_room(plan: ArmPlan) -> Vector:
    """Return the mount of an arm, lower where there is no room for a foot."""
    d, r, mount = plan.axes[0], plan.radii[0], plan.mount
    if plan.kinds[0] == "roll":
        end = plan.roll_end(0)
    else:
        end, d = plan.points[0] - 1.3 * r * _Z, _Z
    d = d if (plan.ahead(0) - mount) @ d >= 0.0 else -d
    lack = _FOOT_ROOM * r - float((end - mount) @ d)
    lowered: Vector = mount - max(lack, 0.0) * d
    return lowered
