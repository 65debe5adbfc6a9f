"""Rows of `info`: every ROBX datum with value, meaning and source; and the data that place and direct an arm."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Final

from chainbuild.convention import Choices
from chainbuild.formats.entries import TOOL_TABLE, Datum, ParameterRow
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.sinumerik.geometry.robot_axes import RECIPES, ArmData, basic_moves, internal_axes
from chainbuild.formats.sinumerik.geometry.tool import Tool
from chainbuild.formats.sinumerik.reading.assignment import Assignment
from chainbuild.formats.sinumerik.reading.catalogue import MachineDatum, catalogue
from chainbuild.formats.sinumerik.reading.data_table import written_name
from chainbuild.formats.sinumerik.reading.robx import Robx
from chainbuild.units import m_s_from_mm_min, rad_s2_from_rev_s2, rad_s_from_rpm

# Units of dynamics, with the SI unit and the conversion.
_SI: Mapping[str, tuple[str, Callable[[float], float]]] = {
    "mm/min": ("m/s", m_s_from_mm_min),
    "rpm": ("rad/s", rad_s_from_rpm),
    "rev/s^2": ("rad/s²", rad_s2_from_rev_s2),
}


_DIRECTIONS: Final = "ROBX_AXES_DIR"
_ZEROS: Final = "ROBX_MAMES"
_LENGTHS: Final = ("DP3", "DP4", "DP5")  # of a tool
_PLACING: Final = ("geometry", "axes", "additional_axes")  # groups of the data that act on poses


def parameter_rows(robx: Robx, tool: Tool, choose: Choices) -> tuple[ParameterRow, ...]:
    """Return the data of the transformation set, every ROBX datum, then the active tool's lengths and angles."""
    linear = _linear_axes(robx, choose)
    general = [catalogue()[f"{name}_{robx.transformation}"] for name in ("TRAFO_TYPE", "TRAFO_AXES_IN")]
    own = [datum for datum in catalogue().values() if datum.te4_name]
    rows = [row for datum in (*general, *own) for row in _rows(robx, datum, linear)]
    return (*rows, *_tool_rows(tool))


def _linear_axes(robx: Robx, choose: Choices) -> list[bool]:
    """Return which of the basic axes are linear."""
    arm = ArmData(internal_axes(robx, choose), *robx.lengths_mm, choose)
    return [move.kind == "prismatic" for move in basic_moves(RECIPES[robx.main_axes](arm))]


def geometry_data(robx: Robx, choose: Choices) -> tuple[Datum, ...]:
    """Return lengths, angles, directions and vectors of a transformation, element by element."""
    linear = _linear_axes(robx, choose)
    own = [datum for datum in catalogue().values() if datum.te4_name and datum.group in _PLACING]
    placing = [datum for datum in own if datum.type == "float" or datum.name == _DIRECTIONS]
    return tuple(found for datum in placing for found in _geometry(robx, datum, linear))


def tool_data(rows: Mapping[str, Assignment], own: Mapping[str, float], overlay: Overlay) -> Iterator[Datum]:
    """Yield the numbers of the active tool: its lengths, given or not, and what else is given.

    Args:
        rows: Those of the file by names such as "DP3".
        own: Those of the overlay, which win.
        overlay: The overlay.
    """
    first = next(iter(rows.values()), None)
    for name in dict.fromkeys((*_LENGTHS, *rows, *own)) if rows or own else ():
        datum, row = catalogue()[name], rows.get(name)
        given = own.get(name, row.value if row is not None else 0.0)
        if isinstance(given, str) or (datum.unit == "none" and (datum.type == "int" or not given)):
            continue
        unit, others = ("", (-given,)) if datum.unit == "none" else (datum.unit, ())
        if first is not None and name not in own:
            index, span = first.index, row.span if row is not None else None
            symbol = "T{} D{}".format(*index) if isinstance(index, tuple) else ""
            key, area = (name, index if isinstance(index, tuple) else None), (row or first).area
            yield Datum(written_name(datum, False, index), symbol, given, unit, span, area, key, others)
        else:
            place, span = f"{TOOL_TABLE}TC_{name}", overlay.span("tool", f"TC_{name}")
            yield Datum(place, "overlay", given, unit, span, 0, (place, None), others)


def _geometry(robx: Robx, datum: MachineDatum, linear: Sequence[bool]) -> Iterator[Datum]:
    te4 = robx.package == "TE4"
    number = datum.te4_number if te4 else datum.number
    for n in range(datum.dimension):
        index = None if datum.dimension == 1 else n
        row, value, unit = (
            robx.data.row(datum.name, index),
            robx.data.number(datum.name, index),
            _unit(datum, n, linear),
        )
        if unit or value:
            yield Datum(
                name=written_name(datum, te4, index),
                symbol=f"MD{number}" if number else "",
                value=value,
                unit=unit,
                span=row.span if row is not None else None,
                channel=robx.data.channel_number,
                key=(datum.name, index),
                others=() if unit else (-value,),
                twins=_twins(datum, n, te4),
            )


def _twins(datum: MachineDatum, n: int, te4: bool) -> tuple[str, ...]:
    """Return the zeros of the axes before and behind one: in a central wrist they turn over what its reversal does."""
    if datum.name != _DIRECTIONS or not 0 < n < datum.dimension - 1:
        return ()
    return tuple(written_name(catalogue()[_ZEROS], te4, k) for k in (n - 1, n + 1))


def _unit(datum: MachineDatum, index: int, linear: Sequence[bool]) -> str:
    """Return a datum's unit; a zero offset has the unit of its axis."""
    if datum.unit == "mm_or_deg":
        return "mm" if index < len(linear) and linear[index] else "deg"
    return "" if datum.unit == "none" else datum.unit


def _rows(robx: Robx, datum: MachineDatum, linear: Sequence[bool]) -> Iterator[ParameterRow]:
    te4 = robx.package == "TE4" and datum.te4_name is not None
    number = datum.te4_number if te4 else datum.number
    for index in range(datum.dimension):
        element = None if datum.dimension == 1 else index
        row = robx.data.row(datum.name, element)
        known = row is not None or index < len(datum.default or datum.default_known)
        value = robx.data.number(datum.name, element) if known else None
        if value is None and not datum.te4_name:
            continue
        whole = value is not None and datum.type != "float"
        si_unit, to_si = _SI.get(datum.unit, ("", None))
        yield ParameterRow(
            name=written_name(datum, te4, element),
            symbol=f"MD{number}" if number else "",
            value=int(value) if whole and value is not None else value,
            unit=_unit(datum, index, linear),
            meaning=datum.meaning,
            given=row is not None,
            source=f"ROBX manual {datum.manual}" if datum.manual else "",
            span=row.span if row is not None else None,
            si=to_si(value) if to_si is not None and value is not None else None,
            si_unit=si_unit,
        )


def _tool_rows(tool: Tool) -> Iterator[ParameterRow]:
    if not tool.name:
        return
    lengths = zip((3, 4, 5), tool.lengths_mm, strict=True)
    values = [(f"DP{n}", value, "mm") for n, value in lengths]
    values += [("DP6", tool.radius_mm, "mm")] if tool.radius_mm else []
    values += [(f"DPC{n}", value, "deg") for n, value in enumerate(tool.angles_deg, start=1) if value]
    for name, value, unit in values:
        datum = catalogue()[name]
        yield ParameterRow(
            name=f"$TC_{name}",
            symbol=tool.name,
            value=value,
            unit=unit,
            meaning=datum.meaning,
            given=True,
            source=f"ROBX manual {datum.manual}" if datum.manual else "",
            span=tool.span,
        )
