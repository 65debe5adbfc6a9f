"""Status and turn of a six-axis articulated arm (KIN_TYP manual 3.3.3)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from numpy.typing import ArrayLike

from chainbuild import tolerances
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.elements import Joint
from chainbuild.chain.poses import link_placements
from chainbuild.errors import ChainbuildError
from chainbuild.frames import inverse
from chainbuild.ik.branches.arms.arms import wrist_centre
from chainbuild.ik.branches.core.serial import Screw, transformed_point
from chainbuild.kinematics.screws import joints_between_tips

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Mechanism

# Bits of the pose status, as KIN_TYP 45 numbers them.
WRIST_BEHIND: Final = 1
WRIST_IN_FRONT: Final = 2
HAND_NEGATIVE: Final = 4

_KINEMATIC: Final = "KIN_TYP 45"


def has_status(mechanism: Mechanism) -> bool:
    """Tell whether the controller defines status and turn for a robot's kinematic."""
    return mechanism.chain.kinematic == _KINEMATIC


def status_turn(mechanism: Mechanism, axes: ArrayLike) -> tuple[int, int]:
    """Return status and turn of axis values (KIN_TYP manual 3.3.3).

    Status: 1 where the wrist is behind axis 1, 2 where it is in front of the line through axes 2 and 3, 4 where axis 5
    is negative. Turn: bits 1, 2, 4, 8, 16, 32 for axes 1 to 6 below 0. On a boundary, and as little below 0 as rounding
    leads, the bit is not set.

    Args:
        mechanism: A robot of KIN_TYP 45.
        axes: (6,) axis values in degrees, as the controller shows them.

    Raises:
        ChainbuildError: the controller defines no status for this kinematic.
        AxisValueError: wrong number of values, or a value that is not finite.
    """
    if not has_status(mechanism):
        raise ChainbuildError(f"status and turn are defined for {_KINEMATIC} only", permitted=_KINEMATIC)
    values = mechanism.axis_values(axes)
    below = [bool(value < -tolerances.BELOW_ZERO_DEG) for value in values]
    turn = sum(1 << n for n, is_below in enumerate(below) if is_below)
    behind, in_front = _wrist_place(mechanism, mechanism.q(values))
    status = WRIST_BEHIND * behind + WRIST_IN_FRONT * in_front + HAND_NEGATIVE * below[4]
    return status, turn


def _wrist_place(mechanism: Mechanism, q: Vector) -> tuple[bool, bool]:
    """Return whether the wrist is behind axis 1, and whether it is in front of the line through axes 2 and 3.

    Seen from the column's frame: z along axis 1, the arm moves in the plane of x, ahead, and z, about y. Link frames
    are where the recipe draws them, whichever way the axes count.
    """
    chain = mechanism.chain
    # In chain order, which is the arm's own also where it carries the workpiece.
    arm = [chain.joints[n] for n in sorted(joints_between_tips(chain))]
    links = link_placements(chain, q)
    if wrist_centre([_line(joint, links, n) for n, joint in enumerate(arm[3:])]) is None:
        raise ChainbuildError("the wrist axes do not meet in a point, so status is not defined")
    column, shoulder, elbow, _, hand, _ = (links[joint.child] for joint in arm)
    back = inverse(column)
    (x2, _, z2), (x3, _, z3), (xw, _, zw) = (
        transformed_point(back, T[:3, 3]).tolist() for T in (shoulder, elbow, hand)
    )
    return xw < 0.0, (z3 - z2) * (xw - x2) - (x3 - x2) * (zw - z2) > 0.0


def _line(joint: Joint, links: dict[str, Matrix], n: int) -> Screw:
    """Return where a joint turns, in the base."""
    T = links[joint.child]
    return Screw(joint.kind, T[:3, :3] @ joint.direction, T[:3, 3], n)
