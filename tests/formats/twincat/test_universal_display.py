"""What KIN_TYP 91 displays by its programming mode, and the way back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.errors import ChainbuildError
from tests.hand.displayed import universal_angles
from tests.kit.universal import CA_HEAD

AT = [1.0, 2.0, 3.0, 30.0, 20.0]
LETTERS = {14: "AB", 15: "BA", 16: "AC", 17: "CA", 18: "BC", 19: "CB", 20: "AB", 21: "BA"}


def head(folder: Path, *more: str, rtcp: int = 1, channel: tuple[str, ...] = ()) -> chainbuild.Robot:
    path = folder / "universal.lis"
    lines = replace(CA_HEAD, rtcp=rtcp, more=more).lines()
    path.write_text("\n".join([*lines, *channel, "Ende", ""]), "utf-8")
    return chainbuild.Robot.load(path)


def test_rtcp_shows_the_rotary_axes_and_complete_the_angles(tmp_path: Path) -> None:
    assert list(head(tmp_path).display(AT)) == ["x_mm", "y_mm", "z_mm", "C", "A"]
    shown = head(tmp_path, rtcp=0).display(AT)
    assert list(shown) == ["x_mm", "y_mm", "z_mm", "a_deg", "b_deg", "c_deg"]
    assert [round(shown[name], 9) for name in ("a_deg", "b_deg", "c_deg")] == [20.0, 0.0, 30.0]


@pytest.mark.parametrize("mode", [12, 13])
@pytest.mark.parametrize("rtcp", [0, 1])
def test_direct_modes_show_the_rotary_axes(mode: int, rtcp: int, tmp_path: Path) -> None:
    robot = head(tmp_path, f"programming_mode {mode}", rtcp=rtcp)
    shown = robot.display(AT)
    assert (shown["C"], shown["A"]) == (30.0, 20.0)
    assert np.abs(robot.from_display(shown).axes - AT).max() < 1e-9


def test_numbers_of_mode_14(tmp_path: Path) -> None:
    robot = head(tmp_path, "programming_mode 14")
    shown = robot.display(AT)
    assert [round(shown[name], 3) for name in ("a_deg", "b_deg")] == [17.495, -80.153]
    again = robot.display(AT, near={"a_deg": 190.0, "b_deg": 70.0})
    assert [round(again[name], 3) for name in ("a_deg", "b_deg")] == [197.495, 80.153]


@pytest.mark.parametrize("mode", LETTERS)
@pytest.mark.parametrize("by_channel", [False, True])
def test_two_angles_of_the_tool_vector(mode: int, by_channel: bool, tmp_path: Path) -> None:
    words = {"channel": (f"ori_rotation_angle {mode}",)} if by_channel else {}
    robot = head(tmp_path, *(() if by_channel else (f"programming_mode {mode}",)), **words)  # type: ignore[arg-type]
    columns = [f"{letter.lower()}_deg" for letter in LETTERS[mode]]
    rng = np.random.default_rng(mode)
    near: dict[str, float] | None = None
    for _ in range(200):
        axes = rng.uniform(-170.0, 170.0, 5)
        shown = robot.display(axes, near=near)
        assert list(shown)[3:] == columns
        before = [near[name] for name in columns] if near else None
        wanted = universal_angles(mode, robot.fk(axes).rotation[:, 2], before)
        assert [shown[name] for name in columns] == pytest.approx(wanted, abs=1e-7)
        found = robot.from_display(shown, start=axes)
        assert np.abs(found.axes - axes).max() < 1e-6
        near = shown


def test_at_a_pole_the_first_angle_stays(tmp_path: Path) -> None:
    robot = head(tmp_path, "programming_mode 17")
    shown = robot.display([0.0, 0.0, 0.0, 40.0, 0.0], near={"c_deg": 33.0, "a_deg": 5.0})
    assert (shown["c_deg"], shown["a_deg"]) == (33.0, 0.0)


def test_mode_10_shows_the_tool_vector(tmp_path: Path) -> None:
    robot = head(tmp_path, "programming_mode 10")
    shown = robot.display(AT)
    assert list(shown)[3:] == ["tool_x", "tool_y", "tool_z"]
    np.testing.assert_allclose([shown[f"tool_{c}"] for c in "xyz"], robot.fk(AT).rotation[:, 2], atol=0.0)
    longer = {name: value * (3.0 if name.startswith("tool") else 1.0) for name, value in shown.items()}
    for given in (shown, longer):
        assert np.abs(robot.from_display(given, start=AT).axes - AT).max() < 1e-6


def test_the_own_mode_wins_over_the_channel(tmp_path: Path) -> None:
    robot = head(tmp_path, "programming_mode 14", channel=("ori_rotation_angle 17",))
    assert list(robot.display(AT))[3:] == ["a_deg", "b_deg"]
    told = [finding for finding in robot.chain.findings if finding.code == "CB419"]
    assert len(told) == 1
    assert "14" in told[0].text
    assert "17" in told[0].text
    assert told[0].span is not None


@pytest.mark.parametrize("words", [("programming_mode 11",), ()])
def test_mode_11_is_refused(words: tuple[str, ...], tmp_path: Path) -> None:
    channel = () if words else ("ori_rotation_angle 11",)
    with pytest.raises(ChainbuildError, match="mode 11 is not supported"):
        head(tmp_path, *words, channel=channel)
