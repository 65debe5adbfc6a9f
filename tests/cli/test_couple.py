"""`chainbuild couple` and `chainbuild as-universal`."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from tests.kit.command_line import Run
from tests.kit.couplings import XY


@pytest.fixture
def machine_file(tmp_path: Path) -> str:
    path = tmp_path / "unit.lis"
    path.write_text("\n".join([*XY, "ori_rotation_angle 4"]))
    return str(path)


def test_the_split_as_a_table(run: Run, machine_file: str) -> None:
    outcome = run("couple", machine_file, "--tcp", "X=1000,Y=500", "--tcp", "Z=50", "--tcp", "C=10")
    assert outcome.code == 0
    rows = {line.split()[0]: line.split()[1:] for line in outcome.out.splitlines() if line.strip()}
    assert rows["LINEAR"] == ["1000", "500"]
    assert rows["ROBOT"] == ["0", "0", "50", "0", "0", "10"]
    assert rows["TCP"] == ["1000", "500", "50", "0", "0", "10"]


def test_the_split_as_json_with_axes(run: Run, machine_file: str) -> None:
    words = ["--tcp", "X=1400,Y=300,Z=700,B=90,C=10", "--program", "LINEAR.X=800", "--lock", "LINEAR.Y"]
    outcome = run("couple", machine_file, *words, "--current", "LINEAR.Y=100", "--axes", "--json")
    assert outcome.code == 0
    data = json.loads(outcome.out)
    assert data["partials"]["LINEAR"] == {"X": 800.0, "Y": 100.0}
    assert data["partials"]["ROBOT"] == pytest.approx({"X": 600, "Y": 200, "Z": 700, "A": 0, "B": 90, "C": 10})
    robot = chainbuild.Robot.load(machine_file)
    assert robot.fk(list(data["axes"].values())).translation == pytest.approx([1.4, 0.3, 0.7], abs=1e-6)


def test_partials_programmed_alone_move_the_tcp(run: Run, machine_file: str) -> None:
    outcome = run("couple", machine_file, "--program", "ROBOT.X=1000,LINEAR.X=500", "--json")
    assert json.loads(outcome.out)["tcp"]["X"] == 1500.0


@pytest.mark.parametrize(
    "words", [["--tcp", "X"], ["--tcp", "X=a"], ["--current", "X=1"], ["--program", "=1"], ["--tcp", "X=1,x=2"]]
)
def test_wrong_usage(run: Run, machine_file: str, words: list[str]) -> None:
    outcome = run("couple", machine_file, *words)
    assert outcome.code == 2
    assert "=VALUE" in outcome.err and ": expected " in outcome.err


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--tcp", "Q=1"], "there is no coordinate Q"),
        (["--program", "SLIDE.X=1"], "there is no partial SLIDE"),
        (["--tcp", "Z=5", "--lock", "ROBOT.Z"], "5 mm and 0 deg are left over"),
        (["--tcp", "X=9000", "--lock", "LINEAR.X", "--axes"], "ROBOT cannot reach"),
    ],
)
def test_refused(run: Run, machine_file: str, words: list[str], text: str) -> None:
    outcome = run("couple", machine_file, *words)
    assert outcome.code == 1
    assert text in outcome.err


def test_a_type_as_universal_kinematic(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "as91.lis"
    outcome = run("as-universal", "ac_table_kin58", "-o", str(path))
    assert outcome.code == 0
    universal = chainbuild.load(path).chain()
    assert universal.kinematic == "KIN_TYP 91"
    axes = [10.0, 20.0, -30.0, 40.0, 50.0]
    of_type, other = chainbuild.Robot.load("ac_table_kin58").fk(axes), chainbuild.Robot(universal).fk(axes)

    assert other.translation - of_type.translation == pytest.approx([0, 0, -0.56], abs=1e-12)
    assert np.abs(other.rotation - of_type.rotation).max() < 1e-12


def test_a_list_on_stdout_is_nothing_but_the_list(run: Run) -> None:
    outcome = run("as-universal", "ca_head_kin9")
    assert outcome.code == 0
    assert outcome.out.endswith("Ende\n")
    assert outcome.err == ""


def test_refusals_of_as_universal(run: Run, tmp_path: Path) -> None:
    path = tmp_path / "none.lis"
    outcome = run("as-universal", "scara_kin36", "-o", str(path))
    assert outcome.code == 1
    assert "cannot be written as KIN_TYP 91" in outcome.err
    assert not path.exists()
    outcome = run("as-universal", "ca_head_kin9", "--tool-length", "5")
    assert outcome.code == 2
    assert "chainbuild as-universal --help" in outcome.err
