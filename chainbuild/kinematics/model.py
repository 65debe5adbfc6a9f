"""From chain to `pin.Model`: named joints, named frames, limits."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from chainbuild.chain.elements import BASE_LINK, Chain, Joint

_ALIGNED = {
    ("revolute", (1.0, 0.0, 0.0)): pin.JointModelRX,
    ("revolute", (0.0, 1.0, 0.0)): pin.JointModelRY,
    ("revolute", (0.0, 0.0, 1.0)): pin.JointModelRZ,
    ("prismatic", (1.0, 0.0, 0.0)): pin.JointModelPX,
    ("prismatic", (0.0, 1.0, 0.0)): pin.JointModelPY,
    ("prismatic", (0.0, 0.0, 1.0)): pin.JointModelPZ,
}
_UNALIGNED = {"revolute": pin.JointModelRevoluteUnaligned, "prismatic": pin.JointModelPrismaticUnaligned}


def joint_bounds(chain: Chain) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return lower and upper joint values (n_q,), SI, over the box of the axis limits."""
    lower, upper = np.array([axis.range for axis in chain.axes]).T
    return chain.axis_map.q_bounds(lower, upper)


def build_model(chain: Chain) -> pin.Model:
    """Return the Pinocchio model of a chain.

    Joint n of the chain is joint n + 1 of the model and has one coordinate, so nq = nv = number of joints.
    Every link is a BODY frame, every frame of the chain an operational frame. Inertias are zero: machine data
    hold no masses.

    Args:
        chain: A checked chain.
    """
    model = pin.Model()
    model.name = chain.name
    lower, upper = joint_bounds(chain)
    ids = {BASE_LINK: 0}
    for n, joint in enumerate(chain.joints):
        limits = (np.array([np.inf]), np.array([np.inf]), lower[n : n + 1], upper[n : n + 1])
        placement = pin.SE3(joint.T_parent_joint)
        index = model.addJoint(ids[joint.parent], _joint_model(joint), placement, joint.name, *limits)
        ids[joint.child] = index
        model.addJointFrame(index)
    for link in chain.links:
        if link.name != BASE_LINK:
            model.addBodyFrame(link.name, ids[link.name], pin.SE3.Identity(), -1)
    for frame in chain.frames:
        joint_id = ids[frame.link]
        model.addFrame(pin.Frame(frame.name, joint_id, pin.SE3(frame.T_link_frame), pin.FrameType.OP_FRAME))
    return model


def _joint_model(joint: Joint) -> pin.JointModel:
    x, y, z = (float(component) for component in joint.direction)
    aligned = _ALIGNED.get((joint.kind, (x, y, z)))
    return aligned() if aligned else _UNALIGNED[joint.kind](x, y, z)
