"""The page in the cell of a notebook: what moves there moves in Python, and the other way round."""

from __future__ import annotations

import gzip
import json
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from anywidget import AnyWidget
from numpy.typing import NDArray
from playwright.sync_api import Browser

import chainbuild
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.inspect import notebook
from chainbuild.inspect.bundle import asset
from chainbuild.inspect.export import page_html
from chainbuild.robot import Robot
from tests.kit.notebook_page import OTHER, Notebook

AXES = [10.0, -80.0, 70.123456789012345, 20.0, 40.0, -30.0]
OTHERS = [-15.0, -60.0, 50.0, 5.0, 0.1 + 0.2, 1e-7]
POSE = "[0.5,0.5,0.7071,0.5, 0.5,0.5,-0.7071,0.1, -0.70710678,0.70710678,0,0.7, 0,0,0,1]"


def arm() -> Robot:
    return Robot.load("kr6r900")


@cache
def the_view() -> Any:
    return chainbuild.show(arm(), at=AXES, height=300)


@pytest.fixture
def view() -> Any:
    """Return a widget at the axis values of these tests."""
    the_view().axes = AXES
    return the_view()


@pytest.fixture(scope="module")
def notebook_of_all(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Notebook]:
    tab = browser.new_page(viewport={"width": 640, "height": 640})
    shown = Notebook(the_view(), tab, tmp_path_factory.mktemp("notebook"), OTHER)
    yield shown
    assert shown.live.told == []
    tab.close()


@pytest.fixture
def cells(notebook_of_all: Notebook) -> Notebook:
    """Return the notebook with the machine where it was at first."""
    notebook_of_all.say(AXES)
    notebook_of_all.until(lambda: notebook_of_all.axes(0) == notebook_of_all.axes(1) == AXES)
    notebook_of_all.tab.evaluate("window.saved = 0")
    return notebook_of_all


def test_the_page_opens_where_python_says(cells: Notebook) -> None:
    assert cells.tab.evaluate("[...document.querySelectorAll('iframe')].map((f) => f.offsetHeight)") == [300, 300]
    assert cells.tab.evaluate("document.querySelector('iframe').title") == arm().chain.title
    assert cells.cell(0).evaluate("window.origin") == "null"
    assert cells.saved == 0


def test_the_wheel_scrolls_the_notebook_until_the_page_is_clicked(cells: Notebook) -> None:
    def scrolled() -> int:
        before = cells.tab.evaluate("window.scrollY")
        cells.tab.mouse.wheel(0, 40)
        cells.tab.wait_for_timeout(150)
        return int(cells.tab.evaluate("window.scrollY") - before)

    cells.tab.mouse.move(600, 250)  # over the picture; nothing was clicked so far
    assert scrolled() > 0
    cells.tab.evaluate("window.scrollTo(0, 0)")
    cells.tab.mouse.click(600, 250)
    assert scrolled() == 0
    cells.tab.mouse.click(600, 630)  # below the cells
    cells.tab.mouse.move(600, 250)
    assert scrolled() > 0
    cells.tab.evaluate("window.scrollTo(0, 0)")


def test_what_is_dragged_in_the_page_is_had_in_python(cells: Notebook) -> None:
    heard: list[NDArray[np.float64]] = []
    end = cells.view.on_axes(heard.append)
    cells.cell(0).evaluate(f"window.chainbuild.drag({POSE})")
    cells.until(lambda: cells.saved == 1)
    assert cells.kept == cells.axes(0) != AXES
    assert cells.hear() == cells.axes(0)  # all digits
    assert [list(axes) for axes in heard] == [cells.axes(0)]
    page = np.array(cells.cell(0).evaluate("window.chainbuild.fk(window.chainbuild.axes())")).reshape(4, 4)
    np.testing.assert_allclose(cells.view.pose.homogeneous, page, rtol=0, atol=1e-12)
    end()
    cells.say(AXES)
    assert len(heard) == 1


def test_a_slider_moves_the_other_cells_and_python(cells: Notebook) -> None:
    script = (
        "const s = document.querySelector('input[type=range]'); s.value = 33.3; s.dispatchEvent(new Event('input'))"
    )
    cells.cell(0).evaluate(f"() => {{ {script}; }}")
    wanted = [33.3, *AXES[1:]]
    cells.until(lambda: cells.axes(1) == wanted)
    assert cells.hear() == wanted
    assert cells.saved == 1


def test_another_cell_moves_the_page(cells: Notebook) -> None:
    cells.cell(1).evaluate(f"window.chainbuild.say({OTHERS})")
    cells.until(lambda: cells.axes(0) == OTHERS)
    cells.settle()
    assert cells.hear() == OTHERS
    assert cells.axes(1) == AXES  # who says it is not told
    assert cells.saved == 1  # and who is told does not say it once more


