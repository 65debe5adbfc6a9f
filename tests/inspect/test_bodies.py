"""Primitive bodies: one a link, of sensible size, in the right place and colour."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from chainbuild.chain.bodies.body import TOOL_SIDE, WORKPIECE_SIDE
from chainbuild.chain.bodies.shapes import detail_bodies, link_bodies, machine_size, shown_limits
from chainbuild.chain.elements import Link
from tests.kit.drawn_robots import ROBOTS, arm, gantry, scara, table


@pytest.mark.parametrize("name", ROBOTS)
def test_every_link_has_exactly_one_body(name: str) -> None:
    chain = ROBOTS[name]().chain
    bodies = link_bodies(chain)
    assert [body.link for body in bodies] == [link.name for link in chain.links]
    assert {body.part for body in bodies} == {"link"}


@pytest.mark.parametrize("name", ROBOTS)
def test_bodies_are_solid_and_no_larger_than_the_machine(name: str) -> None:
    chain = ROBOTS[name]().chain
    size = machine_size(chain)
    counts = {"box": 3, "cylinder": 2, "sphere": 1}
    for body in (*link_bodies(chain), *detail_bodies(chain)):
        assert len(body.dimensions) == counts[body.kind]
        assert min(body.dimensions) > 0.001 * size
        assert max(body.dimensions) < 3.5 * size, body
        np.testing.assert_allclose(body.T_link_body[:3, :3] @ body.T_link_body[:3, :3].T, np.eye(3), atol=1e-12)
        assert np.linalg.det(body.T_link_body[:3, :3]) > 0


def test_a_link_reaches_from_its_joint_to_the_next() -> None:
    chain = arm().chain
    body = next(body for body in link_bodies(chain) if body.link == "A2_link")
    radius, length = body.dimensions
    ends = [body.T_link_body @ [0, 0, side * length / 2, 1] for side in (-1, 1)]
    np.testing.assert_allclose(ends[0][:3], [0, 0, 0], atol=1e-9)
    np.testing.assert_allclose(ends[1][:3], [0.455, 0, 0], atol=1e-9)
    assert 0.03 < radius < 0.1


def test_a_given_radius_is_kept() -> None:
    chain = arm().chain
    links = tuple(Link(link.name, 0.123) if link.name == "A2_link" else link for link in chain.links)
    body = next(body for body in link_bodies(replace(chain, links=links)) if body.link == "A2_link")
    assert body.dimensions[0] == 0.123


def test_rails_span_the_stroke() -> None:
    chain = gantry().chain
    rail = next(body for body in detail_bodies(chain) if body.part == "rail")
    assert rail.link == "base"
    axis_of_rail = rail.T_link_body[:3, 2] * rail.dimensions[2] / 2
    ends = sorted((rail.T_link_body[:3, 3] + side * axis_of_rail)[0] for side in (-1, 1))
    assert -1.0 < ends[0] < 0.0
    assert 20.0 < ends[1] < 21.0


def test_what_carries_the_workpiece_is_told_by_colour() -> None:
    colours = {body.link: body.colour for body in link_bodies(table().chain)}
    assert colours["X_link"] in TOOL_SIDE
    assert colours["A_link"] in WORKPIECE_SIDE
    assert colours["C_link"] in WORKPIECE_SIDE


def test_shown_limits_keep_known_ranges_and_shorten_what_says_nothing() -> None:
    for robot in (arm(), gantry()):
        lower, upper = shown_limits(robot.chain)
        assert list(lower) == [axis.lower for axis in robot.axes]
        assert list(upper) == [axis.upper for axis in robot.axes]
    lower, upper = shown_limits(table().chain)
    assert lower[0] == -upper[0] == -300.0  # assumed ±10 m: about the size of the machine instead
    assert (lower[3], upper[3]) == (-120.0, 30.0)
    assert (lower[4], upper[4]) == (-180.0, 180.0)  # assumed ±360°
    lower, upper = shown_limits(scara().chain)
    assert (lower[3], upper[3]) == (-360.0, 360.0)  # three turns either way
