"""Axis values for what the controller displays: position, and the columns of `Chain.display`.

Where they describe a full orientation, the pose is solved as any other. Else only what is programmed is solved for:
the linear axes of RTCP kinematics, the axes that a position determines, angles that others follow.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild import frames, tolerances
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.elements import Task
from chainbuild.chain.programmed.display import ANGLE_COLUMNS, POSITION_COLUMNS, QUATERNION_COLUMNS, STATUS_COLUMNS
from chainbuild.chain.programmed.status import parse_status, parse_turn
from chainbuild.chain.programmed.vectors import rotation_from_vector
from chainbuild.errors import AxisValueError, ChainbuildError, TableError
from chainbuild.ik.branches.every import ik_all
from chainbuild.ik.policies.four_axis import PitchAndTurn, PoseAngles, with_reachable_orientation
from chainbuild.ik.request import Held, IkOptions, IkRequest, held_by_name, start_point
from chainbuild.ik.result import IkResult
from chainbuild.ik.rtcp import linear_axes, linear_axes_batch
from chainbuild.ik.search.batch import solve_batch
from chainbuild.ik.search.table import IkTable, table_of
from chainbuild.ik.solve import solve
from chainbuild.kinematics.displayed import plane_angle, vector_of_angles
from chainbuild.kinematics.inputs import real_numbers
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.tables.form import C_COLUMN, PoseColumns, PoseForm
from chainbuild.tables.reader import canonical_columns
from chainbuild.units import M_PER_MM, m_from_mm

_ABOUT_Z: Final = 5  # row of a Jacobian in the workpiece frame: the angular velocity about z


def from_display(
    mechanism: Mechanism, shown: Mapping[str, float], start: ArrayLike | None = None, held: Held | None = None
) -> IkResult:
    """Return axis values for what the controller displays; see `Robot.from_display`."""
    asked = _Asked.of(mechanism, shown)
    values = {name: asked.number(name) for name in asked.shown}
    place = [m_from_mm(values.get(name, 0.0)) for name in POSITION_COLUMNS]
    given = [values[name] for name in asked.orientation.columns]
    asked.check_length(given)
    own = {name: values[name] for name in asked.form.held if name in values}
    inputs = {**held_by_name(mechanism, held), **own} if own else held
    if asked.orientation.source == "vector" and asked.form.vectors is not None:
        before = np.eye(3) if start is None else mechanism.fk(start).rotation
        R: Matrix | None = rotation_from_vector(asked.form.vectors, asked.form.angle_mode, given, before)
    else:
        R = asked.form.rotation(asked.orientation, given)
    if R is None:
        return solve_displayed(mechanism, place, given, start, inputs)
    running = values.get(C_COLUMN) if asked.form.running_c else None
    bits = (_bits(values.get("is")), _bits(values.get("it")))
    return solve(mechanism, frames.transform(R, place), start, inputs, absolute_c_deg=running, status_turn=bits)


def _fault(_place: int, text: str, permitted: str) -> TableError:
    """Return the error of a column whose name is wrong."""
    return TableError(text, parameter="shown", permitted=permitted)


def _bits(value: float | None) -> int | None:
    """Return status or turn as an integer; what is no whole number is refused as such where it is used."""
    if value is None or math.isnan(value):
        return None
    return int(value) if value == int(value) else value  # type: ignore[return-value]


def from_display_batch(
    mechanism: Mechanism, shown: Mapping[str, ArrayLike], start: ArrayLike | None = None, *, compiled: bool = True
) -> IkTable:
    """Return axis values for many displayed poses; see `Robot.from_display_batch`."""
    asked = _Asked.of(mechanism, shown)
    given = [np.atleast_1d(asked.column(name)) for name in asked.shown]
    counts = {len(values) for values in given} - {1}
    if len(counts) > 1 or any(values.ndim > 1 for values in given):
        listed = ", ".join(str(values.shape) for values in given)
        raise ChainbuildError(f"the columns have the lengths {listed}", parameter="shown", permitted="one length, or 1")
    columns = dict(zip(asked.shown, np.broadcast_arrays(*given), strict=True))
    display, count = mechanism.chain.display, len(next(iter(columns.values())))
    if asked.orientation.source == "shown" and mechanism.chain.solves_linear_axes:
        begin = np.zeros(len(mechanism.axes)) if start is None else mechanism.axis_values(start)
        axes = np.tile(begin, (count, 1))
        for n, name in zip(display.axes, asked.orientation.columns, strict=True):
            axes[:, n] = columns[name]
        for name in asked.form.held:
            axes[:, mechanism.labels.names.index(name)] = columns.get(name, 0.0)
        places = np.column_stack([columns[name] for name in POSITION_COLUMNS]) * M_PER_MM
        return linear_axes_batch(mechanism, places, axes, compiled=compiled)
    if (poses := asked.poses(columns)) is not None and not mechanism.chain.display.keeps_side:
        return solve_batch(mechanism, poses, start, options=IkOptions(compiled=compiled))
    return _row_by_row(mechanism, columns, start)


def _row_by_row(mechanism: Mechanism, columns: Mapping[str, Vector], start: ArrayLike | None) -> IkTable:
    """Solve row by row; without a start from the row before, except where the side of a start would be kept."""
    begin, found = start, list[IkResult]()
    for values in zip(*(column.tolist() for column in columns.values()), strict=True):
        found.append(from_display(mechanism, dict(zip(columns, values, strict=True)), begin))
        if start is None and found[-1].success and not mechanism.chain.display.keeps_side:
            begin = found[-1].axes
    return table_of(found, mechanism.task, mechanism.labels)


class _Asked(NamedTuple):
    """Displayed values by column, looked through: what gives the orientation."""

    form: PoseForm
    orientation: PoseColumns
    shown: Mapping[str, ArrayLike]

    @classmethod
    def of(cls, mechanism: Mechanism, shown: Mapping[str, ArrayLike]) -> _Asked:
        """Return the values of a mechanism's columns.

        Raises:
            ChainbuildError: a column is missing or unknown.
        """
        form = PoseForm.of(mechanism.chain, mechanism.task)
        if not isinstance(shown, Mapping):
            raise ChainbuildError("displayed values must be a mapping of column to value", parameter="shown")
        names = canonical_columns([str(name) for name in shown], mechanism.axes, _fault)
        shown = dict(zip(names, shown.values(), strict=True))
        orientation = form.orientation(shown)
        wanted, permitted = (*form.position(shown), *orientation.columns), form.permitted()
        for name in [*(name for name in shown if name not in permitted), *(n for n in wanted if n not in shown)]:
            what = "unknown" if name in shown else "missing"
            text, hint = f"{what} column {name!r:.60}", form.programmed_by()
            raise ChainbuildError(text, parameter="shown", permitted=", ".join(permitted), hint=hint)
        return cls(form, orientation, shown)

    def poses(self, columns: Mapping[str, Vector]) -> NDArray[np.float64] | None:
        """Return the poses (N, 4, 4) that N rows describe by themselves, None where more than a pose is programmed."""
        more = {*STATUS_COLUMNS, *self.form.held, *((C_COLUMN,) if self.form.running_c else ())}
        partial = self.form.task == "pose" and self.orientation.columns not in {ANGLE_COLUMNS, QUATERNION_COLUMNS}
        if partial or self.orientation.source == "vector" or more & set(columns):
            return None
        place = np.column_stack([columns[name] for name in POSITION_COLUMNS if name in columns]) * M_PER_MM
        given = zip(*(columns[name].tolist() for name in self.orientation.columns), strict=True)
        rotations = list[Matrix]()
        for values in given if self.orientation.columns else [()] * len(place):
            self.check_length(values)
            rotation = self.form.rotation(self.orientation, values)
            if rotation is None or place.shape[1] != len(POSITION_COLUMNS):
                return None
            rotations.append(rotation)
        poses = np.tile(np.eye(4), (len(place), 1, 1))
        poses[:, :3, :3], poses[:, :3, 3] = rotations, place
        return poses

    def check_length(self, given: Sequence[float]) -> None:
        """Refuse the zero vector and a quaternion or tool vector whose length is not 1.

        Raises:
            ChainbuildError: it is one.
        """
        if fault := self.form.length_fault(self.orientation, given):
            raise ChainbuildError(fault[0], parameter="shown", permitted=fault[1])

    def number(self, name: str) -> float:
        """Return a column as one finite number; status and turn also from a text, as in tables.

        Raises:
            ChainbuildError: it holds anything else.
        """
        given = self.shown[name]
        if name in STATUS_COLUMNS and isinstance(given, str):
            bits = parse_status(given) if name == "is" else parse_turn(given)
            return math.nan if bits is None else float(bits)
        values = self.column(name)
        if values.ndim:
            raise ChainbuildError(f"{name} has the shape {values.shape}", parameter=name, permitted="one number")
        return float(values)

    def column(self, name: str) -> Vector:
        """Return a column as an array of finite numbers.

        Raises:
            ChainbuildError: it holds anything else.
        """
        values = real_numbers(self.shown[name])
        if values is None or not (np.abs(values) < tolerances.HUGE_AXIS_VALUE).all():
            permitted = f"finite numbers below {tolerances.HUGE_AXIS_VALUE:.0e}"
            raise ChainbuildError(f"{name} is {self.shown[name]!r:.60}", parameter=name, permitted=permitted)
        return values


def solve_displayed(
    mechanism: Mechanism,
    position: Sequence[float] | Vector,
    shown: Sequence[float],
    start: ArrayLike | None = None,
    held: Held | None = None,
    solver: str = "auto",
) -> IkResult:
    """Return axis values for a position and the displayed columns beside it.

    Args:
        mechanism: The mechanism.
        position: (3,) tool tip in the workpiece frame [m].
        shown: Values of `Chain.display_columns`, mm and degrees.
        start: Axis values (n_axes,) to start from; the side of the start is kept where the control keeps it.
        held: As for `Robot.ik`.
        solver: As for `Robot.ik`.
    """
    display = mechanism.chain.display
    if display.kind == "axes":
        given = {mechanism.axes[n].name: value for n, value in zip(display.axes, shown, strict=True)}
        return _by_axes(mechanism, np.asarray(position), given, start, held, solver)
    if display.kind in {"angles", "pitch"}:
        return _by_angles(mechanism, position, shown, start, held, solver)
    if display.kind == "position":
        return _on_side(as_task(mechanism, "position"), frames.transform(None, position), start, held, solver)
    if display.kind == "plane":
        T = frames.transform(_turned_about_z(mechanism, shown[0]), position)
        return _on_side(mechanism, T, start, held, solver)
    tool = np.array(shown) if display.kind == "vector" else vector_of_angles(display, shown)
    aimed = as_task(mechanism, "direction")
    return solve(aimed, frames.transform(_with_tool(tool, mechanism.chain.tool_column), position), start, held, solver)


def as_task(mechanism: Mechanism, task: Task) -> Mechanism:
    """Return the mechanism with another task of inverse kinematics."""
    if mechanism.task == task:
        return mechanism
    return mechanism.prepared("task", lambda: Mechanism(replace(mechanism.chain, task=task)), task)


def _by_axes(
    mechanism: Mechanism,
    position: Vector,
    given: Mapping[str, float],
    start: ArrayLike | None,
    held: Held | None,
    solver: str,
) -> IkResult:
    """Return the axes that are solved for while those that are displayed have the values given."""
    begin = np.zeros(len(mechanism.axes)) if start is None else start
    axes = start_point(mechanism, begin, held)[0] / mechanism.kinematics.si_factors
    for name, value in given.items():
        axes[mechanism.labels.names.index(name)] = value
    kept = held_by_name(mechanism, held)
    for name in kept:
        if name in given and kept[name] != given[name]:
            text = f"axis {name} is held at {kept[name]:.10g} and programmed at {given[name]:.10g}"
            raise AxisValueError(text, parameter="held", permitted="one of the two")
    solved = {mechanism.axes[n].name for n in mechanism.chain.display.solved}
    if mechanism.chain.solves_linear_axes and not solved & set(kept):
        return linear_axes(mechanism, position, mechanism.axis_values(axes))
    T = frames.transform(None, position)
    return _on_side(as_task(mechanism, "position"), T, start, {**kept, **given}, solver)


def _by_angles(
    mechanism: Mechanism,
    position: Sequence[float] | Vector,
    shown: Sequence[float],
    start: ArrayLike | None,
    held: Held | None,
    solver: str,
) -> IkResult:
    """Return the axes for pose angles; those without a column follow from the position, or are 0 where they cannot."""
    chain = mechanism.chain
    wanted = {column[0].upper(): value for column, value in zip(chain.display.columns, shown, strict=True)}
    R = frames.matrix_from_angles(chain.angle_mode, [wanted.get(letter, 0.0) for letter in "ABC"])
    T = frames.transform(R, position)
    request = IkRequest.of(mechanism, T, start, held)

    def whole(asked: IkRequest) -> IkResult:
        return solve(mechanism, asked.target, asked.start, asked.held, solver)

    angles = PoseAngles(chain.angle_mode, wanted)
    found = with_reachable_orientation(
        request, PitchAndTurn(mechanism, *shown) if chain.display.kind == "pitch" else angles, whole
    )
    return solve(mechanism, T, start, held, solver) if found is None else found[1]


def _turned_about_z(mechanism: Mechanism, angle_deg: float) -> Matrix:
    """Return the orientation with an angle in the XY plane, for a tool that turns about Z only."""
    R = mechanism.fk(np.zeros(len(mechanism.axes))).rotation
    turned: Matrix = frames.rot_z(angle_deg - plane_angle(mechanism.chain.display, R)) @ R
    return turned


def _with_tool(tool: Vector, column: int) -> Matrix:
    """Return a rotation one of whose columns, x or z, is a direction."""
    direction = frames.unit(tool)
    aside = frames.unit(np.cross(np.eye(3)[int(np.argmin(np.abs(direction)))], direction))
    third = np.cross(direction, aside)
    return np.column_stack((direction, aside, third) if column == 0 else (aside, third, direction))


def _on_side(mechanism: Mechanism, T: Matrix, start: ArrayLike | None, held: Held | None, solver: str) -> IkResult:
    """Return the answer for a pose, on the side of the start where the control keeps the side."""
    found = solve(mechanism, T, start, held, solver)
    if start is None or not mechanism.chain.display.keeps_side:
        return found
    side = side_of(mechanism, mechanism.axis_values(start))
    if not side or (found.success and side_of(mechanism, found.axes) == side):
        return found
    for branch in ik_all(mechanism, T, start, held):
        if side_of(mechanism, branch.axes) == side:
            return branch
    if not found.success:
        return found
    reason = "reached only on the other side of the singular position, and the control keeps the side it is on"
    return replace(found, success=False, status="unreachable", reason=reason)


def side_of(mechanism: Mechanism, axes: Vector) -> int:
    """Return on which side of its singular position a mechanism stands: +1, -1, or 0 on it.

    It is the sign of the determinant of what the programmed values change by the axes that are solved for: the sign of
    X of a face, the hand of a SCARA, the side of a lever.
    """
    display = mechanism.chain.display
    rows = [0, 2] if display.plane_xz else [0, 1, 2]
    rows += [_ABOUT_Z] if display.kind == "plane" else []
    solved = display.solved or tuple(range(len(mechanism.axes)))
    J = mechanism.jacobian(axes, "workpiece")[np.ix_(rows, solved)]
    return int(np.sign(np.linalg.det(J))) if J.shape[0] == J.shape[1] else 0
