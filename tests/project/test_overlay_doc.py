"""docs/overlay.md: every key is there, and its examples load."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.bodies import geometry_table
from chainbuild.formats.overlay import _READERS
from chainbuild.machines import shipped_path
from tests.kit.paths import ROOT

PAGE = (ROOT / "docs/overlay.md").read_text("utf-8")
ROBX, TWINCAT, SUMS, URDF = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)


def copy_of(name: str, folder: Path, overlay: str) -> Path:
    source = shipped_path(name)
    target = folder / source.name
    target.write_bytes(source.read_bytes())
    (folder / f"{name}.chainbuild.toml").write_text(overlay, "utf-8")
    return target


def test_every_key_is_explained() -> None:
    bodies = (*geometry_table._SHAPE_COUNTS, *geometry_table._FILE_KINDS)
    for key in (*_READERS, *geometry_table._KEYS, *bodies, "radius_mm", "at", "scale", "number", "edge", "plane"):
        assert re.search(rf"`\[?(geometry\.)?{key}\]?`", PAGE), key


def test_the_complete_example_loads(tmp_path: Path) -> None:
    machine = chainbuild.load(copy_of("parallelogram_nr", tmp_path, ROBX))
    chain = machine.chain()
    robot = chainbuild.Robot(chain)
    overlay = machine.overlay
    used = {key for key in _READERS if getattr(overlay, key) not in (None, (), {}, 0.0)}
    assert used == {*_READERS} - {"axis_lists", "coupling"}
    assert machine.title == "Handling arm, cell 7"
    assert (chain.axes[0].lower, chain.axes[0].max_speed, chain.axes[5].endless) == (-170.0, 100.0, True)
    chosen = {used.convention.name: used.choice for used in chain.conventions}
    assert chosen["parallelogram_monitor"] == "elbow"
    assert chain.geometry.rods
    assert robot.model.nq == 8
    # 12.5 and 120 mm along Z of the flange, 35 mm along X.
    axes = [0, 0, -90, 0, 40, 0]
    placed = robot.frame_placements(axes)
    offset = placed["flange"].actInv(placed["tool"]).translation
    np.testing.assert_allclose(offset, [0.035, 0.0, 0.1325], atol=1e-12)


def test_the_twincat_example_loads(tmp_path: Path) -> None:
    text = "trafo[0].id 9\ntrafo[0].param[0] 1000000\ntrafo[1].id 45\ntrafo[1].name ROBOT\n"
    text += "".join(f"trafo[1].param[{n}] 4000000\n" for n in (6, 7, 8)) + "wz[4].kinematic.param[0] 500000\nEnde\n"
    (tmp_path / "cell.lis").write_text(text, "utf-8")
    (tmp_path / "cell.chainbuild.toml").write_text(TWINCAT, "utf-8")
    for n, limit in ((1, 1700000), (2, 900000)):
        lines = f"kenngr.swe_pos {limit}\nkenngr.swe_neg -{limit}\nEnde\n"
        (tmp_path / f"axis{n}.lis").write_text(lines, "utf-8")
    machine = chainbuild.load(tmp_path / "cell.lis")
    chain = machine.chain()
    assert chain.kinematic == "KIN_TYP 45"
    assert [(axis.upper, axis.assumed) for axis in chain.axes[:3]] == [(170.0, False), (90.0, False), (360.0, True)]
    tool = chainbuild.Robot(chain).fk([0] * 6).translation[0]
    bare = chainbuild.Robot(chainbuild.load(tmp_path / "cell.lis", overlay=_without_tool(tmp_path)).chain("ROBOT"))
    assert tool - bare.fk([0] * 6).translation[0] == pytest.approx(0.05)


def test_the_sums_are_those_of_any_machine(tmp_path: Path) -> None:
    chain = chainbuild.load(copy_of("kr6r900", tmp_path, SUMS)).chain()
    assert [(one.name, one.lower, one.upper) for one in chain.constraints] == [
        ("A2+A3", -60.0, 210.0),
        ("A4 - 0.5*A6", -400.0, 400.0),
    ]


def _without_tool(folder: Path) -> Path:
    path = folder / "bare.toml"
    path.write_text("", "utf-8")
    return path


@pytest.mark.parametrize("name", ["scara_cc", "scara_sc", "cylinder_cs"])
def test_a_tool_of_a_four_axis_robot_hangs_by_length_3(tmp_path: Path, name: str) -> None:
    """What docs/robx.md says of length 1 in G17, length 3, and G19."""
    axes = [0.0, 30.0, -20.0, 10.0]
    shift = {}
    own = shipped_path(name).with_name(f"{name}.chainbuild.toml").read_text("utf-8")
    for tool in ("", "TC_DP3 = 120", "TC_DP5 = 120", "plane = 19\nTC_DP3 = 120"):
        robot = chainbuild.Robot.load(copy_of(name, tmp_path, f"{own}\n[tool]\n{tool}\n"))
        shift[tool] = robot.fk(axes).translation - shift.get("", np.zeros(3))
    assert shift["TC_DP3 = 120"][2] == pytest.approx(0.0, abs=1e-12)
    assert np.linalg.norm(shift["TC_DP3 = 120"]) == pytest.approx(0.12)
    for tool in ("TC_DP5 = 120", "plane = 19\nTC_DP3 = 120"):
        np.testing.assert_allclose(shift[tool], [0.0, 0.0, -0.12], atol=1e-12)


BLOCKS = [
    block
    for page in sorted((ROOT / "docs").glob("*.md"))
    for block in re.findall(r"```toml\n(.*?)```", page.read_text("utf-8"), re.DOTALL)
    if "[geometry" in block
]


@pytest.mark.parametrize("block", BLOCKS)
def test_the_bodies_of_every_example_are_free_of_collision_at_home(block: str, tmp_path: Path) -> None:
    assert len(BLOCKS) >= 2
    drawing = re.sub(r"\{hull = [^}]*\}", "{sphere = [0, 0, 0], radius_mm = 1}", block)  # a file that is not there
    robot = chainbuild.Robot.load(copy_of("parallelogram_nr", tmp_path, drawing))
    ranges = np.array([axis.range for axis in robot.axes])
    zero = np.where((ranges[:, 0] <= 0.0) & (ranges[:, 1] >= 0.0), 0.0, ranges.mean(axis=1))
    elbow = np.array([0.0, 0.0, -90.0, 0.0, 0.0, 0.0])  # the middle of the parallelogram's angle
    for home in (zero, elbow):
        assert chainbuild.CollisionModel(robot).colliding_pairs(home) == ()
    assert chainbuild.swept_limits(robot, steps=2).touching == ()


def test_the_example_beside_a_urdf_loads(tmp_path: Path) -> None:
    limit = '<limit lower="-2" upper="2" effort="1" velocity="1"/>'
    links = [f"link_{n}" for n in range(1, 7)]
    carried = zip(["base_link", *links], links, range(1, 7), "zyyxyx", strict=False)
    text = "".join(
        f'<joint name="A{n}" type="revolute"><parent link="{parent}"/><child link="{child}"/><origin xyz="0.1 0 0.2"/>'
        f'<axis xyz="{int(axis == "x")} {int(axis == "y")} {int(axis == "z")}"/>{limit}</joint>'
        for parent, child, n, axis in carried
    )
    (tmp_path / "arm.urdf").write_text(f'<robot name="arm">{text}</robot>', "utf-8")
    (tmp_path / "arm.chainbuild.toml").write_text(f"{URDF}\n{SUMS}", "utf-8")
    chain = chainbuild.Robot.from_urdf(tmp_path / "arm.urdf").chain
    assert chain.title == "Handling arm, cell 3"
    assert [one.name for one in chain.constraints] == ["joint A3", "A2+A3", "A4 - 0.5*A6"]
    assert (chain.axes[1].lower, chain.axes[1].upper) == (-100.0, 145.0)
