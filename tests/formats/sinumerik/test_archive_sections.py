"""Archives of a whole control: programs, tool areas, repeated values, notations of the manual, defaults, inches."""

from __future__ import annotations

import numpy as np
import pytest

from chainbuild.errors import ChainbuildError, UnsupportedKinematicError
from chainbuild.findings import Finding
from chainbuild.formats.load import load
from chainbuild.formats.sinumerik.machine import RobxMachine
from tests.kit.robx_files import CC4, NR6, T, close, pose_of, read, robx_text

AXES = (31, -47, 53, 71, -37, 113)
PLAIN = pose_of(read(robx_text(NR6)).chain(), AXES)


def found(machine: RobxMachine, code: str) -> list[Finding]:
    return [finding for finding in machine.findings if finding.code == code]


# ---------------------------------------------------------------- sections

PROGRAM = "N10 $MC_ROBX_TIRORO_POS[2]=999\nR10\n$MC_ROBX_TIRORO_POS[2]=R10\nCHANDATA(7)\nM30"


@pytest.mark.parametrize(
    "header", ["%_N_PART_7_MPF", "%_N_SUB_SPF", "%_N_CYCLE832_CYC", "%_N_SMAC_DEF", "%_N_CH1_SUB_SPF", "%100", "%MPF12"]
)
def test_nothing_in_a_program_is_data(header):
    machine = read(f"%_N_CH1_TEA\n{robx_text(NR6)}\n{header}\n;$PATH=/_N_MPF_DIR\n{PROGRAM}\n")
    assert close(pose_of(machine.chain(), AXES), PLAIN)
    (finding,) = found(machine, "CB120")
    assert finding.severity == "info"
    assert finding.text == (
        f"programs are not read: 1, the first is {header}; lines of them that name data of the transformation: 2"
    )
    assert finding.span.text == header
    assert machine.table.reading.channels == (1,)


@pytest.mark.parametrize("kind", ["CH1_TEA", "INITIAL_INI", "CH1_SEA", "CH1_UFR", "TO1_TOA", "CH1_TEA2"])
def test_data_go_on_behind_a_program(kind):
    text = f"%_N_A_MPF\n{PROGRAM}\n%_N_B_SPF\nM17\n%_N_{kind}\n{robx_text(NR6)}"
    machine = read(text)
    assert close(pose_of(machine.chain(), AXES), PLAIN)
    assert found(machine, "CB120")[0].text.startswith("programs are not read: 2, the first is %_N_A_MPF")


def test_a_section_of_unknown_kind_with_data_is_told():
    machine = read(f"{robx_text(NR6)}\n%_N_OLD_BAK\n$MC_ROBX_TIRORO_POS[2]=999\n%_N_CEC\n$AN_CEC[0]=1")
    assert close(pose_of(machine.chain(), AXES), PLAIN)
    (finding,) = found(machine, "CB121")
    assert "%_N_OLD_BAK is not read; lines with data of the transformation: 1" in finding.text
    assert (finding.severity, finding.span.text) == ("warning", "%_N_OLD_BAK")


# ---------------------------------------------------------------- values


@pytest.mark.parametrize(
    ("lines", "expected"),
    [
        ("$MC_ROBX_MAMES=REP(5)", (5, 5, 5, 5, 5, 5)),
        ("$MC_ROBX_MAMES[2]=REP(5)", (0, 0, 5, 5, 5, 5)),
        ("$MC_ROBX_MAMES[1]=rep(-5.5, 2) '2f", (0, -5.5, -5.5, 0, 0, 0)),
        ("$MC_ROBX_MAMES=SET(1,2)\n$MC_ROBX_MAMES[1]=REP(3)", (1, 3, 3, 3, 3, 3)),
        ("$MC_ROBX_MAMES=[1, -2, 3]", (1, -2, 3, 0, 0, 0)),
        ("MD62917 ROBX_MAMES [1.5, 2., 3]", (1.5, 2, 3, 0, 0, 0)),
    ],
)
def test_several_elements_in_a_line(lines, expected):
    assert read(robx_text(NR6, extra=lines)).transformation().mames == expected


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("$MC_ROBX_MAMES=REP(1,7)", "outside the dimension"),
        ("$MC_ROBX_MAMES[5]=REP(1,2)", "outside the dimension"),
        ("$MC_ROBX_MAMES=REP(1,0)", "no repetition"),
        ("$MC_ROBX_MAMES=REP(1,2,3)", "no repetition"),
        ("$MC_ROBX_MAMES=REP()", "value is missing"),
        ("$MC_ROBX_MAMES=[1,2,3,4,5,6,7]", "outside the dimension"),
        ("$MC_ROBX_MAMES=[1,R2]", "not a number"),
        ("$MA_POS_LIMIT_MINUS=REP(1)", "not axes or tools"),
    ],
)
def test_several_elements_refused(line, words):
    with pytest.raises(ChainbuildError, match=words):
        read(robx_text(NR6, extra=line))


