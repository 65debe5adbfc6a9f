"""Tables recorded on the controller: axis values and the poses it showed for them, row by row."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from chainbuild import frames
from chainbuild.arrays import Matrix
from chainbuild.chain.display import ANGLE_COLUMNS, POSITION_COLUMNS, TOOL_COLUMNS
from chainbuild.chain.elements import Chain, Task
from chainbuild.errors import Span, TableError
from chainbuild.shown import fields_shown
from chainbuild.tables.axes import RESULT_COLUMNS, VIOLATIONS_COLUMN
from chainbuild.tables.poses import POSE_COLUMNS, QUATERNION_COLUMNS
from chainbuild.tables.reader import Table
from chainbuild.units import m_from_mm


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """Axis values and poses read on the controller.

    Attributes:
        axes: (n, n_axes) mm and degrees.
        poses: (n, 4, 4) tool in the workpiece frame [m].
        compared: What of the poses was recorded.
        name: File name.
    """

    __repr__ = fields_shown

    axes: NDArray[np.float64]
    poses: NDArray[np.float64]
    compared: Task = "pose"
    name: str = "recording"


def read_recording(path: Path | str, chain: Chain) -> Recording:
    """Read axis values and poses from one table.

    Columns: the axes by name, x_mm, y_mm, z_mm, and an orientation: qx, qy, qz, qw, else a_deg, b_deg, c_deg in the
    controller's angles, else the tool direction tool_x, tool_y, tool_z, else none. The result columns of inverse
    kinematics are permitted and not read.

    Args:
        path: The file.
        chain: The machine's axes, and what its angles and its tool direction are.

    Raises:
        FileAccessError: the file cannot be read.
        TableError: a column is missing or unknown, or a row holds no numbers.
    """
    names = tuple(axis.name for axis in chain.axes)
    orientation: list[str] = []

    def choose(found: Sequence[str]) -> tuple[Sequence[str], Sequence[str]]:
        columns = (QUATERNION_COLUMNS, ANGLE_COLUMNS, TOOL_COLUMNS)
        orientation.extend(next((group for group in columns if set(group) & set(found)), ()))
        return (*names, *POSITION_COLUMNS, *orientation), (*names, *POSE_COLUMNS, *RESULT_COLUMNS, VIOLATIONS_COLUMN)

    with Table(path, choose) as table:
        values = [chunk.values for chunk in table.chunks()]
    if not values:
        raise TableError("the recording has no rows", span=Span(str(path)))
    rows = np.vstack(values)
    count = len(names)
    poses = np.tile(np.eye(4), (len(rows), 1, 1))
    poses[:, :3, 3] = [[m_from_mm(v) for v in row] for row in rows[:, count : count + 3].tolist()]
    if orientation:
        poses[:, :3, :3] = [_rotation(tuple(orientation), row, chain, path) for row in rows[:, count + 3 :].tolist()]
    return Recording(rows[:, :count].copy(), poses, _compared(tuple(orientation)), str(path))


def _compared(orientation: tuple[str, ...]) -> Task:
    if not orientation:
        return "position"
    return "direction" if orientation == TOOL_COLUMNS else "pose"


def _rotation(orientation: tuple[str, ...], values: list[float], chain: Chain, path: Path | str) -> Matrix:
    """Return the rotation of a row; of a tool direction, some rotation that has it."""
    if orientation == ANGLE_COLUMNS:
        return frames.matrix_from_angles(chain.angle_mode, values)
    if not any(values):
        raise TableError(f"({', '.join(orientation)}) is zero", span=Span(str(path)), permitted="length 1")
    if orientation == QUATERNION_COLUMNS:
        return frames.matrix_from_quaternion(values)
    tool = frames.unit(values)
    aside = frames.unit(np.cross(np.eye(3)[int(np.argmin(np.abs(tool)))], tool))
    third = np.cross(tool, aside)
    return np.column_stack((tool, aside, third) if chain.tool_axis == "x" else (aside, third, tool))
