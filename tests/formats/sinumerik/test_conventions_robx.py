"""Every choice of every ROBX convention changes the pose or the angle as its meaning says."""

from __future__ import annotations

import numpy as np
import pytest

from chainbuild.convention import conventions
from chainbuild.errors import ChainbuildError
from chainbuild.formats.overlay import Overlay
from chainbuild.frames import angles_from_matrix
from chainbuild.writers.models.notes import header
from tests.kit.robx_files import ARM5, CC4, FLANGE, NR6, TABLE, TE4_ARM, F, R, T, chain_of, close, pose_of

AXES = np.array((31, -47, 53, 71, -37, 113), dtype=float)
TESTED: set[str] = set()


def choices(name):
    """Return all choices of a convention for parametrisation, and note that it has a test."""
    TESTED.add(name)
    return sorted(conventions()[name].choices)


def arm_behind(q):
    """What follows on P3 in NR6."""
    wrist = R("z", q[3]) @ R("x", -90) @ R("z", q[4]) @ R("x", 90) @ R("z", q[5])
    return F((795, 0, 115), (0, 90, 0)) @ wrist @ T(z=85)


ARRANGEMENTS = {
    ("ss", "xyz"): (1, lambda q: T(*q[:3])),
    ("ss", "zyx"): (1, lambda q: T(q[2], q[1], q[0])),
    ("cc_linear_sign", "plus"): (2, lambda q: T(y=q[0]) @ T(150) @ R("y", q[1]) @ T(700) @ R("y", q[2])),
    ("cc_linear_sign", "minus"): (2, lambda q: T(y=-q[0]) @ T(150) @ R("y", q[1]) @ T(700) @ R("y", q[2])),
    ("cc_rotary_sign", "plus"): (2, lambda q: T(y=q[0]) @ T(150) @ R("y", q[1]) @ T(700) @ R("y", q[2])),
    ("cc_rotary_sign", "minus"): (2, lambda q: T(y=q[0]) @ T(150) @ R("y", -q[1]) @ T(700) @ R("y", -q[2])),
    ("sc", "zy"): (4, lambda q: T(z=q[0]) @ T(y=q[1]) @ T(150) @ R("y", q[2])),
    ("sc", "yx"): (4, lambda q: T(y=q[0]) @ T(x=q[1]) @ T(150) @ R("y", q[2])),
    ("cs", "zx"): (6, lambda q: R("z", q[0]) @ T(z=q[1]) @ T(150 + q[2])),
    ("cs", "zy"): (6, lambda q: R("z", q[0]) @ T(z=q[1]) @ T(150) @ T(y=q[2])),
    ("cs", "rotary_about_y"): (6, lambda q: R("y", q[0]) @ T(y=q[1]) @ T(150 + q[2])),
    ("rr", "rot_rot_lin"): (5, lambda q: R("z", q[0]) @ T(150) @ R("y", q[1]) @ T(q[2])),
    ("rr", "rot_lin_rot"): (5, lambda q: R("z", q[0]) @ T(150 + q[1]) @ R("y", q[2])),
    ("rr", "lin_rot_rot"): (5, lambda q: T(z=q[0]) @ R("z", q[1]) @ T(150) @ R("y", q[2])),
    ("nn", "zyz"): (7, lambda q: R("z", q[0]) @ T(150) @ R("y", q[1]) @ T(700) @ R("z", q[2])),
    ("nn", "zyx"): (7, lambda q: R("z", q[0]) @ T(150) @ R("y", q[1]) @ T(700) @ R("x", q[2])),
}


@pytest.mark.parametrize(
    ("name", "choice"),
    [(name, choice) for name in dict.fromkeys(key[0] for key in ARRANGEMENTS) for choice in choices(name)],
    ids="-".join,
)
def test_basic_axes(name, choice):
    main, formula = ARRANGEMENTS[name, choice]
    chain = chain_of({**NR6, "MAIN_AXES": main}, conventions={name: choice})
    assert close(pose_of(chain, AXES), F((0, 0, 445)) @ formula(AXES) @ arm_behind(AXES))
    used = {item.convention.name: item for item in chain.conventions}
    assert used[name].choice == choice
    assert used[name].by_user


