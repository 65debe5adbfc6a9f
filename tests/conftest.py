"""The command line run in this process, with its exit code and both streams; chains that several tests compose."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

import chainbuild
from chainbuild.chain.elements import Chain
from chainbuild.cli import main
from tests.kit.command_line import Outcome, Run
from tests.kit.json_documents import documents
from tests.kit.platforms import stand_in, without

# Tests that run side by side are told the width of a terminal; the output of a command is as wide as without one.
os.environ.pop("COLUMNS", None)
stand_in(without())  # on a Python for which a library has no wheels


@pytest.fixture(scope="session")
def arm() -> Chain:
    """Return the chain of a six-axis arm."""
    return chainbuild.load("kr6r900").chain()


@pytest.fixture(scope="session")
def scara() -> Chain:
    """Return the chain of a four-axis arm."""
    return chainbuild.load("scara_kin36").chain()


@pytest.fixture(scope="session")
def compiled_solver() -> None:
    """Have the solver compiled: the first command would say on stderr that it takes long."""
    robot = chainbuild.Robot.load("gantry_ss")
    assert robot.ik(robot.fk([0.0] * len(robot.axes))).success


@pytest.fixture
def heeds_interrupts() -> Iterator[None]:
    """Let an interrupt through where the tests were started in the background, which would have it ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    hang_up = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGINT, before)
    signal.signal(signal.SIGHUP, hang_up)


@pytest.fixture
def run(
    compiled_solver: None,
    heeds_interrupts: None,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> Run:
    """Return a function that runs the command in an empty folder."""
    monkeypatch.chdir(tmp_path)

    def call(*words: str | Path) -> Outcome:
        code = main([str(word) for word in words])
        captured = capsys.readouterr()
        assert "Traceback" not in captured.err
        if "--json" in words and captured.out:
            documents(captured.out)
        return Outcome(code, captured.out, captured.err)

    return call
