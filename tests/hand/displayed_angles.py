"""Hand formulas of orientation angles and of vector programming, from the manuals and the specification alone.

P-CHAN-00112 (channel parameters), programming modes of the universal kinematic 91, #ORI MODE (its own text); "poses n"
is section n of the note on poses. numpy and math only. Units: mm and degrees. The first choice of an option is its
default; what an option does not settle is stated where it is used.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Pair = tuple[float, float]
X, Y, Z = np.eye(3)
UNIT = {"x": X, "y": Y, "z": Z}
LOCK = 1e-12  # a direction nearer to the outer axis than this leaves the outer angle free

OPTIONS: dict[str, tuple[str, ...]] = {
    "kin36_c": ("machine", "absolute"),  # C3 by name, or the tool's angle in XY
    "kin202_c": ("relative", "tool_vector", "pointing"),  # from the zero direction; tip to holder; holder to tip
    "kin208_angles": ("tool_vector", "pose"),  # tool = Rz(C)*Rx(A)*e_z, or C and A of P-CHAN-00112
    "kin213_bc": ("pose", "pitch_and_sum"),  # B, C of P-CHAN-00112, or pitch of the arm plane and sum of both Z turns
    "two_angle_tool": ("z", "as_91"),  # direction that modes 14, 15 of P-CHAN-00112 aim; as_91: X for 14, Y for 15
    "euler_letters": ("c_first", "a_first"),  # mode 1: Rz(C)*Ry(B)*Rz(A) or Rz(A)*Ry(B)*Rz(C)
    "four_axis_tool_dir": ("used", "ignored"),  # does TOOL_DIR shape the C of a four-axis ROBX
    "kin3_b_value": ("drive", "programmed"),
    "gear_flag_place": ("after_gear", "before_gear"),  # flags of 28 seen from the drive
    "kin59_zero_offset_place": ("after_conversion", "before_conversion"),
    "kin59_zero_offset_sign": ("plus", "minus"),
    "spatial_angle_offsets": ("after_conversion", "direction_exact"),  # 59, 60: inner offsets stay out of the drives
    "kin60_tilt_sign": ("plus", "minus"),
    "kin70_cv": ("programmed", "machine"),
    "kin70_angles_seen_from": ("head", "machine"),  # programmed B, A turn with HD14, or along machine axes
    "kin76_axes": ("b_outside", "a_outside", "vertical_outside", "mirror_pair"),
    "offset_inside_flag": ("outside", "inside"),  # type 45
}


def chosen(params: Mapping[str, Any] | None, name: str) -> str:
    """Return the choice of an option, its default where none is given."""
    value = (params or {}).get(name, OPTIONS[name][0])
    if value not in OPTIONS[name]:
        raise ValueError(f"{name}: {value!r} is none of {OPTIONS[name]}")
    return str(value)


def sind(deg: float) -> float:
    return math.sin(math.radians(deg))


def cosd(deg: float) -> float:
    return math.cos(math.radians(deg))


def atan2d(y: Any, x: Any) -> float:
    return math.degrees(math.atan2(y, x))


def rot(axis: Sequence[float] | Array, deg: float) -> Array:
    """Return the right-handed turn about a unit vector."""
    u = np.asarray(axis, dtype=np.float64)
    return cosd(deg) * np.eye(3) + (1.0 - cosd(deg)) * np.outer(u, u) + sind(deg) * np.cross(u, np.eye(3)).T


def wrap(deg: float, near: float = 0.0) -> float:
    """Return the same angle within (near - 180, near + 180]."""
    return near + 180.0 - (near + 180.0 - deg) % 360.0


def nearest(answers: Sequence[Sequence[float]], before: Sequence[float]) -> list[float]:
    """Return the answer with the smallest root of squares to the row before, each angle on the turn nearest to it."""
    moved = [[wrap(a, b) for a, b in zip(answer, before, strict=True)] for answer in answers]
    return min(moved, key=lambda answer: math.dist(answer, before))


def two_turns(u1: Array, u2: Array, e: Array, v: Array, free: float = 0.0) -> list[Pair]:
    """Return both answers (a, b) of v = Rot(u1, a)*Rot(u2, b)*e; none where v is out of reach.

    With v along u1 the angle a is free and takes the value `free`.
    """
    level = (u1 @ u2) * (u2 @ e)
    p, q = u1 @ e - level, u1 @ np.cross(u2, e)
    radius, middle = math.hypot(p, q), atan2d(q, p)
    share = (u1 @ v - level) / radius
    if abs(share) > 1.0 + 1e-9:
        return []
    aside = math.sqrt(max(0.0, float(1.0 - share * share)))
    if abs(level) < LOCK and abs(radius - 1.0) < LOCK:  # the same length, without the loss of digits near the lock
        aside = float(np.linalg.norm(np.cross(u1, v)))
    out = []
    for b in (middle + atan2d(aside, share), middle - atan2d(aside, share)):
        w, flat = rot(u2, b) @ e, v - (u1 @ v) * u1
        a = atan2d(u1 @ np.cross(w, flat), w @ flat)
        out.append((free if np.linalg.norm(np.cross(u1, v)) < LOCK else a, wrap(b)))
    return out


# --- Orientation angles, P-CHAN-00112 -------------------------------------------------------------------------------

SEQUENCES = {0: "Cz B-y Ax", 1: "Cz By Az", 2: "Az By Cx", 3: "Cz Ax By", 4: "Cz By Ax", 5: "Ax By Cz"}
PAIRS = {14: "Ax By x", 15: "By Ax y", 16: "Ax Cz x", 17: "Cz Ax z", 18: "By Cz y", 19: "Cz By z", 20: "Ax By z"}
PAIRS[21] = "By Ax z"
Turn = tuple[str, Array]


def turns(mode: int, params: Mapping[str, Any] | None = None) -> list[Turn]:
    """Return letter and axis of the turns of P-CHAN-00112, outermost first; B of mode 0 turns about -Y."""
    words = (SEQUENCES | {14: "Ax By", 15: "By Ax"}).get(mode)
    if words is None:
        raise ValueError(f"angle mode {mode} has no sequence of its own (-1 passes the angles through)")
    if mode == 1 and chosen(params, "euler_letters") == "a_first":
        words = "Az By Cz"
    return [(word[0], -UNIT[word[-1]] if "-" in word else UNIT[word[-1]]) for word in words.split()]


def rotation_of_angles(mode: int, angles: Mapping[str, float], params: Mapping[str, Any] | None = None) -> Array:
    """Return R (tool in workpiece) of the angles A, B, C (P-CHAN-00112); missing letters are 0."""
    out = np.eye(3)
    for letter, axis in turns(mode, params):
        out = out @ rot(axis, angles.get(letter, 0.0))
    return out


def angles_of_rotation(
    mode: int,
    R: Array,
    params: Mapping[str, Any] | None = None,
    before: Mapping[str, float] | None = None,
    *,
    keep: str = "third",
) -> dict[str, float]:
    """Return A, B, C of R (P-CHAN-00112); modes 14 and 15 only their two letters, of the direction `two_angle_tool`.

    Of the two answers the nearer to `before`, else the middle angle in [-90, 90] (Euler: [0, 180]); modes 14, 15: the
    one whose rotation is nearer to R. Gimbal rule: at the lock only a sum of two angles is fixed; the third turn
    (`keep="first"`: the first one) keeps its value before, 0 without one, and the other takes the rest.
    """
    steps = turns(mode, params)
    letters, axes = [s[0] for s in steps], [s[1] for s in steps]
    old = None if before is None else [before[letter] for letter in letters]
    if len(steps) == 2:
        e = Z if chosen(params, "two_angle_tool") == "z" else axes[0]
        pairs = two_turns(axes[0], axes[1], e, R @ e, old[0] if old else 0.0)
        best = max(pairs, key=lambda pair: np.trace(R.T @ rot(axes[0], pair[0]) @ rot(axes[1], pair[1])))
        return dict(zip(letters, nearest(pairs, old) if old else best, strict=True))
    u1, u2, u3 = axes
    answers = []
    for a, b in two_turns(u1, u2, u3, R @ u3):
        rest = rot(u2, -b) @ rot(u1, -a) @ R
        c = atan2d(u3 @ np.cross(u2, rest @ u2), u2 @ rest @ u2)
        if np.linalg.norm(np.cross(u1, R @ u3)) < LOCK:
            sense = 1.0 if u1 @ rot(u2, b) @ u3 > 0 else -1.0
            kept = 0.0 if old is None else old[2 if keep == "third" else 0]
            answers.append((sense * (c - kept), b, kept) if keep == "third" else (kept, b, c - sense * kept))
        else:
            answers.append((a, b, c))
    if old is not None:
        return dict(zip(letters, nearest(answers, old), strict=True))
    measure = sind if abs(u1 @ u3) > 0.5 else cosd
    best_answer = max(answers, key=lambda answer: measure(answer[1]))
    return {letter: wrap(value) for letter, value in zip(letters, best_answer, strict=True)}


def universal_angles(mode: int, v: Sequence[float] | Array, before: Sequence[float] | None = None) -> Pair:
    """Return the two angles of 91's programming modes 14 to 21: tool = R1*R2*e (poses 1).

    Two answers: the nearer to the row before, else the first angle in (-90, 90]; at the pole the free angle stays.
    """
    first, second, e = PAIRS[mode].split()
    unit = np.asarray(v, dtype=np.float64) / np.linalg.norm(v)
    pairs = two_turns(UNIT[first[1]], UNIT[second[1]], UNIT[e], unit, before[0] if before else 0.0)
    if before is not None:
        a, b = nearest(pairs, before)
        return a, b
    rounded = [(wrap(round(a, 9) + 0.0) if abs(abs(a) - 90.0) < 1e-9 else a, b) for a, b in pairs]
    return next(pair for pair in rounded if -90.0 < pair[0] <= 90.0)


# --- Vector programming (#ORI MODE, poses 3) ------------------------------------------------------------------------


def _without(mode: int, letter: str, value: float, e: Array, v: Array) -> tuple[Array, Array, Array, Array]:
    """Return u1, u2, e, v of the two turns that remain when one of the three keeps its value."""
    letters, (u1, u2, u3) = [s[0] for s in turns(mode)], [s[1] for s in turns(mode)]
    if letter == letters[0]:
        return u2, u3, e, rot(u1, -value) @ v
    if letter == letters[1]:
        turned = rot(u2, value)
        return u1, turned @ u3, turned @ e, v
    return u1, u2, rot(u3, value) @ e, v


def free_letters(mode: int, vector_axis: str = "x") -> list[str]:
    """Return the letters that leave every vector within reach when they keep any value (tested at one odd value)."""
    out = []
    for letter, _ in turns(mode):
        u1, u2, e, _ = _without(mode, letter, 37.0, UNIT[vector_axis], X)
        if abs(u1 @ u2) < LOCK and abs(u2 @ e) < LOCK:
            out.append(letter)
    return out


def rotation_from_vector(
    mode: int,
    vector: Sequence[float] | Array,
    kept_letter: str,
    kept_value: float,
    *,
    R_before: Array | None = None,
    vector_axis: str = "x",
) -> Array:
    """Return R whose tool axis `vector_axis` lies along the vector while one angle of the mode keeps its value.

    A letter that does not leave the vector free is a ValueError that says which would do. Of the two answers the one
    nearer to `R_before`, else the inner of the two sought angles in [-90, 90]. Where the outer one is free it is the
    one nearest to `R_before`, else 0.
    """
    if kept_letter not in free_letters(mode, vector_axis):
        raise ValueError(
            f"mode {mode}: kept angle {kept_letter} binds the vector; {free_letters(mode, vector_axis)} does not"
        )
    if np.linalg.norm(vector) == 0.0:
        raise ValueError("the vector must not be zero")
    e, v = UNIT[vector_axis], np.asarray(vector, dtype=np.float64) / np.linalg.norm(vector)
    letters, axes = [s[0] for s in turns(mode)], [s[1] for s in turns(mode)]
    u1, u2, e_left, v_left = _without(mode, kept_letter, kept_value, e, v)
    at = letters.index(kept_letter)
    answers = []
    for a, b in two_turns(u1, u2, e_left, v_left):
        values = [a, b]
        values.insert(at, kept_value)
        R = np.linalg.multi_dot([rot(axis, value) for axis, value in zip(axes, values, strict=True)])
        if R_before is not None and np.linalg.norm(np.cross(u1, v_left)) < LOCK:
            outer = rot(axes[0], kept_value) @ u1 if at == 0 else u1
            R = rot(outer, _best_turn(outer, R @ R_before.T)) @ R
        answers.append((cosd(b) if R_before is None else np.trace(R_before.T @ R), R))
    best: Array = max(answers, key=lambda answer: answer[0])[1]
    return best


def _best_turn(u: Array, N: Array) -> float:
    """Return the angle about u that makes the trace of Rot(u, angle)*N largest."""
    return atan2d(float(np.trace(np.cross(u, np.eye(3)).T @ N)), float(np.trace(N) - u @ N @ u))


def rotation_in_plane(vector: Sequence[float] | Array, plane: int, R_before: Array) -> Array:
    """Return R with tool X along the vector and tool Z parallel to ZX (plane 1) or tool Y parallel to YZ (plane 2).

    P-CHAN-00436; of the two such rotations the nearer to the one before. With X along +-Y (plane 1) or +-X (plane 2)
    every spin will do: the rotation before is carried over by the shortest turn of its X onto the vector.
    """
    x = np.asarray(vector, dtype=np.float64) / np.linalg.norm(vector)
    normal = {1: Y, 2: X}[plane]
    aside = np.cross(normal, x)
    if np.linalg.norm(aside) < 1e-9:
        old = R_before[:, 0]
        axis = np.cross(old, x)
        if np.linalg.norm(axis) < 1e-12:
            return R_before if old @ x > 0 else rot(R_before[:, 2], 180.0) @ R_before
        return rot(axis / np.linalg.norm(axis), atan2d(float(np.linalg.norm(axis)), float(old @ x))) @ R_before
    aside = aside / np.linalg.norm(aside)
    found = []
    for side in (aside, -aside):
        y, z = (np.cross(side, x), side) if plane == 1 else (side, np.cross(x, side))
        found.append(np.column_stack((x, y, z)))
    return max(found, key=lambda R: np.trace(R_before.T @ R))
