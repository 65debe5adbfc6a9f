"""Axis offsets of the tool (P-TOOL-00006): where they act, where they do not, and what is said."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from chainbuild.chain.elements import Chain
from chainbuild.errors import ChainbuildError
from chainbuild.formats.overlay import Overlay
from chainbuild.robot import Robot
from tests.kit.named_axes import bezeichnungen
from tests.kit.twincat_files import codes, machine, pose
from tests.kit.universal import CA_HEAD

HEAD = "trafo[0].id 9\ntrafo[0].param[0] 1200000\ntrafo[0].param[1] 300000"
TABLE = "trafo[0].id 58\ntrafo[0].param[5] 600000\ntrafo[0].param[8] -5000000"
CARDAN = "trafo[0].id 59\ntrafo[0].param[0] 1000000\ntrafo[0].param[6] 450000"
NOZZLE = "trafo[0].id 25\ntrafo[0].param[0] 1000000"
GEARED = "trafo[0].id 28\ntrafo[0].param[0] 1000000\ntrafo[0].param[11] 1\ntrafo[0].param[12] 3\ntrafo[0].param[15] 1\n"
GEARED += "trafo[0].param[16] 2"
UNIVERSAL = "\n".join(CA_HEAD.lines())
AXES = np.array([10.0, -20.0, 30.0, 25.0, 15.0])
OFFSETS = {3: 10.0, 4: -7.5}


def chain_of(text: str, offsets: dict[int, float], **conventions: str) -> Chain:
    lines = [f"wz[2].ax_versatz[{k}] {value * 1e4:.0f}" for k, value in offsets.items()] or ["wz[2].laenge 0"]
    found = machine("\n".join([text, *lines]), overlay=Overlay(tool={"number": 2}))
    return found.chain(conventions=conventions)


@pytest.mark.parametrize("text", [HEAD, TABLE, CARDAN, NOZZLE, GEARED, UNIVERSAL])
@pytest.mark.parametrize(("choice", "sign"), [("plus", 1.0), ("minus", -1.0), ("ignored", 0.0)])
def test_an_offset_stands_for_another_axis_value(text: str, choice: str, sign: float) -> None:
    chain = chain_of(text, OFFSETS, tool_axis_offset=choice)
    plain = chain_of(text, {})
    moved = AXES.copy()
    for k, value in OFFSETS.items():
        moved[k] += sign * value
    assert pose(chain, AXES) == pytest.approx(pose(plain, moved), abs=1e-9)
    if sign:
        assert np.abs(pose(chain, AXES) - pose(plain, AXES)).max() > 1.0
    robot = Robot(chain)
    assert robot.axes_from_q(robot.q(AXES)) == pytest.approx(AXES, abs=1e-9)
    assert robot.jacobian(AXES) == pytest.approx(Robot(plain).jacobian(moved), abs=1e-9)


def test_the_default_adds() -> None:
    assert pose(chain_of(HEAD, OFFSETS), AXES) == pytest.approx(
        pose(chain_of(HEAD, {}), AXES + [0, 0, 0, 10.0, -7.5]), abs=1e-9
    )


@pytest.mark.parametrize("text", [HEAD, TABLE, UNIVERSAL])
def test_joint_values_stay_the_axis_values(text: str) -> None:
    robot = Robot(chain_of(text, OFFSETS))
    q = dict(zip([joint.name for joint in robot.chain.joints], robot.q(AXES), strict=True))
    assert [np.degrees(q[name]) for name in (axis.name for axis in robot.axes[3:])] == pytest.approx([25.0, 15.0])


def texts(chain: Chain) -> Sequence[str]:
    return [finding.text for finding in chain.findings if finding.code == "CB418"]


def test_what_is_said() -> None:
    assert texts(chain_of(HEAD, OFFSETS)) == [
        "wz[2].ax_versatz[3] acts on axis C: it stands at its value + 10 deg",
        "wz[2].ax_versatz[4] acts on axis A: it stands at its value - 7.5 deg",
    ]
    assert texts(chain_of(HEAD, {3: 10.0}, tool_axis_offset="minus")) == [
        "wz[2].ax_versatz[3] acts on axis C: it stands at its value - 10 deg"
    ]
    assert texts(chain_of(HEAD, {3: 10.0}, tool_axis_offset="ignored")) == [
        "wz[2].ax_versatz[3] acts on axis C: it is ignored as chosen"
    ]
    used = {one.convention.name for one in chain_of(HEAD, OFFSETS).conventions}
    assert "tool_axis_offset" in used
    assert "tool_axis_offset" not in {one.convention.name for one in chain_of(HEAD, {0: 5.0, 3: 0.0}).conventions}


@pytest.mark.parametrize("k", [0, 1, 2])
def test_the_first_three_axes_take_none(k: int) -> None:
    chain = chain_of(HEAD, {k: 5.0})
    assert texts(chain) == [
        f"wz[2].ax_versatz[{k}] has no effect while the transformation is active: the first three axes take none"
    ]
    assert pose(chain, AXES) == pytest.approx(pose(chain_of(HEAD, {}), AXES), abs=1e-12)


def test_complete_transformations_take_none() -> None:
    arm = "trafo[0].id 45\ntrafo[0].param[6] 4000000\ntrafo[0].param[7] 4550000\ntrafo[0].param[8] 4200000"
    chain = chain_of(arm, {3: 10.0})
    assert texts(chain) == [
        "wz[2].ax_versatz[3] has no effect: KIN_TYP 45 is a complete transformation, which moves all axes"
    ]
    axes = [5.0] * 6
    assert pose(chain, axes) == pytest.approx(pose(chain_of(arm, {}), axes), abs=1e-12)
    complete = UNIVERSAL.replace("rtcp 1", "rtcp 0")
    assert pose(chain_of(complete, OFFSETS), AXES) == pytest.approx(pose(chain_of(complete, {}), AXES), abs=1e-12)


def test_nothing_is_said_without_an_offset_or_without_the_tool() -> None:
    assert codes(chain_of(HEAD, {3: 0.0, 0: 0.0})) == []
    assert codes(chain_of(HEAD, {7: 10.0})) == []  # an axis that the kinematic does not have
    assert "CB418" not in codes(machine(f"{HEAD}\nwz[2].ax_versatz[3] 100000").chain())


def test_of_two_steps_it_acts_in_the_first() -> None:
    steps = f"{HEAD}\nkin_step[1].trafo[0].id 58\ndefault_id_of_kin_step[0] 9\ndefault_id_of_kin_step[1] 58"
    moved = AXES + [0, 0, 0, 10.0, 0]
    T = pose(chain_of(steps, {3: 10.0}), AXES)
    # Step 0 gives the position for the axis as it stands; what passes through is the value as programmed.
    head = pose(chain_of(HEAD, {}), moved)
    table = machine("trafo[0].id 58").chain()
    assert pytest.approx(pose(table, [*head[:3, 3], *AXES[3:]]), abs=1e-8) == T


def limited(text: str, offsets: dict[int, float], **overlay: Any) -> Robot:
    lines = [f"wz[2].ax_versatz[{k}] {value * 1e4:.0f}" for k, value in offsets.items()]
    return Robot(machine("\n".join([text, *lines]), overlay=Overlay(tool={"number": 2}, **overlay)).chain())


@pytest.mark.parametrize("text", [HEAD, TABLE, GEARED, CARDAN])
@pytest.mark.parametrize(("choice", "sign"), [("plus", 1.0), ("minus", -1.0), ("ignored", 0.0)])
def test_the_drives_stand_where_the_offset_puts_the_axes(text: str, choice: str, sign: float) -> None:
    robot, plain = Robot(chain_of(text, OFFSETS, tool_axis_offset=choice)), Robot(chain_of(text, {}))
    moved = AXES.copy()
    for k, value in OFFSETS.items():
        moved[k] += sign * value
    assert robot.drives(AXES) == pytest.approx(plain.drives(moved), abs=1e-9)
    if robot.chain.drives is not None and plain.chain.drives is not None:
        derivative = robot.chain.drives.derivative(AXES)
        assert derivative == pytest.approx(plain.chain.drives.derivative(moved), abs=1e-9)
        assert (robot.chain.drives.follows == plain.chain.drives.follows).all()
        assert robot.chain.drives.turning == plain.chain.drives.turning
        assert set(robot.chain.drives.differing) >= set(plain.chain.drives.differing)


def test_of_a_plain_head_it_is_the_value_plus_the_offset() -> None:
    assert Robot(chain_of(HEAD, {3: 10.0, 4: 5.0})).drives([0, 0, 0, 10, 20])[3:].tolist() == [20.0, 25.0]


def test_limits_are_those_of_the_drive() -> None:
    """Programmed to 90, the axis stands at 100."""
    robot = limited(HEAD, {4: 10.0}, drive_limits={"A": (-95.0, 95.0)})
    assert (robot.axes[4].lower, robot.axes[4].upper) == (-105.0, 85.0)
    assert robot.violated_limits([0, 0, 0, 0, 90]) == ("A_drive",)
    assert robot.violated_limits([0, 0, 0, 0, -100]) == ()
    bent = limited(CARDAN, {3: 10.0, 4: 5.0}, drive_limits={"A": (-60.0, 60.0)})
    assert bent.violated_limits([0, 0, 0, 0, 36]) == ()
    assert bent.violated_limits([0, 0, 0, 0, 38]) == ("A_drive",)
    assert bent.violated_limits([0, 0, 0, 0, -45]) == ()


def test_what_a_head_reaches_moves_with_the_offset() -> None:
    a = limited(CARDAN, {4: 5.0}).axes[4]
    assert (a.lower, a.upper) == pytest.approx((-95.0, 85.0), abs=1e-9)


def test_whole_turns_stay_whole_turns() -> None:
    lengths = dict.fromkeys("XYZ", (-3000.0, 3000.0))
    robot = limited(CARDAN, {3: 10.0}, limits={**lengths, "C": (200.0, 500.0)})
    found = [one.axes for one in robot.ik_all(robot.fk([1, 2, 3, 300, 20]))]
    assert any(axes == pytest.approx([1, 2, 3, 300, 20], abs=1e-6) for axes in found)
    assert robot.ik(robot.fk([1, 2, 3, 300, 20]), start=[0, 0, 0, 490, 20]).success


def test_the_channels_names_reach_through_the_offset() -> None:
    text = f"{CARDAN}\n{bezeichnungen({4: 'W_TILT'})}"
    robot = limited(text, {4: 5.0})
    for told in (robot.q, robot.drives):
        with pytest.raises(ChainbuildError) as error:
            told([0, 0, 0, 0, 120])
        assert error.value.parameter == "W_TILT"
