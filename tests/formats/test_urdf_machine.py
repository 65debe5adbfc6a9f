"""A URDF where a machine file is taken: `load`, `check`, `Robot.load`, and which link is the tool."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild import Robot
from chainbuild.errors import ChainbuildError

LIMIT = '<limit lower="-2" upper="2" effort="1" velocity="1"/>'
HAND = """<?xml version="1.0"?>
<!-- an arm with two fingers and a camera at its base -->
<robot name="hand">
  <link name="root"/><link name="arm"/><link name="left"/><link name="right"/><link name="camera"/>
  <joint name="J1" type="revolute"><parent link="root"/><child link="arm"/><origin xyz="0 0 0.5"/>
    <axis xyz="0 0 1"/>{limit}</joint>
  <joint name="J2" type="revolute"><parent link="arm"/><child link="left"/><origin xyz="0.4 0 0"/>
    <axis xyz="0 1 0"/>{limit}</joint>
  <joint name="J3" type="prismatic"><parent link="arm"/><child link="right"/><origin xyz="0 0.3 0"/>
    <axis xyz="1 0 0"/>{limit}</joint>
  <joint name="eye" type="fixed"><parent link="root"/><child link="camera"/><origin xyz="0 0 1"/></joint>
</robot>
""".replace("{limit}", LIMIT)


@pytest.fixture
def hand(tmp_path: Path) -> Path:
    path = tmp_path / "hand.urdf"
    path.write_text(HAND, "utf-8")
    return path


@pytest.mark.parametrize("name", ["hand.urdf", "hand.xml", "hand.txt", "hand"])
def test_the_content_tells_what_it_is(hand: Path, name: str) -> None:
    path = hand.rename(hand.with_name(name))
    machine = chainbuild.load(path, tool="left")
    assert (machine.dialect, machine.name) == ("URDF", "hand")
    assert [axis.name for axis in machine.chain().axes] == ["J1", "J2"]


def test_every_way_to_name_the_tool_is_the_same(hand: Path) -> None:
    expected = Robot.from_urdf(hand, tool="right")
    robots = [
        Robot.load(hand, tool="right"),
        Robot.load(hand, "right"),
        Robot(chainbuild.load(hand).chain("right")),
        Robot(chainbuild.load(hand, tool="left").chain("right")),
    ]
    overlay = hand.with_name("hand.chainbuild.toml")
    overlay.write_text('kinematic = "right"\n', "utf-8")
    robots += [Robot.load(hand), Robot.from_urdf(hand)]
    for robot in robots:
        assert [axis.name for axis in robot.axes] == ["J1", "J3"]
        assert (robot.fk([30, 200]).homogeneous == expected.fk([30, 200]).homogeneous).all()
    assert robots[0].fk([0, 200]).translation.tolist() == pytest.approx([0.2, 0.3, 0.5])
    assert [axis.name for axis in Robot.load(hand, tool="left").axes] == ["J1", "J2"]


def test_the_links_that_could_be_the_tool_are_listed(hand: Path) -> None:
    listed = [(entry.name, entry.type, entry.default) for entry in chainbuild.load(hand).kinematics()]
    assert listed == [("left", "URDF", False), ("right", "URDF", False)]
    named = [(entry.name, entry.default) for entry in chainbuild.load(hand, tool="arm").kinematics()]
    assert named == [("arm", True), ("left", False), ("right", False)]
    assert [axis.name for axis in chainbuild.load(hand).chain("arm").axes] == ["J1"]


MISTAKES = {
    "none_named": ({}, "2 links could be the tool; permitted: left, right; name the link"),
    "unknown": ({"tool": "thumb"}, "no joint leads to a link 'thumb'"),
    "the_root": ({"tool": "root"}, "no joint leads to a link 'root'"),
    "fixed": ({"tool": "camera"}, "none of the joints on the way to link camera moves: eye"),
    "another_case": ({"tool": "LEFT"}, "left, right; did you mean left?"),
    "a_number": ({"kinematic": 7}, "no joint leads to a link '7'"),
    "a_pair": ({"kinematic": ("left", "right")}, "the pair ('left', 'right') needs two transformation steps"),
    "channel": ({"tool": "left", "channel": 2}, "there is no channel 2: a URDF has none"),
    "tool_length": ({"tool": "left", "tool_length_mm": 10.0}, "a URDF does not say where its tool points"),
}


@pytest.mark.parametrize(("options", "text"), MISTAKES.values(), ids=MISTAKES)
def test_mistakes(hand: Path, options: dict[str, object], text: str) -> None:
    with pytest.raises(ChainbuildError) as caught:
        Robot.load(hand, **options)  # type: ignore[arg-type]
    assert text in str(caught.value)
    assert str(caught.value).startswith(f"{hand}: ")


NAMED = {
    "tool": ("tool, tool_cover", "tool"),
    "tool0": ("base, ee_link, tool0", "tool0"),
    "panda": ("panda_hand_tcp, panda_leftfinger, panda_rightfinger", "panda_hand_tcp"),
    "ee": ("ee_link, wrist_camera", "ee_link"),
    "none": ("left, right", "right"),
}


@pytest.mark.parametrize(("links", "example"), NAMED.values(), ids=NAMED)
def test_the_example_is_the_link_that_is_called_a_tool_and_nothing_is_chosen_by_it(
    tmp_path: Path, links: str, example: str
) -> None:
    def joint(child: str, kind: str, parent: str = "arm") -> str:
        ends = f'<parent link="{parent}"/><child link="{child}"/><limit lower="-1" upper="1"/>'
        return f'<link name="{child}"/><joint name="to_{child}" type="{kind}">{ends}</joint>'

    inner = joint("arm", "revolute", "root") + joint("workpiece", "fixed", "root")
    file = tmp_path / "arm.urdf"
    ends = "".join(joint(link, "fixed") for link in links.split(", "))
    file.write_text(f'<robot name="a"><link name="root"/>{inner}{ends}</robot>', "utf-8")
    with pytest.raises(ChainbuildError) as caught:
        chainbuild.load(file).chain()
    assert caught.value.permitted == links
    assert f'tool="{example}" (--tool {example})' in str(caught.value)
    assert [entry.name for entry in chainbuild.load(file).kinematics()] == links.split(", ")


FILES = {
    "xacro": (HAND.replace("<robot", '<robot xmlns:xacro="x"').replace("0.4", "${length}"), 7, "xacro, a template of"),
    "cut_off": (HAND[:400], 0, "not well-formed XML"),
    "no_joints": ('<robot name="a"><link name="b"/></robot>', 0, "the file has no joints"),
    "srdf": ('<robot name="a"><group name="b"/><disable_collisions link1="a" link2="b"/></robot>', 1, "this is SRDF"),
    "bad_number": (HAND.replace("0.4 0 0", "0.4 0 x"), 7, 'xyz="0.4 0 x" in <origin>'),
    "two_parents": (HAND.replace('child link="right"', 'child link="left"'), 0, "left"),
    "ball_joint": (HAND.replace('"J2" type="revolute"', '"J2" type="ball"'), 7, "joint J2 is of type ball"),
}


@pytest.mark.parametrize(("text", "line", "said"), FILES.values(), ids=FILES)
def test_files_that_are_no_robot(hand: Path, text: str, line: int, said: str) -> None:
    hand.write_text(text, "utf-8")
    with pytest.raises(ChainbuildError) as caught:
        Robot.load(hand, tool="left")
    assert said in str(caught.value)
    assert not line or f":{line}: " in str(caught.value)
    assert any(finding.severity == "error" for finding in chainbuild.check(hand, tool="left"))


def test_xacro_tells_the_command_that_makes_a_urdf(hand: Path) -> None:
    hand.write_text(FILES["xacro"][0], "utf-8")
    with pytest.raises(ChainbuildError, match=r"expand it first: xacro .*hand\.urdf > robot\.urdf"):
        chainbuild.load(hand)


def test_check_translates_the_tool_that_is_named(hand: Path) -> None:
    assert [finding.severity for finding in chainbuild.check(hand)] == ["error"]
    found = chainbuild.check(hand, tool="left")
    assert [finding.code for finding in found] == ["CB525"]
    assert "J3" in found[0].text


def test_a_tool_link_is_of_a_urdf_alone() -> None:
    with pytest.raises(ChainbuildError, match=r"tool link 'tool0': .* is no URDF, its tool is part of its data"):
        Robot.load("kr6r900", tool="tool0")


def test_conventions_have_no_effect(hand: Path) -> None:
    machine = chainbuild.load(hand, tool="left")
    chain = machine.chain(conventions={"kin36_c": "machine"})
    assert "CB528" in {finding.code for finding in chain.findings}


def test_a_chain_written_as_urdf_is_the_same_machine(tmp_path: Path) -> None:
    arm = Robot.load("kr6r900")
    path = chainbuild.write_urdf(arm, tmp_path)
    back = Robot.load(path, tool="tool")
    values = np.array([10.0, -80.0, 70.0, 20.0, 40.0, -30.0])
    assert np.abs(back.fk(values).homogeneous - arm.fk(values).homogeneous).max() < 1e-12
    assert back.ik(arm.fk(values), start=values + 2).axes == pytest.approx(values, abs=1e-6)


def test_a_gantry_is_written_as_the_universal_kinematic(tmp_path: Path) -> None:
    rows = "0,0,90,0,P\n0,0,90,90,P\n0,0,0,0,P\n0,0,90,0,R\n0,100,0,0,R\n"
    table = tmp_path / "gantry.csv"
    table.write_text(f"# standard\na,d,alpha,theta,kind\n{rows}", "utf-8")
    values = [10.0, 20.0, 30.0, 40.0, 50.0]
    T = Robot.load(table).fk(values).homogeneous
    path = chainbuild.write_urdf(Robot.load(table), tmp_path)
    for machine in (chainbuild.load(table), chainbuild.load(path, tool="tool")):
        written = tmp_path / "universal.lis"
        written.write_text(chainbuild.as_universal(machine), "utf-8")
        found = Robot.load(written).fk(values).homogeneous
        assert np.abs(found[:3, [2, 3]] - T[:3, [2, 3]]).max() < 1e-7


def test_origins_are_data_that_can_be_changed(hand: Path) -> None:
    machine = chainbuild.load(hand, tool="left")
    data = {datum.name: datum for datum in machine.geometry()}
    assert list(data) == [
        f"{joint}.{part}" for joint in ("J1", "J2") for part in ("x", "y", "z", "roll", "pitch", "yaw")
    ]
    assert (data["J2.x"].value, data["J2.x"].unit) == (400.0, "mm")
    changed = machine.with_values({data["J2.x"]: 450.0, data["J1.roll"]: 30.0, data["J2.yaw"]: -20.0})
    text = HAND.replace("0.4 0 0", "0.45 0 0").replace('xyz="0 0 0.5"', f'xyz="0 0 0.5" rpy="{np.deg2rad(30)} 0 0"')
    hand.write_text(text.replace('0.45 0 0"', f'0.45 0 0" rpy="0 0 {np.deg2rad(-20)}"'), "utf-8")
    expected = Robot.load(hand, tool="left")
    for values in ([0, 0], [30, -50]):
        T = Robot(changed.chain()).fk(values).homogeneous
        assert np.abs(T - expected.fk(values).homogeneous).max() < 1e-15
        assert np.abs(Robot(machine.chain()).fk(values).homogeneous - T).max() > 0.01


def test_a_wrong_origin_is_found_by_poses(hand: Path) -> None:
    right = HAND.replace('name="J3" type="prismatic"', 'name="J3" type="revolute"')
    right = right.replace('parent link="arm"/><child link="right"', 'parent link="left"/><child link="right"')
    hand.write_text(right, "utf-8")
    true, rows = Robot.load(hand, tool="right"), np.random.default_rng(0).uniform(-100, 100, (6, 3)).round(3)
    recording = chainbuild.Recording(rows, np.array([true.fk(row).homogeneous for row in rows]))
    hand.write_text(right.replace("0.4 0 0", "0.43 0 0"), "utf-8")
    machine = chainbuild.load(hand, tool="right")
    found = chainbuild.crosscheck(Robot(machine.chain()), recording, machine=machine)
    assert not found.agrees
    assert found.data[0].agrees
    assert [(datum.name, round(value, 6)) for datum, value in found.data[0].values.items()] == [("J2.x", 400.0)]
