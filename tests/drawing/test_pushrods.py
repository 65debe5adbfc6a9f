"""Rods of parallelogram arms as they are drawn."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
import pytest

from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.bodies.geometry import RodData
from chainbuild.chain.bodies.rods import ROD, has_rods
from chainbuild.chain.poses import link_placements
from chainbuild.drawing.arms import arm_bodies
from chainbuild.drawing.shown import has_parallelogram, shown_chain
from chainbuild.drawing.site import Site
from chainbuild.drawing.tracks import footing
from chainbuild.robot import Robot
from tests.kit.drawn_arms import RODS, SHIPPED, drawn, pose

_ON: Final = 1e-6  # m: bodies are rounded to micrometres


@pytest.mark.parametrize("name", RODS)
def test_rods_meet_their_pins_in_every_pose(name: str) -> None:
    chain, site, bodies = drawn(name, True)
    d = site.direction(site.joints[ROD])
    for seed in range(5):
        axes = pose(chain, seed)
        links = link_placements(chain, chain.axis_map.q(axes))
        places = {
            part: [
                (links[body.link] @ body.T_link_body)[:3, 3]
                for body in bodies
                if body.part == part and abs((site.links[body.link] @ body.T_link_body)[:3, 2] @ d) > 0.99
            ]
            for part in ("rod", "joint")
        }
        across = (
            links[site.joints[ROD].parent][:3, :3]
            @ site.joints[ROD].T_parent_joint[:3, :3]
            @ site.joints[ROD].direction
        )
        for eye in places["rod"]:
            assert min(float(np.linalg.norm(np.cross(pin - eye, across))) for pin in places["joint"]) < 2.0 * _ON


def test_a_rod_is_as_long_as_the_upper_arm_and_beside_it() -> None:
    chain, site, bodies = drawn("parallelogram_nr", True)
    rod = next(body for body in bodies if body.part == "rod" and body.origin == "data")
    shoulder, elbow = footing(site).seats[1:3]
    assert rod.dimensions[1] == pytest.approx(float(np.linalg.norm(elbow.place - shoulder.place)), abs=_ON)
    T = site.links[rod.link] @ rod.T_link_body
    assert T[1, 3] + rod.dimensions[0] < -(shoulder.half + shoulder.plate)  # the operator stands at -Y
    given = replace(chain, geometry=replace(chain.geometry, rod_data=RodData(sideways=0.6)))
    moved = next(body for body in arm_bodies(Site(given)) if body.part == "rod" and body.origin == "data")
    assert (site.links[rod.link] @ moved.T_link_body)[1, 3] == pytest.approx(0.6, abs=_ON)


@pytest.mark.parametrize("name", SHIPPED)
def test_only_parallelogram_arms_get_rods(name: str) -> None:
    chain = Robot.load(name).chain
    shown = shown_chain(chain)
    assert has_rods(shown) == (name in RODS)
    assert shown_chain(shown) is shown
    assert (shown is chain) == (name not in RODS)
    axes = pose(chain, 3)
    assert shown.axes == chain.axes
    np.testing.assert_allclose(Robot(shown).fk(axes).homogeneous, Robot(chain).fk(axes).homogeneous, atol=1e-12)


@pytest.mark.parametrize(("factor", "turned"), [(0.5, False), (-1.0, False), (1.0, True)])
def test_a_gear_between_shoulder_and_elbow_is_no_parallelogram(factor: float, turned: bool) -> None:
    chain = Robot.load("parallelogram_nr").chain
    assert isinstance(chain.axis_map, AffineMap)
    A = chain.axis_map.A.copy()
    A[2, 1] *= factor
    assert has_parallelogram(replace(chain, axis_map=replace(chain.axis_map, A=A))) == turned
