"""What a chain is made of: links, joints, frames, loops, axes. Frozen data, no maths."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import AxisMap
from chainbuild.chain.bodies.geometry import NO_GEOMETRY, Geometry
from chainbuild.chain.bodies.inertia import NO_DYNAMICS, JointDynamics
from chainbuild.chain.drives import DriveLimit, DriveMap
from chainbuild.chain.programmed.display import POSE_ANGLES, Display
from chainbuild.chain.programmed.named import NamedPose
from chainbuild.chain.programmed.vectors import VectorProgramming
from chainbuild.chain.sums import AxisConstraint, AxisSum
from chainbuild.convention import UsedConvention
from chainbuild.findings import NO_FINDINGS, Findings
from chainbuild.shown import fields_shown, two_lines
from chainbuild.units import AxisKind, AxisUnit, unit_of

JointKind = Literal["revolute", "prismatic"]
Task = Literal["auto", "pose", "direction", "position"]

BASE_LINK = "base"
FRAME_NAMES = ("base", "flange", "tool", "workpiece")


@dataclass(frozen=True, slots=True)
class Link:
    """A rigid body.

    Attributes:
        name: Unique name.
        radius: Radius [m] of the capsule that stands for it, or None for the default rule.
    """

    __repr__ = fields_shown

    name: str
    radius: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Joint:
    """One degree of freedom between two links.

    Where one axis alone drives it, with factor ±1, its value is the axis value in SI: `fold` has put the sign and the
    zero of the axis into placement and direction.

    Attributes:
        name: The controller's axis name.
        kind: Revolute or prismatic.
        parent: Name of the link that carries it.
        child: Name of the link it moves.
        T_parent_joint: (4, 4) placement at joint value 0 [m].
        direction: (3,) unit vector of the joint axis in the joint's own frame.
        zero: Joint value [m, rad] of the position in which its recipe draws it.
        reversed: True where it moves against the direction drawn in its recipe.
        dynamics: What a URDF says of its effort, damping and friction.
    """

    __repr__ = fields_shown

    name: str
    kind: JointKind
    parent: str
    child: str
    T_parent_joint: Matrix
    direction: Vector
    zero: float = 0.0
    reversed: bool = False
    dynamics: JointDynamics = NO_DYNAMICS


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """A named frame fixed to a link: T_link_frame (4, 4) [m]."""

    __repr__ = fields_shown

    name: str
    link: str
    T_link_frame: Matrix


@dataclass(frozen=True, slots=True)
class Loop:
    """A closure between two frames.

    Attributes:
        name: Unique name.
        kind: "ball" (3 equations), "hinge" (5, about the frames' z) or "weld" (6).
        frame_a: One frame's name.
        frame_b: The other frame's name.
    """

    __repr__ = fields_shown

    name: str
    kind: Literal["ball", "hinge", "weld"]
    frame_a: str
    frame_b: str


@dataclass(frozen=True, slots=True)
class Axis:
    """An axis as the controller shows it.

    Attributes:
        name: The channel's own name where the machine data give one, else the generic one.
        kind: "linear" or "rotary".
        unit: "mm" or "deg", also of the limits.
        lower: Lower software limit; where the drive has limits of its own, what both leave.
        upper: Upper software limit, likewise.
        assumed: True where neither machine data nor overlay give limits.
        endless: True for an axis that may turn without end.
        carries: What it moves: the tool or the workpiece.
        held: True for an input axis that inverse kinematics leaves where it is programmed.
        max_speed: mm/s or deg/s, where known.
        generic: The name that the type or the transformation gives it ("C", "A1", "EX1"), where the channel has another
            one for it; else empty. It is accepted wherever an axis is named.
        widest: Where limits of drives make the range depend on the other axes: the range in their most favourable
            position; `lower` and `upper` are then the range in the middle of the others. None: it does not depend.
    """

    name: str
    kind: AxisKind
    unit: AxisUnit
    lower: float
    upper: float
    assumed: bool
    endless: bool = False
    carries: Literal["tool", "workpiece"] = "tool"
    held: bool = False
    max_speed: float | None = None
    generic: str = ""
    widest: tuple[float, float] | None = None

    def __repr__(self) -> str:
        depends = self.widest is not None
        said = {"assumed": self.assumed, "endless": self.endless, "held": self.held, "depends on others": depends}
        more = "".join(f", {word}" for word, holds in said.items() if holds)
        return two_lines(f"<Axis {self.name}: {self.kind}, {self.lower:.6g} … {self.upper:.6g} {self.unit}{more}>")

    @property
    def range(self) -> tuple[float, float]:
        """Lower and upper end of what limits ever leave, whatever the other axes."""
        return self.widest or (self.lower, self.upper)

    @classmethod
    def unlimited(cls, name: str, kind: AxisKind, carries: Literal["tool", "workpiece"] = "tool") -> Axis:
        """Build an axis without known limits."""
        from chainbuild import tolerances

        bound = tolerances.ASSUMED_LINEAR_LIMIT_MM if kind == "linear" else tolerances.ASSUMED_ROTARY_LIMIT_DEG
        return cls(name, kind, unit_of(kind), -bound, bound, True, carries=carries)


@dataclass(frozen=True, slots=True)
class ControllerSolver:
    """Budget of the control's iterative inverse (ROBX manual 7.1.7, MD62967–62970).

    Attributes:
        max_count: Largest number of iterations.
        precision: Bound of the internal target function.
        limit_deg: A position counts as singular where axis 5 is within this angle of 0.
        limit2_deg: Axis 5 closer to 0 than this raises 75370–75372.
        hand_angle: Mathematical angle of axis 5, where the robot has one.
    """

    __repr__ = fields_shown

    max_count: int
    precision: float
    limit_deg: float
    limit2_deg: float
    hand_angle: AxisSum | None = None


@dataclass(frozen=True, slots=True)
class SingularityWatch:
    """How a control monitors singularities (ROBX manual 10).

    Attributes:
        threshold: SD41670: at and below it a position is singular; None where the file does not give it.
        clearance: SD41671: between the two a position is examined more closely; None likewise.
        speed_alarm: Alarm where an axis would exceed its speed.
        handled: MD28592: whether blocks with singular parts are split; None where the file does not say.
        measure: What the two are compared with: the choice of convention `singularity_measure`.
        block: What the alarm of a singular block counts: the choice of `singular_block`.
        lacks: Why the control does not handle singular blocks of this kinematic; empty: it does.
    """

    __repr__ = fields_shown

    threshold: float | None
    clearance: float | None
    speed_alarm: int
    handled: bool | None = None
    measure: str = "one_minus_cosine"
    block: str = "whole_block"
    lacks: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Partial:
    """One of the kinematics of a composed chain, for moving it separately.

    Attributes:
        name: Its name among the others.
        chain: The kinematic alone; its workpiece frame is its own coordinate system.
        T_carrier_mcs: (4, 4) its workpiece frame in the tool frame of the one that carries it [m]; for the lowest,
            in the workpiece frame of the whole.
        first_axis: Index of its first axis in the composed chain.
        group: 0: carries the tool; 1, 2, …: other branches, the workpiece's among them.
        rank: Rank in the distribution of a tool motion; None: by its place in the stack.
        locked: Coordinates ("X" … "C") that a motion of the tool does not move.
        letters: The coordinate that each of its axes stands for; empty: that of its generic name, if it is one.
    """

    __repr__ = fields_shown

    name: str
    chain: Chain
    T_carrier_mcs: Matrix
    first_axis: int
    group: int = 0
    rank: int | None = None
    locked: tuple[str, ...] = ()
    letters: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """One kinematic chain with two tips: frames `tool` and `workpiece` on a tree rooted in link `base`.

    Attributes:
        name: File-system-safe name, used for URDF.
        title: Name for people.
        dialect: "SINUMERIK ROBX", "TwinCAT CNC", "URDF" or "Denavit-Hartenberg".
        kinematic: "ROBX NR", "KIN_TYP 45", "DH standard", … .
        links: All links, `base` first.
        joints: All joints, parents before children.
        frames: At least base, flange, tool and workpiece.
        axes: The controller's axes in channel order.
        axis_map: From axis values to joint values.
        angle_mode: Name in `frames.ANGLE_MODES` of the pose angles A, B, C.
        loops: Closures; empty for a tree.
        task: What inverse kinematics solves for; "auto" decides by the Jacobian.
        conventions: The conventions that shaped the chain, for what the manuals leave open.
        findings: Findings of the file and of the translation.
        constraints: Limits on sums of axes.
        absolute_c: What the controller shows as pose angle C where C continues over whole turns.
        tool_axis: Axis of the tool frame that is the tool direction: what a 5-axis chain can point.
        partials: What a composed chain was made of, in the order of the axes; empty for a single kinematic.
        follows_c: True where position and pose angle C are programmed and A and B follow (ROBX robots of four axes).
        controller_solver: Budget of the control's own iterative inverse, where its data are known.
        singularity_watch: How the control monitors singularities, where that is known.
        geometry: What the overlay says about its bodies.
        display: What the controller shows and takes as a pose beside the position.
        vectors: How a program states orientations by vectors, where it can.
        drives: What the drives stand at, by the axis values; None: at the axis values.
        drive_limits: Limits and speeds of drives that do not stand at their axis values.
        named_poses: Poses that the overlay names; composing drops those of the parts.
    """

    name: str
    title: str
    dialect: str
    kinematic: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    frames: tuple[Frame, ...]
    axes: tuple[Axis, ...]
    axis_map: AxisMap
    angle_mode: str
    loops: tuple[Loop, ...] = ()
    task: Task = "auto"
    conventions: tuple[UsedConvention, ...] = ()
    findings: Findings = NO_FINDINGS
    constraints: tuple[AxisConstraint, ...] = ()
    absolute_c: AxisSum | None = None
    tool_axis: Literal["x", "z"] = "z"
    partials: tuple[Partial, ...] = ()
    follows_c: bool = False
    controller_solver: ControllerSolver | None = None
    singularity_watch: SingularityWatch | None = None
    geometry: Geometry = NO_GEOMETRY
    display: Display = POSE_ANGLES
    vectors: VectorProgramming | None = None
    drives: DriveMap | None = None
    drive_limits: tuple[DriveLimit, ...] = ()
    named_poses: tuple[NamedPose, ...] = ()

    def __repr__(self) -> str:
        names = [axis.name for axis in self.axes]
        listed = f"{names[0]} … {names[-1]}" if len(names) > 3 else ", ".join(names)
        return two_lines(f"<Chain {self.name}: {self.kinematic}, axes {listed}>")

    def frame(self, name: str) -> Frame:
        """Return a frame by name."""
        return next(frame for frame in self.frames if frame.name == name)

    @property
    def tool_column(self) -> int:
        """Which column of the tool frame's rotation is the tool direction: 0 or 2."""
        return 0 if self.tool_axis == "x" else 2

    @property
    def has_status(self) -> bool:
        """Whether the controller defines status and turn for the kinematic (KIN_TYP manual 3.3.3)."""
        return self.kinematic == "KIN_TYP 45"

    @property
    def solves_linear_axes(self) -> bool:
        """Whether the linear axes alone are solved for where what is displayed is given: RTCP, and KIN_TYP 76.

        Struts are no such axes (KIN_TYP 209): the position does not follow from them affinely.
        """
        linear = all(self.axes[n].kind == "linear" for n in self.display.solved)
        return not self.loops and self.display.kind == "axes" and linear

    @property
    def display_columns(self) -> tuple[str, ...]:
        """Names of the columns that the controller displays beside the position."""
        return self.display.columns or tuple(self.axes[n].name for n in self.display.axes)

    def with_axes(self, axes: tuple[Axis, ...]) -> Chain:
        """Return the chain with other axis limits, in its partials, too."""
        return replace(self, axes=axes, partials=tuple(_with_limits(partial, axes) for partial in self.partials))

    def with_drive_limits(self, limits: tuple[DriveLimit, ...]) -> Chain:
        """Return the chain with other limits of its drives, in its partials, too."""
        partials = tuple(_with_drive_limits(partial, limits) for partial in self.partials)
        return replace(self, drive_limits=limits, partials=partials)


def _with_limits(partial: Partial, axes: tuple[Axis, ...]) -> Partial:
    """Return a partial with the limits that its axes have in the composed chain; its own names stay."""
    own = partial.chain.axes
    pairs = zip(own, axes[partial.first_axis :], strict=False)
    limited = tuple(replace(new, name=old.name, generic=old.generic, carries=old.carries) for old, new in pairs)
    return replace(partial, chain=partial.chain.with_axes(limited))


def _with_drive_limits(partial: Partial, limits: tuple[DriveLimit, ...]) -> Partial:
    first, count = partial.first_axis, len(partial.chain.axes)
    own = tuple(replace(one, axis=one.axis - first) for one in limits if 0 <= one.axis - first < count)
    return replace(partial, chain=partial.chain.with_drive_limits(own))
