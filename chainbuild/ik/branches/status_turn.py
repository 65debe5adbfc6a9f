"""Status and turn of a six-axis articulated arm (KIN_TYP manual 3.3.3)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from chainbuild import tolerances
from chainbuild.arrays import Integers, Matrix, Vector
from chainbuild.chain.axismap import AffineMap, joint_values
from chainbuild.chain.elements import Joint
from chainbuild.chain.poses import link_placements
from chainbuild.chain.programmed.status import HAND_AXIS, HAND_NEGATIVE, WRIST_BEHIND, WRIST_IN_FRONT
from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.arms.arms import wrist_centre
from chainbuild.ik.branches.core.serial import Screw
from chainbuild.kinematics.inputs import axis_rows
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.screws import joints_between_tips

_KINEMATIC: Final = "KIN_TYP 45"
_BITS: Final = np.array([WRIST_BEHIND, WRIST_IN_FRONT, HAND_NEGATIVE])
# A pose met to 1e-9 m leaves the elbow of a stretched arm of 5 m undecided by so much [m]: the square root of 2·L·1e-9.
_STRETCHED_M: Final = 1e-4
# Beyond this a bit is set, and on either side of zero less than that is within what a verified pose leaves open.
_SET_ABOVE: Final = np.array([tolerances.ZERO_VECTOR, tolerances.ZERO_VECTOR, tolerances.BELOW_ZERO_DEG])
_OPEN_BELOW: Final = np.array([tolerances.IK_POSITION_M, _STRETCHED_M, math.degrees(tolerances.IK_ROTATION_RAD)])


def has_status(mechanism: Mechanism) -> bool:
    """Tell whether the controller defines status and turn for a robot's kinematic."""
    return mechanism.chain.has_status


def require_status(mechanism: Mechanism) -> None:
    """Refuse a robot whose kinematic has no status and turn.

    Raises:
        ChainbuildError: it has none.
    """
    if not has_status(mechanism):
        text = f"status and turn are defined for {_KINEMATIC} only, this is {mechanism.chain.kinematic}"
        raise ChainbuildError(text, parameter="status", permitted=_KINEMATIC)


def status_turn(robot: Mechanism, axes: ArrayLike) -> tuple[int, int]:
    """Return status and turn of axis values (KIN_TYP manual 3.3.3).

    Status: 1 where the wrist is behind axis 1, 2 where it is in front of the line through axes 2 and 3, 4 where axis 5
    is negative. Turn: bits 1, 2, 4, 8, 16, 32 for axes 1 to 6 below 0. On a boundary, and as little below 0 as rounding
    leads, the bit is not set.

    Args:
        robot: A robot of KIN_TYP 45.
        axes: (6,) axis values in degrees, as the controller shows them.

    Raises:
        ChainbuildError: the controller defines no status for this kinematic.
        AxisValueError: wrong number of values, or a value that is not finite.
    """
    require_status(robot)
    status, turn = status_turn_rows(robot, robot.axis_values(axes)[None]).tolist()[0]
    return status, turn


def status_turn_rows(robot: Mechanism, axes: ArrayLike) -> Integers:
    """Return status and turn (N, 2) of rows of axis values (N, 6); see `status_turn`.

    Raises:
        ChainbuildError: the controller defines no status for this kinematic.
        AxisValueError: wrong shape, or a value that is not finite.
    """
    require_status(robot)
    return status_turn_bits(robot, axis_rows(robot.axes, axes))


def status_turn_bits(mechanism: Mechanism, values: Matrix) -> Integers:
    """Return status and turn (N, 2) of rows (N, 6) as a solver makes them; nothing is checked."""
    found: Integers = np.empty((len(values), 2), np.int64)
    found[:, 0] = (_margins(mechanism, values) > _SET_ABOVE).dot(_BITS)
    found[:, 1] = (values < -tolerances.BELOW_ZERO_DEG).dot(1 << np.arange(values.shape[1]))
    return found


def status_constants(mechanism: Mechanism) -> Vector | None:
    """Return what compiled code takes to name status and turn, see `compiled.status`; None where it does not."""
    axis_map = mechanism.chain.axis_map
    if not has_status(mechanism) or not isinstance(axis_map, AffineMap):
        return None
    arm = mechanism.prepared("status", lambda: _Arm.of(mechanism))
    angles = np.column_stack([axis_map.A * axis_map.si_factors, axis_map.b])[arm.places]
    return np.concatenate([angles.ravel(), arm.coefficients.ravel(), [arm.shoulder_x]])


