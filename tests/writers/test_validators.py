"""Files as checkers of URDF see them: check_urdf of urdfdom, and urdf-validator with its statics."""

from __future__ import annotations

import importlib.metadata
import json
import subprocess
import sys
from pathlib import Path

import pytest

import chainbuild
from chainbuild.machines import shipped
from chainbuild.robot import Robot

PROGRAMS = Path(sys.executable).parent
URDFDOM = Path(str(importlib.metadata.distribution("cmeel-urdfdom").locate_file("cmeel.prefix")))


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("urdf")
    return {name: chainbuild.write_urdf(Robot.load(name), folder) for name in shipped()}


def test_check_urdf_accepts_every_file(files: dict[str, Path]) -> None:
    known = {"LD_LIBRARY_PATH": str(URDFDOM / "lib"), "DYLD_LIBRARY_PATH": str(URDFDOM / "lib")}
    for name, path in files.items():
        words = [URDFDOM / "bin" / "check_urdf", path]  # itself: what stands in its place starts a Python each time
        done = subprocess.run(words, capture_output=True, text=True, check=False, env=known)
        assert (done.returncode, done.stderr) == (0, ""), name
        assert "Successfully Parsed XML" in done.stdout
        assert "root Link: base " in done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("name", shipped())
def test_urdf_validator_finds_no_error(name: str, files: dict[str, Path], tmp_path: Path) -> None:
    words = [PROGRAMS / "urdf_validate", files[name], "--output-dir", tmp_path, "--robot-type", "arm_only"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    report = json.loads((tmp_path / f"{name}_validation.json").read_text("utf-8"))
    assert report["critical_issues"] == []
    assert report["schema"]["status"] in ("PASS", "INFO")
    assert {joint["status"] for joint in report["statics"]["joints"]} <= {"PASS"}
    assert (done.returncode, report["overall_status"]) == (0, "PASS")
