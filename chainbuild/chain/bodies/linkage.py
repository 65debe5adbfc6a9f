"""The level linkage of a palletiser as links: two more parallelograms, which keep plate and head level.

Side view; each level rod is parallel to an arm and as long, between pins that stand apart alike::

                    o--------------o head pin
          plate    /               |
              o---O elbow ======== O head
             /   /      forearm
  level rod /   / upper arm
           /   /
      o---O shoulder
      fixed pin

The axes give every angle, as those of the rods of the parallelogram; the balls of `rod_loops` close at each of them.
How far the pins stand apart is in no machine data: it is assumed, across the arm in the middle of its range, where the
linkage is farthest from lying flat. It moves no tool.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.bodies.geometry import RodData
from chainbuild.chain.bodies.rods import (
    CRANK_SHARE,
    HEAD_ROD,
    LEVEL_PLATE,
    LEVEL_ROD,
    ROD,
    ROD_END,
    ROD_PIN,
    has_rods,
    with_rods,
)
from chainbuild.chain.elements import Chain, Frame, Joint, Link, Loop
from chainbuild.chain.fold import drawn
from chainbuild.frames import inverse, rot_about, transform, translation, unit
from chainbuild.units import deg_from_rad

_NO_LENGTH: Final = 1e-9  # m: an arm without length has no direction
_ENDS: Final = {ROD: (ROD_END, ROD_PIN), **{rod: (f"{rod}_end", f"{rod}_pin") for rod in (LEVEL_ROD, HEAD_ROD)}}


def rod_loops(chain: Chain) -> tuple[Loop, ...]:
    """Return the balls that close the rods of a chain: between the end of each rod and its pin; none without rods.

    The axis map closes them: they are constraints to check a model with, not equations that have to be solved.
    """
    frames = {frame.name for frame in chain.frames}
    return tuple(Loop(rod, "ball", end, pin) for rod, (end, pin) in _ENDS.items() if end in frames)


def assumed_lengths(chain: Chain) -> str:
    """Return which lengths of rods are assumed, as a sentence; empty: none are, or there are no rods."""
    rods = {loop.name for loop in rod_loops(chain)}
    names = ["of the crank"] * bool(rods and chain.geometry.rod_data.crank is None)
    names += ["between the pins of the level linkage"] * (LEVEL_ROD in rods)
    if not names:
        return ""
    are = "length is" if len(names) == 1 else "lengths are"
    return f"the {are} assumed {' and '.join(names)}: no machine data give them, and they move no tool"


def with_linkage(chain: Chain, data: RodData) -> Chain:
    """Return the chain with the rods of its parallelogram and of its level linkage, as `with_rods` does.

    Raises:
        ChainError: there can be no rods.
    """
    return with_level_rods(with_rods(chain, data), data)


def with_level_rods(chain: Chain, data: RodData) -> Chain:
    """Return the chain with the rods of its level linkage; poses and axes stay the same.

    Args:
        chain: A chain with the rods of its parallelogram. Without a level flange it is returned as it is.
        data: Dimensions: the crank's length is how far the pins stand from the joints, too.
    """
    plate = next((joint for joint in chain.joints if joint.name == LEVEL_PLATE), None)
    if plate is None or not has_rods(chain) or not isinstance(chain.axis_map, AffineMap):
        return chain
    shoulder = next(joint for joint in chain.joints if joint.child == plate.parent)
    forearm = next(joint for joint in chain.joints if joint.child == chain.frame(ROD_PIN).link)
    head = _head(chain, forearm)
    arm, fore = drawn(plate).T_parent_joint[:3, 3], drawn(head).T_parent_joint[:3, 3]
    if min(np.linalg.norm(arm), np.linalg.norm(fore)) < _NO_LENGTH:
        return chain
    apart = data.crank if data.crank is not None else CRANK_SHARE * float(np.linalg.norm(arm))
    beside = apart * _across(chain, shoulder, arm)
    above = apart * _across(chain, forearm, fore)
    new = [_beside(shoulder, LEVEL_ROD, beside), _beside(forearm, HEAD_ROD, above)]
    ends = [(arm, plate.child, beside), (fore, head.child, drawn(head).T_parent_joint[:3, :3].T @ above)]
    frames = [
        frame
        for joint, (end, link, pin) in zip(new, ends, strict=True)
        for frame in (
            Frame(_ENDS[joint.name][0], joint.child, translation(*end)),
            Frame(_ENDS[joint.name][1], link, translation(*pin.round(15))),
        )
    ]
    radius = next(link.radius for link in chain.links if link.name == f"{ROD}_link")
    names = [joint.name for joint in chain.joints]
    rows = [*range(len(names)), names.index(shoulder.name), names.index(forearm.name)]
    axis_map = chain.axis_map
    return replace(
        chain,
        links=(*chain.links, *(Link(joint.child, radius) for joint in new)),
        joints=(*chain.joints, *new),
        frames=(*chain.frames, *frames),
        axis_map=AffineMap.of(axis_map.A[rows], axis_map.b[rows], [axis.kind for axis in chain.axes]),
    )


def _head(chain: Chain, forearm: Joint) -> Joint:
    """Return the joint at the end of the forearm that keeps the head level: one that no axis alone drives."""
    axes = {axis.name for axis in chain.axes}
    return next(joint for joint in chain.joints if joint.parent == forearm.child and joint.name not in axes)


def _across(chain: Chain, joint: Joint, arm: Vector) -> Vector:
    """Return the unit vector across an arm in the middle of its range, in the frame of its joint as drawn."""
    axis_map = chain.axis_map
    assert isinstance(axis_map, AffineMap)
    n = chain.joints.index(joint)
    middle = np.array([(axis.lower + axis.upper) / 2.0 for axis in chain.axes]) * axis_map.si_factors
    value = float(axis_map.A[n] @ middle + axis_map.b[n])
    own = drawn(joint)
    angle = (-1.0 if joint.reversed else 1.0) * (value - joint.zero)
    return unit(np.cross(own.direction, rot_about(own.direction, deg_from_rad(angle)) @ arm))


def _beside(joint: Joint, name: str, shift: Vector) -> Joint:
    """Return the joint of a rod that turns as another joint does, shifted in that one's frame as drawn [m]."""
    own = drawn(joint).T_parent_joint
    T = own @ translation(*shift.round(15)) @ inverse(own) @ joint.T_parent_joint
    return replace(joint, name=name, child=f"{name}_link", T_parent_joint=transform(T[:3, :3], T[:3, 3].round(15)))
