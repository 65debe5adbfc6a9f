"""Doubts about sound data: parts of vectors, defaults, limits of no axis, strange lengths, several channels."""

from __future__ import annotations

import pytest

from chainbuild.errors import MachineDataError
from chainbuild.formats.load import check
from tests.kit.robx_files import NR6, read, robx_text

TRACK = (1, 2, 3, 4, 5, 6, 7)
TABLE = (1, 2, 3, 4, 5, 6, 0, 0, 0, 7)


def found(text, code):
    return [finding for finding in read(text).findings if finding.code == code]


def doubts(text):
    codes = ("CB346", "CB347", "CB348", "CB349", "CB350", "CB351", "CB512", "CB513", "CB514")
    return [finding.code for finding in read(text).findings if finding.code in codes]


def without(*names):
    return {name: value for name, value in NR6.items() if name not in names}


def test_a_sound_robot_leaves_no_doubt():
    assert doubts(robx_text(NR6)) == []


def test_a_direction_given_in_part():
    (finding,) = found(robx_text(NR6, axes_in=TRACK, extra="$MC_ROBX_EXT_AXIS_VECTOR_1[1]=1"), "CB346")
    assert finding.severity == "warning"
    assert "EXT_AXIS_VECTOR_1 is given in part: for [0] = 0, [2] = 1" in finding.text


def test_a_direction_by_default():
    (finding,) = found(robx_text(NR6, axes_in=TRACK), "CB347")
    assert finding.severity == "info"
    assert finding.text == "EX1 moves along Z: EXT_AXIS_VECTOR_1 has its default (0, 0, 1)"
    (finding,) = found(robx_text(NR6, axes_in=TABLE), "CB347")
    assert "EW1 turns about X" in finding.text
    whole = "$MC_ROBX_EXT_AXIS_VECTOR_1[0]=SET(0,1,0)"
    assert doubts(robx_text(NR6, axes_in=TRACK, extra=whole)) == []


def test_other_vectors_in_part_where_the_default_is_not_zero():
    (finding,) = found(robx_text(without("MAIN_LENGTH_AB"), extra="$MC_ROBX_MAIN_LENGTH_AB[0]=150"), "CB346")
    assert "MAIN_LENGTH_AB is given in part: for [1] = 500 the default is used" in finding.text
    assert doubts(robx_text({**without("TX3P3_POS"), "TX3P3_POS": (795,)})) == []


def test_the_forearm_frame_is_missing():
    (finding,) = found(robx_text(without("TX3P3_RPY")), "CB348")
    assert "default 0, 0, 0" in finding.text
    assert "TX3P3_RPY" in finding.text


def test_a_missing_wrist_type_is_said_to_be_missing():
    with pytest.raises(
        MachineDataError, match=r"wrist type 1 \(the default: MD62\d+ \$MC_ROBX_WRIST_AXES is missing\)"
    ):
        read(robx_text(without("WRIST_AXES")))


LIMITS = "$MA_POS_LIMIT_MINUS[{0}]=-90\n$MA_POS_LIMIT_PLUS[{0}]=90"


def test_limits_of_no_axis():
    (finding,) = found(robx_text(NR6, extra=LIMITS.format("RX1")), "CB349")
    assert "limits of RX1" in finding.text
    assert "AX1, AX2, AX3, AX4, AX5, AX6" in finding.hint
    (finding,) = found(robx_text(NR6, extra=LIMITS.format("AX11")), "CB349")
    assert "AX11" in finding.text


def test_limits_of_other_axes_of_the_machine():
    named = LIMITS.format("SP1") + '\n$MN_AXCONF_MACHAX_NAME_TAB[8]="SP1"'
    assert doubts(robx_text(NR6, extra=named)) == []
    many = "\n".join(LIMITS.format(f"AX{n}") for n in range(1, 12))
    assert doubts(robx_text(NR6, extra=many)) == []


