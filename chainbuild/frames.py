"""Frames: the only place where angles become rotations, and rotations angles.

All angles are degrees here, because machine data and programs are. Rotations are 3×3, transforms 4×4 arrays.
`R_a_b` maps coordinates in b to coordinates in a; products read along the chain from left to right.

>>> rot_z(90.0) @ [1.0, 0.0, 0.0]
array([0., 1., 0.])
>>> f_frame((0.0, 0.0, 0.0), (-90.0, 90.0, -90.0))[:3, 0]  # X of the new frame, seen in the old one: -Z
array([ 0.,  0., -1.])
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild import tolerances
from chainbuild.arrays import Matrix
from chainbuild.errors import ChainbuildError

AxisLetter = Literal["x", "y", "z"]

_INDEX: Final = {"x": 0, "y": 1, "z": 2}
# Cosine and sine of 0, 90, 180, 270 degrees, exactly.
_RIGHT_ANGLES: Final = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))


def cos_sin_deg(angle_deg: float) -> tuple[float, float]:
    """Return cosine and sine of an angle in degrees, exact at multiples of 90°."""
    quarter = round(angle_deg / 90.0)
    if abs(angle_deg - 90.0 * quarter) <= tolerances.RIGHT_ANGLE_DEG:
        return _RIGHT_ANGLES[quarter % 4]
    angle = math.radians(angle_deg)
    return math.cos(angle), math.sin(angle)


def rot_x(angle_deg: float) -> Matrix:
    """Return the rotation about X, angle in degrees."""
    c, s = cos_sin_deg(angle_deg)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def rot_y(angle_deg: float) -> Matrix:
    """Return the rotation about Y, angle in degrees."""
    c, s = cos_sin_deg(angle_deg)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def rot_z(angle_deg: float) -> Matrix:
    """Return the rotation about Z, angle in degrees."""
    c, s = cos_sin_deg(angle_deg)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


_ROTATIONS: Final = {"x": rot_x, "y": rot_y, "z": rot_z}


def rot_about(direction: ArrayLike, angle_deg: float) -> Matrix:
    """Return the rotation about a direction of any length but zero, angle in degrees.

    >>> bool(np.allclose(rot_about((0, 0, 2), 30.0), rot_z(30.0)))
    True
    """
    x, y, z = unit(direction)
    c, s = cos_sin_deg(angle_deg)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    outer = np.outer((x, y, z), (x, y, z))
    return c * np.eye(3) + s * cross + (1.0 - c) * outer


def unit(direction: ArrayLike) -> Matrix:
    """Return a direction scaled to length 1.

    Raises:
        ChainbuildError: the vector is zero or not finite.
    """
    vector = np.asarray(direction, dtype=float)
    norm = float(np.linalg.norm(vector))
    if not math.isfinite(norm) or norm < tolerances.ZERO_VECTOR:
        raise ChainbuildError(f"a direction must be a finite vector other than zero, not {vector.tolist()}")
    return vector / norm


_IDENTITY: Final = np.eye(4)  # copied in a quarter of the time that making it takes


def transform(rotation: ArrayLike | None = None, position: ArrayLike = (0.0, 0.0, 0.0)) -> Matrix:
    """Return the 4×4 transform of a rotation (3×3, default 1) and a position (3)."""
    result = _IDENTITY.copy()
    if rotation is not None:
        result[:3, :3] = rotation
    result[:3, 3] = position
    return result


def translation(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Matrix:
    """Return the 4×4 transform that only translates."""
    return transform(None, (x, y, z))


def inverse(T: Matrix) -> Matrix:
    """Return the inverse of a rigid 4×4 transform."""
    rotation = T[:3, :3].T
    return transform(rotation, -rotation @ T[:3, 3])


def is_rigid(T: Matrix, tolerance: float = tolerances.ROTATION_MATRIX) -> bool:
    """Return whether a (4, 4) array is a rigid transform: right-handed rotation, finite position, last row 0 0 0 1.

    Args:
        T: The array.
        tolerance: How far an element of Rᵀ·R may be from that of the identity.
    """
    # Plain floats: they are few, and every pose that is solved for passes here.
    (a, b, c, x), (d, e, f, y), (g, h, i, z), last = T.tolist()
    rigid: bool = (
        abs(a * a + d * d + g * g - 1.0) < tolerance
        and abs(b * b + e * e + h * h - 1.0) < tolerance
        and abs(c * c + f * f + i * i - 1.0) < tolerance
        and abs(a * b + d * e + g * h) < tolerance
        and abs(a * c + d * f + g * i) < tolerance
        and abs(b * c + e * f + h * i) < tolerance
        and a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) > 0.0
        and abs(x) < tolerances.HUGE_POSITION_M  # one by one: the largest of several numbers may hide NaN
        and abs(y) < tolerances.HUGE_POSITION_M
        and abs(z) < tolerances.HUGE_POSITION_M
        and last == [0.0, 0.0, 0.0, 1.0]
    )
    return rigid


def rigid_rows(T: Matrix) -> NDArray[np.bool_]:
    """Return which of many arrays (N, 4, 4) are rigid transforms (N,): `is_rigid` over arrays."""
    R = T[:, :3, :3]
    with np.errstate(invalid="ignore", over="ignore"):
        off = np.abs(R.transpose(0, 2, 1) @ R - np.eye(3)).max(axis=(1, 2), initial=0.0)
        rigid: NDArray[np.bool_] = (off < tolerances.ROTATION_MATRIX) & (np.linalg.det(R) > 0.0)
        rigid &= (np.abs(T[:, :3, 3]) < tolerances.HUGE_POSITION_M).all(axis=1)
        rigid &= (T[:, 3] == (0.0, 0.0, 0.0, 1.0)).all(axis=1)
    return rigid


def f_frame(position: Sequence[float], rpy_deg: Sequence[float]) -> Matrix:
    """Return ROBX's frame F(POS, RPY) = Trans(POS)·Rz(RPY[0])·Ry(RPY[1])·Rx(RPY[2]) (ROBX manual 4.2).

    Args:
        position: x, y, z, in any unit of length, which the result keeps.
        rpy_deg: Angles A, B, C in degrees.
    """
    return transform(rot_z(rpy_deg[0]) @ rot_y(rpy_deg[1]) @ rot_x(rpy_deg[2]), position)


def dh_link(d: float, a: float, alpha_deg: float) -> Matrix:
    """Return Tz(d)·Tx(a)·Rx(alpha), the fixed part of a standard Denavit-Hartenberg link.

    >>> dh_link(1.0, 2.0, 0.0)[:3, 3]
    array([2., 0., 1.])
    """
    return transform(rot_x(alpha_deg), (a, 0.0, d))


@dataclass(frozen=True, slots=True)
class AngleMode:
    """How three angles A, B, C make a rotation: factors from left to right.

    Attributes:
        name: Key in `ANGLE_MODES`.
        factors: Three of (axis, letter, sign): the angle of that letter, times sign, turns about that axis.
        meaning: The product in writing.
    """

    name: str
    factors: tuple[tuple[AxisLetter, str, int], ...]
    meaning: str


def _mode(name: str, meaning: str, *factors: tuple[AxisLetter, str, int]) -> tuple[str, AngleMode]:
    return name, AngleMode(name, factors, meaning)


# ORIRPY, ORIRPY2: ROBX manual 6.1.3. The others: P-CHAN-00112, whose number is given in ANGLE_MODE_NUMBERS.
ANGLE_MODES: Final[Mapping[str, AngleMode]] = MappingProxyType(
    dict(
        [
            _mode("orirpy", "Rz(A)·Ry(B)·Rx(C)", ("z", "A", 1), ("y", "B", 1), ("x", "C", 1)),
            _mode("orirpy2", "Rx(A)·Ry(B)·Rz(C)", ("x", "A", 1), ("y", "B", 1), ("z", "C", 1)),
            _mode("ypr", "Rz(C)·Ry(-B)·Rx(A)", ("z", "C", 1), ("y", "B", -1), ("x", "A", 1)),
            _mode("euler_a_first", "Rz(A)·Ry(B)·Rz(C)", ("z", "A", 1), ("y", "B", 1), ("z", "C", 1)),
            _mode("euler_c_first", "Rz(C)·Ry(B)·Rz(A)", ("z", "C", 1), ("y", "B", 1), ("z", "A", 1)),
            _mode("cba", "Rz(A)·Ry(B)·Rx(C)", ("z", "A", 1), ("y", "B", 1), ("x", "C", 1)),
            _mode("cab", "Rz(C)·Rx(A)·Ry(B)", ("z", "C", 1), ("x", "A", 1), ("y", "B", 1)),
            _mode("cba_std", "Rz(C)·Ry(B)·Rx(A)", ("z", "C", 1), ("y", "B", 1), ("x", "A", 1)),
            _mode("abc", "Rx(A)·Ry(B)·Rz(C)", ("x", "A", 1), ("y", "B", 1), ("z", "C", 1)),
            _mode("ab", "Rx(A)·Ry(B), C follows", ("x", "A", 1), ("y", "B", 1), ("z", "C", 1)),
            _mode("ba", "Ry(B)·Rx(A), C follows", ("y", "B", 1), ("x", "A", 1), ("z", "C", 1)),
        ]
    )
)

# P-CHAN-00112 (ori_rotation_angle) → angle mode; 1 (Euler) is decided by the convention `euler_letters`.
ANGLE_MODE_NUMBERS: Final[Mapping[int, str]] = MappingProxyType(
    {0: "ypr", 2: "cba", 3: "cab", 4: "cba_std", 5: "abc", 14: "ab", 15: "ba"}
)


def angle_mode_named(name: str) -> AngleMode:
    """Return an angle mode by its name.

    Raises:
        ChainbuildError: there is none of that name.
    """
    try:
        return ANGLE_MODES[name]
    except KeyError:
        raise ChainbuildError(f"unknown angle mode '{name}'", permitted=", ".join(ANGLE_MODES)) from None


def matrix_from_angles(mode: str, angles_deg: Sequence[float]) -> Matrix:
    """Return the rotation that angles A, B, C (degrees) describe in an angle mode.

    P-CHAN-00112 itself states that A15 B-90 C20 in CBA is A20 B90 C15 in YPR:

    >>> cba = matrix_from_angles("cba", (15.0, -90.0, 20.0))
    >>> ypr = matrix_from_angles("ypr", (20.0, 90.0, 15.0))
    >>> bool(np.allclose(cba, ypr, atol=1e-15))
    True
    """
    by_letter = dict(zip("ABC", angles_deg, strict=True))
    result = np.eye(3)
    for axis, letter, sign in angle_mode_named(mode).factors:
        result = result @ _ROTATIONS[axis](sign * by_letter[letter])
    return result


def angles_from_matrix(mode: str, rotation: Matrix) -> tuple[float, float, float]:
    """Return angles A, B, C in degrees, each in (-180, 180], of a rotation in an angle mode.

    At gimbal lock the angle of the first factor is 0.

    >>> matrix = matrix_from_angles("orirpy2", (10.0, 20.0, 30.0))
    >>> [round(angle, 9) for angle in angles_from_matrix("orirpy2", matrix)]
    [10.0, 20.0, 30.0]
    """
    factors = angle_mode_named(mode).factors
    first, middle, last = (_INDEX[axis] for axis, _, _ in factors)
    raw = _proper_euler(rotation, first, middle) if first == last else _tait_bryan(rotation, first, middle, last)
    letters = {letter: sign * math.degrees(angle) for (_, letter, sign), angle in zip(factors, raw, strict=True)}
    a, b, c = (_half_open(letters[letter]) for letter in "ABC")
    return a, b, c


def _half_open(angle_deg: float) -> float:
    """Return an angle in (-180, 180] without a signed zero."""
    return 180.0 if angle_deg == -180.0 else angle_deg + 0.0


def _tait_bryan(R: Matrix, i: int, j: int, k: int) -> tuple[float, float, float]:
    """Return the angles about three different axes i, j, k, intrinsic; the middle one within ±90°."""
    parity = 1.0 if (j - i) % 3 == 1 else -1.0
    cosine = math.hypot(R[i, i], R[i, j])
    middle = math.atan2(parity * R[i, k], cosine)
    if cosine < tolerances.GIMBAL_LOCK:
        return 0.0, middle, math.atan2(parity * R[j, i], R[j, j])
    return math.atan2(-parity * R[j, k], R[k, k]), middle, math.atan2(-parity * R[i, j], R[i, i])


def _proper_euler(R: Matrix, i: int, j: int) -> tuple[float, float, float]:
    """Return the angles about i, j, i, intrinsic; the middle one within 0…180°."""
    k = 3 - i - j
    parity = 1.0 if (j - i) % 3 == 1 else -1.0
    sine = math.hypot(R[j, i], R[k, i])
    middle = math.atan2(sine, R[i, i])
    if sine < tolerances.GIMBAL_LOCK:
        # With the first angle 0, row j of the product is row j of the last rotation.
        return 0.0, middle, math.atan2(-parity * R[j, k], R[j, j])
    return math.atan2(R[j, i], -parity * R[k, i]), middle, math.atan2(R[i, j], parity * R[i, k])


def quaternion_from_matrix(R: Matrix) -> tuple[float, float, float, float]:
    """Return the unit quaternion x, y, z, w with w ≥ 0 of a rotation.

    >>> quaternion_from_matrix(rot_x(180.0))
    (1.0, 0.0, 0.0, 0.0)
    """
    squares = np.array(
        [
            1.0 + R[0, 0] - R[1, 1] - R[2, 2],
            1.0 - R[0, 0] + R[1, 1] - R[2, 2],
            1.0 - R[0, 0] - R[1, 1] + R[2, 2],
            1.0 + R[0, 0] + R[1, 1] + R[2, 2],
        ]
    )
    sums = {
        (0, 1): R[0, 1] + R[1, 0],
        (0, 2): R[0, 2] + R[2, 0],
        (1, 2): R[1, 2] + R[2, 1],
        (0, 3): R[2, 1] - R[1, 2],
        (1, 3): R[0, 2] - R[2, 0],
        (2, 3): R[1, 0] - R[0, 1],
    }
    best = int(np.argmax(squares))
    raw = [squares[best] if n == best else sums[(min(n, best), max(n, best))] for n in range(4)]
    norm = math.copysign(math.sqrt(math.fsum(c * c for c in raw)), raw[3] or 1.0)
    x, y, z, w = (float(c / norm) + 0.0 for c in raw)
    return x, y, z, w


def matrix_from_quaternion(quaternion: Sequence[float]) -> Matrix:
    """Return the rotation of a quaternion x, y, z, w of any length but zero.

    >>> (matrix_from_quaternion((0.0, 0.0, 1.0, 1.0)) @ [1.0, 0.0, 0.0]).round(15)
    array([0., 1., 0.])
    """
    x, y, z, w = unit(quaternion)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def urdf_rpy(R: Matrix, written: Callable[[float], float] = float) -> tuple[float, float, float]:
    """Return URDF's roll, pitch, yaw in radians: R = Rz(yaw)·Ry(pitch)·Rx(roll), exact also close to pitch ±90°.

    There roll and yaw are ill-conditioned separately, but not together. Yaw is therefore rounded as it will be written;
    pitch and roll follow from the remaining rotation, so that roll compensates the rounding of yaw.

    Args:
        R: (3, 3) rotation.
        written: Rounds an angle to the digits that the file keeps.
    """
    c, s = float(R[0, 0]), float(R[1, 0])
    yaw = written(_half_open_rad(math.atan2(s, c))) if math.hypot(c, s) > tolerances.ANGLE_NOISE else 0.0
    cy, sy = math.cos(yaw), math.sin(yaw)
    rest = np.array([[cy, sy, 0.0], [-sy, cy, 0.0], [0.0, 0.0, 1.0]]) @ R
    return _half_open_rad(math.atan2(-rest[1, 2], rest[1, 1])), math.atan2(-rest[2, 0], rest[0, 0]), yaw


def _half_open_rad(angle: float) -> float:
    """Return pi for an angle that rounding noise has moved to -pi."""
    return math.pi if angle < tolerances.ANGLE_NOISE - math.pi else angle
