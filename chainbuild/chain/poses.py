"""Placements of the frames of a chain, in NumPy alone: for use while chains are still being built."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import joint_values
from chainbuild.chain.elements import BASE_LINK, Chain, Joint
from chainbuild.chain.fold import joint_motion
from chainbuild.frames import ANGLE_MODES, inverse, quaternion_from_matrix, rot_about


def link_placements(chain: Chain, q: Vector) -> dict[str, Matrix]:
    """Return the placement of every link in the base [m] at joint values (n_q,), SI; loops are not closed."""
    found = {BASE_LINK: np.eye(4)}
    for joint, value in zip(chain.joints, q, strict=True):
        found[joint.child] = found[joint.parent] @ joint.T_parent_joint @ joint_motion(joint, float(value))
    return found


def frame_placement(chain: Chain, name: str, axes: ArrayLike) -> Matrix:
    """Return a frame in the base [m] at axis values (n_axes,), mm and degrees."""
    frame = chain.frame(name)
    q = joint_values(chain.axis_map, np.asarray(axes, dtype=float))
    return link_placements(chain, q)[frame.link] @ frame.T_link_frame


def pose(chain: Chain, axes: ArrayLike) -> Matrix:
    """Return the tool in the workpiece frame [m] at axis values (n_axes,), mm and degrees."""
    tool, workpiece = chain.frame("tool"), chain.frame("workpiece")
    links = link_placements(chain, joint_values(chain.axis_map, np.asarray(axes, dtype=float)))
    return inverse(links[workpiece.link] @ workpiece.T_link_frame) @ links[tool.link] @ tool.T_link_frame


def pose_jacobian(chain: Chain, axes: ArrayLike) -> Matrix:
    """Return the Jacobian (6, n_axes) of the pose, SI by SI, linear rows first, in the axes of the workpiece frame.

    The linear rows are the velocity of the tool's origin, the angular rows the angular velocity, both seen from the
    workpiece.
    """
    values = np.asarray(axes, dtype=float)
    links = link_placements(chain, joint_values(chain.axis_map, values))
    tool, workpiece = chain.frame("tool"), chain.frame("workpiece")
    T_workpiece = links[workpiece.link] @ workpiece.T_link_frame
    tip = (links[tool.link] @ tool.T_link_frame)[:3, 3]
    signs = _signs(chain)
    columns = [signs[joint.name] * _column(joint, links, tip) for joint in chain.joints]
    back = np.zeros((6, 6))
    back[:3, :3] = back[3:, 3:] = T_workpiece[:3, :3].T
    J: Matrix = back @ np.array(columns).T @ chain.axis_map.dq_daxes(values)
    return J


def rotation_vector(R: Matrix) -> Vector:
    """Return axis times angle [rad] of a rotation."""
    x, y, z, w = quaternion_from_matrix(R)
    vector = np.array([x, y, z])
    sine = float(np.linalg.norm(vector))
    result: Vector = vector * (2.0 * math.atan2(sine, w) / sine if sine > 0.0 else 2.0)
    return result


def angle_rates(mode: str, angles_deg: Sequence[float]) -> Matrix:
    """Return the angular velocities (3, 3) of the angles A, B, C of a mode at unit speed, in the outer axes."""
    by_letter = dict(zip("ABC", angles_deg, strict=True))
    rates, R = np.zeros((3, 3)), np.eye(3)
    for axis, letter, sign in ANGLE_MODES[mode].factors:
        direction = np.eye(3)["xyz".index(axis)]
        rates[:, "ABC".index(letter)] = sign * (R @ direction)
        R = R @ rot_about(direction, sign * by_letter[letter])
    return rates


def _column(joint: Joint, links: dict[str, Matrix], tip: Vector) -> Vector:
    """Return the velocity of the tip and the angular velocity, in the base, of a joint at unit speed."""
    T = links[joint.parent] @ joint.T_parent_joint
    direction = T[:3, :3] @ joint.direction
    if joint.kind == "prismatic":
        return np.concatenate([direction, np.zeros(3)])
    return np.concatenate([np.cross(direction, tip - T[:3, 3]), direction])


def _signs(chain: Chain) -> dict[str, float]:
    """Return for every joint +1 where it moves the tool, -1 where it moves the workpiece, 0 for both or neither."""
    tool = {joint.name for joint in path_to(chain, chain.frame("tool").link)}
    workpiece = {joint.name for joint in path_to(chain, chain.frame("workpiece").link)}
    return {joint.name: float(joint.name in tool) - float(joint.name in workpiece) for joint in chain.joints}


def path_to(chain: Chain, link: str) -> Sequence[Joint]:
    """Return the joints from the base to a link, in that order."""
    carrier = {joint.child: joint for joint in chain.joints}
    path: list[Joint] = []
    while link != BASE_LINK:
        path.append(carrier[link])
        link = carrier[link].parent
    return path[::-1]
