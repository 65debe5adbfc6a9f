"""How the poses of a kinematic are written: which columns hold them, and which of several orientations counts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final, Literal, NamedTuple

import numpy as np

from chainbuild import frames, tolerances
from chainbuild.arrays import Matrix
from chainbuild.chain.elements import Axis, Chain, Task
from chainbuild.chain.names import axis_index
from chainbuild.chain.programmed.display import (
    ANGLE_COLUMNS,
    POSE_ANGLES,
    POSITION_COLUMNS,
    QUATERNION_COLUMNS,
    STATUS_COLUMNS,
    TOOL_COLUMNS,
    Display,
)
from chainbuild.chain.programmed.vectors import VECTOR_COLUMNS, VectorProgramming
from chainbuild.kinematics.displayed import vector_of_angles
from chainbuild.shown import fields_shown
from chainbuild.units import deg_from_rad

C_COLUMN: Final = "c_deg"
UNIT_COLUMNS: Final = frozenset((*QUATERNION_COLUMNS, *TOOL_COLUMNS, *VECTOR_COLUMNS))

OrientationSource = Literal["shown", "angles", "quaternion", "tool", "vector", "none"]


class PoseColumns(NamedTuple):
    """Which columns give the orientation.

    Attributes:
        source: "shown": those that the controller displays; "angles": A, B and C; "quaternion"; "tool": the tool
            vector; "vector": that of vector programming (#ORI MODE); "none": the task needs none.
        columns: Their names in order.
    """

    source: OrientationSource
    columns: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PoseForm:
    """How the poses of a mechanism are written.

    Attributes:
        angle_mode: Name in `frames.ANGLE_MODES` of the pose angles.
        task: What the mechanism's inverse kinematics solves for.
        display: What the controller displays beside the position.
        columns: Names of those columns.
        tool_axis: Axis of the tool frame that is the tool vector.
        running_c: True where C continues over whole turns.
        held: Names of the input axes, which inverse kinematics does not move.
        vectors: How vectors are programmed (#ORI MODE), where they can be.
        status: True where the controller defines status and turn.
        axes: The axes, for other spellings of their names; empty: none are known.
    """

    __repr__ = fields_shown

    angle_mode: str
    task: Task = "pose"
    display: Display = POSE_ANGLES
    columns: tuple[str, ...] = ANGLE_COLUMNS
    tool_axis: Literal["x", "z"] = "z"
    running_c: bool = False
    held: tuple[str, ...] = ()
    vectors: VectorProgramming | None = None
    status: bool = False
    axes: tuple[Axis, ...] = ()

    @classmethod
    def of(cls, chain: Chain, task: Task) -> PoseForm:
        """Return the form of a chain."""
        columns = chain.display_columns
        return cls(
            chain.angle_mode,
            task,
            chain.display,
            columns,
            chain.tool_axis,
            running_c=chain.absolute_c is not None,
            held=tuple(axis.name for axis in chain.axes if axis.held and axis.name not in columns),
            vectors=chain.vectors,
            status=chain.has_status,
            axes=chain.axes,
        )

    @property
    def full(self) -> tuple[str, ...]:
        """Columns that fk writes beside the position: full orientations only where they are what is programmed."""
        quaternion = () if self.display.rtcp else QUATERNION_COLUMNS
        return (*quaternion, *(name for name in TOOL_COLUMNS if name not in self.columns), *self.columns)

    @property
    def whole(self) -> bool:
        """Whether the displayed columns describe a rotation, or a direction, without the kinematic."""
        return self.display.kind in {"direction", "vector"} or (self.shows_angles and len(self.columns) == 3)

    @property
    def shows_angles(self) -> bool:
        """Whether the displayed columns are pose angles of `angle_mode`."""
        return self.display.kind == "angles"

    def position(self, names: Iterable[str]) -> tuple[str, ...]:
        """Return the columns of the position; where only x and z are programmed y may be missing."""
        optional = {"y_mm"} - set(names) if self.display.plane_xz else set()
        return tuple(name for name in POSITION_COLUMNS if name not in optional)

    def orientation(self, names: Iterable[str]) -> PoseColumns:
        """Return which of the columns that are there give the orientation, or those that should be there."""
        found = set(names)
        shown, angles = PoseColumns("shown", self.columns), found & set(ANGLE_COLUMNS)
        own = self.display.rtcp and (not self.columns or found & set(self.columns))
        choices = (
            (own, shown),
            (found & set(QUATERNION_COLUMNS), PoseColumns("quaternion", QUATERNION_COLUMNS)),
            (self.vectors and found & set(VECTOR_COLUMNS), PoseColumns("vector", VECTOR_COLUMNS)),
            (self.shows_angles and not angles <= set(self.columns), PoseColumns("angles", ANGLE_COLUMNS)),
            (found & set(self.columns), shown),
            (self.task != "pose" and found & set(TOOL_COLUMNS), PoseColumns("tool", TOOL_COLUMNS)),
            (self.task == "position", PoseColumns("none", ())),
        )
        return next((orientation for holds, orientation in choices if holds), shown)

    def permitted(self) -> tuple[str, ...]:
        """Return every column that a table of poses may have."""
        angles = () if self.display.rtcp or not self.shows_angles else ANGLE_COLUMNS
        more = (*(VECTOR_COLUMNS if self.vectors else ()), *(STATUS_COLUMNS if self.status else ()))
        names = (*POSITION_COLUMNS, *self.columns, *angles, *QUATERNION_COLUMNS, *TOOL_COLUMNS, *more, *self.held)
        return tuple(dict.fromkeys(names))

    def groups(self) -> tuple[tuple[str, ...], ...]:
        """Return the orientations that are taken, the displayed one first."""
        groups = [self.columns, QUATERNION_COLUMNS]
        groups += [ANGLE_COLUMNS] if self.shows_angles else []
        groups += [TOOL_COLUMNS] if self.task != "pose" else []
        return tuple(dict.fromkeys(group for group in groups if group))

    def programmed_by(self) -> str:
        """Return in words what a pose is programmed by, for messages."""
        if self.display.kind == "axes" and self.columns:
            axes = "axes" if len(self.columns) > 1 else "axis"
            return f"this kinematic is programmed by position and its rotary {axes} {', '.join(self.columns)}"
        listed = ", ".join(self.columns)
        return f"this kinematic is programmed by position{f' and {listed}' if listed else ' alone'}"

    def hint(self, name: str) -> str | None:
        """Return what to say of a column that is not permitted, where there is more to say than its name."""
        n = axis_index(self.axes, name.partition("[")[0].partition("(")[0].strip())
        if n is not None and self.axes[n].kind == "linear":
            return f"{self.axes[n].name} is an axis: the position of the tool is {', '.join(POSITION_COLUMNS)}"
        return self.programmed_by() if self.display.rtcp or name in ANGLE_COLUMNS else None

    def length_fault(self, orientation: PoseColumns, values: Sequence[float]) -> tuple[str, str] | None:
        """Return what is wrong with the length of a quaternion or vector, and what is permitted; None if nothing is.

        A vector that is programmed may have any length but zero.
        """
        source, columns = orientation
        if not columns or not set(columns) <= UNIT_COLUMNS:
            return None
        norm, listed = math.hypot(*values), ", ".join(columns)
        if source in {"vector", "shown"}:
            zero = f"({listed}) is the zero vector", "any other vector"
            return zero if norm < tolerances.ZERO_VECTOR else None
        length = f"({listed}) has the length {norm:.6g}", f"1 ± {tolerances.QUATERNION_NORM:g}"
        return None if abs(norm - 1.0) <= tolerances.QUATERNION_NORM else length

    def rotation(self, orientation: PoseColumns, values: Sequence[float]) -> Matrix | None:
        """Return a rotation (3, 3) that the values of an orientation describe, None where they alone describe none.

        Of a tool vector it is one of the rotations that have it. Angles without a column are 0, where they follow.

        Args:
            orientation: The columns.
            values: Their values; quaternions and vectors of any length but zero.
        """
        source, kind = orientation.source, self.display.kind if orientation.source == "shown" else ""
        if source == "quaternion":
            return frames.matrix_from_quaternion(values)
        if source == "tool" or kind in {"vector", "direction"}:
            aimed = vector_of_angles(self.display, values).tolist() if kind == "direction" else values
            return None if kind and self.task == "pose" else self._with_tool(aimed)
        if source == "none":
            return np.eye(3)
        if source != "angles" and (kind != "angles" or self.display.follows):
            return None
        angles = dict(zip(orientation.columns, values, strict=True))
        return frames.matrix_from_angles(self.angle_mode, [angles.get(name, 0.0) for name in ANGLE_COLUMNS])

    def _with_tool(self, direction: Sequence[float]) -> Matrix:
        x, y, z = direction
        tilt, turn = math.atan2(math.hypot(x, y), z), math.atan2(y, x)
        R: Matrix = frames.rot_z(deg_from_rad(turn)) @ frames.rot_y(deg_from_rad(tilt))
        return R if self.tool_axis == "z" else R @ frames.rot_y(-90.0)