def test_what_python_sets_moves_every_cell_and_comes_not_back(cells: Notebook) -> None:
    cells.say(OTHERS)
    cells.until(lambda: cells.axes(0) == cells.axes(1) == OTHERS)
    cells.tab.wait_for_timeout(350)  # until the page has looked for other solutions: that moves nothing
    assert cells.saved == 0


def test_a_hand_that_drags_is_not_jerked_back(cells: Notebook) -> None:
    slider = cells.cell(0).locator("input[type=range]").first
    slider.scroll_into_view_if_needed()
    box = slider.bounding_box()
    assert box is not None
    mouse, height = cells.tab.mouse, box["y"] + box["height"] / 2
    mouse.move(box["x"] + 0.6 * box["width"], height)
    mouse.down()
    cells.until(lambda: cells.saved)
    mine = cells.axes(0)
    cells.say(OTHERS)
    cells.until(lambda: cells.axes(1) == OTHERS)
    cells.settle()
    assert cells.axes(0) == mine
    mouse.move(box["x"] + 0.7 * box["width"], height)
    cells.until(lambda: cells.kept[0] > mine[0])
    mouse.up()
    cells.settle()
    cells.until(lambda: cells.axes(0) == cells.axes(1) == cells.kept)  # moved last by the hand
    assert cells.kept[0] > mine[0]
    mouse.down()
    mouse.move(box["x"] + 0.5 * box["width"], height)
    cells.until(lambda: cells.kept[0] < mine[0])
    cells.say(OTHERS)
    cells.settle()
    assert cells.axes(0) != OTHERS
    mouse.up()
    cells.until(lambda: cells.axes(0) == OTHERS)  # set last by Python


BAD = (
    "null", "7", "'axes'", "{}", "{ chainbuild: 'axes' }", "{ chainbuild: 'axes', axes: 5 }",
    "{ chainbuild: 'axes', axes: [1, 2] }", "{ chainbuild: 'axes', axes: [1, 2, 3, 4, 5, NaN] }",
    "{ chainbuild: 'axes', axes: [1, 2, 3, 4, 5, '6'] }", "{ chainbuild: 'axes', axes: [1, 2, 3, 4, 5, null] }",
    "{ chainbuild: 'other', axes: [1, 2, 3, 4, 5, 6] }", "{ axes: [1, 2, 3, 4, 5, 6] }",
)  # fmt: skip
GOOD = "{ chainbuild: 'axes', axes: [1, 2, 3, 4, 5, 6] }"


def test_malformed_messages_move_nothing(cells: Notebook) -> None:
    messages = f"[{', '.join(BAD)}]"
    cells.tab.evaluate(f"{messages}.forEach((message) => window.frames[0].postMessage(message, '*'))")
    huge = "{ chainbuild: 'axes', axes: [1e9, 2, 3, 4, 5, 6] }"
    cells.cell(0).evaluate(f"{messages}.concat({huge}).forEach((message) => window.parent.postMessage(message, '*'))")
    cells.settle()
    assert cells.axes(0) == cells.axes(1) == cells.kept == AXES
    assert cells.saved == 0


def test_only_the_page_and_its_notebook_are_listened_to(cells: Notebook) -> None:
    cells.cell(1).evaluate(f"window.parent.frames[0].postMessage({GOOD}, '*')")
    cells.cell(0).evaluate(f"window.postMessage({GOOD}, '*')")
    cells.tab.evaluate(f"window.postMessage({GOOD}, '*')")
    cells.settle()
    assert cells.axes(0) == cells.axes(1) == cells.kept == AXES


def test_a_page_that_is_loaded_anew_stands_where_the_others_do(cells: Notebook) -> None:
    cells.say(OTHERS)
    cells.tab.evaluate("document.querySelector('#cell2').append(document.querySelector('#cell1 iframe'))")
    cells.until(lambda: cells.axes(2) == OTHERS)
    cells.tab.evaluate("document.querySelector('#cell1').append(document.querySelector('#cell2 iframe'))")
    cells.until(lambda: cells.axes(1) == OTHERS)
    assert cells.saved == 0


def test_a_cell_that_is_cleared_neither_speaks_nor_listens(cells: Notebook) -> None:
    cells.tab.evaluate("async () => { window.end = await window.shown('cell2'); }")
    cells.until(lambda: cells.axes(2) == AXES)
    cells.tab.evaluate("window.end()")
    cells.cell(2).evaluate(f"window.chainbuild.say({OTHERS})")
    cells.settle()
    assert cells.kept == AXES
    cells.say(OTHERS)
    cells.until(lambda: cells.axes(1) == OTHERS)
    assert cells.axes(2) == AXES
    cells.tab.evaluate("document.querySelector('#cell2').replaceChildren()")


