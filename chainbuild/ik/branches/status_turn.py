"""Status and turn of a six-axis articulated arm (KIN_TYP manual 3.3.3)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.arms.arms import wrist_centre
from chainbuild.ik.branches.core.serial import Screw, structure_of, unroll

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Mechanism

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
    is negative. Turn: bits 1, 2, 4, 8, 16, 32 for axes 1 to 6 below 0. On a boundary the bit is not set.

    Args:
        mechanism: A robot of KIN_TYP 45.
        axes: (6,) axis values in degrees, as the controller shows them.

    Raises:
        ChainbuildError: the controller defines no status for this kinematic.
        AxisValueError: wrong count or not finite.
    """
    if not has_status(mechanism):
        raise ChainbuildError(f"status and turn are defined for {_KINEMATIC} only", permitted=_KINEMATIC)
    values = mechanism.axis_values(axes)
    turn = sum(1 << n for n, value in enumerate(values) if value < 0.0)
    behind, in_front = _wrist_place(mechanism, mechanism.q(values))
    status = WRIST_BEHIND * behind + WRIST_IN_FRONT * in_front + HAND_NEGATIVE * bool(values[4] < 0.0)
    return status, turn


def _wrist_place(mechanism: Mechanism, q: np.ndarray) -> tuple[bool, bool]:
    """Return whether the wrist is behind axis 1, and whether it is in front of the line through axes 2 and 3."""
    structure = structure_of(mechanism, np.zeros(len(mechanism.axes), dtype=bool))
    serial = unroll(mechanism.chain, q, structure.moving)
    if [screw.joint for screw in serial.screws] != sorted(screw.joint for screw in serial.screws):
        serial = serial.reversed()  # the arm carries the workpiece
    one, two, three, *hand = serial.screws
    centre = wrist_centre(hand)
    if centre is None:
        raise ChainbuildError("the hand axes do not meet in a point, so no status is defined")
    forward = np.cross(two.direction, one.direction)  # the arm's plane at joint value 0: Y × Z = X
    elbow = _moved((two,), three.point, q)
    wrist = _moved((two, three), centre, q)
    behind = float(forward @ (wrist - one.point)) < 0.0
    along, out = elbow - two.point, wrist - two.point
    side = float(two.direction @ np.cross(along, out))
    return behind, side > 0.0


def _moved(screws: tuple[Screw, ...], point: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return a point after the screws' motions, the last one first."""
    for screw in reversed(screws):
        point = screw.move(float(q[screw.joint]), point)
    return point
