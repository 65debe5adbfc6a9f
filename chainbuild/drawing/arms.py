"""Robots: foot, shoulder, arms and wrist as nested yokes."""

from __future__ import annotations

from chainbuild.chain.bodies.body import Body
from chainbuild.drawing.site import Site


def arm_bodies(site: Site) -> list[Body]:
    """Return the bodies of this side of the machine."""
    raise NotImplementedError(site)
