"""Laws of every drawing: nothing stands inside something else, nothing hangs in the air, nothing is missing."""

from __future__ import annotations

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.bodies.body import TOOL_SIDE, WORKPIECE_SIDE
from chainbuild.drawing.machine import drawn_bodies
from chainbuild.drawing.shown import shown_chain
from chainbuild.drawing.site import Site, home_of
from chainbuild.errors import ChainError
from tests.kit import before_fold
from tests.kit.drawings import check_laws, is_sound
from tests.kit.random_tools import random_tool

RANDOM = 200


@pytest.mark.parametrize("name", chainbuild.shipped())
def test_shipped_machines(name: str) -> None:
    check_laws(chainbuild.Robot.load(name).chain)


@pytest.mark.parametrize("seed", range(RANDOM))
def test_random_machine_tools(seed: int) -> None:
    check_laws(random_tool(np.random.default_rng(seed)))


CASES = dict(before_fold.cases())


@pytest.mark.parametrize("name", CASES)
def test_whatever_a_chain_is_it_can_be_drawn(name: str) -> None:
    """Robots that carry the workpiece, composed machines, types with reversed axes, loops without a pose at home."""
    chain = shown_chain(CASES[name])
    bodies = drawn_bodies(chain)
    assert bodies
    assert all(is_sound(body) for body in bodies)
    assert {body.link for body in bodies} <= {link.name for link in chain.links}


@pytest.mark.parametrize("name", ["kr6r900", "gantry_ss"])
def test_a_robot_that_carries_the_workpiece_looks_the_same_in_other_colours(name: str) -> None:
    machine = chainbuild.load(name)
    carried, carrying = drawn_bodies(machine.chain("gripper")), drawn_bodies(machine.chain())
    arm = {(body.link, body.part, body.kind) for body in carrying if body.part not in ("flange", "tool")}
    assert arm <= {(body.link, body.part, body.kind) for body in carried}
    assert not {body.colour for body in carried} & set(TOOL_SIDE)
    assert {body.link for body in carried if body.colour in WORKPIECE_SIDE} >= {"A6_link"}
    (tool,) = [body for body in carried if body.part == "tool" and body.link == "base"]
    top = tool.T_link_body[:3, 3] + [0.0, 0.0, tool.dimensions[1] / 2]
    np.testing.assert_allclose(top, machine.chain("gripper").frame("tool").T_link_frame[:3, 3], atol=1e-6)


def test_loops_without_a_pose_keep_the_skeleton() -> None:
    chain = CASES["type 37 reversed"]
    assert home_of(chain) is None
    assert {body.part for body in drawn_bodies(chain)} <= {"link", "joint", "rail", "lever", "flange", "tool", "table"}
    with pytest.raises(ChainError, match="no pose to draw"):
        Site(chain)
