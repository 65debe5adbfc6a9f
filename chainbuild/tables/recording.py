"""Tables recorded on the controller: axis values and the poses it showed for them, row by row."""

from __future__ import annotations

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
from chainbuild.tables.reader import Choice, Table, canonical_columns
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
    _rows: _Rows | None = field(default=None, repr=False)  # what was read, where its meaning depends on the chain

    def read_for(self, chain: Chain, *, rows: NDArray[np.int_] | None = None) -> NDArray[np.float64]:
        """Return the poses (n, 4, 4) as another chain of the same machine, with other conventions or data, means them.

        Args:
            chain: The chain.
            rows: (n,) indices of rows; None: all.

        Raises:
            ChainbuildError: its poses have other columns.
        """
        read, chosen = self._rows, np.arange(len(self.poses)) if rows is None else rows
        if read is None or len(read.lines) != len(self.poses):  # made of arrays, maybe of some rows of a file
            return self.poses[chosen]
        same = read.form.whole and _form(chain) == read.form
        return self.poses[chosen] if same else read.poses(chain, chosen)


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
        chunks = list(table.chunks())
    if not chunks:
        raise TableError("the recording has no rows", span=Span(str(path)))
    lines = tuple(line for chunk in chunks for line in chunk.lines)
    read = _Rows(str(path), table.read, lines, np.vstack([chunk.values for chunk in chunks]), table.form)
    meaning, every = _Meaning(chain, table.names), np.arange(len(lines))
    depends = meaning.orientation.source not in {"quaternion", "none"}
    axes = read.values[:, : len(chain.axes)].copy()
    return Recording(axes, read.poses(chain, every), meaning.compared, str(path), read if depends else None)


class _RecordingTable(Table):
    """A recording while it is read."""

    def __init__(self, path: Path | str, chain: Chain) -> None:
        self._chain = chain
        self.form = _form(chain)
        super().__init__(path, self._choose, chain.axes)

    @property
    def read(self) -> tuple[str, ...]:
        """The columns that are read, as the header has them."""
        return tuple(self.written[self.names.index(name)] for name in (*self.wanted, *self.beside))

    def _choose(self, names: Sequence[str]) -> Choice:
        permitted = (*(axis.name for axis in self._chain.axes), *self.form.permitted(), *RESULT_COLUMNS)
        return _Meaning(self._chain, names).columns, (*dict.fromkeys(permitted), VIOLATIONS_COLUMN)

    def _beside_columns(self) -> tuple[str, ...]:
        # A chain with other conventions may be programmed by them.
        permitted = {*self.form.permitted()} - {*self.wanted}
        return tuple(name for name in self.names if name in permitted)

    def _hint(self, name: str) -> str | None:
        return self.form.hint(name)


@dataclass(frozen=True, slots=True, eq=False)
class _Rows:
    """The numbers of a recording, which chains of different conventions and data take for different poses.

    Attributes:
        file: Its name.
        written: Names of the columns as the header has them.
        lines: (n,) line numbers.
        values: (n, columns) mm, degrees and unit vectors; NaN where there is no number.
        form: How the chain that they were first read for writes poses.
    """

    file: str
    written: tuple[str, ...]
    lines: tuple[int, ...]
    values: NDArray[np.float64]
    form: PoseForm

    def poses(self, chain: Chain, rows: NDArray[np.int_]) -> NDArray[np.float64]:
        """Return the poses (n, 4, 4) of some rows as a chain means them [m]."""
        names = canonical_columns(self.written, chain.axes, self._fault)
        meaning = _Meaning(chain, names)
        wrong = {*meaning.columns} - {*names} | {*names} - {*meaning.columns, *meaning.form.permitted()}
        if wrong:
            raise TableError(f"missing or unknown column {min(wrong)}", span=Span(self.file))
        count, first = len(chain.axes), len(chain.axes) + len(meaning.place)
        places = [POSITION_COLUMNS.index(name) for name in meaning.place]
        values = self.values[rows][:, [names.index(name) for name in meaning.columns]]
        poses = np.tile(np.eye(4), (len(rows), 1, 1))
        for n, (row, line) in enumerate(zip(values, rows.tolist(), strict=True)):
            given = row[first:].tolist()
            fault = meaning.form.length_fault(meaning.orientation, given)
            if fault or not np.isfinite(row).all():
                text, permitted = fault or ("a column holds no number", None)
                raise TableError(text, span=Span(self.file, self.lines[line]), permitted=permitted)
            poses[n, places, 3] = [m_from_mm(value) for value in row[count:first].tolist()]
            poses[n, :3, :3] = meaning.rotation(row[:count], given)
        return poses

    def _fault(self, place: int, text: str, permitted: str) -> TableError:
        return TableError(text, span=Span(self.file), parameter=self.written[place], permitted=permitted)


def _form(chain: Chain) -> PoseForm:
    # Everything recorded is compared, whatever inverse kinematics can solve for.
    return PoseForm.of(chain, "direction")


class _Meaning:
    """Which columns of a recording give its poses for a chain, and which poses they are."""

    def __init__(self, chain: Chain, names: Sequence[str]) -> None:
        self._chain = chain
        self.form = _form(chain)
        self.place = self.form.position(names)
        self.orientation = self._orientation(names)
        self.columns = (*(axis.name for axis in chain.axes), *self.place, *self.orientation.columns)

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
