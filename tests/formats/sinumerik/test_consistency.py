"""Data that contradict each other: each once, with its line, and nothing where the file is silent or consistent."""

from __future__ import annotations

import pytest

from chainbuild.findings import Finding
from tests.hand.robx_hand import scara_c_deg
from tests.kit.robx_files import ARM5, CC4, NR6, read, robx_text


def found(data: dict, code: str, extra: str = "", **options: object) -> list[Finding]:
    chain = read(robx_text(data, extra=extra, **options)).chain()
    return [finding for finding in chain.findings if finding.code == code]


TURNS = "\n".join(f"$MC_ORIAX_TURN_TAB_1[{n}]={{{n}}}" for n in range(3))


@pytest.mark.parametrize(
    ("tool_dir", "turns", "permitted"),
    [(0, (1, 2, 3), "3, 2, 1"), (-1, (3, 1, 2), "3, 2, 1"), (1, (3, 2, 1), "1, 2, 3")],
)
def test_orientation_axes(tool_dir, turns, permitted):
    (finding,) = found({**NR6, "TOOL_DIR": tool_dir}, "CB352", TURNS.format(*turns))
    assert (finding.severity, finding.permitted) == ("warning", permitted)
    assert "ORIAX_TURN_TAB_1" in finding.span.text
    right = tuple(int(number) for number in permitted.split(", "))
    assert not found({**NR6, "TOOL_DIR": tool_dir}, "CB352", TURNS.format(*right))
    assert not found({**NR6, "TOOL_DIR": tool_dir}, "CB352")


@pytest.mark.parametrize(("start", "reserved", "expected"), [(1, 2, 1), (1, 3, 0), (8, 9, 1), (8, 10, 0), (0, 0, 0)])
def test_reserved_tool_parameters(start, reserved, expected):
    findings = found({**NR6, "CC_TOA_START_NUM": start}, "CB353", f"$MN_MM_NUM_CC_TOA_PARAM={reserved}")
    assert len(findings) == expected
    assert all(f"$TC_DPC{start} to $TC_DPC{start + 2}" in one.text for one in findings)
    assert not found({**NR6, "CC_TOA_START_NUM": start}, "CB353")


@pytest.mark.parametrize(("start", "enabled", "expected"), [(-1, 0, 1), (-1, 2, 1), (-1, 3, 0), (0, 0, 0)])
def test_tool_vectors_enabled(start, enabled, expected):
    findings = found({**NR6, "CC_TOA_START_NUM": start}, "CB354", f"$MN_MM_ENABLE_TOOL_ORIENT={enabled}")
    assert len(findings) == expected
    assert all(one.permitted == "3" and "ENABLE" in one.span.text for one in findings)


@pytest.mark.parametrize(
    ("lines", "expected"),
    [("[0]=0\n{}[1]=0", 1), ("[0]=0\n{}[1]=1", 0), ("=4", 0), ("=0", 1)],
)
def test_block_elements(lines, expected):
    name = "$MC_MM_NUM_CC_BLOCK_ELEMENTS"
    assert len(found(NR6, "CB355", name + lines.format(name))) == expected


@pytest.mark.parametrize(
    ("data", "line", "expected"),
    [
        (NR6, "$MA_IS_ROT_AX[AX2]=0", ["axis A2 of the transformation is rotary"]),
        (NR6, "$MA_IS_ROT_AX[AX2]=1", []),
        (NR6, "$MA_IS_ROT_AX[AX9]=0", []),
        (CC4, "$MA_IS_ROT_AX[AX1]=1", ["axis A1 of the transformation is linear"]),
        (CC4, "$MA_IS_ROT_AX[AX1]=0", []),
        ({**NR6, "MAIN_AXES": 1}, "$MA_IS_ROT_AX[AX4]=0", ["axis A4 of the transformation is rotary"]),
    ],
)
def test_kind_of_an_axis(data, line, expected):
    findings = found(data, "CB356", line)
    assert [words in one.text for one, words in zip(findings, expected, strict=True)] == [True] * len(expected)


@pytest.mark.parametrize(
    ("main", "index", "value", "meant"),
    [
        (3, 1, 1.5708, "90°"),
        (3, 2, -1.571, "-90°"),
        (3, 4, 0.7854, "45°"),
        (3, 0, -0.5236, "-30°"),
        (3, 5, 3.14159, "180°"),
        (2, 1, 1.5708, "90°"),
        (2, 0, 1.5708, None),  # the linear axis of a CC: mm
        (1, 2, 1.5708, None),
        (3, 4, 0.785, None),
        (3, 4, 90, None),
        (3, 4, 0, None),
    ],
)
def test_zero_offsets_in_radians(main, index, value, meant):
    findings = found({**NR6, "MAIN_AXES": main}, "CB350", f"$MC_ROBX_MAMES[{index}]={value}")
    assert len(findings) == (meant is not None)
    assert all(one.text.endswith(f"is {meant} meant?") and f"MAMES[{index}]" in one.span.text for one in findings)


ABSOLUTE = {**CC4, "SPECIAL_FEATURE_MASK": 1}
MATHEMATICAL_ZERO = (10, -20, -30, -40)  # AXES_DIR and MAMES of CC4


@pytest.mark.parametrize("turn", [0, 35, -120])
def test_the_offset_of_the_absolute_angle(turn):
    data = {**ABSOLUTE, "TROWO_RPY": (turn, 0, 0)}
    shown = scara_c_deg({**data, "SPECIAL_FEATURE_MASK": 0}, MATHEMATICAL_ZERO)
    (finding,) = found(data, "CB357")
    assert (finding.severity, abs(shown) > 1) == ("warning", True)
    assert f"shows C = {shown:.6g}: the absolute C" in finding.text
    assert finding.hint.endswith(f"C_ANGLE_OFFSET = {-shown:.6g}")
    assert not found({**data, "C_ANGLE_OFFSET": 0}, "CB357")
    assert not found({**data, "SPECIAL_FEATURE_MASK": 0}, "CB357")


def test_no_offset_is_needed_where_the_pose_shows_0():
    assert not found({**ABSOLUTE, "TROWO_RPY": (180, 0, 0)}, "CB357")


def test_the_datum_at_fault_on_five_axes():
    (finding,) = found({**ARM5, "TFLWP_POS": (5, 0, 9), "TFLWP_RPY": (0, 0, 0)}, "CB314")
    assert "MD62910" in finding.parameter
    (finding,) = found(ARM5, "CB316", "$TC_DP3[1,1]=120")
    assert finding.parameter == "$TC_DP3 to $TC_DP5"
    assert "$TC_DP3" in finding.span.text
