"""Tables of poses: the tool in the workpiece frame, mm, with quaternion, tool vector and angles A, B, C."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TextIO

import numpy as np
from numpy.typing import NDArray

from chainbuild import frames, tolerances
from chainbuild.chain.elements import Task
from chainbuild.tables.axes import numbers
from chainbuild.tables.reader import Choice, Table
from chainbuild.units import deg_from_rad, m_from_mm, mm_from_m

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]

POSITION_COLUMNS: Final = ("x_mm", "y_mm", "z_mm")
QUATERNION_COLUMNS: Final = ("qx", "qy", "qz", "qw")
TOOL_COLUMNS: Final = ("tool_x", "tool_y", "tool_z")
ANGLE_COLUMNS: Final = ("a_deg", "b_deg", "c_deg")
POSE_COLUMNS: Final = (*POSITION_COLUMNS, *QUATERNION_COLUMNS, *TOOL_COLUMNS, *ANGLE_COLUMNS)


@dataclass(frozen=True, slots=True, eq=False)
class PoseRow:
    """One pose of a table.

    Attributes:
        line: Line number, from 1.
        T: (4, 4) tool in the workpiece frame [m].
    """

    line: int
    T: Matrix


class PoseTable(Table):
    """A table of poses.

    x_mm, y_mm, z_mm are due. The orientation is the quaternion where it is given, else A, B, C; a machine whose task
    is "direction" also takes the tool vector alone, one whose task is "position" needs none. Other pose columns are
    permitted and not read.

    Args:
        path: The file.
        angle_mode: Name in `frames.ANGLE_MODES`.
        task: What the machine's inverse kinematics solves for.

    Attributes:
        oriented: False where the table gives no orientation.

    Raises:
        FileAccessError: the file cannot be read.
        TableError: the header is missing, or names a column that is unknown, double or not complete.
    """

    def __init__(self, path: Path, angle_mode: str, task: Task) -> None:
        self._angle_mode = angle_mode
        self._task = task
        super().__init__(path, self._choose)
        orientation = tuple(self.wanted[3:])
        self.oriented = bool(orientation)
        self._rotation = self._reader(orientation)

    def _choose(self, names: Sequence[str]) -> Choice:
        return (*POSITION_COLUMNS, *self._orientation_columns(set(names))), POSE_COLUMNS

    def _orientation_columns(self, names: set[str]) -> tuple[str, ...]:
        if names & set(QUATERNION_COLUMNS):
            return QUATERNION_COLUMNS
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
                yield PoseRow(line, frames.transform(self._rotation(line, values[3:]), position))

    def _from_quaternion(self, line: int, quaternion: list[float]) -> Matrix:
        self._check_length(line, quaternion, QUATERNION_COLUMNS)
        return frames.matrix_from_quaternion(quaternion)

    def _from_tool_vector(self, line: int, direction: list[float]) -> Matrix:
        self._check_length(line, direction, TOOL_COLUMNS)
        x, y, z = direction
        tilt, turn = math.atan2(math.hypot(x, y), z), math.atan2(y, x)
        return frames.rot_z(deg_from_rad(turn)) @ frames.rot_y(deg_from_rad(tilt))

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
    """

    def __init__(self, stream: TextIO, angle_mode: str) -> None:
        self._stream = stream
        self._angle_mode = angle_mode
        stream.write(",".join(POSE_COLUMNS) + "\n")

    def write(self, T: Matrix) -> None:
        """Write one pose: (4, 4), tool in the workpiece frame [m]."""
        self._stream.write(numbers(pose_values(T, self._angle_mode)) + "\n")


def pose_values(T: Matrix, angle_mode: str) -> Vector:
    """Return the values (13,) of a pose (4, 4) [m] in the order of `POSE_COLUMNS`, mm and degrees."""
    R = T[:3, :3]
    position = [mm_from_m(value) for value in T[:3, 3].tolist()]
    quaternion, angles = frames.quaternion_from_matrix(R), frames.angles_from_matrix(angle_mode, R)
    return np.array([*position, *quaternion, *R[:, 2].tolist(), *angles])
