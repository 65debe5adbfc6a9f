"""What a composed chain takes over from its parts: limits on sums of axes, running angles, bodies."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from chainbuild.arrays import Matrix
from chainbuild.chain.elements import AxisConstraint, AxisSum, Chain
from chainbuild.chain.geometry import Geometry
from chainbuild.chain.names import Names


def constraints(chain: Chain, before: int, after: int) -> Iterable[AxisConstraint]:
    """Yield the limits on sums of axes of a chain, with other axes before and after its own."""
    for constraint in chain.constraints:
        yield replace(constraint, sum=padded(constraint.sum, before, after))


def padded(total: AxisSum, before: int, after: int) -> AxisSum:
    """Return a sum over more axes, with coefficient 0 for those before and after."""
    return AxisSum((0.0,) * before + total.coefficients + (0.0,) * after, total.offset)


def carried_c(lower: Chain, T_offset: Matrix, upper: Chain) -> AxisSum | None:
    """Return upper's running angle C, which remains valid where lower and the offset only translate."""
    turned = any(joint.kind == "revolute" for joint in lower.joints) or not np.array_equal(T_offset[:3, :3], np.eye(3))
    if upper.absolute_c is None or turned:
        return None
    return padded(upper.absolute_c, len(lower.axes), 0)


def joined_geometry(host: Geometry, guest: Geometry, names: Names, moved: Sequence[str]) -> Geometry:
    """Return what overlays say about the bodies of both.

    Args:
        host: Of the chain that is grafted on.
        guest: Of the chain that is grafted.
        names: The guest's new names.
        moved: The guest's links whose frames have moved: their shapes are drawn by rule again.
    """
    named = {link: new for link, new in names.links.items() if link not in moved}
    return replace(
        host,
        radii={**{named[link]: r for link, r in guest.radii.items() if link in named}, **host.radii},
        shapes={**{named[link]: s for link, s in guest.shapes.items() if link in named}, **host.shapes},
        ignore=(*host.ignore, *((names.links[a], names.links[b]) for a, b in guest.ignore)),
    )
