"""The overlay: an empty one, where its errors point, and what it may say about axes."""

from __future__ import annotations

from pathlib import Path

import pytest

import chainbuild
from chainbuild.errors import ChainbuildError
from chainbuild.formats.overlay import Overlay, read_overlay

HEAD = "trafo[0].id 9\nEnde\n"


def load(folder: Path, overlay: str) -> chainbuild.Machine:
    path = folder / "head.lis"
    path.write_text(HEAD, "utf-8")
    (folder / "head.chainbuild.toml").write_text(overlay, "utf-8")
    return chainbuild.load(path)


@pytest.mark.parametrize("content", [b"", b" \n\t\r\n", b"\xef\xbb\xbf", b"# nothing\n"])
def test_an_empty_overlay_says_nothing(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "empty.toml"
    path.write_bytes(content)
    assert read_overlay(path) == Overlay(path=path)
    assert chainbuild.check("irb2600", overlay=path) == chainbuild.check("irb2600", overlay=path)
    assert not any(finding.severity == "error" for finding in chainbuild.check("irb2600", overlay=path))


@pytest.mark.parametrize(
    ("text", "line", "parameter", "says"),
    [
        ("[limits]\nX = [0, 1]\nC = [20, 10]", 3, "limits.C", "axis 'C' leave no range: 20 to 10"),
        ("limits = {C = [5, 5]}", 1, "limits.C", "5 to 5"),
        ("name = 'C'\nlimits.C = 5", 2, "limits.C", "[lower, upper]"),
        ("[limits]\n'C' = [0, nan]", 2, "limits.C", "is nan"),
        ("[limits]\nC = [0, 1e12]", 2, "limits.C", "is 1e+12; permitted: a finite number below 1e+09"),
        ("[limits]\nC = [0, true]", 2, "limits.C", "wrong type"),
        ("[speeds]\n\n  A = -5", 3, "speeds.A", "the speed of axis 'A' is -5"),
        ("# A = 3\n[limits]\nX = [0, 1]\n[speeds]\nX = 'fast'", 5, "speeds.X", "wrong type"),
        ("[conventions]\nkin98_hd1 = 3", 2, "conventions.kin98_hd1", "a string"),
        ("[conventions]\nfoo = 'bar'", 2, None, "unknown convention 'foo'"),
        ("[tool]\nnumber = 'one'", 2, "tool.number", "wrong type"),
        ("[tool]\nfoo = 1", 2, "tool.foo", "[tool] has an invalid 'foo'"),
        ("[tool]\nnumber = 3", 2, "tool.number", "no tool 3"),
        ("\ntool_length_mm = inf", 2, "tool_length_mm", "is inf"),
        ("[limits]\nQ = [0, 1]", 2, "limits.Q", "no axis 'Q'; parameter limits.Q; permitted: X, Y, Z, C, A"),
        ("[speeds]\nQ = 1", 2, "speeds.Q", "no axis 'Q'"),
        ("name = 'x'\nendless = ['Q']", 2, "endless.Q", "no axis 'Q'"),
        ("endless = ['C', 'X']", 1, "endless.X", "axis 'X' is linear and cannot turn without end; parameter endless.X"),
        ("[geometry.radii_mm]\nC_link = -1", 2, "C_link", "above 0"),
        ("[geometry]\nradii_mm = {nowhere = 1}", 2, "geometry.nowhere", "no link 'nowhere'"),
        ("name = 'x'\nkinematic = 77", 2, "kinematic", "no kinematic 77"),
        ("kinematic = ''", 1, "kinematic", "an id or a name"),
        ("kinematic = true", 1, "kinematic", "an id or a name"),
    ],
)
def test_errors_point_at_their_line(text: str, line: int, parameter: str | None, says: str, tmp_path: Path) -> None:
    with pytest.raises(ChainbuildError) as caught:
        load(tmp_path, text).chain()
    assert says in str(caught.value)
    assert (caught.value.line, caught.value.parameter) == (line, parameter)
    assert caught.value.file == str(tmp_path / "head.chainbuild.toml")
    errors = [finding for finding in chainbuild.check(tmp_path / "head.lis") if finding.severity == "error"]
    assert caught.value.message in {finding.text for finding in errors}


def test_a_rotary_axis_may_turn_without_end(tmp_path: Path) -> None:
    axes = load(tmp_path, "endless = ['C']").chain().axes
    assert [axis.name for axis in axes if axis.endless] == ["C"]


def test_what_an_overlay_says_of_another_kinematic_is_no_fault(tmp_path: Path) -> None:
    path = tmp_path / "two.lis"
    path.write_text("trafo[0].id 58\ntrafo[1].id 202\n", "utf-8")
    (tmp_path / "two.chainbuild.toml").write_text("endless = ['C']\n", "utf-8")
    machine = chainbuild.load(path)
    assert not any(axis.endless for axis in machine.chain(202).axes)
    assert not [finding for finding in chainbuild.check(path) if finding.severity == "error"]


def test_robx_overlays_point_at_their_line(tmp_path: Path) -> None:
    path = tmp_path / "o.toml"
    for text, line, says in (
        ("kinematic = 7", 1, "no kinematic 7"),
        ("[tool]\nplane = 5", 2, "17, 18 or 19"),
        ("[tool]\nTC_DP99 = 5", 2, "TC_DP3"),
        ("[limits]\nA9 = [0, 1]", 2, "no axis 'A9'"),
    ):
        path.write_text(text, "utf-8")
        with pytest.raises(ChainbuildError) as caught:
            chainbuild.load("irb2600", overlay=path).chain()
        assert says in str(caught.value)
        assert (caught.value.file, caught.value.line) == (str(path), line)
        assert [finding for finding in chainbuild.check("irb2600", overlay=path) if finding.severity == "error"]


@pytest.mark.parametrize(
    ("text", "line", "parameter", "says"),
    [
        ("[limits.drives]\nC = [20, 10]", 2, "limits.drives.C", "leave no range"),
        ("[limits]\nX = [0, 1]\n[limits.drives]\nX = [2, 3]", 4, "limits.drives.X", "no value in common"),
        ("[limits.drives]\nQ = [0, 1]", 2, "limits.drives.Q", "the kinematic has no axis 'Q'"),
        ("[speeds.drives]\nC = -1", 2, "speeds.drives.C", "is -1"),
        ("[speeds]\nX = 1\n[speeds.drives]\nQ = 1", 4, "speeds.drives.Q", "the kinematic has no axis 'Q'"),
    ],
)
def test_errors_of_drives_point_at_their_line(tmp_path: Path, text: str, line: int, parameter: str, says: str) -> None:
    with pytest.raises(ChainbuildError) as caught:
        load(tmp_path, text).chain()
    error = caught.value
    assert error.span is not None
    assert (error.span.line, error.parameter) == (line, parameter)
    assert says in str(error)


def test_limits_of_a_drive_at_its_axis_value_are_limits_of_the_axis(tmp_path: Path) -> None:
    overlay = "[limits]\nC = [-90, 90]\n[limits.drives]\nC = [-50, 200]\nA = [-70, 70]\n"
    axes = load(tmp_path, overlay + "[speeds]\nC = 100\n[speeds.drives]\nC = 80\nA = 30\n").chain().axes
    assert (axes[3].lower, axes[3].upper, axes[3].max_speed) == (-50.0, 90.0, 80.0)
    assert (axes[4].lower, axes[4].upper, axes[4].assumed, axes[4].max_speed) == (-70.0, 70.0, False, 30.0)
