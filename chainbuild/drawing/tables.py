"""Tables, cradles, slides and the part: what carries the workpiece of a machine tool or beside a robot."""

from __future__ import annotations

from chainbuild.chain.bodies.body import Body
from chainbuild.drawing.site import Site


def workpiece_side(site: Site) -> list[Body]:
    """Return the bodies of this side of the machine."""
    raise NotImplementedError(site)
