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
    values = axis_rows(robot.axes, axes)
    status = (_margins(robot, values) > _SET_ABOVE) @ _BITS
    turn = (values < -tolerances.BELOW_ZERO_DEG) @ (1 << np.arange(values.shape[1]))
    found: Integers = np.stack((status, turn), axis=1)
    return found


def status_and_decided(mechanism: Mechanism, values: Matrix) -> tuple[Integers, Integers]:
    """Return the status (N,) of rows of axis values (N, 6), and which of its bits (N,) are decided.

    A bit is not where the arm is as near to the boundary as a verified pose leaves open: at a singular position.
    """
    margins = _margins(mechanism, values)
    return (margins > 0.0) @ _BITS, (np.abs(margins) > _OPEN_BELOW) @ _BITS


@dataclass(frozen=True, slots=True, eq=False)
class _Part:
    """What a joint carries, turned by the joint and seen from the part before.

    Attributes:
        place: Place of the joint among the joint values.
        along: (3, 3) points by this: their part along the axis.
        across: (3, 3) points by this: moved on by a quarter turn, without their part along the axis.
        R: (3, 3) points by this: in the axes of the part before.
        origin: (3,) the joint [m], there.
    """

    place: int
    along: Matrix
    across: Matrix
    R: Matrix
    origin: Vector

    @classmethod
    def of(cls, joint: Joint, place: int) -> _Part:
        T, d = joint.T_parent_joint, joint.direction
        return cls(place, np.outer(d, d), np.cross(np.eye(3), -d), T[:3, :3].T, T[:3, 3])

    def placed(self, points: Matrix, q: Matrix) -> Matrix:
        """Return points (N, 3) on the joint as seen from the part before, at joint values (N, n_q)."""
        c, s = np.cos(q[:, self.place, None]), np.sin(q[:, self.place, None])
        along = points @ self.along
        turned: Matrix = along + c * (points - along) + s * (points @ self.across)
        return turned @ self.R + self.origin


def _margins(mechanism: Mechanism, values: Matrix) -> Matrix:
    """Return how far each bit of the status is from its boundary (N, 3), positive where it is set.

    The wrist behind axis 1 [m], in front of the line through axes 2 and 3 [m], axis 5 below zero [degrees]. Link frames
    are where the recipe draws them, whichever way the axes count.
    """
    shoulder, elbow, fore, hand = mechanism.prepared("status", lambda: _parts(mechanism))
    q = _joint_rows(mechanism, values)
    x2, _, z2 = shoulder.origin.tolist()
    x3, _, z3 = shoulder.placed(elbow.origin[None], q).T
    xw, _, zw = shoulder.placed(elbow.placed(fore.placed(hand.origin[None], q), q), q).T
    length = np.maximum(np.hypot(x3 - x2, z3 - z2), tolerances.ZERO_VECTOR)
    in_front = ((z3 - z2) * (xw - x2) - (x3 - x2) * (zw - z2)) / length
    return np.stack((-xw, in_front, -values[:, HAND_AXIS]), axis=1)


def _parts(mechanism: Mechanism) -> tuple[_Part, ...]:
    """Return axes 2, 3, 4 and 5 of an arm, the first as seen from its column.

    Raises:
        ChainbuildError: the wrist axes do not meet in a point.
    """
    chain = mechanism.chain
    # In chain order, which is the arm's own also where it carries the workpiece.
    places = sorted(joints_between_tips(chain))
    links = link_placements(chain, mechanism.q(np.zeros(len(chain.axes))))
    if wrist_centre([_line(chain.joints[place], links, n) for n, place in enumerate(places[3:])]) is None:
        raise ChainbuildError("the wrist axes do not meet in a point, so status is not defined")
    return tuple(_Part.of(chain.joints[place], place) for place in places[1:5])


def _line(joint: Joint, links: dict[str, Matrix], n: int) -> Screw:
    """Return where a joint turns, in the base."""
    T = links[joint.child]
    return Screw(joint.kind, T[:3, :3] @ joint.direction, T[:3, 3], n)


def _joint_rows(mechanism: Mechanism, values: Matrix) -> Matrix:
    """Return joint values (N, n_q) of rows of axis values."""
    axis_map = mechanism.chain.axis_map
    if isinstance(axis_map, AffineMap):
        rows: Matrix = (values * axis_map.si_factors) @ axis_map.A.T + axis_map.b
        return rows
    return np.array([joint_values(axis_map, row) for row in values]).reshape(len(values), -1)
