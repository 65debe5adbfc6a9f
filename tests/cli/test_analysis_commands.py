"""singularity, collide, limits, workspace: tables, JSON, pictures, refusals."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.machines import shipped_path
from tests.kit.command_line import Run

COMMANDS = ["singularity", "collide", "limits", "workspace"]
NEAR_WRIST = "0,-90,90,0,0.3,0"
FOLDED = "0,45,150,0,0,0"


def is_picture(path: str) -> bool:
    root = ET.parse(path).getroot()
    return root.tag.endswith("svg") and len(root) > 5


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
    for option in ("--kinematic", "--convention", "--overlay", "--json", "--picture"):
        assert option in outcome.out
    assert re.search(rf"│ {command} +\S+ \S+", run("--help").out)


def test_singularity_of_one_position(run: Run) -> None:
    outcome = run("singularity", "kr6r900", "--at", NEAR_WRIST, "--nearest", "--picture", "one.svg")
    assert outcome.code == 0
    assert "wrist (alpha5): A4 and A6 are nearly parallel (A5 = 0.3°)" in outcome.out
    assert "axis 5 within ITERLIMIT" in outcome.out
    assert "nearest singularity at" in outcome.out
    assert "A5 -0.3°" in outcome.out
    assert is_picture("one.svg")
    far = run("singularity", "kr6r900", "--at", "0,-90,90,0,60,0")
    assert "no singularity near" in far.out


def test_axis_speeds_are_shown_without_their_noise(run: Run) -> None:
    out = run("singularity", "ac_table_kin58", "--at", "0,0,-100,0,0").out
    assert re.search(r"^ A +0 deg/s +150 deg/s", out, re.MULTILINE)
    assert "e-" not in out.partition("Axis speeds")[2].partition("pole")[0]


def test_singularity_for_programs(run: Run) -> None:
    data = json.loads(run("singularity", "kr6r900", "--at", NEAR_WRIST, "--nearest", "--json").out)
    (row,) = data["rows"]
    assert row["names"][0]["kind"] == "wrist"
    assert row["axes"]["A5"] == 0.3
    assert row["judgement"]["hand_limit"] is True
    assert row["nearest"]["found"] is True
    assert row["possible_speed"] < 100.0
    assert data["smallest"][0] == pytest.approx(row["singular_values"][-1])
    exact = json.loads(run("singularity", "kr6r900", "--at", "0,-90,90,0,0,0", "--json", "--length", "500").out)
    assert exact["rows"][0]["speeds"]["A4"] is None  # infinite
    assert exact["length_mm"] == pytest.approx(500.0)


def test_singularity_along_a_path(run: Run) -> None:
    rows = [f"0,-90,90,10,{a5},0" for a5 in range(-20, 21)]
    Path("path.csv").write_text("A1,A2,A3,A4,A5,A6\n" + "\n".join(rows) + "\n", "utf-8")
    words = ("singularity", "kr6r900", "--axes", "path.csv", "--between", "rows")
    outcome = run(*words, "--picture", "path.svg")
    assert outcome.code == 0
    assert "wrist (alpha5)" in outcome.out
    assert "41 rows" in outcome.out
    assert is_picture("path.svg")
    data = json.loads(run(*words, "--json").out)
    assert len(data["smallest"]) == 41
    assert min(row["row"] for row in data["rows"]) > 5


def test_verdicts_of_the_control_on_a_path(run: Run) -> None:
    """Both rows are clear; the block between them is not."""
    Path("path.csv").write_text("A1,A2,A3,A4,A5,A6\n0,-90,90,10,-8,0\n0,-90,90,10,8,0\n", "utf-8")
    outcome = run("singularity", "kr6r900", "--axes", "path.csv")
    assert "MD28592 $MC_MM_NUM_SINGULARITY_BLOCKS = 1 switches it on" in " ".join(outcome.out.split())
    assert "rows 1 … 2" in outcome.out
    assert "alarm 10911" in " ".join(outcome.out.split())
    assert "75327" not in outcome.out
    text = chainbuild.load("kr6r900").path.read_text("utf-8")
    Path("on.tea").write_text(text.replace("M17", "$MC_MM_NUM_SINGULARITY_BLOCKS=1\nM17"), "utf-8")
    choices = ["--convention", "singularity_measure=product", "--convention", "singular_block=stretch"]
    data = json.loads(run("singularity", "on.tea", "--axes", "path.csv", "--json", *choices).out)["verdicts"]
    assert (data["measure"], data["singular_block"], data["handled"]) == ("product", "stretch", True)
    (block,) = data["blocks"]
    assert (block["row"], block["level"], block["alarm"]) == (1, "singular", None)
    assert block["parts"][0]["least"]["share"] == pytest.approx(0.5)
    at = json.loads(run("singularity", "on.tea", "--at", "0,-90,90,10,1,0", "--json", *choices).out)
    assert at["rows"][0]["judgement"]["measure"] == "product"
    shown = run("singularity", "on.tea", "--at", "0,-90,90,10,1,0").out
    assert "watched" in shown
    assert "one_minus_cosine" in shown


def test_collide_at_a_position_and_along_a_path(run: Run) -> None:
    free = run("collide", "kr6r900", "--at", "0,-90,90,0,0,0")
    assert (free.code, "no collision" in free.out) == (0, True)
    hit = run("collide", "kr6r900", "--at", FOLDED)
    assert hit.code == 3
    assert "touch at" in hit.out
    Path("path.csv").write_text(f"A1,A2,A3,A4,A5,A6\n0,-90,90,0,0,0\n{FOLDED}\n", "utf-8")
    outcome = run("collide", "kr6r900", "--axes", "path.csv", "--json", "--picture", "d.svg")
    assert outcome.code == 3
    data = json.loads(outcome.out)
    (contact,) = data["contacts"]
    assert contact["row"] == 1
    assert 0.0 < contact["share"] < 1.0
    assert len(data["closest"]) == 2
    assert np.array(data["closest"][0]["points_mm"]).shape == (2, 3)
    assert is_picture("d.svg")
    near = json.loads(run("collide", "kr6r900", "--at", "0,-90,90,0,0,0", "--clearance", "500", "--json").out)
    assert near["collides"] is True


def test_pairs_and_srdf(run: Run) -> None:
    outcome = run("collide", "kr6r900_2", "--pairs", "--samples", "100", "--srdf", "out")
    assert outcome.code == 0
    assert "95% confidence" in outcome.out
    root = ET.parse("out/kr6r900_2/kr6r900_2.srdf").getroot()
    assert {entry.get("reason") for entry in root.findall("disable_collisions")} == {"Adjacent", "Always", "Never"}
    data = json.loads(run("collide", "kr6r900_2", "--pairs", "--samples", "100", "--json").out)
    assert data["pairs"]["samples"] == 100


GIVEN = """
[geometry]
crank_mm = 300
rod_radius_mm = 40

