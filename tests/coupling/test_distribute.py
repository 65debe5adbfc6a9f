"""A tool motion handed out to partial kinematics: the five tables of Couple kinematics 4.1 to 4.4, and beyond."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.compose import stack
from chainbuild.coupling.distribution import Distribution
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.robot import Robot
from tests.kit.couplings import AT_TABLE, XY
from tests.kit.twincat_files import chain_of
from tests.kit.universal import CA_HEAD, Universal, X, robot_lines, rotation, shift

LETTERS = "XYZABC"


@pytest.fixture(scope="module")
def robot() -> Robot:
    return chainbuild.Robot(chain_of([*XY, "ori_rotation_angle 4"]))


def values(found: Distribution) -> dict[str, list[float]]:
    return {part.name: part.values.tolist() for part in found.partials}


def expect(found: Distribution, linear: list[float], arm: list[float], tcp: list[float]) -> None:
    assert [part.name for part in found.partials] == ["LINEAR", "ROBOT"]
    assert [part.free for part in found.partials] == [(True, True, False, False, False, False), (True,) * 6]
    assert values(found)["LINEAR"][:2] == pytest.approx(linear, abs=1e-9)
    assert values(found)["ROBOT"] == pytest.approx(arm, abs=1e-9)
    assert found.tcp == pytest.approx(tcp, abs=1e-9)
    assert consistent(found)


def consistent(found: Distribution) -> bool:
    """Return whether the partials' poses, with what lies between them, make the tool position."""
    chain = found.robot.chain
    T = np.eye(4)
    for partial, part in zip(chain.partials, found.partials, strict=True):
        if partial.group == 0:
            T = T @ partial.T_carrier_mcs @ part.T
    return np.allclose(T[:3, 3] * 1000, found.tcp[:3], atol=1e-6) or any(p.group for p in chain.partials)


def test_4_1_partials_programmed_directly(robot: Robot) -> None:
    found = robot.distribute(axes={"ROBOT.X": 1000, "LINEAR.X": 500, "ROBOT.Y": 300, "LINEAR.Y": 0})
    expect(found, [500, 0], [1000, 300, 0, 0, 0, 0], [1500, 300, 0, 0, 0, 0])


def test_4_2_the_tcp_programmed(robot: Robot) -> None:
    found = robot.distribute({"X": 1000, "Y": 500, "Z": 50, "C": 10})
    expect(found, [1000, 500], [0, 0, 50, 0, 0, 10], [1000, 500, 50, 0, 0, 10])
    # After 4.1 the same: what the partials had does not matter where nobody programmed it.
    before = {"ROBOT": [1000, 300, 0, 0, 0, 0], "LINEAR": {"X": 500, "Y": 0}}
    again = robot.distribute({"X": 1000, "Y": 500, "Z": 50, "C": 10}, current=before)
    expect(again, [1000, 500], [0, 0, 50, 0, 0, 10], [1000, 500, 50, 0, 0, 10])


def test_4_3_mixed(robot: Robot) -> None:
    found = robot.distribute({"X": 1000, "Y": 500, "Z": 50, "C": 10}, axes={"LINEAR": {"X": 800, "Y": 0}})
    expect(found, [800, 0], [200, 500, 50, 0, 0, 10], [1000, 500, 50, 0, 0, 10])


def test_a_zero_has_no_sign(robot: Robot) -> None:
    for part in robot.distribute([-0.0] * 6).partials:
        assert part.values.tolist() == [0.0] * 6
        assert not np.signbit(part.values).any()


def test_4_3_along_an_arc(robot: Robot) -> None:
    # The table shows C = 10, which nobody programs: it stands there from before.
    before = {"ROBOT": {"X": 500, "Y": 0, "Z": 1500, "C": 10}, "LINEAR": {"X": 0, "Y": 0}}
    kept = {"LINEAR.X": 0.0, "ROBOT.Y": 0.0}
    for angle in np.radians(np.linspace(90, -90, 37)):
        # G02 from (500, 0) to (500, -500) with radius 250.
        x, y = 500 + 250 * np.cos(angle), -250 + 250 * np.sin(angle)
        found = robot.distribute({"X": x, "Y": y}, axes=kept, current=before)
        expect(found, [0, y], [x, 0, 1500, 0, 0, 10], [x, y, 1500, 0, 0, 10])
    expect(found, [0, -500], [500, 0, 1500, 0, 0, 10], [500, -500, 1500, 0, 0, 10])


