"""Which rule draws a machine, by its topology."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, Literal

from chainbuild.chain.axismap import BlockMap
from chainbuild.chain.bodies.body import Body
from chainbuild.chain.bodies.shapes import detail_bodies, link_bodies
from chainbuild.chain.elements import Chain
from chainbuild.chain.poses import path_to
from chainbuild.drawing.arms import arm_bodies
from chainbuild.drawing.given import with_given
from chainbuild.drawing.held import as_tool_carrier, holds_workpiece, recoloured
from chainbuild.drawing.machine_tools.stands import machine_tool_bodies
from chainbuild.drawing.machine_tools.tables import table_beside
from chainbuild.drawing.parallel import parallel_bodies
from chainbuild.drawing.site import Site, home_of
from chainbuild.drawing.special import special_bodies

Build = Literal["machine tool", "arm", "parallel", "special"]


_ARM_TURNS: Final = 4  # rotary axes on the way to the tool: heads of machine tools have three at most
_SPECIAL: Final = tuple(f"KIN_TYP {number}" for number in (13, 14, 36, 85, 202, 205))


def robot_bodies(site: Site) -> list[Body]:
    """Return the bodies of a robot, and of what carries the workpiece beside it."""
    robot = arm_bodies(site)
    return [*robot, *table_beside(site, robot)]


_RULES: Final[dict[Build, Callable[[Site], list[Body]]]] = {
    "machine tool": machine_tool_bodies,
    "arm": robot_bodies,
    "parallel": parallel_bodies,
    "special": special_bodies,
}


def drawn_bodies(chain: Chain) -> tuple[Body, ...]:
    """Return the bodies that show a machine, several a link: by the rule of its build, and what is given.

    Closed loops that no rule knows, or that have no pose to draw, keep the skeleton.
    """
    if home_of(chain) is None or not _known_loops(chain):
        return (*link_bodies(chain), *detail_bodies(chain))
    if holds_workpiece(chain):
        return tuple(recoloured(chain, drawn_bodies(as_tool_carrier(chain))))
    site = Site(chain)
    return tuple(with_given(site, _RULES[build_of(site)]))


def _known_loops(chain: Chain) -> bool:
    """Return whether a rod on a driven arm closes some loop, which the rules draw, or the chain has no loops.

    The rules draw one machine: of several that are composed, one with loops may stand on another's tool.
    """
    if chain.loops and isinstance(chain.axis_map, BlockMap):
        return False
    driven = {axis.name for axis in chain.axes}

    def on_an_arm(frame: str) -> bool:
        path = path_to(chain, chain.frame(frame).link)
        return len(path) > 1 and path[0].name in driven

    return not chain.loops or any(
        chain.frame(loop.frame_a).link != chain.frame(loop.frame_b).link
        and (on_an_arm(loop.frame_a) or on_an_arm(loop.frame_b))
        for loop in chain.loops
    )


def build_of(site: Site) -> Build:
    """Return how a machine is built."""
    chain = site.chain
    if chain.loops:
        return "parallel"
    if chain.kinematic in _SPECIAL:
        return "special"
    turns = sum(joint.kind == "revolute" for joint in site.tool_path)
    return "arm" if turns >= _ARM_TURNS or chain.dialect == "SINUMERIK ROBX" else "machine tool"
