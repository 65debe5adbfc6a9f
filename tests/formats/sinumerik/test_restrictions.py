"""What is sound but outside the manual's lists: built, with a warning that says so; and what must raise none."""

from __future__ import annotations

import pytest

from chainbuild.findings import finding_kinds
from tests.kit.robx_files import ARM5, CC4, NR6, TE4_ARM, pose_of, read, robx_text

KIND_OF = {1: (1, 1, 1), 2: (1, 3, 3), 3: (3, 3, 3), 4: (1, 1, 3), 5: (3, 3, 1), 6: (3, 1, 1), 7: (3, 3, 3)}


def of_type(main, **changes):
    return {**NR6, "MAIN_AXES": main, "AXES_TYPE": (*KIND_OF[main], 3, 3, 3), **changes}


def codes(data, **options):
    machine = read(robx_text(data, **options))
    chain = machine.chain()
    pose_of(chain, [1.0] * len(chain.axes))
    found = {finding.code: finding for finding in chain.findings}
    assert {finding.code for finding in machine.findings} == set(found)
    assert all(finding_kinds()[code].severity != "error" for code in found)
    return found


@pytest.mark.parametrize(
    ("main", "wrist", "extra"),
    [
        (3, 2, {}),
        (3, 3, {"DHPAR4_5ALPHA": (70, -35)}),
        (3, 6, {"DHPAR4_5D": (0, 70)}),
        (4, 2, {}),
        (4, 3, {"DHPAR4_5ALPHA": (70, -35)}),
        (4, 6, {"DHPAR4_5A": (30, 70), "DHPAR4_5ALPHA": (70, -35)}),
        (2, 2, {}),
        (2, 3, {"DHPAR4_5ALPHA": (70, -35)}),
        (2, 6, {"DHPAR4_5D": (0, 70)}),
    ],
)
def test_listed_combinations_raise_nothing(main, wrist, extra):
    assert not codes(of_type(main, WRIST_AXES=wrist, **extra))


@pytest.mark.parametrize(
    ("main", "wrist", "extra", "words"),
    [
        (3, 5, {"DHPAR4_5A": (30, 70)}, "does not list"),
        (3, 6, {"DHPAR4_5A": (30, 70)}, "DHPAR4_5A = 0"),
        (4, 6, {"DHPAR4_5D": (0, 70)}, "DHPAR4_5D = 0"),
        (2, 6, {"DHPAR4_5A": (30, 0)}, "DHPAR4_5ALPHA = (-90, 90)"),
        (2, 6, {"DHPAR4_5ALPHA": (-70, 90)}, "DHPAR4_5ALPHA = (-90, 90)"),
        (1, 2, {}, "describes no six-axis"),
        (5, 2, {}, "describes no six-axis"),
        (6, 2, {}, "describes no six-axis"),
        (7, 2, {}, "describes no six-axis"),
    ],
)
def test_other_combinations_are_built_with_a_warning(main, wrist, extra, words):
    found = codes(of_type(main, WRIST_AXES=wrist, **extra))
    assert set(found) == {"CB310"}
    assert words in found["CB310"].text


