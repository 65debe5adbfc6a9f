"""What a datum of a file moves: the chain with one millimetre or degree more of it, beside the chain as it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.chain.axismap import joint_values
from chainbuild.chain.poses import link_placements, pose, rotation_vector
from chainbuild.shown import fields_shown
from chainbuild.units import deg_from_rad, mm_from_m

if TYPE_CHECKING:
    from chainbuild.arrays import Vector
    from chainbuild.chain.elements import Chain
    from chainbuild.formats.entries import Datum

_STEP: Final = 1.0  # mm or degrees: what a change moves is told for one of them
_MOVED: Final = 1e-9  # m and parts of a direction: rounding is less


@dataclass(frozen=True, slots=True)
class Effect:
    """What stands elsewhere in one chain than in another at the same axis values.

    Attributes:
        links: Names of the links that do, from the base on.
        shift_mm: Shift (3,) of the tool in the workpiece frame.
        turn_deg: Turn of the tool.
    """

    __repr__ = fields_shown

    links: tuple[str, ...]
    shift_mm: tuple[float, ...]
    turn_deg: float


def next_value(datum: Datum, value: float) -> float:
    """Return the value that a datum is changed to: one millimetre or degree more, of a bare number the next one."""
    if datum.unit:
        return value + _STEP
    choice = sorted({datum.value, *datum.others})
    return choice[(choice.index(value) + 1) % len(choice)]


def effect_at(here: Chain, there: Chain, axes: Vector) -> Effect | None:
    """Return what stands elsewhere in another chain at axis values (n_axes,), mm and degrees.

    None where the two do not consist of the same links.

    Raises:
        ChainbuildError: one of them has no pose there.
    """
    before, after = (link_placements(chain, joint_values(chain.axis_map, axes)) for chain in (here, there))
    T, T_moved = pose(here, axes), pose(there, axes)
    if before.keys() != after.keys():
        return None
    links = tuple(name for name, placed in before.items() if np.abs(after[name] - placed).max() > _MOVED)
    turn = deg_from_rad(float(np.linalg.norm(rotation_vector(T[:3, :3].T @ T_moved[:3, :3]))))
    return Effect(links, tuple(mm_from_m(part) for part in (T_moved - T)[:3, 3].tolist()), turn)
