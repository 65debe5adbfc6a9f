"""Commands by the channel's own names of the axes, and by the generic ones."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import chainbuild
from tests.kit.command_line import Run, rows_of, write
from tests.kit.couplings import XY
from tests.kit.named_axes import bezeichnungen, named_machine

HEAD = {0: "X_BETT", 1: "Y_BETT", 2: "Z_PINOLE", 3: "C_KOPF", 4: "A_KOPF"}
VALUES = "100,50,-20,30,40"
HEADERS = [
    "X_BETT,Y_BETT,Z_PINOLE,C_KOPF,A_KOPF",
    "X,Y,Z,C,A",
    "x_bett,Y,z,C_Kopf,a",
    "X [mm],Y [mm],Z[mm],C_KOPF [deg],A [°]",
]


@pytest.fixture
def head(tmp_path: Path) -> Path:
    return named_machine(tmp_path, "ca_head_kin9", HEAD)


@pytest.mark.parametrize("header", HEADERS)
def test_fk_of_a_table(run: Run, head: Path, header: str) -> None:
    wanted = rows_of(run("fk", "ca_head_kin9", "--axes", write("plain.csv", f"X,Y,Z,C,A\n{VALUES}\n")).out)
    found = run("fk", head, "--axes", write("axes.csv", f"{header}\n{VALUES}\n"))
    assert found.code == 0
    called = {"C": HEAD[3], "A": HEAD[4]}
    named = [{called.get(name, name): value for name, value in row.items()} for row in wanted]
    assert rows_of(found.out) == named  # the control shows C and A by the channel's names


@pytest.mark.parametrize("header", HEADERS)
def test_ik_from_a_start(run: Run, head: Path, header: str) -> None:
    poses = write("poses.csv", run("fk", "ca_head_kin9", "--axes", write("plain.csv", f"X,Y,Z,C,A\n{VALUES}\n")).out)
    found = run("ik", head, "--poses", poses, "--start", write("start.csv", f"{header}\n{VALUES}\n"))
    assert found.code == 0, found.err
    (row,) = rows_of(found.out)
    assert list(row)[:5] == list(HEAD.values())
    assert [float(row[name]) for name in HEAD.values()] == pytest.approx([100, 50, -20, 30, 40], abs=1e-6)


def test_faults_of_a_table(run: Run, head: Path) -> None:
    for header, text in (
        (
            "X_BETT,Y,Z,C [mm],A",
            "the values of axis C_KOPF are in deg; permitted: C_KOPF or C_KOPF [deg]",
        ),
        ("X_BETT,Y,Z,C,C_KOPF", "columns 'C' and 'C_KOPF' are the same: C_KOPF"),
        ("X_BETT,Y,Z,C,B", "unknown column 'B'; permitted: X_BETT, Y_BETT, Z_PINOLE, C_KOPF, A_KOPF"),
        ("X_BETT,Y,Z,C", "missing column A_KOPF"),
    ):
        found = run("fk", head, "--axes", write("axes.csv", f"{header}\n{VALUES}\n"))
        assert found.code == 1
        assert text in found.err
        assert "axes.csv:1" in found.err


@pytest.mark.parametrize("header", HEADERS[:2])
def test_collide_and_singularity(run: Run, head: Path, header: str) -> None:
    path = write("path.csv", f"{header}\n{VALUES}\n110,50,-20,30,0\n")
    for command in ("collide", "singularity"):
        found = run(command, head, "--axes", path, "--json")
        assert found.code in (0, 3)
        assert json.loads(found.out)
    shown = json.loads(run("singularity", head, "--at", "0,0,0,10,0", "--json").out)
    assert list(shown["rows"][0]["axes"]) == list(HEAD.values())


def test_workspace_and_limits_by_either_name(run: Run, tmp_path: Path) -> None:
    arm = named_machine(tmp_path, "kr6r900", {n: f"RA{n}" for n in range(1, 7)})
    words = ["--cells", "4", "--workers", "1", "--json"]
    by_name = run("workspace", arm, "--over", "RA2", "--over", "RA3", *words)
    by_generic = run("workspace", arm, "--over", "A2", "--over", "a3", *words)
    directions = json.loads(by_name.out)["directions"]
    assert [one["name"] for one in directions] == ["RA2 [deg]", "RA3 [deg]"]
    assert json.loads(by_generic.out)["directions"] == directions
    assert run("workspace", arm, "--over", "A2", "--over", "RA2", *words).code == 1
    swept = json.loads(run("limits", arm, "--axis", "a3", "--over", "RA2", "--steps", "3", "--json").out)
    assert (swept["axis"], swept["over"]) == ("RA3", "RA2")
    refused = run("limits", arm, "--axis", "A3", "--over", "RA3", "--steps", "3")
    assert refused.code == 1
    assert "swept against itself" in refused.err


def test_info_tells_both_names(run: Run, head: Path) -> None:
    axes = json.loads(run("info", head, "--json").out)["axes"]
    assert [(axis["name"], axis["generic"]) for axis in axes] == list(zip(HEAD.values(), "XYZCA", strict=True))
    shown = run("info", head).out
    assert "Generic" in shown
    assert any(line.split()[:1] == ["C_KOPF"] and " C " in line for line in shown.splitlines())
    # The overlay names them by their letters.
    assert {axis["limits_from"] for axis in axes} == {"overlay"}


def test_an_axis_called_like_a_column(run: Run, tmp_path: Path) -> None:
    path = named_machine(tmp_path, "ca_head_kin9", {**HEAD, 4: "A_DEG"})
    line = path.read_text("utf-8").splitlines().index("gruppe[0].achse[4].bezeichnung A_DEG") + 1
    for command in ("info", "check"):
        found = run(command, path)
        assert found.code == 1
        said = " ".join((found.out + found.err).split())
        assert "called 'A_DEG' like a column of the tables" in said
        assert f":{line}" in said


def test_a_coupling_by_the_names_of_its_channel(run: Run, tmp_path: Path) -> None:
    names = ["X_TCP", "Y_TCP", "Z_TCP", "A_TCP", "B_TCP", "C_TCP", "X_LIN", "Y_LIN",
             "X_ROB", "Y_ROB", "Z_ROB", "A_ROB", "B_ROB", "C_ROB"]  # fmt: skip
    path = tmp_path / "unit.lis"
    path.write_text("\n".join([*XY, "ori_rotation_angle 4", bezeichnungen(dict(enumerate(names)))]))
    words = ["couple", path, "--tcp", "X=1400,Y=300,Z=700,B=90,C=10", "--axes", "--json"]
    by_letter = run(*words, "--program", "LINEAR.X=800", "--lock", "LINEAR.Y", "--current", "LINEAR.Y=100")
    by_name = run(*words, "--program", "X_LIN=800", "--lock", "Y_LIN", "--current", "Y_LIN=100")
    assert by_name.code == 0, by_name.err
    assert by_name.out == by_letter.out
    data = json.loads(by_name.out)
    assert data["partials"]["LINEAR"] == {"X": 800.0, "Y": 100.0}
    assert list(data["axes"]) == names[6:]
    robot = chainbuild.Robot.load(path)
    assert robot.fk(list(data["axes"].values())).translation == pytest.approx([1.4, 0.3, 0.7], abs=1e-6)
    refused = run(*words, "--lock", "Y_TISCH")
    assert refused.code == 1
    assert "Y_TISCH is not a coordinate of a partial" in refused.err
