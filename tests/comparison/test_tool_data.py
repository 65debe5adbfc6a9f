"""Tool data: a wrong number of the active tool is named with its place, wherever it is given."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.comparison.convention_trials import Selection
from chainbuild.comparison.crosscheck import crosscheck
from chainbuild.comparison.samples import make_samples
from chainbuild.formats.machine import Machine
from chainbuild.machines import shipped_path
from chainbuild.tables.recording import Recording
from chainbuild.writers.report import crosscheck_text

HEAD = """trafo[0].id 9
trafo[0].param[1] 3000000
wz[4].laenge 1500000
wz[4].kinematic.param[4] 70000
wz[4].ax_versatz[4] 30000
Ende
"""
EDGE = "$TC_DP1[3,2]=120\n$TC_DP3[3,2]=120\n$TC_DP5[3,2]=14\n$TC_DPC2[3,2]=20\n"
START_1 = "$MC_ROBX_CC_TOA_START_NUM=1"


def written(folder: Path, text: str, overlay: str = "", suffix: str = "lis") -> Machine:
    (folder / "m.chainbuild.toml").write_text(overlay, "utf-8")
    (folder / f"m.{suffix}").write_text(text, "utf-8")
    return chainbuild.load(folder / f"m.{suffix}")


def arm(folder: Path, overlay: str = "") -> Machine:
    """Return an arm whose file gives one tool."""
    shipped = shipped_path("kr6r900")
    assert shipped is not None
    text = shipped.read_text("utf-8").replace("M17", "")
    return written(folder, f"{text}\nCHANDATA(1)\n{START_1}\n{EDGE}M17\n", overlay, "tea")


def lines_of(here: Machine, there: Machine, tool_length_mm: float = 0.0, other_mm: float = 0.0) -> list[str]:
    """Return the data that are named for poses of another machine, as text."""
    robot, other = chainbuild.Robot(here.chain(tool_length_mm=tool_length_mm)), there.chain(tool_length_mm=other_mm)
    axes = make_samples(robot, 8, ("random",)).axes
    recording = Recording(axes, np.array([chainbuild.Robot(other).fk(row).homogeneous for row in axes]))
    selection = Selection(tool_length_mm=tool_length_mm)
    found = crosscheck(robot, recording, machine=here, selection=selection)
    assert found.deciding_data
    return [line.strip().removeprefix("or ").split(" (leaves")[0] for line in crosscheck_text(found).splitlines()]


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("laenge 1500000", "laenge 1525000",
         "P-TOOL-00003 wz[4].laenge (line 3): 150 to 152.5 mm, in the list 1525000"),
        ("[4] 70000", "[4] -70000",
         "HD5 wz[4].kinematic.param[4] (line 4): 7 to -7 mm, in the list -70000"),
        ("versatz[4] 30000", "versatz[4] 42500",
         "P-TOOL-00006 wz[4].ax_versatz[4] (line 5): 3 to 4.25 deg, in the list 42500"),
    ],
)  # fmt: skip
def test_a_wrong_number_of_a_tool_list_is_named(tmp_path: Path, old: str, new: str, said: str) -> None:
    there = written(tmp_path, HEAD.replace(old, new), "[tool]\nnumber = 4\n")
    here = written(tmp_path, HEAD, "[tool]\nnumber = 4\n")
    assert said in lines_of(here, there)


def test_a_length_that_the_list_leaves_out_is_named(tmp_path: Path) -> None:
    without = HEAD.replace("wz[4].laenge 1500000\n", "")
    here, there = (written(tmp_path, text, "[tool]\nnumber = 4\n") for text in (without, HEAD))
    found = lines_of(here, there)
    assert "P-TOOL-00003 wz[4].laenge (not given, default): 0 to 150 mm, in the list 1500000" in found
    assert not any("--tool-length" in line for line in found)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("$TC_DP3[3,2]=120", "$TC_DP3[3,2]=123.5", "T3 D2 $TC_DP3[3,2] (line {}): 120 to 123.5 mm"),
        ("$TC_DP5[3,2]=14", "$TC_DP5[3,2]=-14", "T3 D2 $TC_DP5[3,2] (line {}): 14 to -14 mm"),
        ("$TC_DP5[3,2]=14", "$TC_DP5[3,2]=14\n$TC_DP4[3,2]=6", "T3 D2 $TC_DP4[3,2] (not given, default): 0 to 6 mm"),
        ("$TC_DPC2[3,2]=20", "$TC_DPC2[3,2]=27", "T3 D2 $TC_DPC2[3,2] (line {}): 20 to 27 deg"),
    ],
)
def test_a_wrong_number_of_a_cutting_edge_is_named(tmp_path: Path, old: str, new: str, said: str) -> None:
    here = arm(tmp_path)
    lines = here.path.read_text("utf-8").splitlines()
    changed = tmp_path / "there.tea"
    changed.write_text(here.path.read_text("utf-8").replace(old, new), "utf-8")
    assert said.format(lines.index(old) + 1) in lines_of(here, chainbuild.load(changed))


def test_wrong_numbers_of_the_overlay_are_named(tmp_path: Path) -> None:
    overlay = "tool_length_mm = 30\n[tool]\nTC_DP4 = 5\nTC_DP5 = 14\n"
    there = [arm(tmp_path, overlay.replace(*change)) for change in (("= 30", "= 33"), ("DP4 = 5", "DP4 = 9.25"))]
    here = arm(tmp_path, overlay)
    line = here.path.read_text("utf-8").splitlines().index("$TC_DP3[3,2]=120") + 1
    found = lines_of(here, there[0])
    assert "overlay tool_length_mm (line 1): 30 to 33 mm" in found
    assert f"T3 D2 $TC_DP3[3,2] (line {line}): 120 to 123 mm" in found
    assert "overlay tool.TC_DP4 (line 3): 5 to 9.25 mm" in lines_of(here, there[1])


def test_a_wrong_length_of_the_caller_is_named(tmp_path: Path) -> None:
    machine = written(tmp_path, HEAD)
    assert "--tool-length tool_length_mm (as given): 40 to 37.5 mm" in lines_of(machine, machine, 40.0, 37.5)
    assert "--tool-length tool_length_mm (not given, default): 0 to 37.5 mm" in lines_of(machine, machine, 0.0, 37.5)


@pytest.mark.parametrize("name", ["arm_nr5", "ca_head_kin9", "robot_head_kin210"])
def test_tool_data_with_their_own_values_are_the_same(name: str) -> None:
    machine = chainbuild.load(name)
    data = machine.tool_data()
    assert data
    own = machine.with_values({one: one.value for one in data})
    robots = [chainbuild.Robot(m.chain()) for m in (machine, own)]
    for row in make_samples(robots[0], 3, ("random",)).axes:
        here, there = (robot.fk(row).homogeneous for robot in robots)
        np.testing.assert_allclose(there, here, atol=1e-12)