def test_notations_of_the_manual_are_told_once():
    lines = "\n".join(f"$MC_ROBX_AXIS_SEQ[{n}]={axis}" for n, axis in {0: 2, 1: 1, 2: 3, 23: 4}.items())
    machine = read(robx_text(CC4, extra=f"{lines}\n$MC_ROBX_SPECIAL_FEATURE_MASK.Bit 0 = 1"))
    robx = machine.transformation()
    assert (robx.axis_seq[:4], robx.feature_mask) == ((2, 1, 3, 4), 1)
    (finding,) = found(machine, "CB122")
    assert finding.severity == "warning"
    assert finding.text.endswith(": 2")
    assert finding.span.text == "$MC_ROBX_AXIS_SEQ[23]=4"


@pytest.mark.parametrize(
    ("lines", "mask"),
    [
        ("$MC_ROBX_SPECIAL_FEATURE_MASK='H3'\n$MC_ROBX_SPECIAL_FEATURE_MASK.bit 0 == FALSE", 2),
        ("$MC_ROBX_SPECIAL_FEATURE_MASK='H2'\nMD62953 $MC_ROBX_SPECIAL_FEATURE_MASK.bit0=TRUE", 3),
        ("$MC_ROBX_SPECIAL_FEATURE_MASK.Bit 1 = 1\n$MC_ROBX_SPECIAL_FEATURE_MASK.Bit 0 = 1", 3),
    ],
)
def test_a_bit_of_a_mask_leaves_the_others(lines, mask):
    assert read(robx_text(CC4, extra=lines)).transformation().feature_mask == mask


# ---------------------------------------------------------------- defaults and data sets


def test_an_archive_of_changed_data_has_the_default_inputs():
    text = "\n".join(line for line in robx_text(NR6).splitlines() if "AXES_IN" not in line)
    machine = read(f"{text}\nN24110 $MC_TRAFO_AXES_IN_1[5]=6")
    assert machine.transformation().axes_in[:7] == (1, 2, 3, 4, 5, 6, 0)
    assert close(pose_of(machine.chain(), AXES), PLAIN)
    (finding,) = found(machine, "CB124")
    assert "[0] = 1, [1] = 2, [2] = 3, [3] = 4, [4] = 5 is the control's default" in finding.text
    assert not found(read(robx_text(NR6)), "CB124")


def test_a_robot_of_four_axes_gets_no_fifth_input_by_default():
    assert read(robx_text(CC4)).transformation().axes_in[:6] == (1, 2, 3, 4, 0, 0)


@pytest.mark.parametrize("number", [11, 20])
def test_data_sets_up_to_20(number):
    text = robx_text(NR6).replace("TRAFO_TYPE_1=", f"TRAFO_TYPE_{number}=").replace("AXES_IN_1[", f"AXES_IN_{number}[")
    machine = read(text.replace("N24100 ", "").replace("N24110 ", ""))
    assert machine.transformation(number).transformation == number
    assert close(pose_of(machine.chain(), AXES), PLAIN)


def test_lengths_in_inches_are_refused():
    with pytest.raises(ChainbuildError, match="inches") as caught:
        read(robx_text(NR6, extra="N10240 $MN_SCALING_SYSTEM_IS_METRIC=0"))
    assert (caught.value.code, caught.value.parameter) == ("CB125", "$MN_SCALING_SYSTEM_IS_METRIC")
    assert read(robx_text(NR6, extra="N10240 $MN_SCALING_SYSTEM_IS_METRIC=1")).chain()


# ---------------------------------------------------------------- tools

EDGE = {3: 120, 4: 13, 5: 14, 6: 5, 12: 0.4, 13: 0.2, 14: 0.1, 15: -0.25, 21: 30, 22: -7, 23: 2}


def edge(data, tool="1,1"):
    return "\n".join(f"$TC_DP{n}[{tool}]={value}" for n, value in data.items())


def behind_flange(chain):
    return np.linalg.inv(PLAIN) @ pose_of(chain, AXES)


