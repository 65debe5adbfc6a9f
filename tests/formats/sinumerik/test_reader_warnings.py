"""Machine data that would be dropped in silence: numbers without names, the other package's data, axes twice."""

from __future__ import annotations

import itertools

import pytest

from chainbuild.findings import Collector, Finding
from chainbuild.formats.sinumerik.reading.reader import read_assignments
from chainbuild.formats.text import SourceText
from chainbuild.robot import Robot
from tests.kit.robx_files import NR6, read, robx_text


def with_code(code: str, extra: str, axes_in: tuple[int, ...] | None = None) -> list[Finding]:
    machine = read(robx_text(NR6, extra=extra, axes_in=axes_in))
    return [finding for finding in machine.findings if finding.code == code]


@pytest.mark.parametrize(
    "line", ["62910 $MC_ROBX_TFLWP_POS[2] 90", "62910 $MC_ROBX_TFLWP_POS[2]=90", "\t62910\t\\$MC_ROBX_TFLWP_POS[2] 90"]
)
def test_a_bare_number_before_the_name(line: str) -> None:
    collector = Collector()
    (row,) = read_assignments(SourceText("a.tea", line, "utf-8"), collector).assignments
    assert (row.datum.name, row.index, row.value, collector.findings) == ("ROBX_TFLWP_POS", 2, 90.0, [])
    assert line[row.span.column - 1 :] == "90"


def test_a_bare_number_of_another_datum() -> None:
    (finding,) = with_code("CB109", "62911 $MC_ROBX_TFLWP_POS[2] 90")
    assert "62911 is not the number of MD62910 $MC_ROBX_TFLWP_POS; the name is used" in finding.text


@pytest.mark.parametrize("line", ["N62910 [2]=90", "62910 [2]=90", "N62910=90", "62610[2] = 90"])
def test_a_number_without_a_name(line: str) -> None:
    (finding,) = with_code("CB116", line)
    assert finding.severity == "warning"
    assert "TFLWP_POS" in finding.text
    assert finding.span is not None
    assert finding.span.text == line


@pytest.mark.parametrize("line", ["N62910", "N62910 G0 X10", "N10 [2]=90", "100 [2]=90", "N62910 M30"])
def test_block_numbers_leave_no_finding(line: str) -> None:
    assert with_code("CB116", line) == []


def test_data_of_the_other_package() -> None:
    te4 = robx_text(NR6, package="TRAFO6", extra="$MC_ROBX_TFLWP_POS[2]=90\n$MC_ROBX_TFLWP_POS[1]=1")
    (finding,) = [f for f in read(te4).findings if f.code == "CB343"]
    assert finding.severity == "warning"
    assert "reads $MC_TRAFO6_… only: $MC_ROBX_TFLWP_POS[2] and 1 more ignored" in finding.text
    assert finding.span is not None
    assert finding.span.text == "$MC_ROBX_TFLWP_POS[2]=90"
    (finding,) = with_code("CB343", "$MC_TRAFO6_TFLWP_POS[2]=90")
    assert "reads $MC_ROBX_… only: $MC_TRAFO6_TFLWP_POS[2] ignored" in finding.text
    assert with_code("CB343", "") == []


LIMITS = "$MA_POS_LIMIT_MINUS[{}]=-100\n$MA_POS_LIMIT_PLUS[{}]=100\n"


def test_limits_under_both_names_of_an_axis() -> None:
    extra = '$MN_AXCONF_MACHAX_NAME_TAB[0]="TURN"\n' + LIMITS.format("AX1", "AX1") + "$MA_POS_LIMIT_MINUS[TURN]=-50"
    (finding,) = with_code("CB113", extra)
    assert "$MA_POS_LIMIT_MINUS[AX1] in line" in finding.text
    assert "$MA_POS_LIMIT_MINUS[TURN] are the same axis; the last value is used" in finding.text
    axes = read(robx_text(NR6, extra=extra)).chain().axes
    assert (axes[0].lower, axes[0].upper) == (-50.0, 100.0)
    once = '$MN_AXCONF_MACHAX_NAME_TAB[0]="TURN"\n' + LIMITS.format("TURN", "AX1")
    assert with_code("CB113", once) == []


