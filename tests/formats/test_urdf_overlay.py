"""Overlays beside URDF files: limits, sums of axes, couplings, poses, bodies, and what a URDF has no use for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild.errors import ChainbuildError, OverlayError
from chainbuild.machines import shipped_path
from tests.kit.urdf_files import joint, link, written

FOLLOWS = '<axis xyz="0 1 0"/><mimic joint="A3" multiplier="-2" offset="0.1"/>'
UP, DOWN = (f'<axis xyz="0 {y} 0"/><limit lower="-1" upper="1.5" effort="1" velocity="2"/>' for y in (1, -1))
ARM = (
    joint("A1", "revolute", "base_link", "column", inside=UP.replace("0 1 0", "0 0 1")),
    joint("A2", "revolute", "column", "upper", "0.1 0 0.4", UP),
    joint("A3", "revolute", "upper", "fore", "0 0 0.7", DOWN),
    joint("G", "revolute", "fore", "rod", "0.1 0 0", FOLLOWS),
    joint("X", "prismatic", "fore", "ram", "0.6 0 0", '<axis xyz="1 0 0"/><limit lower="0" upper="0.2"/>'),
    joint("end", "fixed", "ram", "tcp"),
    link("tcp", 1),
)  # fmt: skip


def arm(tmp_path: Path, overlay: str) -> chainbuild.Robot:
    path = written(tmp_path, *ARM)
    (tmp_path / "robot.chainbuild.toml").write_text(overlay)
    return chainbuild.Robot.from_urdf(path, tool="tcp")


def by_hand(a1: float, a2: float, a3: float, x: float, share: float) -> np.ndarray:
    """Return the tool at axis values, mm and degrees: joint 3, which turns about -y, stands at a3 + share·a2."""
    turn, lean = np.radians(a1), np.radians(a2)
    fore = lean - np.radians(a3 + share * a2)
    out = 0.1 + 0.7 * np.sin(lean) + (0.6 + 0.001 * x) * np.cos(fore)
    up = 0.4 + 0.7 * np.cos(lean) - (0.6 + 0.001 * x) * np.sin(fore)
    return np.array([out * np.cos(turn), out * np.sin(turn), up])


@pytest.mark.parametrize("share", [1.0, -1.0, 0.4])
def test_a_coupled_joint_is_that_of_a_hand_formula(tmp_path: Path, share: float) -> None:
    robot = arm(tmp_path, f"[coupling]\nA3 = {{A2 = {share}}}")
    for axes in ((20.0, 30.0, 10.0, 50.0), (-10.0, -40.0, 25.0, 100.0)):
        np.testing.assert_allclose(robot.fk(axes).translation, by_hand(*axes, share=share), atol=1e-15)
    q3 = np.radians(10.0 + share * 30.0)
    np.testing.assert_allclose(robot.q([20.0, 30.0, 10.0, 50.0])[[2, 4]], [q3, 0.1 - 2.0 * q3])
    np.testing.assert_allclose(robot.axes_from_q(robot.q([20.0, 30.0, 10.0, 50.0])), [20.0, 30.0, 10.0, 50.0])


def test_with_a_share_of_1_the_forearm_keeps_its_slope(tmp_path: Path) -> None:
    """As on controllers that measure axis 3 against the horizontal."""
    robot = arm(tmp_path, "[coupling]\nA3 = {A2 = 1}")
    slopes = [robot.fk([0.0, a2, 25.0, 0.0]).rotation @ [1.0, 0.0, 0.0] for a2 in (-30.0, 0.0, 50.0)]
    np.testing.assert_allclose(slopes, [[np.cos(np.radians(25.0)), 0.0, np.sin(np.radians(25.0))]] * 3, atol=1e-15)


def test_limits_of_a_coupled_joint_stay_the_joints(tmp_path: Path) -> None:
    robot = arm(tmp_path, "[coupling]\na3 = {A2 = 1.0}")
    low, high = np.degrees(-1.0), np.degrees(1.5)
    (limit,) = robot.chain.constraints
    assert (limit.name, limit.sum.coefficients) == ("joint A3", (0.0, 1.0, 1.0, 0.0))
    assert [limit.lower, limit.upper] == pytest.approx([low, high])
    ranges = np.array([(axis.lower, axis.upper) for axis in robot.axes[1:3]])
    np.testing.assert_allclose(ranges, [[low, high], [low - high, high - low]])
    assert robot.violated_limits([0.0, 50.0, 30.0, 0.0]) == ()
    assert robot.violated_limits([0.0, 50.0, 40.0, 0.0]) == ("joint A3",)
    axes = [10.0, 50.0, -60.0, 100.0]
    found = robot.ik(robot.fk(axes))
    assert found.success
    assert robot.violated_limits(found.axes) == ()


def test_limits_of_a_joint_without_any_stay_assumed(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        joint("A", "continuous", "a", "b", inside='<axis xyz="0 0 1"/>'),
        joint("B", "revolute", "b", "c", inside='<axis xyz="0 1 0"/>'),
    )
    (tmp_path / "robot.chainbuild.toml").write_text("[coupling]\nB = {A = 1.0}")
    robot = chainbuild.Robot.from_urdf(path)
    assert not robot.chain.constraints
    assert [(axis.assumed, axis.endless) for axis in robot.axes] == [(True, True), (True, False)]


@pytest.mark.parametrize(
    ("sum_of", "factors"),
    [
        ("A2+A3", (0, 1, 1, 0)),
        ("A2 - 0.5*A3", (0, 1, -0.5, 0)),
        ("-a1 + 2 * A2 - .25*A3", (-1, 2, -0.25, 0)),
    ],
)
def test_limits_on_sums_of_axes(tmp_path: Path, sum_of: str, factors: tuple[float, ...]) -> None:
    robot = arm(tmp_path, f'[limits.sums]\n"{sum_of}" = [-20, 30]')
    (limit,) = robot.chain.constraints
    assert (limit.name, limit.sum.coefficients, limit.lower, limit.upper) == (sum_of, factors, -20.0, 30.0)
    axes = np.array([5.0, 20.0, 6.0, 0.0])
    value = float(np.dot(factors, axes))
    assert (robot.violated_limits(axes) == ()) == (-20.0 <= value <= 30.0)
    assert robot.violated_limits(axes + [0.0, 35.0, 0.0, 0.0]) == (sum_of,)


def test_names_of_axes_with_signs_in_them_are_read_whole(tmp_path: Path) -> None:
    path = written(tmp_path, *(
        joint(name, "revolute", f"{n}", f"{n + 1}", "0.1 0 0", UP) for n, name in enumerate(("J", "J-2", "J+J", "K*2"))
    ))  # fmt: skip
    (tmp_path / "robot.chainbuild.toml").write_text('[limits.sums]\n"J-J-2+0.5*J+J - K*2" = [-1, 1]')
    (limit,) = chainbuild.from_urdf(path).constraints
    assert limit.sum.coefficients == (1.0, -1.0, 0.5, -1.0)


def test_limits_speeds_endless_axes_poses_and_name(tmp_path: Path) -> None:
    robot = arm(
        tmp_path,
        """name = "Arm 7"