EXT = {**FLANGE, "TFL_EXT_RPY": (20, 30, -40), "TTCFL_POS": (11, 12, -80), "CC_TOA_START_NUM": 2}
TOOL = "$TC_DP3[1,1]=120\n$TC_DP4[1,1]=13\n$TC_DP5[1,1]=14\n$TC_DPC2[1,1]=15\n$TC_DPC3[1,1]=25\n$TC_DPC4[1,1]=35"


@pytest.mark.parametrize("choice", choices("tfl_ext"))
def test_tfl_ext(choice):
    chain = chain_of(
        EXT,
        axes_in=(1, 2, 3, 4, 5, 6, 0, 0, 0, 0, 0, 0, 7, 8),
        extra=TOOL,
        conventions={"tfl_ext": choice},
    )
    flange = pose_of(chain_of(NR6), AXES)
    turn = T(50) @ R("z", 25) @ T(60, 0, -70) @ R("y", -35)
    E, TC, L, turned = (
        F((0, 0, 0), (20, 30, -40)),
        F((11, 12, -80), (0, 90, 0)),
        T(14, 13, 120),
        F((0, 0, 0), (15, 25, 35)),
    )
    expected = {
        "after_ttcfl": turn @ TC @ E @ L @ turned,
        "after_fl": E @ turn @ TC @ L @ turned,
        "orientation_only": turn @ TC @ L @ E @ turned,
    }
    assert close(pose_of(chain, (*AXES, 25, -35)), flange @ expected[choice])


@pytest.mark.parametrize("choice", choices("axes_dir_index"))
def test_axes_dir_index(choice):
    dirs, zeros = {"internal": ((1, -1, 1), (4, 5, 6)), "input": ((-1, 1, 1), (5, 6, 4))}[choice]
    data = {
        **NR6,
        "MAIN_AXES": 1,
        "AXIS_SEQ": (2, 3, 1, 4, 5, 6),
        "AXES_DIR": (1, -1, 1, 1, 1, 1),
        "MAMES": (4, 5, 6, 0, 0, 0),
    }
    chain = chain_of(data, conventions={"axes_dir_index": choice})
    internal = np.array((AXES[1], AXES[2], AXES[0])) * dirs - zeros
    assert close(pose_of(chain, AXES), F((0, 0, 445)) @ T(*internal) @ arm_behind(AXES))


PARALLELOGRAM = {**NR6, "SPECIAL_KIN": 2, "AXES_DIR": (1, 1, -1, 1, 1, 1), "MAMES": (0, 20, 30, 0, 0, 0)}


@pytest.mark.parametrize("choice", choices("special_kin_2"))
def test_special_kin_2(choice):
    shoulder = {"absolute_pitch": -47 - 20, "relative_at_zero": -47}[choice]
    chain = chain_of(PARALLELOGRAM, conventions={"special_kin_2": choice})
    elbow = (-53 - 30) - shoulder
    basic = R("z", 31) @ T(150) @ R("y", -47 - 20) @ T(700) @ R("y", elbow)
    assert close(pose_of(chain, AXES), F((0, 0, 445)) @ basic @ arm_behind(AXES))


@pytest.mark.parametrize("choice", choices("parallelogram_monitor"))
def test_parallelogram_monitor(choice):
    angle = {"mcs": -47 + 53 + 180, "elbow": 180 - ((-53 - 30) - (-47 - 20))}[choice]
    data = {**PARALLELOGRAM, "SW_LIMITS_PARALLEL": (20, 150)}
    chain = chain_of(data, conventions={"parallelogram_monitor": choice})
    (constraint,) = chain.constraints
    assert constraint.sum.value(AXES) == pytest.approx(angle)
    assert (constraint.lower, constraint.upper, constraint.alarm) == (20, 150, 75329)
    assert constraint.margin(AXES) == pytest.approx(min(angle - 20, 150 - angle))


@pytest.mark.parametrize("choice", choices("table_origin"))
def test_table_origin(choice):
    origin = {"robot_base": (900, 50, -200), "wo": (0, 0, 0), "riding": (1180, 50, -200)}[choice]
    moved = {"TROWO_POS": (900, 50, -200), "TROWO_RPY": (10, 20, 30), "EXT_AXIS_VECTOR_1": (1, 0, 0)}
    data = {**moved, "EXT_AX_OFFSET": (20, 0, 0)}
    chain = chain_of({**TABLE, **data}, axes_in=range(1, 7 + 1), conventions=None)
    still = pose_of(chain, (*AXES, 300))
    chain = chain_of(
        {**TABLE, **data},
        axes_in=(1, 2, 3, 4, 5, 6, 7, 0, 0, 8, 9),
        conventions={"table_origin": choice},
    )
    workpiece = still @ np.linalg.inv(pose_of(chain, (*AXES, 300, 25, -35)))
    assert close(workpiece, T(*origin) @ T(900, 0, 200) @ R("z", 25) @ T(30) @ R("y", -35) @ T(z=40))


