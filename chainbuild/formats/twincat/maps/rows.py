"""The closed forms of closed loops over many rows of axis values at once, in NumPy."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.arrays import Matrix, Vector

IN_LINE: Final = 1e-14  # of a cosine: rounding where the rods are in line

Rows3 = tuple[Vector, Vector, Vector]  # x, y and z of many points


def common_points(centres: tuple[Rows3, Rows3, Rows3], rod: float, hanging: float, limits: tuple[float, ...]) -> Rows3:
    """Return the common points of balls about three centres, not a number where there is none.

    Args:
        centres: Of the balls, each (N,).
        rod: Their radius.
        hanging: +1 for the lower point, -1 for the upper one.
        limits: Those of `ThreeRodsMap.common`: squared sine, share of the rod, share of its square.
    """
    flat, same, touches = limits
    (ax, ay, az), b, c = centres
    ux, uy, uz = b[0] - ax, b[1] - ay, b[2] - az
    vx, vy, vz = c[0] - ax, c[1] - ay, c[2] - az
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    square = nx * nx + ny * ny + nz * nz
    uu, vv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
    least = (same * rod) ** 2
    wx, wy, wz = ux - vx, uy - vy, uz - vz
    alike = (uu <= least) | (vv <= least) | (wx * wx + wy * wy + wz * wz <= least) | (square <= flat * uu * vv)
    with np.errstate(divide="ignore", invalid="ignore"):
        # o - a = (v × n)·|u|²/(2·|n|²) + (n × u)·|v|²/(2·|n|²)
        f, g = uu / (2.0 * square), vv / (2.0 * square)
        ox = f * (vy * nz - vz * ny) + g * (ny * uz - nz * uy)
        oy = f * (vz * nx - vx * nz) + g * (nz * ux - nx * uz)
        oz = f * (vx * ny - vy * nx) + g * (nx * uy - ny * ux)
        height = rod**2 - (ox * ox + oy * oy + oz * oz)
        height[np.abs(height) < touches * rod**2] = 0.0
        height[alike] = np.nan
        step = np.copysign(np.sqrt(height / square), nz) * hanging
    return ax + ox - step * nx, ay + oy - step * ny, az + oz - step * nz


def rod_turns(x: Vector, y: float, rods: tuple[float, float], side: float) -> Vector:
    """Return the direction θ [rad] of the rod from C at ways from C to B, not a number where the rods do not meet.

    Args:
        x: (N,) ways along the slides [m].
        y: Across them [m].
        rods: Lengths from C and from B [m].
        side: +1: they meet on the left of the way, -1: on its right.
    """
    apart, (rod, other) = np.hypot(x, y), rods
    with np.errstate(divide="ignore", invalid="ignore"):
        cosine = (rod**2 + apart**2 - other**2) / (2.0 * rod * apart)
        touching = np.abs(cosine) <= 1.0 + IN_LINE
        cosine[touching] = np.clip(cosine[touching], -1.0, 1.0)
        return np.asarray(np.arctan2(y, x) + side * np.arccos(cosine))


def in_columns(*columns: Vector) -> Matrix:
    """Return columns (N,) as rows (N, n)."""
    return np.column_stack(columns)
