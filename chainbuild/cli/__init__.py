"""The command line: one file a command, entry point `chainbuild.cli:main`."""

from __future__ import annotations

from chainbuild.cli.entry import main

__all__ = ["main"]
