"""Where the command starts and ends: help, usage errors, exit codes, signals, import cost."""

from __future__ import annotations

import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import chainbuild
from chainbuild.cli import entry
from chainbuild.cli.entry import message_of
from chainbuild.errors import ChainbuildError, Span
from tests.kit.command_line import ARM, AXES, PROGRAM, Run

pytestmark = pytest.mark.usefixtures("heeds_interrupts")

COMMANDS = ["info", "check", "fk", "ik", "urdf", "export", "inspect", "picture", "demo", "types", "singularity", "warm"]


def test_version(run: Run) -> None:
    assert run("--version").out.strip() == chainbuild.__version__


def test_help_lists_every_command_with_a_sentence(run: Run) -> None:
    for words in (("--help",), ()):
        outcome = run(*words)
        assert outcome.code == 0
        for command in COMMANDS:
            assert re.search(rf"│ {command} +\S+ \S+", outcome.out), command


@pytest.mark.parametrize("command", COMMANDS)
def test_every_option_is_explained(run: Run, command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    outcome = run(command, "--help")
    assert outcome.code == 0
    options = re.findall(r"│ \*? *(--[a-z-]+|FILE)((?: -\w| STR| INT| FLOAT| PATH)*)(.*)│", outcome.out)
    assert options
    for name, _, text in options:
        explained = re.sub(r"\[(default|required).*?\]", "", text).strip()
        assert len(explained) > 8, f"{command} {name} is not explained"
        assert "--no-" not in text


def test_every_help_has_an_example_that_parses() -> None:
    app = entry.build_app()
    for name in ("", *(name for name in app if not name.startswith("-"))):
        text = " ".join((app[name] if name else app).help.split())
        examples = re.findall(r"Example: `chainbuild ([^`]*)`", text)
        assert examples
        for example in examples:
            assert example.startswith(name)
            app.parse_args(shlex.split(example), print_error=False, exit_on_error=False)


def test_common_options_are_everywhere(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    for command in set(COMMANDS) - {"types", "warm"}:
        out = run(command, "--help").out
        for option in ("--kinematic", "--channel", "--tool-length", "--convention", "--overlay"):
            assert option in out, f"{command} {option}"
    for command in ("info", "check", "types", "urdf"):
        assert "--json" in run(command, "--help").out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["nope"], 'Unknown command "nope"'),
        (["info"], "FILE requires an argument"),
        (["info", "x", "y"], "unexpected argument y"),
        (
            ["singularity", "x", "--at", "0", "-90", "9"],
            "unexpected argument -90 9; write several values as one word with commas",
        ),
        (
            ["fk", "x", "--at", "0,", "90,", "9"],
            "unexpected argument 90, 9; write several values as one word with commas",
        ),
        (["info", "x", "--nope"], "--nope"),
        (["fk", "x"], "--axes"),
        (["ik", "x"], "--poses"),
        (
            ["inspect", "x", "--export", "p.html", "--port", "0"],
            "--export excludes --port: an exported page has no server",
        ),
        (["picture", "x"], "--output"),
        (["picture", "x", "-o", "m.svg", "--view", "back"], "--view"),
        (["picture", "kr6r900_2", "-o", "m.svg", "--at", "0,a"], "--at 0,a: expected numbers separated by commas"),
        (["info", "x", "--channel", "one"], "--channel"),
        (["info", "x", "--tool-length", "long"], "--tool-length"),
        (["info", "x", "--convention", "name"], "--convention name: expected NAME=CHOICE"),
        (["check", "x", "--convention", "=choice"], "--convention =choice: expected NAME=CHOICE"),
    ],
)
def test_wrong_usage_ends_with_2(run: Run, words: list[str], message: str) -> None:
    outcome = run(*words)
    assert (outcome.code, outcome.out) == (2, "")
    first, second = outcome.err.splitlines()
    assert first.startswith("chainbuild: ")
    assert message in first
    command = f"{words[0]} " if words[0] in COMMANDS else ""
    assert second == f"chainbuild {command}--help shows the usage"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["info", "missing"], "missing: no such file, and no shipped machine of that name"),
        (["info", "missing.lis"], "missing.lis: no such file\n"),
        (["info", "no/kr6.lis"], "no/kr6.lis: no such file: the folder does not exist\n"),
        (["info", "kr6r900.tea"], "kr6r900.tea: no such file; the shipped machine is called kr6r900\n"),
        (["info", "."], ".: this is a folder"),
        (["info", ARM, "--kinematic", "7"], f"{ARM}: the file configures no kinematic '7'"),
        (["info", ARM, "--channel", "3"], f"{ARM}: the file has no channel 3"),
        (["info", ARM, "--tool-length", "nan"], "chainbuild: the tool length nan"),
        (["info", ARM, "--convention", "no=x"], "chainbuild: unknown convention 'no'"),
        (["info", ARM, "--overlay", "missing.toml"], "missing.toml: no such file"),
        (["fk", ARM, "--axes", "missing.csv"], "missing.csv: the table cannot be read: No such file"),
        (["fk", "kr6r900_2", "--at", "0,-90,90"], "chainbuild: expected 6 axis values, got 3"),
        (["check", "missing.lis"], "missing.lis: no such file"),
        (["inspect", ARM, "--export", "no/page.html"], "no/page.html: "),
        (["picture", ARM, "-o", "no/m.svg"], "no/m.svg: the file cannot be written"),
        (["picture", ARM, "-o", "m.jpg"], "chainbuild: m.jpg: the suffix .jpg says no kind of picture"),
        (["picture", "kr6r900_2", "-o", "m.svg", "--at", "0,-90,nan,0,0,0"], "chainbuild: axis B2 has the value nan"),
        (["urdf", ARM, "-o", "/dev/null"], "/dev/null: the folder cannot be created: this is a file"),
    ],
)
def test_refused_input_ends_with_1(run: Run, words: list[str], message: str) -> None:
    outcome = run(*words)
    assert (outcome.code, outcome.out) == (1, "")
    assert outcome.err.startswith(message)
    assert len(outcome.err.splitlines()) == 1


