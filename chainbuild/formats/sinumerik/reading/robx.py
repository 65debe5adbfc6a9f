"""One ROBX transformation as typed data (ROBX manual 5, 8, 11.2); TE4's TRAFO6_* data fill the same fields.

Lengths are mm and angles degrees, suffixed so; dynamics are SI. Motion limits and
the iteration's budget do not change the geometry.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from chainbuild import frames
from chainbuild.chain.elements import ControllerSolver
from chainbuild.errors import Span
from chainbuild.formats.sinumerik.reading.catalogue import catalogue
from chainbuild.formats.sinumerik.reading.data_table import ChannelData
from chainbuild.units import m_s_from_mm_min, rad_s2_from_rev_s2, rad_s_from_rpm

Vector3 = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Dynamics:
    """Cartesian motion limits of the override controller, in the basic coordinate system (ROBX manual 5.3.18).

    Attributes:
        velocity: [m/s] along X, Y, Z.
        acceleration: [m/s²] along X, Y, Z.
        angular_velocity: [rad/s] of the angles A, B, C.
        angular_acceleration: [rad/s²] of the angles A, B, C.
        reduction: Factor on the largest velocity.
        filter_time: [s] time constant of the velocity controller.
    """

    velocity: Vector3
    acceleration: Vector3
    angular_velocity: Vector3
    angular_acceleration: Vector3
    reduction: float
    filter_time: float


@dataclass(frozen=True, slots=True)
class Control:
    """Data that affect the control and not the geometry.

    Attributes:
        kinclass: 1 standard, 2 special kinematics.
        grip_reset_mode: Gripper-referred motion after a reset: 0 as before, 1 off, 2 on.
        a_dbd_start_index: Index of $A_DBD that shows gripper-referred motion; -1 none.
        solver: Budget of the iterative inverse.
        dynamics: Motion limits.
    """

    kinclass: int
    grip_reset_mode: int
    a_dbd_start_index: int
    solver: ControllerSolver
    dynamics: Dynamics


def read_control(data: ChannelData) -> Control:
    """Type the control-side data of a channel."""
    return Control(
        int(data.number("ROBX_KINCLASS")),
        int(data.number("ROBX_GRIP_REL_RESET_MODE")),
        int(data.number("ROBX_A_DBD_START_INDEX")),
        ControllerSolver(
            int(data.number("ROBX_ITERMAXCOUNT")),
            data.number("ROBX_ITERPRECISION"),
            data.number("ROBX_ITERLIMIT"),
            data.number("ROBX_ITERLIMIT2"),
        ),
        _dynamics(data),
    )


def _dynamics(data: ChannelData) -> Dynamics:
    """Type the motion limits of a channel: mm/min, m/s², rpm and rev/s² become SI."""
    vx, vy, vz = (m_s_from_mm_min(value) for value in data.vector("ROBX_VELCP"))
    wa, wb, wc = (rad_s_from_rpm(value) for value in data.vector("ROBX_VELORI"))
    aa, ab, ac = (rad_s2_from_rev_s2(value) for value in data.vector("ROBX_ACCORI"))
    return Dynamics(
        (vx, vy, vz),
        data.vector("ROBX_ACCCP"),
        (wa, wb, wc),
        (aa, ab, ac),
        data.number("ROBX_DYN_LIM_REDUCE"),
        data.number("ROBX_VEL_FILTER_TIME"),
    )


Package = Literal["ROBX", "TE4"]

MAIN_AXES = {1: "SS", 2: "CC", 3: "NR", 4: "SC", 5: "RR", 6: "CS", 7: "NN"}
WRISTS = {1: "no wrist", 2: "central wrist", 3: "inclined wrist", 5: "angled wrist", 6: "inclined wrist with offsets"}


@dataclass(frozen=True, slots=True)
class FrameData:
    """A frame of machine data: position in mm, RPY angles A, B, C in degrees."""

    position_mm: Vector3
    rpy_deg: Vector3 = (0.0, 0.0, 0.0)

    def T(self) -> NDArray[np.float64]:
        """Return F(POS, RPY) as a 4×4 transform with its translation in mm."""
        return frames.f_frame(self.position_mm, self.rpy_deg)


@dataclass(frozen=True, slots=True)
class ExtraAxis:
    """An additional axis that TRAFO_AXES_IN names.

    Attributes:
        name: EX1 … EX3 (moves the base), EW1 … EW3 (turns the workpiece), EF1 … EF3 (turns the tool).
        slot: 0, 1 or 2: its place in the machine data.
        channel_axis: Channel axis number.
        direction: Vector as given, of any length.
        offset: Zero offset in mm (linear) or degrees, subtracted from the axis value.
        vector_name: Name of the datum that gives the direction.
    """

    name: str
    slot: int
    channel_axis: int
    direction: Vector3
    offset: float
    vector_name: str


@dataclass(frozen=True, slots=True)
class ExtraGroup:
    """The rotary additional axes of workpiece or flange with the offsets between them (ROBX manual 8.2, 8.3).

    Attributes:
        axes: The axes that exist, in the order of their slots.
        base_mm: From the robot's base point or the flange to the first axis.
        joints_mm: From the first to the second and from the second to the third axis.
        part_mm: From the last axis to the workpiece origin; zero for the flange.
    """

    axes: tuple[ExtraAxis, ...]
    base_mm: Vector3
    joints_mm: tuple[Vector3, Vector3]
    part_mm: Vector3 = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class DhLink:
    """Denavit-Hartenberg data from one wrist axis to the next: Tz(d)·Tx(a)·Rx(alpha)."""

    d_mm: float
    a_mm: float
    alpha_deg: float


@dataclass(frozen=True, slots=True)
class Robx:
    """A transformation of type 4100 (ROBX) or 4099 (TE4).

    Attributes:
        data: The channel's data, for spans and for data without a field.
        transformation: x of TRAFO_TYPE_x.
        package: "ROBX" or "TE4".
        axes_in: Channel axis at each of the inputs 0 … 14, 0 for none.
        main_axes: 1 SS, 2 CC, 3 NR, 4 SC, 5 RR, 6 CS, 7 NN.
        wrist: 1 none, 2 central, 3 inclined, 5 angled, 6 inclined with offsets.
        dh: From axis 4 to 5 and from axis 5 to 6.
        mames: mm or degrees, by the kind of the axis.
        axis_seq: Input axis that serves as internal axis i + 1.
        toa_start: First $TC_DPC parameter of the tool angles; 0 none, -1 vectors.
        feature_mask: Bit 0 lets the angle C of a 4-axis SCARA continue over whole turns.
        c_angle_offset_deg: C at mathematical zero with its sign reversed.
        parallel_limits_deg: Limit angles of the parallelogram.
        control: Data that do not change the geometry.
    """

    data: ChannelData
    transformation: int
    package: Package
    axes_in: tuple[int, ...]
    special_kin: int
    main_axes: int
    wrist: int
    num_axes: int
    a4par: bool
    axes_type: tuple[int, ...]
    lengths_mm: tuple[float, float]
    trowo: FrameData
    tiroro: FrameData
    tx3p3: FrameData
    tflwp: FrameData
    ttcfl: FrameData
    tfl_ext_rpy_deg: Vector3
    dh: tuple[DhLink, DhLink]
    mames: tuple[float, ...]
    axes_dir: tuple[int, ...]
    axis_seq: tuple[int, ...]
    base_axes: tuple[ExtraAxis, ...]
    table: ExtraGroup
    flange: ExtraGroup
    toa_start: int
    tool_dir: int
    feature_mask: int
    c_angle_offset_deg: float
    parallel_limits_deg: tuple[float, float]
    control: Control

    @property
    def arrangement(self) -> str:
        """Letters of the basic axes: SS, CC, NR, SC, RR, CS or NN."""
        return MAIN_AXES[self.main_axes]

    @property
    def type_text(self) -> str:
        """Short type: "ROBX NR, 6 axes"."""
        return f"{self.package} {self.arrangement}, {self.num_axes} axes"

    @property
    def tflwp_c_given(self) -> bool:
        """False where the third angle of `tflwp` is a default, which is missing in the manual."""
        return self.data.row("ROBX_TFLWP_RPY", 2) is not None

    def span(self, *names: str) -> Span | None:
        """Return where the file gives the first of the named data, else where it gives the transformation's type."""
        wanted = (*(f"ROBX_{name}" for name in names), f"TRAFO_TYPE_{self.transformation}")
        return next((span for name in wanted if (span := self.data.span(name))), None)

    def parameter(self, name: str) -> str:
        """Return number and name of a datum for messages: "MD62909 $MC_ROBX_TX3P3_RPY"."""
        datum = catalogue()[f"ROBX_{name}"]
        if self.package == "TE4":
            return f"MD{datum.te4_number} $MC_{datum.te4_name}"
        return f"MD{datum.number} {datum.identifier}"

    def given(self, name: str) -> bool:
        """Tell whether the file gives a datum (name without ROBX_)."""
        return self.data.given(f"ROBX_{name}")


