"""Named bad files with what their refusal must say."""

from __future__ import annotations

from dataclasses import dataclass

from tests.kit.robx_files import ARM5, NR6, TE4_ARM, robx_text


@dataclass(frozen=True)
class Bad:
    """A file's text, and what must be in the refusal: words, the text of the line it points at, alarm, code."""

    text: str
    words: tuple[str, ...]
    line: str
    alarm: int | None = None
    code: str = ""


def changed(data, **changes):
    """Return data with changes; None removes a datum."""
    return {name: value for name, value in {**data, **changes}.items() if value is not None}


def nr6(**changes):
    return robx_text(changed(NR6, **changes))


def with_line(line):
    return robx_text(NR6, extra=line)


FULL = (1, 2, 3, 4, 5, 6)

BAD = {
    # Syntax and values
    "num axes 7": Bad(nr6(NUM_AXES=7), ("MD62905", "4, 5 or 6"), "NUM_AXES=7", None, "CB106"),
    "num axes 3": Bad(nr6(NUM_AXES=3), ("MD62905", "4, 5 or 6"), "NUM_AXES=3", None, "CB106"),
    "wrist 4": Bad(nr6(WRIST_AXES=4), ("MD62904", "1, 2, 3, 5 or 6"), "WRIST_AXES=4", None, "CB106"),
    "main axes 0": Bad(nr6(MAIN_AXES=0), ("MD62903", "1, 2, 3, 4, 5, 6 or 7"), "MAIN_AXES=0", None, "CB106"),
    "kinclass 3": Bad(nr6(KINCLASS=3), ("MD62900", "1 or 2"), "KINCLASS=3", None, "CB106"),
    "special kin 3": Bad(nr6(SPECIAL_KIN=3), ("MD62902", "1 or 2"), "SPECIAL_KIN=3", None, "CB106"),
    "axes dir 0": Bad(nr6(AXES_DIR=(1, 0, 1)), ("MD62918", "-1 or 1"), "AXES_DIR[1]=0", None, "CB106"),
    "tool dir 2": Bad(nr6(TOOL_DIR=2), ("MD62949", "-1, 0 or 1"), "TOOL_DIR=2", None, "CB106"),
    "toa start 9": Bad(nr6(CC_TOA_START_NUM=9), ("MD62936", "-1 to 8"), "START_NUM=9", None, "CB106"),
    "angle B 91": Bad(nr6(TX3P3_RPY=(0, 91, 0)), ("MD62909", "-90 to 90"), "RPY[1]=91", None, "CB106"),
    "angle A 181": Bad(nr6(TIRORO_RPY=(181, 0, 0)), ("MD62913", "-180 to 180"), "RPY[0]=181", None, "CB106"),
    "iteration count 19": Bad(nr6(ITERMAXCOUNT=19), ("MD62967", "3 to 18"), "COUNT=19", None, "CB106"),
    "status index 6": Bad(nr6(A_DBD_START_INDEX=6), ("MD62952", "multiples of 4"), "INDEX=6", None, "CB106"),
    "length 1e300": Bad(nr6(MAIN_LENGTH_AB=(1e300, 1)), ("MD62907", "1e+09"), "=1e+300", None, "CB106"),
    "index 3 of 3": Bad(with_line("$MC_ROBX_TX3P3_POS[3]=1"), ("MD62908", "[0] to [2]"), "POS[3]", None, "CB105"),
    "negative index": Bad(with_line("$MC_ROBX_TX3P3_POS[-1]=1"), ("[0] to [2]",), "POS[-1]", None, "CB105"),
    "index missing": Bad(with_line("$MC_ROBX_TX3P3_POS=1"), ("missing", "[0] to [2]"), "POS=1", None, "CB105"),
    "index on a scalar": Bad(with_line("$MC_ROBX_NUM_AXES[1]=6"), ("[0] or no index",), "AXES[1]", None, "CB105"),
    "index is a word": Bad(with_line("$MC_ROBX_AXES_DIR[AX1]=1"), ("[0] to [5]",), "DIR[AX1]", None, "CB105"),
    "index not closed": Bad(with_line("$MC_ROBX_AXES_DIR[1=1"), ("not closed",), "DIR[1=1", None, "CB101"),
    "limit without axis": Bad(with_line("$MA_POS_LIMIT_PLUS=1"), ("no machine axis",), "PLUS=1", None, "CB105"),
    "tool without number": Bad(with_line("$TC_DP3=1"), ("names no tool",), "DP3=1", None, "CB105"),
    "nan": Bad(nr6(MAIN_LENGTH_AB=("nan", 1)), ("'nan' is not finite",), "[0]=nan", None, "CB103"),
    "inf": Bad(nr6(MAIN_LENGTH_AB=("-inf", 1)), ("'-inf' is not finite",), "[0]=-inf", None, "CB103"),
    "1e999": Bad(nr6(MAIN_LENGTH_AB=("1e999", 1)), ("'1e999' is not finite",), "[0]=1e999", None, "CB103"),
    "decimal comma": Bad(nr6(MAIN_LENGTH_AB=("150,5", 1)), ("decimal comma", "point"), "150,5", None, "CB104"),
    "text for a number": Bad(nr6(MAIN_LENGTH_AB=("long", 1)), ("'long' is not a number",), "=long", None, "CB102"),
    "string for a number": Bad(with_line('$MC_ROBX_NUM_AXES="6"'), ("wrong type",), '"6"', None, "CB107"),
    "number for a string": Bad(with_line("$MN_AXCONF_MACHAX_NAME_TAB[0]=1"), ("string",), "TAB[0]=1", None, "CB107"),
    "fraction for an integer": Bad(nr6(NUM_AXES=5.5), ("5.5 is not an integer",), "AXES=5.5", None, "CB107"),
    "no value": Bad(with_line("$MC_ROBX_NUM_AXES="), ("the value is missing",), "AXES=", None, "CB101"),
    "two values": Bad(with_line("$MC_ROBX_MAIN_LENGTH_AB[0]=1 2"), ("'1 2' is not a number",), "=1 2", None, "CB102"),
    "list too long": Bad(with_line("$MC_ROBX_TX3P3_POS[1]=SET(1,2,3)"), ("[3]", "[0] to [2]"), "SET", None, "CB105"),
    "list with a gap": Bad(
        with_line("$MC_ROBX_TX3P3_POS[0]=SET(1,,3)"), ("the value is missing",), "SET", None, "CB101"
    ),
    "list of an axis": Bad(with_line("$MA_POS_LIMIT_PLUS[AX1]=SET(1,2)"), ("not axes",), "SET", None, "CB105"),
    "name without quotes": Bad(with_line("$MN_AXCONF_MACHAX_NAME_TAB[0]=X1"), ("double quotes",), "=X1", None, "CB107"),
    "hexadecimal without quotes": Bad(with_line("$MC_ROBX_SPECIAL_FEATURE_MASK=H1"), ("'H1'",), "=H1", None, "CB102"),
    "hexadecimal of 40 bits": Bad(
        with_line("$MC_ROBX_SPECIAL_FEATURE_MASK='H1234567890'"), ("32 bits",), "'H1", None, "CB102"
    ),
    "binary with a 2": Bad(with_line("$MC_ROBX_SPECIAL_FEATURE_MASK='B12'"), ("0 and 1",), "'B12'", None, "CB102"),
    "chandata 0": Bad("CHANDATA(0)\n" + nr6(), ("CHANDATA(1)",), "CHANDATA(0)", None, "CB112"),
    "chandata without number": Bad("CHANDATA\n" + nr6(), ("names no channel",), "CHANDATA", None, "CB112"),
    # Transformation and axes
    "no transformation": Bad("N10000 $MN_X=1\nCHANDATA(1)\n", ("no ROBX transformation", "4100"), "", None, "CB303"),
    "type missing": Bad("$MC_ROBX_NUM_AXES=6\n", ("TRAFO_TYPE_x is missing", "4100"), "NUM_AXES", 75312, "CB301"),
    "type 16": Bad(nr6().replace("=4100", "=16"), ("TRAFO_TYPE_x is 16", "4100"), "TYPE_1=16", 75312, "CB301"),
    "type 4099 with ROBX data": Bad(nr6().replace("=4100", "=4099"), ("is 4099", "4100"), "=4099", 75312, "CB301"),
    "type 4100 with TE4 data": Bad(
        robx_text(TE4_ARM, package="TRAFO6").replace("=4099", "=4100"), ("is 4100", "4099"), "=4100", 75312, "CB301"
    ),
    "six inputs, num axes missing": Bad(
        robx_text(changed(NR6, NUM_AXES=None), axes_in=FULL),
        ("names 6 robot axes", "NUM_AXES is 4", "MD62905 $MC_ROBX_NUM_AXES is missing"),
        "AXES_IN_1[5]=6",
        75311,
        "CB302",
    ),
    "four inputs for six axes": Bad(
        robx_text(NR6, axes_in=(1, 2, 3, 4)), ("names 5 robot axes", "NUM_AXES is 6"), "AXES_IN_1[3]", 75311, "CB302"
    ),
    "gap in the inputs": Bad(
        robx_text(ARM5, axes_in=(1, 2, 0, 4, 5, 6)), ("1, 2, 0, 4, 5, 6",), "AXES_IN_1[5]", 75311, "CB302"
    ),
    "no inputs": Bad(robx_text(NR6, axes_in=()), ("names 5 robot axes",), "TRAFO_TYPE_1", 75311, "CB302"),
    "channel axis twice": Bad(
        robx_text(NR6, axes_in=(1, 2, 3, 4, 5, 5)), ("channel axis 5 twice",), "AXES_IN_1[5]", 75311, "CB302"
    ),
    "spindle drive": Bad(
        nr6(AXES_TYPE=(3, 2, 3, 3, 3, 3)), ("AXES_TYPE[1] = 2", "spindles"), "AXES_TYPE", None, "CB304"
    ),
    "spindle on": Bad(nr6(SPIN_ON=1), ("SPIN_ON = 1", "permitted: 0"), "SPIN_ON=1", None, "CB304"),
    "older package with three axes": Bad(
        robx_text({**TE4_ARM, "NUM_AXES": 3}, package="TRAFO6"), ("MD62605 $MC_TRAFO6_NUM_AXES",), "=3", None, "CB106"
    ),
    "six axes without wrist": Bad(
        nr6(WRIST_AXES=1), ("wrist type 1", "6 axes", "2 or 3"), "WRIST_AXES=1", None, "CB305"
    ),
    "five axes with angled wrist": Bad(
        robx_text({**ARM5, "WRIST_AXES": 5}), ("wrist type 5", "5 axes", "2 or 3"), "WRIST_AXES=5", None, "CB305"
    ),
    "sequence with an axis twice": Bad(
        nr6(AXIS_SEQ=(1, 2, 2, 4, 5, 6)), ("does not name each",), "AXIS_SEQ[5]", None, "CB319"
    ),
    "sequence of an articulated arm": Bad(
        nr6(AXIS_SEQ=(2, 1, 3, 4, 5, 6)), ("NR cannot exchange", "the given order only"), "AXIS_SEQ[5]", None, "CB320"
    ),
    "sequence of SC moves axis 3": Bad(
        nr6(MAIN_AXES=4, AXIS_SEQ=(3, 2, 1, 4, 5, 6)), ("axes 1, 2 may change",), "AXIS_SEQ[5]", None, "CB320"
    ),
    "sequence moves a wrist axis": Bad(
        nr6(MAIN_AXES=1, AXIS_SEQ=(1, 2, 4, 3, 5, 6)), ("axes 1, 2, 3 may change",), "AXIS_SEQ[5]", None, "CB320"
    ),
    # Geometry
    "length B zero": Bad(nr6(MAIN_LENGTH_AB=(150, 0)), ("length B is 0", "MD62907"), "LENGTH_AB[1]=0", 75310, "CB341"),
    "central wrist with an offset": Bad(
        nr6(DHPAR4_5A=(0, 30)), ("central wrist", "DHPAR4_5A is not 0"), "DHPAR4_5A[1]=30", None, "CB306"
    ),
    "inclined wrist with an offset": Bad(
        nr6(WRIST_AXES=3, DHPAR4_5D=(0, 30)), ("meet in one point", "DHPAR4_5D"), "DHPAR4_5D[1]=30", None, "CB306"
    ),
    "central wrist at 80 degrees": Bad(
        nr6(DHPAR4_5ALPHA=(-80, 90)), ("perpendicular", "type 3 or 6"), "ALPHA[1]=90", None, "CB306"
    ),
    "inclined wrist with one axis": Bad(
        nr6(WRIST_AXES=3, DHPAR4_5ALPHA=(0, 90)), ("makes axes 4 and 5 coincide",), "ALPHA[1]", None, "CB309"
    ),
    "five axes without flange": Bad(
        robx_text(changed(ARM5, TFLWP_RPY=None)), ("TFLWP_RPY is missing", "MD62911"), "TRAFO_TYPE", 75310, "CB312"
    ),
    "five axes, flange along axis 5": Bad(
        robx_text({**ARM5, "TFLWP_RPY": (0, -90, 180)}),
        ("parallel to axis 5", "MD62911"),
        "TFLWP_RPY[2]",
        75310,
        "CB313",
    ),
    "five axes, flange beside axis 5": Bad(
        robx_text({**ARM5, "TFLWP_RPY": (90, 0, 0), "TFLWP_POS": (12, 0, 80)}),
        ("at a distance of 12 mm", "MD62910"),
        "TFLWP_POS[2]",
        75310,
        "CB313",
    ),
    "four axes, wrist at 45 degrees": Bad(
        robx_text({**TE4_ARM, "TX3P3_RPY": (0, 0, -45)}),
        ("neither parallel", "MD62909"),
        "TX3P3_RPY[2]",
        75310,
        "CB317",
    ),
    "four axes, base at 30 degrees": Bad(
        robx_text({**TE4_ARM, "TIRORO_RPY": (0, 30, 0)}),
        ("axis of the world", "MD62913"),
        "TIRORO_RPY[2]",
        75310,
        "CB318",
    ),
    "four axes, base lying": Bad(
        robx_text({**TE4_ARM, "TIRORO_RPY": (0, 90, 0)}), ("Z of IRO", "MD62913"), "TIRORO_RPY[2]", 75310, "CB318"
    ),
    "four axes, world at 30 degrees": Bad(
        robx_text({**TE4_ARM, "TIRORO_RPY": (30, 0, 0), "TROWO_RPY": (0, 30, 0)}),
        ("axis of the world", "MD62972"),
        "TROWO_RPY[2]",
        75310,
        "CB318",
    ),
    "four axes, world lying": Bad(
        robx_text({**TE4_ARM, "TROWO_RPY": (0, 90, 0)}),
        ("Z of IRO", "4-axis NR", "MD62972"),
        "TROWO_RPY[2]",
        75310,
        "CB318",
    ),
    "parallelogram on a gantry": Bad(
        nr6(SPECIAL_KIN=2, MAIN_AXES=1), ("not of a SS", "MAIN_AXES 3"), "SPECIAL_KIN=2", None, "CB321"
    ),
    "parallelogram limits reversed": Bad(
        nr6(SPECIAL_KIN=2, SW_LIMITS_PARALLEL=(100, 20)), ("100 to 20",), "PARALLEL[1]=20", None, "CB323"
    ),
    # Additional axes, gripper, limits
    "table axis without direction": Bad(
        robx_text({**NR6, "EXT_ROT_AX_VECTOR_1": (0, 0, 0)}, axes_in=(*FULL, 0, 0, 0, 7)),
        ("EW1 is the zero vector", "MD62940"),
        "VECTOR_1[2]",
        None,
        "CB324",
    ),
    "direction beyond 1": Bad(nr6(EXT_AXIS_VECTOR_1=(0, 0, 2)), ("MD62937", "-1 to 1"), "VECTOR_1[2]=2", None, "CB106"),
    "flange axes on five axes": Bad(
        robx_text(ARM5, axes_in=(1, 2, 3, 4, 5, 0, 0, 0, 0, 0, 0, 0, 7)),
        ("robot of six axes",),
        "[12]=7",
        75373,
        "CB326",
    ),
    "gripper-referred on five axes": Bad(
        robx_text({**ARM5, "GRIP_REL_RESET_MODE": 2}), ("six axes", "9.2.1"), "RESET_MODE=2", 75321, "CB327"
    ),
    "limits reversed": Bad(
        with_line("$MA_POS_LIMIT_MINUS[AX2]=90\n$MA_POS_LIMIT_PLUS[AX2]=-90"),
        ("A2", "90 to -90"),
        "PLUS[AX2]",
        None,
        "CB114",
    ),
    "predefined tool direction": Bad(
        robx_text({**NR6, "CC_TOA_START_NUM": -1}, extra="$TC_DPV[1,1]=3"), ("$TC_DPV = 3",), "$TC_DPV", None, "CB336"
    ),
    "second channel at fault": Bad(
        nr6() + nr6(NUM_AXES=5).replace("CHANDATA(1)", "CHANDATA(2)").replace("RPY[0]=0", "RPY[0]=200"),
        ("MD62909", "-180 to 180"),
        "RPY[0]=200",
        None,
        "CB106",
    ),
}