@pytest.mark.parametrize("second", [-10, -20])
@pytest.mark.parametrize("names", list(itertools.permutations(("AX1", "TURN", "CHAN"))))
def test_of_three_names_of_an_axis_the_last_line_counts(names: tuple[str, str, str], second: int) -> None:
    """AX1, the machine axis' name and the channel's, in every order: by lines, not by kinds of names."""
    named = '$MN_AXCONF_MACHAX_NAME_TAB[0]="TURN"\n$MC_AXCONF_CHANAX_NAME_TAB[0]="CHAN"\n'
    lines = [f"$MA_POS_LIMIT_MINUS[{name}]={value}" for name, value in zip(names, (-10, second, -30), strict=True)]
    text = robx_text(NR6, extra=f"{named}$MA_POS_LIMIT_PLUS[AX1]=100\n" + "\n".join(lines))
    (finding,) = [f for f in read(text).findings if f.code == "CB113"]
    first = text.splitlines().index(lines[0]) + 1
    assert finding.text.startswith(f"$MA_POS_LIMIT_MINUS[{names[0]}] in line {first} and ")
    assert f"and $MA_POS_LIMIT_MINUS[{names[2]}] are the same axis" in finding.text
    assert finding.parameter == f"$MA_POS_LIMIT_MINUS[{names[2]}]"
    assert finding.span is not None
    assert finding.span.text == lines[2]
    assert (read(text).chain().axes[0].lower, read(text).chain().axes[0].upper) == (-30.0, 100.0)


def test_a_channel_axis_without_machine_axis() -> None:
    (finding,) = with_code("CB344", "$MC_AXCONF_MACHAX_USED[2]=0\n" + LIMITS.format("AX3", "AX3"))
    assert "channel axis 3, which has no machine axis" in finding.text
    assert finding.span is not None
    assert finding.span.text == "$MC_AXCONF_MACHAX_USED[2]=0"
    assert with_code("CB344", "$MC_AXCONF_MACHAX_USED[2]=3\n$MC_AXCONF_MACHAX_USED[8]=0") == []


def test_a_channel_axis_beyond_the_most() -> None:
    (finding,) = with_code("CB344", "", axes_in=(1, 2, 3, 4, 5, 31))
    assert "names channel axis 31; a channel has at most 20" in finding.text
    assert with_code("CB344", "", axes_in=(1, 2, 3, 4, 5, 20)) == []


@pytest.mark.parametrize("angles", [(90, 90), (-90, -90)])
@pytest.mark.parametrize("wrist", [2, 5])
def test_a_wrist_whose_angles_are_not_opposite(angles: tuple[float, float], wrist: int) -> None:
    machine = read(robx_text({**NR6, "WRIST_AXES": wrist, "DHPAR4_5ALPHA": angles}))
    found = {finding.code: finding for finding in machine.findings}
    assert found["CB345"].severity == "warning"
    assert f"({angles[0]}, {angles[1]})" in found["CB345"].text
    assert "CB307" not in found
    Robot(machine.chain())


@pytest.mark.parametrize("angles", [(90, -90), (-90, 90)])
def test_opposite_angles_leave_no_such_finding(angles: tuple[float, float]) -> None:
    machine = read(robx_text({**NR6, "DHPAR4_5ALPHA": angles}))
    assert "CB345" not in {finding.code for finding in machine.findings}


def test_limits_the_wrong_way_round_are_refused() -> None:
    machine = read(robx_text(NR6, extra="$MA_POS_LIMIT_MINUS[AX1]=5\n$MA_POS_LIMIT_PLUS[AX1]=-5"), strict=False)
    assert [finding.code for finding in machine.findings if finding.severity == "error"] == ["CB114"]


def test_of_three_names_of_an_axis_the_one_between_may_be_the_other() -> None:
    named = '$MN_AXCONF_MACHAX_NAME_TAB[0]="TURN"\n$MC_AXCONF_CHANAX_NAME_TAB[0]="CHAN"\n$MA_POS_LIMIT_PLUS[AX1]=100\n'
    lines = "\n".join(
        f"$MA_POS_LIMIT_MINUS[{name}]={value}" for name, value in (("AX1", -30), ("TURN", -10), ("CHAN", -30))
    )
    (finding,) = with_code("CB113", named + lines)
    assert "$MA_POS_LIMIT_MINUS[TURN] in line" in finding.text
    assert "$MA_POS_LIMIT_MINUS[CHAN] are the same axis" in finding.text
