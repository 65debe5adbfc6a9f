"""Tables of poses: the tool in the workpiece frame as the controller displays and takes it, with full orientations."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TextIO

import numpy as np

from chainbuild import frames, tolerances
from chainbuild.arrays import Matrix
from chainbuild.chain.programmed.display import (
    ANGLE_COLUMNS,
    POSITION_COLUMNS,
    QUATERNION_COLUMNS,
    STATUS_COLUMNS,
    TOOL_COLUMNS,
)
from chainbuild.chain.programmed.status import parse_status, parse_turn
from chainbuild.chain.programmed.vectors import VECTOR_COLUMNS, kept_angle, rotation_from_vector
from chainbuild.errors import ChainbuildError, Span
from chainbuild.tables.axes import DECIMALS, UNIT_DECIMALS, VIOLATIONS_COLUMN, names_field, number_field
from chainbuild.tables.form import C_COLUMN, UNIT_COLUMNS, PoseForm
from chainbuild.tables.reader import Choice, Table
from chainbuild.units import m_from_mm, mm_from_m, rad_from_deg

_NOT_GIVEN: Final = "-1"  # a status or turn that a row leaves out: its bits are no negative number


@dataclass(frozen=True, slots=True, eq=False)
class PoseRow:
    """One pose of a table.

    Attributes:
        line: Line number, from 1.
        T: (4, 4) tool in the workpiece frame [m]; its rotation counts only where `shown` is None.
        shown: Values of the displayed columns where they describe no rotation without the kinematic.
        c_deg: The angle C where it runs on over whole turns and the table gives it, else None.
        held: Input axis → value, for the columns that the table has.
        status: Pose status, where the table gives it.
        turn: Turn, where the table gives it.
        contradictory: True where A, B, C beside the quaternion are those of another orientation.
        beside: (3, 3) a full orientation beside displayed columns, which count; else None.
    """

    line: int
    T: Matrix
    shown: tuple[float, ...] | None = None
    c_deg: float | None = None
    held: Mapping[str, float] | None = None
    status: int | None = None
    turn: int | None = None
    contradictory: bool = False
    beside: Matrix | None = None


_AXIS_VALUES: Final = "this is a table of axis values: --axes reads it (fk, collide, singularity, picture, inspect)"


class PoseTable(Table):
    """A table of poses.

    x_mm, y_mm, z_mm and the columns that the controller displays (`PoseForm.columns`) are read, or a full orientation.
    On RTCP kinematics displayed columns win over a quaternion, on complete ones a quaternion wins. A machine whose task
    is "direction" also takes the tool vector alone, one whose task is "position" needs none. Where C continues over
    whole turns, c_deg is also read beside a quaternion. Input axes may have columns of their own. Column `violations`,
    which `PoseWriter` adds, is permitted and not read; any other is refused.

    Args:
        path: The file.
        form: How the poses are written.

    Attributes:
        form: The form.
        orientation: Which columns give the orientation.
        held: Those of the input axes that have a column.
        oriented: False where the table gives no orientation.
        by_quaternion: True where it gives quaternions.

    Raises:
        FileAccessError: the file cannot be read.
        TableError: the header is missing, or names a column that is unknown or duplicate, or is incomplete.
    """

    def __init__(self, path: Path, form: PoseForm) -> None:
        self.form = form
        super().__init__(path, self._choose, form.axes)
        self.orientation = form.orientation(self.names)
        source, columns = self.orientation
        self.oriented = bool(columns)
        self.by_quaternion = source == "quaternion"
        first = len(form.position(self.names))
        self._place = {name: n for n, name in enumerate(self.wanted)}
        self._orientation = slice(first, first + len(columns))
        self.held = tuple(name for name in form.held if name in self.names)
        self._before, self._kept = np.eye(3), 0.0
        parsers = zip(STATUS_COLUMNS, (parse_status, parse_turn), strict=True) if form.status else ()
        self._bits = [(self.names.index(name), parse) for name, parse in parsers if name in self.names]

    def begin(self, rotation: Matrix) -> None:
        """Take the orientation (3, 3) that vector programming starts from; without it all angles are 0."""
        if self.form.vectors is not None:
            self._before, self._kept = rotation, kept_angle(self.form.vectors, self.form.angle_mode, rotation)

    def _choose(self, names: Sequence[str]) -> Choice:
        form = self.form
        columns = form.orientation(names).columns
        beside = (C_COLUMN,) if form.running_c and C_COLUMN in names and C_COLUMN not in columns else ()
        more = (name for name in (*STATUS_COLUMNS, *form.held) if name in names and name in form.permitted())
        wanted = (*form.position(names), *columns, *beside, *more)
        return wanted, (*self._permitted(names), VIOLATIONS_COLUMN)

    def _permitted(self, names: Sequence[str]) -> tuple[str, ...]:
        permitted = self.form.permitted()
        # What `fk --angles` adds where no angles are displayed may stand beside the columns that count; it is not read.
        aside = not self.form.shows_angles and (not self.form.columns or set(self.form.columns) & set(names))
        return (*permitted, *(name for name in ANGLE_COLUMNS if aside and name not in permitted))

    @property
    def unused(self) -> tuple[str, ...]:
        """Columns of another orientation that are neither used nor compared."""
        others = {*ANGLE_COLUMNS, *QUATERNION_COLUMNS, *VECTOR_COLUMNS} - {*self.wanted, *self.beside}
        return tuple(name for name in self.names if name in others)

    def _shown_columns(self, permitted: Sequence[str]) -> Sequence[str]:
        return self.form.permitted()

    def _hint(self, name: str) -> str | None:
        axes = {axis.name for axis in self.form.axes}
        other = (
            _AXIS_VALUES if axes and axes <= set(self.names) and not set(POSITION_COLUMNS) & set(self.names) else None
        )
        return self.form.hint(name) or other

    def _beside_columns(self) -> tuple[str, ...]:
        # Read for comparison only. Where C runs on over whole turns c_deg is an input of its own.
        names, source = set(self.names), self.form.orientation(self.names).source
        if self.form.display.rtcp:
            given = next((group for group in (QUATERNION_COLUMNS, TOOL_COLUMNS) if names >= set(group)), ())
            return given if source == "shown" and self.form.columns else ()
        angles = self.form.columns if self.form.shows_angles else ()
        angles = ANGLE_COLUMNS if angles and names >= set(ANGLE_COLUMNS) else angles
        return angles if source == "quaternion" and angles and names >= set(angles) and not self.form.running_c else ()

    def _alternatives(self, missing: Sequence[str]) -> str:
        """Return the other orientations that this machine takes, where the table gives none at all."""
        groups = self.form.groups()
        if set(self.names) & {name for group in groups for name in group}:
            return ""
        return "".join(f", or {', '.join(group)}" for group in groups if not set(group) & set(missing))

    def rows(self) -> Iterator[PoseRow]:
        """Read the poses that are left.

        Raises:
            TableError: a row holds no pose.
        """
        position = [self._place.get(name) for name in POSITION_COLUMNS]
        for chunk in self.chunks():
            for line, values in zip(chunk.lines, chunk.values.tolist(), strict=True):
                place = [0.0 if n is None else m_from_mm(values[n]) for n in position]
                yield self._row_of(line, place, values)

    def _row_of(self, line: int, place: Sequence[float], values: list[float]) -> PoseRow:
        given, beside = tuple(values[self._orientation]), values[len(self.wanted) :]
        self._check_vector(line, given)
        rotation = self._rotation(line, given)
        T = frames.transform(rotation, place)
        status, turn = (self._whole(name, values) for name in STATUS_COLUMNS)
        return PoseRow(
            line,
            T,
            shown=given if rotation is None else None,
            c_deg=values[self._place[C_COLUMN]] if self.form.running_c and C_COLUMN in self._place else None,
            held={name: values[self._place[name]] for name in self.held} if self.held else None,
            status=status,
            turn=turn,
            contradictory=rotation is not None and self._contradicts(rotation, beside),
            beside=self._orientation_beside(beside) if rotation is None else None,
        )

    def _rotation(self, line: int, given: Sequence[float]) -> Matrix | None:
        """Return the rotation of a row; that of a vector follows on the row before."""
        if self.orientation.source != "vector":
            return self.form.rotation(self.orientation, given)
        assert self.form.vectors is not None  # else there are no such columns
        try:
            R = rotation_from_vector(self.form.vectors, self.form.angle_mode, given, self._before, kept_deg=self._kept)
        except ChainbuildError as error:
            error.span = error.span or Span(self.file, line)
            raise
        self._before = R
        return R

    def _translated(self, number: int, fields: list[str]) -> list[str]:
        """Write status and turn, which may be binary or missing, as numbers."""
        if not self._bits:
            return fields
        translated = list(fields)
        for place, parse in self._bits:
            try:
                bits = parse(fields[place])
            except ChainbuildError as error:
                error.span = Span(self.file, number)
                raise
            translated[place] = _NOT_GIVEN if bits is None else str(bits)
        return translated

    def _whole(self, name: str, values: Sequence[float]) -> int | None:
        value = values[self._place[name]] if name in self._place else float(_NOT_GIVEN)
        return None if value == float(_NOT_GIVEN) else int(value)

    def _contradicts(self, rotation: Matrix, beside: Sequence[float]) -> bool:
        """Return whether the displayed angles are given and are those of another rotation than the quaternion."""
        if not beside or not all(abs(angle) < tolerances.HUGE_AXIS_VALUE for angle in beside):
            return False
        own = dict(zip(ANGLE_COLUMNS, frames.angles_from_matrix(self.form.angle_mode, rotation), strict=True))
        given = own | dict(zip(self.beside, beside, strict=True))
        difference = rotation - frames.matrix_from_angles(self.form.angle_mode, [given[n] for n in ANGLE_COLUMNS])
        # A rotation by a small angle differs from 1 by the angle times the square root of 2.
        return float(np.linalg.norm(difference)) > math.sqrt(2.0) * rad_from_deg(
            tolerances.ANGLES_BESIDE_QUATERNION_DEG
        )

    def _orientation_beside(self, beside: Sequence[float]) -> Matrix | None:
        """Return the orientation that stands beside displayed columns, for comparison; None where there is none."""
        if not beside or not 0.0 < sum(abs(value) for value in beside) < tolerances.HUGE_AXIS_VALUE:
            return None
        if len(beside) == len(QUATERNION_COLUMNS):
            return frames.matrix_from_quaternion(beside)
        return self.form.rotation(self.orientation._replace(source="tool"), beside)

    def _check_vector(self, line: int, values: Sequence[float]) -> None:
        if fault := self.form.length_fault(self.orientation, values):
            raise self.error_at(line, *fault)


class PoseWriter:
    """Writes poses: position, full orientation (qw ≥ 0), tool vector and what the controller displays.

    Args:
        stream: Where to.
        form: How the poses are written.
        quaternion: True: with the quaternion in any case.
        angles: Name in `frames.ANGLE_MODES` of angles A, B, C that are written in addition; None: none.
        more: Names of further columns behind the pose, such as input axes and drives.
        violations: True: one more column names the limits that are violated.
        drives: Names of the columns of drive values, behind all others.
    """

    def __init__(
        self,
        stream: TextIO,
        form: PoseForm,
        *,
        quaternion: bool = False,
        angles: str | None = None,
        more: Sequence[str] = (),
        violations: bool = False,
        drives: Sequence[str] = (),
    ) -> None:
        self._stream, self._form, self._angles, self._violations = stream, form, angles, violations
        names = [name for name in form.full if name not in form.columns]
        names = [*(QUATERNION_COLUMNS if quaternion and not set(names) & set(QUATERNION_COLUMNS) else ()), *names]
        shown = [*form.columns, *(name for name in ANGLE_COLUMNS if angles and name not in form.columns)]
        self._columns = (*POSITION_COLUMNS, *names, *(sorted(shown) if form.shows_angles else shown))
        self._status = STATUS_COLUMNS if form.status else ()
        last = (VIOLATIONS_COLUMN,) if violations else ()
        stream.write(",".join((*self._columns, *self._status, *more, *last, *drives)) + "\n")

    def write(
        self,
        T: Matrix,
        shown: Mapping[str, float] | None = None,
        more: Sequence[float] = (),
        status: Sequence[int] = (),
        violated: Sequence[str] = (),
        drives: Sequence[float] = (),
    ) -> None:
        """Write one pose.

        Args:
            T: (4, 4) tool in the workpiece frame [m].
            shown: Displayed column → value; angles that are not among them are those of the pose.
            more: Values of the further columns, mm and degrees.
            status: Pose status and turn.
            violated: Names of the limits that are violated.
            drives: Values of the drives, mm and degrees.
        """
        values = self._values(T) | dict(shown or {})
        fields = [self._field(name, values[name]) for name in self._columns]
        fields += [*map(str, status), *map(number_field, more)]
        last = [names_field(violated)] if self._violations else []
        self._stream.write(",".join([*fields, *last, *(number_field(value) for value in drives)]) + "\n")

    def _values(self, T: Matrix) -> dict[str, float]:
        """Return what a pose alone determines, by column."""
        R, names = T[:3, :3], set(self._columns)
        values = dict(zip(POSITION_COLUMNS, map(mm_from_m, T[:3, 3].tolist()), strict=True))
        if names >= set(QUATERNION_COLUMNS):
            values |= zip(QUATERNION_COLUMNS, frames.quaternion_from_matrix(R), strict=True)
        values |= zip(TOOL_COLUMNS, R[:, 0 if self._form.tool_axis == "x" else 2].tolist(), strict=True)
        if names & set(ANGLE_COLUMNS):
            mode = self._angles or self._form.angle_mode
            values |= zip(ANGLE_COLUMNS, frames.angles_from_matrix(mode, R), strict=True)
        return values

    def _field(self, name: str, value: float) -> str:
        if name in UNIT_COLUMNS:
            return number_field(value, UNIT_DECIMALS)
        # Rounding may give -180, which is outside (-180, 180].
        is_axis = self._form.display.kind == "axes" and name in self._form.columns
        at_end = name in ANGLE_COLUMNS and not is_axis and not self._form.running_c
        return number_field(180.0 if at_end and round(value, DECIMALS) == -180.0 else value)