TROWO = {"TROWO_POS": (900, 50, -200), "TROWO_RPY": (10, 20, 30)}


@pytest.mark.parametrize("choice", choices("gripper_trowo"))
def test_gripper_trowo(choice):
    chain = chain_of({**NR6, **TROWO}, kinematic="gripper", conventions={"gripper_trowo": choice})
    base = F((900, 50, -200), (10, 20, 30))
    base = base if choice == "as_is" else np.linalg.inv(base)
    assert close(pose_of(chain, AXES), np.linalg.inv(base @ pose_of(chain_of(NR6), AXES)))


@pytest.mark.parametrize("choice", choices("gripper_flange_data"))
def test_gripper_flange_data(choice):
    data = {**NR6, "TTCFL_POS": (11, 12, -80), "TTCFL_RPY": (0, 90, 0), "TFL_EXT_RPY": (20, 30, -40)}
    chain = chain_of(data, kinematic="gripper", extra="$TC_DP3[1,1]=120", conventions={"gripper_flange_data": choice})
    flange = np.linalg.inv(pose_of(chain_of(NR6), AXES))
    G, H = F((11, 12, -80), (0, 90, 0)) @ F((0, 0, 0), (20, 30, -40)), T(z=120)
    expected = {
        "unused": flange @ H,
        "robot_side": np.linalg.inv(G) @ flange @ H,
        "tool_side": flange @ G @ H,
    }
    assert close(pose_of(chain, AXES), expected[choice])


BOTH = (1, 2, 3, 4, 5, 6, 0, 0, 0, 7, 8, 0, 9)  # two axes under the workpiece, one at the flange


@pytest.mark.parametrize("choice", choices("leftover_joint_offset"))
def test_leftover_joint_offset(choice):
    data = {**FLANGE, **TABLE, "EXT_ROT_JOINT_OFFSET_2": (5, 6, 7), "EXT_FL_ROT_BASE_OFFSET": (50, 0, 0)}
    chain = chain_of(data, axes_in=BOTH, conventions={"leftover_joint_offset": choice})
    counts = choice == "counts"
    table = T(900, 0, 200) @ R("z", 25) @ T(30) @ R("y", -35) @ (T(5, 6, 7) if counts else T()) @ T(z=40)
    flange = T(50) @ R("z", 15) @ (T(60, 0, -70) if counts else T()) @ F((0, 0, -80), (0, 90, 0))
    expected = np.linalg.inv(table) @ pose_of(chain_of(NR6), AXES) @ flange
    assert close(pose_of(chain, (*AXES, 25, -35, 15)), expected)
    assert [f.code for f in chain.findings].count("CB335") == 2


def test_leftover_joint_offset_is_asked_only_where_there_is_one():
    chain = chain_of({**TABLE}, axes_in=(1, 2, 3, 4, 5, 6, 0, 0, 0, 7, 8))
    assert "leftover_joint_offset" not in [item.convention.name for item in chain.conventions]


@pytest.mark.parametrize("choice", choices("gripper_extra_axes"))
def test_gripper_extra_axes(choice):
    data = {**FLANGE, **TABLE, "EXT_FL_ROT_JOINT_OFF_1": (0, 0, 0), "TTCFL_POS": (0, 0, 0), "TTCFL_RPY": (0, 0, 0)}
    options = {"axes_in": BOTH, "kinematic": "gripper", "conventions": {"gripper_extra_axes": choice}}
    if choice == "refused":
        with pytest.raises(ChainbuildError, match="gripper_extra_axes=built") as caught:
            chain_of(data, **options)
        assert (caught.value.code, caught.value.parameter) == ("CB328", "$MC_TRAFO_AXES_IN_1")
        return
    chain = chain_of(data, extra="$TC_DP3[1,1]=120", **options)
    table = T(900, 0, 200) @ R("z", 25) @ T(30) @ R("y", -35) @ T(z=40)
    carried = pose_of(chain_of(NR6), AXES) @ T(50) @ R("z", 15)
    assert close(pose_of(chain, (*AXES, 25, -35, 15)), np.linalg.inv(carried) @ table @ T(z=120))
    assert [axis.carries for axis in chain.axes[6:]] == ["tool", "tool", "workpiece"]


