"""A signal at a hundred moments of each writing command: no half file, no process left, no traceback of ours."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import time
from pathlib import Path

import pytest

import chainbuild
from tests.kit.command_line import PROGRAM

MOMENTS = 100
PACKAGE = str(Path(chainbuild.__file__).parent)
AT = "0,-90,90,0,30,0"
COMMANDS = {
    "fk": "fk kr6r900 --axes ../axes.csv -o poses.csv",
    "ik": "ik kr6r900 --poses ../poses.csv -o axes.csv",
    "as-universal": "as-universal bed_mill_kin1 -o list.lis",
    "urdf": "urdf kr6r900 -o out",
    "export": "export tripod_kin12 --format urdf,mjcf -o out",
    "demo": "demo kr6r900 -o out",
    "inspect": "inspect kr6r900 --export page.html",
    "picture": "picture kr6r900 -o m.png",
    "srdf": "collide kr6r900 --pairs --samples 50 --srdf out",
    "collide": f"collide kr6r900 --at {AT} --picture distance.svg",
    "singularity": f"singularity kr6r900 --at {AT} --picture measure.svg",
    "limits": "limits kr6r900 --axis A3 --over A2 --steps 2 --picture free.svg",
    "crosscheck": "crosscheck kr6r900 --recording ../recorded.csv --html check.html",
    "workspace": "workspace kr6r900 --samples 60000 --cells 20 --workers 2 -o map.npz --picture map.svg",
}
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)


def started(words: list[str], folder: Path) -> subprocess.Popen[str]:
    """Start a command as the first of its own session, heedful of interrupts."""
    return subprocess.Popen(
        [*PROGRAM, *words],
        cwd=folder,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def reached_the_command(err: str) -> bool:
    """Return whether a traceback goes through more of the package than its first line, which imports `typing`."""
    frames = re.findall(rf'File "{re.escape(PACKAGE)}/([^"]+)"', err)
    return any(frame != "__init__.py" for frame in frames)


def left_over(session: int) -> list[int]:
    """Return the processes of a session that run."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            state, _, _, its_session = (process / "stat").read_text().rpartition(")")[2].split()[:4]
        except OSError:
            continue
        if int(its_session) == session and state != "Z":
            found.append(int(process.name))
    return found


@pytest.mark.slow
@pytest.mark.usefixtures("heeds_interrupts")
@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="looks processes up in /proc")
@pytest.mark.parametrize("name", COMMANDS)
def test_a_command_killed_at_any_moment_leaves_nothing_half(name: str, tmp_path: Path) -> None:
    words = COMMANDS[name].split(" ")
    (tmp_path / "axes.csv").write_text("A1,A2,A3,A4,A5,A6\n" + f"{AT}\n" * 2000, "utf-8")
    (tmp_path / "recorded.csv").write_text(f"A1,A2,A3,A4,A5,A6,x_mm,y_mm,z_mm\n{AT},514.282,0,850\n", "utf-8")
    assert started(["fk", "kr6r900", "--axes", "axes.csv", "-o", "poses.csv"], tmp_path).wait(60) == 0
    whole = tmp_path / "whole"
    whole.mkdir()
    for _ in range(2):  # the second without compiling
        begin = time.monotonic()
        assert started(words, whole).wait(120) in (0, 3)
        length = time.monotonic() - begin
    expected = contents(whole)
    for moment in range(MOMENTS):
        folder = tmp_path / str(moment)
        folder.mkdir()
        number = SIGNALS[moment % len(SIGNALS)]
        process = started(words, folder)
        time.sleep(length * moment / MOMENTS)
        if process.poll() is None:
            os.kill(process.pid, number)
        _, err = process.communicate(timeout=60)
        deadline = time.monotonic() + 10.0
        while left_over(process.pid):
            assert time.monotonic() < deadline, (moment, number, left_over(process.pid))
            time.sleep(0.02)
        found = contents(folder)
        if number == signal.SIGKILL:
            found = {path: content for path, content in found.items() if not path.endswith(".part")}
        for path, content in found.items():
            assert path in expected, (moment, number, path)
            assert path.endswith(".npz") or content == expected[path], (moment, number, path)
        if reached_the_command(err) or not ("Traceback" in err or "Fatal Python error" in err):
            assert process.returncode in (0, 3, 130, -number), (moment, number, process.returncode, err)
            assert "Traceback" not in err, (moment, err)
        # Else Python was interrupted before it reached the package, or after it had left it.
