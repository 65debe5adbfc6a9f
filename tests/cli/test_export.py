"""`chainbuild export`: several files at once, or none."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import chainbuild
from chainbuild.errors import ChainbuildError
from chainbuild.robot import Robot
from chainbuild.writers.models.mjcf import mjcf_text
from chainbuild.writers.models.urdf import urdf_text
from tests.kit.command_line import Run


def test_the_files_are_those_of_their_writers(run: Run) -> None:
    outcome = run("export", "tripod_kin12", "--samples", "200", "-o", "out", "--format", "urdf,mjcf,srdf")
    folder = Path("out/tripod_kin12")
    assert outcome.code == 0
    suffixes = ("urdf", "loops.yaml", "xml", "srdf")
    assert outcome.out.splitlines() == [str(folder / f"tripod_kin12.{suffix}") for suffix in suffixes]
    machine = chainbuild.load("tripod_kin12")
    robot = Robot(machine.chain())
    written = (folder / "tripod_kin12.urdf").read_text("utf-8")
    assert written == chainbuild.write_urdf(robot, "other", machine=machine).read_text("utf-8")
    for line in ("trafo[0].param[4] = 420 mm", "kin12_carriages=above", "tripod_kin12.loops.yaml says how loops"):
        assert line in written
    assert "Machine data" not in urdf_text(robot)
    assert (folder / "tripod_kin12.xml").read_text("utf-8") == mjcf_text(robot)
    assert "Pairs by 200 positions" in (folder / "tripod_kin12.srdf").read_text("utf-8")


def test_formats_are_chosen(run: Run) -> None:
    data = json.loads(run("export", "kr6r900", "--format", "MJCF", "--json").out)
    assert data == {"schema": "chainbuild:export:1", "paths": {"mjcf": ["urdf_out/kr6r900/kr6r900.xml"]}}
    assert [path.name for path in Path("urdf_out/kr6r900").iterdir()] == ["kr6r900.xml"]


@pytest.mark.parametrize("words", [["--format", "usd"], ["--format", "urdf,"], ["--samples", "0"]])
def test_what_is_not_offered_is_refused(run: Run, words: list[str]) -> None:
    outcome = run("export", "kr6r900", *words)
    assert outcome.code == 2
    assert not Path("urdf_out").exists()


def test_all_are_those_that_the_machine_has(run: Run) -> None:
    data = json.loads(run("export", "kr6r900", "--samples", "5", "--no-inertia", "--json").out)
    assert list(data["paths"]) == ["urdf", "mjcf", "srdf", "opw", "report"]
    assert "inertial" not in Path("urdf_out/kr6r900/kr6r900.urdf").read_text("utf-8")
    outcome = run("urdf", "lambda_kin21", "-o", "out")
    assert outcome.out.splitlines()[:2] == ["out/lambda_kin21/lambda_kin21.urdf", "  beside it lambda_kin21.loops.yaml"]
    assert "inertial" in Path("out/lambda_kin21/lambda_kin21.urdf").read_text("utf-8")


def test_nothing_is_written_where_one_cannot_be_made(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_robot: Robot) -> str:
        raise ChainbuildError("no position within the limits has a pose")

    monkeypatch.setattr("chainbuild.writers.models.export.mjcf_text", refuse)
    outcome = run("export", "kr6r900", "--format", "urdf,mjcf")
    assert outcome.code == 1
    assert not Path("urdf_out").exists()


def test_python_refuses_formats_that_are_none(tmp_path: Path) -> None:
    robot = Robot.load("kr6r900")
    for formats in (["usd"], [], "urdf"):
        with pytest.raises(ChainbuildError, match="urdf, mjcf, srdf, opw"):
            chainbuild.export(robot, tmp_path, formats=formats)  # type: ignore[arg-type]
    assert list(tmp_path.iterdir()) == []
