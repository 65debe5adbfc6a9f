"""What a controller shows and takes as a pose beside the position: data, no maths.

RTCP transformations are programmed by position and the machine's own rotary axes, complete ones by position and angles.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

from chainbuild.shown import fields_shown

DisplayKind = Literal["axes", "angles", "direction", "pitch", "plane", "vector", "position"]

POSITION_COLUMNS: Final = ("x_mm", "y_mm", "z_mm")
ANGLE_COLUMNS: Final = ("a_deg", "b_deg", "c_deg")
TOOL_COLUMNS: Final = ("tool_x", "tool_y", "tool_z")
QUATERNION_COLUMNS: Final = ("qx", "qy", "qz", "qw")
STATUS_COLUMNS: Final = ("is", "it")  # pose status and turn


@dataclass(frozen=True, slots=True)
class Display:
    """Columns of a pose beside x_mm, y_mm, z_mm, what they mean, and which axes inverse kinematics solves for.

    Attributes:
        kind: "axes": values of some of the axes themselves; "angles": pose angles of `Chain.angle_mode`, of which those
            without a column follow; "direction": two angles of the tool vector; "pitch": B and C of
            Rz(a)·Ry(B)·Rz(C - a), where a is the turn of the arm's plane; "plane": the tool's angle in the XY plane;
            "vector": the tool vector; "position": nothing.
        columns: Column names in the order in which they are written; empty for axes shown by their own names.
        axes: Kind "axes": index of the axis of each column.
        solved: Indices of the axes that are found where the columns are given; the others are given. Empty: all.
        letters: Kind "direction": the letters of the two turns, outer first: "CA" is Rz(C)·Rx(A).
        along: Kind "direction": what they turn to the tool vector.
        zero_deg: Kind "plane": the angle of the tool vector where the column is 0.
        rtcp: True where an RTCP transformation is programmed: full orientations are then no part of its display.
        keeps_side: True where the control keeps the branch it was switched on in.
        follows: Kind "angles": True where the orientation of given columns depends on the position.
        plane_xz: True where only x and z are programmed; y is then 0 where it is not given.
    """

    __repr__ = fields_shown

    kind: DisplayKind = "angles"
    columns: tuple[str, ...] = ANGLE_COLUMNS
    axes: tuple[int, ...] = ()
    solved: tuple[int, ...] = ()
    letters: str = ""
    along: Literal["x", "y", "z"] = "z"
    zero_deg: float = 0.0
    rtcp: bool = False
    keeps_side: bool = False
    follows: bool = False
    plane_xz: bool = False


POSE_ANGLES: Final = Display()
