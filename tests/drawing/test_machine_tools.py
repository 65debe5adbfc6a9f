"""What is drawn of a machine tool: where data put it, on the side that it belongs to."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild.chain.assemble import linear, mark, shift, turn
from chainbuild.chain.bodies.body import TOOL_SIDE, WORKPIECE_SIDE, Body
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.elements import Chain
from chainbuild.drawing.machine import drawn_bodies
from chainbuild.drawing.site import Site
from chainbuild.frames import rot_x
from tests.kit.drawings import gap, islands, placements
from tests.kit.drawn_robots import axis, build
from tests.kit.random_tools import random_tool

HEADS = (
    "ba_head_kin16", "bevel_head_kin76", "ca_head_kin9", "cardan_head_kin59", "cardan_head_kin60", "cross_head_kin5",
    "drill_head_kin7", "oblique_head_kin11", "rotated_head_kin70", "saw_head_kin10", "underfloor_head_kin6",
)  # fmt: skip


def placed(chain: Chain, axes: np.ndarray) -> list[tuple[Body, np.ndarray]]:
    """Return the bodies of a machine with their places at axis values, in the base."""
    bodies = drawn_bodies(chain)
    return list(zip(bodies, placements(chain, bodies, axes), strict=True))


def ends(body: Body, T: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return both ends (3,) of a cylinder's axis."""
    half = T[:3, 2] * body.dimensions[1] / 2
    return T[:3, 3] - half, T[:3, 3] + half


def axle(body: Body, T: np.ndarray, point: np.ndarray, direction: np.ndarray) -> float:
    """Return how far [m] a cylinder's axis is from a line, at its ends."""
    return max(float(np.linalg.norm(np.cross(end - point, direction))) for end in ends(body, T))


def line_of(robot: chainbuild.Robot, axes: np.ndarray, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return a point of a joint's axis and its direction in the base, by Pinocchio."""
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, robot.q(axes))
    joint = next(joint for joint in robot.chain.joints if joint.name == name)
    place = data.oMi[robot.model.getJointId(name)]
    return place.translation, place.rotation @ joint.direction


def tip_of(robot: chainbuild.Robot, axes: np.ndarray) -> np.ndarray:
    """Return where the tip is in the base, by Pinocchio."""
    data = robot.model.createData()
    pin.framesForwardKinematics(robot.model, data, robot.q(axes))
    place: np.ndarray = data.oMf[robot.model.getFrameId("tool")].translation
    return place


def somewhere(robot: chainbuild.Robot) -> np.ndarray:
    """Return axis values away from home, inside the limits."""
    low, high = shown_limits(robot.chain)
    return low + 0.6 * (high - low)


@pytest.mark.parametrize("name", HEADS)
def test_the_tool_ends_at_the_tip_wherever_the_machine_stands(name: str) -> None:
    robot = chainbuild.Robot.load(name)
    axes = somewhere(robot)
    tool = next(pair for pair in placed(robot.chain, axes) if pair[0].part == "tool")
    assert min(float(np.linalg.norm(end - tip_of(robot, axes))) for end in ends(*tool)) < 2e-6
    assert tool[0].origin == "data"


@pytest.mark.parametrize(("name", "joint", "parts"), [
    ("ca_head_kin9", "A", ("joint",)), ("ca_head_kin9", "C", ("plate", "housing")),
    ("ba_head_kin16", "B", ("joint",)), ("ba_head_kin16", "A", ("joint",)),
    ("cardan_head_kin59", "A", ("joint", "housing")), ("oblique_head_kin11", "B", ("joint", "housing")),
    ("ac_table_kin58", "A", ("joint",)), ("ac_table_kin58", "C", ("table", "housing")),
    ("cac_table_kin64", "C1", ("plate", "housing")), ("b_head_a_table_kin61", "A", ("joint",)),
])  # fmt: skip
def test_what_turns_is_drawn_about_its_axis(name: str, joint: str, parts: tuple[str, ...]) -> None:
    robot = chainbuild.Robot.load(name)
    axes = somewhere(robot)
    point, direction = line_of(robot, axes, joint)
    place = next(one for one in robot.chain.joints if one.name == joint)
    links = {"housing": place.parent}
    for part in parts:
        link = links.get(part, place.child)
        found = [pair for pair in placed(robot.chain, axes) if pair[0].part == part and pair[0].link == link]
        assert found
        assert min(axle(*pair, point, direction) for pair in found) < 2e-6


@pytest.mark.parametrize("seed", [*range(12), 25, 38])
def test_guides_reach_as_far_as_the_slides(seed: int) -> None:
    chain = random_tool(np.random.default_rng(seed))
    bodies = drawn_bodies(chain)
    for end in ("lower", "upper"):
        axes = np.array([getattr(axis, end) if axis.kind == "linear" else 0.0 for axis in chain.axes])
        assert len(islands(chain, bodies, axes, 1e-3)) == 1


@pytest.mark.parametrize("seed", range(20))
def test_the_tool_clears_the_part_at_the_lowest(seed: int) -> None:
    chain = random_tool(np.random.default_rng(seed))
    pairs = placed(chain, np.array([axis.lower if axis.name == "Z" else 0.0 for axis in chain.axes]))
    parts = [pair for pair in pairs if pair[0].part == "workpiece"]
    tool = next(pair for pair in pairs if pair[0].part == "tool")
    assert all(gap(*part, *tool) > 0.0 for part in parts)


def test_what_has_no_room_under_the_tip_has_no_part() -> None:
    parts = {name: [body.part for body in drawn_bodies(chainbuild.Robot.load(name).chain)] for name in ROOMS}
    assert {name: "workpiece" in found for name, found in parts.items()} == ROOMS


ROOMS = {"ac_table_kin58": True, "oblique_head_kin11": False, "b_head_a_table_kin61": False, "ca_head_kin9": True}


def test_the_side_that_carries_the_workpiece_is_told_by_colour() -> None:
    bodies = drawn_bodies(chainbuild.Robot.load("ba_head_c_table_kin82").chain)
    cool = {body.link for body in bodies if body.colour in WORKPIECE_SIDE}
    warm = {body.link for body in bodies if body.colour in TOOL_SIDE}
    assert (cool, warm) == ({"C_link"}, {"X_link", "Y_link", "Z_link", "B_link", "A_link"})


def test_up_is_the_axis_of_the_base_nearest_to_the_workpiece_z() -> None:
    lying = build(
        "lying",
        [axis("X", -300, 300), axis("Y", -300, 300), axis("Z", -300, 0)],
        [linear("X", "x"), linear("Z", "z"), linear("Y", "y"), turn(rot_x(90.0)), shift(z=-100.0), mark("flange")],
        (turn(rot_x(80.0)),),
    ).chain
    up = Site(lying).links["base"][:3, :3].T @ np.array([0.0, 0.0, 1.0])
    np.testing.assert_allclose(up, [0.0, -1.0, 0.0], atol=1e-12)
    assert np.linalg.det(Site(lying).links["base"][:3, :3]) == pytest.approx(1.0)
