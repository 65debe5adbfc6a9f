"""A notebook in a browser without Jupyter: cells that show a widget, and what Jupyter brings to Python and back."""

from __future__ import annotations

import base64
import gzip
import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from playwright.sync_api import Frame, Page

from tests.kit.live_page import LivePage

# A notebook in which cells show one widget: the first the page, others what a page says and hears, without a machine.
# The model does what that of Jupyter does, and counts what is saved.
NOTEBOOK = """<!DOCTYPE html><meta charset="utf-8"><body style="margin:0" data-jp-theme-light="THEME">
<div id="cell0"></div><div id="cell1"></div><div id="cell2"></div><div style="height:3000px"></div>
<script type="module">
import widget from "ESM";
const bytes = (text) => new DataView(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
const [state, pages] = [STATE, PAGES.map(bytes)];
const listeners = new Set();
window.saved = 0;
window.model = {
  get: (name) => (name === "_page" ? (pages.length > 1 ? pages.shift() : pages[0]) : state[name]),
  set: (name, value) => { state[name] = value; [...listeners].forEach((listener) => listener()); },
  save_changes: () => { window.saved += 1; },
  on: (name, listener) => { if (name === "change:axes") listeners.add(listener); },
  off: (name, listener) => listeners.delete(listener),
};
window.shown = (id) => widget.render({ model: window.model, el: document.getElementById(id) });
for (const cell of ["cell0", "cell1"].slice(0, pages.length)) await window.shown(cell);
</script>"""
OTHER = """<script>
let axes = [];
const say = (message) => parent.postMessage(message, "*");
window.chainbuild = { axes: () => axes, say: (axes) => say({ chainbuild: "axes", axes }) };
window.onmessage = (event) => { axes = event.data.axes; };
say({ chainbuild: "ready" });
</script>"""


class Notebook:
    """A notebook in a browser, and the widget in Python that it shows.

    Attributes:
        view: The widget.
        tab: The notebook.
    """

    def __init__(self, view: Any, tab: Page, folder: Path, *others: str, page: str = "", theme: str = "") -> None:
        self.view, self.tab = view, tab
        packed = [
            gzip.compress(page.encode()) if page else self.view._page,
            *(gzip.compress(o.encode()) for o in others),
        ]
        words = {
            "ESM": "data:text/javascript;base64," + base64.b64encode(self.view._esm.encode()).decode(),
            "STATE": json.dumps(self.view.get_state(["axes", "_title", "_height"])),
            "PAGES": json.dumps([base64.b64encode(one).decode() for one in packed]),
            "THEME": theme,
        }
        path = folder / "notebook.html"
        path.write_text(re.sub("|".join(words), lambda found: words[found[0]], NOTEBOOK), "utf-8")
        self.live = LivePage(tab)
        tab.goto(path.as_uri())

    def cell(self, n: int) -> Frame:
        """Return the page of a cell, usable."""
        element = self.tab.wait_for_selector(f"#cell{n} iframe")
        frame = element and element.content_frame()
        assert frame is not None
        self.until(lambda: frame.evaluate("!!window.chainbuild"))
        return frame

    def until(self, holds: Callable[[], object]) -> None:
        """Wait until something holds."""
        for _ in range(1500):
            if holds():
                return
            self.tab.wait_for_timeout(10)
        raise AssertionError(f"never; {self.live.told}")

    def axes(self, n: int) -> list[float]:
        """Return the axis values of the page in a cell."""
        return list(self.cell(n).evaluate("window.chainbuild.axes()"))

    @property
    def kept(self) -> list[float]:
        """The axis values of the browser's model."""
        return list(self.tab.evaluate("window.model.get('axes')"))

    @property
    def saved(self) -> int:
        return int(self.tab.evaluate("window.saved"))

    def hear(self) -> list[float]:
        """Bring the axis values of the browser to Python, as the kernel does; return what Python has."""
        self.view.set_state({"axes": self.kept})
        return list(self.view.axes)

    def say(self, axes: Any) -> None:
        """Set the axis values in Python, and bring them to the browser."""
        self.view.axes = axes
        self.tab.evaluate("(axes) => window.model.set('axes', axes)", self.view.get_state(["axes"])["axes"])

    def settle(self) -> None:
        """Let every message arrive."""
        self.tab.wait_for_timeout(60)
