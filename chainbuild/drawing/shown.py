"""The chain that a drawing shows: with the rods of its parallelogram."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.bodies.linkage import with_linkage
from chainbuild.chain.bodies.rods import has_rods
from chainbuild.chain.elements import Chain, Joint
from chainbuild.chain.fold import drawn

_ROUNDING: Final = 1e-9  # factors and sines below this are rounding


def shown_chain(chain: Chain) -> Chain:
    """Return the chain with crank, rod and level linkage where it is a parallelogram arm, else the same chain.

    Poses and axes stay the same.

    Args:
        chain: The chain, with rods or without.
    """
    return with_linkage(chain, chain.geometry.rod_data) if has_parallelogram(chain) and not has_rods(chain) else chain


def has_parallelogram(chain: Chain) -> bool:
    """Return whether a parallelogram turns the forearm of an arm.

    Its motor stands beside that of the shoulder and turns the forearm against the frame: the shoulder's axis then
    moves the elbow back by as much as it moves the shoulder. On a serial arm it leaves the elbow alone. A URDF has its
    links itself: fingers that mimic one another are no rods.

    Args:
        chain: The chain, without rods.
    """
    if chain.loops or chain.dialect == "URDF" or not isinstance(chain.axis_map, AffineMap):
        return False
    at = {joint.child: n for n, joint in enumerate(chain.joints)}
    for n, elbow in enumerate(chain.joints):
        m = at.get(elbow.parent)
        if m is not None and _parallel(chain.joints[m], elbow):
            return _held(chain.axis_map, chain.joints, m, n)
    return False


def _parallel(shoulder: Joint, elbow: Joint) -> bool:
    if {shoulder.kind, elbow.kind} != {"revolute"}:
        return False
    return float(np.linalg.norm(np.cross(_turned(elbow), drawn(shoulder).direction))) < _ROUNDING


def _turned(joint: Joint) -> Vector:
    """Return the direction (3,) of a joint as it is drawn, in the frame of the link that carries it."""
    own = drawn(joint)
    direction: Vector = own.T_parent_joint[:3, :3] @ own.direction
    return direction


def _held(axis_map: AffineMap, joints: Sequence[Joint], shoulder: int, elbow: int) -> bool:
    """Return whether the shoulder's axis moves the shoulder, and turns the forearm not at all."""
    over = np.abs(axis_map.A[shoulder]) > _ROUNDING
    same = 1.0 if _turned(joints[elbow]) @ drawn(joints[shoulder]).direction > 0.0 else -1.0
    signs = [-1.0 if joints[n].reversed else 1.0 for n in (shoulder, elbow)]
    pitch = signs[0] * axis_map.A[shoulder] + same * signs[1] * axis_map.A[elbow]
    return bool(over.any() and (np.abs(pitch[over]) < _ROUNDING).all())
