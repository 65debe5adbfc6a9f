"""Heads, rams, bridges and columns: what carries the tool of a machine tool."""

from __future__ import annotations

from chainbuild.chain.bodies.body import Body
from chainbuild.drawing.site import Site


def tool_side(site: Site) -> list[Body]:
    """Return the bodies of this side of the machine."""
    raise NotImplementedError(site)