def status_and_decided(mechanism: Mechanism, values: Matrix) -> tuple[Integers, Integers]:
    """Return the status (N,) of rows of axis values (N, 6), and which of its bits (N,) are decided.

    A bit is not where the arm is as near to the boundary as a verified pose leaves open: at a singular position.
    """
    margins = _margins(mechanism, values)
    return (margins > 0.0) @ _BITS, (np.abs(margins) > _OPEN_BELOW) @ _BITS


@dataclass(frozen=True, slots=True, eq=False)
class _Arm:
    """Where axes 2 to 4 take elbow and wrist, in the plane of the column's x and z.

    Each coordinate is a sum of products of 1, the cosine or the sine of each of the three angles.

    Attributes:
        places: The three joints among the joint values.
        coefficients: (27, 4) the products by this: from axis 2 to axis 3 and from axis 2 to the wrist, x and z [m].
        shoulder_x: Axis 2, in front of axis 1 [m].
    """

    places: list[int]
    coefficients: Matrix
    shoulder_x: float

    @classmethod
    def of(cls, mechanism: Mechanism) -> _Arm:
        """Return that of a robot.

        Raises:
            ChainbuildError: the wrist axes do not meet in a point.
        """
        chain = mechanism.chain
        # In chain order, which is the arm's own also where it carries the workpiece.
        places = sorted(joints_between_tips(chain))
        links = link_placements(chain, mechanism.q(np.zeros(len(chain.axes))))
        if wrist_centre([_line(chain.joints[place], links, n) for n, place in enumerate(places[3:])]) is None:
            raise ChainbuildError("the wrist axes do not meet in a point, so status is not defined")
        shoulder, elbow, fore, hand = (chain.joints[place] for place in places[1:5])
        from_here = [_turning(shoulder), _turning(elbow), _turning(fore)]
        from_here[0][0, :3, 3] = 0.0  # as seen from axis 2
        wrist = np.einsum("aij,bjk,ckl,l->abci", *from_here, hand.T_parent_joint[:, 3])
        arm = np.zeros((3, 3, 3, 4))
        arm[:, 0, 0] = from_here[0] @ elbow.T_parent_joint[:, 3]
        coefficients = np.concatenate([arm[..., :3:2], wrist[..., :3:2]], axis=3).reshape(27, 4)
        return cls(places[1:4], coefficients, float(shoulder.T_parent_joint[0, 3]))

    def angles(self, mechanism: Mechanism, values: Matrix) -> Matrix:
        """Return the three angles of rows of axis values (N, 6)."""
        axis_map = mechanism.chain.axis_map
        if isinstance(axis_map, AffineMap):
            return axis_map.q_rows(values)[:, self.places]
        return np.array([joint_values(axis_map, row)[self.places] for row in values]).reshape(len(values), 3)


def _margins(mechanism: Mechanism, values: Matrix) -> Matrix:
    """Return how far each bit of the status is from its boundary (N, 3), positive where it is set.

    The wrist behind axis 1 [m], in front of the line through axes 2 and 3 [m], axis 5 below zero [degrees]. Link frames
    are where the recipe draws them, whichever way the axes count.
    """
    arm = mechanism.prepared("status", lambda: _Arm.of(mechanism))
    angles = arm.angles(mechanism, values)
    waves = np.ones((len(values), 3, 3))
    np.cos(angles, out=waves[:, 1])
    np.sin(angles, out=waves[:, 2])
    products = waves[:, :, None, 0, None] * waves[:, None, :, 1, None] * waves[:, None, None, :, 2]
    x3, z3, xw, zw = (products.reshape(-1, 27) @ arm.coefficients).T
    margins = np.empty((len(values), 3))
    margins[:, 0] = -arm.shoulder_x - xw
    margins[:, 1] = (z3 * xw - x3 * zw) / np.maximum(np.hypot(x3, z3), tolerances.ZERO_VECTOR)
    margins[:, 2] = -values[:, HAND_AXIS]
    return margins


def _turning(joint: Joint) -> Matrix:
    """Return the placement of what a joint carries: the parts of 1, the cosine and the sine of its angle (3, 4, 4)."""
    d, parts = joint.direction, np.zeros((3, 4, 4))
    along, skew = np.outer(d, d), np.cross(np.eye(3), -d).T
    parts[0, :3, :3], parts[1, :3, :3], parts[2, :3, :3] = along, np.eye(3) - along, skew
    parts[0, 3, 3] = 1.0
    placed: Matrix = joint.T_parent_joint @ parts
    return placed


def _line(joint: Joint, links: dict[str, Matrix], n: int) -> Screw:
    """Return where a joint turns, in the base."""
    T = links[joint.child]
    return Screw(joint.kind, T[:3, :3] @ joint.direction, T[:3, 3], n)
