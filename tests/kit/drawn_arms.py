"""The shipped robots as they are drawn, each built once."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import Body
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.elements import Chain
from chainbuild.drawing.arms import arm_bodies
from chainbuild.drawing.shown import shown_chain
from chainbuild.drawing.site import Site
from chainbuild.robot import Robot
from tests.kit.drawn_robots import ROBOTS

FILE: Final = Path(__file__).parents[1] / "data" / "drawn_arms.json"
SHIPPED: Final = (
    "kr6r900", "kr6r900_2", "irb2600", "tx2_60", "comau_calibrated", "parallelogram_nr", "arm_nn", "arm_nr5", "arm_rr",
    "scara_cc", "scara_sc", "cylinder_cs", "gantry_ss", "palletiser_nr4", "palletiser_kin96", "palletiser_kin213",
    "linear_robot_kin206", "irb2600_track", "irb2600_table", "robot_xy_unit_kin210", "gantry_robot_kin210",
    "robot_tilting_table_kin210", "irb2600_flange", "robot_head_kin210",
)  # fmt: skip
PINNED: Final = (*SHIPPED, "arm", "scara")
RODS: Final = ("parallelogram_nr", "palletiser_kin96")
CASES: Final = (*((name, False) for name in SHIPPED), *((name, True) for name in RODS))


@cache
def drawn(name: str, rods: bool) -> tuple[Chain, Site, tuple[Body, ...]]:
    """Return chain, site and bodies of a robot, with the rods of a parallelogram or without."""
    chain = (ROBOTS[name]() if name in ROBOTS else Robot.load(name)).chain
    if rods:
        chain = shown_chain(chain)
    site = Site(chain)
    return chain, site, tuple(arm_bodies(site))


def pose(chain: Chain, seed: int) -> Vector:
    """Return axis values (n_axes,) in the inner part of what is shown."""
    low, high = shown_limits(chain)
    inside: Vector = low + (high - low) * np.random.default_rng(seed).uniform(0.2, 0.8, len(low))
    return inside


def extents_mm(name: str) -> dict[str, list[float]]:
    """Return what every link of a robot spans at home, x, y, z from and to, and the mean of its bodies' places [mm]."""
    _, site, bodies = drawn(name, name in RODS)
    spans: dict[str, list[float]] = {}
    for link in sorted({body.link for body in bodies}):
        ends, places = [], []
        for body in bodies:
            if body.link == link:
                T, half = site.links[link] @ body.T_link_body, half_sizes(body)
                places.append(T[:3, 3])
                ends += [T[:3, 3] - np.abs(T[:3, :3]) @ half, T[:3, 3] + np.abs(T[:3, :3]) @ half]
        low, high = np.min(ends, axis=0), np.max(ends, axis=0)
        measures = [*np.column_stack([low, high]).ravel(), *np.mean(places, axis=0)]
        spans[link] = [round(float(measure) * 1000.0, 1) + 0.0 for measure in measures]
    return spans


def half_sizes(body: Body) -> Vector:
    """Return half the edges (3,) of the box around a body, along its own axes [m]."""
    if body.kind == "box":
        return np.array(body.dimensions) / 2.0
    r = body.dimensions[0]
    return np.array([r, r, body.dimensions[1] / 2.0 if body.kind == "cylinder" else r])


if __name__ == "__main__":  # writes the file anew, where a rule of the drawing was changed on purpose
    known = json.dumps({name: extents_mm(name) for name in PINNED}, separators=(",", ":"))
    FILE.write_text(known.replace("},", "},\n") + "\n", "utf-8")
