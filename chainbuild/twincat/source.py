"""What a chain is built from: a kinematic, its channel, the active tool, limits and overlay."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

from chainbuild.overlay import Overlay
from chainbuild.twincat.axislist import AxisList
from chainbuild.twincat.config import Channel, Trafo
from chainbuild.twincat.toollist import Tool

DIALECT: Final = "TwinCAT CNC"


@dataclass(frozen=True, slots=True)
class Source:
    """What a chain is built from.

    Attributes:
        trafo: The kinematic.
        channel: The channel that configures it.
        tool: The active tool, or None.
        tool_length_mm: Length of the tool, all sources added.
        axis_lists: Axis lists in file order.
        overlay: What the file beside the machine file adds.
        second: The kinematic of the second transformation step that stands on this one, or None.
        main: False where another kinematic of the file is the one that the overlay is written for.
    """

    trafo: Trafo
    channel: Channel
    tool: Tool | None = None
    tool_length_mm: float = 0.0
    axis_lists: Sequence[AxisList] = field(default_factory=tuple)
    overlay: Overlay = field(default_factory=Overlay)
    second: Trafo | None = None
    main: bool = True
