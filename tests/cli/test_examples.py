"""The examples of every help text run as they are printed."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable

import pytest

from chainbuild.cli import entry
from tests.kit.command_line import Run, write

AXES = "A1,A2,A3,A4,A5,A6\n0,-90,90,0,30,0\n0,-80,90,0,20,0\n"
POSES = "x_mm,y_mm,z_mm,qx,qy,qz,qw\n700,0,700,0,0.7071067811865476,0,0.7071067811865476\n"
RECORDING = "A1,A2,A3,A4,A5,A6,x_mm,y_mm,z_mm\n0,-90,90,0,0,0,525,0,890\n"


def examples() -> list[str]:
    app = entry.build_app()
    texts = [app.help, *(app[name].help for name in app if not name.startswith("-"))]
    return [
        example for text in texts for example in re.findall(r"Example: `chainbuild ([^`]*)`", " ".join(text.split()))
    ]


def served(_session: object, ready: Callable[[str, Callable[[], None]], None], **_options: object) -> int:
    """Stand for the server, which would wait for Ctrl-C."""
    ready("http://127.0.0.1:7421/", lambda: None)
    return 0


@pytest.mark.parametrize("example", examples())
def test_an_example_of_the_help_runs(run: Run, example: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("chainbuild.inspect.live.server.serve", served)
    monkeypatch.setattr(
        "chainbuild.ik.warm.warm_up", lambda *, progress: {"one pose": 0.0}
    )  # minutes, if it is not kept
    monkeypatch.setenv("SHELL", "/bin/bash")
    monkeypatch.setenv("HOME", ".")  # what is installed stays in the folder of the test
    for name in ("path.csv", "start.csv"):
        write(name, AXES if name == "path.csv" else "\n".join(AXES.splitlines()[:2]) + "\n")
    for name in ("poses.csv", "line.csv"):
        write(name, POSES)
    if "--recording" in example:
        write("poses.csv", RECORDING)
    words = [
        word if word != "100000" else "1000" for word in shlex.split(example)
    ]  # of samples: as many more take seconds
    assert run(*words).code in ((0, 3) if words[0] in ("collide", "crosscheck") else (0,)), example
