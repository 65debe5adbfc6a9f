"""Hand formulas of what a control shows of a pose: columns, orientation angles, drives, status and turn, vectors.

Written from the manuals and the specification alone: "poses n" is section n of the note on poses, "KIN n" of the
German manual of kinematic transformations, "ROBX n" of the ROBX manual. numpy and math only. Units: mm and degrees.
HD values are plain mm, degrees or flags by their printed number. The first choice of an option is its default.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from .displayed_angles import (
    OPTIONS,
    PAIRS,
    Array,
    Pair,
    X,
    Y,
    Z,
    angles_of_rotation,
    atan2d,
    chosen,
    cosd,
    free_letters,
    nearest,
    rot,
    rotation_from_vector,
    rotation_in_plane,
    rotation_of_angles,
    sind,
    turns,
    two_turns,
    universal_angles,
    wrap,
)

__all__ = [
    "OPTIONS",
    "angles_of_rotation",
    "displayed",
    "displayed_robx",
    "drives_3",
    "drives_28",
    "drives_59",
    "drives_60",
    "drives_70",
    "drives_76",
    "free_letters",
    "rotation_from_vector",
    "rotation_in_plane",
    "rotation_of_angles",
    "status_turn_45",
    "universal_angles",
    "wrist_45",
]

# --- Columns of a pose (poses 1) ------------------------------------------------------------------------------------

# Channel letters of the rotary axes after the first three axes (KIN 2, twincat-types); 28 prints C1 and A2 as well.
ROTARY = {
    **dict.fromkeys((3, 4), "B"), **dict.fromkeys((5, 6, 7, 8, 34, 207), "C"), 30: "A",
    **dict.fromkeys((2, 11, 22, 23, 52, 61, 63, 80), "A B"), **dict.fromkeys((16, 81), "B A"),
    **dict.fromkeys((1, 57), "B C"),
    **dict.fromkeys((9, 10, 25, 28, 33, 59), "C A"), 58: "A C", 60: "C B", 64: "C1 A C2", 70: "B A CV", 82: "B C A",
    209: "A C", **dict.fromkeys((13, 14, 17, 18, 85, 203, 205), ""),
}  # fmt: skip


def _angle_columns(mode: int, R: Array, params: Mapping[str, Any], letters: str = "ABC") -> dict[str, float]:
    """Return `a_deg` ... of P-CHAN-00112; mode -1 needs `pass_through_as`, the mode whose order the angles follow."""
    before = params.get("before")
    old = None if before is None else {k: before.get(f"{k.lower()}_deg", 0.0) for k in "ABC"}
    found = angles_of_rotation(params.get("pass_through_as", -1) if mode == -1 else mode, R, params, old)
    return {f"{k.lower()}_deg": found[k] for k in letters if k in found}


def _palletiser_columns(R: Array, p: Sequence[float] | Array) -> dict[str, float]:
    """Return B, C of 213 with R = Rz(a1)*Ry(B)*Rz(C - a1): B = 0 is the level flange for every C (KIN 3.6).

    a1 is the side of the arm plane, taken from the azimuth of p; C does not depend on it.
    """
    away = math.atan2(p[1], p[0])
    pitch = atan2d(math.cos(away) * R[0, 2] + math.sin(away) * R[1, 2], R[2, 2])
    return {"b_deg": pitch, "c_deg": atan2d(R[1, 0] - R[0, 1], R[0, 0] + R[1, 1])}


def _universal_columns(
    names: list[str], axes: Mapping[str, float], R: Array, mode: int, options: Mapping[str, Any]
) -> dict[str, float]:
    """Return the columns of 91: `programming_mode` wins over a P-CHAN-00112 value of 10 to 21 (poses 1)."""
    own = options.get("programming_mode", mode if mode >= 10 else None)
    if own is None:
        return {n: axes[n] for n in names[3:]} if options.get("rtcp", 0) == 1 else _angle_columns(mode, R, options)
    if own == 10:
        return dict(zip(("tool_x", "tool_y", "tool_z"), R[:, 2].tolist(), strict=True))
    if own in (12, 13):
        return {n: axes[n] for n in names[3:]}
    if own not in PAIRS:
        raise ValueError(f"programming mode {own} is refused")
    columns = [f"{word[0].lower()}_deg" for word in PAIRS[own].split()[:2]]
    before = options.get("before")
    pair = universal_angles(own, R[:, 2], None if before is None else [before[c] for c in columns])
    return dict(zip(columns, pair, strict=True))


def displayed(
    kin_typ: int,
    axes: Mapping[str, float],
    R: Array,
    p: Sequence[float] | Array,
    *,
    angle_mode: int = 0,
    params: Mapping[str, Any] | None = None,
) -> dict[str, float]:
    """Return the columns of a pose (poses 1; KIN 1, 4.1): x_mm, y_mm, z_mm, then what the type shows beside them.

    `axes` is in channel order, `R[:, 2]` the tool vector. `params` holds the options, `before` (columns of the row
    before), `hd10` (variant of 202), `rtcp` and `programming_mode` (91), `carrier` (type that carries 98).
    """
    options, names = params or {}, list(axes)
    if kin_typ == 98:
        return displayed(int(options["carrier"]), axes, R, p, angle_mode=angle_mode, params=params)
    out = dict(zip(("x_mm", "y_mm", "z_mm"), (float(value) for value in p), strict=True))
    if kin_typ in ROTARY:  # RTCP: the machine's own rotary axes by name
        shown = names[3:] if ROTARY[kin_typ] else []
        if len(shown) != len(ROTARY[kin_typ].split()):
            raise ValueError(f"type {kin_typ}: rotary axes {ROTARY[kin_typ]} expected, {names} given")
        return out | {name: axes[name] for name in shown}
    flat_deg = atan2d(R[1, 0], R[0, 0])
    if kin_typ == 36:
        return out | ({names[3]: axes[names[3]]} if chosen(params, "kin36_c") == "machine" else {"c_deg": flat_deg})
    if kin_typ == 202:  # KIN: C = 0 is parallel to X; at zero the tool vector is +X (LINKS) or -X (RECHTS)
        turned = {"relative": 180.0 * options.get("hd10", 0), "tool_vector": 0.0, "pointing": 180.0}
        return out | {"c_deg": wrap(atan2d(R[1, 2], R[0, 2]) - turned[chosen(params, "kin202_c")])}
    if kin_typ == 91:
        return out | _universal_columns(names, axes, R, angle_mode, options)
    if kin_typ in (12, 37):
        return out
    if kin_typ == 19:
        return out | dict(zip(("tool_x", "tool_y", "tool_z"), R[:, 2].tolist(), strict=True))
    if kin_typ in (21, 96):  # the tool stays upright
        return out | {"c_deg": flat_deg}
    if kin_typ == 76:  # KIN 2.34: R = Rz(C)*Rx(A)
        return out | {"c_deg": flat_deg, "a_deg": atan2d(R[2, 1], R[2, 2])}
    if kin_typ == 213 and chosen(params, "kin213_bc") == "pitch_and_sum":
        return out | _palletiser_columns(R, p)
    if kin_typ == 208 and chosen(params, "kin208_angles") == "tool_vector":
        before = options.get("before")
        pair = universal_angles(17, R[:, 2], None if before is None else [before["c_deg"], before["a_deg"]])
        return out | dict(zip(("c_deg", "a_deg"), pair, strict=True))
    return out | _angle_columns(
        angle_mode, R, options, {208: "CA", 213: "BC", 45: "ABC", 206: "ABC", 210: "ABC"}[kin_typ]
    )


def displayed_robx(
    axis_count: int,
    R: Array,
    p: Sequence[float] | Array,
    tool_dir: int = 0,
    *,
    before: Mapping[str, float] | None = None,
    params: Mapping[str, Any] | None = None,
) -> dict[str, float]:
    """Return x, y, z, the programmed angles and the tool direction of a ROBX pose (ROBX 6.1.3, spec robx 3 and 7).

    TOOL_DIR 0, -1: ORIRPY, Rz(A)*Ry(B)*Rx(C), tool X; +1: ORIRPY2, Rx(A)*Ry(B)*Rz(C), tool Z. 6 axes show A, B, C;
    5 axes A, B (C follows); 4 axes C. B in [-90, 90]; at B = +-90 A is 0 (5, 6 axes: its value before), C takes all.
    A and C are on the turn nearest to the row before.
    """
    if axis_count == 4 and chosen(params, "four_axis_tool_dir") == "ignored":
        tool_dir = 0
    steps = turns(5) if tool_dir == 1 else [("A", Z), ("B", Y), ("C", X)]
    tool = R @ steps[2][1]
    old = before or {}
    pairs = two_turns(steps[0][1], Y, steps[2][1], tool, 0.0 if axis_count == 4 else old.get("a_deg", 0.0))
    a, b = max(pairs, key=lambda pair: cosd(pair[1]))
    rest = rot(Y, -b) @ rot(steps[0][1], -a) @ R
    angles = {"a_deg": a, "b_deg": b, "c_deg": atan2d(steps[2][1] @ np.cross(Y, rest @ Y), Y @ rest @ Y)}
    columns = {4: ("c_deg",), 5: ("a_deg", "b_deg"), 6: ("a_deg", "b_deg", "c_deg")}[axis_count]
    out = dict(zip(("x_mm", "y_mm", "z_mm"), (float(value) for value in p), strict=True))
    out |= {name: wrap(angles[name], old.get(name, 0.0)) for name in columns}
    return out | dict(zip(("tool_x", "tool_y", "tool_z"), tool.tolist(), strict=True))


# --- Drives (poses 2) -----------------------------------------------------------------------------------------------

HD = Mapping[int, float]


def drives_3(b: float, params: Mapping[str, Any] | None = None) -> dict[str, float]:
    """Return the drive of the upper spindle, b_M = b + 180 where the axis is the programmed value (KIN 2.3)."""
    return {"B": b if chosen(params, "kin3_b_value") == "drive" else b + 180.0}


def _sign(value: float) -> float:
    """Return the direction of a signed parameter; 0 counts as positive."""
    return -1.0 if value < 0 else 1.0


def _gear(numerator: float, denominator: float, unset: float) -> float:
    if denominator == 0.0 and numerator != 0.0:
        raise ValueError("type 28: gear factor with a zero denominator")
    return unset if denominator == 0.0 else numerator / denominator


def drives_28(c: float, a: float, hd: HD, params: Mapping[str, Any] | None = None) -> dict[str, float]:
    """Return CM = CW and AM = AW*k_a + HD11 + k_ca*CW, k_ca = HD12/HD13, k_a = HD16/HD17; 0/0 is 0 and 1 (KIN 2.22).

    `gear_flag_place`: the signs HD14, HD15 lie in the head, so the drives do not see them; or on the drives' side.
    """
    k_ca, k_a = _gear(hd.get(12, 0.0), hd.get(13, 0.0), 0.0), _gear(hd.get(16, 0.0), hd.get(17, 0.0), 1.0)
    out = {"C": c, "A": a * k_a + hd.get(11, 0.0) + k_ca * c}
    if chosen(params, "gear_flag_place") == "before_gear":
        out = {"C": _sign(hd.get(14, 0.0)) * out["C"], "A": _sign(hd.get(15, 0.0)) * out["A"]}
    return out


def _cardan(c: float, tilt: float, hd: HD, sense: float, params: Mapping[str, Any] | None) -> Pair:
    """Return C and tilt of the machine: tilt = 2*asin(sin(tilt/2)/sin HD7), C turned back by what the tilt adds."""
    if hd.get(21, 0.0) == 0.0:
        if abs(tilt) > 2.0 * abs(hd[7]) + 1e-9:
            raise ValueError(f"spatial angle {tilt} is beyond 2*HD7 = {2.0 * hd[7]}")
        if tilt != 0.0:
            half = math.asin(max(-1.0, min(1.0, sense * sind(tilt / 2.0) / sind(hd[7]))))
            tilt = math.degrees(2.0 * half)
            c -= atan2d(cosd(hd[7]) * math.sin(half), math.cos(half))
    if chosen(params, "spatial_angle_offsets") == "direction_exact" and hd.get(21, 0.0) == 0.0:
        return c + hd.get(14, 0.0), tilt + hd.get(15, 0.0)
    return c, tilt  # HD14, HD15 act on the model only (KIN 2.29)


def drives_59(c: float, a: float, hd: HD, params: Mapping[str, Any] | None = None) -> dict[str, float]:
    """Return the drives of the C/A cardan head; HD16, HD17 act like a zero offset, so A = 0 moves it (KIN 2.29.1)."""
    sign = 1.0 if chosen(params, "kin59_zero_offset_sign") == "plus" else -1.0
    shift_c, shift_a = sign * hd.get(16, 0.0), sign * hd.get(17, 0.0)
    if chosen(params, "kin59_zero_offset_place") == "before_conversion":
        c, a = _cardan(c + shift_c, a + shift_a, hd, 1.0, params)
    else:
        c, a = (value + s for value, s in zip(_cardan(c, a, hd, 1.0, params), (shift_c, shift_a), strict=True))
    return {"C": c, "A": a}


def drives_60(c: float, b: float, hd: HD, params: Mapping[str, Any] | None = None) -> dict[str, float]:
    """Return the drives of the C/B cardan head (KIN 2.29.2); it has no zero offsets."""
    sense = 1.0 if chosen(params, "kin60_tilt_sign") == "plus" else -1.0
    return dict(zip(("C", "B"), _cardan(c, b, hd, sense, params), strict=True))


def drives_70(b: float, a: float, cv: float, hd: HD, params: Mapping[str, Any] | None = None) -> dict[str, float]:
    """Return B, A of the head whose tool vector is the programmed one turned by CV about Z (KIN 2.33); CV is virtual.

    Drives beyond +-90 are a ValueError (the head's range); at A = +-90 B keeps the programmed value.
    """
    if chosen(params, "kin70_cv") == "machine":
        return {"B": b, "A": a, "CV": cv}
    sign_b, sign_a = _sign(hd.get(10, 0.0)), _sign(hd.get(9, 0.0))
    b_in, a_in = sign_b * b - hd.get(8, 0.0), sign_a * a - hd.get(7, 0.0)
    head = hd.get(14, 0.0) if chosen(params, "kin70_angles_seen_from") == "machine" else 0.0
    v = rot(Z, cv - head) @ rot(Y, b_in) @ rot(X, a_in) @ Z
    b_in, a_in = max(two_turns(Y, X, Z, v, b_in), key=lambda pair: cosd(pair[1]))
    b, a = sign_b * (b_in + hd.get(8, 0.0)), sign_a * (a_in + hd.get(7, 0.0))
    if max(abs(a), abs(b)) > 90.0 + 1e-9:
        raise ValueError(f"type 70: B {b}, A {a} is outside the head's range of +-90")
    return {"B": b, "A": a, "CV": cv}


def kin76_axes(hd: HD, params: Mapping[str, Any] | None = None) -> tuple[str, Array, str, Array]:
    """Return outer and inner machine axis of the bevel head: names and directions before the mounting turn HD6."""
    tilted = np.array([sind(hd[7]), 0.0, cosd(hd[7])])
    return {
        "b_outside": ("B", Y, "A", tilted),
        "a_outside": ("A", tilted, "B", Y),
        "vertical_outside": ("A", Z, "B", tilted),
        "mirror_pair": ("A", tilted, "B", tilted * (-1.0, 1.0, 1.0)),
    }[chosen(params, "kin76_axes")]


def drives_76(c: float, a: float, hd: HD, params: Mapping[str, Any] | None = None) -> dict[str, float]:
    """Return machine A, B with Rz(HD6)*Rot(outer)*Rot(inner)*e_z = Rz(C)*Rx(A)*e_z (KIN 2.34); the answer nearer 0."""
    outer, u1, inner, u2 = kin76_axes(hd, params)
    v = rot(Z, c - hd.get(6, 0.0)) @ rot(X, a) @ Z
    answers = two_turns(u1, u2, Z, v)
    if not answers:
        raise ValueError("type 76: the tool direction is out of reach")
    first, second = nearest(answers, (0.0, 0.0))
    return {outer: first, inner: second}


# --- Status and turn of type 45 (poses 4; KIN 3.3.3) ----------------------------------------------------------------

FLAGS, OFFSETS = (21, 22, 23, 24, 25, 26), (36, 14, 15, 37, 38, 39)


def wrist_45(axes: Sequence[float], hd: HD, params: Mapping[str, Any] | None = None) -> tuple[Array, Array, Array]:
    """Return axis A2, axis A3 and the wrist centre in the frame that turns with A1 (row 45 of the types)."""
    joints = []
    for value, flag, offset in zip(axes, FLAGS, OFFSETS, strict=True):
        sign, zero = -1.0 if hd.get(flag, 0.0) else 1.0, hd.get(offset, 0.0)
        joints.append(
            sign * (value - zero) if chosen(params, "offset_inside_flag") == "inside" else sign * value - zero
        )
    shoulder = np.array([hd.get(11, 0.0), 0.0, hd.get(7, 0.0)])
    elbow = shoulder + rot(Y, joints[1]) @ np.array([0.0, 0.0, hd.get(8, 0.0)])
    forearm = np.array([hd.get(9, 0.0), -hd.get(32, 0.0), -hd.get(12, 0.0)])
    return shoulder, elbow, elbow + rot(Y, joints[1] + joints[2]) @ forearm


def status_turn_45(axes: Sequence[float], hd: HD, params: Mapping[str, Any] | None = None) -> tuple[int, int]:
    """Return IS and IT: wrist behind A1 (1), in front of the line A2-A3 (2), A5 < 0 (4); bit n for axis n+1 < 0.

    In front is the side of +X when the upper arm points up; it turns with the upper arm. Axis values count, not joint
    angles. 0 within 1e-9 is not less than 0.
    """
    shoulder, elbow, wrist = wrist_45(axes, hd, params)
    line, reach = elbow - shoulder, wrist - shoulder
    ahead = float(line[2] * reach[0] - line[0] * reach[2]) / float(np.linalg.norm(line))
    status = (1 if wrist[0] < -1e-9 else 0) + (2 if ahead > 1e-9 else 0) + (4 if axes[4] < -1e-9 else 0)
    return status, sum(1 << n for n, value in enumerate(axes) if value < -1e-9)
