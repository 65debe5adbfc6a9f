"""Axes by the channel's own names: $MC_AXCONF_CHANAX_NAME_TAB."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild import ChainbuildError, Robot
from chainbuild.chain.names import axis_index
from chainbuild.errors import MachineDataError
from chainbuild.formats.overlay import Overlay
from chainbuild.tables import AxisTable
from tests.kit.named_axes import channel_axis_names, named_machine
from tests.kit.robx_files import FLANGE, NR6, TABLE, read, robx_text

ARM = {n: f"RA{n}" for n in range(1, 7)}
ALL = {**ARM, 7: "SCHLITTEN", 8: "DREH", 9: "KIPP", 10: "KOPF"}


def chain(data: object = NR6, names: object = ARM, **options: object) -> chainbuild.Chain:
    text = robx_text(data, extra=channel_axis_names(names), **options)  # type: ignore[arg-type]
    return read(text).chain()


def test_the_robot_s_axes() -> None:
    plain, named = read(robx_text(NR6)).chain(), chain()
    assert [axis.name for axis in named.axes] == [f"RA{n}" for n in range(1, 7)]
    assert [axis.generic for axis in named.axes] == [f"A{n}" for n in range(1, 7)]
    assert [joint.name for joint in named.joints] == [f"RA{n}" for n in range(1, 7)]
    values = [10, -70, 80, 15, 25, 35]
    assert np.array_equal(Robot(named).fk(values).homogeneous, Robot(plain).fk(values).homogeneous)


def test_names_follow_the_channel_axes_that_the_transformation_takes() -> None:
    # Channel axes 1 and 2 are none of the robot's: a name taken by the place in the transformation would be shifted.
    names = {1: "X", 2: "Y", **{n + 2: f"RA{n}" for n in range(1, 7)}}
    limits = "".join(f"$MA_POS_LIMIT_MINUS[AX{n}]={-n}\n$MA_POS_LIMIT_PLUS[AX{n}]={n}\n" for n in range(1, 9))
    text = robx_text(NR6, axes_in=range(3, 9), extra=channel_axis_names(names) + limits)
    found = read(text).chain()
    assert [(axis.name, axis.upper) for axis in found.axes] == [(f"RA{n}", n + 2) for n in range(1, 7)]
    turned = read(robx_text(NR6, axes_in=(6, 5, 4, 3, 2, 1), extra=channel_axis_names(ARM))).chain()
    assert [axis.name for axis in turned.axes] == ["RA6", "RA5", "RA4", "RA3", "RA2", "RA1"]
    assert [axis.generic for axis in turned.axes] == [f"A{n}" for n in range(1, 7)]


@pytest.mark.parametrize(
    ("data", "inputs", "generic", "names"),
    [
        (TABLE, (1, 2, 3, 4, 5, 6, 0, 0, 0, 8, 9), ["EW1", "EW2"], ["DREH", "KIPP"]),
        (FLANGE, (1, 2, 3, 4, 5, 6, 0, 0, 0, 0, 0, 0, 10, 8), ["EF1", "EF2"], ["KOPF", "DREH"]),
        ({**NR6, "EXT_AXIS_VECTOR_1": (0, 1, 0)}, (1, 2, 3, 4, 5, 6, 7), ["EX1"], ["SCHLITTEN"]),
        (
            {**TABLE, "EXT_AXIS_VECTOR_1": (0, 1, 0)},
            (1, 2, 3, 4, 5, 6, 7, 0, 0, 8, 9),
            ["EX1", "EW1", "EW2"],
            ["SCHLITTEN", "DREH", "KIPP"],
        ),
    ],
)
def test_additional_axes(data: object, inputs: tuple[int, ...], generic: list[str], names: list[str]) -> None:
    found = chain(data, ALL, axes_in=inputs)
    assert [axis.name for axis in found.axes[6:]] == names
    assert [axis.generic for axis in found.axes[6:]] == generic
    assert all(axis.held for axis in found.axes[6:])
    plain = read(robx_text(data, axes_in=inputs)).chain()  # type: ignore[arg-type]
    assert [axis.carries for axis in found.axes] == [axis.carries for axis in plain.axes]
    values = [10, -70, 80, 15, 25, 35, *(5 * n for n in range(1, len(names) + 1))]
    T = Robot(plain).fk(values).homogeneous
    assert np.array_equal(Robot(found).fk(values).homogeneous, T)
    robot = Robot(found)
    for called in (names, generic, [name.lower() for name in generic]):
        answer = robot.ik(
            T, start=[*values[:6], *([0.0] * len(names))], held=dict(zip(called, values[6:], strict=True))
        )
        assert answer.axes == pytest.approx(values, abs=1e-5)


def test_the_second_body_of_a_riding_table_follows_the_name() -> None:
    text = robx_text({**TABLE, "EXT_AXIS_VECTOR_1": (0, 1, 0)}, axes_in=(1, 2, 3, 4, 5, 6, 7, 0, 0, 8, 9),
                     extra=channel_axis_names(ALL))  # fmt: skip
    found = read(text).chain(conventions={"table_origin": "riding"})
    joints = [joint.name for joint in found.joints]
    assert {"SCHLITTEN", "SCHLITTEN_table"} <= set(joints)
    assert not any(name.startswith("EX1") for name in joints)


def test_a_channel_may_call_another_axis_a1() -> None:
    found = chain(names={1: "A2", 2: "A1", 3: "A3"})
    assert [axis.name for axis in found.axes] == ["A2", "A1", "A3", "A4", "A5", "A6"]
    assert [axis_index(found.axes, name) for name in ("A1", "A2", "a1")] == [1, 0, 1]
    assert "CB119" not in [finding.code for finding in found.findings]


def test_a_name_that_is_another_axis_generic_one() -> None:
    found = chain(names={1: "A4"})
    assert [axis.name for axis in found.axes] == ["A4", "A2", "A3", "A4_2", "A5", "A6"]
    (told,) = [finding for finding in found.findings if finding.code == "CB119"]
    assert "A4 is the name of another axis than A4 of the robot, which is called A4_2" in told.text
    assert "$MC_AXCONF_CHANAX_NAME_TAB[3] is missing" in str(told.hint)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("STATUS", "like a column of the tables"),
        ("qx", "like a column of the tables"),
        ("IT", "like a column of the tables"),
        ("X1_DRIVE", "like the column of a drive"),
        ("A 1", "the axis is called 'A 1'"),
        ("A,1", "the axis is called 'A,1'"),
        ("ra1", "two axes of a channel are called 'ra1', also in line"),
    ],
)
def test_names_that_are_refused(name: str, text: str) -> None:
    source = robx_text(NR6, extra=channel_axis_names({1: "RA1", 9: name}))
    with pytest.raises(MachineDataError) as caught:
        read(source)
    assert caught.value.code == "CB118"
    assert text in caught.value.message
    assert caught.value.span is not None
    assert caught.value.span.line == source.splitlines().index(f'N20080 $MC_AXCONF_CHANAX_NAME_TAB[8]="{name}"') + 1
    assert caught.value.parameter == "$MC_AXCONF_CHANAX_NAME_TAB[8]"


def test_names_of_two_channels_may_be_the_same() -> None:
    text = robx_text(NR6, extra=f"CHANDATA(2)\n{channel_axis_names({1: 'RA1'})}CHANDATA(1)\n{channel_axis_names(ARM)}")
    assert read(text).chain().axes[0].name == "RA1"


@pytest.mark.parametrize(("name", "codes"), [("A-1", ["CB119"]), ("A" * 32, ["CB119"]), ("A" * 31, []), ("", [])])
def test_names_in_doubt(name: str, codes: list[str]) -> None:
    machine = read(robx_text(NR6, extra=channel_axis_names({1: name})))
    assert [finding.code for finding in machine.findings if finding.code == "CB119"] == codes
    assert machine.chain().axes[0].name == (name or "A1")


def test_messages_and_overlay_by_the_name() -> None:
    text = robx_text(NR6, extra=channel_axis_names(ARM) + "$MA_POS_LIMIT_PLUS[AX2]=90")
    machine = read(text, overlay=Overlay(limits={"A1": (-1.0, 2.0), "RA3": (-3.0, 4.0)}))
    assert "axis RA2 has only the upper software limit" in machine.findings[0].text
    assert [axis.upper for axis in machine.chain().axes[:3]] == [2, 90, 4]
    with pytest.raises(ChainbuildError, match="'A1' and 'ra1' are the same axis RA1"):
        read(text, overlay=Overlay(limits={"A1": (-1.0, 2.0), "ra1": (-3.0, 4.0)})).chain()


@pytest.mark.parametrize("name", ["irb2600_track", "parallelogram_nr", "scara_sc", "gantry_ss", "arm_nr5"])
def test_shipped_robots_by_other_names(name: str, tmp_path: Path) -> None:
    plain = Robot.load(name)
    names = [f"ROB_{axis.name}" for axis in plain.axes]
    robot = Robot.load(named_machine(tmp_path, name, dict(enumerate(names, start=1))))
    assert [axis.name for axis in robot.axes] == names
    values = [(0.4 * axis.lower + 0.6 * axis.upper) for axis in plain.axes]
    assert np.array_equal(robot.fk(values).homogeneous, plain.fk(values).homogeneous)
    assert robot.pose_angles(values) == plain.pose_angles(values)
    assert robot.violated_limits([axis.upper for axis in robot.axes]) == plain.violated_limits(
        [axis.upper for axis in plain.axes]
    )
    # The same numbers whatever the columns are called.
    row = ",".join(f"{value:.9f}" for value in values)
    for columns in (names, [axis.name for axis in plain.axes]):
        path = tmp_path / "axes.csv"
        path.write_text(f"{','.join(columns)}\n{row}\n")
        with AxisTable(path, robot.axes) as table:
            assert next(read for _, read in table.rows()) == pytest.approx(values, abs=1e-8)
    urdf = chainbuild.write_urdf(robot, tmp_path)
    back = Robot.from_urdf(urdf, tool="tool")
    assert {axis.name for axis in back.axes} >= {axis.name for axis in robot.axes if axis.carries == "tool"}


def test_a_parallelogram_with_rods_by_other_names(tmp_path: Path) -> None:
    plain = Robot.load("parallelogram_nr")
    robot = Robot.load(named_machine(tmp_path, "parallelogram_nr", ARM))
    joints = [joint.name for joint in robot.chain.joints]
    assert joints == [f"R{j.name}" if j.name.startswith("A") else j.name for j in plain.chain.joints]
    text = chainbuild.write_urdf(robot, tmp_path).read_text("utf-8")
    plain_text = chainbuild.write_urdf(plain, tmp_path).read_text("utf-8")
    assert text.count("<mimic") == plain_text.count("<mimic")
