"""Point-vector programming (#ORI MODE): a vector and one more condition make an orientation. Data and maths.

The vector v is what a column e of the rotation R (tool in workpiece) points along; a turn about v is left open. Either
condition of the controller closes it by a second direction b of the tool, perpendicular to v and to a pole p:

    R·e = v,   R·b = ±(p × v) / |p × v|

- The last angle kept, which turns about e: p is the axis of the first factor, b that of the middle one, turned back.
- The first angle kept, where the last one turns about another axis than e: p is the axis of the middle factor, turned
  by the first, b the axis of the last.
- TOOL_AX_IN_PLANE 1: p is Y, b the tool's Z; 2: p is X, b the tool's Y.

Both signs are solutions, half a turn about v apart; the one nearer to the rotation before is taken. Where v is along
the pole every turn is one, and the rotation before is swung to v without a turn about it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from chainbuild import tolerances
from chainbuild.arrays import Matrix, Vector
from chainbuild.errors import ChainbuildError
from chainbuild.frames import AxisLetter, angle_mode_named, angles_from_matrix, is_rigid, rot_x, rot_y, rot_z, transform
from chainbuild.shown import fields_shown

OriMode = Literal["angle", "vector_abc", "vector_ijk"]
AngleLetter = Literal["A", "B", "C"]
ToolPlane = Literal[0, 1, 2]

VECTOR_COLUMNS: Final = ("ori_x", "ori_y", "ori_z")
# FIXED_AX_IDX of each angle: the axes of the program are X, Y, Z, A, B, C.
FIXED_AXIS_INDEX: Final[Mapping[AngleLetter, int]] = MappingProxyType({"A": 3, "B": 4, "C": 5})
# TOOL_AX_IN_PLANE → the axis of the workpiece frame that is normal to the plane, the tool axis that lies in it.
TOOL_PLANES: Final[Mapping[int, tuple[AxisLetter, AxisLetter]]] = MappingProxyType({1: ("y", "z"), 2: ("x", "y")})
BOTH_SET_ALARM: Final = 22027

_SHOWN: Final = 100  # characters of a refused value in a message
_UNITS: Final = dict(zip("xyz", np.eye(3), strict=True))
_TURNS: Final = {"x": rot_x, "y": rot_y, "z": rot_z}


@dataclass(frozen=True, slots=True)
class VectorProgramming:
    """How a program states orientations: #ORI MODE, or ori.mode and its neighbours in the channel list.

    Attributes:
        mode: What the program's words mean: angles, or a vector in A, B, C or in I, J, K.
        fixed: The angle that is kept (FIXED_AX_IDX, P-CHAN-00178); None: the one that leaves the vector free, unless a
            plane is given.
        plane: TOOL_AX_IN_PLANE (P-CHAN-00436): 1 the tool's Z is parallel to the ZX plane, 2 its Y to the YZ plane,
            0 neither.
        axis: The axis of the tool frame that the vector is.

    Raises:
        ChainbuildError: an unknown value, or both an angle and a plane.
    """

    __repr__ = fields_shown

    mode: OriMode = "angle"
    fixed: AngleLetter | None = None
    plane: ToolPlane = 0
    axis: Literal["x", "z"] = "x"

    def __post_init__(self) -> None:
        _among("mode", self.mode, get_args(OriMode))
        _among("fixed", self.fixed, (None, *get_args(AngleLetter)))
        _among("plane", self.plane, get_args(ToolPlane))
        _among("axis", self.axis, ("x", "z"))
        if self.fixed and self.plane:
            raise ChainbuildError(
                f"an angle ({self.fixed}) and a plane ({self.plane}) are both given", parameter="fixed, plane",
                permitted="one of them", alarm=BOTH_SET_ALARM,
            )  # fmt: skip


def _among(name: str, value: Any, permitted: tuple[Any, ...]) -> None:
    if value not in permitted:
        shown = ", ".join(map(repr, permitted))
        raise ChainbuildError(f"{name} is {value!r}", parameter=name, permitted=shown)


def free_angle(angle_mode: str, axis: Literal["x", "z"] = "x") -> AngleLetter:
    """Return the angle that can be kept while the other two point the vector anywhere; there is exactly one.

    It is that of the last factor where this turns about the vector's own axis. Else it is that of the first: the last
    turn moves the vector on a great circle through the axis of the middle one, which sweeps it over the sphere.

    >>> [free_angle(mode) for mode in ("ypr", "cba", "cab", "cba_std", "abc", "euler_c_first")]
    ['A', 'C', 'C', 'A', 'A', 'C']

    Args:
        angle_mode: Name in `frames.ANGLE_MODES`.
        axis: The axis of the tool frame that the vector is.
    """
    first, _, last = angle_mode_named(angle_mode).factors
    letters: dict[str, AngleLetter] = {letter: letter for letter in FIXED_AXIS_INDEX}
    return letters[last[1] if last[0] == axis else first[1]]


def check_condition(how: VectorProgramming, angle_mode: str) -> None:
    """Refuse a kept angle or a plane that does not go with every vector.

    Raises:
        ChainbuildError: with what would do.
    """
    if how.plane and TOOL_PLANES[how.plane][1] == how.axis:
        others = [str(plane) for plane, (_, inside) in TOOL_PLANES.items() if inside != how.axis]
        raise ChainbuildError(
            f"TOOL_AX_IN_PLANE={how.plane} is about the tool's {how.axis.upper()}, which is the vector itself",
            parameter="TOOL_AX_IN_PLANE", permitted=", ".join(others),
            hint="convention ori_vector_axis says which axis of the tool the vector is",
        )  # fmt: skip
    free = free_angle(angle_mode, how.axis)
    if how.fixed not in (None, free):
        meaning = angle_mode_named(angle_mode).meaning
        raise ChainbuildError(
            f"FIXED_AX_IDX={FIXED_AXIS_INDEX[how.fixed]} keeps angle {how.fixed}; the other two of {meaning} do not"
            f" point the tool's {how.axis.upper()} in every direction",
            parameter="FIXED_AX_IDX", permitted=f"{FIXED_AXIS_INDEX[free]} (angle {free})",
        )  # fmt: skip


def kept_angle(how: VectorProgramming, angle_mode: str, R: Matrix) -> float:
    """Return the value [deg] in a rotation (3, 3) of the angle that vector programming keeps.

    Values half a turn apart mean the same. At gimbal lock it cannot be told from the rotation: take it earlier.
    """
    letter = how.fixed or free_angle(angle_mode, how.axis)
    return angles_from_matrix(angle_mode, R)["ABC".index(letter)]


def rotation_from_vector(
    how: VectorProgramming, angle_mode: str, vector: ArrayLike, before: Matrix, *, kept_deg: float | None = None
) -> Matrix:
    """Return the rotation (3, 3), tool in workpiece frame, that a programmed vector means.

    Of the two solutions the nearer to the rotation before is returned. Where the vector leaves the turn about it open,
    it is the rotation before, swung to the vector the shortest way; to the opposite vector, about the tool's Y.

    >>> how = VectorProgramming(plane=1)
    >>> rotation_from_vector(how, "ypr", (3.0, 0.0, 4.0), np.eye(3)).round(12)
    array([[ 0.6,  0. , -0.8],
           [ 0. ,  1. ,  0. ],
           [ 0.8,  0. ,  0.6]])

    Args:
        how: The condition; its mode does not matter here.
        angle_mode: Name in `frames.ANGLE_MODES` of the machine's pose angles.
        vector: (3,) of any length but zero.
        before: (3, 3) rotation of the row before, or of the start.
        kept_deg: Value of the kept angle [deg], that at #TRAFO ON; None: its value in the rotation before. Along a path
            through gimbal lock it must be given, because there the rotation alone does not tell it.

    Raises:
        ChainbuildError: the condition does not go with every vector, the vector is zero or not finite, or `before` is
            no rotation.
    """
    check_condition(how, angle_mode)
    v, before = _direction(vector), _rotation(before)
    e = _UNITS[how.axis]
    pole, b = _condition(how, angle_mode, before, kept_deg)
    n = _cross(pole, v)
    if math.sqrt(n @ n) < tolerances.GIMBAL_LOCK:
        return _swung(e, v, before)
    n -= v * (v @ n)  # close to the pole rounding has left a part along v
    n /= math.sqrt(n @ n)
    tool, ahead = np.array([e, b, _cross(e, b)]), np.array([v, n, _cross(v, n)])
    gain, _ = _gains(tool, ahead, before)
    if gain < -tolerances.ANGLE_NOISE:
        ahead[1:] *= -1.0
    R: Matrix = ahead.T @ tool
    return R


def _condition(
    how: VectorProgramming, angle_mode: str, before: Matrix, kept_deg: float | None
) -> tuple[Vector, Vector]:
    """Return the pole p in the workpiece frame and the direction b in the tool frame."""
    if how.plane:
        normal, inside = TOOL_PLANES[how.plane]
        return _UNITS[normal], _UNITS[inside]
    kept = kept_angle(how, angle_mode, before) if kept_deg is None else kept_deg
    if not math.isfinite(kept):
        raise ChainbuildError(f"the kept angle is {kept}", parameter="kept_deg", permitted="a finite number")
    first, middle, last = angle_mode_named(angle_mode).factors
    if last[0] == how.axis:
        return _UNITS[first[0]], _TURNS[last[0]](last[2] * kept).T @ _UNITS[middle[0]]
    return _TURNS[first[0]](first[2] * kept) @ _UNITS[middle[0]], _UNITS[last[0]]


def _swung(e: Vector, v: Vector, before: Matrix) -> Matrix:
    """Return the rotation nearest to `before` whose column along e is v."""
    # As the direction beside v that of the tool axes which is farther from it; at the opposite vector both are, take Y.
    y, other = _UNITS["y"], _cross(e, _UNITS["y"])
    b = y if abs(v @ before @ y) <= abs(v @ before @ other) + tolerances.GIMBAL_LOCK else other
    n = before @ b
    n = n - v * (v @ n)
    n /= math.sqrt(n @ n)
    tool, ahead = np.array([e, b, _cross(e, b)]), np.array([v, n, _cross(v, n)])
    cosine, sine = _gains(tool, ahead, before)
    length = math.hypot(cosine, sine)
    if length > tolerances.GIMBAL_LOCK:
        turned = cosine / length * ahead[1] + sine / length * ahead[2]
        ahead = np.array([v, turned, _cross(v, turned)])
    R: Matrix = ahead.T @ tool
    return R


def _gains(tool: Matrix, ahead: Matrix, before: Matrix) -> tuple[float, float]:
    """Return what the trace of beforeᵀ·R grows by with the cosine and the sine of a turn about the vector.

    Args:
        tool: Rows e, b, e × b in the tool frame.
        ahead: Rows v, n, v × n in the workpiece frame, to which they are mapped.
        before: (3, 3) rotation.
    """
    M = ahead @ before @ tool.T
    return float(M[1, 1] + M[2, 2]), float(M[2, 1] - M[1, 2])


def _cross(a: Vector, b: Vector) -> Vector:
    # Plain floats: numpy's product takes ten times as long for two vectors.
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def _direction(vector: ArrayLike) -> Vector:
    """Return a vector of any length but zero, scaled to length 1."""
    v = _floats(vector, (3,), "vector", "three finite numbers that are not all zero")
    v = v / np.abs(v).max()  # first, so that no square overflows or vanishes
    direction: Vector = v / math.sqrt(v @ v)
    return direction


def _rotation(before: Matrix) -> Matrix:
    R = _floats(before, (3, 3), "before", "a rotation (3, 3)")
    if not is_rigid(transform(R)):
        raise ChainbuildError("the rotation before is no rotation", parameter="before", permitted="a rotation (3, 3)")
    return R


def _floats(values: ArrayLike, shape: tuple[int, ...], name: str, permitted: str) -> Matrix:
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.shape != shape or not np.isfinite(array).all() or not array.any():
        shown = " ".join(repr(values).split())[:_SHOWN]
        raise ChainbuildError(f"{name} is {shown}", parameter=name, permitted=permitted)
    return array
