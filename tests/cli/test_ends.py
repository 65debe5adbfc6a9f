"""How a command ends where something else goes on: a closed pipe, an interrupt while libraries load, foreign code."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import chainbuild
from chainbuild.cli import process
from chainbuild.errors import ChainbuildError
from tests.kit.command_line import PROGRAM, Run

pytestmark = pytest.mark.usefixtures("heeds_interrupts")

AT = "0,-90,90,0,30,0"
FOLDED = "0,-90,180,0,110,0"


@pytest.mark.parametrize("words", ["info kr6r900 --defaults", "types", f"singularity kr6r900 --at {AT}"])
def test_a_reader_that_leaves_ends_the_command_quietly(words: str) -> None:
    done = subprocess.run(
        ["bash", "-c", '"$@" | true; exit ${PIPESTATUS[0]}', "bash", *PROGRAM, *words.split()],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 141, done.stderr
    assert "Traceback" not in done.stderr
    assert "rror" not in done.stderr


def test_the_package_runs_with_the_exit_code_of_its_command() -> None:
    done = subprocess.run([sys.executable, "-m", "chainbuild", "info", "no.lis"], capture_output=True, check=False)
    assert done.returncode == 1


INTERRUPTED_IMPORT = """
import signal, sys
from pathlib import Path
Path("slow_module.py").write_text('''
import os, signal, time
try:
    os.kill(os.getpid(), signal.SIGINT)
    for _ in range(20):
        time.sleep(0.005)
    whole = True
except KeyboardInterrupt:
    print("interrupted while it was loaded")
    raise
''')
sys.path.insert(0, ".")
from chainbuild.cli import process
try:
    with process.signals():
        import slow_module
        print("loaded", slow_module.whole)
        import time
        time.sleep(3)
        print("never interrupted")
except KeyboardInterrupt:
    print("interrupted behind it")