def test_4_4_locked(robot: Robot) -> None:
    found = robot.distribute({"X": 1000, "Y": 500, "Z": 50}, axes={"LINEAR.X": 800}, locked=["LINEAR.Y"])
    expect(found, [800, 0], [200, 500, 50, 0, 0, 0], [1000, 500, 50, 0, 0, 0])
    # The lock of the configuration does the same: axis 7 of the channel is Y_LIN.
    locked = chainbuild.Robot(chain_of([*XY, "ori_rotation_angle 4", "trafo[2].lock_dof[7] 1"]))
    expect(
        locked.distribute({"X": 1000, "Y": 500, "Z": 50}, axes={"LINEAR.X": 800}),
        [800, 0], [200, 500, 50, 0, 0, 0], [1000, 500, 50, 0, 0, 0],
    )  # fmt: skip


def test_a_locked_coordinate_can_be_programmed(robot: Robot) -> None:
    found = robot.distribute({"X": 1000, "Y": 500}, axes={"LINEAR.Y": 120}, locked=["LINEAR.Y"])
    assert values(found)["LINEAR"][:2] == pytest.approx([1000, 120])


def test_the_priority_decides_who_moves() -> None:
    lines = [line.replace("move_prio[0] LINEAR", "move_prio[0] TMP") for line in [*XY, "ori_rotation_angle 4"]]
    lines = [line.replace("move_prio[1] ROBOT", "move_prio[1] LINEAR").replace("] TMP", "] ROBOT") for line in lines]
    found = chainbuild.Robot(chain_of(lines)).distribute({"X": 1000, "Y": 500, "Z": 50, "C": 10})
    expect(found, [0, 0], [1000, 500, 50, 0, 0, 10], [1000, 500, 50, 0, 0, 10])
    # What the first cannot do, because it is locked, goes to the next.
    found = chainbuild.Robot(chain_of(lines)).distribute({"X": 1000, "Y": 500}, locked=["ROBOT.X"])
    expect(found, [1000, 0], [0, 500, 0, 0, 0, 0], [1000, 500, 0, 0, 0, 0])


def test_six_values_and_base_offsets() -> None:
    robot = chainbuild.Robot(
        chain_of([*XY, "ori_rotation_angle 4", "trafo[0].base[0] 300000", "trafo[0].base[2] -1000000"])
    )
    found = robot.distribute([1000, 500, 50, 5, 20, 10])
    # Along X the offset is the unit's, along Z only the robot can make up for it.
    expect(found, [1030, 500], [0, 0, -50, 5, 20, 10], [1000, 500, 50, 5, 20, 10])


def test_a_turned_base() -> None:
    robot = chainbuild.Robot(chain_of([*XY, "ori_rotation_angle 4", "trafo[0].base[5] 900000"]))
    found = robot.distribute({"X": 100, "Y": 200, "Z": 300, "C": 10}, axes={"LINEAR.X": 0, "LINEAR.Y": 0})
    # The robot's system is turned by -90 about Z in the unit's: its X is -Y, its C counts from there.
    expect(found, [0, 0], [-200, 100, 300, 0, 0, 100], [100, 200, 300, 0, 0, 10])


def test_an_oblique_slide_takes_what_lies_along_it() -> None:
    slide = Universal([replace(X, orientation=(1, 1, 0))], [0])
    lines = [
        *robot_lines(0), *slide.lines(1, name="LINEAR"), "trafo[2].id 210", "trafo[2].group[0].chain[0] LINEAR",
        "trafo[2].group[0].chain[1] ROBOT", "ori_rotation_angle 4",
    ]  # fmt: skip
    found = chainbuild.Robot(chain_of(lines)).distribute({"X": 100, "Z": 7})
    assert values(found)["LINEAR"][:3] == pytest.approx([50, 50, 0])
    assert values(found)["ROBOT"] == pytest.approx([50, -50, 7, 0, 0, 0])


