"""No command writes over a file that it reads, and no two results go to one file."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from chainbuild.cli import main
from chainbuild.machines import shipped_path

AT = "0,-90,90,0,30,0"
POSES = "x_mm,y_mm,z_mm,qx,qy,qz,qw\n514.282,0,850,0,0.96592582628907,0,0.25881904510252\n"


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, bytes]:
    """Stand in a folder with a machine, its overlay, tables and a link to the machine; return their contents."""
    machine = shipped_path("kr6r900")
    assert machine is not None
    shutil.copy(machine, tmp_path / "m.tea")
    shutil.copy(machine.with_name("kr6r900.chainbuild.toml"), tmp_path / "m.chainbuild.toml")
    (tmp_path / "axes.csv").write_text(f"A1,A2,A3,A4,A5,A6\n{AT}\n")
    (tmp_path / "poses.csv").write_text(POSES)
    (tmp_path / "recorded.csv").write_text(f"A1,A2,A3,A4,A5,A6,x_mm,y_mm,z_mm\n{AT},514.282,0,850\n")
    (tmp_path / "link.csv").symlink_to("axes.csv")
    (tmp_path / "hard.csv").hardlink_to(tmp_path / "axes.csv")
    (tmp_path / "hard.tea").hardlink_to(tmp_path / "m.tea")
    shutil.copy(shipped_path("ac_table_kin58"), tmp_path / "t.lis")  # type: ignore[arg-type]
    (tmp_path / "x.lis").write_text("kenngr.swe_pos 100\nkenngr.swe_neg -100\n")
    (tmp_path / "t.chainbuild.toml").write_text('axis_lists = ["x.lis"]\n')
    (tmp_path / "mine.py").write_text("def f(axes):\n    return None\n")
    monkeypatch.chdir(tmp_path)
    return {path.name: path.read_bytes() for path in tmp_path.iterdir()}


@pytest.mark.parametrize(
    "words",
    [
        f"fk m.tea --at {AT} -o m.tea",
        f"fk m.tea --at {AT} -o m.chainbuild.toml",
        f"fk m.tea --at {AT} -o ./sub/../m.tea",
        "fk m.tea --axes axes.csv -o axes.csv",
        "fk m.tea --axes axes.csv -o link.csv",
        "ik m.tea --poses poses.csv -o poses.csv",
        "ik m.tea --poses poses.csv --start axes.csv -o axes.csv",
        "as-universal m.tea -o m.tea",
        "inspect m.tea --export m.tea",
        "picture m.tea -o m.tea",
        "picture m.tea --axes axes.csv -o axes.csv",
        "picture kr6r900 --overlay t.chainbuild.toml -o x.lis",
        "crosscheck m.tea --recording recorded.csv --html recorded.csv",
        "collide m.tea --axes axes.csv --picture axes.csv",
        "singularity m.tea --axes axes.csv --picture m.tea",
        "workspace m.tea -o map.npz --picture map.npz",
        "fk m.tea --axes axes.csv -o hard.csv",
        "fk m.tea --axes hard.csv -o link.csv",
        "ik m.tea --poses poses.csv -o hard.tea",
        "workspace m.tea -o hard.tea",
        "inspect m.tea --export axes.csv --axes link.csv",
        "inspect m.tea --export poses.csv --poses poses.csv",
        "inspect m.tea --export ./recorded.csv --recording recorded.csv",
        "inspect t.lis --export x.lis",
        "as-universal t.lis -o x.lis",
        "inspect kr6r900 --overlay t.chainbuild.toml --export x.lis",
        "limits m.tea --axis A3 --over A2 --picture m.chainbuild.toml",
        "crosscheck m.tea --solver mine:f --html mine.py",
    ],
)
def test_refused_and_nothing_written(
    words: str, files: dict[str, bytes], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "sub").mkdir()
    assert main(words.split()) == 2
    message = capsys.readouterr().err
    assert "expected another file, nothing was written" in message
    (tmp_path / "sub").rmdir()
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == files


def test_other_outputs_are_written(files: dict[str, bytes], tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["fk", "m.tea", "--axes", "axes.csv", "-o", "out.csv"]) == 0
    assert main(["fk", "m.tea", "--axes", "axes.csv", "-o", "out.csv"]) == 0  # its own result may be replaced
    assert main(["ik", "m.tea", "--poses", "out.csv", "-o", "/dev/null"]) == 0
    assert (tmp_path / "out.csv").read_text().startswith("x_mm")
    assert {name: (tmp_path / name).read_bytes() for name in files} == files


@pytest.mark.parametrize(
    ("command", "suffix"),
    [("urdf {} -o out", "urdf"), ("demo {} -o out", "urdf"), ("collide {} --pairs --samples 5 --srdf out", "srdf")],
)
@pytest.mark.parametrize("how", ["itself", "hard link", "symbolic link"])
def test_a_folder_written_to_may_hold_the_machine_file(
    command: str, suffix: str, how: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target = tmp_path / "out" / "m" / f"m.{suffix}"
    target.parent.mkdir(parents=True)
    before = (tmp_path / "m.tea").read_bytes()
    if how == "itself":
        target.write_bytes(before)
    elif how == "hard link":
        target.hardlink_to(tmp_path / "m.tea")
    else:
        target.symlink_to(tmp_path / "m.tea")
    assert main(command.format(target if how == "itself" else "m.tea").split()) == 2
    assert "this file is also an input; it is left as it is" in capsys.readouterr().err
    assert target.read_bytes() == before
    assert [path.name for path in target.parent.iterdir()] == [target.name]


def test_an_output_may_be_replaced_by_the_next_command(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """What is an input of one command is none of the next."""
    assert main(["fk", "m.tea", "--axes", "axes.csv", "-o", "poses.csv"]) == 0
    assert main(["fk", "m.tea", "--at", AT, "-o", "axes.csv"]) == 0
    assert (tmp_path / "axes.csv").read_text().startswith("x_mm")
