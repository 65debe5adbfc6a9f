"""Joints of URDF files that need care: limits with one end, joints that follow others, names, trees that are none."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild.errors import ChainbuildError, ParseError

LIMITED = '<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="0" velocity="0"/>'
TWO_RAD_DEG = math.degrees(2.0)


def joint(name: str, parent: str, child: str, kind: str = "revolute", inside: str = LIMITED) -> str:
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}<origin xyz="0.1 0 0.3" rpy="0.3 0.2 0"/>{inside}</joint>'


def mimic(of: str, multiplier: float = 1.0, offset: float = 0.0, limit: str = "") -> str:
    return f'<axis xyz="0 1 0"/><mimic joint="{of}" multiplier="{multiplier}" offset="{offset}"/>{limit}'


def robot_of(tmp_path: Path, *joints: str, tool: str | None = None) -> chainbuild.Robot:
    path = tmp_path / "robot.urdf"
    path.write_text("\n".join(('<robot name="r">', *joints, "</robot>")))
    return chainbuild.Robot.from_urdf(path, tool=tool)


def ranges(robot: chainbuild.Robot) -> list[tuple[str, float, float, bool]]:
    return [(axis.name, round(axis.lower, 9), round(axis.upper, 9), axis.assumed) for axis in robot.axes]


def codes(robot: chainbuild.Robot) -> list[str]:
    return [finding.code for finding in robot.chain.findings]


@pytest.mark.parametrize(
    ("limit", "lower", "upper", "missing"),
    [
        ('lower="-2"', -TWO_RAD_DEG, 0.0, "upper"),
        ('upper="2"', 0.0, TWO_RAD_DEG, "lower"),
    ],
)
def test_an_end_that_is_not_given_is_zero(tmp_path: Path, limit: str, lower: float, upper: float, missing: str) -> None:
    robot = robot_of(tmp_path, joint("a", "b", "c", inside=f"<limit {limit}/>"), joint("x", "c", "d"))
    assert ranges(robot)[0] == ("a", round(lower, 9), round(upper, 9), False)
    (finding,) = robot.chain.findings
    assert (finding.code, finding.parameter, finding.span and finding.span.line) == ("CB521", missing, 2)


def test_limits_that_are_not_given_or_beyond_sense_are_assumed(tmp_path: Path) -> None:
    robot = robot_of(
        tmp_path,
        joint("a", "b", "c", inside='<limit effort="1" velocity="2"/>'),
        joint("x", "c", "d", "prismatic", '<limit lower="-1e16" upper="1e16"/>'),
        joint("y", "d", "e", "prismatic", '<limit lower="0.5" upper="1e16"/>'),
        joint("z", "e", "f", inside='<limit lower="-1e16" upper="7"/>'),
    )
    assert ranges(robot) == [
        ("a", -360.0, 360.0, True),
        ("x", -10_000.0, 10_000.0, True),
        ("y", 500.0, 10_500.0, False),
        ("z", -360.0, round(math.degrees(7.0), 9), False),
    ]
    assert robot.axes[0].max_speed == pytest.approx(TWO_RAD_DEG)


@pytest.mark.parametrize(
    ("multiplier", "offset", "lower", "upper"),
    [
        (2.0, 0.0, -0.2, 0.3),
        (-2.0, 0.0, -0.3, 0.2),
        (2.0, 0.1, -0.25, 0.25),
        (-2.0, 0.1, -0.25, 0.25),
        (0.5, 0.0, -0.8, 1.0),
    ],
)
@pytest.mark.parametrize("parent", ["c", "b"], ids=["on the way", "on another branch"])
def test_the_limits_of_a_mimic_joint_bind_its_driver(
    tmp_path: Path, multiplier: float, offset: float, lower: float, upper: float, parent: str
) -> None:
    limit = '<limit lower="-0.4" upper="0.6" velocity="0.5"/>'
    joints = joint("a", "b", "c"), joint("m", parent, "d", inside=mimic("a", multiplier, offset, limit))
    robot = robot_of(tmp_path, *joints, tool="d" if parent == "c" else "c")
    assert ranges(robot) == [("a", round(math.degrees(lower), 9), round(math.degrees(upper), 9), False)]
    assert robot.axes[0].max_speed == pytest.approx(math.degrees(0.5 / abs(multiplier)))
    if parent == "c":
        ends = np.array([robot.q([end])[1] for end in (robot.axes[0].lower, robot.axes[0].upper)])
        assert (ends > -0.4 - 1e-12).all()
        assert (ends < 0.6 + 1e-12).all()


def test_a_mimic_of_metres_by_radians_binds_in_si(tmp_path: Path) -> None:
    slide = mimic("a", 0.1, limit='<limit lower="0" upper="0.05"/>')
    robot = robot_of(tmp_path, joint("a", "b", "c"), joint("m", "c", "d", "prismatic", slide))
    assert ranges(robot) == [("a", 0.0, round(math.degrees(0.5), 9), False)]
    np.testing.assert_allclose(robot.q([robot.axes[0].upper]), [0.5, 0.05])


def test_an_endless_driver_is_endless_no_more(tmp_path: Path) -> None:
    follower = joint("m", "c", "d", inside=mimic("a", limit='<limit lower="-1" upper="2"/>'))
    (axis,) = robot_of(tmp_path, joint("a", "b", "c", "continuous", ""), follower).axes
    assert (axis.endless, axis.assumed, axis.upper) == (False, False, pytest.approx(TWO_RAD_DEG))
    (free,) = robot_of(tmp_path, joint("a", "b", "c", "continuous", ""), joint("m", "c", "d", inside=mimic("a"))).axes
    assert (free.endless, free.assumed) == (True, True)


def test_a_mimic_of_a_mimic_follows_the_first(tmp_path: Path) -> None:
    robot = robot_of(
        tmp_path,
        joint("a", "b", "c"),
        joint("x", "c", "d", inside=mimic("a", 0.5, 0.2)),
        joint("y", "d", "e", inside=mimic("x", -3.0, 0.1)),
    )
    assert [axis.name for axis in robot.axes] == ["a"]
    np.testing.assert_allclose(robot.q([math.degrees(0.4)]), [0.4, 0.5 * 0.4 + 0.2, -3.0 * (0.5 * 0.4 + 0.2) + 0.1])


def test_a_mimic_of_another_branch_has_that_ones_axis(tmp_path: Path) -> None:
    other = joint("o", "b", "q", inside='<limit lower="-0.5" upper="0.5"/>')
    robot = robot_of(tmp_path, joint("a", "b", "c"), other, joint("x", "c", "d", inside=mimic("o", 2.0, 0.1)), tool="d")
    bound = round(math.degrees(0.5), 9)
    assert ranges(robot)[1] == ("o", -bound, bound, False)
    assert [joint.name for joint in robot.chain.joints] == ["a", "x", "o"]
    np.testing.assert_allclose(robot.q([0.0, math.degrees(0.3)]), [0.0, 0.7, 0.3])
    assert robot.ik(robot.fk([10.0, 20.0])).success


@pytest.mark.parametrize(
    ("second", "message", "line"),
    [
        (mimic("z"), "joint m mimics joint z, which the file does not have", 3),
        (mimic("f"), "joint m mimics joint f, which is fixed", 3),
        (mimic("m"), "joint m mimics itself", 3),
        (mimic("a", limit='<limit lower="2" upper="3"/>'), "limits of joint m leave joint a, which it follows, no", 3),
        (mimic("a", 0.0, 5.0, '<limit lower="2" upper="3"/>'), "joint m stands at 5, outside its limits 2 … 3", 3),
        ('<limit lower="1" upper="-1"/>', "limits of joint m leave nothing: 1 … -1", 3),
        ('<limit lower="-1" upper="1" velocity="-2"/>', "highest speed of joint m is -2", 3),
        ('<limit lower="-1_0" upper="1"/>', 'lower="-1_0" in <limit>', 3),
    ],
)
def test_what_joints_cannot_follow_or_keep_is_refused(tmp_path: Path, second: str, message: str, line: int) -> None:
    fixed = joint("f", "d", "e", "fixed", "")
    joints = joint("a", "b", "c"), joint("m", "c", "d", inside=second), fixed
    with pytest.raises(ParseError, match=message) as caught:
        robot_of(tmp_path, *joints)
    assert caught.value.line == line


@pytest.mark.parametrize(
    ("kind", "value"), [("revolute", 0.0), ("revolute", 0.5), ("prismatic", 0.0), ("prismatic", -0.2)]
)
def test_a_joint_whose_limits_leave_one_value_is_fixed_there(tmp_path: Path, kind: str, value: float) -> None:
    locked = joint("l", "c", "d", kind, f'<axis xyz="0 2 0"/><limit lower="{value}" upper="{value}"/>')
    robot = robot_of(tmp_path, joint("a", "b", "c"), locked, joint("x", "d", "e"))
    assert [axis.name for axis in robot.axes] == ["a", "x"]
    assert codes(robot) == ["CB522"]
    free = robot_of(
        tmp_path, joint("a", "b", "c"), locked.replace("lower", "l").replace("upper", "u"), joint("x", "d", "e")
    )
    shown = math.degrees(value) if kind == "revolute" else 1000.0 * value
    np.testing.assert_allclose(robot.fk([10.0, 20.0]).homogeneous, free.fk([10.0, shown, 20.0]).homogeneous, atol=1e-14)


def test_a_driver_that_its_follower_fixes_is_fixed_with_it(tmp_path: Path) -> None:
    limit = '<limit lower="0.5" upper="0.5"/>'
    driver, follower = joint("a", "b", "c"), joint("m", "c", "d", inside=mimic("a", -2.0, 0.1, limit))
    robot = robot_of(tmp_path, driver, follower, joint("x", "d", "e"))
    assert [axis.name for axis in robot.axes] == ["x"]
    free = robot_of(tmp_path, driver, follower.replace(limit, ""), joint("x", "d", "e"))
    expected = free.fk([math.degrees(-0.2), 20.0]).homogeneous
    np.testing.assert_allclose(robot.fk([20.0]).homogeneous, expected, atol=1e-14)


@pytest.mark.parametrize("name", ["tool", "workpiece", "universe", "base", "flange", "status", "x_mm", "A_drive"])
def test_joints_with_the_names_of_frames_and_columns_are_renamed(tmp_path: Path, name: str) -> None:
    robot = robot_of(tmp_path, joint(name, "b", "c"), joint("x", "c", "d"), joint(f"{name}_joint", "d", "e"))
    first, _, last = robot.axes
    assert (first.generic, last.name) == (name, f"{name}_joint")
    assert first.name not in {name, last.name}
    assert codes(robot) == ["CB523"]
    assert robot.ik(robot.fk([10.0, 20.0, 30.0])).success
    model = pin.buildModelFromUrdf(str(chainbuild.write_urdf(robot, tmp_path / "out")))
    data = model.createData()
    q = pin.neutral(model)
    for axis, value in zip(robot.axes, (10.0, 20.0, 30.0), strict=True):
        q[model.joints[model.getJointId(axis.name)].idx_q] = np.radians(value)
    pin.framesForwardKinematics(model, data, q)
    place = data.oMf[model.getFrameId("tool", pin.FrameType.BODY)].homogeneous
    np.testing.assert_allclose(place, robot.fk([10.0, 20.0, 30.0]).homogeneous, atol=1e-9)


def test_a_robot_of_one_joint_works(tmp_path: Path) -> None:
    robot = robot_of(tmp_path, joint("tool", "b", "c"))
    assert robot.task == "pose"  # the tool stands on the axis: position and direction say nothing about it
    found = robot.ik(robot.fk([25.0]))
    assert found.success
    assert found.axes == pytest.approx([25.0])
    assert chainbuild.write_urdf(robot, tmp_path / "out").is_file()


@pytest.mark.parametrize(
    ("joints", "message", "line"),
    [
        ([joint("f", "b", "c", "fixed", "")], "none of the joints on the way to link c moves: f", None),
        ([joint("l", "b", "c", inside='<limit lower="0" upper="0"/>')], "none of the joints .* moves: l", None),
        (['<link name="b"/>'], "the file has no joints", None),
        (
            [joint("a", "b", "c"), joint("x", "c", "d"), joint("y", "b", "d")],
            "link d has two parents: joints x and y",
            4,
        ),
        ([joint("a", "b", "c"), joint("x", "e", "f")], "2 links have no parent: b, e", None),
        ([joint("a", "b", "c"), joint("a", "c", "d")], "joint a occurs twice", 3),
        ([joint(" ", "b", "c")], "a joint has no name", 2),
        (['<joint name="a" type="fixed"><child link="c"/></joint>'], "joint a lacks <parent>", 2),
        ([joint("a", "b", "c").replace("0.3 0.2 0", "${pi} 0 0")], "is xacro, a template", 2),
        (['<xacro:macro name="m"/>'], "is xacro, a template", 2),
    ],
)
def test_what_makes_no_robot_is_refused_in_words(
    tmp_path: Path, joints: list[str], message: str, line: int | None
) -> None:
    with pytest.raises(ChainbuildError, match=message) as caught:
        robot_of(tmp_path, *joints)
    assert caught.value.file == str(tmp_path / "robot.urdf")
    assert caught.value.line == line


def test_a_joint_too_far_away_is_refused_and_any_length_of_direction_is_not(tmp_path: Path) -> None:
    with pytest.raises(ParseError, match="joint a is too far away"):
        robot_of(tmp_path, joint("a", "b", "c").replace("0.1 0 0.3", "0 -1e300 0"))
    long = LIMITED.replace("0 0 1", "0 0 1e200")
    place = robot_of(tmp_path, joint("a", "b", "c", inside=long)).fk([30.0])
    np.testing.assert_array_equal(place.homogeneous, robot_of(tmp_path, joint("a", "b", "c")).fk([30.0]).homogeneous)
