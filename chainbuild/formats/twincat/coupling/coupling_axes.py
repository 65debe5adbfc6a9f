"""What KIN_TYP 210 asks of the channel: six simulated TCP axes, the order of the axes, a fitting angle mode.

Only what the lists say is checked: a list without names of axes, or without axis lists, leaves nothing to compare.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from chainbuild.errors import Span
from chainbuild.findings import Collector
from chainbuild.formats.twincat.coupling.coupling_groups import coupling_data
from chainbuild.formats.twincat.lists.axislist import list_by_channel
from chainbuild.formats.twincat.lists.config import Channel
from chainbuild.formats.twincat.lists.source import Source

_TCP: Final = "TCP"
_TCP_LETTERS: Final = "XYZABC"
_SIMULATED: Final = 4  # kenngr.antr_typ (P-AXIS-00020)
_LETTER: Final = re.compile(r"([XYZABC])(?:_\w+)?", re.IGNORECASE)  # "X", "X_ROB"; not "A1", which counts joints
_SUFFIX: Final = re.compile(r"\w+_([A-Za-z0-9]+)")


@dataclass(frozen=True, slots=True)
class Place:
    """A partial kinematic and the coordinate that each of its axes in the channel stands for."""

    name: str
    letters: str


def check_axes(source: Source, partials: Sequence[Place], collector: Collector) -> None:
    """Note what contradicts the manual's scheme: TCP axes, then the partials group by group, from the ground up.

    Args:
        source: The coupling, its channel and the axis lists.
        partials: The partials in the order of their axes.
        collector: Takes findings.
    """
    places = (Place(_TCP, _TCP_LETTERS), *partials)
    _check_simulated(source, collector)
    named = {i: axis.name for i, axis in source.channel.axes.items() if axis.name}
    span = source.channel.span if source.trafo.span is None else source.trafo.span
    needed = sum(len(place.letters) for place in places)
    if source.channel.axes and max(source.channel.axes) + 1 < needed:
        text = f"the channel has {max(source.channel.axes) + 1} axes, the coupling needs {needed}"
        _note(text, places, span, collector)
        return
    wrong = _wrong_letter(named, places) or _shared_suffix(named, places)
    if wrong:
        _note(wrong, places, span, collector)


def _note(text: str, places: Sequence[Place], span: Span | None, collector: Collector) -> None:
    scheme, first = [], 0
    for place in places:
        last = first + len(place.letters) - 1
        scheme.append(f"{place.name} {first}" + (f" to {last}" if last > first else ""))
        first = last + 1
    hint = "the controller gives axes out of order to another kinematic (manual 3.5)"
    order = "axis indices " + ", ".join(scheme)
    collector.add("CB463", text, span=span, parameter="gruppe[0].achse[i]", permitted=order, hint=hint)


def _check_simulated(source: Source, collector: Collector) -> None:
    """Note TCP axes that are no simulated axes, or measure."""
    for i in range(len(_TCP_LETTERS)):
        axis = source.channel.axes.get(i)
        entry = list_by_channel(i, axis, source.axis_lists)
        if entry is None:
            continue
        shown = f"axis {i}{f' ({axis.name})' if axis and axis.name else ''} is a TCP axis of the coupling, but"
        if entry.drive_type not in (None, _SIMULATED):
            text = f"{shown} its drive type is {entry.drive_type}"
            collector.add("CB463", text, span=entry.span, parameter="kenngr.antr_typ", permitted="4 (simulation)")
        if entry.measures:
            text = f"{shown} it takes part in measuring"
            collector.add("CB463", text, span=entry.span, parameter="kenngr.messachse", permitted="0")


def _owners(places: Sequence[Place]) -> list[tuple[str, str]]:
    """Return name and letter for every axis of the channel."""
    return [(place.name, letter) for place in places for letter in place.letters]


def _wrong_letter(named: dict[int, str], places: Sequence[Place]) -> str | None:
    """Return what to say of the first axis whose letter is not that of its place."""
    for i, (owner, letter) in enumerate(_owners(places)):
        match = _LETTER.fullmatch(named.get(i, ""))
        if match is not None and match[1].upper() != letter:
            return f"axis {i} is called {named[i]}, but is the {letter} of {owner}"
    return None


def _shared_suffix(named: dict[int, str], places: Sequence[Place]) -> str | None:
    """Return what to say where the names of one kinematic ("…_ROB") go on at the place of another."""
    users: dict[str, dict[str, str]] = {}
    for i, (owner, _) in enumerate(_owners(places)):
        match = _SUFFIX.fullmatch(named.get(i, ""))
        if match is not None:
            users.setdefault(match[1].upper(), {}).setdefault(owner, f"axis {i} ({named[i]})")
    for owners in users.values():
        if 1 < len(owners) < len(places):  # a suffix of all axes names the machine
            (first, where), (second, there) = list(owners.items())[:2]
            return f"{where} belongs to {first}, {there} of the same suffix to {second}"
    return None


def check_angle_mode(name: str, rotary: str, channel: Channel, span: Span | None, collector: Collector) -> None:
    """Note an angle mode (P-CHAN-00112) in which the TCP's angles are not those of an RTCP partial's rotary axes.

    Args:
        name: The partial.
        rotary: Letters of its rotary axes in their order: "CA".
        channel: The channel, which gives the mode.
        span: Where the partial is configured.
        collector: Takes findings.
    """
    fitting: dict[str, list[int]] = coupling_data()["rtcp_angle_modes"]
    if len(rotary) < 2 or len(set(rotary)) < len(rotary):
        return  # about one direction any mode turns alike; one twice is no matter of angles
    given = channel.angle_mode
    mode, permitted = int(given.value) if given else 0, fitting.get(rotary, [])
    if mode in permitted:
        return
    text = f"{name} turns about {' and '.join(rotary)}; the angle mode {mode}{'' if given else ' (default)'} does not"
    collector.add(
        "CB464", f"{text} turn in that order", span=given.span if given else span, parameter="ori_rotation_angle",
        permitted=" or ".join(map(str, permitted)) or "none fits",
        hint="the angles programmed for the TCP are those of its rotary axes only in a fitting mode",
    )  # fmt: skip
