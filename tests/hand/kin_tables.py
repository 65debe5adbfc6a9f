"""Hand formulas of the machines whose workpiece is moved: KIN_TYP 1, 23, 34, 52, 57, 58, 61, 63, 64, 80, 81, 82.

`f(param, axes, tool_length_mm, conv)`: raw file values by file index, axes in channel order (mm, deg), choices by name;
the result is the tool in the workpiece frame, in mm. Sections of the KIN_TYP manual stand at each formula.
A workpiece-side linear axis moves opposite to its coordinate (manual 1.3), hence t(-X, -Y, ...) on that branch.
"""

from __future__ import annotations

from collections.abc import Sequence

from .tables_algebra import (
    Formula,
    Head,
    Matrix,
    chain,
    choice,
    internal,
    on_table,
    rx,
    ry,
    rz,
    seen_from,
    shift,
    sign_of,
    sign_value,
    table_flag,
    zero_is_plus,
)

Param = dict[int, float]
Conv = dict[str, str]


def _angle(hd: Head, value: float, offset: int, flag: int, conv: Conv) -> float:
    """Return the internal angle of an axis with offset HDoffset and direction flag HDflag."""
    return internal(value, hd(offset), table_flag(hd.flag(flag), conv), conv, "inside")


def _table_angle(hd: Head, value: float, offset: int, flag: int, conv: Conv) -> float:
    """Return the same for an axis that carries the workpiece."""
    return on_table(_angle(hd, value, offset, flag, conv), conv)