LENGTHS = {
    "cyclic": {17: (14, 13, 120), 18: (13, 120, 14), 19: (120, 14, 13)},
    "swapped": {17: (14, 13, 120), 18: (14, 120, 13), 19: (120, 13, 14)},
    "as_g17": {17: (14, 13, 120), 18: (14, 13, 120), 19: (14, 13, 120)},
}


@pytest.mark.parametrize("plane", [17, 18, 19])
@pytest.mark.parametrize("choice", choices("tool_length_plane"))
def test_tool_length_plane(choice, plane):
    shift = LENGTHS[choice][plane]
    chain = chain_of(
        NR6,
        extra="$TC_DP3[1,1]=120\n$TC_DP4[1,1]=13\n$TC_DP5[1,1]=14",
        overlay=Overlay(tool={"plane": plane}),
        conventions={"tool_length_plane": choice},
    )
    assert close(pose_of(chain, AXES), pose_of(chain_of(NR6), AXES) @ T(*shift))


@pytest.mark.parametrize("tool_dir", [0, -1, 1])
@pytest.mark.parametrize("choice", choices("dpvn_axis"))
def test_dpvn_axis(choice, tool_dir):
    data = {**NR6, "CC_TOA_START_NUM": -1, "TOOL_DIR": tool_dir}
    # G17: components 3, 4, 5 are Z, Y, X. The normal has a part along the direction, which must not count.
    vectors = "$TC_DPV3[1,1]=4\n$TC_DPV5[1,1]=3\n$TC_DPVN3[1,1]=4\n$TC_DPVN4[1,1]=2\n$TC_DPVN5[1,1]=3"
    chain = chain_of(data, extra=vectors, conventions={"dpvn_axis": choice})
    turn = (np.linalg.inv(pose_of(chain_of(NR6), AXES)) @ pose_of(chain, AXES))[:3, :3]
    direction, normal = np.array((0.6, 0.0, 0.8)), np.array((0.0, 1.0, 0.0))
    along = 2 if tool_dir == 1 else 0
    normal_axis = 1 if choice == "y" else 2 - along
    assert np.abs(turn[:, along] - direction).max() < 1e-12
    assert np.abs(turn[:, normal_axis] - normal).max() < 1e-12
    assert np.linalg.det(turn) == pytest.approx(1.0)


SCARA = {**CC4, "SPECIAL_FEATURE_MASK": 1, "C_ANGLE_OFFSET": 25}
SCARA_AXES = np.array((120, 35, -25, 415), dtype=float)
SCARA_Q = SCARA_AXES * CC4["AXES_DIR"] - CC4["MAMES"]


@pytest.mark.parametrize("choice", choices("c_sum"))
def test_c_sum(choice):
    """With the last axis turned round, `plain` adds it all the same, `signed` counts it negatively."""
    data = {**SCARA, "TX3P3_RPY": (0, 0, 90), "TFLWP_RPY": (0, 90, 0)}
    chain = chain_of(data, conventions={"c_sum": choice})
    _, q2, q3, q4 = SCARA_Q
    s_basic, s_wrist = _signs(data)
    expected = q2 + q3 + q4 if choice == "plain" else s_basic * (q2 + q3) + s_wrist * q4
    assert (s_basic, s_wrist) != (1, 1)
    assert chain.absolute_c.value(SCARA_AXES) == pytest.approx(expected - 25)


def _signs(data):
    base, wrist = F((0, 0, 0), data["TIRORO_RPY"]), F((0, 0, 0), data["TX3P3_RPY"])
    flange_x = (base @ wrist @ F((0, 0, 0), data["TFLWP_RPY"]))[:3, 0]
    basic, fourth = base[:3, 1] @ flange_x, (base @ wrist)[:3, 2] @ flange_x
    assert abs(abs(basic) - 1) < 1e-12
    assert abs(abs(fourth) - 1) < 1e-12
    return (-1 if basic < 0 else 1), (-1 if fourth < 0 else 1)


@pytest.mark.parametrize("choice", choices("c_offset"))
def test_c_offset(choice):
    sign = {"subtract": -1, "add": 1}[choice]
    chain = chain_of(SCARA, conventions={"c_offset": choice})
    assert chain.absolute_c.value(SCARA_AXES) == pytest.approx(SCARA_Q[1:].sum() + sign * 25)


