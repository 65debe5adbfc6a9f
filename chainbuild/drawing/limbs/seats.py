"""Where the joints of a robot sit: the places that its links are drawn from.

A hinge sits at its data. Machine data give the axis of an in-line housing, but not where along it the one link ends
and the next begins: it is assumed between what lies before it and after it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.elements import Joint
from chainbuild.drawing.limbs.plan import SAME_LINE, UPRIGHT, ArmPlan, SeatKind, line_point
from chainbuild.frames import unit
from chainbuild.shown import fields_shown

_HALF: Final = 0.8  # half the width of a hinge's boss over its radius
_PLATE: Final = 0.35  # thickness of a fork's plate likewise
_SLAB: Final = 0.95  # thickness of a SCARA's arm likewise
_BOSS: Final = 1.15  # radii from a hinge to what turns beside it
_BEND: Final = 0.6  # radii from a bend to what turns after it
_FOOT_SHARE: Final = 0.5  # of the way up to the shoulder: the foot; what turns on it is the rest
_HOUSING_SHARE: Final = 0.3  # of the way to the next joint: the housing; what turns in it is the longer part
_NOSE: Final = 3.0  # radii: what turns at the end of a ram, from its hinge
_THIN: Final = 0.25  # of a radius: the least length of what turns at the end of an arm
_FRONT: Final = 1.3  # radii from the middle of a ram's housing to its front, where there is room
_ROOM: Final = (0.5, 0.4)  # else: of the way to the next joint, and radii at least


@dataclass(frozen=True, slots=True, eq=False)
class Seat:
    """Where a joint sits and how it is built.

    Attributes:
        joint: The joint.
        kind: How it is built.
        place: (3,) where its parent ends and its child begins; of a hinge: the middle of its boss [m].
        axis: (3,) unit vector: outward along the arm for a roll or a slide, the joint's direction for a hinge.
        corner: (3,) point on the axis up to which the parent comes; it follows the axis from there.
        radius: Of its housing [m].
        half: Half the width of its boss [m].
        parent_forks: Whether the parent holds the child between its plates; else the child holds the parent.
        ahead: (3,) point that the arm goes on to; of a slide across the arm: where the next joint sits [m].
    """

    __repr__ = fields_shown

    joint: Joint
    kind: SeatKind
    place: Vector
    axis: Vector
    corner: Vector
    radius: float
    half: float
    parent_forks: bool
    ahead: Vector

    @property
    def link(self) -> str:
        """The link that the joint carries."""
        return self.joint.child

    @property
    def plate(self) -> float:
        """Thickness of the plates of its fork, or of the slab of a SCARA [m]."""
        return (_SLAB if self.kind == "stack" else _PLATE) * self.radius


def seats_of(plan: ArmPlan) -> list[Seat]:
    """Return where the joints of an arm sit, from the base to the tip."""
    rules = {"roll": _roll, "hinge": _hinge, "stack": _stack, "column": _column, "quill": _ram, "ram": _ram}
    seats: list[Seat] = []
    for n, kind in enumerate(plan.kinds):
        after_plate = bool(seats) and seats[-1].kind == "plate" and kind in ("ram", "plate")
        rule = _stacked if after_plate or kind == "plate" else rules[kind]
        seats.append(rule(plan, n, seats[-1] if seats else None))
    return seats


def _seat(plan: ArmPlan, n: int, place: Vector, axis: Vector, corner: Vector, ahead: Vector | None = None) -> Seat:
    r = plan.radii[n]
    goes_on = plan.ahead(n) if ahead is None else ahead
    return Seat(plan.joints[n], plan.kinds[n], place, axis, corner, r, _HALF * r, True, goes_on)


def _hinge(plan: ArmPlan, n: int, before: Seat | None) -> Seat:
    p, d, r = plan.points[n], plan.axes[n], plan.radii[n]
    half = _HALF * r
    if before is not None and before.kind == "hinge" and not before.parent_forks:
        half = before.half  # the plates that hold the shoulder hold the elbow
    return Seat(plan.joints[n], "hinge", p, d, p, r, half, not _holds(plan, n), plan.ahead(n))


def _holds(plan: ArmPlan, n: int) -> bool:
    """Return whether a hinge's child holds the parent: a shoulder, with an elbow parallel to it."""
    if "hinge" in plan.kinds[:n] or plan.kinds[n + 1 : n + 2] != ["hinge"]:
        return False
    apart = float(np.linalg.norm(plan.points[n + 1] - plan.points[n]))
    return abs(float(plan.axes[n] @ plan.axes[n + 1])) > UPRIGHT and apart > 2.0 * plan.radii[n]


