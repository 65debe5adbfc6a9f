"""Robots: foot, shoulder, arms and wrist as nested yokes; under them a track, a column or a gantry."""

from __future__ import annotations

from itertools import pairwise

from chainbuild.chain.bodies.body import Body
from chainbuild.drawing.limbs.links import limb
from chainbuild.drawing.limbs.pushrods import pushrod_bodies
from chainbuild.drawing.limbs.tips import tip_bodies
from chainbuild.drawing.site import Site
from chainbuild.drawing.tracks import footing


def arm_bodies(site: Site) -> list[Body]:
    """Return the bodies of a robot from the floor to the tip of its tool.

    Args:
        site: The site.
    """
    base = footing(site)
    bodies = list(base.bodies)
    for start, end in pairwise(base.seats):
        bodies += limb(site, start, end)
    before, last = base.seats[-2:] if len(base.seats) > 1 else (None, base.seats[-1])
    # The quill of a SCARA comes out above the hood of its arm.
    quill = 1.9 * before.plate if before is not None and before.kind == "stack" else 0.0
    return [*bodies, *tip_bodies(site, last, quill), *pushrod_bodies(site, base.seats)]
