"""What the controller displays at axis values, and the orientation that displayed columns describe.

Which columns a kinematic has is `Chain.display`; this file has their maths, in both directions.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from chainbuild import frames, tolerances
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import joint_values
from chainbuild.chain.elements import Chain
from chainbuild.chain.poses import link_placements
from chainbuild.chain.programmed.display import ANGLE_COLUMNS, POSITION_COLUMNS, Display
from chainbuild.errors import ChainbuildError
from chainbuild.kinematics.inputs import real_numbers
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.units import deg_from_rad, mm_from_m

_ROTATIONS: Final = {"A": frames.rot_x, "B": frames.rot_y, "C": frames.rot_z}
_QUARTER_DEG: Final = 90.0  # the first of two answers has its first angle within this


def displayed(
    mechanism: Mechanism, axes: ArrayLike, near: Mapping[str, float] | None = None, at: pin.SE3 | None = None
) -> dict[str, float]:
    """Return what the controller displays at axis values; see `Robot.display`.

    Args:
        mechanism: The mechanism.
        axes: (n_axes,) axis values, mm and degrees.
        near: What was displayed before: of two answers of a tool vector the nearer one is taken.
        at: The pose there, where it is known already.
    """
    values = mechanism.axis_values(axes)
    T = mechanism.fk(values) if at is None else at
    shown = dict(zip(POSITION_COLUMNS, map(mm_from_m, T.translation.tolist()), strict=True))
    columns = mechanism.chain.display_columns
    shown |= zip(columns, orientation_shown(mechanism, values, T.rotation, near), strict=True)
    return shown | {axis.name: float(values[n]) for n, axis in enumerate(mechanism.axes) if axis.held}


def orientation_shown(
    mechanism: Mechanism, values: Vector, rotation: Matrix, near: Mapping[str, float] | None = None
) -> tuple[float, ...]:
    """Return the displayed values beside the position, in the order of `Chain.display_columns`.

    Args:
        mechanism: The mechanism.
        values: (n_axes,) axis values, mm and degrees.
        rotation: (3, 3) of the tool in the workpiece frame there.
        near: What was displayed before.
    """
    chain = mechanism.chain
    display = chain.display
    if display.kind == "axes":
        return tuple(float(values[n]) for n in display.axes)
    if display.kind == "angles":
        angles = dict(zip(ANGLE_COLUMNS, frames.angles_from_matrix(chain.angle_mode, rotation), strict=True))
        if chain.absolute_c is not None:
            angles["c_deg"] = chain.absolute_c.value(values)
        return tuple(angles[column] for column in display.columns)
    tool = rotation[:, chain.tool_column]
    if display.kind == "direction":
        return two_angles(display, tool, _before(display, near) if near else None)
    if display.kind == "plane":
        return (plane_angle(display, rotation),)
    if display.kind == "pitch":
        return pitch_and_turn(mechanism, values, rotation)
    return tuple(tool.tolist()) if display.kind == "vector" else ()


def _before(display: Display, near: Mapping[str, float]) -> tuple[float, ...]:
    """Return the two angles displayed before.

    Raises:
        ChainbuildError: one is missing or no finite number.
    """
    values = real_numbers([near.get(column, math.nan) for column in display.columns])
    if values is None or not (np.abs(values) < tolerances.HUGE_AXIS_VALUE).all():
        permitted = f"what was displayed before, with {', '.join(display.columns)}"
        raise ChainbuildError("near is no such display", parameter="near", permitted=permitted)
    return tuple(values.tolist())


def plane_angle(display: Display, rotation: Matrix) -> float:
    """Return the angle in the XY plane [deg], in (-180, 180], of a display of kind "plane"."""
    column = rotation[:, "xyz".index(display.along)]
    return wrapped(deg_from_rad(math.atan2(column[1], column[0])) - display.zero_deg)


def pitch_and_turn(mechanism: Mechanism, values: Vector, rotation: Matrix) -> tuple[float, float]:
    """Return B and C [deg] of R = Rz(a)·Ry(B)·Rz(C - a), a being the turn of the first joint, which bears the arm."""
    across = arm_normal(mechanism.chain, values)
    ahead = np.array([across[1], -across[0], 0.0])
    pitch = math.atan2(float(ahead @ rotation[:, 2]), float(rotation[2, 2]))
    turn = math.atan2(rotation[1, 0] - rotation[0, 1], rotation[0, 0] + rotation[1, 1])
    return wrapped(deg_from_rad(pitch)), wrapped(deg_from_rad(turn))


def arm_normal(chain: Chain, values: Vector) -> Vector:
    """Return the normal (3,) of the arm's plane at axis values: the y axis that the first joint turns about z."""
    links = link_placements(chain, joint_values(chain.axis_map, values))
    normal: Vector = links[chain.joints[0].child][:3, 1]
    return normal


