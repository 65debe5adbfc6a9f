"""What an overlay says of several axes, put on a chain: limits on their sums, and joints that several move."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.elements import Axis, Chain
from chainbuild.chain.names import axis_index
from chainbuild.chain.sums import AxisConstraint, AxisSum
from chainbuild.errors import ChainError
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.text import COUPLED, SUMS

_ROUNDED: Final = 1e-12  # shares below this are rounding of an inverse


def with_sums(chain: Chain, overlay: Overlay, *, main: bool = True) -> Chain:
    """Return a chain with the overlay's limits on sums of axes (`[limits.sums]`).

    Args:
        chain: The chain.
        overlay: What has them.
        main: False: the overlay is not written for this kinematic of its file; sums of axes that it lacks are left out.

    Raises:
        OverlayError: a sum of what are no axes, of one axis alone, or of linear and rotary ones; or limits that no
            axis values within theirs keep.
    """
    found = []
    for text, (lower, upper) in overlay.sums.items():
        coefficients = _coefficients(chain.axes, text)
        if not main and not any(coefficients):
            continue
        kinds = {axis.kind for axis, one in zip(chain.axes, coefficients, strict=True) if one}
        if np.count_nonzero(coefficients) < 2 or len(kinds) > 1:
            known = ", ".join(axis.name for axis in chain.axes)
            permitted = f'two or more axes of a kind, such as "A2+A3" or "A3 - 0.5*A2", of {known}'
            raise overlay.error(f"'{text}' is no sum of axes", ("limits", SUMS, text), permitted)
        least, most = _bounds(chain.axes, coefficients)
        if lower > most or upper < least:
            wrong = f"no axis values within their limits give '{text}' a value from {lower:g} to {upper:g}"
            raise overlay.error(wrong, ("limits", SUMS, text), f"limits that overlap {least:g} to {most:g}")
        found.append(AxisConstraint(text, AxisSum(coefficients, 0.0), lower, upper))
    return replace(chain, constraints=(*chain.constraints, *found))


def _coefficients(axes: Sequence[Axis], text: str) -> tuple[float, ...]:
    """Return the factor of every axis in a sum; all 0 where the text is none."""
    names = sorted({name for axis in axes for name in (axis.name, axis.generic) if name}, key=len, reverse=True)
    known = "|".join(re.escape(name) for name in names)  # names may hold - and +: the longest is meant
    term = re.compile(rf"\s*([+-]?)\s*(?:(\d+(?:\.\d*)?|\.\d+)\s*\*\s*)?({known})\s*", re.IGNORECASE)
    found, at = [0.0] * len(axes), 0
    while at < len(text):
        part = term.match(text, at)
        n = None if part is None else axis_index(axes, part[3])
        if part is None or n is None or (at and not part[1]):
            return (0.0,) * len(axes)
        found[n] += (-1.0 if part[1] == "-" else 1.0) * float(part[2] or 1.0)
        at = part.end()
    return tuple(found)


def _bounds(axes: Sequence[Axis], coefficients: Sequence[float]) -> tuple[float, float]:
    """Return the least and the largest value of a sum within the limits of its axes; endless ones have none."""
    pairs = [(axis, one) for axis, one in zip(axes, coefficients, strict=True) if one]
    if any(axis.endless for axis, _ in pairs):
        return -math.inf, math.inf
    ends = [sorted(one * end for end in axis.range) for axis, one in pairs]
    return sum(low for low, _ in ends), sum(high for _, high in ends)


def with_coupling(chain: Chain, overlay: Overlay) -> Chain:
    """Return a chain some of whose joints move with other axes, too (`[coupling]`): q₃ = axis₃ + factor · axis₂.

    Limits of an axis are those of its joint so far; they stay the joint's, as a limit on the sum, and leave the axis
    what they leave it whatever the others.

    Args:
        chain: A chain with an affine axis map, in which axes and the joints of their names agree.
        overlay: What has the couplings.

    Raises:
        OverlayError: an unknown axis, one that is coupled to itself or to one of the other kind, or couplings that give
            different axis values the same joint values.
    """
    if not overlay.coupling:
        return chain
    axes, axis_map = chain.axes, chain.axis_map
    assert isinstance(axis_map, AffineMap)
    shares = _shares(overlay, axes)
    try:
        coupled = AffineMap.of(axis_map.A @ shares, axis_map.b, [axis.kind for axis in axes])
    except ChainError as error:
        raise overlay.error(error.message, (COUPLED,), "couplings that can be undone") from None
    own = AffineMap.of(shares, np.zeros(len(axes)), [axis.kind for axis in axes])
    free = AffineMap(own.back, own.b, own.si_factors, own.A)  # axis values by what the joints stand at
    ends = np.array([(axis.lower, axis.upper) for axis in axes]).T
    lower, upper = (bound / own.si_factors for bound in free.q_bounds(*ends))
    together = [np.flatnonzero(np.abs(row) > _ROUNDED) for row in own.back]
    limits = tuple(
        AxisConstraint(f"joint {axis.name}", AxisSum(tuple(row), 0.0), axis.lower, axis.upper)
        for axis, row in zip(axes, shares.tolist(), strict=True)
        if np.count_nonzero(row) > 1 and not axis.assumed
    )
    left = tuple(
        replace(axis, lower=float(lower[n]), upper=float(upper[n]), assumed=any(axes[m].assumed for m in with_it))
        if len(with_it) > 1
        else axis
        for n, (axis, with_it) in enumerate(zip(axes, together, strict=True))
    )
    return replace(chain, axes=left, axis_map=coupled, constraints=(*chain.constraints, *limits))


def _shares(overlay: Overlay, axes: Sequence[Axis]) -> Matrix:
    """Return (n_axes, n_axes): what each axis adds to the value of the joint of each, SI by SI."""
    shares = np.eye(len(axes))
    for n, given in overlay.by_axis(axes, (COUPLED,), overlay.coupling).items():
        written = next(name for name in overlay.coupling if axis_index(axes, name) == n)
        for m, factor in overlay.by_axis(axes, (COUPLED, written), given).items():
            if axes[m].kind != axes[n].kind or m == n:
                others = (one.name for k, one in enumerate(axes) if one.kind == axes[n].kind and k != n)
                text = f"the joint of axis {axes[n].name} cannot move along with axis {axes[m].name}"
                raise overlay.error(text, (COUPLED, written), ", ".join(others) or "none: no other axis is of its kind")
            shares[n, m] = factor
    return shares
