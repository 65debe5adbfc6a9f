"""Every text form of machine data."""

from __future__ import annotations

import pytest

from chainbuild.findings import Collector
from chainbuild.formats.sinumerik.reading.data_table import tabulate
from chainbuild.formats.sinumerik.reading.reader import read_assignments
from chainbuild.formats.text import SourceText, is_sinumerik, read_source


def assignments(text, collector=None):
    return read_assignments(SourceText("a.tea", text, "utf-8"), collector or Collector()).assignments


FORMS = {
    "number and name": ("N62908 $MC_ROBX_TX3P3_POS[0]=1444", "ROBX_TX3P3_POS", 0, 1444.0),
    "name only, blanks": ("  $MC_ROBX_AXES_DIR[2] = -1  ", "ROBX_AXES_DIR", 2, -1.0),
    "blank before the index": ("$MC_ROBX_AXES_DIR [ 2 ]= -1", "ROBX_AXES_DIR", 2, -1.0),
    "notes without equals": (
        "MD62907 $MC_ROBX_MAIN_LENGTH_AB[1] 1175  ; notes style",
        "ROBX_MAIN_LENGTH_AB",
        1,
        1175.0,
    ),
    "escaped dollar": (r"MD62907 \$MC_ROBX_MAIN_LENGTH_AB[1] 1175", "ROBX_MAIN_LENGTH_AB", 1, 1175.0),
    "escaped underscore": (r"MD62905 \$MC\_ROBX\_NUM\_AXES = 6", "ROBX_NUM_AXES", None, 6.0),
    "number without name": ("MD62907[1] = 1175", "ROBX_MAIN_LENGTH_AB", 1, 1175.0),
    "name without prefix": ("ROBX_NUM_AXES = 6", "ROBX_NUM_AXES", None, 6.0),
    "lower case": ("n62905 $mc_robx_num_axes=6", "ROBX_NUM_AXES", None, 6.0),
    "tabs": ("\tN62905\t$MC_ROBX_NUM_AXES\t=\t6", "ROBX_NUM_AXES", None, 6.0),
    "hexadecimal": ("N62953 $MC_ROBX_SPECIAL_FEATURE_MASK='H1F'", "ROBX_SPECIAL_FEATURE_MASK", None, 31.0),
    "binary": ("$MC_ROBX_SPECIAL_FEATURE_MASK='B101'", "ROBX_SPECIAL_FEATURE_MASK", None, 5.0),
    "exponent": ("$MC_ROBX_ITERPRECISION=1.0e-6", "ROBX_ITERPRECISION", None, 1e-6),
    "exponent EX": ("$MC_ROBX_ITERPRECISION=1EX-6", "ROBX_ITERPRECISION", None, 1e-6),
    "leading plus": ("$MC_ROBX_MAIN_LENGTH_AB[0]=+.5", "ROBX_MAIN_LENGTH_AB", 0, 0.5),
    "trailing point": ("$MC_ROBX_MAIN_LENGTH_AB[0]=5.", "ROBX_MAIN_LENGTH_AB", 0, 5.0),
    "integer with point": ("$MC_ROBX_NUM_AXES=6.0", "ROBX_NUM_AXES", None, 6.0),
    "scalar with index 0": ("$MC_ROBX_NUM_AXES[0]=6", "ROBX_NUM_AXES", None, 6.0),
    "axis index": ("N36100 $MA_POS_LIMIT_MINUS[AX1]=-170", "POS_LIMIT_MINUS", "AX1", -170.0),
    "axis index behind an element": ("$MA_POS_LIMIT_MINUS[0, ax12]=-170", "POS_LIMIT_MINUS", "AX12", -170.0),
    "tool": ("$TC_DP3[4,2]=120.5", "DP3", (4, 2), 120.5),
    "tool without edge": ("$TC_DP3[4]=120.5", "DP3", (4, 1), 120.5),
    "string": ('$MN_AXCONF_MACHAX_NAME_TAB[0]="X;1"  ; a comment', "AXCONF_MACHAX_NAME_TAB", 0, "X;1"),
    "truth value": ("$MA_IS_ROT_AX[AX4]=TRUE", "IS_ROT_AX", "AX4", 1.0),
    "older package": ("N62605 $MC_TRAFO6_NUM_AXES=4", "ROBX_NUM_AXES", None, 4.0),
    "older package by number": ("MD62605 4", "ROBX_NUM_AXES", None, 4.0),
    "any data set": ("N24210 $MC_TRAFO_AXES_IN_2[5]=7", "TRAFO_AXES_IN_2", 5, 7.0),
    "misspelt in the manual": ("$MC_ROBX_ITER_MAXCOUNT=9", "ROBX_ITERMAXCOUNT", None, 9.0),
}


@pytest.mark.parametrize("form", FORMS)
def test_forms(form):
    text, name, index, value = FORMS[form]
    (row,) = assignments(text)
    assert (row.datum.name, row.index, row.value) == (name, index, value)
    assert row.te4 == form.startswith("older")


def test_spans_point_at_the_value():
    _, row = assignments("; first\nN62905 $MC_ROBX_NUM_AXES=6\n\nMD62907 \\$MC_ROBX_MAIN_LENGTH_AB[1] 1175 ; x")
    assert (row.span.file, row.span.line) == ("a.tea", 4)
    assert row.span.text[row.span.column - 1 :].startswith("1175")


