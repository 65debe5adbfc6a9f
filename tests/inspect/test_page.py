"""The exported page: one file that loads nothing, opens in a browser and shows the robot."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import chainbuild
from chainbuild import frames
from chainbuild.chain.programmed.display import Display
from chainbuild.errors import FileAccessError, Span
from chainbuild.findings import Finding
from chainbuild.inspect.export import export_page, page_html
from chainbuild.inspect.inline import inline_page
from chainbuild.inspect.sweep import axis_sweep
from chainbuild.kinematics.displayed import vector_of_angles
from chainbuild.robot import Robot
from tests.kit.browser import chromium, document, screenshot
from tests.kit.drawn_robots import ROBOTS, arm

PANEL = 380  # pixels to the left of the picture
Picture = NDArray[np.uint8]


def robot_pixels(picture: Picture) -> NDArray[np.bool_]:
    """Return where the picture shows the warm colour of what carries the tool."""
    red, green, blue = (picture[:, PANEL:, n].astype(int) for n in range(3))
    return (red > 130) & (red - blue > 80) & (red > green) & (green - blue > 15)


def dark_pixels(picture: Picture) -> NDArray[np.bool_]:
    """Return where the picture shows joints, rails and base, below the bar of the viewer's own menu."""
    shown = picture[:, PANEL:].astype(int)
    dark = (shown.max(axis=2) < 110) & (np.ptp(shown, axis=2) < 30)
    dark[:30] = False
    return dark


@pytest.mark.parametrize("name", [*ROBOTS, "kr6r900", "tx2_60"])
def test_screenshot_shows_the_robot(name: str, tmp_path: Path) -> None:
    robot = ROBOTS[name]() if name in ROBOTS else chainbuild.Robot.load(name)
    picture = screenshot(export_page(robot, tmp_path / "page.html"), "#t=0")
    assert picture.shape == (800, 1280, 3)
    warm, machine = robot_pixels(picture), robot_pixels(picture) | dark_pixels(picture)
    assert warm.sum() > 1500, f"{warm.sum()} pixels in the links' colours"
    rows, columns = np.nonzero(machine)
    height, width = machine.shape
    # Not a dot, not cut off, not in a corner.
    assert max(np.ptp(rows) / height, np.ptp(columns) / width) > 0.25
    assert rows.max() < height - 5
    assert columns.min() > 5
    assert columns.max() < width - 5
    assert abs(rows.mean() / height - 0.5) < 0.25
    assert abs(columns.mean() / width - 0.5) < 0.25
    # The background is there, too: most of the picture is pale.
    assert (picture[:, PANEL:].min(axis=2) > 150).mean() > 0.5


def test_the_sweep_moves_the_robot_and_names_the_axis(tmp_path: Path) -> None:
    page = export_page(arm(), tmp_path / "page.html")
    still = robot_pixels(screenshot(page, "#t=0"))
    moved = robot_pixels(screenshot(page, "#t=6.2"))
    assert moved.sum() > 1500
    assert (still != moved).sum() > 3000
    text = document(page, "#t=6.2")
    assert "Axis A2 moves: −190.0°" in text
    assert re.search(r'<tr class="moving"><td>A2</td>', text)


MACHINES = (
    "kr6r900",
    "scara_cc",
    "tx2_60",
    "irb2600_table",
    "ac_table_kin58",
    "palletiser_kin96",
    "cyl_2rot_kin202",
    "pitch",
)
TWO_ANGLES = Display("direction", ("c_deg", "a_deg"), letters="CA", along="z")


@pytest.mark.parametrize("name", [*ROBOTS, *MACHINES, "two angles"])
def test_the_panel_tells_the_pose_of_the_tool(name: str, tmp_path: Path) -> None:
    """Between two keyframes, too: the pose is read from the scene, not from keyframes far apart."""
    robot = (
        ROBOTS[name]()
        if name in ROBOTS
        else chainbuild.Robot.load("tx2_60" if name in ("two angles", "pitch") else name)
    )
    if name == "pitch":
        robot = chainbuild.Robot.load("palletiser_kin213", conventions={"kin213_angles": "pitch_and_turn"})
    if name == "two angles":
        robot = chainbuild.Robot(replace(robot.chain, display=TWO_ANGLES))
    motion = axis_sweep(robot)
    for axis in (0, len(robot.axes) - 1):
        frame = 50 * axis + 16
        text = document(export_page(robot, tmp_path / "page.html"), f"#t={(frame + 0.5) / 10}")
        cells = re.findall(r"<td[^>]*>([^<]*)</td>", re.search(r'id="tcp">.*?</table>', text, re.DOTALL)[0])
        shown = np.array([float(cell.replace("\u2212", "-")) for cell in cells])
        axes = motion.axes[frame : frame + 2].mean(axis=0)
        T, display = robot.fk(axes), robot.chain.display
        assert np.abs(shown[:3] - 1000 * T.translation).max() < 0.06 + 1e-6 * np.abs(axes).max()
        if display.columns == ("a_deg", "b_deg", "c_deg"):
            mode = robot.chain.angle_mode
            assert np.abs(frames.matrix_from_angles(mode, shown[3:].tolist()) - T.rotation).max() < 0.003
        elif display.kind == "direction":
            assert np.abs(vector_of_angles(display, shown[3:].tolist()) - T.rotation[:, 2]).max() < 0.003
        else:
            wanted = [robot.display(axes)[column] for column in robot.chain.display_columns]
            assert np.abs((shown[3:] - wanted + 180.0) % 360.0 - 180.0).max() < 0.06
        if robot.chain.absolute_c:
            assert shown[-1] == pytest.approx(robot.pose_angles(axes)[2], abs=0.06)


