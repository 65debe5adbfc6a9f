"""Which findings a command tells: those that need something done; remarks are for `check` and `info`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import chainbuild
from chainbuild.convention import conventions
from chainbuild.errors import MachineDataError, Span
from chainbuild.findings import Finding, finding_kinds, once, still_true
from chainbuild.machines import shipped_path
from tests.kit.command_line import Run, write

AT = "0,-90,90,0,30,0"


@pytest.fixture
def elbow_file(run: Run) -> str:
    """Return the name of a parallelogram arm whose limits, as the manual prints them, do not watch the elbow."""
    text = shipped_path("parallelogram_nr").read_text("utf-8")
    line = next(line for line in text.splitlines() if "AXES_DIR[2]" in line)
    return str(
        write("arm.tea", text.replace(line, "$MC_ROBX_AXES_DIR[2]=1" if "-1" in line else "$MC_ROBX_AXES_DIR[2]=-1"))
    )


def test_the_register_is_consistent() -> None:
    for kind in finding_kinds().values():
        assert kind.told in ("named", "counted", "listed")
        assert kind.severity != "error" or kind.told == "counted"
        assert kind.convention in (None, "parameter", *conventions())
        assert kind.includes is None or kind.includes in finding_kinds()


def test_angles_as_the_maker_has_them_are_told_by_check_and_info_alone(run: Run) -> None:
    for words in (["fk", "kr6r900", "--at", AT], ["urdf", "kr6r900"], ["collide", "kr6r900", "--at", AT]):
        assert run(*words).err == "", words
    for words in (["check", "kr6r900"], ["info", "kr6r900"]):
        assert "CB307 warning" in run(*words).out


def test_a_finding_goes_with_the_convention_that_settles_it(run: Run, elbow_file: str) -> None:
    assert "CB322 warning" in run("check", elbow_file).out
    assert "(warning)" in run("urdf", elbow_file).err
    settled = ["--convention", "parallelogram_monitor=elbow"]
    for command in ("check", "info"):
        assert "CB322" not in run(command, elbow_file, *settled).out
    assert run("urdf", elbow_file, *settled).err == ""
    Path("arm.chainbuild.toml").write_text("[conventions]\nparallelogram_monitor = 'elbow'\n", "utf-8")
    assert "CB322" not in run("check", elbow_file).out


def test_a_convention_that_keeps_the_printed_angle_keeps_the_finding(run: Run, elbow_file: str) -> None:
    for command in ("check", "info"):
        assert "CB322" in run(command, elbow_file, "--convention", "parallelogram_monitor=mcs").out


def test_a_chosen_sense_of_a_table_is_no_longer_open(run: Run) -> None:
    assert "CB465 info" in run("check", "ac_table_kin58").out
    assert "CB465" not in run("check", "ac_table_kin58", "--convention", "table_rotary_sense=left_handed").out


def test_an_unknown_type_is_one_message(run: Run) -> None:
    write("k87.lis", "trafo[0].id 87\ntrafo[0].type 87\n")
    told = "KIN_TYP 87 is unknown"
    checked = run("check", "k87.lis")
    assert (checked.code, checked.out.count(told)) == (1, 1)
    assert "CB410 error" in checked.out
    shown = run("info", "k87.lis")
    assert shown.code == 1
    assert (shown.out + shown.err).count(told) == 1
    (finding,) = json.loads(run("check", "k87.lis", "--json").out)["findings"]
    assert finding["code"] == "CB410"
    data = json.loads(run("info", "k87.lis", "--json").out)
    assert (data["findings"], data["error"]["code"]) == ([], "CB410")


def test_an_unknown_type_beside_the_default_is_still_a_warning(run: Run) -> None:
    write("cell.lis", "trafo[0].id 9\ntrafo[1].id 87\ntrafo[1].type 87\n")
    assert [one.code for one in chainbuild.check("cell.lis") if one.severity == "warning"] == ["CB223"]


def test_what_includes_another_does_so_at_the_same_place_only() -> None:
    here, there = Span("f", 1), Span("f", 2)
    short, far = Finding("CB223", "warning", "a", here), Finding("CB223", "warning", "a", there)
    long = Finding("CB410", "error", "a", here)
    assert once([short, far, short, long]) == (far, long)
    assert once([short, far], MachineDataError("a", span=here, code="CB410")) == (far,)
    assert once([short, far], MachineDataError("a", span=here)) == (short, far)


def test_a_missing_choice_is_settled_by_its_own_convention() -> None:
    guide = Finding("CB438", "error", "choose", parameter="kin19_guide")
    assert still_true([guide], ["kin19_azimuth"]) == (guide,)
    assert still_true([guide], ["kin19_guide"]) == ()