def test_channels_by_chandata_and_header():
    reading = read_assignments(
        SourceText(
            "a",
            "$MC_ROBX_NUM_AXES=4\nCHANDATA(2)\n$MC_ROBX_NUM_AXES=5\n%_N_CH3_TEA\n$MC_ROBX_NUM_AXES=6\n"
            "%_N_NC_TEA\n$MC_ROBX_KINCLASS=1",
            "utf-8",
        ),
        Collector(),
    )
    assert [row.channel for row in reading.assignments] == [1, 2, 3, 1]
    assert reading.channels == (2, 3)


def test_unrelated_lines_are_ignored_and_counted():
    collector = Collector()
    text = """%_N_NC_TEA
    ;$PATH=/_N_COMPLETE_DIR
    N10000 $MN_SOMETHING_ELSE[0]="A1"
    N20100 $MC_DIAMETER_AX_DEF="X"
    N10 G1 X100 F1000
    DEF INT COUNTER
    R1=17
    N62905 $MC_ROBX_NUM_AXES=6
    M30
    """
    reading = read_assignments(SourceText("a", text, "utf-8"), collector)
    assert [row.datum.name for row in reading.assignments] == ["ROBX_NUM_AXES"]
    assert reading.ignored == 5
    assert [finding.code for finding in collector.findings] == ["CB110"]
    assert ": 5" in collector.findings[0].text


def test_repeated_assignment_last_wins_with_a_warning():
    collector = Collector()
    source = SourceText(
        "a", "CHANDATA(1)\n$MC_ROBX_NUM_AXES=4\n$MC_ROBX_NUM_AXES=6\nCHANDATA(2)\n$MC_ROBX_NUM_AXES=5", ""
    )
    table = tabulate(read_assignments(source, collector), collector)
    assert table.channel(1).number("ROBX_NUM_AXES") == 6
    assert table.channel(2).number("ROBX_NUM_AXES") == 5
    (finding,) = collector.findings
    assert finding.code == "CB113"
    assert finding.severity == "warning"
    assert finding.span.line == 3
    assert "line 2" in finding.text


@pytest.mark.parametrize(
    ("line", "code", "words"),
    [
        ("$MC_ROBX_NUM_AXIS=6", "CB108", "not a known"),
        ("$MC_ROBX_TX3P3_PSO[0]=6", "CB108", "not a known"),
        ("N62908 $MC_ROBX_TX3P3_RPY[0]=6", "CB109", "N62908 is not the number of MD62909"),
        ("R1 = 2 * $MC_ROBX_NUM_AXES", "CB111", "assigns nothing"),
        ("> $MC_ROBX_NUM_AXES=6", "CB111", "assigns $MC_ROBX_NUM_AXES, but other text stands before it"),
        ("IF $MC_ROBX_NUM_AXES == 6", "CB111", "assigns nothing"),
    ],
)
def test_warnings_of_lines(line, code, words):
    collector = Collector()
    assignments(line, collector)
    found = {finding.code: finding for finding in collector.findings}
    assert found[code].severity == "warning"
    assert words in found[code].text
    assert found[code].span.line == 1


def test_a_misspelt_name_gets_a_hint():
    collector = Collector()
    assignments("$MC_ROBX_NUM_AXIS=6", collector)
    assert collector.findings[0].hint == "did you mean $MC_ROBX_NUM_AXES?"


def test_a_block_number_before_a_name_is_no_contradiction():
    collector = Collector()
    assignments("N10 $MC_ROBX_NUM_AXES=6", collector)
    assert not collector.findings


@pytest.mark.parametrize(
    "raw",
    [
        "; Maße\r\nN62905 $MC_ROBX_NUM_AXES=6\r\nM17\r\n".encode("latin-1"),
        "; Maße\nN62905 $MC_ROBX_NUM_AXES=6\nM17\n".encode(),
        b"\xef\xbb\xbf" + "; Maße\r\nN62905 $MC_ROBX_NUM_AXES=6".encode(),
        b"\xff\xfe" + "; Maße\r\nN62905 $MC_ROBX_NUM_AXES=6".encode("utf-16-le"),
        b"; old\rN62905 $MC_ROBX_NUM_AXES=6\rM17\r",
    ],
    ids=["latin-1 crlf", "utf-8", "bom", "utf-16", "cr"],
)
def test_encodings_and_line_ends(tmp_path, raw):
    path = tmp_path / "a.tea"
    path.write_bytes(raw)
    (row,) = read_assignments(read_source(path), Collector()).assignments
    assert (row.value, row.span.line) == (6.0, 2)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("N62905 $MC_ROBX_NUM_AXES=6", True),
        (r"notes: \$MC_TRAFO6_NUM_AXES 4", True),
        ("CHANDATA(1)\n", True),
        ("%_N_NC_TEA\n", True),
        ("MD62905 6", True),
        ("$TC_DP3[1,1]=5", True),
        ("trafo[0].param[6] 8300000\nkinematik_id 45", False),
        ("<?xml version='1.0'?><a>cost: $MCD</a>", False),
        ("A1,A2,A3\n0,0,0\n", False),
        ("N6290 G1 X10", False),
    ],
)
def test_dialect_is_told_by_content(text, expected):
    assert is_sinumerik(text) is expected