def test_the_viewers_own_menu_is_hidden(tmp_path: Path) -> None:
    """Its bar is black, at the upper right."""
    picture = screenshot(export_page(arm(), tmp_path / "page.html"), "#t=0")
    assert picture[:20, 1000:].min() > 150


def test_the_page_is_readable_on_a_narrow_screen(tmp_path: Path) -> None:
    picture = screenshot(export_page(arm(), tmp_path / "page.html"), "#t=0", 600, 800)
    shown = picture[:440]
    warm = (shown[..., 0] > 130) & (shown[..., 0].astype(int) - shown[..., 2] > 80)
    assert warm.sum() > 500


def test_the_page_loads_nothing() -> None:
    text = page_html(arm())
    assert not re.search(r"""(?:src|href)\s*=\s*["']?\s*(?:https?:)?//""", text)
    assert not re.search(r"""(?:@import|url\()\s*["']?\s*(?:https?:)?//""", text)
    # What the browser itself enforces: nothing may be fetched, whatever the viewer's code could do.
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)
    assert policy is not None
    assert "default-src 'none'" in policy[1]
    assert "http" not in policy[1]
    assert "connect-src" not in policy[1]


def test_the_panel_says_what_is_shown() -> None:
    text = page_html(chainbuild.Robot.load("kr6r900"))
    for words in ("KUKA KR 6 R900", "SINUMERIK ROBX", "drawn, not measured", "Conventions", "swept in this order"):
        assert words in text
    for name, lower, upper in (("A1", "170", "170"), ("A2", "190", "45"), ("A6", "350", "350")):
        assert re.search(rf"<td>{name}</td><td>rotary</td>[^/]*−{lower}</td>[^/]*{upper}</td><td>°</td>", text)
    assert "Assumed limits: the machine data contain none" not in text


def test_assumed_and_shortened_ranges_are_owned_up_to() -> None:
    text = page_html(ROBOTS["table"]())
    assert "<td>X *</td>" in text
    assert "Assumed limits: the machine data contain none" in text
    assert "X −300 … 300 mm" in text
    assert "C −180 … 180°" in text


def test_every_convention_used_is_listed() -> None:
    robot = chainbuild.Robot.load("tx2_60")
    text = page_html(robot)
    for used in robot.chain.conventions:
        assert f"{used.convention.name} = {used.choice}" in text


def test_the_same_robot_gives_the_same_page() -> None:
    assert page_html(arm()) == page_html(arm())


def test_a_notebook_shows_the_page_in_place(tmp_path: Path) -> None:
    shown = inline_page(arm(), height=500)
    assert len(repr(shown)) < 100
    page = tmp_path / "notebook.html"
    page.write_text(shown._repr_html_(), "utf-8")
    assert robot_pixels(screenshot(page, "", 1000, 520)).sum() > 500


def test_texts_cannot_break_out_of_the_page(tmp_path: Path) -> None:
    nasty = "</script><script>alert(1)</script>"
    finding = Finding("CB999", "warning", nasty, Span("/home/somebody/secret/file.tea", 7))
    chain = arm().chain
    axes = (replace(chain.axes[0], name="<b>A1"), *chain.axes[1:])
    text = page_html(Robot(replace(chain, title=nasty, findings=(finding,), axes=axes)))
    assert "alert(1)</script>" not in text
    assert "<b>A1" not in text
    assert "file.tea:7" in text
    assert "somebody" not in text


def test_a_failing_export_leaves_the_old_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = tmp_path / "page.html"
    page.write_text("old", "utf-8")

    def fail(_: Robot) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("chainbuild.inspect.export.axis_sweep", fail)
    with pytest.raises(ZeroDivisionError):
        export_page(arm(), page)
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]
    assert page.read_text("utf-8") == "old"


def test_a_missing_folder_is_a_clean_error(tmp_path: Path) -> None:
    with pytest.raises(FileAccessError, match="cannot be written"):
        export_page(arm(), tmp_path / "missing" / "page.html")


def test_a_missing_browser_says_how_to_get_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("shutil.which", lambda _: None)
    with pytest.raises(pytest.fail.Exception, match="apt-get install chromium"):
        chromium()
