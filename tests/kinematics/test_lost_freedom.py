"""Arms of six axes that are singular in every position: said when they are built, and the task stays the pose."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild import frames
from chainbuild.chain.assemble import Element, Fixed, assemble, linear, mark, rotary, shift, turn
from chainbuild.chain.elements import Axis, Chain

A_M = (0.2951, 0.4270, 0.0, 0.0, 0.0, 0.1680)
D_M = (0.0, 0.9954, 0.6455, 0.0, 0.0, 0.0)
ALPHA_DEG = (-90.0, 90.0, 90.0, 90.0, 90.0, -90.0)


def chain_of(axes: list[Axis], elements: list[Element]) -> Chain:
    body = assemble(axes, [*elements, mark("flange")])
    return Chain(
        "arm", "an arm", "test", "test", body.links, body.joints, body.frames, tuple(axes), body.axis_map, "rpy"
    )


def arm(alpha_deg: tuple[float, ...], d_m: tuple[float, ...] = D_M, before: str = "") -> chainbuild.Robot:
    """Six joints by Denavit-Hartenberg parameters, on a rail where its direction is given."""
    names = [f"A{n + 1}" for n in range(6)]
    axes = [Axis(name, "rotary", "deg", -170.0, 170.0, False) for name in names]
    elements: list[Element] = []
    if before:
        axes.insert(0, Axis("X", "linear", "mm", -500.0, 500.0, False))
        elements.append(linear("X", before))
    for name, a, d, alpha in zip(names, A_M, d_m, alpha_deg, strict=True):
        elements += [rotary(name, "z"), Fixed(frames.dh_link(1000.0 * d, 1000.0 * a, alpha))]
    return chainbuild.Robot(chain_of(axes, elements))


def test_an_arm_that_is_singular_everywhere_says_so_and_is_given_poses() -> None:
    robot = arm(ALPHA_DEG)
    (finding,) = robot.chain.findings
    assert (finding.code, finding.severity) == ("CB601", "warning")
    assert "5 of the 6 freedoms of a pose in every position" in finding.text
    assert robot.task == "pose"
    assert robot.kinematics.chain is robot.chain


def test_an_orientation_that_it_cannot_reach_is_no_success() -> None:
    robot = arm(ALPHA_DEG)
    T = robot.fk([10.0, 20.0, 30.0, 40.0, 50.0, 60.0])
    assert robot.ik(T).success
    turned = pin.SE3(T.rotation @ pin.exp3(np.array([0.0, 0.0, 0.5])), T.translation)
    result = robot.ik(turned)
    assert not result.success
    assert not robot.ik_batch([turned]).success.any()


def test_it_is_said_once_however_often_it_is_built() -> None:
    robot = arm(ALPHA_DEG)
    assert len(chainbuild.Robot(robot.chain).chain.findings) == 1
    assert len(pickle.loads(pickle.dumps(robot)).chain.findings) == 1
    assert len(copy.deepcopy(robot).chain.findings) == 1


def test_an_arm_with_six_freedoms_and_one_on_a_rail_say_nothing() -> None:
    upright = (-90.0, 0.0, 90.0, -90.0, 90.0, 0.0)
    assert not arm(upright, (0.3, 0.0, 0.0, 0.6, 0.0, 0.1)).chain.findings
    assert arm(upright).chain.findings  # its wrist meets in a point of A3, which then does not move it
    assert not arm(ALPHA_DEG, before="y").chain.findings


def test_a_machine_tool_with_an_axis_too_many_is_still_given_directions() -> None:
    names = ("X", "Y", "Z", "W")
    axes = [Axis(name, "linear", "mm", -500.0, 500.0, False) for name in names]
    axes += [Axis(name, "rotary", "deg", -100.0, 100.0, False) for name in ("C", "B")]
    elements: list[Element] = [linear("X", "x"), linear("Y", "y"), linear("Z", "z"), rotary("C", "z"), rotary("B", "y")]
    robot = chainbuild.Robot(chain_of(axes, [*elements, linear("W", "z"), shift(z=-100.0)]))
    assert (robot.task, len(robot.chain.findings)) == ("direction", 0)


@pytest.mark.parametrize("angle_deg", [0.0, 20.0])
def test_a_joint_through_the_tool_is_no_question_of_position_or_direction(angle_deg: float) -> None:
    """What rounding leaves of the position is no freedom."""
    tilted = turn(frames.rot_x(angle_deg) @ frames.rot_z(3.0 * angle_deg))
    axis = Axis("C", "rotary", "deg", -170.0, 170.0, False)
    robot = chainbuild.Robot(chain_of([axis], [tilted, shift(123.4, 5.6, 7.8), rotary("C", "z")]))
    assert robot.task == "pose"
    assert robot.ik(robot.fk([25.0])).axes == pytest.approx([25.0])