def read_robx(data: ChannelData, transformation: int) -> Robx:
    """Type the data of one transformation; values the file does not give are the catalogue's defaults."""
    axes_in = _inputs(data, transformation)
    return Robx(
        data=data,
        transformation=transformation,
        package="TE4" if data.te4 else "ROBX",
        axes_in=axes_in,
        special_kin=_integer(data, "SPECIAL_KIN"),
        main_axes=_integer(data, "MAIN_AXES"),
        wrist=_integer(data, "WRIST_AXES"),
        num_axes=_integer(data, "NUM_AXES"),
        a4par=bool(_integer(data, "A4PAR")),
        axes_type=data.integers("ROBX_AXES_TYPE"),
        lengths_mm=_pair(data, "MAIN_LENGTH_AB"),
        trowo=_frame(data, "TROWO"),
        tiroro=_frame(data, "TIRORO"),
        tx3p3=_frame(data, "TX3P3"),
        tflwp=_frame(data, "TFLWP"),
        ttcfl=_frame(data, "TTCFL"),
        tfl_ext_rpy_deg=data.vector("ROBX_TFL_EXT_RPY"),
        dh=(_dh(data, 0), _dh(data, 1)),
        mames=data.numbers("ROBX_MAMES"),
        axes_dir=data.integers("ROBX_AXES_DIR"),
        axis_seq=data.integers("ROBX_AXIS_SEQ"),
        base_axes=_extra_axes(data, axes_in, 6, "EX", "EXT_AXIS_VECTOR", "EXT_AX_OFFSET"),
        table=_table(data, axes_in),
        flange=_flange(data, axes_in),
        toa_start=_integer(data, "CC_TOA_START_NUM"),
        tool_dir=_integer(data, "TOOL_DIR"),
        feature_mask=_integer(data, "SPECIAL_FEATURE_MASK"),
        c_angle_offset_deg=data.number("ROBX_C_ANGLE_OFFSET"),
        parallel_limits_deg=_pair(data, "SW_LIMITS_PARALLEL"),
        control=read_control(data),
    )