def test_lengths_are_geometry_wear_and_base():
    machine = read(robx_text(NR6, extra=edge(EDGE)))
    assert close(behind_flange(machine.chain()), T(14 + 0.1 + 2, 13 + 0.2 - 7, 120 + 0.4 + 30))
    assert machine.tools[1].radius_mm == 4.75
    rows = {row.name: row.value for row in machine.parameters() if row.name.startswith("$TC_")}
    assert (rows["$TC_DP3"], rows["$TC_DP6"]) == (150.4, 4.75)


@pytest.mark.parametrize(
    ("line", "what"),
    [
        ("$TC_ADPTT[1]=1", "tool adapters"),
        ("$TC_ADPT1[1]=40", "tool adapters"),
        ("$TC_CARR1[1]=10", "tool carriers"),
        ("$TC_SCP13[1,1]=0.1", "wear that depends on the location"),
        ("$TC_ECP13[1,1]=0.1", "setting-up offsets"),
    ],
)
def test_tool_data_that_are_not_read_are_named(line, what):
    machine = read(robx_text(NR6, extra=f"{edge(EDGE)}\n{line}\n{line}"))
    (finding,) = found(machine, "CB123")
    assert what in finding.text
    assert (finding.severity, finding.span.text) == ("warning", line)
    assert not found(read(robx_text(NR6, extra=edge(EDGE))), "CB123")


TWO_CHANNELS = robx_text(NR6) + robx_text(NR6).replace("CHANDATA(1)", "CHANDATA(2)")
AREAS = f"%_N_TO1_TOA\n{edge({3: 120})}\nM17\n%_N_TO2_TOA\n{edge({3: 55})}\nM17\n"


def test_tool_areas_belong_to_their_channels():
    machine = read(f"{TWO_CHANNELS}\n{AREAS}")
    assert close(behind_flange(machine.chain(channel=1)), T(z=120))
    assert close(behind_flange(machine.chain(channel=2)), T(z=55))
    assert not found(machine, "CB113")
    assert not found(machine, "CB126")


def test_a_channel_may_be_linked_to_another_area():
    linked = TWO_CHANNELS.replace("CHANDATA(1)\n", "CHANDATA(1)\n$MC_MM_LINK_TOA_UNIT=2\n")
    machine = read(f"{linked}\n{AREAS}")
    assert [close(behind_flange(machine.chain(channel=n)), T(z=55)) for n in (1, 2)] == [True, True]


def test_tools_of_another_channel_are_not_taken():
    machine = read(f"{robx_text(NR6)}\n%_N_TO2_TOA\n{edge({3: 55})}\n")
    assert close(pose_of(machine.chain(), AXES), PLAIN)
    assert "tool area 2" in found(machine, "CB126")[0].text


# ---------------------------------------------------------------- files of another kind


@pytest.mark.parametrize(
    ("text", "words", "line"),
    [
        ("N24100 $MC_TRAFO_TYPE_1=0\n$MC_TRAFO_TYPE_2=24\n$MC_TRAFO5_TOOL_VECTOR_1=2", "TRAFO_TYPE 24 is an ori", 2),
        ("$MC_TRAFO_TYPE_1=72", "72 is an orientation transformation (TRAORI) whose data", 1),
        ("$MC_TRAFO_TYPE_11=256", "256 is a polar transformation (TRANSMIT)", 1),
        ("$MC_TRAFO_TYPE_1=4000", "4000 is another one", 1),
        ('; chain\nN10 $NK_NAME[0]="ROOT"\n$NK_TYPE[1]="AXIS_ROT_W"', "a chain of $NK_ elements", 2),
        (
            "> $MC_TRAFO_TYPE_1=4100\n> $MC_ROBX_NUM_AXES=6",
            "lines with other text before such data were ignored, 1 of them: remove it",
            2,
        ),
        ('$MN_AXCONF_MACHAX_NAME_TAB[0]="X"', "configures no ROBX transformation;", None),
    ],
)
def test_a_file_without_robx_is_named_for_what_it_is(text, words, line):
    with pytest.raises(UnsupportedKinematicError) as caught:
        read(text)
    assert words in str(caught.value)
    assert (caught.value.code, caught.value.line) == ("CB303", line)


def test_files_of_other_kinds_are_found_by_content(tmp_path):
    chain = tmp_path / "chain.ini"
    chain.write_text('$NK_NAME[0]="ROOT"\n')
    with pytest.raises(ChainbuildError, match=r"chain of \$NK_ elements.*types 91"):
        load(chain)
