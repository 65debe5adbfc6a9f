"""Tables of poses: the tool in the workpiece frame, mm, with quaternion, tool vector and angles A, B, C."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal, TextIO

import numpy as np

from chainbuild import frames, tolerances
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.display import ANGLE_COLUMNS, POSITION_COLUMNS, TOOL_COLUMNS
from chainbuild.chain.drives import DRIVE_SUFFIX
from chainbuild.chain.elements import Task
from chainbuild.tables.axes import DECIMALS, UNIT_DECIMALS, VIOLATIONS_COLUMN, names_field, number_field
from chainbuild.tables.reader import Choice, Table
from chainbuild.units import deg_from_rad, m_from_mm, mm_from_m, rad_from_deg

ToolAxis = Literal["x", "z"]

QUATERNION_COLUMNS: Final = ("qx", "qy", "qz", "qw")
C_COLUMN: Final = "c_deg"
POSE_COLUMNS: Final = (*POSITION_COLUMNS, *QUATERNION_COLUMNS, *TOOL_COLUMNS, *ANGLE_COLUMNS)
_UNIT_VECTORS: Final = slice(3, 10)  # quaternion and tool vector


@dataclass(frozen=True, slots=True, eq=False)
class PoseRow:
    """One pose of a table.

    Attributes:
        line: Line number, from 1.
        T: (4, 4) tool in the workpiece frame [m].
        c_deg: The angle C where it runs on over whole turns and the table gives it, else None.
        held: Input axis → value, for the columns that the table has.
        contradictory: True where A, B, C beside the quaternion are those of another orientation.
    """

    line: int
    T: Matrix
    c_deg: float | None = None
    held: Mapping[str, float] | None = None
    contradictory: bool = False


class PoseTable(Table):
    """A table of poses.

    x_mm, y_mm, z_mm are required. The orientation is the quaternion where it is given, else A, B, C; a machine whose
    task is "direction" also takes the tool vector alone, one whose task is "position" needs none. On a machine whose A
    and B follow C, c_deg alone is enough; where C continues over whole turns, c_deg is also read beside a quaternion.
    Input axes may have columns of their own. Column `violations`, which `PoseWriter` adds, is permitted and not read;
    any other is refused.

    Args:
        path: The file.
        angle_mode: Name in `frames.ANGLE_MODES`.
        task: What the machine's inverse kinematics solves for.
        follows_c: True where A and B follow C.
        running_c: True where C runs on over whole turns.
        tool_axis: Axis of the tool frame that is the tool vector.
        held: Names of the input axes, which inverse kinematics does not move.

    Attributes:
        held: Those of the input axes that have a column.
        oriented: False where the table gives no orientation.
        by_quaternion: True where it gives quaternions.

    Raises:
        FileAccessError: the file cannot be read.
        TableError: the header is missing, or names a column that is unknown or duplicate, or is incomplete.
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
        held: Sequence[str] = (),
    ) -> None:
        self._inputs = tuple(held)
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
        self.held = tuple(name for name in self._inputs if name in self.names)
        self._held = slice(len(self.wanted) - len(self.held), len(self.wanted))

    def _choose(self, names: Sequence[str]) -> Choice:
        orientation = self._orientation_columns(set(names))
        beside = (C_COLUMN,) if self._running_c and C_COLUMN in names and C_COLUMN not in orientation else ()
        held = (name for name in self._inputs if name in names)
        drives = (name for name in names if name.endswith(DRIVE_SUFFIX))  # written by fk, not read
        known = (*POSE_COLUMNS, *self._inputs, VIOLATIONS_COLUMN, *drives)
        return (*POSITION_COLUMNS, *orientation, *beside, *held), known

    def _shown_columns(self, permitted: Sequence[str]) -> Sequence[str]:
        return [name for name in permitted if name != VIOLATIONS_COLUMN]

    def _beside_columns(self) -> tuple[str, ...]:
        # Read for comparison only. Where C runs on over whole turns c_deg is an input of its own.
        given = set(self.names) >= {*QUATERNION_COLUMNS, *ANGLE_COLUMNS}
        return ANGLE_COLUMNS if given and not self._running_c else ()

    def _alternatives(self, missing: Sequence[str]) -> str:
        """Return the other orientations that this machine takes, where the table gives none at all."""
        groups = [QUATERNION_COLUMNS, ANGLE_COLUMNS]
        groups += [(C_COLUMN,)] if self._follows_c else []
        groups += [TOOL_COLUMNS] if self._task != "pose" else []
        if set(self.names) & {name for group in groups for name in group}:
            return ""
        return "".join(f", or {', '.join(group)}" for group in groups if not set(group) & set(missing))

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
                held = dict(zip(self.held, values[self._held], strict=True)) if self.held else None
                contradictory = bool(self.beside) and self._contradicts(rotation, values[-len(self.beside) :])
                yield PoseRow(line, frames.transform(rotation, position), c_deg, held, contradictory)

    def _contradicts(self, rotation: Matrix, angles: list[float]) -> bool:
        """Return whether angles A, B, C are given and describe another rotation than the quaternion."""
        if not all(abs(angle) < tolerances.HUGE_AXIS_VALUE for angle in angles):
            return False
        difference = rotation - frames.matrix_from_angles(self._angle_mode, angles)
        # A rotation by a small angle differs from 1 by the angle times the square root of 2.
        return float(np.linalg.norm(difference)) > math.sqrt(2.0) * rad_from_deg(
            tolerances.ANGLES_BESIDE_QUATERNION_DEG
        )

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
        held: Names of the input axes; each has a column behind the pose.
        violations: True: one more column names the limits that are violated.
        drives: Names of the columns of drive values, behind all others.
    """

    def __init__(
        self,
        stream: TextIO,
        angle_mode: str,
        *,
        tool_axis: ToolAxis = "z",
        held: Sequence[str] = (),
        violations: bool = False,
        drives: Sequence[str] = (),
    ) -> None:
        self._stream = stream
        self._angle_mode = angle_mode
        self._tool_axis = tool_axis
        self._violations = violations
        last = (VIOLATIONS_COLUMN,) if violations else ()
        stream.write(",".join((*POSE_COLUMNS, *held, *last, *drives)) + "\n")

    def write(
        self,
        T: Matrix,
        angles: Sequence[float] | None = None,
        violated: Sequence[str] = (),
        held: Sequence[float] = (),
        drives: Sequence[float] = (),
    ) -> None:
        """Write one pose.

        Args:
            T: (4, 4) tool in the workpiece frame [m].
            angles: A, B, C as the controller shows them; None: those of the pose.
            violated: Names of the limits that are violated.
            held: Values of the input axes, mm and degrees.
            drives: Values of the drives, mm and degrees.
        """
        values = pose_values(T, self._angle_mode, self._tool_axis).tolist()
        # Rounding may give -180, which is outside (-180, 180].
        shown = angles or [180.0 if round(value, DECIMALS) == -180.0 else value for value in values[-3:]]
        fields = [
            *(number_field(value) for value in values[: _UNIT_VECTORS.start]),
            *(number_field(value, UNIT_DECIMALS) for value in values[_UNIT_VECTORS]),
            *(number_field(value) for value in (*shown, *held)),
        ]
        last = [names_field(violated)] if self._violations else []
        self._stream.write(",".join([*fields, *last, *(number_field(value) for value in drives)]) + "\n")


def pose_values(T: Matrix, angle_mode: str, tool_axis: ToolAxis = "z") -> Vector:
    """Return the values (13,) of a pose (4, 4) [m] in the order of `POSE_COLUMNS`, mm and degrees."""
    R = T[:3, :3]
    position = [mm_from_m(value) for value in T[:3, 3].tolist()]
    quaternion, angles = frames.quaternion_from_matrix(R), frames.angles_from_matrix(angle_mode, R)
    tool = R[:, 0 if tool_axis == "x" else 2]
    return np.array([*position, *quaternion, *tool.tolist(), *angles])
