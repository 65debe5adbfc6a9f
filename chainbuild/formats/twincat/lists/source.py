"""What a chain is built from: a kinematic, its channel, the active tool, limits and overlay."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Final

from chainbuild.chain.names import as_name, free_name
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.twincat.lists.axislist import AxisList
from chainbuild.formats.twincat.lists.config import Channel, Trafo
from chainbuild.formats.twincat.lists.toollist import Tool

DIALECT: Final = "TwinCAT CNC"
_LABEL_CHARACTERS: Final = 40  # of a kinematic's name in the name of a chain


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
        second: The kinematic of the second transformation step on this one, or None.
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

    def upper(self) -> Source:
        """Return what the second transformation step is built from: the tool acts in the first (P-CHAN-00263)."""
        assert self.second is not None  # asked only of two steps
        return replace(self, trafo=self.second, second=None, tool=None, tool_length_mm=0.0)


def chain_name(machine: str, source: Source, default: Source | None) -> str:
    """Return a file-system-safe name of a chain, different for every kinematic of a machine file.

    Args:
        machine: Name of the machine, which is that of its default kinematic.
        source: What the chain is built from.
        default: What the default kinematic is built from, or None where there is none.
    """
    if default is not None and source.trafo is default.trafo and source.second is default.second:
        return machine
    taken: list[str] = []
    label = upper = ""
    for trafo in source.channel.trafos:
        own = as_name(trafo.name)[:_LABEL_CHARACTERS] if trafo.name else f"kin{trafo.id}"
        # Compared without case: file systems do not all tell cases apart.
        taken.append(free_name(own.lower(), taken))
        if trafo is source.trafo:
            label = own + taken[-1][len(own) :]
        if trafo is source.second:
            upper = f"_{own}{taken[-1][len(own) :]}_two_steps"
    channel = "" if default is not None and source.channel is default.channel else f"_channel{source.channel.index}"
    return f"{machine}{channel}_{label}{upper}"
