"""Tracks, columns and gantries: what runs on them stays on them over the whole stroke."""

from __future__ import annotations

from typing import Final

import pytest

from chainbuild.chain.bodies.shapes import shown_limits
from tests.kit.drawn_arms import drawn
from tests.kit.solid_bodies import gap, placed, span

_GAP: Final = 1e-3  # m: what is closer than a millimetre looks like one piece
_ON: Final = 1e-6  # m: bodies are rounded to micrometres


def test_a_lifted_robot_stands_clear_of_its_column_over_the_stroke() -> None:
    chain, site, bodies = drawn("robot_tilting_table_kin210", False)
    lift = [axis.name for axis in chain.axes].index("Z")
    for value in (chain.axes[lift].lower, chain.axes[lift].upper):
        axes = site.home.copy()
        axes[lift] = value
        objects = placed(chain, axes, bodies)
        column = next(n for n, body in enumerate(bodies) if body.part == "column")
        carriage = [n for n, body in enumerate(bodies) if body.link == "Z_link" and body.part == "carriage"]
        assert min(gap(objects[column], objects[n]) for n in carriage) <= _GAP
        robot = [n for n, body in enumerate(bodies) if body.link not in (bodies[column].link, "Z_link", "base")]
        assert min(gap(objects[column], objects[n]) for n in robot) > 0.0


@pytest.mark.parametrize("name", ["gantry_ss", "gantry_robot_kin210"])
def test_a_ram_stays_in_its_carriage_and_the_bridge_on_its_runways(name: str) -> None:
    chain, site, bodies = drawn(name, False)
    low, high = shown_limits(chain)
    ram = next(n for n, body in enumerate(bodies) if body.part == "ram")
    slide = next(n for n, body in enumerate(bodies) if body.part == "carriage" and body.link == site.tool_path[1].child)
    trucks = [n for n, body in enumerate(bodies) if body.part == "carriage" and body.link == site.tool_path[0].child]
    beams = [n for n, body in enumerate(bodies) if body.part == "beam"]
    for share in (0.0, 1.0):
        axes = site.home.copy()
        axes[:3] = (low + share * (high - low))[:3]
        objects = placed(chain, axes, bodies)
        assert gap(objects[ram], objects[slide]) <= 0.0
        assert all(min(gap(objects[n], objects[m]) for m in beams) <= _GAP for n in trucks)
        foot = site.home.copy()
        foot[:3] = axes[:3]
        bridge = next(n for n, body in enumerate(bodies) if body.part == "bridge")
        assert gap(objects[ram], objects[bridge]) >= -_ON


@pytest.mark.parametrize("name", ["irb2600_track", "scara_sc", "linear_robot_kin206"])
def test_a_carriage_stays_on_its_track(name: str) -> None:
    chain, site, bodies = drawn(name, False)
    low, high = shown_limits(chain)
    first = site.tool_path[0]
    n = [axis.name for axis in chain.axes].index(first.name)
    carriage = next(m for m, body in enumerate(bodies) if body.link == first.child and body.part == "carriage")
    rails = [m for m, body in enumerate(bodies) if body.part == "rail"]
    d = site.direction(first)
    for value in (low[n], high[n]):
        axes = site.home.copy()
        axes[n] = value
        objects = placed(chain, axes, bodies)
        spans = [span(objects[m], d) for m in (carriage, rails[0])]
        assert spans[1][0] - _ON <= spans[0][0] < spans[0][1] <= spans[1][1] + _ON
        assert all(gap(objects[carriage], objects[m]) <= _GAP for m in rails)
