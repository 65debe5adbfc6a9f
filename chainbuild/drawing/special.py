"""Lathes, the robots of two axes, the eccentric disc: machines with a rule of their own."""

from __future__ import annotations

from chainbuild.chain.bodies.body import Body
from chainbuild.drawing.site import Site


def special_bodies(site: Site) -> list[Body]:
    """Return the bodies of this side of the machine."""
    raise NotImplementedError(site)