def _stack(plan: ArmPlan, n: int, before: Seat | None) -> Seat:
    """Return the seat of an arm that lies on the one before; the first one is as high as data say."""
    place = plan.points[n].copy()
    if before is not None and before.kind == "stack":
        place[2] = before.place[2] + before.plate
    else:
        place[2] -= _SLAB * plan.radii[n] / 2.0
    return _seat(plan, n, place, np.array([0.0, 0.0, 1.0]), place)


def _roll(plan: ArmPlan, n: int, before: Seat | None) -> Seat:
    corner = _corner(plan, n, before)
    way = plan.roll_end(n) - corner
    d = plan.axes[n] if way @ plan.axes[n] >= 0.0 else -plan.axes[n]
    stop, r = float(way @ d), plan.radii[n]
    given = _given_flange(plan, n, d, corner)
    if before is not None and before.kind == "stack":
        at = 0.0
    elif given is not None:
        at = given
    elif before is not None and _carries_on(before, d):
        # The ram itself reaches up to what turns; one that begins on a slide across the arm is short.
        short = before.kind == "ram" and np.linalg.norm(before.corner - before.place) < plan.near
        reach = float((before.ahead - corner) @ d) if short else max(stop - _NOSE * r, stop / 2.0)
        place = corner + reach * d
        return _seat(plan, n, place, d, place)
    else:
        start = _start(before, corner, d, r)
        share = _FOOT_SHARE if before is None else _HOUSING_SHARE
        at = start + share * (stop - start) if stop - start > _THIN * r else stop - _THIN * r
    return _seat(plan, n, corner + at * d, d, corner)


def _carries_on(before: Seat, d: Vector) -> bool:
    """Return whether a roll turns about the ram or quill that carries it."""
    return before.kind in ("ram", "quill") and float(np.linalg.norm(np.cross(before.axis, d))) < SAME_LINE


def _corner(plan: ArmPlan, n: int, before: Seat | None) -> Vector:
    """Return where an arm comes to the axis of a roll."""
    p, d = plan.points[n], plan.axes[n]
    if before is None:
        return line_point(p, d, plan.mount)
    return line_point(p, d, before.place, before.axis if before.kind in ("hinge", "roll") else None)


def _start(before: Seat | None, corner: Vector, d: Vector, r: float) -> float:
    """Return how far along its axis what turns in line can begin, from its corner."""
    if before is not None and before.kind == "hinge":
        beside = float(np.linalg.norm(corner - before.place))
        return _BOSS * before.radius if beside < before.radius else _BEND * r
    if before is not None and before.kind == "roll":
        return max(0.0, float((before.place - corner) @ d))
    return 0.0


def _given_flange(plan: ArmPlan, n: int, d: Vector, corner: Vector) -> float | None:
    """Return how far along the axis of a roll a flange of its parent lies, or None where there is none."""
    for frame in plan.site.chain.frames if n else ():
        if frame.link == plan.joints[n].parent and frame.name.endswith("flange"):
            return float((plan.site.frame(frame.name)[:3, 3] - corner) @ d)
    return None


def _column(plan: ArmPlan, n: int, before: Seat | None) -> Seat:
    assert before is not None
    place = line_point(before.place, before.axis, plan.points[n])
    return _seat(plan, n, place, plan.axes[n], place)


def _stacked(plan: ArmPlan, n: int, before: Seat | None) -> Seat:
    """Return the seat of a slide across the arm, or on such a one: all that data put in one place share the way on."""
    place = before.ahead if before is not None and before.kind == "plate" else plan.points[n]
    together = sum(1 for p in plan.points[n:] if np.linalg.norm(p - plan.points[n]) < plan.near)
    step = (plan.ahead(n) - place) / (together + 1.0)
    if np.linalg.norm(step) < plan.near:
        side = np.eye(3)[int(np.argmin(np.abs(plan.axes[n])))]
        step = _PLATE * plan.radii[n] * unit(np.cross(plan.axes[n], side))
    axis = plan.axes[n] if plan.kinds[n] == "plate" else unit(step)
    return _seat(plan, n, place, axis, place, place + step)


def _ram(plan: ArmPlan, n: int, before: Seat | None) -> Seat:
    """Return the seat of a ram or quill: it runs through what it carries, not through the tool."""
    ahead = [*plan.points[n + 1 :], *plan.ends][0]
    start = before.place if before is not None else plan.mount
    d = plan.axes[n] if (ahead - start) @ plan.axes[n] >= 0.0 else -plan.axes[n]
    if plan.kinds[n] == "quill":
        corner = line_point(ahead, d, start)
        return _seat(plan, n, corner, d, corner, ahead)
    corner, r = line_point(ahead, d, plan.before(n)), plan.radii[n]
    room = float((ahead - corner) @ d)
    front = min(_FRONT * r, max(_ROOM[0] * room, _ROOM[1] * r))
    return _seat(plan, n, corner + front * d, d, corner, ahead)
