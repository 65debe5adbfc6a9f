"""An exported page in a browser, as its user has it: fields, sliders, keys, mouse, picture."""

from __future__ import annotations

import io
import json
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Browser, Error, Locator, Page

from chainbuild.inspect.export import export_page
from chainbuild.robot import Robot

FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]  # no GPU here
_PATIENCE = 60.0  # seconds until a page that does nothing fails its test


class LivePage:
    """A page that is open.

    Attributes:
        tab: Playwright's page.
        told: What went wrong in it: errors on the console, exceptions, requests to anywhere.
    """

    def __init__(self, tab: Page, own: str = "file:") -> None:
        self.tab = tab
        self.told: list[str] = []
        tab.on("console", lambda m: self.told.append(m.text) if m.type == "error" else None)
        tab.on("pageerror", lambda error: self.told.append(str(error)))
        tab.on("request", lambda r: None if r.url.startswith((own, "data:", "blob:")) else self.told.append(r.url))

    def until(self, expression: str) -> Any:
        """Return the value of a JavaScript expression once it is true.

        Raises:
            AssertionError: it never was.
        """
        end = time.monotonic() + _PATIENCE
        while True:
            try:
                if value := self.tab.evaluate(expression):
                    return value
            except Error as error:
                if "context was destroyed" not in str(error):  # by loading the page anew
                    raise
            assert time.monotonic() < end, f"never: {expression}; {self.told}"
            self.tab.wait_for_timeout(20)

    def call(self, name: str, *arguments: Any) -> Any:
        """Return what a function of `window.chainbuild` returns."""
        words = ", ".join(
            json.dumps(np.asarray(one).tolist() if not isinstance(one, str) else one) for one in arguments
        )
        return self.tab.evaluate(f"window.chainbuild.{name}({words})")

    @property
    def axes(self) -> NDArray[np.float64]:
        """The axis values, mm and degrees."""
        return np.array(self.call("axes"))

    def drawn(self, links: Sequence[str]) -> NDArray[np.float64]:
        """Return the placements (n, 4, 4) [m] at which links are drawn."""
        script = f"{json.dumps(list(links))}.map((name) => window.chainbuild.drawn(name))"
        return np.array(self.tab.evaluate(script)).reshape(-1, 4, 4)

    def set_input(self, selector: str, value: float) -> None:
        """Write a value into a field or slider, as typing or dragging does."""
        self.tab.evaluate(
            "([selector, value]) => { const field = document.querySelector(selector); field.value = value;"
            " field.dispatchEvent(new Event('input', { bubbles: true })); }",
            [selector, repr(float(value))],
        )

    def one(self, selector: str) -> Locator:
        """Return the element of a selector."""
        return self.tab.locator(selector)

    def status(self) -> str:
        """Return the status word."""
        return self.one("[data-status]").get_attribute("data-status") or ""

    def shown(self) -> dict[str, float]:
        """Return the displayed pose by column, in full."""
        fields = "[...document.querySelectorAll('[data-pose]')]"
        script = f"Object.fromEntries({fields}.map((f) => [f.dataset.pose, +f.dataset.value]))"
        found: dict[str, float] = self.tab.evaluate(script)
        return found

    def picture(self) -> NDArray[np.uint8]:
        """Return a picture (height, width, 3) of the window."""
        with Image.open(io.BytesIO(self.tab.screenshot())) as image:
            return np.asarray(image.convert("RGB"))

    def overflow(self) -> int:
        """Return by how many pixels the page is wider than its window."""
        width: int = self.tab.evaluate("document.documentElement.scrollWidth - window.innerWidth")
        return width


@contextmanager
def opened(
    browser: Browser, page: Path, fragment: str = "", size: tuple[int, int] = (1280, 720), scheme: str = "light"
) -> Iterator[LivePage]:
    """Give a page in a window of its own; an error on its console or a request to anywhere fails the test."""
    with opened_at(browser, page.as_uri() + fragment, "file:", size, scheme) as live:
        yield live


@contextmanager
def opened_at(
    browser: Browser, address: str, own: str, size: tuple[int, int] = (1280, 720), scheme: str = "light"
) -> Iterator[LivePage]:
    """Give the page at an address, as `opened` does; it may ask for what begins with `own`."""
    width, height = size
    tab = browser.new_page(viewport={"width": width, "height": height}, color_scheme=scheme)  # type: ignore[arg-type]
    try:
        live = LivePage(tab, own)
        tab.set_default_timeout(1000 * _PATIENCE)
        tab.goto(address, wait_until="commit")
        live.until("!!window.chainbuild")
        yield live
        assert live.told == []
    finally:
        tab.close()


class Lives(dict[str, LivePage]):
    """Open pages by machine; each is written and opened once."""

    def __init__(self, browser: Browser, folder: Path, stack: ExitStack) -> None:
        super().__init__()
        self.browser, self.folder, self.stack = browser, folder, stack

    def page(self, name: str) -> Path:
        """Return the page file of a shipped machine, written anew."""
        return export_page(Robot.load(name), self.folder / f"{name}.html")

    def __missing__(self, name: str) -> LivePage:
        self[name] = self.stack.enter_context(opened(self.browser, self.page(name)))
        return self[name]
