"""What the exported page draws and tells through `window.chainbuild`, machine by machine."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser

from chainbuild.inspect.export import export_page
from chainbuild.kinematics.closure import closing_axes
from chainbuild.machines import shipped
from chainbuild.robot import Robot
from tests.kit.live_page import opened

# What the tests of the panel do not open: loops by closed form and by continuation, a nonlinear map, rods, a gantry.
OTHERS = ("delta_kin37", "rod_table_kin19", "rotated_head_kin70", "parallelogram_nr", "gantry_robot_kin210")
FRAMES = ("base", "flange", "tool", "workpiece")


def stands_where_pinocchio_says(name: str, browser: Browser, folder: Path) -> None:
    robot = Robot.load(name)
    rows = closing_axes(robot, np.random.default_rng(5), 6)
    links = [*(link.name for link in robot.chain.links[1:]), *FRAMES]
    page = export_page(robot, folder / "page.html")
    assert page.stat().st_size < 2_000_000
    with opened(browser, page, size=(640, 480)) as live:
        for axes in rows:
            live.call("set", axes)
            np.testing.assert_allclose(live.axes, axes, rtol=0, atol=0)
            known = robot.frame_placements(axes)
            drawn = live.drawn(links)
            for link, T in zip(links, drawn, strict=True):
                np.testing.assert_allclose(T, known[link].homogeneous, rtol=0, atol=1e-6, err_msg=link)
            found = np.array(live.call("fk", axes)).reshape(4, 4)
            np.testing.assert_allclose(found, robot.fk(axes).homogeneous, rtol=0, atol=1e-12)
            shown, told = live.shown(), robot.display(axes)
            assert shown == pytest.approx({column: told[column] for column in shown}, abs=1e-8)
            assert live.status() == "ok"
            live.call("goTo", robot.fk(axes).homogeneous.ravel())
            again = robot.fk(live.axes)
            assert again.translation == pytest.approx(robot.fk(axes).translation, abs=1e-9)
        before = live.axes
        live.call("drag", np.array([1.0, 0, 0, 500, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]))
        assert live.status() in {"unreachable", "limits"}
        assert robot.violated_limits(live.axes) == ()
        assert np.isfinite(before).all()
        live.until("window.chainbuild.frames > 2")


@pytest.mark.parametrize("name", OTHERS)
def test_links_stand_where_pinocchio_says(name: str, browser: Browser, tmp_path: Path) -> None:
    stands_where_pinocchio_says(name, browser, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("name", shipped())
def test_links_of_every_machine_stand_where_pinocchio_says(name: str, browser: Browser, tmp_path: Path) -> None:
    stands_where_pinocchio_says(name, browser, tmp_path)
