"""Which length of a file places what: each is changed, the chain built again, and what has moved is looked for.

So every kinematic is served, and no recipe has to say what its data mean.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.elements import Chain
from chainbuild.errors import ChainbuildError
from chainbuild.formats.entries import Datum, datum_name
from chainbuild.formats.machine import Machine
from chainbuild.shown import fields_shown

_STEP_MM: Final = 1.0  # far above rounding, far below any machine
_MOVED: Final = 1e-9  # m: of a placement; rounding is less


@dataclass(frozen=True, slots=True, eq=False)
class Dimension:
    """A length of machine data as a line: from where something would be with the length 0 to where it is.

    Attributes:
        datum: The length.
        label: Its short name, value and unit: "HD5 = −45 mm".
        places: The joint or frame that it places.
        link: The link in which the line stands.
        start: (3,) where the line begins, in the link [m].
        end: (3,) where it ends.
    """

    __repr__ = fields_shown

    datum: Datum
    label: str
    places: str
    link: str
    start: Vector
    end: Vector


def dimensions(
    machine: Machine,
    kinematic: int | str | tuple[int | str, int | str] | None = None,
    channel: int | None = None,
    tool_length_mm: float = 0.0,
    conventions: Mapping[str, str] | None = None,
) -> tuple[Dimension, ...]:
    """Return the lengths of a machine file, but for those that are 0 or move nothing, as lines in the links.

    Args:
        machine: The machine.
        kinematic: As for `Machine.chain`.
        channel: As for `Machine.chain`.
        tool_length_mm: As for `Machine.chain`.
        conventions: As for `Machine.chain`.

    Raises:
        ChainbuildError: the kinematic or channel does not exist, or cannot be built.
    """

    def built(values: Mapping[Datum, float]) -> Chain:
        return machine.with_values(values).trial_chain(kinematic, channel, tool_length_mm, conventions)

    data = machine.geometry(kinematic, channel)
    data = (*data, *machine.tool_data(kinematic, channel, tool_length_mm=tool_length_mm))
    given = [datum for datum in data if datum.unit == "mm" and datum.value != 0.0]
    here = built({})
    found = []
    for datum in given:
        try:
            moved = next(_moved(here, built({datum: datum.value + _STEP_MM})), None)
        except ChainbuildError:
            continue  # the machine permits no other value
        if moved is not None:
            places, link, end, step = moved
            start = end - step * (datum.value / _STEP_MM)
            found.append(Dimension(datum, _label(datum, given), places, link, start, end))
    return tuple(found)


def _moved(here: Chain, there: Chain) -> Iterator[tuple[str, str, Vector, Vector]]:
    """Yield what stands elsewhere in another chain: its name, the link, where it is in the link, how far it moved."""
    if [joint.name for joint in here.joints] != [joint.name for joint in there.joints]:
        return
    places: list[tuple[str, str, Matrix, Matrix]] = [
        (one.name, one.parent, one.T_parent_joint, other.T_parent_joint)
        for one, other in zip(here.joints, there.joints, strict=True)
    ]
    frames = {frame.name: frame for frame in there.frames}
    places += [
        (frame.name, frame.link, frame.T_link_frame, frames[frame.name].T_link_frame)
        for frame in here.frames
        if frame.name in frames
    ]
    for name, link, T, T_moved in places:
        step = T_moved[:3, 3] - T[:3, 3]
        if np.abs(step).max() > _MOVED:
            yield name, link, T[:3, 3], step


def _label(datum: Datum, data: Sequence[Datum]) -> str:
    """Return a text for a drawing: short name, value and unit."""
    return f"{datum_name(datum, data)} = {datum.value:.10g} {datum.unit}".replace("-", "−")