# MD24110 of an unchanged control. An archive of changed data alone leaves them out.
_DEFAULT_INPUTS: Final = (1, 2, 3, 4, 5)


def _inputs(data: ChannelData, transformation: int) -> tuple[int, ...]:
    """Return TRAFO_AXES_IN: the file's, else the control's default for the robot's own axes, else none.

    Beyond NUM_AXES nothing is taken by default: a list that names the robot's axes only is meant so.
    """
    given = list(data.integers(f"TRAFO_AXES_IN_{transformation}"))
    for n in inputs_by_default(data, transformation):
        given[n] = _DEFAULT_INPUTS[n]
    return tuple(given)


def inputs_by_default(data: ChannelData, transformation: int) -> list[int]:
    """Return the elements of TRAFO_AXES_IN for which the control's default counts."""
    count = min(_integer(data, "NUM_AXES"), len(_DEFAULT_INPUTS))
    return [n for n in range(count) if data.row(f"TRAFO_AXES_IN_{transformation}", n) is None]


def _integer(data: ChannelData, name: str) -> int:
    return int(data.number(f"ROBX_{name}"))


def _pair(data: ChannelData, name: str) -> tuple[float, float]:
    first, second = data.numbers(f"ROBX_{name}")
    return first, second


def _frame(data: ChannelData, name: str) -> FrameData:
    return FrameData(data.vector(f"ROBX_{name}_POS"), data.vector(f"ROBX_{name}_RPY"))


def _dh(data: ChannelData, n: int) -> DhLink:
    d, a, alpha = (data.number(f"ROBX_DHPAR4_5{letter}", n) for letter in ("D", "A", "ALPHA"))
    return DhLink(d, a, alpha)


def _extra_axes(
    data: ChannelData, axes_in: tuple[int, ...], first: int, letters: str, vector: str, offset: str
) -> tuple[ExtraAxis, ...]:
    offsets = data.vector(f"ROBX_{offset}")
    found = []
    for slot in range(3):
        name = f"ROBX_{vector}_{slot + 1}"
        if axes_in[first + slot]:
            axis = ExtraAxis(
                f"{letters}{slot + 1}", slot, axes_in[first + slot], data.vector(name), offsets[slot], name
            )
            found.append(axis)
    return tuple(found)


def _table(data: ChannelData, axes_in: tuple[int, ...]) -> ExtraGroup:
    return ExtraGroup(
        _extra_axes(data, axes_in, 9, "EW", "EXT_ROT_AX_VECTOR", "EXT_ROT_AX_OFFSET"),
        data.vector("ROBX_EXT_ROT_BASE_OFFSET"),
        (data.vector("ROBX_EXT_ROT_JOINT_OFFSET_1"), data.vector("ROBX_EXT_ROT_JOINT_OFFSET_2")),
        data.vector("ROBX_EXT_ROT_PART_OFFSET"),
    )


def _flange(data: ChannelData, axes_in: tuple[int, ...]) -> ExtraGroup:
    return ExtraGroup(
        _extra_axes(data, axes_in, 12, "EF", "EXT_FL_ROT_AX_VECTOR", "EXT_FL_ROT_AX_OFFSET"),
        data.vector("ROBX_EXT_FL_ROT_BASE_OFFSET"),
        (data.vector("ROBX_EXT_FL_ROT_JOINT_OFF_1"), data.vector("ROBX_EXT_FL_ROT_JOINT_OFF_2")),
    )