@pytest.mark.parametrize(("given", "meant"), [("cel.lis", "cell.lis"), ("cell.tea", "cell.lis"), ("bell.csv", None)])
def test_a_mistyped_path_is_answered_by_the_files_beside_it(run: Run, given: str, meant: str | None) -> None:
    for name in ("cell.lis", "other.lis"):
        Path(name).write_text("", "utf-8")
    more = f"; did you mean {meant}?" if meant else ""
    assert run("info", given).err == f"{given}: no such file{more}\n"


def test_a_missing_table_is_answered_by_its_columns(run: Run) -> None:
    outcome = run("fk", "kr6r900_2", "--axes", "missing.csv")
    assert outcome.err.endswith("permitted: a table whose first line is C1,B1,B2,A1,B3,A2\n")


def test_the_message_marks_the_spot(run: Run) -> None:
    Path("bad.lis").write_text("trafo[0].id 45\ntrafo[0].param[6] 1,5\nEnde\n", "utf-8")
    outcome = run("info", "bad.lis")
    assert outcome.code == 1
    head, line, mark = outcome.err.splitlines()
    assert head.startswith("bad.lis:2: ")
    assert line.strip() == "trafo[0].param[6] 1,5"
    assert mark.strip() == "^"


def test_messages_without_a_place_name_the_program() -> None:
    assert message_of(ChainbuildError("no")) == "chainbuild: no"
    assert message_of(ChainbuildError("no", span=Span("f", 3, 2, "ab"))) == "f:3: no\n    ab\n     ^"


def test_interrupt_ends_with_130(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*words: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(entry, "build_app", lambda *_: interrupted)
    outcome = run("types")
    assert (outcome.code, outcome.err) == (130, "chainbuild: interrupted\n")


def table_of(path: Path, rows: int) -> Path:
    path.write_text(AXES + "".join(f"{n % 170},-90,90,{n % 90},10,0\n" for n in range(rows)), "utf-8")
    return path


def test_an_interrupted_run_leaves_no_file(tmp_path: Path) -> None:
    axes = table_of(tmp_path / "axes.csv", 100_000)
    command = [*PROGRAM, "fk", str(ARM), "--axes", str(axes), "-o", str(tmp_path / "poses.csv")]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 60.0
    while not list(tmp_path.glob(".poses.csv.*")):
        assert process.poll() is None
        assert time.monotonic() < deadline
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (130, "chainbuild: interrupted\n")
    assert [path.name for path in tmp_path.iterdir()] == ["axes.csv"]


def test_a_reader_that_goes_away_is_no_error(tmp_path: Path) -> None:
    axes = table_of(tmp_path / "axes.csv", 20_000)
    command = [*PROGRAM, "fk", str(ARM), "--axes", str(axes)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline().startswith("x_mm")
    process.stdout.close()
    assert process.stderr is not None
    assert process.stderr.read() == ""
    assert process.wait(timeout=60) == 141
    process.stderr.close()


def test_tables_may_come_from_and_go_to_pipes(tmp_path: Path) -> None:
    axes = table_of(tmp_path / "axes.csv", 3)
    command = [*PROGRAM, "fk", str(ARM), "--axes", "/dev/stdin", "-o", "/dev/stdout"]
    done = subprocess.run(command, input=axes.read_text("utf-8"), capture_output=True, text=True, check=True)
    assert len(done.stdout.splitlines()) == 4


def test_a_full_disk_is_one_message() -> None:
    with Path("/dev/full").open("w", encoding="utf-8") as full:
        done = subprocess.run([*PROGRAM, "types"], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr == "chainbuild: the output cannot be written: No space left on device\n"


@pytest.mark.parametrize("words", ["['--help']", "['info', '--help']", "['nope']", f"['info', {str(ARM)!r}]"])
def test_help_and_info_do_not_load_pinocchio(words: str) -> None:
    code = (
        "import sys; from chainbuild.cli import main; "
        f"main({words}); "
        "print('HEAVY', sorted({m.split('.')[0] for m in sys.modules} & {'pinocchio', 'coal', 'meshcat'}))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "HEAVY []"


def test_progress_is_shown_on_a_terminal_only(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    axes = table_of(tmp_path / "axes.csv", 3000)
    assert run("fk", ARM, "--axes", axes, "-o", "poses.csv").err == ""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr("chainbuild.progress._UNSEEN_S", 0.0)
    outcome = run("fk", ARM, "--axes", axes, "-o", "poses.csv")
    assert (outcome.code, outcome.out) == (0, "")
    assert "poses" in outcome.err


def test_output_is_plain_under_any_locale() -> None:
    environment = {**os.environ, "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    for words in (["info", "tx2_60"], ["types"], ["info", "tx2_60", "--json"], ["--help"]):
        done = subprocess.run([*PROGRAM, *words], capture_output=True, env=environment, check=False)
        assert done.returncode == 0, done.stderr.decode()
    json.loads(subprocess.run([*PROGRAM, "types", "--json"], capture_output=True, env=environment, check=True).stdout)
