"""What the drives of heads stand at whose axis values are not theirs: 59 and 60, 70, 76.

The gear of 28 and the shifted B of 3 are affine (`chain.drives`). Drive values are mm and degrees in channel order.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.formats.twincat.maps.heads import SpatialAnglesMap, VirtualTurnMap
from chainbuild.frames import cos_sin_deg, rot_y
from chainbuild.units import deg_from_rad, rad_from_deg

BevelAxes = Literal["b_outside", "a_outside", "upright"]

# Indices in X, Y, Z, C, A and in X, Y, Z, B, A, CV: the outer rotary axis, the inner one, the virtual one.
_OUTER: Final = 3
_INNER: Final = 4
_VIRTUAL: Final = 5
_ROTARY: Final = slice(3, 5)
_REACH_SLACK: Final = 1e-12  # of a sine: a direction on the edge of the reach counts as reached


def _own(count: int, *rows: tuple[int, tuple[int, ...]]) -> NDArray[np.bool_]:
    """Return which axes each drive follows: its own, and in some rows others."""
    follows = np.eye(count, dtype=bool)
    for row, columns in rows:
        follows[row] = False
        follows[row, list(columns)] = True
    return follows


def _degrees(angles: Vector) -> list[float]:
    return [deg_from_rad(float(angle)) for angle in angles]


@dataclass(frozen=True, slots=True, eq=False)
class SpatialDrives:
    """59, 60: the drives C, A (B) stand at the machine angles of the programmed spatial angles, plus zero offsets.

    Attributes:
        spatial: From spatial angles to the angles of the joints.
        zero_deg: (2,) drive minus joint angle of C and of the inclined axis.
    """

    spatial: SpatialAnglesMap
    zero_deg: tuple[float, float]

    @property
    def follows(self) -> NDArray[np.bool_]:
        """C follows C and A, the inclined axis A alone."""
        return _own(5, (_OUTER, (_OUTER, _INNER)))

    @property
    def differing(self) -> tuple[int, ...]:
        """C and the inclined axis."""
        return (_OUTER, _INNER)

    @property
    def turning(self) -> tuple[int, ...]:
        """The linear drives and C."""
        return (0, 1, 2, _OUTER)

    @property
    def reach(self) -> Mapping[int, tuple[float, float]]:
        """The largest lean."""
        lean = deg_from_rad(self.spatial.largest_tilt)
        return {_INNER: (-lean, lean)}

    def drives(self, axes: Vector) -> Vector:
        """Return the drive values of axis values."""
        values: Vector = axes.copy()
        values[_ROTARY] = np.add(_degrees(self.spatial.q(axes)[_ROTARY]), self.zero_deg)
        return values

    def derivative(self, axes: Vector) -> Matrix:
        """Return the derivative, that of the joints."""
        return self.spatial.dq_daxes(axes)

    def refusal(self, axes: Vector) -> ChainbuildError | None:
        """Return the error of a lean that the head cannot reach, or None."""
        return self.spatial.refusal(axes)

    def named(self, names: Sequence[str]) -> SpatialDrives:
        """Return the drives that name the inclined axis by another name."""
        return replace(self, spatial=self.spatial.named(names))


@dataclass(frozen=True, slots=True, eq=False)
class VirtualTurnDrives:
    """70: the drives B, A stand where the virtual axis CV turns the programmed tool vector to; CV has no drive.

    Attributes:
        turned: From the programmed B, A, CV to the angles of the joints.
    """

    turned: VirtualTurnMap

    @property
    def follows(self) -> NDArray[np.bool_]:
        """B and A follow B, A and CV."""
        return _own(6, *((row, (_OUTER, _INNER, _VIRTUAL)) for row in (_OUTER, _INNER)))

    @property
    def differing(self) -> tuple[int, ...]:
        """B and A."""
        return (_OUTER, _INNER)

    @property
    def turning(self) -> tuple[int, ...]:
        """The linear drives and CV."""
        return (0, 1, 2, _VIRTUAL)

    @property
    def reach(self) -> Mapping[int, tuple[float, float]]:
        """Nothing: the head points everywhere."""
        return {}

    def drives(self, axes: Vector) -> Vector:
        """Return the drive values of axis values."""
        straight = self.turned.straight
        values: Vector = axes.copy()
        behind = np.append(self.turned.q(axes), straight.q(axes)[_VIRTUAL])
        values[_ROTARY] = straight.axes(behind)[_ROTARY]
        return values

    def derivative(self, axes: Vector) -> Matrix:
        """Return the derivative."""
        result: Matrix = np.eye(6)
        result[_ROTARY] = self.turned.straight.A[_ROTARY, _ROTARY] @ self.turned.dq_daxes(axes)[_ROTARY]
        return result

    def refusal(self, axes: Vector) -> ChainbuildError | None:
        """Return None: the head points everywhere."""
        return None


@dataclass(frozen=True, slots=True, eq=False)
class BevelDrives:
    """76: the machine axes behind the programmed C and A, in their places: C's drive is machine axis A, A's is B.

    The tool vector d = Rz(C)·Rx(A)·e_z, seen from the cutting head, Rz(-mounting)·d, is met by two turns, of which one
    is about u = (sin δ, 0, cos δ), machine axis A at δ = HD7 to Z:

        b_outside    Ry(B)·Rot(u, A)·e_z    sin A = -d_y / sin δ                |d_y| at most sin δ
        a_outside    Rot(u, A)·Ry(B)·e_z    cos(B - δ) = u·d                    everywhere
        upright      Rz(B)·Rot(u, A)·e_z    sin(A/2) = sin(lean/2) / sin δ      leans up to 2·δ

    Attributes:
        tilt_deg: δ = HD7, above 0 and below 180.
        mounting_deg: Turn of the cutting head about Z.
        arrangement: How the two axes stand.
        names: Names of the programmed C and A.
    """

    tilt_deg: float
    mounting_deg: float
    arrangement: BevelAxes
    names: tuple[str, str] = ("C", "A")

    @property
    def follows(self) -> NDArray[np.bool_]:
        """Both follow C and A."""
        return _own(5, *((row, (_OUTER, _INNER)) for row in (_OUTER, _INNER)))

    @property
    def differing(self) -> tuple[int, ...]:
        """Both rotary axes."""
        return (_OUTER, _INNER)

    @property
    def turning(self) -> tuple[int, ...]:
        """The linear drives: a whole turn of C is none of the machine axes."""
        return (0, 1, 2)

    @property
    def reach(self) -> Mapping[int, tuple[float, float]]:
        """Nothing: how far the head leans depends on the direction."""
        return {}

    def drives(self, axes: Vector) -> Vector:
        """Return the drive values of axis values, not a number beyond the reach."""
        values: Vector = axes.copy()
        c, a = (rad_from_deg(float(angle)) for angle in axes[_ROTARY])
        values[_ROTARY] = _degrees(np.array(self._machine(c - rad_from_deg(self.mounting_deg), a)))
        return values

    def _machine(self, c: float, a: float) -> tuple[float, float]:
        """Return machine angles A, B [rad] for the direction Rz(c)·Rx(a)·e_z."""
        cosine, sine = cos_sin_deg(self.tilt_deg)
        x, y, z = math.sin(c) * math.sin(a), -math.cos(c) * math.sin(a), math.cos(a)
        if self.arrangement == "b_outside":
            angle = _arc_sine(-y / sine)
            leans = sine * cosine * (1.0 - math.cos(angle)), cosine**2 + sine**2 * math.cos(angle)
            return angle, math.atan2(x, z) - math.atan2(*leans)
        if self.arrangement == "a_outside":
            b = rad_from_deg(self.tilt_deg) - math.acos(max(-1.0, min(1.0, sine * x + cosine * z)))
            # Across u: Ry(b)·e_z leans from u towards (-cos δ, 0, sin δ), which Rot(u, A) turns towards -e_y.
            return math.atan2(-y, sine * z - cosine * x), b
        lean = math.remainder(a, math.tau)
        angle = 2.0 * _arc_sine(math.sin(lean / 2.0) / sine)
        return angle, c - math.atan2(cosine * math.sin(angle / 2.0), math.cos(angle / 2.0))

    def direction(self, drives: Vector) -> tuple[float, float, float]:
        """Return the tool vector of drive values, seen from the cutting head."""
        cosine, sine = cos_sin_deg(self.tilt_deg)
        a, b = (rad_from_deg(float(angle)) for angle in drives[_ROTARY])
        if self.arrangement == "a_outside":
            x, z = math.sin(b), math.cos(b)
            along, across = sine * x + cosine * z, sine * z - cosine * x
            return (
                along * sine - across * math.cos(a) * cosine,
                -across * math.sin(a),
                along * cosine + across * math.cos(a) * sine,
            )
        x, y, z = sine * cosine * (1.0 - math.cos(a)), -sine * math.sin(a), cosine**2 + sine**2 * math.cos(a)
        if self.arrangement == "b_outside":
            return math.cos(b) * x + math.sin(b) * z, y, math.cos(b) * z - math.sin(b) * x
        return math.cos(b) * x - math.sin(b) * y, math.sin(b) * x + math.cos(b) * y, z

    def derivative(self, axes: Vector) -> Matrix:
        """Return the derivative: that of the direction by the drives, taken back; huge on the edge of the reach."""
        result: Matrix = np.eye(5)
        if self.arrangement == "upright":  # the cardanic head, its two axes in the other order
            result[_ROTARY] = SpatialAnglesMap.of(self.tilt_deg).dq_daxes(axes)[_ROTARY][::-1]
            return result
        at = self.drives(axes)
        c, a = (rad_from_deg(float(angle)) for angle in axes[_ROTARY])
        c -= rad_from_deg(self.mounting_deg)
        by_c = (math.cos(c) * math.sin(a), math.sin(c) * math.sin(a), 0.0)
        by_a = (math.sin(c) * math.cos(a), -math.cos(c) * math.cos(a), -math.sin(a))
        wanted = np.array([by_c, by_a]).T
        columns = [np.cross(axis, self.direction(at)) for axis in self._turns(at)]
        result[_ROTARY, _ROTARY] = np.linalg.pinv(np.array(columns).T) @ wanted
        return result

    def _turns(self, drives: Vector) -> tuple[Vector, Vector]:
        """Return the directions of machine axes A and B at drive values, seen from the cutting head."""
        cosine, sine = cos_sin_deg(self.tilt_deg)
        a, b = (rad_from_deg(float(angle)) for angle in drives[_ROTARY])
        u = np.array([sine, 0.0, cosine])
        if self.arrangement == "b_outside":
            return rot_y(deg_from_rad(b)) @ u, np.array([0.0, 1.0, 0.0])
        across = np.array([-cosine, 0.0, sine])  # u × e_y: Rot(u, a) turns e_y towards it
        return u, math.cos(a) * np.array([0.0, 1.0, 0.0]) + math.sin(a) * across

    def refusal(self, axes: Vector) -> ChainbuildError | None:
        """Return the error of a direction that the head cannot lean to, or None."""
        if np.isfinite(self.drives(axes)).all():
            return None
        c, a = self.names
        wanted = f"{a} = {axes[_INNER]:g} deg at {c} = {axes[_OUTER]:g} deg"
        return AxisValueError(
            f"the machine axes A and B cannot lean the tool by {wanted}",
            parameter=a,
            permitted=f"what HD7 = {self.tilt_deg:g} deg reaches by convention kin76_machine_axes={self.arrangement}",
        )

    def named(self, names: Sequence[str]) -> BevelDrives:
        """Return the drives that name the programmed axes by other names."""
        return replace(self, names=(names[_OUTER], names[_INNER]))


def _arc_sine(sine: float) -> float:
    """Return an arc sine, not a number beyond 1; rounding is no excess."""
    return math.asin(max(-1.0, min(1.0, sine))) if abs(sine) <= 1.0 + _REACH_SLACK else math.nan
