"""Substitute limits of the override controller in SI units (ROBX manual 5.3.18, MD62929–62935)."""

from __future__ import annotations

from dataclasses import dataclass

from chainbuild.sinumerik.data_table import ChannelData
from chainbuild.units import m_s_from_mm_min, rad_s2_from_rev_s2, rad_s_from_rpm

Vector3 = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Dynamics:
    """Cartesian motion limits in the basic coordinate system.

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


def read_dynamics(data: ChannelData) -> Dynamics:
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