def raised_and_turned(chain: Chain, values: Vector, pitch_deg: float, turn_deg: float) -> Matrix:
    """Return the rotation (3, 3) of the B and C [deg] that `pitch_and_turn` gives, at axis values (n_axes,)."""
    across = arm_normal(chain, values)
    arm_deg = deg_from_rad(math.atan2(-across[0], across[1]))
    R: Matrix = frames.rot_z(arm_deg) @ frames.rot_y(pitch_deg) @ frames.rot_z(turn_deg - arm_deg)
    return R


def wrapped(angle_deg: float) -> float:
    """Return an angle in (-180, 180]."""
    turned = math.remainder(angle_deg, 360.0)
    return 180.0 if turned == -180.0 else turned + 0.0


def vector_of_angles(display: Display, angles: Sequence[float]) -> Vector:
    """Return the tool vector R1·R2·e (3,) of two angles [deg] of a display of kind "direction"."""
    first, second = (_ROTATIONS[letter] for letter in display.letters)
    vector: Vector = first(angles[0]) @ second(angles[1]) @ np.eye(3)["xyz".index(display.along)]
    return vector


def two_angles(display: Display, tool: Vector, near: Sequence[float] | None = None) -> tuple[float, float]:
    """Return the two angles [deg] of a tool vector, for a display of kind "direction" (manual of KIN_TYP 91).

    Two pairs describe one vector: the one nearer to `near`; without it the one whose first angle is in (-90, 90].
    Where the first angle has no effect it stays, at 0 without `near`.

    Args:
        display: The display: v = R1·R2·e.
        tool: (3,) vector of length 1.
        near: Two angles [deg] displayed before.
    """
    i, j = ("ABC".index(letter) for letter in display.letters)
    k, sense = 3 - i - j, 1.0 if (j - i) % 3 == 1 else -1.0  # i × j = sense·k
    v_i, v_j, v_k = float(tool[i]), float(tool[j]), float(tool[k])
    across = math.hypot(v_j, v_k)
    pairs = []
    for side in (1.0, -1.0):
        if "xyz".index(display.along) == i:  # v = cos b, sin a·sin b, -sense·cos a·sin b
            a, b = math.atan2(side * v_j, -sense * side * v_k), math.atan2(side * across, v_i)
        else:  # along k: v = sense·sin b, -sense·sin a·cos b, cos a·cos b
            a, b = math.atan2(-sense * side * v_j, side * v_k), math.atan2(sense * v_i, side * across)
        pairs.append((deg_from_rad(a) + 0.0, deg_from_rad(b) + 0.0))  # without signed zeros
    if across < tolerances.GIMBAL_LOCK:
        kept = near[0] if near else 0.0
        pairs = [(kept, b) for _, b in pairs]
    if near:
        close = [
            (n + math.remainder(a - n, 360.0), m + math.remainder(b - m, 360.0)) for a, b in pairs for n, m in [near]
        ]
        return min(close, key=lambda pair: math.dist(pair, near))
    return next((pair for pair in pairs if -_QUARTER_DEG < pair[0] <= _QUARTER_DEG), pairs[0])
