"""RobxMachine: transformations, channels, limits, parameters, typed data."""

from __future__ import annotations

import math

import pytest

from chainbuild.errors import ConventionError, MachineDataError, OverlayError
from chainbuild.formats.overlay import Overlay
from tests.kit.robx_files import CC4, NR6, TE4_ARM, chain_of, read, robx_text

LIMITS = """
N36100 $MA_POS_LIMIT_MINUS[AX1]=-170
N36110 $MA_POS_LIMIT_PLUS[AX1]=175
N32000 $MA_MAX_AX_VELO[AX1]=20
"""


def test_limits_by_machine_axis():
    first, second, *_ = chain_of(NR6, extra=LIMITS).axes
    assert (first.name, first.lower, first.upper, first.assumed) == ("A1", -170, 175, False)
    assert first.max_speed == pytest.approx(120)  # 20 rpm
    assert (second.lower, second.upper, second.assumed) == (-360, 360, True)


def test_limits_follow_the_inputs_and_the_axis_configuration():
    chain = chain_of(NR6, axes_in=(3, 2, 1, 4, 5, 6), extra=LIMITS)
    assert [axis.assumed for axis in chain.axes] == [True, True, False, True, True, True]
    configured = """
    $MC_AXCONF_MACHAX_USED[0]=9
    $MC_AXCONF_MACHAX_USED[1]=1
    $MN_AXCONF_MACHAX_NAME_TAB[8]="SWING"
    $MA_POS_LIMIT_MINUS[Swing]=-5
    $MA_POS_LIMIT_PLUS[AX9]=6
    """
    first, second, *_ = chain_of(NR6, extra=LIMITS + configured).axes
    assert (first.lower, first.upper) == (-5, 6)
    assert (second.lower, second.upper) == (-170, 175)


def test_logical_machine_axes():
    text = '$MN_AXCONF_LOGIC_MACHAX_TAB[1]="AX1"'
    chain = chain_of(NR6, extra=LIMITS + text)
    assert chain.axes[1].upper == 175


def test_linear_axes_have_mm_and_speed_in_mm_per_s():
    chain = chain_of({**NR6, "MAIN_AXES": 1}, extra=LIMITS.replace("=20", "=6000"))
    first = chain.axes[0]
    assert (first.kind, first.unit, first.max_speed) == ("linear", "mm", pytest.approx(100))


def test_endless_axes_have_no_limits():
    chain = chain_of({**NR6, "AXES_TYPE": (4, 3, 3, 3, 3, 4)}, extra=LIMITS)
    assert [axis.endless for axis in chain.axes] == [True, False, False, False, False, True]
    assert chain.axes[0].assumed
    modulo = chain_of(NR6, extra="$MA_ROT_IS_MODULO[AX6]=1")
    assert modulo.axes[5].endless


def test_one_sided_and_unset_limits():
    chain = chain_of(NR6, extra="$MA_POS_LIMIT_MINUS[AX1]=-170\n$MA_POS_LIMIT_PLUS[AX1]=100000000")
    assert (chain.axes[0].lower, chain.axes[0].upper, chain.axes[0].assumed) == (-170, 360, True)
    assert [finding.code for finding in chain.findings] == ["CB115"]
    unset = "$MA_POS_LIMIT_MINUS[AX1]=-100000000\n$MA_POS_LIMIT_PLUS[AX1]=100000000"
    assert chain_of(NR6, extra=unset).axes[0].assumed


@pytest.mark.parametrize(("line", "lower", "upper"), [("PLUS[AX1]=-400", -401, -400), ("MINUS[AX1]=400", 400, 401)])
def test_a_limit_beyond_the_other_side_that_is_assumed_leaves_a_range(line, lower, upper):
    axis = chain_of(NR6, extra=f"$MA_POS_LIMIT_{line}").axes[0]
    assert (axis.lower, axis.upper, axis.assumed) == (lower, upper, True)


def test_overlay_limits_win():
    overlay = Overlay(limits={"A1": (-10.0, 20.0)}, endless=("A6",), speeds={"A2": 33.0})
    axes = chain_of(NR6, extra=LIMITS, overlay=overlay).axes
    assert (axes[0].lower, axes[0].upper, axes[1].max_speed, axes[5].endless) == (-10, 20, 33, True)
    with pytest.raises(OverlayError, match="no axis 'A7'"):
        read(robx_text(NR6), overlay=Overlay(limits={"A7": (0.0, 1.0)}))


TWO = """
CHANDATA(2)
$MC_TRAFO_TYPE_1=16
$MC_TRAFO_TYPE_3=4100
""" + "".join(f"$MC_TRAFO_AXES_IN_3[{n}]={n + 11}\n" for n in range(4))


def two_channels():
    second = robx_text(CC4, axes_in=()).split("\n")
    return robx_text(NR6) + TWO + "\n".join(line for line in second if "ROBX" in line)


def test_two_channels():
    machine = read(two_channels())
    entries = machine.kinematics()
    assert [(e.id, e.name, e.channel, e.default) for e in entries] == [
        (1, "ROBX", 1, True),
        (1, "gripper", 1, False),
        (3, "ROBX", 2, False),
    ]
    assert [entry.type for entry in entries] == ["ROBX NR, 6 axes", "ROBX NR, 6 axes", "ROBX CC, 4 axes"]
    chain = machine.chain()
    assert chain.kinematic == "ROBX NR"
    assert "CB340" in {finding.code for finding in chain.findings}
    second = machine.chain(channel=2)
    assert second.kinematic == "ROBX CC"
    assert second.name != chain.name
    assert machine.chain(kinematic=3, channel=2).kinematic == "ROBX CC"
    with pytest.raises(MachineDataError, match="no kinematic 1"):
        machine.chain(kinematic=1, channel=2)
    with pytest.raises(MachineDataError, match="channel 3"):
        machine.chain(channel=3)


