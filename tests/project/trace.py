"""Count the files of the package that a call goes through: `python -m tests.project.trace ik|command MACHINE`.

Real calls only, cold, in a process of its own: what is run at import (class bodies, module code) is not counted.
"""

from __future__ import annotations

import contextlib
import io
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import numpy as np

import chainbuild

PACKAGE = str(Path(chainbuild.__file__).parent) + "/"
CO_OPTIMIZED = 1  # a function's body, not that of a class or a module


def files_of(call: Callable[[], object]) -> set[str]:
    """Return the files whose functions a call enters."""
    seen: set[str] = set()

    def look(frame: FrameType, event: str, _: object) -> None:
        code = frame.f_code
        if event == "call" and code.co_flags & CO_OPTIMIZED and code.co_filename.startswith(PACKAGE):
            seen.add(code.co_filename.removeprefix(PACKAGE))

    sys.setprofile(look)
    try:
        call()
    finally:
        sys.setprofile(None)
    return seen


def of_ik(name: str) -> set[str]:
    """Return the files that one pose through `Robot.ik` enters."""
    robot = chainbuild.Robot.load(name)
    lower, upper = (np.array([getattr(axis, end) for axis in robot.axes]) for end in ("lower", "upper"))
    free = np.array([not axis.held for axis in robot.axes])
    T = robot.fk(np.where(free, lower + 0.4 * (upper - lower), 0.0))
    return files_of(lambda: robot.ik(T))


def of_command(name: str) -> set[str]:
    """Return the files that `chainbuild ik` enters for a table of one pose."""
    from chainbuild.cli import main

    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        poses, axes = f"{folder}/poses.csv", f"{folder}/axes.csv"
        with contextlib.redirect_stderr(io.StringIO()):
            _run(main, ["fk", name, "--at", "10,-30,-60,20,30,10", "-o", poses])
            # What the package's own file does is to import others, not to be on the way of a pose.
            return files_of(lambda: _run(main, ["ik", name, "--poses", poses, "-o", axes])) - {"__init__.py"}


def _run(main: Callable[..., object], words: list[str]) -> None:
    sys.argv = ["chainbuild", *words]
    with contextlib.suppress(SystemExit):
        main()


if __name__ == "__main__":
    kind, machine = sys.argv[1:]
    print("\n".join(sorted(of_ik(machine) if kind == "ik" else of_command(machine))))
