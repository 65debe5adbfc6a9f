"""picture: what the options reach."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import chainbuild
from chainbuild import Robot
from tests.kit.command_line import Run

SVG = "{http://www.w3.org/2000/svg}"


def texts() -> list[str]:
    return sorted(text.text or "" for text in ET.parse("m.svg").iter(f"{SVG}text"))


def test_the_command_writes_what_the_function_does(run: Run) -> None:
    outcome = run("picture", "kr6r900", "-o", "m.svg", "--at", "0,-90,90,0,30,0", "--view", "right")
    assert (outcome.code, outcome.out) == (0, "m.svg\n")
    chainbuild.picture(Robot.load("kr6r900"), "n.svg", [0, -90, 90, 0, 30, 0], view="right")
    assert Path("m.svg").read_bytes() == Path("n.svg").read_bytes()


def test_frames_and_lengths(run: Run) -> None:
    assert run("picture", "ac_table_kin58", "-o", "m.svg", "--frames", "--dimensions").code == 0
    assert texts() == ["HD1 = 150 mm", "HD6 = −60 mm", "HD9 = −500 mm", "base", "flange = tool", "workpiece"]
    assert run("picture", "ac_table_kin58", "-o", "m.svg", "--dimensions", "--tool-length", "35").code == 0
    assert texts() == ["HD1 = 150 mm", "HD6 = −60 mm", "HD9 = −500 mm", "tool_length = 35 mm"]


def test_a_machine_without_lengths_says_so(run: Run) -> None:
    source = chainbuild.load("bed_mill_kin1").path.read_text("utf-8")
    Path("m.lis").write_text("\n".join(line for line in source.splitlines() if ".param" not in line), "utf-8")
    outcome = run("picture", "m.lis", "-o", "m.svg", "--dimensions")
    assert outcome.code == 0
    assert "--dimensions: no length of the machine data" in outcome.err


def test_a_trace_begins_at_its_first_row(run: Run) -> None:
    Path("path.csv").write_text("A1,A2,A3,A4,A5,A6\n0,-90,90,0,30,0\n20,-80,80,0,30,0\n", "utf-8")
    assert run("picture", "kr6r900", "-o", "m.svg", "--axes", "path.csv").code == 0
    first = Path("m.svg").read_bytes()
    assert run("picture", "kr6r900", "-o", "m.svg", "--axes", "path.csv", "--at", "0,-90,90,0,30,0").code == 0
    assert Path("m.svg").read_bytes() == first
    outcome = run("picture", "kr6r900", "-o", "m.svg", "--axes", "missing.csv")
    assert outcome.code == 1
    assert "missing.csv: the table cannot be read" in outcome.err
    Path("path.csv").write_text("A1,A2,A3,A4,A5,A6\n", "utf-8")
    outcome = run("picture", "kr6r900", "-o", "m.svg", "--axes", "path.csv")
    assert (outcome.code, "no rows" in outcome.err) == (1, True)
    assert Path("m.svg").read_bytes() == first


def test_meshes_that_are_not_drawn_are_named(run: Run) -> None:
    Path("own.toml").write_text('[geometry.shapes]\nA3_link = [{mesh = "a.stl"}]\n', "utf-8")
    outcome = run("picture", "kr6r900", "-o", "m.svg", "--overlay", "own.toml")
    assert (outcome.code, outcome.out) == (0, "m.svg\n")
    assert "meshes of A3_link cannot be read: these links are drawn by rule" in outcome.err
    assert "drawn by rule" in run("inspect", "kr6r900", "--export", "m.html", "--overlay", "own.toml").err
    assert "drawn by rule" not in run("picture", "kr6r900", "-o", "m.svg").err
