"""Tool directions of the programming modes of KIN_TYP 91: two programmed angles, or a vector (P-CHAN-00112).

A mode names two rotations and the tool direction at zero: the tool points along R1·R2·e. In the classic modes 14 to 19
e is the axis of the first rotation; in 20 and 21 it is Z.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from chainbuild import tolerances
from chainbuild.arrays import Vector
from chainbuild.errors import ChainbuildError
from chainbuild.frames import cos_sin_deg, rot_x, rot_y, rot_z, unit

POINT_VECTOR_MODE: Final = 10
_ROTATIONS: Final = {"A": rot_x, "B": rot_y, "C": rot_z}
_AXES: Final = {"A": 0, "B": 1, "C": 2, "X": 0, "Y": 1, "Z": 2}


@dataclass(frozen=True, slots=True)
class DirectionMode:
    """A mode of two angles.

    Attributes:
        number: P-CHAN-00112, or programming_mode of KIN_TYP 91.
        first: Letter of the first angle: A turns about X, B about Y, C about Z.
        second: Letter of the second angle.
        tool: Coordinate axis the tool points along at zero.
    """

    number: int
    first: str
    second: str
    tool: str


DIRECTION_MODES: Final[Mapping[int, DirectionMode]] = MappingProxyType(
    {
        mode.number: mode
        for mode in (
            DirectionMode(14, "A", "B", "X"),
            DirectionMode(15, "B", "A", "Y"),
            DirectionMode(16, "A", "C", "X"),
            DirectionMode(17, "C", "A", "Z"),
            DirectionMode(18, "B", "C", "Y"),
            DirectionMode(19, "C", "B", "Z"),
            DirectionMode(20, "A", "B", "Z"),
            DirectionMode(21, "B", "A", "Z"),
        )
    }
)


def tool_direction(mode: int, values: Sequence[float]) -> Vector:
    """Return the tool direction (3,) of length 1 that a mode's programmed values mean.

    >>> tool_direction(17, (90.0, 30.0)).round(4)  # C90 A30
    array([0.5  , 0.   , 0.866])

    Args:
        mode: 10, or 14 to 21.
        values: U, V, W of any length but zero in mode 10; else the two angles in degrees, in the order of the mode.

    Raises:
        ChainbuildError: another mode, or the zero vector.
    """
    if mode == POINT_VECTOR_MODE:
        return unit(values)
    named = _mode(mode)
    first, second = values
    return _ROTATIONS[named.first](first) @ _ROTATIONS[named.second](second) @ _basis(named.tool)


def angles_of_direction(mode: int, direction: ArrayLike) -> tuple[tuple[float, float], ...]:
    """Return the pairs of angles [degrees, in (-180, 180]] that point the tool along a direction.

    Two pairs as a rule. One where the direction is the axis of the first angle, which then is free and returned as 0.
    None where the mode cannot reach it: never for modes 14 to 21.

    Args:
        mode: 14 to 21.
        direction: Any vector but zero.

    Raises:
        ChainbuildError: another mode, or the zero vector.
    """
    named = _mode(mode)
    wanted = unit(direction)
    axis, e = _basis(named.first), _basis(named.tool)
    side = np.cross(_basis(named.second), e)
    # The second rotation sweeps e·cos + side·sin; along the first axis only one of the two has a share, of size 1.
    along_e, along_side = float(axis @ e), float(axis @ side)
    height = max(-1.0, min(1.0, float(axis @ wanted)))
    if along_e:
        angle = math.acos(height * along_e)
        seconds = [math.degrees(angle), -math.degrees(angle)]
    else:
        angle = math.degrees(math.asin(height * along_side))
        seconds = [angle, 180.0 - angle]
    if math.hypot(*np.delete(wanted, _AXES[named.first])) < tolerances.GIMBAL_LOCK:
        return ((0.0, _wrapped(seconds[0])),)
    pairs = []
    for second in seconds:
        cosine, sine = cos_sin_deg(second)
        swept = e * cosine + side * sine
        turned = math.atan2(float(axis @ np.cross(swept, wanted)), float(swept @ wanted) - height * height)
        pairs.append((_wrapped(math.degrees(turned)), _wrapped(second)))
    return tuple(pairs)


def _mode(number: int) -> DirectionMode:
    if number not in DIRECTION_MODES:
        known = ", ".join(map(str, (POINT_VECTOR_MODE, *DIRECTION_MODES)))
        raise ChainbuildError(f"programming mode {number} names no tool direction", permitted=known)
    return DIRECTION_MODES[number]


def _basis(letter: str) -> Vector:
    vector = np.zeros(3)
    vector[_AXES[letter]] = 1.0
    return vector


def _wrapped(angle_deg: float) -> float:
    wrapped = math.remainder(angle_deg, 360.0)
    return 180.0 if wrapped == -180.0 else wrapped + 0.0
