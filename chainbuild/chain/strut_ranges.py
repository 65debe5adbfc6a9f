"""Ranges of axes of closed loops that nobody limits, from the lengths of the struts.

They limit no motion: carriages on endless columns may stand anywhere, if they stand alike. They are where positions are
drawn for tests, maps, comparisons, collision pairs and the page, so that a good part of what is drawn closes.
"""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.elements import Chain

Range = tuple[float, float]


@runtime_checkable
class RangingMap(Protocol):
    """An axis map of closed loops that knows how far its struts let the axes go."""

    def strut_ranges(self) -> tuple[Range | None, ...]:
        """Return the range of each axis, mm and degrees; None: the struts do not limit it."""
        ...


def strut_range(chain: Chain, n: int) -> Range | None:
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
