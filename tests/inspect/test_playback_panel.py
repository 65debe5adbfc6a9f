"""The playback section of the page, alone in a browser: rows, clock, notes, trace, errors of a recording."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from chainbuild.analysis.singularity.measures import measure
from chainbuild.inspect.bundle import import_map, viewer_file
from chainbuild.inspect.export import export_page
from chainbuild.inspect.playback import axes_playback
from chainbuild.robot import Robot
from tests.kit.live_page import opened as page_opened

# A machine whose tool stands at its first three axes, and that has no pose beyond x = 1000.
STUB = """
<!DOCTYPE html><html lang="en"><meta charset="utf-8"><script type="importmap">{imports}</script>
<body><script>{viewer}</script><script type="module">
import {{ traceRGB }} from "cb/colours";
import {{ startPlayback }} from "cb/playback";
const placed = ([x, y, z]) => [1, 0, 0, x / 1000, 0, 1, 0, y / 1000, 0, 0, 1, z / 1000, 0, 0, 0, 1];
window.traceColour = (value) => traceRGB(value).map((part) => part / 255);
window.drawn = (name) => window.page.inWorkpiece.getObjectByName(name);
window.numbers = (name, attribute) => Array.from(window.drawn(name).geometry.attributes[attribute].array);
window.start = async (playback, at) => {{
  window.player?.pause();
  document.body.replaceChildren(Object.assign(document.createElement("section"), {{ id: "root" }}));
  window.page = {{
    data: {{ playback, given: at !== null }}, moves: [], redrawn: 0,
    setAxes(axes) {{ this.moves.push(axes); }},
    redraw() {{ this.redrawn += 1; }},
    chain: {{ fk: (axes) => (axes[0] > 1000 ? null : placed(axes)) }},
    three: MeshCat.THREE, inWorkpiece: new MeshCat.THREE.Group(), root: document.getElementById("root"),
  }};
  window.player = startPlayback(window.page);
  if (window.player) await window.player.ready;
}};
</script></body></html>
"""
ROWS = [[0, 0, 0, 10], [100, 0, 0, 20], None, [200, 50, 0, 30], [200, 50, 80, 40], [2000, 0, 0, 50]]
NOTES = [
    {"row": 2, "last": 2, "kind": "close", "text": "<b>close</b> to singular"},
    {"row": 3, "last": 3, "kind": "unreachable", "text": "unreachable: too far"},
    {"row": 5, "last": 6, "kind": "limit", "text": "Y is 50, outside 0 … 40 mm"},
]
PLAYBACK = {
    "kind": "axes", "source": "<img src=x onerror=alert(1)>.csv", "rows": ROWS, "numbers": [1, 2, 3, 4, 5, 6],
    "singular": [1.0, 0.05, None, 1e-9, 0.3, None], "notes": NOTES, "remarks": [], "measured": None, "errors": None,
}  # fmt: skip
MEASURED = {
    "kind": "recording", "rows": [ROWS[0], ROWS[1], ROWS[3]], "numbers": [1, 2, 3], "singular": [1.0, 1.0, 1.0],
    "notes": [], "measured": [[0.001, 0.0, 0.0], [0.1, -0.002, 0.0], [0.2, 0.05, 0.0]],
    "errors": [[1.0, 0.0, 0.0], [0.0, -2.0, 0.0], None], "turns": [0.26, None, None],
}  # fmt: skip

Open = Callable[..., Page]


@pytest.fixture(scope="module")
def opened(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Page, list[str]]]:
    """Return a page that waits for playbacks, and what goes wrong on it."""
    file = tmp_path_factory.mktemp("section") / "section.html"
    file.write_text(STUB.format(imports=import_map(), viewer=viewer_file("main.min.js")), "utf-8")
    wrong: list[str] = []
    page = browser.new_page(viewport={"width": 420, "height": 700})
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.on("console", lambda message: wrong.append(message.text) if message.type == "error" else None)
    page.goto(file.as_uri())
    page.wait_for_function("window.start")
    yield page, wrong
    page.close()


@pytest.fixture
def show(opened: tuple[Page, list[str]]) -> Iterator[Open]:
    """Return a function that opens the section with a playback; an error on its console fails the test."""
    page, wrong = opened

    def show_playback(playback: dict[str, Any] | None, at: list[float] | None = None) -> Page:
        page.evaluate("([playback, at]) => start(playback, at)", [playback, at])
        return page

    yield show_playback
    assert wrong == []


def row(page: Page) -> str:
    shown = page.locator("[data-row]")
    number = shown.get_attribute("data-row")
    assert number is not None
    assert shown.inner_text() == (number or "–")
    return number


def last_move(page: Page) -> list[float]:
    return page.evaluate("page.moves.at(-1)")


def test_rows_are_reached_by_slider_keyboard_and_notes(show: Open) -> None:
    page = show(PLAYBACK)
    assert (row(page), last_move(page)) == ("1", ROWS[0])
    slider = page.get_by_role("slider", name="Row of")
    slider.press("ArrowRight")
    assert (row(page), last_move(page)) == ("2", ROWS[1])
    assert slider.get_attribute("aria-valuetext") == "row 2"
    status = page.get_by_role("status")
    assert status.text_content() == "smallest singular value 0.05\n<b>close</b> to singular"
    slider.press("ArrowRight")
    assert (row(page), last_move(page)) == ("3", ROWS[1])
    said = (status.text_content() or "").split("\n")
    assert said[:2] == ["no axis values: the machine stays where it was", "unreachable: too far"]
    slider.fill("5")
    assert (row(page), last_move(page)) == ("6", ROWS[5])
    assert "outside 0 … 40 mm" in status.inner_text()
    page.get_by_role("button", name="row 2: <b>close</b>").press("Enter")
    assert (row(page), last_move(page)) == ("2", ROWS[1])
    assert page.get_by_role("button", name="rows 5 … 6: Y is 50").count() == 1
    # Texts of files are no markup.
    assert page.locator("#root img, #root b").count() == 0
    assert "<img src=x onerror=alert(1)>.csv: 6 rows, axis values" in page.locator("#root").inner_text()


def test_violations_are_stepped_through(show: Open) -> None:
    page = show(PLAYBACK)
    after, before = (page.get_by_role("button", name=f"{side} violation") for side in ("Next", "Previous"))
    seen = []
    for step in (after, after, after, before, before):
        step.click()
        seen.append(row(page))
    assert seen == ["3", "5", "5", "3", "3"]
    assert page.get_by_role("status").inner_text() == "no violation before row 3"
    page = show({**PLAYBACK, "notes": NOTES[:1]})
    assert page.get_by_role("button", name="Next violation").is_disabled()


def test_it_plays_between_rows_and_stops_on_one(show: Open) -> None:
    page = show(PLAYBACK)
    page.get_by_label("Speed").select_option("2")
    page.get_by_role("button", name="Play").click()
    page.wait_for_function("page.moves.length > 4")
    moves = page.evaluate("page.moves")[1:]
    assert any(0 < x < 100 for x, *_ in moves)
    assert all(y == z == 0 and abs(a - 10 - x / 10) < 1e-9 for x, y, z, a in moves if x < 100)
    page.get_by_role("button", name="Pause").click()
    assert last_move(page) in ROWS
    assert page.evaluate("player.playing") is False
    assert int(row(page)) == ROWS.index(last_move(page)) + 1
    page.get_by_label("Speed").select_option("50")
    page.get_by_role("button", name="Play").click()
    page.wait_for_function("!player.playing")
    assert (row(page), last_move(page)) == ("6", ROWS[5])
    moves = page.evaluate("page.moves")
    assert not any(100 < x < 200 for x, *_ in moves)  # nothing is known between a row and one without solution
    page.get_by_label("Speed").select_option("0.5")
    page.get_by_role("button", name="Play").click()  # from the first row again
    page.wait_for_function("page.moves.at(-1)[0] < 50")
    page.get_by_role("button", name="Pause").click()


def test_the_trace_has_the_colours_of_the_legend_and_gaps(show: Open) -> None:
    page = show(PLAYBACK)
    places = page.evaluate("numbers('trace rows', 'position')")
    colours = page.evaluate("numbers('trace rows', 'color')")
    wanted = [[x / 1000, y / 1000, z / 1000] for x, y, z, _ in (ROWS[0], ROWS[1], ROWS[3], ROWS[4])]
    assert places == pytest.approx([value for place in wanted for value in place], abs=1e-7)
    known = page.evaluate("[1.0, 0.05, 1e-9, 0.3].map(traceColour)")
    assert colours == pytest.approx([part for colour in known for part in colour], abs=1e-6)
    lines = page.evaluate("numbers('trace lines', 'position')")
    begins, ends = lines[0::6], lines[3::6]
    assert not any(b < 0.11 < e for b, e in zip(begins, ends, strict=True))  # no line across row 3
    assert 0.2 < max(ends) <= 1.0  # to the row without pose as far as there are poses
    assert len(begins) > 2 * 8  # on a curve between rows, as the axes move evenly
    colours = page.evaluate("numbers('trace lines', 'color')")
    assert len(colours) == len(lines)
    halfway = 6 * next(n for n, b in enumerate(begins) if b == pytest.approx(0.05, abs=1e-7))
    assert colours[halfway : halfway + 3] == pytest.approx(page.evaluate("traceColour(0.525)"), abs=1e-6)
    page.get_by_label("Trace", exact=True).uncheck()
    assert page.evaluate("drawn('trace').visible") is False
    page = show({**PLAYBACK, "kind": "poses"})
    assert len(page.evaluate("numbers('trace lines', 'position')")) == 2 * 6  # rows of poses are joined by lines


def test_colours_fall_from_singular_to_good(show: Open) -> None:
    page = show(None)
    assert page.locator("#root").is_hidden()
    assert page.evaluate("player") is None
    worst, low, middle, good, beyond, none = page.evaluate("[0, 0.001, 0.0316, 1, 7, null].map(traceColour)")
    assert worst == low
    assert good == beyond
    assert worst[0] > 0.5 > worst[2]
    assert good[2] > 0.5 > good[0]
    assert middle not in (worst, good)
    assert max(none) - min(none) < 0.1


def test_the_legend_names_its_scale(show: Open) -> None:
    page = show(PLAYBACK)
    legend = page.locator("figure")
    assert legend.inner_text().split("\n") == [
        "≤ 0.001", "0.01", "0.1", "≥ 1", "Trace: smallest singular value, scaled; red is singular, grey unknown",
    ]  # fmt: skip
    bar = legend.locator("div").first.evaluate("(e) => getComputedStyle(e).backgroundImage")
    first = page.evaluate("traceColour(0.001).map((v) => Math.round(255 * v)).join(', ')")
    assert bar.startswith(f"linear-gradient(to right, rgb({first}), ")


def test_errors_of_a_recording_are_drawn_to_a_scale_that_is_said(show: Open) -> None:
    page = show({**PLAYBACK, **MEASURED})
    # The largest error, 2 mm, is to be a twentieth of 206 mm: five times is less than the next power of ten.
    scale = page.get_by_label("Errors")
    assert scale.input_value() == "1"
    points = page.evaluate("numbers('measured points', 'position')")
    assert points == pytest.approx([value for point in MEASURED["measured"] for value in point], abs=1e-7)
    vectors = page.evaluate("numbers('error vectors', 'position')")
    assert vectors == pytest.approx([0, 0, 0, 0.001, 0, 0, 0.1, 0, 0, 0.1, -0.002, 0], abs=1e-7)
    assert "drawn 1 times as long" in page.locator("#root").inner_text()
    scale.select_option("10")
    vectors = page.evaluate("numbers('error vectors', 'position')")
    assert vectors == pytest.approx([0, 0, 0, 0.01, 0, 0, 0.1, 0, 0, 0.1, -0.02, 0], abs=1e-7)
    assert "drawn 10 times as long" in page.locator("#root").inner_text()
    assert page.evaluate("page.inWorkpiece.children.filter((c) => c.name === 'measured').length") == 1
    assert "(dx +1.000, dy 0.000, dz 0.000), turned by 0.260°" in page.get_by_role("status").inner_text()
    page.evaluate("player.seek(2)")
    said = page.get_by_role("status").inner_text()
    assert said.endswith("measured 2.000 mm from the model (dx 0.000, dy −2.000, dz 0.000)")
    small = [[0.01, 0.0, 0.0], [0.0, -0.02, 0.0], None]
    assert show({**PLAYBACK, **MEASURED, "errors": small}).get_by_label("Errors").input_value() == "100"


def test_axis_values_to_open_at_come_first(show: Open) -> None:
    page = show(PLAYBACK, at=[1, 2, 3, 4])
    assert page.evaluate("page.moves") == []
    assert row(page) == ""
    page.get_by_role("slider", name="Row of").press("ArrowRight")
    assert (row(page), last_move(page)) == ("2", ROWS[1])


def test_of_many_notes_the_first_are_listed(show: Open) -> None:
    many = [{"row": 1, "last": 1, "kind": "close", "text": f"note {n}"} for n in range(620)]
    page = show({**PLAYBACK, "notes": many, "remarks": ["sampled"]})
    assert page.locator("button[data-note]").count() == 500
    assert {"620 notes on rows", "… and 120 more", "sampled"} <= set(page.locator("#root").inner_text().split("\n"))


def test_the_whole_page_plays_the_rows_of_a_file(browser: Browser, tmp_path: Path) -> None:
    robot = Robot.load("kr6r900")
    rows = np.array(
        [[0, -90, 90, 0, 30, 0], [20, -80, 90, 0, 12.25, 0], [40, -70, 95, 0, 0, 0], [60, -60, 200, 0, 9, 0]]
    )
    path = tmp_path / "rows.csv"
    path.write_text("A1,A2,A3,A4,A5,A6\n" + "\n".join(",".join(map(str, row)) for row in rows), "utf-8")
    played = axes_playback(robot, path)
    smallest = [measure(robot, row).smallest for row in rows]
    with page_opened(browser, export_page(robot, tmp_path / "page.html", playback=played)) as live:
        shown = live.one("[data-row]")
        assert shown.get_attribute("data-row") == "1"
        np.testing.assert_array_equal(live.axes, rows[0])
        live.one("#playback input[type=range]").focus()
        for n in (1, 2, 3):
            live.tab.keyboard.press("ArrowRight")
            assert shown.get_attribute("data-row") == str(n + 1)
            np.testing.assert_array_equal(live.axes, rows[n])
            told = live.tab.evaluate("(axes) => window.chainbuild.singular(axes).smallest", rows[n].tolist())
            assert told == pytest.approx(smallest[n], abs=1e-12)
            assert played.data()["singular"][n] == pytest.approx(smallest[n], rel=1e-6, abs=1e-11)
        assert live.status() == "limits"
        live.one('input[type=range][data-axis="A1"]').focus()
        live.tab.keyboard.press("ArrowRight")
        assert shown.get_attribute("data-row") == ""  # what is shown is no row of the file any more
        live.one("#playback").get_by_role("button", name="Previous violation").click()
