"""Tables recorded on the controller: axis values and the poses it showed for them, row by row."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from chainbuild import frames
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.elements import Chain, Task
from chainbuild.chain.poses import pose
from chainbuild.chain.programmed.display import ANGLE_COLUMNS, POSITION_COLUMNS, QUATERNION_COLUMNS, TOOL_COLUMNS
from chainbuild.errors import Span, TableError
from chainbuild.kinematics.displayed import plane_angle, raised_and_turned
from chainbuild.shown import fields_shown
from chainbuild.tables.axes import RESULT_COLUMNS, VIOLATIONS_COLUMN
from chainbuild.tables.form import OrientationSource, PoseColumns, PoseForm
from chainbuild.tables.reader import Choice, Table
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
    _form: PoseForm | None = field(default=None, repr=False)  # how they were read, where that depends on the chain

    def read_for(self, chain: Chain) -> NDArray[np.float64]:
        """Return the poses (n, 4, 4) as another chain of the same machine, with other conventions, means them.

        Raises:
            ChainbuildError: its poses have other columns.
        """
        if self._form is None or (self._form.whole and PoseForm.of(chain, "direction") == self._form):
            return self.poses
        poses = read_recording(self.name, chain).poses if Path(self.name).is_file() else self.poses
        return poses if len(poses) == len(self.poses) else self.poses


def read_recording(path: Path | str, chain: Chain) -> Recording:
    """Read axis values and poses from one table.

    Columns: the axes by name, x_mm, y_mm, z_mm, and what the controller displays beside them, or a full orientation:
    qx, qy, qz, qw, on complete kinematics a_deg, b_deg, c_deg, else the tool direction tool_x, tool_y, tool_z, else
    none. RTCP kinematics display their rotary axes, whose columns are there. Angles that follow from the displayed ones
    are those of the model. The result columns of inverse kinematics are permitted and not read.

    Args:
        path: The file.
        chain: The machine's axes, and what its angles and its tool direction are.

    Raises:
        FileAccessError: the file cannot be read.
        TableError: a column is missing or unknown, or a row holds no numbers.
    """
    with _RecordingTable(path, chain) as table:
        values = [chunk.values for chunk in table.chunks()]
    if not values:
        raise TableError("the recording has no rows", span=Span(str(path)))
    rows = np.vstack(values)
    count, first = len(chain.axes), len(chain.axes) + len(table.place_columns)
    axes = rows[:, :count].copy()
    poses = np.tile(np.eye(4), (len(rows), 1, 1))
    for column, name in enumerate(table.place_columns, start=count):
        poses[:, POSITION_COLUMNS.index(name), 3] = [m_from_mm(value) for value in rows[:, column].tolist()]
    for n, given in enumerate(rows[:, first:].tolist()):
        poses[n, :3, :3] = table.rotation(axes[n], given)
    depends = table.orientation.source not in {"quaternion", "none"}
    return Recording(axes, poses, table.compared, str(path), table.form if depends else None)


class _RecordingTable(Table):
    """A recording while it is read."""

    def __init__(self, path: Path | str, chain: Chain) -> None:
        self._chain = chain
        # Everything recorded is compared, whatever inverse kinematics can solve for.
        self.form = PoseForm.of(chain, "direction")
        super().__init__(path, self._choose, chain.axes)
        self.place_columns = self.form.position(self.names)
        self.orientation = self._orientation(self.names)

    def _orientation(self, names: Sequence[str]) -> PoseColumns:
        """Return which columns hold the orientation; those of axes are there as axes."""
        found = set(names) - {axis.name for axis in self._chain.axes}
        follow = self.form.shows_angles and found & set(ANGLE_COLUMNS) - set(self.form.columns)
        groups: tuple[tuple[OrientationSource, tuple[str, ...]], ...] = (
            ("quaternion", QUATERNION_COLUMNS),
            ("angles", ANGLE_COLUMNS if follow else ()),
            ("shown", self.form.columns),
            ("tool", TOOL_COLUMNS),
        )
        return next((PoseColumns(*group) for group in groups if found & set(group[1])), PoseColumns("none", ()))

    def _choose(self, names: Sequence[str]) -> Choice:
        axes = tuple(axis.name for axis in self._chain.axes)
        permitted = (*axes, *self.form.permitted(), *RESULT_COLUMNS, VIOLATIONS_COLUMN)
        return (*axes, *self.form.position(names), *self._orientation(names).columns), tuple(dict.fromkeys(permitted))

    def _hint(self, name: str) -> str | None:
        return self.form.programmed_by() if self.form.display.rtcp or name in ANGLE_COLUMNS else None

    @property
    def compared(self) -> Task:
        """What of the poses is there."""
        source, _ = self.orientation
        if source == "none":
            return "position"
        by_vector = source == "tool" or (source == "shown" and self.form.display.kind in {"direction", "vector"})
        return "direction" if by_vector else "pose"

    def rotation(self, axes: Vector, given: Sequence[float]) -> Matrix:
        """Return the rotation of a row: of a direction one that has it; angles that follow are those of the model."""
        unit = self.orientation.columns in {QUATERNION_COLUMNS, TOOL_COLUMNS}
        if unit and not math.hypot(*given) > 0.0:
            text = f"({', '.join(self.orientation.columns)}) is zero"
            raise TableError(text, span=Span(self.file), permitted="length 1")
        found = None if self._in_part else self.form.rotation(self.orientation, given)
        return self._completed(axes, given) if found is None else found

    @property
    def _in_part(self) -> bool:
        return self.orientation.source == "shown" and self.form.display.kind == "angles"

    def _completed(self, axes: Vector, given: Sequence[float]) -> Matrix:
        """Return the rotation of displayed columns that describe one only together with what follows from the axes."""
        display = self.form.display
        if display.kind == "axes":  # what is displayed are values of axes
            shown = axes.copy()
            shown[list(display.axes)] = given
            R: Matrix = pose(self._chain, shown)[:3, :3]
            return R
        if display.kind == "pitch":
            return raised_and_turned(self._chain, axes, *given)
        ours = pose(self._chain, axes)[:3, :3]
        if display.kind == "plane":
            turned: Matrix = frames.rot_z(given[0] - plane_angle(display, ours)) @ ours
            return turned
        mode = self._chain.angle_mode
        own = dict(zip(ANGLE_COLUMNS, frames.angles_from_matrix(mode, ours), strict=True))
        angles = own | dict(zip(self.orientation.columns, given, strict=True))
        return frames.matrix_from_angles(mode, [angles[name] for name in ANGLE_COLUMNS])
