"""Names of channel axes: which are permitted, and the one of each axis of a transformation.

Source: MD20080 $MC_AXCONF_CHANAX_NAME_TAB; the ROBX manual does not describe it.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from chainbuild.chain.elements import Axis
from chainbuild.chain.names import channel_names, name_fault
from chainbuild.findings import Collector
from chainbuild.formats.sinumerik.reading.assignment import Assignment
from chainbuild.formats.sinumerik.reading.data_table import DataTable, written_name
from chainbuild.formats.sinumerik.reading.robx import Robx

_TABLE: Final = "AXCONF_CHANAX_NAME_TAB"
_OWN: Final = "a name of its own for each axis"
_LONGEST: Final = 31  # characters of an identifier of NC programs
_IDENTIFIER: Final = re.compile(r"[A-Za-z_]\w*", re.ASCII)


def check_axis_names(table: DataTable, collector: Collector) -> None:
    """Refuse names of channel axes that tables could not hold, and those of two axes of a channel."""
    seen: dict[tuple[int, str], Assignment] = {}
    for (channel, _, datum, index), row in table.rows.items():
        name = str(row.value)
        if datum != _TABLE or not name:
            continue
        parameter = written_name(row.datum, False, index)
        fault = name_fault(name)
        first = seen.setdefault((channel, name.casefold()), row)
        if first is not row:
            fault = f"two axes of a channel are called {name!r}, also in line {first.span.line}", _OWN
        if fault is not None:
            collector.add("CB118", fault[0], span=row.span, parameter=parameter, permitted=fault[1])
        elif not _IDENTIFIER.fullmatch(name) or len(name) > _LONGEST:
            text = f"an NC program cannot name the axis {name[:40]!r}"
            permitted = f"a letter, then letters, digits and _, at most {_LONGEST} characters"
            collector.add("CB119", text, span=row.span, parameter=parameter, permitted=permitted)


def names_of_axes(
    axes: Sequence[Axis], channel_axes: Sequence[int], robx: Robx, collector: Collector
) -> tuple[str, ...]:
    """Return the channel's names of the axes of a transformation, the generic one where the file names none.

    Args:
        axes: The axes by their generic names.
        channel_axes: Number of the channel axis of each, from 1.
        robx: The transformation.
        collector: Takes a finding where the channel calls one axis by the generic name of another without a name.
    """
    rows = [robx.data.row(_TABLE, number - 1) for number in channel_axes]
    given = ["" if row is None else str(row.value) for row in rows]
    names, lost = channel_names(axes, given)
    for n in lost:
        generic = axes[n].name
        row = next(row for row in rows if row is not None and str(row.value).casefold() == generic.casefold())
        text = f"{row.value} is the name of another axis than {generic} of the robot, which is called {names[n]}"
        hint = f"name all axes: ${row.datum.prefix}_{_TABLE}[{channel_axes[n] - 1}] is missing"
        collector.add("CB119", text, span=row.span, parameter=written_name(row.datum, False, row.index), hint=hint)
    return names
