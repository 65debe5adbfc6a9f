"""Whole millimetres and degrees where a list counts 1e-4 of them, and heads that hardly tilt."""

from __future__ import annotations

import pytest

from chainbuild.errors import ChainbuildError
from chainbuild.findings import Collector, Finding
from chainbuild.formats.twincat.lists.axislist import read_axis_list
from tests.kit.twincat_files import codes, kin_45, machine, parameters

ARMS = {8: 4550000.0, 9: 4200000.0}
UNITS = ("CB440", "CB441", "CB442", "CB510", "CB511")


def found(text: str) -> list[Finding]:
    return [finding for finding in machine(text).chain().findings if finding.code in UNITS]


# ---------------------------------------------------------------- lengths


def test_whole_millimetres_of_a_head() -> None:
    (finding,) = found("trafo[0].id 9\ntrafo[0].param[0] 245\ntrafo[0].param[1] -12\n")
    assert (finding.code, finding.severity, finding.parameter) == ("CB440", "warning", "trafo[0].param[0]")
    assert finding.text == (
        "all lengths of kinematic 9 are below 0.1 mm, the largest: trafo[0].param[0] = 245 is 0.0245 mm; "
        "counts are 1e-4 mm"
    )
    assert finding.hint == "245 mm would be 2450000"
    assert finding.span is not None
    assert finding.span.line == 2


@pytest.mark.parametrize(
    "text",
    [
        "trafo[0].id 9\ntrafo[0].param[0] 1000\ntrafo[0].param[1] 12",  # 0.1 mm: a measured machine
        "trafo[0].id 9\ntrafo[0].param[0] -2450000\ntrafo[0].param[1] 245",
        "trafo[0].id 9\ntrafo[0].param[0] 0",
        "trafo[0].id 9",
        "trafo[0].id 9\nwz[1].kinematic.param[0] 12",  # a correction on top of the list's lengths
    ],
)
def test_lengths_that_leave_no_doubt(text: str) -> None:
    assert found(text) == []


def test_lengths_that_have_a_doubt_of_their_own_are_told_once() -> None:
    assert [finding.code for finding in found("trafo[0].id 9\ntrafo[0].param[0] 245.0")] == ["CB510"]
    assert [finding.code for finding in found("trafo[0].id 9\ntrafo[0].param[0] 245 mm")] == ["CB511"]


def test_points_of_a_universal_kinematic() -> None:
    axes = "".join(
        f"trafo[0].axis[{n}].type {kind}\ntrafo[0].axis[{n}].orientation[{n % 3}] 1\ntrafo[0].chain[{n}] {n}\n"
        for n, kind in enumerate((1, 1, 1, 2))
    )
    text = f"trafo[0].id 91\ntrafo[0].number_of_axes 4\ntrafo[0].zero_orientation[2] 1\n{axes}"
    (finding,) = [one for one in found(f"{text}trafo[0].axis[3].point[2] 300\n") if one.code == "CB440"]
    assert "0.03 mm" in finding.text
    assert found(f"{text}trafo[0].axis[3].point[2] 3000000\n") == []


@pytest.mark.parametrize(("line", "shown"), [("laenge 120", "0.012 mm"), ("radius 5", "0.0005 mm")])
def test_length_and_radius_of_a_tool(line: str, shown: str) -> None:
    (finding,) = [one for one in machine(f"trafo[0].id 9\nwz[2].{line}\n").findings if one.code == "CB440"]
    assert "length and radius of tool 2 are below 0.1 mm" in finding.text
    assert shown in finding.text
    assert "CB440" not in codes(machine(f"trafo[0].id 9\nwz[2].laenge 1200000\nwz[2].{line.replace('laenge', 'nr')}\n"))


@pytest.mark.parametrize(("lower", "upper", "expected"), [(-170, 170, 1), (0, 1700000, 0), (-170.5, 170.5, 0)])
def test_software_limits(lower: float, upper: float, expected: int) -> None:
    text = f"kopf.log_achs_name A\nkenngr.swe_neg {lower}\nkenngr.swe_pos {upper}"
    collector = Collector()
    read_axis_list(parameters(text), {}, collector)
    doubts = [one for one in collector.findings if one.code == "CB440"]
    assert ["the software limits of axis A are below 0.1 mm or deg" in one.text for one in doubts] == [True] * expected


# ---------------------------------------------------------------- angles


@pytest.mark.parametrize("count", [15, -30, 45, 90, -180, 270, 360])
def test_whole_degrees(count: int) -> None:
    (finding,) = found(kin_45({**ARMS, 14: count}))
    assert (finding.code, finding.severity, finding.parameter) == ("CB441", "warning", "trafo[0].param[13]")
    assert f"looks like whole degrees: {count} is {count / 10000:g} deg" in finding.text
    assert finding.hint == f"{count} deg would be {count}0000"


@pytest.mark.parametrize("count", [14, 900000, 0, 91, 450])
def test_angles_that_leave_no_doubt(count: int) -> None:
    assert found(kin_45({**ARMS, 14: count})) == []


# ---------------------------------------------------------------- heads


def head(kin: int, tilt: float, machine_angles: int) -> str:
    values = {0: 2000000, 6: tilt, 20: machine_angles}
    return "\n".join([f"trafo[0].id {kin}", *(f"trafo[0].param[{k}] {value:.10g}" for k, value in values.items())])


@pytest.mark.parametrize("kin", [59, 60])
@pytest.mark.parametrize(
    ("tilt", "angles", "meant"),
    [
        (45, 0, "45 degrees would be 450000"),
        (45, 1, "45 degrees would be 450000"),
        (0, 1, "45 degrees would be 450000"),
        (1795000, 1, "45 degrees would be 450000"),
        (30, 0, "30 degrees would be 300000"),
    ],
)
def test_a_head_that_hardly_tilts(kin: int, tilt: float, angles: int, meant: str) -> None:
    (finding,) = found(head(kin, tilt, angles))
    assert (finding.code, finding.severity, finding.parameter) == ("CB442", "warning", "HD7 tilt_angle")
    assert f"HD7 = {tilt / 10000:g} degrees the head can hardly tilt the tool" in finding.text
    assert meant in str(finding.hint)


@pytest.mark.parametrize("kin", [59, 60])
def test_a_head_that_tilts(kin: int) -> None:
    assert found(head(kin, 450000, 0)) == []
    assert found(head(kin, 10001, 0)) == []
    with pytest.raises(ChainbuildError, match="cannot tilt"):
        machine(head(kin, 0, 0)).chain()
    lenient = machine(head(kin, 0, 0), strict=False)
    assert "CB442" not in codes(lenient)


@pytest.mark.parametrize(("kin", "hd"), [(11, 3), (33, 3), (76, 7)])
def test_other_oblique_heads(kin: int, hd: int) -> None:
    text = f"trafo[0].id {kin}\ntrafo[0].param[0] 2000000\ntrafo[0].param[{hd - 1}] "
    assert [one.code for one in found(f"{text}45")] == ["CB442"]
    assert found(f"{text}450000") == []
