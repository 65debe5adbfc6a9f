"""The end of a robot: its flange and its tool."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.chain.bodies.body import TOOL_COLOUR, Body
from chainbuild.drawing.limbs.links import slab
from chainbuild.drawing.limbs.pieces import boss, ring, tube
from chainbuild.drawing.limbs.plan import line_point
from chainbuild.drawing.limbs.seats import Seat
from chainbuild.drawing.limbs.slides import slide_start
from chainbuild.drawing.site import Site

_DISC: Final = 0.3  # thickness of the flange over the radius of what carries it
_TOOL: Final = 0.4  # radius of the tool likewise
_POINT: Final = 1e-6  # m: places closer than this are one


def tip_bodies(site: Site, seat: Seat, quill: float = 0.0) -> list[Body]:
    """Return the last link of a robot: from its joint to the flange, the flange, and the tool to its tip.

    Args:
        site: The site.
        seat: The last joint towards the tool.
        quill: Thickness of the arm that it passes, where it is the quill of a SCARA [m].
    """
    link, r = seat.link, seat.radius
    has_flange = site.chain.frame("flange").link == link
    end = site.frame("flange")[:3, 3] if has_flange else site.tip
    bodies: list[Body] = []
    root = seat.place
    if seat.kind == "hinge":
        bodies += boss(site, link, seat)
    elif seat.kind == "stack":
        bodies += slab(site, seat, end)
        root = line_point(end, seat.axis, seat.place)
    elif seat.kind in ("column", "ram", "plate", "quill"):
        root, bodies = slide_start(site, seat, line_point(seat.corner, seat.axis, end))
    elif seat.kind == "roll":
        bodies.append(ring(site, link, seat, 0.9 * r))
        if quill:
            top = seat.corner - (quill + 0.8 * r) * seat.axis
            bodies += tube(site, link, "spindle", root, top, 0.45 * r)
        bend = line_point(seat.place, seat.axis, end)
        if np.linalg.norm(end - bend) > _POINT:
            bodies += tube(site, link, "housing", root, bend, 0.8 * r, origin="data")
            root = bend
    way = end - root
    length = float(np.linalg.norm(way))
    if length > _POINT and has_flange:
        thick = min(_DISC * r, 0.5 * length)
        face = end - way * (thick / length)
        bodies += tube(site, link, "housing", root, face, 0.8 * r, origin="data")
        bodies.append(site.cylinder(link, "flange", face, end, r, colour=TOOL_COLOUR, origin="data"))
        root = end
    if np.linalg.norm(site.tip - root) > _POINT:
        bodies.append(site.cylinder(link, "tool", root, site.tip, _TOOL * r, colour=TOOL_COLOUR, origin="data"))
    return bodies
