"""A headless Chromium for the tests, and the document of a page."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path

import pytest

_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
_FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-dev-shm-usage",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-default-apps",
    "--disable-extensions",
    "--hide-scrollbars",
    "--virtual-time-budget=3000",
    "--enable-logging=stderr",
]


def chromium() -> str:
    """Return the path of a Chromium."""
    for name in _NAMES:
        if path := shutil.which(name):
            return path
    pytest.fail(
        f"no Chromium found (looked for {', '.join(_NAMES)}); `make chromium` or `apt-get install chromium` gets one"
    )


def run(page: Path, *arguments: str, fragment: str = "") -> subprocess.CompletedProcess[str]:
    """Open a page in a fresh profile; the console goes to stderr."""
    with tempfile.TemporaryDirectory(prefix="chainbuild-chromium-") as profile:
        command = [chromium(), *_FLAGS, f"--user-data-dir={profile}", *arguments, page.as_uri() + fragment]
        done = subprocess.run(command, capture_output=True, text=True, timeout=180, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return done


def document(page: Path, fragment: str) -> str:
    """Return the page's document after its scripts have run."""
    return run(page, "--dump-dom", fragment=fragment).stdout