[geometry.shapes]
base = [{capsule = [0, 0, 100, 0, 0, 450], radius_mm = 200}]
A1_link = [{capsule = [-50, 0, -350, 300, 0, -350], radius_mm = 120}]
A2_link = [{capsule = [0, 0, 0, 1100, 0, 0], radius_mm = 90}]
A3_link = [{capsule = [0, 0, 0, 1250, 0, 250], radius_mm = 100}]
"""


def test_limits_of_a_parallelogram(run: Run) -> None:
    source = shipped_path("parallelogram_nr")
    overlay = source.with_name("parallelogram_nr.chainbuild.toml").read_text("utf-8")
    Path("arm.tea").write_bytes(source.read_bytes())
    Path("arm.chainbuild.toml").write_text(overlay + GIVEN, "utf-8")
    outcome = run("limits", "arm.tea", "--steps", "5", "--picture", "p.svg")
    assert outcome.code == 0
    assert re.search(r"N62964 \$MC_ROBX_SW_LIMITS_PARALLEL\[0\]=[\d.]+\n", outcome.out)
    assert "too tight" in outcome.out
    assert "estimate" not in outcome.out
    assert is_picture("p.svg")
    data = json.loads(run("limits", "arm.tea", "--steps", "5", "--json").out)
    assert data["proposal"][0] < data["proposal"][1]
    assert data["given"] == [30.0, 150.0]
    assert (data["drawn"], data["touching"]) == ([], [])
    assert len(data["machine_data"]) == 2


def test_drawn_bodies_that_touch_at_home_propose_no_limits(run: Run) -> None:
    outcome = run("limits", "parallelogram_nr", "--steps", "5")
    assert outcome.code == 0
    assert "base and rod_link touch at home (A2 = 0°, A3 = -92.5°): the bodies are wrong" in outcome.out
    assert "too wide" not in outcome.out
    assert "N62964" not in outcome.out
    assert "an estimate: " in outcome.out
    data = json.loads(run("limits", "parallelogram_nr", "--steps", "5", "--json").out)
    assert data["proposal"] is None
    assert data["machine_data"] == []
    assert ["base", "rod_link"] in data["touching"]
    assert "rod_link" in data["drawn"]


def test_limits_of_an_axis_over_another(run: Run) -> None:
    outcome = run("limits", "palletiser_kin96", "--axis", "G3", "--over", "G2", "--steps", "4", "--picture", "g.svg")
    assert outcome.code == 0
    assert "G1_link – G3_link" in outcome.out
    assert is_picture("g.svg")
    words = ("--axis", "G3", "--over", "G2", "--steps", "3", "--at", "0,10,-5,0", "--json")
    data = json.loads(run("limits", "palletiser_kin96", *words).out)
    assert [one["over"] for one in data["intervals"]] == [-40.0, 22.5, 85.0]


def test_workspace_maps(run: Run) -> None:
    words = ("--samples", "4000", "--cells", "20", "--workers", "1")
    outcome = run("workspace", "kr6r900", *words, "-o", "map.npz", "--picture", "map.svg")
    assert outcome.code == 0
    assert "cells reached" in outcome.out
    assert is_picture("map.svg")
    data = json.loads(run("workspace", "kr6r900", *words, "-o", "map.npz", "--json").out)
    assert data["positions"] > 3900
    assert data["directions"][1]["name"] == "z [m]"
    words = ("--over", "A3", "--over", "A5", "--cells", "15", "--workers", "1", "--at", "0,-80,70,0,0,0")
    axes = json.loads(run("workspace", "kr6r900", *words, "--json").out)
    assert axes["positions"] == 225
    words = ("--section", "volume", "--cells", "8", "--samples", "900", "--collisions", "--workers", "1")
    volume = run("workspace", "kr6r900", *words, "--picture", "v.svg")
    assert "left out for self-collision" in volume.out
    assert is_picture("v.svg")


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["singularity", "kr6r900"], 2, "expected --at, --axes or --poses"),
        (["singularity", "kr6r900", "--at", "1,2"], 1, "expected 6 axis values"),
        (["singularity", "kr6r900", "--at", "1,x,3"], 2, "--at 1,x,3: expected numbers separated by commas"),
        (["singularity", "kr6r900", "--at", NEAR_WRIST, "--speed", "0"], 1, "speed"),
        (["singularity", "kr6r900", "--at", NEAR_WRIST, "--length", "-1"], 1, "characteristic length"),
        (["collide", "kr6r900"], 2, "expected --at, --axes, --pairs or --srdf"),
        (["collide", "kr6r900", "--at", NEAR_WRIST, "--clearance", "-1"], 1, "clearance"),
        (["collide", "kr6r900", "--pairs", "--samples", "0"], 1, "at least 1 sample"),
        (["limits", "kr6r900"], 1, "has no limits on a parallelogram's angle"),
        (["limits", "kr6r900", "--axis", "A3"], 2, "--axis and --over must be given together"),
        (["limits", "kr6r900", "--axis", "A3", "--over", "B"], 1, "no axis 'B'"),
        (["limits", "parallelogram_nr", "--at", "0,0,0,0,0,0"], 2, "--at requires --axis and --over"),
        (["limits", "parallelogram_nr", "--steps", "0"], 1, "at least 2 values"),
        (["limits", "kr6r900", "--axis", "A3", "--over", "A2", "--steps", "0"], 2, "--steps"),
        (["workspace", "kr6r900", "--cells", "1"], 1, "1 cells per side"),
        (["workspace", "kr6r900", "--over", "A1"], 1, "two different axes"),
        (["workspace", "kr6r900", "--at", NEAR_WRIST], 2, "--at requires --over"),
        (["workspace", "kr6r900", "--workers", "0"], 2, "--workers"),
        (["workspace", "kr6r900", "--samples", "10", "-o", "no/map.npz"], 1, "no/map.npz"),
    ],
)
def test_what_is_refused(run: Run, words: list[str], code: int, message: str) -> None:
    outcome = run(*words)
    assert (outcome.code, outcome.out) == (code, "")
    assert message in outcome.err
