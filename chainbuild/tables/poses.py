"""Tables of poses: the tool in the workpiece frame, mm, with quaternion, tool vector and angles A, B, C."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal, TextIO

import numpy as np
from numpy.typing import NDArray

from chainbuild import frames, tolerances
from chainbuild.chain.elements import Task
from chainbuild.tables.axes import VIOLATIONS_COLUMN, joined, numbers
from chainbuild.tables.reader import Choice, Table
from chainbuild.units import deg_from_rad, m_from_mm, mm_from_m

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]
ToolAxis = Literal["x", "z"]

POSITION_COLUMNS: Final = ("x_mm", "y_mm", "z_mm")
QUATERNION_COLUMNS: Final = ("qx", "qy", "qz", "qw")
TOOL_COLUMNS: Final = ("tool_x", "tool_y", "tool_z")
C_COLUMN: Final = "c_deg"
ANGLE_COLUMNS: Final = ("a_deg", "b_deg", C_COLUMN)
POSE_COLUMNS: Final = (*POSITION_COLUMNS, *QUATERNION_COLUMNS, *TOOL_COLUMNS, *ANGLE_COLUMNS)


@dataclass(frozen=True, slots=True, eq=False)
class PoseRow:
    """One pose of a table.

    Attributes:
        line: Line number, from 1.
        T: (4, 4) tool in the workpiece frame [m].
        c_deg: The angle C where it runs on over whole turns and the table gives it, else None.
    """

    line: int
    T: Matrix
    c_deg: float | None = None


class PoseTable(Table):
    """A table of poses.

    x_mm, y_mm, z_mm are due. The orientation is the quaternion where it is given, else A, B, C; a machine whose task
    is "direction" also takes the tool vector alone, one whose task is "position" needs none. Other pose columns are
    permitted and not read. Of a machine on which A and B follow C, c_deg alone will do; where C runs on over whole
    turns, c_deg is also read beside a quaternion.

    Args:
        path: The file.
        angle_mode: Name in `frames.ANGLE_MODES`.
        task: What the machine's inverse kinematics solves for.
        follows_c: True where A and B follow C.
        running_c: True where C runs on over whole turns.
        tool_axis: Axis of the tool frame that is the tool vector.

    Attributes:
        oriented: False where the table gives no orientation.
        by_quaternion: True where it gives quaternions.

    Raises:
        FileAccessError: the file cannot be read.
        TableError: the header is missing, or names a column that is unknown, double or not complete.
    """

    def __init__(
        self,
        path: Path,
        angle_mode: str,
        task: Task,
        *,
        follows_c: bool = False,
        running_c: bool = False,
        tool_axis: ToolAxis = "z",
    ) -> None:
        self._angle_mode = angle_mode
        self._task = task
        self._follows_c = follows_c
        self._running_c = running_c
        self._tool_axis = tool_axis
        super().__init__(path, self._choose)
        orientation = self._orientation_columns(set(self.names))
        self.oriented = bool(orientation)
        self.by_quaternion = orientation == QUATERNION_COLUMNS
        self._orientation = slice(3, 3 + len(orientation))
        self._rotation = self._reader(orientation)
        self._c = self.wanted.index(C_COLUMN) if running_c and C_COLUMN in self.wanted else None

    def _choose(self, names: Sequence[str]) -> Choice:
        orientation = self._orientation_columns(set(names))
        beside = (C_COLUMN,) if self._running_c and C_COLUMN in names and C_COLUMN not in orientation else ()
        return (*POSITION_COLUMNS, *orientation, *beside), (*POSE_COLUMNS, VIOLATIONS_COLUMN)

    def _orientation_columns(self, names: set[str]) -> tuple[str, ...]:
        if names & set(QUATERNION_COLUMNS):
            return QUATERNION_COLUMNS
        if self._follows_c and names & set(ANGLE_COLUMNS) == {C_COLUMN}:
            return (C_COLUMN,)
        if names & set(ANGLE_COLUMNS):
            return ANGLE_COLUMNS
        if self._task == "pose":
            return QUATERNION_COLUMNS
        if self._task == "position" and not names & set(TOOL_COLUMNS):
            return ()
        return TOOL_COLUMNS

    def _reader(self, orientation: tuple[str, ...]) -> Callable[[int, list[float]], Matrix]:
        if orientation == QUATERNION_COLUMNS:
            return self._from_quaternion
        if orientation == ANGLE_COLUMNS:
            return lambda _line, angles: frames.matrix_from_angles(self._angle_mode, angles)
        if orientation == (C_COLUMN,):
            return lambda _line, angle: frames.matrix_from_angles(self._angle_mode, (0.0, 0.0, *angle))
        if orientation == TOOL_COLUMNS:
            return self._from_tool_vector
        return lambda _line, _nothing: np.eye(3)

    def rows(self) -> Iterator[PoseRow]:
        """Read the poses that are left.

        Raises:
            TableError: a row holds no pose.
        """
        for chunk in self.chunks():
            for line, values in zip(chunk.lines, chunk.values.tolist(), strict=True):
                position = [m_from_mm(value) for value in values[:3]]
                rotation = self._rotation(line, values[self._orientation])
                c_deg = None if self._c is None else values[self._c]
                yield PoseRow(line, frames.transform(rotation, position), c_deg)

    def _from_quaternion(self, line: int, quaternion: list[float]) -> Matrix:
        self._check_length(line, quaternion, QUATERNION_COLUMNS)
        return frames.matrix_from_quaternion(quaternion)

    def _from_tool_vector(self, line: int, direction: list[float]) -> Matrix:
        self._check_length(line, direction, TOOL_COLUMNS)
        x, y, z = direction
        tilt, turn = math.atan2(math.hypot(x, y), z), math.atan2(y, x)
        R = frames.rot_z(deg_from_rad(turn)) @ frames.rot_y(deg_from_rad(tilt))
        return R if self._tool_axis == "z" else R @ frames.rot_y(-90.0)

    def _check_length(self, line: int, values: list[float], columns: tuple[str, ...]) -> None:
        norm = math.hypot(*values)
        if not abs(norm - 1.0) <= tolerances.QUATERNION_NORM:
            raise self.error_at(
                line, f"({', '.join(columns)}) has the length {norm:.6g}", f"1 ± {tolerances.QUATERNION_NORM:g}"
            )


class PoseWriter:
    """Writes poses with quaternion (qw ≥ 0), tool vector and angles A, B, C.

    Args:
        stream: Where to.
        angle_mode: Name in `frames.ANGLE_MODES`.
        tool_axis: Axis of the tool frame that is the tool vector.
        violations: True: one more column names the limits that are violated.
    """

    def __init__(self, stream: TextIO, angle_mode: str, *, tool_axis: ToolAxis = "z", violations: bool = False) -> None:
        self._stream = stream
        self._angle_mode = angle_mode
        self._tool_axis = tool_axis
        self._violations = violations
        stream.write(",".join((*POSE_COLUMNS, VIOLATIONS_COLUMN) if violations else POSE_COLUMNS) + "\n")

    def write(self, T: Matrix, angles: Sequence[float] | None = None, violated: Sequence[str] = ()) -> None:
        """Write one pose.

        Args:
            T: (4, 4) tool in the workpiece frame [m].
            angles: A, B, C as the controller shows them; None: those of the pose.
            violated: Names of the limits that are violated.
        """
        values = pose_values(T, self._angle_mode, self._tool_axis)
        if angles is not None:
            values[-3:] = angles
        last = f",{joined(violated)}" if self._violations else ""
        self._stream.write(f"{numbers(values)}{last}\n")


def pose_values(T: Matrix, angle_mode: str, tool_axis: ToolAxis = "z") -> Vector:
    """Return the values (13,) of a pose (4, 4) [m] in the order of `POSE_COLUMNS`, mm and degrees."""
    R = T[:3, :3]
    position = [mm_from_m(value) for value in T[:3, 3].tolist()]
    quaternion, angles = frames.quaternion_from_matrix(R), frames.angles_from_matrix(angle_mode, R)
    tool = R[:, 0 if tool_axis == "x" else 2]
    return np.array([*position, *quaternion, *tool.tolist(), *angles])
