"""Control-side data of a transformation, which do not change its geometry: motion limits, iteration, reset state."""

from __future__ import annotations

from dataclasses import dataclass

from chainbuild.chain.elements import ControllerSolver
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
    """What steers the control and not the geometry.

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