def test_a_five_axis_head_on_a_robot() -> None:
    robot = chainbuild.Robot.load("robot_head_kin210")
    free = {part.name: part.free for part in robot.distribute().partials}
    # Rotary axes C, A: in mode CAB the head turns about C and A, and shifts.
    assert free["HEAD"] == (True, True, True, True, False, True)
    arm = {"X": 1500.0, "Y": 100.0, "Z": 1400.0, "A": 5.0, "B": 80.0, "C": 12.0}
    head = {"X": 20.0, "Y": -30.0, "Z": 15.0, "A": 3.0, "C": 4.0}
    there = robot.distribute(axes={"ROBOT": arm, "HEAD": head})
    found = robot.distribute(there.tcp.tolist(), axes={"ROBOT": arm})
    assert values(found)["ROBOT"] == pytest.approx(list(arm.values()))
    assert dict(zip(LETTERS, values(found)["HEAD"], strict=True)) == pytest.approx({**head, "B": 0.0}, abs=1e-8)
    # Left to itself the head, which has priority, takes what it can; the robot turns what the head cannot.
    free = robot.distribute(there.tcp.tolist(), current={"ROBOT": arm})
    T = (
        robot.chain.partials[0].T_carrier_mcs
        @ free.partials[0].T
        @ robot.chain.partials[1].T_carrier_mcs
        @ free.partials[1].T
    )
    assert T[:3, 3] * 1000 == pytest.approx(there.tcp[:3], abs=1e-6)
    with pytest.raises(ChainbuildError, match="are left over"):
        robot.distribute((there.tcp + [0, 0, 0, 5, 0, 0]).tolist(), axes={"ROBOT": arm})


def test_a_head_without_slides_is_programmed_by_its_axes() -> None:
    head = Universal(CA_HEAD.axes[3:], [0, 1], (0, 0, 1), (0, 0, -250))
    lines = [
        *robot_lines(0), *head.lines(1, name="HEAD"), "trafo[2].id 210", "trafo[2].group[0].chain[0] ROBOT",
        "trafo[2].group[0].chain[1] HEAD", "ori_rotation_angle 3",
    ]  # fmt: skip
    robot = chainbuild.Robot(chain_of(lines))
    found = robot.distribute({"X": 500, "Z": 800}, axes={"HEAD.C": 30, "HEAD.A": 40})
    expected = rotation((0, 0, 1), 30) @ shift((0, 0, -100)) @ rotation((1, 0, 0), 40) @ shift((0, 0, -150))
    T = found.partials[1].T
    assert T[:3, 3] * 1000 == pytest.approx(expected[:3, 3])
    assert T[:3, :3] == pytest.approx(expected[:3, :3])
    assert found.tcp[:3] == pytest.approx([500, 0, 800])


def test_the_tcp_counts_from_the_workpiece_of_another_group() -> None:
    robot = chainbuild.Robot(chain_of([*AT_TABLE, "ori_rotation_angle 4"]))
    table = {"TABLE.A": 20.0, "TABLE.C": 50.0}
    found = robot.distribute({"X": 300, "Y": 40, "Z": 25, "C": 10}, axes=table)
    T_table = rotation((1, 0, 0), 20) @ rotation((0, 0, 1), 50)
    tool = T_table @ shift((300, 40, 25)) @ rotation((0, 0, 1), 10)
    linear, arm = found.partials[0].T.copy(), found.partials[1].T.copy()
    for T in (linear, arm):
        T[:3, 3] *= 1000
    assert linear @ arm == pytest.approx(tool, abs=1e-9)
    assert linear[:2, 3] == pytest.approx(tool[:2, 3])
    # What is not programmed stays in the workpiece: the robot follows the table.
    again = robot.distribute({}, axes={"TABLE.A": -15.0, "TABLE.C": 5.0}, current=values(found))
    assert again.tcp == pytest.approx(found.tcp)
    moved = rotation((1, 0, 0), -15) @ rotation((0, 0, 1), 5) @ np.linalg.inv(T_table) @ tool
    tip = again.partials[0].T @ again.partials[1].T
    assert tip[:3, 3] * 1000 == pytest.approx(moved[:3, 3], abs=1e-9)
    assert tip[:3, :3] == pytest.approx(moved[:3, :3], abs=1e-12)


