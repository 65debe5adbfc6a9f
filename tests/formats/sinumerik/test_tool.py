"""Tool: lengths and angles, TOOL_DIR, $TC_DPC start number, vectors, and where the active tool comes from."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from chainbuild.errors import OverlayError
from chainbuild.formats.overlay import Overlay
from tests.kit.robx_files import NR6, F, R, T, chain_of, close, pose_of, read, robx_text

AXES = (31, -47, 53, 71, -37, 113)
LENGTHS = "$TC_DP1[1,1]=120\n$TC_DP3[1,1]=120\n$TC_DP4[1,1]=13\n$TC_DP5[1,1]=14\n"
ANGLES = "".join(f"$TC_DPC{n}[1,1]={10 * n}\n" for n in range(1, 11))


def tool_of(data, **options):
    """Return the tool in the flange frame."""
    return np.linalg.inv(pose_of(chain_of(NR6), AXES)) @ pose_of(chain_of({**NR6, **data}, **options), AXES)


@pytest.mark.parametrize(("tool_dir", "sign"), [(0, 1), (1, -1), (-1, -1)])
def test_lengths_act_along_the_flange(tool_dir, sign):
    assert close(tool_of({"TOOL_DIR": tool_dir}, extra=LENGTHS), T(sign * 14, sign * 13, sign * 120))


@pytest.mark.parametrize("start", [1, 3, 8])
def test_angles_turn_about_the_tip(start):
    tool = tool_of({"CC_TOA_START_NUM": start}, extra=LENGTHS + ANGLES)
    a, b, c = 10 * start, 10 * start + 10, 10 * start + 20
    assert close(tool, T(14, 13, 120) @ R("z", a) @ R("y", b) @ R("x", c))


def test_angles_are_not_read_by_default():
    assert close(tool_of({}, extra=LENGTHS + ANGLES), T(14, 13, 120))


def test_lengths_follow_the_carrier():
    tool = tool_of({"TTCFL_POS": (1, 2, 3), "TTCFL_RPY": (10, 20, 30)}, extra=LENGTHS)
    assert close(tool, F((1, 2, 3), (10, 20, 30)) @ T(14, 13, 120))


@pytest.mark.parametrize(("tool_dir", "sign"), [(0, 1), (1, -1)])
def test_tool_length_adds_to_length_1(tool_dir, sign):
    machine = read(robx_text({**NR6, "TOOL_DIR": tool_dir}, extra=LENGTHS))
    plain, longer = pose_of(machine.chain(), AXES), pose_of(machine.chain(tool_length_mm=55.0), AXES)
    assert close(longer, plain @ T(z=sign * 55.0))


@pytest.mark.parametrize("length", [float("nan"), float("inf"), "5", None, True])
def test_tool_length_must_be_a_number(length):
    with pytest.raises(Exception, match="tool length"):
        read(robx_text(NR6)).chain(tool_length_mm=length)


VECTORS = {
    # direction (X, Y, Z), tool direction's axis, expected rotation of it
    "no direction": ("", 0, np.eye(3)[:, 0]),
    "without normal": ("$TC_DPV3[1,1]=1\n", 0, np.array((0, 0, 1.0))),
    "opposite": ("$TC_DPV5[1,1]=-1\n", 0, np.array((-1.0, 0, 0))),
    "normal along the direction": ("$TC_DPV4[1,1]=2\n$TC_DPVN4[1,1]=5\n", 0, np.array((0, 1.0, 0))),
    "skew": ("$TC_DPV3[1,1]=1\n$TC_DPV4[1,1]=2\n$TC_DPV5[1,1]=2\n", 1, np.array((2, 2, 1.0)) / 3),
}


@pytest.mark.parametrize("name", VECTORS)
def test_direction_vectors(name):
    text, tool_dir, direction = VECTORS[name]
    tool = tool_of({"CC_TOA_START_NUM": -1, "TOOL_DIR": tool_dir}, extra=text)
    assert np.abs(tool[:3, 2 if tool_dir == 1 else 0] - direction).max() < 1e-12
    assert np.linalg.det(tool[:3, :3]) == pytest.approx(1.0)


def test_without_a_normal_the_turn_is_the_smallest():
    tool = tool_of({"CC_TOA_START_NUM": -1}, extra="$TC_DPV3[1,1]=1\n")
    assert close(tool, R("y", -90))
    assert close(tool_of({"CC_TOA_START_NUM": -1}, extra="$TC_DPV5[1,1]=-1\n"), R("y", 180))


def test_overlay_gives_the_tool():
    overlay = Overlay(tool={"TC_DP3": 120.0, "TC_DP5": 14.0})
    assert close(tool_of({}, overlay=overlay), T(14, 0, 120))
    # Its data win over the file's.
    assert close(tool_of({}, overlay=overlay, extra="$TC_DP3[1,1]=7\n$TC_DP4[1,1]=8"), T(14, 8, 120))


def test_overlay_tool_length():
    assert close(tool_of({}, overlay=Overlay(tool_length_mm=33.0)), T(z=33.0))


MANY = "$TC_DP3[1,1]=10\n$TC_DP3[1,2]=20\n$TC_DP3[7,1]=70\n"


def test_of_several_tools_none_is_active_until_named():
    assert close(tool_of({}, extra=MANY), np.eye(4))
    assert "CB337" in {finding.code for finding in read(robx_text(NR6, extra=MANY)).findings}
    assert close(tool_of({}, extra=MANY, overlay=Overlay(tool={"number": 7})), T(z=70))
    assert close(tool_of({}, extra=MANY, overlay=Overlay(tool={"number": 1, "edge": 2})), T(z=20))


def test_the_only_tool_is_active_and_noted():
    machine = read(robx_text(NR6, extra=LENGTHS))
    assert machine.tools[1].name == "T1 D1"
    assert "CB338" in {finding.code for finding in machine.findings}


@pytest.mark.parametrize(
    ("tool", "permitted"),
    [
        ({"TC_DP9": 1.0}, "TC_DP3"),
        ({"DP3": 1.0}, "TC_DP3"),
        ({"plane": 20}, "17, 18 or 19"),
        ({"number": 3}, "T1 D1, T1 D2, T7 D1"),
        ({"number": 1.5}, "an integer"),
        ({"TC_DP3": (1.0, 2.0)}, "a number"),
        ({"TC_DPV": 0.5}, "an integer"),
    ],
)
def test_overlay_errors(tool, permitted):
    with pytest.raises(OverlayError) as caught:
        read(robx_text(NR6, extra=MANY), overlay=Overlay(path=Path("arm.chainbuild.toml"), tool=tool))
    assert permitted in str(caught.value)
    assert "arm.chainbuild.toml" in str(caught.value)
