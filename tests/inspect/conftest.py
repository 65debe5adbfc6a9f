"""One browser for all tests of the page."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack

import pytest
from playwright.sync_api import Browser, sync_playwright

from tests.kit.browser import chromium
from tests.kit.live_page import FLAGS, LivePage, Lives


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    """Return a headless Chromium, started once.

    It ends with this folder's tests: as long as it is driven no other event loop can run, which notebooks need.
    """
    with sync_playwright() as driver:
        started = driver.chromium.launch(executable_path=chromium(), args=FLAGS)
        yield started
        started.close()


@pytest.fixture(scope="module")
def lives(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lives]:
    """Return open pages by machine; each is opened once for a file of tests."""
    with ExitStack() as stack:
        yield Lives(browser, tmp_path_factory.mktemp("pages"), stack)


@pytest.fixture
def kuka(lives: Lives) -> LivePage:
    """Return the open page of an arm."""
    return lives["kr6r900"]
