"""The command line as the tests run it, and the tables that go in and come out."""

from __future__ import annotations

import csv
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from tests.kit.paths import REFERENCE

ARM = REFERENCE / "kin45_kr6r900_2.lis"
AXES = "C1,B1,B2,A1,B3,A2\n"
PROGRAM = [sys.executable, "-m", "chainbuild.cli"]


@dataclass(frozen=True)
class Outcome:
    """The exit code of a command and what it wrote to both streams."""

    code: int
    out: str
    err: str


Run = Callable[..., Outcome]


def rows_of(text: str) -> list[dict[str, str]]:
    """Return the rows of a table, by column."""
    return list(csv.DictReader(text.splitlines()))


def write(name: str, text: str) -> Path:
    """Write a file into the folder in which the command runs."""
    path = Path(name)
    path.write_text(text, "utf-8")
    return path
