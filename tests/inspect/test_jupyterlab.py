"""The page in a cell of a real JupyterLab: its server, its kernel, its front end."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import nbformat
import pytest
from playwright.sync_api import Browser, Frame, Page

from tests.kit.paths import ROOT

pytestmark = pytest.mark.slow

CELLS = (
    "import chainbuild\nview = chainbuild.show(chainbuild.Robot.load('kr6r900'))\nview",
    "print('AXES', view.axes.tolist())",
    "view.axes = [10, -70, 60, 5, 30, 12.3456789]",
    "view",
    "for k in range(101):\n    view.axes = [k / 2, -70, 60, 5, 30, 0]",
)
POSE = "[0.5,0.5,0.7071,0.5, 0.5,0.5,-0.7071,0.1, -0.70710678,0.70710678,0,0.7, 0,0,0,1]"


@pytest.fixture
def notebook(browser: Browser, tmp_path: Path) -> Iterator[Page]:
    """Return JupyterLab with a notebook of CELLS, its kernel idle and its first cell chosen."""
    cells = [nbformat.v4.new_code_cell(source) for source in CELLS]
    kernel = {"kernelspec": {"name": "python3", "display_name": "Python 3"}}
    nbformat.write(nbformat.v4.new_notebook(cells=cells, metadata=kernel), tmp_path / "one.ipynb")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    folders = {f"JUPYTER_{name}_DIR": str(tmp_path / name) for name in ("CONFIG", "DATA", "RUNTIME")}
    paths = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    command = [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", "--ip=127.0.0.1", f"--port={port}"]
    with (tmp_path / "log").open("w") as log:
        server = subprocess.Popen(
            [*command, f"--notebook-dir={tmp_path}", "--IdentityProvider.token=test"],
            env={**os.environ, **folders, "PYTHONPATH": paths},
            stdout=log,
            stderr=log,
        )
        tab = browser.new_page(viewport={"width": 1280, "height": 900})
        try:
            until(tab, lambda: "Use Control-C" in (tmp_path / "log").read_text("utf-8"))
            tab.goto(f"http://127.0.0.1:{port}/lab/tree/one.ipynb?token=test&reset")
            tab.wait_for_selector(".jp-Notebook-ExecutionIndicator[data-status=idle]", timeout=120_000)
            tab.locator(".jp-CodeCell .cm-content").first.click()
            yield tab
        finally:
            tab.close()
            server.terminate()
            server.wait(60)


def until(tab: Page, holds: Callable[[], object]) -> None:
    """Wait until something holds."""
    for _ in range(3000):
        if holds():
            return
        tab.wait_for_timeout(20)
    raise AssertionError("never")


def run(tab: Page) -> None:
    """Run the chosen cell; the next one is chosen."""
    tab.keyboard.press("Shift+Enter")


def pages(tab: Page) -> list[Frame]:
    """Return the pages in the cells that are usable."""
    return [frame for frame in tab.frames if "srcdoc" in frame.url and frame.evaluate("!!window.chainbuild")]


def axes(page: Frame) -> list[float]:
    return list(page.evaluate("window.chainbuild.axes()"))


def test_page_and_kernel_keep_the_same_axis_values(notebook: Page) -> None:
    told: list[str] = []
    notebook.on("console", lambda message: told.append(message.text) if message.type == "error" else None)
    run(notebook)
    until(notebook, lambda: pages(notebook))
    (page,) = pages(notebook)
    assert axes(page) == [0, -90, 90, 0, 90, 0]
    page.evaluate(f"window.chainbuild.drag({POSE})")
    notebook.wait_for_timeout(500)  # until the kernel has it
    run(notebook)
    printed = notebook.locator(".jp-OutputArea-output", has_text="AXES")
    printed.wait_for()
    assert [float(one) for one in printed.inner_text().strip()[6:-1].split(",")] == axes(page)
    run(notebook)
    until(notebook, lambda: axes(page) == [10, -70, 60, 5, 30, 12.3456789])
    run(notebook)
    until(notebook, lambda: len(pages(notebook)) == 2)
    until(notebook, lambda: all(axes(one) == [10, -70, 60, 5, 30, 12.3456789] for one in pages(notebook)))
    run(notebook)
    until(notebook, lambda: all(axes(one) == [50, -70, 60, 5, 30, 0] for one in pages(notebook)))
    assert told == []