def test_axes_are_a_second_step(robot: Robot) -> None:
    found = robot.distribute({"X": 1400, "Y": 300, "Z": 700, "B": 90, "C": 10}, axes={"LINEAR": {"X": 800, "Y": 100}})
    axes = found.axes()
    assert axes[:2] == pytest.approx([800, 100], abs=1e-6)
    T = robot.fk(axes)
    assert T.translation * 1000 == pytest.approx([1400, 300, 700], abs=1e-3)
    again = found.axes(start=axes)
    assert again == pytest.approx(axes, abs=1e-4)


def test_a_partial_that_cannot_reach_is_named(robot: Robot) -> None:
    found = robot.distribute({"X": 5000, "Z": 700}, axes={"LINEAR": {"X": 0, "Y": 0}})
    with pytest.raises(ChainbuildError, match=r"ROBOT cannot reach X5000 Y0 Z700 A0 B0 C0: unreachable"):
        found.axes()


def test_what_nobody_can_do_is_refused(robot: Robot) -> None:
    with pytest.raises(ChainbuildError, match=r"5 mm and 0 deg are left over") as caught:
        robot.distribute({"Z": 5}, locked=["ROBOT.Z"])
    assert "LINEAR: X Y; ROBOT: X Y A B C" in str(caught.value.permitted)
    with pytest.raises(ChainbuildError, match="7 deg are left over"):
        robot.distribute({"B": 7}, locked=["ROBOT.B"])


@pytest.mark.parametrize(
    ("call", "text"),
    [
        ({"tcp": {"Q": 1}}, "there is no coordinate Q"),
        ({"tcp": [1, 2, 3]}, "expected 6 values, got 3"),
        ({"tcp": {"X": float("nan")}}, "X has the value nan"),
        ({"tcp": {"X": "5"}}, "X has the value '5'"),
        ({"axes": {"X": 1}}, "X is not a coordinate of a partial"),
        ({"axes": {"SLIDE.X": 1}}, "there is no partial SLIDE"),
        ({"axes": {"LINEAR.Z": 1}}, "LINEAR cannot be moved in Z by itself"),
        ({"axes": {"ROBOT": {"Q": 1}}}, "ROBOT cannot be moved in Q by itself"),
        ({"axes": {"ROBOT.X": float("inf")}}, "ROBOT.X has the value inf"),
        ({"locked": ["ROBOT.Q"]}, "there is no coordinate Q"),
        ({"locked": ["ROBOT"]}, "ROBOT is not a coordinate of a partial"),
        ({"current": {"SLIDE": {"X": 1}}}, "there is no partial SLIDE"),
    ],
)
def test_refused(robot: Robot, call: dict[str, object], text: str) -> None:
    with pytest.raises(AxisValueError, match=text):
        robot.distribute(**call)  # type: ignore[arg-type]


def test_three_dialects_deep() -> None:
    """Any composed robot can hand a motion out, ROBX and TwinCAT mixed; a single robot gets it all."""
    gantry = chainbuild.load("gantry_robot_kin210").chain("GANTRY")
    arm = chainbuild.load("kr6r900").chain()
    robot = chainbuild.Robot(stack(gantry, np.eye(4), arm, lower_name="GANTRY", upper_name="ARM"))
    found = robot.distribute([1000, 200, -1500, 10, 20, 30])
    by_name = {part.name: part for part in found.partials}
    assert by_name["GANTRY"].values[:3] == pytest.approx([1000, 200, -1500])
    assert by_name["ARM"].values[:3] == pytest.approx([0, 0, 0], abs=1e-9)
    alone = chainbuild.Robot(arm).distribute([500, 100, 600, 10, 20, 30])
    assert alone.partials[0].values == pytest.approx([500, 100, 600, 10, 20, 30])
