"""info, check, types, urdf, inspect, demo: what they print, and what programs may read."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

import chainbuild
from chainbuild.convention import conventions
from chainbuild.findings import finding_kinds
from chainbuild.machines import shipped_path
from tests.kit.command_line import ARM, Run
from tests.kit.paths import REFERENCE


def test_info_shows_what_was_read(run: Run) -> None:
    outcome = run("info", "kr6r900_2")
    assert outcome.code == 0
    for words in ("TwinCAT CNC", "KIN_TYP 45", "HD8", "455", "KIN_TYP manual 3.3", "C1", "-170", "360 deg/s", "Rz(C)"):
        assert words in outcome.out
    assert "--defaults shows them" in outcome.out
    assert "default" in run("info", "kr6r900_2", "--defaults").out


def test_info_is_readable_in_80_columns(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    for name in ("kr6r900", "kr6r900_2", "irb2600_track", "scara_cc"):
        lines = run("info", name).out.splitlines()
        tables = lines[3 : lines.index("Findings") if "Findings" in lines else None]
        assert max(map(len, tables)) <= 80
        text = " ".join(" ".join(tables).split())
        assert "manual" not in text.partition("Conventions")[0]  # the source only where there is room
        assert "Limits from" in text
    assert "transformation in data" in " ".join(run("info", "kr6r900").out.split())
    assert "joint 2: swings" in run("info", "kr6r900_2").out


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ("", "ANGLE; a vector is the tool's X, angle A kept (FIXED_AX_IDX=3)"),
        (
            "ori_rotation_angle 2\nori.mode VECTOR_IJK",
            "VECTOR_IJK; a vector is the tool's X, angle C kept (FIXED_AX_IDX=5)",
        ),
        ("ori.tool_ax_in_plane 1", "ANGLE; a vector is the tool's X, tool Z perpendicular to Y (TOOL_AX_IN_PLANE=1)"),
    ],
)
def test_info_says_what_a_programmed_vector_means(run: Run, tmp_path: Path, lines: str, said: str) -> None:
    path = tmp_path / "arm.lis"
    path.write_text(f"trafo[0].id 45\n{lines}\n")
    assert f"Vectors (#ORI MODE): {said}" in " ".join(run("info", str(path)).out.split())
    assert "Vectors" not in run("info", "kr6r900").out


def test_info_says_how_to_choose_and_where_limits_come_from(run: Run) -> None:
    out = run("info", "kr6r900").out
    assert re.search(r"^ 1 +ROBX .* default *$", out, re.MULTILINE)
    assert re.search(r"^ +gripper .* --kinematic gripper *$", out, re.MULTILINE)
    text = shipped_path("irb2600").read_text("utf-8")
    limits = "$MA_POS_LIMIT_MINUS[AX2]=-90\n$MA_POS_LIMIT_PLUS[AX2]=90\n"
    Path("arm.tea").write_text(text.replace("M17", f"{limits}M17"), "utf-8")
    Path("arm.chainbuild.toml").write_text("[limits]\nA1 = [-10, 10]\n", "utf-8")
    axes = json.loads(run("info", "arm.tea", "--json").out)["axes"]
    assert [axis["limits_from"] for axis in axes[:3]] == ["overlay", "machine data", "assumed"]


def test_info_of_arrays_is_one_row_each(run: Run) -> None:
    out = run("info", "kr6r900").out
    assert "$MC_ROBX_TX3P3_POS[0…2]" in out
    assert "420, 0, 35" in out


def test_info_for_programs(run: Run) -> None:
    data = json.loads(run("info", "kr6r900_2", "--json").out)
    assert data["vectors"] == {"mode": "angle", "fixed": None, "plane": 0, "axis": "x"}
    chain = chainbuild.load("kr6r900_2").chain()
    assert [axis["name"] for axis in data["axes"]] == [axis.name for axis in chain.axes]
    assert data["axes"][1]["lower"] == -190.0
    assert data["kinematic"] == "KIN_TYP 45"
    upper_arm = next(row for row in data["parameters"] if row["symbol"] == "HD8")
    assert (upper_arm["value"], upper_arm["unit"], upper_arm["given"]) == (455, "mm", True)
    assert upper_arm["line"] > 0
    assert {"kinematics", "conventions", "findings", "dialect", "title"} <= set(data)


def test_info_of_a_machine_that_uses_conventions(run: Run) -> None:
    machine = REFERENCE / "kin58_trt_2.lis"
    used = chainbuild.load(machine).chain().conventions
    assert used
    name = used[0].convention.name
    other = next(choice for choice in used[0].convention.choices if choice != used[0].choice)
    out = run("info", machine).out
    assert name in out
    assert "(default)" in out
    data = json.loads(run("info", machine, "--json", "--convention", f"{name}={other}").out)
    chosen = next(row for row in data["conventions"] if row["name"] == name)
    assert (chosen["choice"], chosen["by_user"]) == (other, True)
    assert chosen["verify"] == conventions()[name].verify


def test_info_of_an_unsupported_kinematic_shows_it_and_refuses(run: Run) -> None:
    Path("tubes.lis").write_text("trafo[0].id 15\ntrafo[0].param[0] 1000000\nEnde\n", "utf-8")
    outcome = run("info", "tubes.lis")
    assert outcome.code == 1
    assert "KIN_TYP 15" in outcome.out
    assert outcome.err.startswith("tubes.lis:1: KIN_TYP 15")
    data = json.loads(run("info", "tubes.lis", "--json").out)
    assert data["axes"] == []


def test_check_accepts_and_refuses(run: Run) -> None:
    accepted = run("check", "kr6r900_2")
    assert accepted.code == 0
    assert accepted.out.endswith("accepted, no findings\n")
    Path("bad.lis").write_text("trafo[0].id 45\ntrafo[0].param[6] 1,5\nEnde\n", "utf-8")
    refused = run("check", "bad.lis")
    assert refused.code == 1
    assert "bad.lis:2: CB" in refused.out
    assert refused.out.splitlines()[-1].startswith("bad.lis: refused (1 error")


def test_check_for_programs(run: Run) -> None:
    Path("bad.lis").write_text("trafo[0].id 45\ntrafo[0].param[6] 1,5\nEnde\n", "utf-8")
    outcome = run("check", "bad.lis", "--json")
    data = json.loads(outcome.out)
    assert (outcome.code, data["refused"]) == (1, True)
    finding = next(row for row in data["findings"] if row["severity"] == "error")
    assert (finding["line"], finding["file"]) == (2, "bad.lis")


def test_check_looks_at_the_selection(run: Run) -> None:
    outcome = run("check", ARM, "--kinematic", "7")
    assert outcome.code == 1
    assert "no kinematic '7'" in outcome.out


def test_check_prints_warnings_and_ends_with_0(run: Run) -> None:
    outcome = run("check", "kr6r900")
    assert outcome.code == 0
    assert "CB307 warning" in outcome.out
    assert "accepted (1 warning)" in outcome.out


def test_types_lists_the_catalogue(run: Run) -> None:
    out = run("types").out
    data = json.loads(run("types", "--json").out)
    assert [entry["kin_typ"] for entry in data] == list(chainbuild.catalogue())
    for number, title in ((91, "Universal kinematic"), (210, "Coupling kinematic")):
        assert re.search(rf"^ {number} +{title} ", out, re.MULTILINE)
        assert next(entry for entry in data if entry["kin_typ"] == number)["parameters"] == []
    assert "Six-axis articulated robot" in out
    arm = next(entry for entry in data if entry["kin_typ"] == 45)
    assert [axis["name"] for axis in arm["axes"]] == ["C1", "B1", "B2", "A1", "B3", "A2"]
    assert arm["parameters"]


def test_types_shows_one_type(run: Run) -> None:
    out = " ".join(run("types", "45").out.split())
    for words in ("joint 1: turns the whole arm about Z", "b1_to_b2_z", "Upper arm", "kin45_length_frame="):
        assert words in out
    entry = json.loads(run("types", "45", "--json").out)
    assert (entry["kin_typ"], entry["parameters"][0]["name"], entry["parameters"][0]["unit"]) == (45, "tool_z", "mm")
    assert json.loads(run("types", "210", "--json").out)["title"] == "Coupling kinematic"
    refused = run("types", "46")
    assert (refused.code, refused.err.startswith("chainbuild: KIN_TYP 46 is unknown")) == (1, True)


def test_urdf_writes_and_tells(run: Run) -> None:
    outcome = run("urdf", ARM)
    path = Path("urdf_out/kin45_kr6r900_2/kin45_kr6r900_2.urdf")
    assert outcome.code == 0
    assert outcome.out.splitlines()[0] == str(path)
    assert "not expressed: the limits of axes C1, B1, B2, A1, B3, A2 are assumed" in outcome.out
    assert path.is_file()
    data = json.loads(run("urdf", ARM, "--output", "other", "--json").out)
    assert Path(data["path"]).read_bytes() == path.read_bytes()
    assert data["path"] == "other/kin45_kr6r900_2/kin45_kr6r900_2.urdf"
    assert any("assumed" in line for line in data["not_expressed"])


def test_inspect_writes_a_page(run: Run) -> None:
    outcome = run("inspect", "kr6r900_2", "--export", "page.html")
    assert (outcome.code, outcome.out) == (0, "page.html\n")
    assert Path("page.html").read_text("utf-8").lstrip().lower().startswith("<!doctype html>")


def test_demo_builds_every_shipped_machine(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    outcome = run("demo")
    assert (outcome.code, outcome.err) == (0, "")
    for name in chainbuild.shipped():
        assert f" {name} " in outcome.out, f"{name} is broken"
        assert Path(f"urdf_out/{name}/{name}.urdf").is_file()
    assert f"{len(chainbuild.shipped())} robots written: urdf_out/NAME/NAME.urdf, NAME.xml, …\n" in outcome.out
    (line,) = (line for line in outcome.out.splitlines() if "(warnings) in " in line)
    named = line.partition("(warnings) in ")[2].partition("; chainbuild check NAME lists them")[0].split(", ")
    warned = {
        name: sum(finding_kinds()[one.code].told != "listed" for one in chainbuild.check(name))
        for name in chainbuild.shipped()
    }
    assert set(named) == {name for name, count in warned.items() if count}
    assert "chainbuild inspect kr6r900 --export page.html" in outcome.out


def test_demo_of_one_machine(run: Run) -> None:
    outcome = run("demo", "tx2_60", "-o", "out")
    assert outcome.code == 0
    assert [path.name for path in Path("out").iterdir()] == ["tx2_60"]


def test_a_convention_that_changes_nothing_is_told(run: Run) -> None:
    outcome = run("fk", "ac_table_kin58", "--at", "0,0,0,0,0", "--convention", "cc_rotary_sign=minus")
    assert outcome.code == 0
    assert outcome.err == "--convention cc_rotary_sign has no effect: KIN_TYP 58 uses table_rotary_sense\n"
    used = run("fk", "ac_table_kin58", "--at", "0,0,0,0,0", "--convention", "table_rotary_sense=left_handed")
    assert used.err == ""


def test_warnings_are_one_line_on_stderr_and_leave_stdout_to_the_result(run: Run) -> None:
    outcome = run("urdf", "robot_head_kin210", "--json")
    assert outcome.code == 0
    json.loads(outcome.out)
    assert outcome.err == "1 finding (warning): chainbuild check robot_head_kin210\n"
    assert run("urdf", "irb2600").err == ""
    other = run("urdf", "robot_head_kin210", "--tool-length", "5", "--kinematic", "210")
    assert other.err.endswith(": chainbuild check robot_head_kin210 --kinematic 210 --tool-length 5\n")


def test_what_was_chosen_among_several_is_told_in_full(run: Run) -> None:
    text = shipped_path("irb2600").read_text("utf-8")
    tools = "$TC_DP3[1,1]=10\n$TC_DP3[2,1]=20\n"
    Path("two.tea").write_text(text.replace("M17", f"{tools}M17"), "utf-8")
    outcome = run("urdf", "two.tea")
    assert outcome.code == 0
    assert outcome.err.startswith("two.tea: CB337 warning: the file holds 2 cutting edges; none is active")
    assert len(outcome.err.splitlines()) == 1


def test_a_named_overlay_is_used(run: Run) -> None:
    Path("my.toml").write_text('name = "My arm"\n[limits]\nC1 = [-1, 2]\n', "utf-8")
    data = json.loads(run("info", ARM, "--json", "--overlay", "my.toml").out)
    assert data["title"] == "My arm"
    assert (data["axes"][0]["lower"], data["axes"][0]["assumed"]) == (-1.0, False)


@pytest.mark.parametrize("command", ["info", "check", "fk", "ik", "urdf", "inspect", "demo"])
def test_brackets_in_files_are_no_markup(run: Run, command: str) -> None:
    extra = {"fk": ["--axes", "a.csv"], "ik": ["--poses", "a.csv"], "inspect": ["--export", "p.html"]}
    Path("[red]x[.lis").write_text("trafo[0].id 45\ntrafo[0].param[6] [bold]\nEnde\n", "utf-8")
    outcome = run(command, "[red]x[.lis", *extra.get(command, []))
    assert outcome.code == 1
    assert "[red]x[.lis:2: " in outcome.out + outcome.err