@pytest.mark.parametrize(
    ("data", "code", "words"),
    [
        ({**NR6, "DHPAR4_5ALPHA": (90, -90)}, "CB307", "(90, -90)"),
        ({**NR6, "DHPAR4_5ALPHA": (90, 90)}, "CB345", "(90, 90)"),
        ({**NR6, "DHPAR4_5ALPHA": (-90, -90)}, "CB345", "(-90, -90)"),
        ({**NR6, "WRIST_AXES": 6, "DHPAR4_5D": (10, 70)}, "CB358", "DHPAR4_5D[0] = 0"),
        ({**NR6, "WRIST_AXES": 3, "DHPAR4_5ALPHA": (8, -35)}, "CB308", "nearly degenerate"),
        ({**NR6, "WRIST_AXES": 3, "DHPAR4_5ALPHA": (70, -172)}, "CB308", "nearly degenerate"),
        ({**NR6, "A4PAR": 1}, "CB311", "not parallel"),
        ({**NR6, "TX3P3_RPY": (0, 0, 90)}, "CB311", "is parallel"),
        ({**ARM5, "TFLWP_POS": (5, 0, 9), "TFLWP_RPY": (0, 0, 0)}, "CB314", "(0, 0, Z)"),
        ({**ARM5, "WRIST_AXES": 3}, "CB315", "A4PAR = 1"),
        ({**ARM5, "MAIN_AXES": 7, "WRIST_AXES": 3, "A4PAR": 1}, "CB315", "with a central wrist only"),
        ({**NR6, "AXES_TYPE": (3, 3, 1, 3, 3, 3)}, "CB330", "the arrangement is used"),
        ({name: value for name, value in NR6.items() if name != "AXES_TYPE"}, "CB330", "is missing"),
        ({**NR6, "SPECIAL_FEATURE_MASK": 5}, "CB331", "'H5'"),
        ({**NR6, "SPECIAL_FEATURE_MASK": 1}, "CB342", "no effect"),
        ({**NR6, "SPECIAL_KIN": 2, "SW_LIMITS_PARALLEL": (20, 150)}, "CB322", "not the angle of the elbow"),
        ({**NR6, "GRIP_REL_RESET_MODE": 2}, "CB329", "after a reset"),
        ({**NR6, "EXT_ROT_BASE_OFFSET": (1, 0, 0)}, "CB335", "EXT_ROT_BASE_OFFSET"),
    ],
)
def test_warnings(data, code, words):
    found = codes(data)
    assert words in found[code].text
    assert found[code].parameter.startswith("MD62")


def test_comau_like_parallelogram_raises_nothing():
    data = {**NR6, "SPECIAL_KIN": 2, "AXES_DIR": (1, 1, -1, 1, 1, 1), "MAMES": (0, 90, 90, 0, 0, 0)}
    assert not codes({**data, "SW_LIMITS_PARALLEL": (20, 150)})


@pytest.mark.parametrize("data", [TE4_ARM, CC4, ARM5], ids=["NR 4", "CC 4", "NR 5"])
def test_few_axes_raise_nothing(data):
    assert not codes(data)


def test_five_axis_tool_form():
    assert not codes({**ARM5, "GRIP_REL_RESET_MODE": 1}, extra="$TC_DP5[1,1]=120").keys() - {"CB338"}
    assert "CB316" in codes(ARM5, extra="$TC_DP3[1,1]=120")
    assert "CB316" in codes(ARM5, extra="$TC_DP4[1,1]=120")


def test_direction_is_normalised_with_a_warning():
    found = codes({**NR6, "EXT_AXIS_VECTOR_1": (0.5, 0.5, 0)}, axes_in=range(1, 8))
    assert "length 0.70710678" in found["CB325"].text
    chain = read(robx_text({**NR6, "EXT_AXIS_VECTOR_1": (0.5, 0.5, 0)}, axes_in=range(1, 8))).chain()
    moved = pose_of(chain, (0, 0, 0, 0, 0, 0, 100)) - pose_of(chain, [0.0] * 7)
    assert (moved[0, 3], moved[1, 3]) == pytest.approx((100 / 2**0.5, 100 / 2**0.5))


@pytest.mark.parametrize(
    ("extra", "code"),
    [
        ("$MC_TRAFO_INCLUDES_TOOL_1=0", "CB333"),
        ("$MC_TRAFO_AXES_IN_1[16]=9", "CB334"),
        ("$ON_TECHNO_EXTENSION_MASK[3]='H1'", "CB332"),
    ],
)
def test_standard_data(extra, code):
    assert code in codes(NR6, extra=extra)
    assert not codes(NR6, extra="$MC_TRAFO_INCLUDES_TOOL_1=1\n$ON_TECHNO_EXTENSION_MASK[3]='H10000'")


@pytest.mark.parametrize(
    ("main", "trowo", "tiroro"),
    [(2, (0, 0, 0), (0, 0, 90)), (2, (0, 0, 0), (90, 0, 0)), (1, (0, 0, 0), (0, 0, 0)), (4, (90, 0, 0), (0, 90, 0))],
)
def test_four_axis_bases_that_are_permitted(main, trowo, tiroro):
    kinds = (*KIND_OF[main], 3, 3, 3)
    data = {**TE4_ARM, "MAIN_AXES": main, "AXES_TYPE": kinds, "TROWO_RPY": trowo, "TIRORO_RPY": tiroro}
    assert not codes(data)
