"""The page in Chromium: time of a drag event, frames a second; `python -m tests.bench.page` writes the table."""

from __future__ import annotations

import statistics
import tempfile
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

import chainbuild
from chainbuild.inspect.export import export_page
from tests.bench.tables import markdown
from tests.kit.browser import chromium
from tests.kit.live_page import FLAGS, opened

MACHINES = ("kr6r900", "tx2_60", "irb2600")
SIZE = (640, 360)
MARKS = "first paint 2 s, a drag event 5 ms, 30 frames a second with seven ghosts"
# Away from the limits and from singular positions: every branch that the arm has stays while the tool moves.
_AXES = (10.0, -60.0, 80.0, 30.0, 40.0, 20.0)
_DRAGS = """
(axes) => {
  const page = window.chainbuild;
  page.set(axes);
  const T = page.fk(axes);
  page.goTo(T);
  const times = [];
  for (let n = 0; n < 300; n += 1) {
    const moved = T.slice();
    moved[3] += 0.03 * Math.sin(n / 20);
    moved[7] += 0.03 * (1 - Math.cos(n / 20));
    const start = performance.now();
    page.drag(moved);
    times.push(performance.now() - start);
  }
  return { times, ghosts: page.ghosts };
}
"""
_FRAMES = """
(axes) => new Promise((resolve) => {
  const page = window.chainbuild;
  const T = page.fk(axes);
  const [start, first] = [performance.now(), page.frames];
  const step = (now) => {
    const moved = T.slice();
    moved[3] += 0.03 * Math.sin((now - start) / 300);
    page.drag(moved);
    if (now - start < 4000) requestAnimationFrame(step);
    else resolve((1000 * (page.frames - first)) / (now - start));
  };
  requestAnimationFrame(step);
})
"""


def measured(browser: Any, name: str) -> tuple[object, ...]:
    """Return a machine's name, first paint [s], ghosts, times of drag events [ms] (median, 99 %), frames a second."""
    with tempfile.TemporaryDirectory() as folder:
        page = export_page(chainbuild.Robot.load(name), Path(folder) / "page.html")
        with opened(browser, page, size=SIZE) as live:
            live.until("window.chainbuild.frames > 1")
            paint = live.until("performance.getEntriesByName('first-contentful-paint')[0]?.startTime")
            dragged = live.tab.evaluate(_DRAGS, list(_AXES))
            frames = live.tab.evaluate(_FRAMES, list(_AXES))
    times = sorted(dragged["times"])
    drags = statistics.median(times), times[-3]
    return name, f"{paint / 1000.0:.2f}", dragged["ghosts"], *(f"{time:.2f}" for time in drags), f"{frames:.0f}"


def main() -> None:
    """Measure and write the table."""
    with sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=chromium(), args=FLAGS)
        rows = [measured(browser, name) for name in MACHINES]
        browser.close()
    head = ("machine", "first paint [s]", "ghosts", "drag, median [ms]", "drag, 99 % [ms]", "frames/s")
    text = f"# The page\n\n{SIZE[0]} × {SIZE[1]}, drawn in software. Marks: {MARKS}.\n\n{markdown(head, rows)}\n"
    Path(__file__).with_suffix(".md").write_text(text, "utf-8")
    print(text)


if __name__ == "__main__":
    main()
