"""The page's JavaScript modules in a blank page of a browser, and what they compute."""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping
from typing import Any

from playwright.sync_api import Browser, Page

from tests.kit.paths import PACKAGE


def page_modules() -> dict[str, str]:
    """Return the source of each module of the page by its name: `cb/` and the stem of its file."""
    files = sorted((PACKAGE / "inspect" / "static").rglob("*/*.js"))
    found = {f"cb/{path.stem}": path.read_text("utf-8") for path in files}
    assert len(found) == len(files), "two modules have the same name"
    return found


def module_page(browser: Browser, modules: Mapping[str, str]) -> Page:
    """Return a blank page that can import modules by name.

    Args:
        browser: The browser.
        modules: Name → source.
    """
    page = browser.new_page()
    urls = {
        name: "data:text/javascript;charset=utf-8;base64," + base64.b64encode(source.encode()).decode()
        for name, source in modules.items()
    }
    page.set_content(f'<script type="importmap">{json.dumps({"imports": urls})}</script>')
    return page


def computed(page: Page, script: str, data: Any) -> Any:
    """Return what an asynchronous function of JavaScript returns of data; not a number comes back as None.

    Args:
        page: A page that has the modules.
        script: Source of the function, of one argument.
        data: What JSON can hold.
    """
    # As text: the driver would hand over each number by itself.
    return json.loads(
        page.evaluate(f"async (text) => JSON.stringify(await ({script})(JSON.parse(text)))", json.dumps(data))
    )