def test_a_page_that_may_not_run_is_said_to_be_missing(browser: Browser, tmp_path: Path) -> None:
    tab = browser.new_page()
    tab.clock.install()
    Notebook(the_view(), tab, tmp_path, page="nothing")
    tab.wait_for_selector("#cell0 p", state="attached")
    tab.clock.fast_forward(19_000)
    assert tab.inner_text("#cell0") == ""
    tab.clock.fast_forward(2_000)
    assert "inspect --export" in tab.inner_text("#cell0")
    tab.close()


@pytest.mark.parametrize(("theme", "dark"), [("false", True), ("true", False)])
def test_the_page_is_dark_where_the_notebook_is(browser: Browser, tmp_path: Path, theme: str, dark: bool) -> None:
    tab = browser.new_context(color_scheme="null").new_page()
    shown = Notebook(the_view(), tab, tmp_path, page=OTHER, theme=theme)
    assert shown.cell(0).evaluate("matchMedia('(prefers-color-scheme: dark)').matches") is dark
    tab.context.close()


def test_python_refuses_what_are_no_axis_values(view: Any) -> None:
    for bad in ([1.0], [np.nan] * 6, [1e10] * 6, None, "axes", [[1.0] * 6]):
        with pytest.raises(AxisValueError):
            view.axes = bad
        with pytest.raises(AxisValueError):
            view.set_state({"axes": bad})
        assert list(view.axes) == AXES
    with pytest.raises(AxisValueError):
        chainbuild.show(arm(), at=[0.0])
    for height in (0, -5, 3.5, True, "400px"):
        with pytest.raises(ChainbuildError, match="height"):
            chainbuild.show(arm(), height=height)


def test_python_keeps_its_own_axis_values(view: Any) -> None:
    given = np.array(OTHERS)
    view.axes = given
    given[0] = 99.0
    assert list(view.axes) == OTHERS
    with pytest.raises(ValueError, match="read-only"):
        view.axes[0] = 1.0
    heard: list[Any] = []
    view.on_axes(heard.append)
    view.axes = OTHERS
    assert heard == []  # nothing has changed


def test_a_view_is_a_widget_and_opens_as_its_page_would() -> None:
    robot = arm()
    view = chainbuild.show(robot)
    assert isinstance(view, chainbuild.RobotView) and isinstance(view, AnyWidget)
    assert list(view.axes) == [0.0, -90.0, 90.0, 0.0, 90.0, 0.0]
    np.testing.assert_array_equal(view.pose.homogeneous, robot.fk(view.axes).homogeneous)
    assert repr(view) == "<RobotView kr6r900: A1 0, A2 -90, A3 90, A4 0, A5 90, A6 0 [deg]>"


def test_lengths_are_on_the_page() -> None:
    machine = chainbuild.load("ca_head_kin9")
    robot = Robot(machine.chain())
    lengths = chainbuild.dimensions(machine)
    view: Any = chainbuild.show(robot, dimensions=lengths)
    data = gzip.decompress(view._page).decode().partition('id="page-data">')[2].partition("</script>")[0]
    assert len(json.loads(data)["dimensions"]) == len(lengths) > 0


def test_without_widgets_a_picture_is_seen(view: Any) -> None:
    data, _ = view._repr_mimebundle_()
    assert data["application/vnd.jupyter.widget-view+json"]["model_id"] == view.model_id
    assert data["image/svg+xml"].startswith("<svg")
    view.axes = OTHERS
    assert view._repr_mimebundle_()[0]["image/svg+xml"] != data["image/svg+xml"]
    assert sum(len(str(one)) for one in data.values()) < 60_000


def test_where_there_is_no_pose_there_is_no_picture() -> None:
    view: Any = chainbuild.show(Robot.load("tripod_kin12"))
    view.axes = [0.0, 0.0, -9000.0]
    assert "image/svg+xml" not in view._repr_mimebundle_()[0]
    with pytest.raises(ChainbuildError):
        view.pose  # noqa: B018


def test_without_the_extra_it_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "anywidget", None)
    notebook._widget_type.cache_clear()
    with pytest.raises(ChainbuildError, match="anywidget") as caught:
        chainbuild.show(arm())
    assert "chainbuild[notebook]" in str(caught.value.hint)
    assert "inspect --export" in str(caught.value.hint)


def test_only_a_call_imports_what_notebooks_need() -> None:
    code = "import chainbuild, sys; chainbuild.show; print({'anywidget', 'ipywidgets', 'IPython'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


def test_the_widget_is_no_part_of_the_page() -> None:
    assert "DecompressionStream" in asset("notebook/widget.js")
    page = page_html(arm())
    assert "DecompressionStream" not in page
    assert '"embedded"' not in page
