"""The assignment in a line of machine data."""

from __future__ import annotations

from dataclasses import dataclass

from chainbuild.errors import Span
from chainbuild.formats.sinumerik.reading.catalogue import MachineDatum
from chainbuild.formats.sinumerik.reading.values import ElementIndex, Value


@dataclass(frozen=True, slots=True)
class Assignment:
    """One line that gives a machine datum a value.

    Attributes:
        datum: Entry of the catalogue.
        te4: True where the line uses the older package's name or number (TRAFO6_*, MD626xx).
        index: Element number, axis name in capitals, (tool, edge), or None for a scalar.
        value: Number or string, checked against the catalogue.
        channel: Channel of the line, 1 where the file names none.
        span: The place of the value.
        area: Tool area of the section, 0 where none is named.
    """

    datum: MachineDatum
    te4: bool
    index: ElementIndex
    value: Value
    channel: int
    span: Span
    area: int = 0
