"""How many files one pose goes through, by real calls."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MOST_FILES_OF_IK = 16
MOST_FILES_OF_THE_COMMAND = 57


def entered(kind: str, machine: str) -> set[str]:
    words = [sys.executable, "-m", "tests.project.trace", kind, machine]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True)
    return set(done.stdout.split())


@pytest.mark.parametrize("machine", ["kr6r900", "tx2_60", "parallelogram_nr", "irb2600_track", "ac_table_kin58"])
def test_a_pose_goes_through_few_files(machine: str) -> None:
    files = entered("ik", machine)
    assert {"robot.py", "ik/solve.py", "ik/search/solver.py"} <= files
    assert len(files) <= MOST_FILES_OF_IK, sorted(files)


@pytest.mark.parametrize("machine", ["kr6r900", "parallelogram_nr"])
def test_the_command_goes_through_few_files(machine: str) -> None:
    files = entered("command", machine)
    assert {"cli/ik.py", "robot.py", "ik/solve.py"} <= files
    assert len(files) <= MOST_FILES_OF_THE_COMMAND, sorted(files)


def test_the_stages_are_called_by_one_file_alone() -> None:
    """No file but ik/solve.py names the functions that are the stages of one inverse kinematics."""
    stages = (
        "as_programmed(",
        "preferred(",
        "keeping_sums(",
        "checked(",
        "solve_controller(",
        "nearest_branch(",
        "with_status(",
    )
    package = ROOT / "chainbuild"
    for path in package.rglob("*.py"):
        lines = [line for line in path.read_text("utf-8").splitlines() if "def " not in line]
        calls = [stage for stage in stages if any(stage in line and "_" + stage not in line for line in lines)]
        assert not calls or path == package / "ik" / "solve.py", f"{path} calls {calls}"
