"""The rods of a parallelogram as links: joints that axis 2 and axis 3 drive, closed without a loop.

Side view; the crank turns with the forearm, the rod stays parallel to the upper arm::

      rod_pin o-----O elbow ======== forearm
             /     /
        rod /     / upper arm
           /     /
          o-----O shoulder
            crank

Crank and forearm are parallel, so are rod and upper arm: with equal lengths the rod's end falls on the forearm's pin
at every angle. An arm whose elbow angle is a joint of its own carries the crank on its upper arm: the crank turns by
the elbow's angle, the rod back by it. An arm with a level flange gets level links without mass at shoulder and elbow;
what they carry turns by one angle each, and the head is kept level by the forearm's own angle. Every joint of a rod
therefore follows one other joint.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.bodies.geometry import RodData
from chainbuild.chain.elements import Axis, Chain, Frame, Joint, Link
from chainbuild.chain.fold import drawn, folded
from chainbuild.errors import ChainError
from chainbuild.frames import transform, unit
from chainbuild.units import deg_from_rad

CRANK, ROD, LEVEL_PLATE, LEVEL_CRANK = "crank", "rod", "level_plate", "level_crank"
ROD_END, ROD_PIN = "rod_end", "rod_pin"
ROD_JOINTS = (CRANK, ROD, LEVEL_PLATE, LEVEL_CRANK)
# Rods of the level linkage (`chainbuild.chain.bodies.linkage`): drawn, but of assumed width and place.
LEVEL_ROD, HEAD_ROD = "level_rod", "level_head_rod"
LEVEL_LINKS = tuple(f"{joint}_link" for joint in (LEVEL_PLATE, LEVEL_CRANK, LEVEL_ROD, HEAD_ROD))

# Where nobody gave them: crank over upper arm, and radius of rods over the crank, as drawings have them.
CRANK_SHARE: Final = 0.25
_RADIUS_SHARE: Final = 0.2
_PARALLEL: Final = 1e-9  # sines, metres and factors below this are rounding


@dataclass(frozen=True, slots=True, eq=False)
class _Row:
    """A joint with its row of the axis map: value = factors·axes + offset."""

    joint: Joint
    factors: Vector
    offset: float


def with_rods(chain: Chain, data: RodData) -> Chain:
    """Return the chain with the rods of its parallelogram; poses and axes stay the same, joints are added.

    Args:
        chain: A chain whose second and third rotary joints are parallel and follow one another.
        data: Dimensions.

    Raises:
        ChainError: there is no such pair of joints, the axis map is not affine, or the arm has no length.
    """
    if not isinstance(chain.axis_map, AffineMap):
        raise ChainError("rods need an affine axis map")
    rows = [_Row(*row) for row in zip(chain.joints, chain.axis_map.A, chain.axis_map.b.tolist(), strict=True)]
    shoulder, elbow = _parallel_pair(rows)
    pin = _pin(chain, drawn(elbow.joint), data)
    level = _level_joint(rows, shoulder, elbow)
    arms = _as_drawn(shoulder), _as_drawn(elbow)
    if level is None:
        new = _relative(*arms, pin)
    else:
        rows = [row for row in rows if row is not elbow and row is not level]
        new = _levelled(*arms, level, pin)
    new = [_with_fold(row, chain.axes) for row in new]
    at = next(n for n, row in enumerate(rows) if row is shoulder) + 1
    rows = _parents_first([*rows[:at], *new, *rows[at:]])
    radius = data.radius or _RADIUS_SHARE * float(np.linalg.norm(pin))
    arm = elbow.joint.T_parent_joint[:3, 3]
    kinds = [axis.kind for axis in chain.axes]
    return replace(
        chain,
        links=(*chain.links, *(_link(row.joint, radius) for row in new if row.joint.name in ROD_JOINTS)),
        joints=tuple(row.joint for row in rows),
        frames=(
            *chain.frames,
            Frame(ROD_END, f"{ROD}_link", transform(np.eye(3), arm)),
            Frame(ROD_PIN, elbow.joint.child, transform(np.eye(3), pin)),
        ),
        axis_map=AffineMap.of(np.array([r.factors for r in rows]), np.array([r.offset for r in rows]), kinds),
    )


def has_rods(chain: Chain) -> bool:
    """Return whether a chain carries the rods of a parallelogram."""
    return any(frame.name == ROD_END for frame in chain.frames)


def _parallel_pair(rows: Sequence[_Row]) -> tuple[_Row, _Row]:
    by_child = {row.joint.child: row for row in rows}
    for row in rows:
        before = by_child.get(row.joint.parent)
        if before is None or row.joint.kind != "revolute" or before.joint.kind != "revolute":
            continue
        turned = row.joint.T_parent_joint[:3, :3] @ row.joint.direction
        if np.linalg.norm(np.cross(turned, before.joint.direction)) < _PARALLEL:
            return before, row
    raise ChainError("rods need two parallel rotary joints, one behind the other: this kinematic has none")


def _as_drawn(row: _Row) -> _Row:
    """Return the row of a joint as its recipe draws it."""
    joint, sign = row.joint, -1.0 if row.joint.reversed else 1.0
    return _Row(drawn(joint), sign * row.factors, sign * (row.offset - joint.zero))


def _with_fold(row: _Row, axes: Sequence[Axis]) -> _Row:
    """Return the row of a revolute joint, folded where one rotary axis alone drives it with factor ±1."""
    driving = np.flatnonzero(row.factors)
    if len(driving) != 1 or axes[driving[0]].kind != "rotary" or abs(row.factors[driving[0]]) != 1.0:
        return row
    sign = float(row.factors[driving[0]])
    return _Row(folded(row.joint, sign, deg_from_rad(row.offset)), sign * row.factors, 0.0)


def _pin(chain: Chain, elbow: Joint, data: RodData) -> Vector:
    """Return where the rod meets the forearm, in the forearm's frame, and the crank, in the crank's [m].

    Angle and side count about the elbow as the recipe draws it, whatever the sign of its axis.
    """
    d = elbow.direction
    ahead = _forearm(chain, elbow)
    across = ahead - d * (ahead @ d)
    arm = elbow.T_parent_joint[:3, 3]
    length = float(np.linalg.norm(arm))
    if np.linalg.norm(across) < _PARALLEL or length < _PARALLEL:
        raise ChainError("rods need an upper arm and a forearm longer than 0")
    x = unit(across)
    angle = np.radians(data.angle_deg)
    turned = np.cos(angle) * x + np.sin(angle) * np.cross(d, x)
    crank = data.crank if data.crank is not None else CRANK_SHARE * length
    pin: Vector = (crank * turned + data.sideways * d).round(15)
    return pin


def _forearm(chain: Chain, elbow: Joint) -> Vector:
    """Return the way from the elbow to where the forearm ends, in its frame [m]."""
    ends = [drawn(joint).T_parent_joint[:3, 3] for joint in chain.joints if joint.parent == elbow.child]
    ends += [frame.T_link_frame[:3, 3] for frame in chain.frames if frame.link == elbow.child]
    return max(ends, key=lambda end: float(np.linalg.norm(end)), default=np.zeros(3))


def _level_joint(rows: Sequence[_Row], shoulder: _Row, elbow: _Row) -> _Row | None:
    """Return the joint on the forearm that turns the head back by both angles, if there is one."""
    sign = _sign(shoulder.joint, elbow.joint)
    pitch = elbow.factors + sign * shoulder.factors
    for row in rows:
        if row.joint.parent == elbow.joint.child and row.joint.kind == "revolute":
            turned = row.joint.T_parent_joint[:3, :3] @ row.joint.direction
            if np.allclose(row.factors, -pitch * float(turned @ elbow.joint.direction), atol=_PARALLEL):
                return row
    return None


def _sign(shoulder: Joint, elbow: Joint) -> float:
    return 1.0 if float(elbow.T_parent_joint[:3, :3] @ elbow.direction @ shoulder.direction) > 0.0 else -1.0


def _relative(shoulder: _Row, elbow: _Row, pin: Vector) -> list[_Row]:
    """Return crank and rod of an arm whose elbow angle is a joint, drawn: both follow it."""
    R, d = elbow.joint.T_parent_joint[:3, :3], elbow.joint.direction
    crank = Joint(CRANK, "revolute", shoulder.joint.child, f"{CRANK}_link", transform(R), d)
    rod = Joint(ROD, "revolute", crank.child, f"{ROD}_link", transform(R.T, pin), R @ d)
    return [_Row(crank, elbow.factors, elbow.offset), _Row(rod, -elbow.factors, -elbow.offset)]


def _levelled(shoulder: _Row, elbow: _Row, level: _Row, pin: Vector) -> list[_Row]:
    """Return plate, forearm, head, crank and rod of an arm, drawn, with a level flange."""
    s, e = shoulder.joint, elbow.joint
    R = e.T_parent_joint[:3, :3]
    sign = _sign(s, e)
    pitch = _Row(e, elbow.factors + sign * shoulder.factors, elbow.offset + sign * shoulder.offset)
    place = transform(np.eye(3), e.T_parent_joint[:3, 3])
    plate = Joint(LEVEL_PLATE, "revolute", s.child, f"{LEVEL_PLATE}_link", place, s.direction)
    forearm = replace(e, parent=plate.child, T_parent_joint=transform(R))
    crank = Joint(CRANK, "revolute", s.parent, f"{CRANK}_link", s.T_parent_joint @ transform(R), e.direction)
    back = Joint(LEVEL_CRANK, "revolute", crank.child, f"{LEVEL_CRANK}_link", transform(R.T, pin), R @ e.direction)
    rod = Joint(ROD, "revolute", back.child, f"{ROD}_link", np.eye(4), s.direction)
    return [
        _Row(plate, -shoulder.factors, -shoulder.offset),
        replace(pitch, joint=forearm),
        level,
        replace(pitch, joint=crank),
        _Row(back, -pitch.factors, -pitch.offset),
        _Row(rod, shoulder.factors, shoulder.offset),
    ]


def _parents_first(rows: list[_Row]) -> list[_Row]:
    children = {row.joint.child for row in rows}
    ordered: list[_Row] = []
    while rows:
        done = {row.joint.child for row in ordered}
        ready = next(row for row in rows if row.joint.parent not in children or row.joint.parent in done)
        ordered.append(ready)
        rows = [row for row in rows if row is not ready]
    return ordered


def _link(joint: Joint, radius: float) -> Link:
    return Link(joint.child, radius)


def pinned_links(chain: Chain) -> tuple[tuple[str, str], ...]:
    """Return the pairs of links that share a pin of the parallelogram without a joint between them."""
    if not has_rods(chain):
        return ()
    carrier = {joint.child: joint.parent for joint in chain.joints}
    forearm = chain.frame(ROD_PIN).link
    upper = carrier[forearm]
    if upper == f"{LEVEL_PLATE}_link":
        upper = carrier[upper]
    crank, rod = f"{CRANK}_link", f"{ROD}_link"
    return (crank, rod), (rod, forearm), (crank, upper), (crank, carrier[upper]), (upper, forearm)