"""


def test_an_interrupt_waits_until_a_library_is_loaded(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED_IMPORT],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert done.stdout.splitlines() == ["loaded True", "interrupted behind it"], done.stderr


def test_an_interrupt_while_the_command_line_loads_is_one_line() -> None:
    begun = "import os, signal\nfrom chainbuild import files\nos.kill(os.getpid(), signal.SIGINT)\n"
    planted = "import builtins, sys\nold = builtins.__import__\n"
    planted += "def new(name, *rest):\n"
    planted += "    if name == 'cyclopts' and not hasattr(sys, 'told'):\n        sys.told = 1\n"
    planted += f"        exec({begun!r})\n    return old(name, *rest)\n"
    planted += "builtins.__import__ = new\nimport chainbuild.cli\nprint('went on')\n"
    done = subprocess.run([sys.executable, "-c", planted], capture_output=True, text=True, check=False, timeout=60)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "chainbuild: interrupted\n")


def test_nothing_comes_back_after_the_command() -> None:
    with process.signals():
        process._interrupt(signal.SIGINT, _frame_of_an_import())
    time.sleep(3 * process._AGAIN_S)  # an interrupt that came again would end the tests


def _frame_of_an_import() -> object:
    """Return a frame that looks like that of an import."""
    scope: dict[str, object] = {}
    exec(compile("import sys\nframe = sys._getframe()", process._IMPORTING, "exec"), scope)
    return scope["frame"]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("def f(:\n", "SyntaxError"),
        ("import sys\nsys.exit(0)\n", "it ends the process"),
        ("raise RuntimeError('broken')\n", "RuntimeError: broken"),
        ("x = 1 / 0\n", "ZeroDivisionError"),
        ("import sys\ndef f(axes):\n    sys.exit(0)\n", "fails: SystemExit"),
        ("def f(axes):\n    raise MemoryError\n", "fails: MemoryError"),
        ("def f(T):\n    if T.shape != (4, 4): raise TypeError\n    f.n = getattr(f, 'n', 0) + 1\n"
         "    if f.n > 1: raise SystemExit(0)\n    return []\n", "fails: SystemExit"),
        ("def f(x):\n    return 'text'\n", "neither a pose nor a list"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("kind", ["auto", "fk"])
def test_a_solver_that_fails_is_one_error(text: str, says: str, kind: str, run: Run, tmp_path: Path) -> None:
    name = f"solver_{abs(hash((text, kind)))}"
    (tmp_path / f"{name}.py").write_text(text, "utf-8")
    outcome = run("crosscheck", "kr6r900", "--solver", f"{name}:f", "--kind", kind, "--count", "5")
    assert outcome.code == 1
    assert len([line for line in outcome.err.splitlines() if "finding" not in line]) == 1
    if kind == "auto":
        assert says in outcome.err


def test_rows_of_json_are_those_of_the_tables(run: Run) -> None:
    rows = ["0,-90,90,10,20,0", AT, "0,-90,90,10,0.2,0", "0,-90,90,10,-20,0"]
    Path("path.csv").write_text("A1,A2,A3,A4,A5,A6\n" + "\n".join(rows) + "\n", "utf-8")
    words = ("singularity", "kr6r900", "--axes", "path.csv", "--between", "rows")
    shown = run(*words).out
    data = json.loads(run(*words, "--json").out)
    told = {int(line.split()[0]) for line in shown.splitlines() if line[:3].strip().isdigit() and "wrist" in line}
    assert 3 in told
    assert told == {row["row"] for row in data["rows"] if row["names"] or row["notices"]}
    straight = words[:-2]
    shown, blocks = run(*straight).out, json.loads(run(*straight, "--json").out)["verdicts"]["blocks"]
    assert blocks
    for block in blocks:
        assert f"rows {block['row']} … {block['row'] + 1}, {block['length_mm']:.4g} mm: {block['level']} at " in shown

    Path("folded.csv").write_text(f"A1,A2,A3,A4,A5,A6\n0,-90,90,0,0,0\n{FOLDED}\n{FOLDED}\n", "utf-8")
    shown = run("collide", "kr6r900", "--at", FOLDED).out
    assert "row 1: " in shown
    assert json.loads(run("collide", "kr6r900", "--at", FOLDED, "--json").out)["contacts"][0]["row"] == 1
    shown = run("collide", "kr6r900", "--axes", "folded.csv").out
    data = json.loads(run("collide", "kr6r900", "--axes", "folded.csv", "--json").out)
    assert [f"row {one['row']}: " in shown for one in data["contacts"]] == [True] * len(data["contacts"])
    assert [one["row"] for one in data["closest"]] == [1, 2, 3]

    Path("recorded.csv").write_text(
        "A1,A2,A3,A4,A5,A6,x_mm,y_mm,z_mm\n0,-90,90,0,0,0,525,0,890\n0,-90,90,0,0,0,525,0,891\n0,-90,90,0,0,0,525,0,890\n",
        "utf-8",
    )
    shown = run("crosscheck", "kr6r900", "--recording", "recorded.csv").out
    forward = json.loads(run("crosscheck", "kr6r900", "--recording", "recorded.csv", "--json").out)["forward"]
    assert [row["row"] for row in forward["rows"]] == [1, 2, 3]
    assert f"row {forward['worst']['row']}: " in shown
    assert forward["worst"]["row"] == 2


def seconds(count: int, folder: Path) -> float:
    """Return how long reading and checking a project of many channels takes, in processor time."""
    path = folder / f"{count}.tsproj"
    lists = "<SdaMds><![CDATA[trafo[0].id 9\n]]></SdaMds>\n" * count
    path.write_text(f'<?xml version="1.0"?>\n<TcSmProject>{lists}</TcSmProject>', "utf-8")
    begin = time.process_time()
    chainbuild.load(path).chain()
    findings = chainbuild.check(path)
    assert max(len(str(finding)) for finding in findings) < 1000
    return time.process_time() - begin


def test_many_channels_take_time_in_proportion(tmp_path: Path) -> None:
    few, many = seconds(80, tmp_path), seconds(640, tmp_path)
    assert many < 14 * few, (few, many)


def test_a_table_of_very_many_kinematics_ends(run: Run, tmp_path: Path) -> None:
    seconds(210, tmp_path)
    shown = run("info", "210.tsproj").out
    assert "--channel 199 " in shown
    assert "--channel 200 " not in shown
    assert "10 more: --json lists them" in shown
    assert len(json.loads(run("info", "210.tsproj", "--json").out)["kinematics"]) == 210


def test_a_channel_that_does_not_exist_is_told_with_some_that_do(tmp_path: Path) -> None:
    seconds(50, tmp_path)
    with pytest.raises(ChainbuildError, match=r"no channel 70; .*… \(50 in all\)"):
        chainbuild.load(tmp_path / "50.tsproj").chain(channel=70)
