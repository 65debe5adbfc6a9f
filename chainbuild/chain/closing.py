"""What axis maps of closed loops know beyond joint values: singular places, ranges of their struts, the tips alone.

Ranges limit no motion: carriages on endless columns may stand anywhere, if they stand alike. They are where positions
are drawn for tests, maps, comparisons, collision pairs and the page, so that a good part of what is drawn closes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol, runtime_checkable

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import AxisMap
from chainbuild.chain.elements import Chain
from chainbuild.shown import fields_shown

StrutRange = tuple[float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Loss:
    """A function of closed loops that vanishes where they are singular.

    Attributes:
        kind: "strut": an axis moves the tool no more, as the stretched arm of a serial robot; "platform": the axes hold
            the platform no more, it moves by itself; "twist": the pairs of rods no longer keep it from turning.
        value: 0 at the singularity, no more than 1 far from it; without unit, signed where it has two sides.
        axes: Indices of the axes concerned.
        words: What stands how there, with a place {nearly}.
        rates: (n_q,) "platform": motion of the joints that no axis drives there; else None.
        about: (3,) "twist": the line [base] about which the platform could turn; else None.
    """

    __repr__ = fields_shown

    kind: Literal["strut", "platform", "twist"]
    value: float
    axes: tuple[int, ...]
    words: str
    rates: Vector | None = None
    about: Vector | None = None

    def condition(self, nearly: bool) -> str:
        """Return what stands how, nearly or exactly."""
        return self.words.format(nearly="nearly " if nearly else "")


@runtime_checkable
class LosingMap(Protocol):
    """An axis map of closed loops that knows where they are singular."""

    def losses(self, axes: Vector) -> tuple[Loss, ...]:
        """Return every function that vanishes at a singularity, at axis values (n_axes,); none where nothing closes."""
        ...


def endless_reason(axis_map: AxisMap, axes: Vector) -> str:
    """Return why the joints have no finite rates at axis values (n_axes,)."""
    text = "the kinematic has no finite derivative at these axis values"
    losses = axis_map.losses(axes) if isinstance(axis_map, LosingMap) else ()
    loose = [loss for loss in losses if loss.kind == "platform"]
    return f"{text}: {loose[0].condition(nearly=False)}, and the axes hold the tool no more" if loose else text


@runtime_checkable
class TipMap(Protocol):
    """An axis map of closed loops whose first joints, those between the tips, follow without the others."""

    def tip_values(self, axes: Vector) -> list[float] | None:
        """Return the values of the first joints, SI, at axis values (n_axes,), or None where nothing closes."""
        ...

    def tip_rows(self, rows: Matrix) -> Matrix:
        """Return them (N, n) at rows of axis values (N, n_axes); not a number where nothing closes."""
        ...


@runtime_checkable
class RangingMap(Protocol):
    """An axis map of closed loops that knows how far its struts let the axes go."""

    def strut_ranges(self) -> tuple[StrutRange | None, ...]:
        """Return the range of each axis, mm and degrees; None: the struts do not limit it."""
        ...


def strut_range(chain: Chain, n: int) -> StrutRange | None:
    """Return the range that the struts leave axis n where neither data nor overlay limit it, else None."""
    if not chain.axes[n].assumed or not isinstance(chain.axis_map, RangingMap):
        return None
    return chain.axis_map.strut_ranges()[n]


def drawn_range(chain: Chain) -> tuple[Vector, Vector]:
    """Return the range (n_axes,) in which random positions are drawn, mm and degrees: limits, or what the struts leave.

    Args:
        chain: Any chain, with loops or without.
    """
    ranges = [strut_range(chain, n) or axis.range for n, axis in enumerate(chain.axes)]
    return np.array([low for low, _ in ranges]), np.array([high for _, high in ranges])
