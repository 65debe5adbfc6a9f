"""The command line: one file per command, entry point `chainbuild.cli:main`."""

from __future__ import annotations

from chainbuild.cli.entry import main

__all__ = ["main"]
