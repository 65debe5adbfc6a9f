"""The shipped ROBX machines: every arrangement and every kind of additional axis is among them, as their files say."""

from __future__ import annotations

import numpy as np
import pytest

import chainbuild
from chainbuild.formats.sinumerik.machine import RobxMachine
from chainbuild.frames import angles_from_matrix

ROBX = {name: machine for name in chainbuild.shipped() if isinstance(machine := chainbuild.load(name), RobxMachine)}


def test_every_arrangement_is_among_them() -> None:
    arrangements = {machine.transformation().arrangement for machine in ROBX.values()}
    assert arrangements == {"SS", "CC", "NR", "SC", "RR", "CS", "NN"}
    assert {machine.transformation().num_axes for machine in ROBX.values()} == {4, 5, 6}


@pytest.mark.parametrize(
    ("name", "extra"),
    [("irb2600_track", ["EX1"]), ("irb2600_table", ["EW1", "EW2"]), ("irb2600_flange", ["EF1", "EF2"])],
)
def test_additional_axes(name: str, extra: list[str]) -> None:
    axes = ROBX[name].chain().axes
    assert [axis.name for axis in axes if axis.held] == extra


@pytest.mark.parametrize("name", [n for n in ROBX if n.startswith("irb2600_")])
def test_additional_axes_move_what_they_are_for(name: str) -> None:
    plain, robot = chainbuild.Robot(ROBX["irb2600"].chain()), chainbuild.Robot(ROBX[name].chain())
    arm, extra = [10.0, 20.0, -30.0, 40.0, 50.0, 60.0], [axis for axis in robot.axes if axis.held]
    values = [700.0 if axis.kind == "linear" else 35.0 for axis in extra]
    T, still = robot.fk([*arm, *values]), plain.fk(arm)
    if name == "irb2600_track":  # along Y, zero at 500, the robot 300 mm up
        np.testing.assert_allclose(T.translation, still.translation + [0.0, 0.2, 0.3], atol=1e-12)
        np.testing.assert_allclose(T.rotation, still.rotation, atol=1e-12)
    elif name == "irb2600_table":  # the tilted table sees the tool turned back about Y, then about Z
        c, s = np.cos(np.radians(35.0)), np.sin(np.radians(35.0))
        Ry, Rz = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]), np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        centre = np.array([1.1, 0.0, 0.6]) + Ry @ [0.0, 0.0, -0.08 + 0.12]
        np.testing.assert_allclose(T.rotation, Rz.T @ Ry.T @ still.rotation, atol=1e-12)
        np.testing.assert_allclose(T.translation, Rz.T @ Ry.T @ (still.translation - centre), atol=1e-12)
    else:  # 60 mm, about Z, 90 mm, about Y, 70 mm: all from the flange
        c, s = np.cos(np.radians(35.0)), np.sin(np.radians(35.0))
        Ry, Rz = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]), np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        tip = [0.0, 0.0, 0.15] + Rz @ Ry @ [0.0, 0.0, 0.07]
        np.testing.assert_allclose(T.translation, still.translation + still.rotation @ tip, atol=1e-12)
        np.testing.assert_allclose(T.rotation, still.rotation @ Rz @ Ry, atol=1e-12)


def test_the_palletiser_is_the_worked_example() -> None:
    robot = chainbuild.Robot(ROBX["palletiser_nr4"].chain())
    T = robot.fk([0.0, 0.0, 0.0, 0.0])
    np.testing.assert_allclose(T.translation * 1000.0, [1100.0, 0.0, 500.0], atol=1e-9)
    np.testing.assert_allclose(T.rotation, [[0, 0, 1], [1, 0, 0], [0, 1, 0]], atol=1e-12)
    np.testing.assert_allclose(robot.fk([0.0, -90.0, 90.0, 0.0]).translation * 1000.0, [800.0, 0.0, 800.0], atol=1e-9)
    third = robot.fk([30.0, -60.0, 45.0, 20.0]).translation * 1000.0
    np.testing.assert_allclose(third, [813.212306, 469.508344, 820.022186], atol=1e-6)


def test_the_offset_of_c_is_the_one_the_manual_asks_for() -> None:
    """C at mathematical zero, with its sign reversed: at zero both ways of showing C agree."""
    robot = chainbuild.Robot(ROBX["scara_cc"].chain())
    total = robot.chain.absolute_c
    assert total is not None
    zero = np.zeros(4)
    assert total.value(zero) == pytest.approx(angles_from_matrix("orirpy", robot.fk(zero).rotation)[2], abs=1e-12)


def test_the_tool_of_the_overlay_counts() -> None:
    """Length 3 of `arm_nr5` lies along X of the flange, the tool direction."""
    robot = chainbuild.Robot(ROBX["arm_nr5"].chain())
    placed = robot.frame_placements([10.0, 20.0, -30.0, 40.0, 50.0])
    offset = placed["flange"].actInv(placed["tool"]).translation
    np.testing.assert_allclose(offset, [0.16, 0.0, 0.0], atol=1e-12)


@pytest.mark.parametrize("name", ROBX)
def test_first_lines_say_where_the_numbers_come_from(name: str) -> None:
    lines = ROBX[name].path.read_text("utf-8").splitlines()
    comment = " ".join(line for line in lines[:6] if line.startswith(";"))
    assert any(word in comment for word in ("invented", "data sheet", "backup", "manual"))
    assert ROBX[name].overlay.name
    assert ROBX[name].overlay.source
    assert all(axis.max_speed for axis in ROBX[name].chain().axes)