def test_limits_by_the_name_of_a_channel_axis():
    machine = read(robx_text(NR6, extra=LIMITS.format("RX1") + '\n$MC_AXCONF_CHANAX_NAME_TAB[0]="RX1"'))
    assert machine.chain().axes[0].upper == 90
    assert not [finding for finding in machine.findings if finding.code == "CB349"]


@pytest.mark.parametrize(
    ("data", "code", "words"),
    [
        ({"TX3P3_POS": (0, 0, 0)}, "CB512", "the forearm"),
        ({"MAIN_LENGTH_AB": (0.15, 0.7)}, "CB513", "the upper arm is 0.7 mm long and the forearm 803.3 mm"),
        ({"TX3P3_POS": (7.95, 0, 0)}, "CB513", "the forearm is 7.95 mm"),
        (
            {"MAIN_LENGTH_AB": (0.15, 0.7), "TX3P3_POS": (0.795, 0, 0), "TFLWP_POS": (0, 0, 0.085)},
            "CB514",
            "1.73 mm",
        ),
        ({"MAIN_LENGTH_AB": (150e3, 700e3), "TX3P3_POS": (795e3, 0, 0)}, "CB514", "1645.09 m"),
    ],
)  # fmt: skip
def test_strange_lengths(data, code, words):
    (finding,) = found(robx_text({**NR6, **data}), code)
    assert finding.severity == "warning"
    assert words in finding.text


def test_a_gantry_needs_no_reach():
    gantry = {**NR6, "MAIN_AXES": 1, "TX3P3_POS": (0, 0, 0), "TFLWP_POS": (0, 0, 10)}
    assert doubts(robx_text(gantry)) == []


def two_channels():
    second = robx_text(NR6).replace("CHANDATA(1)", "CHANDATA(2)").replace("TRAFO_TYPE_1", "TRAFO_TYPE_3")
    return robx_text(NR6) + second.replace("AXES_IN_1", "AXES_IN_3")


def test_check_says_which_channel_is_taken_and_which_limits_are_assumed(tmp_path):
    path = tmp_path / "two.tea"
    path.write_text(two_channels())
    codes = [finding.code for finding in check(path)]
    assert codes.count("CB340") == 1
    assert codes.count("CB501") == 1
    (assumed,) = [finding for finding in check(path) if finding.code == "CB501"]
    assert "A1, A2, A3, A4, A5, A6" in assumed.text
    assert assumed.severity == "info"


def test_a_transformation_of_another_channel():
    with pytest.raises(MachineDataError, match=r"channel 1 configures no kinematic 3.*it is in channel 2"):
        read(two_channels()).chain(kinematic=3)


def test_limits_twice_for_one_axis_with_the_same_value():
    same = LIMITS.format("AX1") + "\n" + LIMITS.format("X1") + '\n$MN_AXCONF_MACHAX_NAME_TAB[0]="X1"'
    assert not found(robx_text(NR6, extra=same), "CB113")
    assert len(found(robx_text(NR6, extra=same.replace("PLUS[X1]=90", "PLUS[X1]=80")), "CB113")) == 1


@pytest.mark.parametrize(("value", "degrees"), [(1.5708, 90), (-1.570796, -90), (3.1416, 180), (4.71239, 270)])
def test_angles_in_radians(value, degrees):
    (finding,) = found(robx_text({**NR6, "TX3P3_RPY": (0, value, 0)}), "CB350")
    assert finding.severity == "warning"
    assert f"TX3P3_RPY[1] is {value:g}: machine data give angles in degrees; is {degrees}° meant?" in finding.text


@pytest.mark.parametrize("value", [0, 90, 1.5, 1.57, 3.14, 1.6, 89.9])
def test_angles_that_are_none_in_radians(value):
    assert found(robx_text({**NR6, "TX3P3_RPY": (0, value, 0)}), "CB350") == []


def test_the_lengths_are_left_to_the_default():
    (finding,) = found(robx_text(without("MAIN_LENGTH_AB")), "CB351")
    assert "MAIN_LENGTH_AB is missing: its default 0, 500 mm is used" in finding.text
