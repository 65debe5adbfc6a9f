"""Sign and zero of an axis folded into the placement and the direction of its joint, and the joint as it was drawn.

A recipe draws a joint and says how an axis moves it: θ = sign·a + offset. Folded, the joint's value is the axis value:

    T·M(d, sign·a + offset) = T·M(d, offset) · M(sign·d, a)

Links and frames keep their poses. Whatever depends on the drawing (bodies, sizes, the sense of a crank) uses the joint
as its recipe draws it, so that the sign and zero of an axis do not change it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.elements import Chain, Joint
from chainbuild.frames import rot_about, transform
from chainbuild.units import deg_from_rad, m_from_mm, rad_from_deg


def joint_motion(joint: Joint, q: float) -> Matrix:
    """Return the (4, 4) motion of a joint at its value, in the joint's own frame [m]."""
    if joint.kind == "prismatic":
        return transform(None, joint.direction * q)
    return transform(rot_about(joint.direction, deg_from_rad(q)))


def folded(joint: Joint, sign: float, offset: float) -> Joint:
    """Return the joint whose value is x where that of the given one is sign·x + offset.

    Args:
        joint: The joint.
        sign: +1 or -1.
        offset: mm or degrees: right angles stay exact.
    """
    if joint.kind == "prismatic":
        shift = m_from_mm(offset)
        motion = transform(None, joint.direction * shift)
    else:
        shift = rad_from_deg(offset)
        motion = transform(rot_about(joint.direction, offset))
    return replace(
        joint,
        T_parent_joint=joint.T_parent_joint @ motion if offset else joint.T_parent_joint,
        direction=sign * joint.direction + 0.0,
        zero=sign * (joint.zero - shift) + 0.0,
        reversed=joint.reversed != (sign < 0.0),
    )


def drawn(joint: Joint) -> Joint:
    """Return the joint as its recipe draws it: placed as at `zero`, moving in the direction drawn."""
    return replace(
        joint,
        T_parent_joint=joint.T_parent_joint @ joint_motion(joint, joint.zero) if joint.zero else joint.T_parent_joint,
        direction=-joint.direction + 0.0 if joint.reversed else joint.direction,
        zero=0.0,
        reversed=False,
    )


def drawn_values(joints: Sequence[Joint], q: Vector) -> Vector:
    """Return the values (…, n_q) of the joints as drawn at joint values (…, n_q), SI."""
    signs = np.array([-1.0 if joint.reversed else 1.0 for joint in joints])
    values: Vector = signs * (q - np.array([joint.zero for joint in joints]))
    return values


def drawn_bounds(joints: Sequence[Joint], low: Vector, high: Vector) -> tuple[Vector, Vector]:
    """Return bounds of the values of the joints as drawn over bounds (n_q,) of the joint values, SI."""
    ends = drawn_values(joints, low), drawn_values(joints, high)
    return np.minimum(*ends), np.maximum(*ends)


def reach(chain: Chain, low: Vector, high: Vector) -> float:
    """Return a bound on the distance between tool and workpiece [m]: the sum of all offsets and strokes.

    Args:
        chain: The chain.
        low: (n_q,) lower bounds of the joint values, SI.
        high: (n_q,) upper bounds.
    """
    low, high = drawn_bounds(chain.joints, low, high)
    total = sum(float(np.linalg.norm(chain.frame(tip).T_link_frame[:3, 3])) for tip in ("tool", "workpiece"))
    for n, joint in enumerate(chain.joints):
        total += float(np.linalg.norm(drawn(joint).T_parent_joint[:3, 3]))
        if joint.kind == "prismatic":
            total += max(abs(float(low[n])), abs(float(high[n])))
    return total