def test_two_transformations_in_one_channel():
    more = "$MC_TRAFO_TYPE_2=4100\n" + "".join(f"$MC_TRAFO_AXES_IN_2[{n}]={n + 11}\n" for n in range(6))
    machine = read(robx_text(NR6, extra=more))
    assert [entry.id for entry in machine.kinematics() if entry.name == "ROBX"] == [1, 2]
    names = {machine.chain().name, machine.chain(kinematic=2).name, machine.chain("gripper").name}
    assert len(names) == 3


@pytest.mark.parametrize("wanted", [1, "1", "ROBX", None])
def test_choosing_the_transformation(wanted):
    assert read(robx_text(NR6)).chain(kinematic=wanted).kinematic == "ROBX NR"


@pytest.mark.parametrize("wanted", [7, "other", "gripper2"])
def test_unknown_transformation(wanted):
    with pytest.raises(MachineDataError, match="configures no kinematic"):
        read(robx_text(NR6)).chain(kinematic=wanted)


def test_gripper_on_fewer_axes_is_the_controllers_alarm():
    with pytest.raises(MachineDataError) as caught:
        read(robx_text(TE4_ARM)).chain(kinematic="gripper")
    assert caught.value.alarm == 75321


def test_older_package():
    machine = read(robx_text(TE4_ARM, package="TRAFO6"))
    (entry,) = machine.kinematics()
    assert (entry.type, machine.chain().kinematic) == ("TE4 NR, 4 axes", "TE4 NR")
    row = next(row for row in machine.parameters() if row.name == "$MC_TRAFO6_NUM_AXES")
    assert (row.symbol, row.value) == ("MD62605", 4)


def test_parameters():
    rows = {row.name: row for row in read(robx_text(NR6, extra="$TC_DP3[1,1]=120")).parameters()}
    given = rows["$MC_ROBX_TX3P3_POS[0]"]
    assert (given.symbol, given.value, given.unit, given.given) == ("MD62908", 795, "mm", True)
    assert given.span.text == "$MC_ROBX_TX3P3_POS[0]=795"
    assert given.source.startswith("ROBX manual 11.2.1")
    default = rows["$MC_ROBX_MAMES[0]"]
    assert (default.value, default.unit, default.given, default.span) == (0, "deg", False, None)
    assert rows["$MC_ROBX_NUM_AXES"].value == 6
    assert isinstance(rows["$MC_ROBX_NUM_AXES"].value, int)
    assert rows["$MC_ROBX_SPINDLE_SIGN[0]"].value is None  # the manual's default is lost
    assert rows["$TC_DP3"].value == 120
    assert len([name for name in rows if "ROBX" in name]) > 150
    gantry = {row.name: row for row in read(robx_text({**NR6, "MAIN_AXES": 1})).parameters()}
    assert gantry["$MC_ROBX_MAMES[2]"].unit == "mm"
    assert gantry["$MC_ROBX_MAMES[3]"].unit == "deg"


def test_control_side_data_are_typed():
    (robx,) = read(
        robx_text({**NR6, "A_DBD_START_INDEX": 8, "GRIP_REL_RESET_MODE": 1, "ITERMAXCOUNT": 12, "ITERLIMIT2": 0.5})
    ).transformations
    assert (robx.control.a_dbd_start_index, robx.control.grip_reset_mode) == (8, 1)
    assert (
        robx.control.solver.max_count,
        robx.control.solver.precision,
        robx.control.solver.limit_deg,
        robx.control.solver.limit2_deg,
    ) == (
        12,
        1e-6,
        3.0,
        0.5,
    )


def test_dynamics_are_si():
    (robx,) = read(
        robx_text({**NR6, "VELCP": (60000, 120000, 180000), "VELORI": (60, 30, 15), "ACCORI": (1, 2, 3)})
    ).transformations
    dynamics = robx.control.dynamics
    assert dynamics.velocity == pytest.approx((1, 2, 3))
    assert dynamics.acceleration == (0.5, 0.5, 0.5)
    assert dynamics.angular_velocity == pytest.approx((math.tau, math.pi, math.pi / 2))
    assert dynamics.angular_acceleration == pytest.approx((math.tau, 2 * math.tau, 3 * math.tau))
    assert (dynamics.reduction, dynamics.filter_time) == (1.0, 0.024)


def test_conventions_from_overlay_and_argument():
    data = {**NR6, "MAIN_AXES": 6}
    overlay = Overlay(conventions={"cs": "zy"})
    used, _ = chain_of(data, overlay=overlay).conventions
    assert (used.convention.name, used.choice) == ("cs", "zy")
    used, _ = chain_of(data, overlay=overlay, conventions={"cs": "rotary_about_y"}).conventions
    assert used.choice == "rotary_about_y"
    with pytest.raises(ConventionError, match="no choice 'up'"):
        chain_of(data, conventions={"cs": "up"})


def test_titles_and_names():
    machine = read(robx_text(NR6), file="my arm #3.tea", overlay=Overlay(name="Cell 4"))
    chain = machine.chain()
    assert (machine.name, chain.name, chain.title) == ("my_arm__3", "my_arm__3", "Cell 4")
    assert machine.kinematics()[0].title == "Articulated arm (NR), 6 axes, central wrist"


def test_notes_are_a_machine_file_too():
    text = robx_text(NR6).replace("$MC", r"\$MC").replace("=", " ").replace("N24100", "MD24100")
    assert read(text).chain().kinematic == "ROBX NR"
