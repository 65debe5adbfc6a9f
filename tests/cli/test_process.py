"""What surrounds a command: closed streams, signals, errors as JSON, tables with failed rows."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

from chainbuild.cli.process import signals
from chainbuild.robot import Robot
from tests.kit.command_line import ARM, AXES, PROGRAM, Run

pytestmark = pytest.mark.usefixtures("heeds_interrupts")


def closed(*words: str, redirect: str) -> subprocess.CompletedProcess[str]:
    """Run the command with streams closed before it begins."""
    line = 'exec "$@" ' + redirect
    return subprocess.run(["sh", "-c", line, "sh", *PROGRAM, *words], capture_output=True, text=True, check=False)


@pytest.mark.parametrize("words", [("types",), ("info", str(ARM)), ("--help",), ("info", str(ARM), "--json")])
def test_a_closed_stdout_is_one_message(words: tuple[str, ...]) -> None:
    done = closed(*words, redirect=">&-")
    assert (done.returncode, done.stderr) == (1, "chainbuild: the output cannot be written: Bad file descriptor\n")


def test_a_closed_stdout_does_not_matter_where_nothing_is_printed(tmp_path: Path) -> None:
    axes, poses = tmp_path / "axes.csv", tmp_path / "poses.csv"
    axes.write_text(AXES + "0,-90,90,0,0,0\n", "utf-8")
    done = closed("fk", str(ARM), "--axes", str(axes), "-o", str(poses), redirect=">&-")
    assert done.returncode == 0, done.stderr
    assert len(poses.read_text("utf-8").splitlines()) == 2


def test_a_closed_stderr_keeps_messages_out_of_stdout() -> None:
    done = closed("info", "missing.lis", redirect="2>&-")
    assert (done.returncode, done.stdout) == (1, "")
    assert closed("info", str(ARM), redirect=">&- 2>&-").returncode == 1


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_run_that_is_ended_leaves_no_file(number: signal.Signals, tmp_path: Path) -> None:
    axes = tmp_path / "axes.csv"
    axes.write_text(AXES + "0,-90,90,0,0,0\n" * 200_000, "utf-8")
    command = [*PROGRAM, "fk", str(ARM), "--axes", str(axes), "-o", str(tmp_path / "poses.csv")]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 60.0
    while not list(tmp_path.glob(".poses.csv.*")):
        assert process.poll() is None
        assert time.monotonic() < deadline
        time.sleep(0.01)
    process.send_signal(number)
    _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (-number, "chainbuild: terminated\n")
    assert [path.name for path in tmp_path.iterdir()] == ["axes.csv"]


def test_signal_handlers_are_put_back(run: Run) -> None:
    numbers = (signal.SIGTERM, signal.SIGHUP, signal.SIGINT)
    before = [signal.getsignal(number) for number in numbers]
    run("types")
    assert [signal.getsignal(number) for number in numbers] == before


def test_an_interrupt_that_was_swallowed_comes_again(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def swallow(robot: Robot, axes: object) -> object:
        with suppress(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        return forward(robot, axes)

    forward = Robot.fk
    monkeypatch.setattr(Robot, "fk", swallow)
    Path("axes.csv").write_text(AXES + "0,-90,90,0,0,0\n" * 3, "utf-8")
    outcome = run("fk", ARM, "--axes", "axes.csv", "-o", "poses.csv")
    assert (outcome.code, outcome.err.splitlines()[-1]) == (130, "chainbuild: interrupted")
    assert not Path("poses.csv").exists()


@pytest.mark.parametrize("command", ["info", "check"])
def test_a_file_that_cannot_be_read_is_json_too(run: Run, command: str) -> None:
    outcome = run(command, "missing.lis", "--json")
    data = json.loads(outcome.out)
    assert (outcome.code, data["refused"], data["file"]) == (1, True, "missing.lis")
    assert data["error"]["text"].startswith("no such file")
    assert outcome.err.startswith("missing.lis: no such file")


def test_a_refused_file_is_json_with_its_line(run: Run) -> None:
    Path("bad.lis").write_text("trafo[0].id 45\ntrafo[0].param[6] 1,5\nEnde\n", "utf-8")
    outcome = run("info", "bad.lis", "--json")
    error = json.loads(outcome.out)["error"]
    assert (outcome.code, error["line"], error["code"], error["severity"]) == (1, 2, "CB202", "error")
    outcome = run("check", "bad.lis", "--json")
    data = json.loads(outcome.out)
    assert (outcome.code, data["refused"], data["findings"][0]["line"]) == (1, True, 2)


def test_a_refused_kinematic_is_json_with_what_was_read(run: Run) -> None:
    Path("tubes.lis").write_text("trafo[0].id 15\nEnde\n", "utf-8")
    outcome = run("info", "tubes.lis", "--json")
    data = json.loads(outcome.out)
    assert (outcome.code, data["refused"], data["kinematics"][0]["id"]) == (1, True, 15)
    assert "tube processing" in data["error"]["text"]
    accepted = json.loads(run("info", ARM, "--json").out)
    assert (accepted["refused"], accepted["error"]) == (False, None)


@pytest.mark.parametrize(("content", "says"), [("", "the file is empty"), ("trafo[0].id 45\n\0", "NUL")])
def test_check_lists_faulty_content_and_ends_with_1(run: Run, content: str, says: str) -> None:
    Path("bad.lis").write_text(content, "utf-8")
    outcome = run("check", "bad.lis")
    assert (outcome.code, outcome.err) == (1, "")
    assert says in outcome.out
    assert outcome.out.splitlines()[-1] == "bad.lis: refused (1 error)"


@pytest.mark.parametrize("options", [("fk", "--axes"), ("ik", "--start")])
def test_rows_that_failed_in_inverse_kinematics_are_called_so(run: Run, options: tuple[str, str]) -> None:
    head = f"{AXES.strip()},status,position_error_mm,rotation_error_deg\n"
    Path("axes.csv").write_text(head + "0,-90,90,0,0,0,ok,0.0,0.0\n,,,,,,limits,3.0,1.0\n", "utf-8")
    Path("poses.csv").write_text("x_mm,y_mm,z_mm,qx,qy,qz,qw\n500,0,500,0,0,0,1\n" * 1 + "500,0,500,0,0,0,1\n", "utf-8")
    command, option = options
    more = ["--poses", "poses.csv"] if command == "ik" else []
    outcome = run(command, ARM, option, "axes.csv", *more)
    assert outcome.code == 1
    assert "axes.csv:3: the row has no axis values: inverse kinematics failed there (limits)" in outcome.err


def test_a_missing_value_in_a_good_row_is_still_called_so(run: Run) -> None:
    Path("axes.csv").write_text(f"{AXES.strip()},status\n0,,90,0,0,0,limits\n", "utf-8")
    outcome = run("fk", ARM, "--axes", "axes.csv")
    assert (outcome.code, "column B1: no value" in outcome.err) == (1, True)


@pytest.mark.parametrize(("words", "code"), [(("types",), 0), (("info", "missing.lis"), 1), (("--nothing",), 2)])
def test_the_module_ends_with_the_code_of_the_command(words: tuple[str, ...], code: int) -> None:
    command = [sys.executable, "-m", "chainbuild", *words]
    assert subprocess.run(command, capture_output=True, check=False).returncode == code


def test_an_interrupt_in_what_c_calls_waits_until_it_is_over() -> None:
    file = "/site-packages/llvmlite/binding/executionengine.py"
    code = compile("signal.raise_signal(signal.SIGINT)\ntime.sleep(0.1)\nreached.append(1)", file, "exec")
    reached: list[int] = []
    with signals():
        exec(code, {"signal": signal, "time": time, "reached": reached})
        assert reached == [1]
        with pytest.raises(KeyboardInterrupt):
            time.sleep(10)