def kin1(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Bed machine, axes X Y Z B C (2.1): B in the head, C on the cross slide X, Y."""
    x, y, z, b_axis, c_axis = axes
    hd = Head(param)
    b_direction = -zero_is_plus(hd.flag(13))  # coded the other way round: 0 is negative
    b = internal(b_axis, hd(10), b_direction, conv, "inside")
    c = on_table(internal(c_axis, hd(11), zero_is_plus(hd.flag(14)), conv, "inside"), conv)
    pivot = chain(shift(0, 0, z), shift(hd(3), hd(4), -hd(2)))
    tool = chain(pivot, ry(b), shift(hd(5), hd(6), -hd(1) - tool_length_mm))
    return seen_from(chain(shift(-x, -y, 0), hd.vector(7), rz(c)), tool)


def kin23(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Tilting head A, turning table B on a cross slide, axes X Y Z A B (2.20)."""
    x, y, z, a_axis, b_axis = axes
    hd = Head(param)
    a = sign_value(hd.flag(4), conv) * a_axis
    slide, table = shift(-x, -y, 0), ry(on_table(sign_value(hd.flag(5), conv) * b_axis, conv))
    order = {"slides_carry_rotary": (slide, table), "rotary_carries_slides": (table, slide)}
    platform = shift(0, 0, sign_of(conv, "kin23_platform_sign") * hd(2))
    workpiece = chain(*order[choice(conv, "table_slide_order")], platform)
    return seen_from(workpiece, chain(shift(0, 0, z), rx(a), shift(0, 0, -hd(1) - tool_length_mm)))


def kin34(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Tool on Y and Z, workpiece on X and C, axes X Y Z C (2.25); the type has neither HD1 nor flags."""
    x, y, z, c_axis = axes
    hd = Head(param)
    sign = sign_of(conv, "kin34_offset_sign")
    slide = shift(-x, 0, 0)
    table = chain(shift(sign * hd(2), sign * hd(3), 0), rz(on_table(c_axis, conv)))
    order = {"slides_carry_rotary": (slide, table), "rotary_carries_slides": (table, slide)}
    return seen_from(chain(*order[choice(conv, "table_slide_order")]), shift(0, y, z - tool_length_mm))


def kin52(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Tool on X and Y, workpiece on Z, A, B, axes X Y Z A B (2.26); HD3 leads from the workpiece zero to A."""
    x, y, z, a_axis, b_axis = axes
    hd = Head(param)
    a = rx(on_table(sign_value(hd.flag(4), conv) * a_axis, conv))
    b = ry(on_table(sign_value(hd.flag(5), conv) * b_axis, conv))
    zero = shift(0, sign_of(conv, "kin52_wcs_offset_sign") * hd(3), 0)
    table = {"a_carries_b": (a, zero, b), "b_carries_a": (b, a, zero)}[choice(conv, "kin52_table_order")]
    tool = chain(shift(x, y, 0), shift(0, sign_of(conv, "kin52_tool_y_sign") * hd(2), -hd(1) - tool_length_mm))
    return seen_from(chain(shift(0, 0, -z), *table), tool)


def _clamp_to_slide(hd: Head, tool_length_mm: float, conv: Conv) -> Matrix:
    """Return the tool seen from the slide point where HD1..3 run from the clamping point to the slide (57, 58, 64)."""
    sign = sign_of(conv, "slide_offset_sign")
    return shift(sign * hd(2), sign * hd(3), -hd(1) - tool_length_mm)


def kin57(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Table B carrying C, axes X Y Z B C (2.27): HD7..9 to B, HD4..6 from B to C, HD14..16 to the workpiece zero."""
    x, y, z, b_axis, c_axis = axes
    hd = Head(param)
    b = _table_angle(hd, b_axis, 10, 12, conv)
    c = _table_angle(hd, c_axis, 11, 13, conv)
    workpiece = chain(hd.vector(7), ry(b), hd.vector(4), rz(c), hd.vector(14))
    return seen_from(workpiece, chain(shift(x, y, z), _clamp_to_slide(hd, tool_length_mm, conv)))


def kin58(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Table A carrying C, axes X Y Z A C (2.28): numbered as 57."""
    x, y, z, a_axis, c_axis = axes
    hd = Head(param)
    a = _table_angle(hd, a_axis, 10, 12, conv)
    c = _table_angle(hd, c_axis, 11, 13, conv)
    workpiece = chain(hd.vector(7), rx(a), hd.vector(4), rz(c), hd.vector(14))
    return seen_from(workpiece, chain(shift(x, y, z), _clamp_to_slide(hd, tool_length_mm, conv)))


def _pivot_to_slide(hd: Head, conv: Conv) -> Matrix:
    """Return the head pivot seen from the slide point: HD4..6 run from the pivot to the slide (61, 63)."""
    return hd.vector(4, {"shifts_zero": -1.0, "absorbed": 0.0}[choice(conv, "pivot_to_slide_effect")])


def kin61(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Tool on X, Z, B, workpiece on Y, A, axes X Y Z A B (2.30): A and B meet where the linear axes are 0."""
    x, y, z, a_axis, b_axis = axes
    hd = Head(param)
    a = _table_angle(hd, a_axis, 13, 15, conv)
    b = _angle(hd, b_axis, 14, 16, conv)
    clamp = shift(hd(2), hd(3), -hd(1) - tool_length_mm)
    tool = chain(shift(x, 0, z), _pivot_to_slide(hd, conv), ry(b), clamp)
    machine_zero = hd.vector(7, sign_of(conv, "machine_zero_sign"))
    return seen_from(chain(shift(0, -y, 0), machine_zero, rx(a), hd.vector(10), hd.vector(17)), tool)


def kin63(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Tool on Z, A, workpiece on X, Y, B, axes X Y Z A B (2.31): numbered as 61."""
    x, y, z, a_axis, b_axis = axes
    hd = Head(param)
    a = _angle(hd, a_axis, 13, 15, conv)
    b = _table_angle(hd, b_axis, 14, 16, conv)
    clamp = shift(hd(2), hd(3), -hd(1) - tool_length_mm)
    tool = chain(shift(0, 0, z), _pivot_to_slide(hd, conv), rx(a), clamp)
    machine_zero = hd.vector(7, sign_of(conv, "machine_zero_sign"))
    return seen_from(chain(shift(-x, -y, 0), machine_zero, ry(b), hd.vector(10), hd.vector(17)), tool)


def kin64(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Table C1 carrying A carrying C2, axes X Y Z C1 A C2 (2.32); HD16..18 are offsets as tabled, not flags."""
    x, y, z, c1_axis, a_axis, c2_axis = axes
    hd = Head(param)
    c1 = _table_angle(hd, c1_axis, 16, 19, conv)
    a = _table_angle(hd, a_axis, 17, 20, conv)
    c2 = _table_angle(hd, c2_axis, 18, 21, conv)
    workpiece = chain(hd.vector(10), rz(c1), hd.vector(4), rx(a), hd.vector(7), rz(c2), hd.vector(13))
    return seen_from(workpiece, chain(shift(x, y, z), _clamp_to_slide(hd, tool_length_mm, conv)))


def _two_axis_table(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv, *, a_outer: bool) -> Matrix:
    """Return 80 and 81, which differ in the order of the table axes only; HD1..3 run from the slide to the clamp."""
    x, y, z, outer_axis, inner_axis = axes
    hd = Head(param)
    outer = _table_angle(hd, outer_axis, 13, 15, conv)
    inner = _table_angle(hd, inner_axis, 14, 16, conv)
    first, second = (rx, ry) if a_outer else (ry, rx)
    machine_zero = hd.vector(10, sign_of(conv, "machine_zero_sign"))
    workpiece = chain(machine_zero, first(outer), hd.vector(4), second(inner), hd.vector(7))
    return seen_from(workpiece, chain(shift(x, y, z), shift(hd(2), hd(3), -hd(1) - tool_length_mm)))


def kin80(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Table A carrying B, axes X Y Z A B (2.35): A passes through the slide point where the linear axes are 0."""
    return _two_axis_table(param, axes, tool_length_mm, conv, a_outer=True)


def kin81(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Table B carrying A, axes X Y Z B A (2.36): B passes through the slide point where the linear axes are 0."""
    return _two_axis_table(param, axes, tool_length_mm, conv, a_outer=False)


def kin82(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Head B carrying A over a table C, axes X Y Z B C A, C between (2.37); A has neither offset nor flag."""
    x, y, z, b_axis, c_axis, a = axes
    hd = Head(param)
    b = _angle(hd, b_axis, 16, 18, conv)
    c = _table_angle(hd, c_axis, 17, 19, conv)
    tip = shift(-hd(2), -hd(3), -hd(1) - tool_length_mm)
    tool = chain(shift(x, y, z), hd.vector(7, -1.0), ry(b), hd.vector(4, -1.0), rx(a), tip)
    machine_zero = hd.vector(13, sign_of(conv, "machine_zero_sign"))
    return seen_from(chain(machine_zero, rz(c), hd.vector(10)), tool)


FORMULAS: dict[int, Formula] = {
    1: kin1,
    23: kin23,
    34: kin34,
    52: kin52,
    57: kin57,
    58: kin58,
    61: kin61,
    63: kin63,
    64: kin64,
    80: kin80,
    81: kin81,
    82: kin82,
}