source = "data sheet"
endless = ["A1"]
[limits]
A2 = [-10, 20]
[speeds]
X = 300
[poses]
park = {A1 = 0, A2 = 10, A3 = 20, X = 0}
far = [0, 50, 0, 0]
""",
    )
    a1, a2, a3, x = robot.axes
    assert (a1.endless, a2.lower, a2.upper, x.max_speed) == (True, -10.0, 20.0, 300.0)
    assert a3.max_speed == pytest.approx(np.degrees(2.0))
    assert robot.chain.title == "Arm 7"
    assert robot.model.velocityLimit[3] == pytest.approx(0.3)
    assert [pose.axes for pose in robot.chain.named_poses] == [(0.0, 10.0, 20.0, 0.0), (0.0, 50.0, 0.0, 0.0)]
    (finding,) = robot.chain.findings
    assert (finding.code, finding.parameter) == ("CB502", "poses.far")


def test_bodies_by_the_names_of_the_file_keep_its_masses(tmp_path: Path) -> None:
    robot = arm(
        tmp_path,
        """[geometry]
ignore = [["base_link", "A2_link"]]
[geometry.radii_mm]
fore = 40
[geometry.shapes]
base_link = [{box = [100, 100, 50]}]
""",
    )
    geometry = robot.chain.geometry
    assert geometry.ignore == (("base", "upper"),)
    assert geometry.radii == {"fore": 0.04}
    assert set(geometry.shapes) == {"base"}
    assert geometry.inertias["ram"].mass == 1.0
    assert pin.computeTotalMass(robot.model) == 1.0
    with pytest.raises(OverlayError, match="link 'tcp' is fixed to link 'ram'") as caught:
        arm(tmp_path, "[geometry.radii_mm]\ntcp = 40")
    assert caught.value.line == 2


@pytest.mark.parametrize(
    ("overlay", "line", "message", "permitted"),
    [
        ("kinematic = 1", 1, "the kinematic of a URDF is its tool link", "the name of a link"),
        ("tool_length_mm = 5", 1, "no use for 'tool_length_mm'", "[coupling]"),
        ("\n[tool]\nnumber = 1", 2, "no use for 'tool'", "name, source"),
        ('axis_lists = ["a.lis"]', 1, "no use for 'axis_lists'", "[poses]"),
        ('[conventions]\nparallelogram_monitor = "elbow"', 1, "no use for 'conventions'", "[speeds]"),
        ("[limits.drives]\nA1 = [0, 1]", 1, "no use for 'limits.drives'", "[limits]"),
        ("[speeds.drives]\nA1 = 3", 1, "no use for 'speeds.drives'", "[speeds]"),
        ("[limits]\nZ = [0, 1]", 2, "no axis 'Z'", "A1, A2, A3, X"),
        ('[limits.sums]\n"A2+Z" = [0, 1]', 2, "'A2+Z' is no sum of axes", "A1, A2, A3, X"),
        ('[limits.sums]\n"A2 A3" = [0, 1]', 2, "no sum of axes", "such as"),
        ('[limits.sums]\n"A2" = [0, 1]', 2, "no sum of axes", "two or more"),
        ('[limits.sums]\n"A2+A2-A2" = [0, 1]', 2, "no sum of axes", "two or more"),
        ('[limits.sums]\n"A2+X" = [0, 1]', 2, "no sum of axes", "of a kind"),
        ('[limits.sums]\n"A2+A3" = [1, 1]', 2, "leave no range", "lower below upper"),
        ('[limits.sums]\n"A2+A3" = 3', 2, "has the wrong type", "[lower, upper]"),
        ('[limits.sums]\n"A2-A3" = [144, 200]', 2, "no axis values within", "-143.239 to 143.239"),
        ('[limits.sums]\n"A2-A3" = [-200, -144]', 2, "no axis values within", "-143.239 to 143.239"),
        ('[limits.sums]\n"0.5*A2+A3" = [129, 200]', 2, "no axis values within", "-85.9437 to 128.916"),
        ("[coupling]\nA3 = 1", 2, "has the wrong type", "a table"),
        ("[coupling]\nA3 = {A2 = true}", 2, "has the wrong type", "a finite number"),
        ("[coupling]\nA3 = {Z = 1}", 2, "no axis 'Z'", "A1, A2, A3, X"),
        ("[coupling]\nA3 = {A3 = 1}", 2, "axis A3 cannot move along with axis A3", "A1, A2"),
        ("[coupling]\nA3 = {X = 1}", 2, "axis A3 cannot move along with axis X", "A1, A2"),
        ("[coupling]\nA3 = {A2 = 1}\nA2 = {A3 = 1}", 1, "singular", "undone"),
        ("[geometry.radii_mm]\nnone = 3", 2, "no link 'none'", "base, column, upper, fore, ram, rod"),
        ("colour = 1", 1, "unknown key 'colour'", "coupling"),
    ],
)
def test_what_does_not_fit_is_one_error(tmp_path: Path, overlay: str, line: int, message: str, permitted: str) -> None:
    with pytest.raises(OverlayError) as caught:
        arm(tmp_path, overlay)
    assert message in caught.value.message
    assert permitted in (caught.value.permitted or "")
    assert (caught.value.line, caught.value.file) == (line, str(tmp_path / "robot.chainbuild.toml"))


@pytest.mark.parametrize("text", ['"A2-A3" = [143, 200]', '"A2-A3" = [-200, -143]', '"A2+A3" = [900, 901]'])
def test_sums_that_some_axis_values_keep_are_taken(tmp_path: Path, text: str) -> None:
    endless = 'endless = ["A2"]\n' if "900" in text else ""
    assert len(arm(tmp_path, f"{endless}[limits.sums]\n{text}").chain.constraints) == 1


def test_an_overlay_of_another_name_is_taken_where_it_is_named(tmp_path: Path) -> None:
    path, other = written(tmp_path, *ARM), tmp_path / "other.toml"
    other.write_text('name = "other"')
    (tmp_path / "robot.chainbuild.toml").write_text('name = "beside"')
    assert chainbuild.from_urdf(path, tool="tcp").title == "beside"
    assert chainbuild.Robot.from_urdf(path, tool="tcp", overlay=other).chain.title == "other"
    with pytest.raises(ChainbuildError, match="no such file"):
        chainbuild.from_urdf(path, tool="tcp", overlay=tmp_path / "none.toml")


def test_machine_data_take_no_couplings(tmp_path: Path) -> None:
    overlay = tmp_path / "o.toml"
    overlay.write_text("[coupling]\nA3 = {A2 = 1}")
    machine = shipped_path("kr6r900")
    assert machine is not None
    with pytest.raises(OverlayError, match="the table is for a URDF and for DH parameters") as caught:
        chainbuild.load(machine, overlay=overlay)
    assert caught.value.line == 1
    (finding,) = chainbuild.check(machine, overlay=overlay)
    assert finding.severity == "error"
