"""Machines with closed loops: tripods, the delta robot, the table on rods, the lambda kinematic."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.chain.bodies.body import TOOL_SIDE, WORKPIECE_SIDE, Body
from chainbuild.chain.elements import BASE_LINK
from chainbuild.drawing.builds.bed import bed_height, part_block, tips
from chainbuild.drawing.builds.columns import column_bodies, column_reach, under_arms
from chainbuild.drawing.builds.delta import delta_bodies
from chainbuild.drawing.builds.platform import bridge_bodies, table_guide, table_platform, tool_platform
from chainbuild.drawing.builds.scissors import scissor_bodies
from chainbuild.drawing.builds.struts import Arm, arms_of, platform_of, rod_bodies, round_foot
from chainbuild.drawing.machine_tools.tables import standing
from chainbuild.drawing.site import Site

_TABLE: Final = 0.12  # of the machine's size: how high a fixed table stands over the floor
_TABLE_WIDTH: Final = 0.6  # of the way to the columns: radius of a fixed table
_PART: Final = 0.12  # of the machine's size: width of the part


def parallel_bodies(site: Site) -> list[Body]:
    """Return the bodies of a machine with closed loops."""
    platform = platform_of(site.chain)
    if platform is None:
        return scissor_bodies(site)
    arms = arms_of(site, platform)
    if platform != site.chain.frame("tool").link:
        return _under_a_bridge(site, platform, arms)
    bodies = [body for arm in arms for body in rod_bodies(site, arm, TOOL_SIDE[1])]
    bodies += tool_platform(site, platform, arms)
    if site.workpiece_path:
        below = _turning_table(site)
        floor = min(float(site.bounds(body)[0, 2]) for body in below)
    else:
        floor, below = _fixed_table(site, arms)
    if arms[0].joint.kind == "revolute":
        return [*bodies, *delta_bodies(site, arms, floor), *below]
    foot = round_foot(site, floor, column_reach(arms), arms[0])
    return [*bodies, *column_bodies(site, arms, floor, TOOL_SIDE[0]), foot, *below]


def _fixed_table(site: Site, arms: list[Arm]) -> tuple[float, list[Body]]:
    """Return the z of the floor, and the table on it with the part; under levers the part stands on the floor."""
    lowest = float(tips(site)[:, 2].min())
    top = bed_height(site, lowest)
    x, y = site.tip[:2]
    if arms[0].joint.kind == "revolute":
        return top, part_block(site, BASE_LINK, (x, y, top), _PART * site.size, lowest - top)
    rise = _TABLE * site.size
    floor = min(top - rise, under_arms(site, arms))
    top = top if arms[0].hangs else floor + rise  # rods that stand lean over the table
    radius = _TABLE_WIDTH * float(np.hypot(*arms[0].start[:2]))
    part = part_block(site, BASE_LINK, (x, y, top), _PART * site.size, lowest - top)
    return floor, [site.cylinder(BASE_LINK, "table", (x, y, floor), (x, y, top), radius), *part]


def _turning_table(site: Site) -> list[Body]:
    """Return a table on rotary axes, with the part: the struts tell how much room the tool leaves."""
    table = standing(site)
    room = float(tips(site)[:, 2].min() - site.T_workpiece[2, 3])
    known = any(body.part == "workpiece" for body in table)
    link = site.workpiece_path[-1].child
    part = part_block(site, link, site.T_workpiece[:3, 3], _PART * site.size, room)
    return table if known else [*table, *part]


def _under_a_bridge(site: Site, platform: str, arms: list[Arm]) -> list[Body]:
    """Return a table on rods under a tool on crossed slides."""
    floor = under_arms(site, arms)
    return [
        *(body for arm in arms for body in rod_bodies(site, arm, WORKPIECE_SIDE[1])),
        *column_bodies(site, arms, floor, WORKPIECE_SIDE[0]),
        *table_platform(site, platform, arms),
        *table_guide(site, arms, floor),
        *bridge_bodies(site, floor, column_reach(arms)),
    ]