def test_signed_sum_follows_the_angle_of_the_pose():
    """Over many turns the change of the absolute C is the change of the pose's C, without its jumps."""
    data = {**SCARA, "TX3P3_RPY": (0, 0, 90), "TFLWP_RPY": (0, 90, 0)}
    chain = chain_of(data, conventions={"c_sum": "signed"})

    def shown(axes):
        return angles_from_matrix(chain.angle_mode, pose_of(chain, axes)[:3, :3])[2]

    start = SCARA_AXES
    for step in range(1, 30):
        axes = start + step * np.array((3.0, 17.0, -5.0, 61.0))
        turned = chain.absolute_c.value(axes) - chain.absolute_c.value(start)
        off = turned - (shown(axes) - shown(start))
        assert (off + 180) % 360 - 180 == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("choice", choices("tflwp_default_c"))
def test_tflwp_default_c(choice):
    data = {name: value for name, value in NR6.items() if name != "TFLWP_RPY"}
    chain = chain_of(data, conventions={"tflwp_default_c": choice})
    plain = pose_of(chain_of(NR6), AXES)
    assert close(pose_of(chain, AXES), plain @ F((0, 0, 0), (0, -90, float(choice))))
    assert not any(item.convention.name == "tflwp_default_c" for item in chain_of(NR6).conventions)


HANDLED = "$MC_MM_NUM_SINGULARITY_BLOCKS=1"


@pytest.mark.parametrize("choice", choices("singularity_measure"))
def test_singularity_measure(choice):
    """It changes no pose and stands in no URDF; what it compares is tested with the verdicts."""
    chain = chain_of(NR6, conventions={"singularity_measure": choice})
    assert "singularity_measure" not in header(chain)
    assert chain.singularity_watch.measure == choice
    assert close(pose_of(chain, AXES), pose_of(chain_of(NR6), AXES))


@pytest.mark.parametrize("choice", choices("singular_block"))
def test_singular_block(choice):
    chain = chain_of(NR6, extra=HANDLED, conventions={"singular_block": choice})
    assert chain.singularity_watch.block == choice
    assert close(pose_of(chain, AXES), pose_of(chain_of(NR6), AXES))


@pytest.mark.parametrize(
    ("data", "axes_in", "extra", "handled", "lacks"),
    [
        (NR6, None, HANDLED, True, ""),
        (NR6, None, "", None, "is not in the file"),
        (NR6, None, "$MC_MM_NUM_SINGULARITY_BLOCKS=0", False, "MD28592 $MC_MM_NUM_SINGULARITY_BLOCKS is 0"),
        (ARM5, None, HANDLED, True, "it needs 6 robot axes, here are 5"),
        (CC4, None, HANDLED, True, "it needs 6 robot axes, here are 4"),
        (TABLE, BOTH[:11], HANDLED, True, ""),
        ({**FLANGE, **TABLE}, BOTH, HANDLED, True, ""),
        ({**FLANGE, **TABLE}, (*BOTH, 10), HANDLED, True, "it permits 3 additional axes, here are 4"),
    ],
)  # fmt: skip
def test_singular_block_is_asked_only_where_the_control_handles_them(data, axes_in, extra, handled, lacks):
    """ROBX manual 10.1.2, 10.2.1: six robot axes, at most three additional ones, MD28592 = 1."""
    chain = chain_of(data, axes_in=axes_in, extra=extra)
    watch = chain.singularity_watch
    assert watch.handled is handled
    assert (lacks in watch.lacks) if lacks else (watch.lacks == "")
    assert ("singular_block" in [item.convention.name for item in chain.conventions]) == (not lacks)


def test_conventions_without_bearing_are_not_listed_and_noted():
    chain = chain_of(NR6, conventions={"cs": "zy"})
    assert [item.convention.name for item in chain.conventions] == ["singularity_measure"]
    assert [finding.code for finding in chain.findings] == ["CB339"]
    assert [item.convention.name for item in chain_of(TE4_ARM).conventions] == ["singularity_measure"]


def test_every_convention_has_a_test():
    """And so has every choice: the parameters above come from the register."""
    robx = {c.name for c in conventions().values() if any(item.startswith("ROBX") for item in c.applies)}
    assert robx == TESTED
