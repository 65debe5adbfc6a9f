"""The exported page: one file that loads nothing, opens in a browser and shows the robot."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Browser

import chainbuild
from chainbuild import frames
from chainbuild.chain.programmed.display import Display
from chainbuild.errors import FileAccessError, Span
from chainbuild.findings import Finding
from chainbuild.inspect.export import export_page, page_html
from chainbuild.inspect.panel import panel_html
from chainbuild.inspect.sweep import rest_pose
from chainbuild.kinematics.displayed import vector_of_angles
from chainbuild.robot import Robot
from tests.kit.browser import chromium
from tests.kit.drawn_robots import ROBOTS, arm
from tests.kit.live_page import LivePage, opened

PANEL = 392  # pixels to the left of the picture
Picture = NDArray[np.uint8]


def robot_pixels(picture: Picture) -> NDArray[np.bool_]:
    """Return where a picture shows the warm colour of what carries the tool."""
    red, green, blue = (picture[..., n].astype(int) for n in range(3))
    return (red > 130) & (red - blue > 80) & (red > green) & (green - blue > 15)


def dark_pixels(picture: Picture) -> NDArray[np.bool_]:
    """Return where a picture shows joints, rails and base."""
    shown = picture.astype(int)
    return (shown.max(axis=2) < 110) & (np.ptp(shown, axis=2) < 30)


def machine_alone(live: LivePage) -> Picture:
    """Return the picture of the machine without frames, gizmo and buttons."""
    live.one("[data-gizmo=off]").click()
    live.one("[data-show=frames]").uncheck()
    live.tab.wait_for_timeout(150)
    picture = live.picture()[:, PANEL:].copy()
    picture[:40] = picture[41, 0]
    return picture


TWO_ANGLES = Display("direction", ("c_deg", "a_deg"), letters="CA", along="z")


def machine(name: str) -> Robot:
    """Return a robot of these tests."""
    if name in ROBOTS:
        return ROBOTS[name]()
    if name == "pitch":
        return Robot.load("palletiser_kin213", conventions={"kin213_angles": "pitch_and_turn"})
    if name == "two angles":
        return Robot(replace(Robot.load("tx2_60").chain, display=TWO_ANGLES))
    return Robot.load(name)


SEEN = tuple(ROBOTS)
TOLD = ("palletiser_kin96", "pitch", "two angles")


QUICK = ("arm", "table", "pitch")  # a robot, a five-axis machine, fewer than six freedoms
MARKED = [pytest.param(name, marks=[pytest.mark.slow] * (name not in QUICK)) for name in (*SEEN, *TOLD)]


@pytest.mark.parametrize("name", MARKED)
def test_the_page_shows_the_robot_and_tells_the_pose_of_the_tool(name: str, browser: Browser, tmp_path: Path) -> None:
    robot = machine(name)
    size = (1280, 800) if name in SEEN else (420, 320)
    with opened(browser, export_page(robot, tmp_path / "page.html"), size=size) as live:
        np.testing.assert_allclose(live.axes, rest_pose(robot), atol=1e-9)
        for change in (0.0, 7.3, -11.9):
            assert_pose_told(live, robot, rest_pose(robot) + change)
        if name in SEEN:
            live.call("set", rest_pose(robot))
            assert live.picture()[:8, 1000:].min() > 150  # the bar of the viewer's own menu is black
            assert_robot_seen(machine_alone(live))


def assert_robot_seen(picture: Picture) -> None:
    warm = robot_pixels(picture)
    assert warm.sum() > 1500, f"{warm.sum()} pixels in the links' colours"
    rows, columns = np.nonzero(warm | dark_pixels(picture))
    height, width = warm.shape
    # Not a dot, not cut off, not in a corner.
    assert max(np.ptp(rows) / height, np.ptp(columns) / width) > 0.25
    assert rows.max() < height - 5
    assert columns.min() > 5
    assert columns.max() < width - 5
    assert abs(rows.mean() / height - 0.5) < 0.25
    assert abs(columns.mean() / width - 0.5) < 0.25
    # The background is there, too: most of the picture is pale.
    assert (picture.min(axis=2) > 150).mean() > 0.5


def assert_pose_told(live: LivePage, robot: Robot, axes: NDArray[np.float64]) -> None:
    live.call("set", axes)
    T, shown, display = robot.fk(axes), live.shown(), robot.chain.display
    assert list(shown) == ["x_mm", "y_mm", "z_mm", *robot.chain.display_columns]
    np.testing.assert_allclose(list(shown.values())[:3], 1000 * T.translation, atol=1e-8)
    values = list(shown.values())[3:]
    if display.columns == ("a_deg", "b_deg", "c_deg"):
        R = frames.matrix_from_angles(robot.chain.angle_mode, values)
        np.testing.assert_allclose(R, T.rotation, atol=1e-9)
    elif display.kind == "direction":
        np.testing.assert_allclose(vector_of_angles(display, values), T.rotation[:, 2], atol=1e-9)
    else:
        wanted = [robot.display(axes)[column] for column in robot.chain.display_columns]
        assert np.abs((np.subtract(values, wanted) + 180.0) % 360.0 - 180.0).max(initial=0.0) < 1e-8
    for column, text in fields_of(live):
        assert float(text) == pytest.approx(shown[column], abs=0.00051)


def fields_of(live: LivePage) -> list[tuple[str, str]]:
    """Return column and text of every field of the pose."""
    found: list[tuple[str, str]] = live.tab.evaluate(
        "[...document.querySelectorAll('[data-pose]')].map((f) => [f.dataset.pose, f.value])"
    )
    return found


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
    for words in ("KUKA KR 6 R900", "SINUMERIK ROBX", "drawn, not measured", "Conventions", "Axis A1"):
        assert words in text
    for name, lower, upper in (("A1", "170", "170"), ("A2", "190", "45"), ("A6", "350", "350")):
        assert f'aria-label="Axis {name}" title="rotary, limits −{lower} … {upper} degrees"' in text
    assert "Assumed limits: the machine data contain none" not in text


def test_assumed_and_shortened_ranges_are_owned_up_to() -> None:
    text = page_html(ROBOTS["table"]())
    assert '<span class="name">X *</span>' in text
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


def test_texts_cannot_break_out_of_the_page(tmp_path: Path) -> None:
    nasty = "</script><script>alert(1)</script>"
    finding = Finding("CB999", "warning", nasty, Span("/home/private-place/file.tea", 7))
    chain = arm().chain
    axes = (replace(chain.axes[0], name="<b>A1"), *chain.axes[1:])
    text = page_html(Robot(replace(chain, title=nasty, findings=(finding,), axes=axes)))
    assert "alert(1)</script>" not in text
    assert "<b>A1" not in text
    assert "file.tea:7" in text
    assert "private-place" not in text


def test_a_failing_export_leaves_the_old_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = tmp_path / "page.html"
    page.write_text("old", "utf-8")

    def fail(_: Robot) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("chainbuild.inspect.export.rest_pose", fail)
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


def test_long_names_of_joints_stand_above_their_sliders() -> None:
    chain = chainbuild.load("kr6r900").chain()
    renamed = replace(chain.axes[1], name="shoulder_lift_joint")
    text = panel_html(replace(chain, axes=(chain.axes[0], renamed), dialect="URDF", kinematic="URDF"), 0.1)
    assert '<div class="axis" role="group" aria-label="Axis A1"' in text
    assert '<div class="axis long" role="group" aria-label="Axis shoulder_lift_joint"' in text
    assert '<p class="soft">URDF</p>' in text
