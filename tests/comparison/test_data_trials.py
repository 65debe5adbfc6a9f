"""Machine data: a wrong sign or value is named from recorded poses, with its line, and nothing else is."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.comparison.data_trials import DataTrial, Evidence, try_data
from chainbuild.comparison.samples import make_samples
from chainbuild.formats.entries import Datum
from chainbuild.formats.machine import Machine
from chainbuild.machines import shipped_path
from chainbuild.tables.recording import Recording

GANTRY = "trafo[0].id 9\ntrafo[0].param[0] 1800000\ntrafo[0].param[1] 3000000\ntrafo[0].param[4] -400000\nEnde\n"
CALIBRATED = "comau_calibrated"
TOLERANCE = (1e-5, 1e-4)


def datum(machine: Machine, name: str) -> Datum:
    return next(one for one in machine.geometry() if name in (one.name, one.symbol))


def recorded(machine: Machine, there: Machine, compared: str = "pose", count: int = 8) -> Recording:
    """Return what a machine with other data shows."""
    robot = chainbuild.Robot(there.trial_chain())
    axes = make_samples(chainbuild.Robot(machine.chain()), count, ("random",)).axes
    poses = np.array([robot.fk(row).homogeneous for row in axes])
    return Recording(axes, poses, compared)


def tried(machine: Machine, there: Machine, compared: str = "pose", count: int = 8) -> list[DataTrial]:
    """Return the data that would make the poses of another machine agree."""
    recording = recorded(machine, there, compared, count)
    evidence = Evidence(recording.axes, recording.poses, recording.compared, TOLERANCE)
    return [trial for trial in try_data(machine, chainbuild.Selection(), {}, evidence) if trial.agrees]


def named(machine: Machine, there: Machine, compared: str = "pose", count: int = 8) -> list[dict[str, float]]:
    """Return names and values of the data that would make the poses of another machine agree."""
    found = tried(machine, there, compared, count)
    return [{one.name: value for one, value in trial.values.items()} for trial in found]


@pytest.fixture
def gantry(tmp_path: Path) -> Machine:
    path = tmp_path / "gantry.lis"
    path.write_text(GANTRY, "utf-8")
    return chainbuild.load(path)


@pytest.mark.parametrize("compared", ["pose", "direction", "position"])
def test_a_wrong_sign_is_named_with_its_line(gantry: Machine, compared: str) -> None:
    there = gantry.with_values({datum(gantry, "HD5"): 40.0})
    (trial,) = tried(gantry, there, compared)
    ((one, value),) = trial.values.items()
    assert (one.name, one.symbol, one.value, value, one.unit) == ("trafo[0].param[4]", "HD5", -40.0, 40.0, "mm")
    assert one.span is not None
    assert one.span.line == 4
    assert trial.position_error < 1e-9


@pytest.mark.parametrize(
    ("name", "symbol", "value"),
    [
        ("oblique_head_kin11", "HD3", 52.0),  # tilt of an axis: degree 2
        ("cardan_head_kin59", "HD7", 52.0),  # limits of the head leave no whole turn: by steps
        ("ca_head_kin9", "HD3", 12.5),  # not in the file
        ("geared_head_kin28", "HD6", 20.0),
        ("palletiser_kin96", "HD3", 1270.0),
        ("gantry_robot_kin210", "trafo[2].param[8]", 431.7),  # a member of a coupling
        ("kr6r900", "$MC_ROBX_TX3P3_POS[2]", -35.0),
    ],
)
def test_a_wrong_value_is_named(name: str, symbol: str, value: float) -> None:
    machine = chainbuild.load(name)
    one = datum(machine, symbol)
    assert {one.name: value} in named(machine, machine.with_values({one: value}))


def test_every_datum_that_explains_the_poses_is_named() -> None:
    machine = chainbuild.load("ac_table_kin58")
    there = machine.with_values({datum(machine, "HD1"): 177.0})
    names = [set(one) for one in named(machine, there)]
    assert {"trafo[0].param[0]"} in names
    assert len(names) > 1


@pytest.mark.parametrize(
    ("name", "direction", "zeros"),
    [
        ("kr6r900", "$MC_ROBX_AXES_DIR[4]", ("$MC_ROBX_MAMES[3]", "$MC_ROBX_MAMES[5]")),
        ("kr6r900_2", "HD25", ("trafo[0].param[36]", "trafo[0].param[38]")),
    ],
)
def test_a_reversed_wrist_axis_has_a_twin(name: str, direction: str, zeros: tuple[str, str]) -> None:
    machine = chainbuild.load(name)
    one = datum(machine, direction)
    found = named(machine, machine.with_values({datum(machine, zero): 180.0 for zero in zeros}))
    assert {one.name: one.others[0]} in found
    assert dict.fromkeys(zeros, 180.0) in found
    recording = recorded(machine, machine.with_values({one: one.others[0]}))
    explanation = chainbuild.crosscheck(chainbuild.Robot(machine.chain()), recording).explanation
    assert explanation is not None
    a4, a5, a6 = (axis.name for axis in machine.chain().axes[3:])
    assert explanation.axes == (a5,)
    twin = f"in place of {a5} reversed the zeros of {a4} and {a6} off by 180 deg, which is the same arm"
    assert explanation.others == (twin,)


def test_noise_is_not_a_datum(gantry: Machine) -> None:
    recording = recorded(gantry, gantry)
    poses = recording.poses.copy()
    poses[:, :3, 3] += np.random.default_rng(2).normal(size=(len(poses), 3)) * 0.01
    evidence = Evidence(recording.axes, poses, "position", TOLERANCE)
    found = try_data(gantry, chainbuild.Selection(), {}, evidence)
    assert found
    assert all(not trial.agrees and trial.position_error > 1e-3 for trial in found)


def test_two_poses_name_nothing(gantry: Machine) -> None:
    there = gantry.with_values({datum(gantry, "HD5"): 40.0})
    assert named(gantry, there, count=2) == []


def test_the_progress_is_told(gantry: Machine) -> None:
    recording = recorded(gantry, gantry.with_values({datum(gantry, "HD5"): 40.0}))
    evidence = Evidence(recording.axes, recording.poses, "pose", TOLERANCE)
    told: list[tuple[int, int]] = []
    try_data(gantry, chainbuild.Selection(), {}, evidence, lambda done, total: told.append((done, total)))
    assert told == [(n, 10) for n in range(1, 11)]  # and the tool length


@pytest.mark.parametrize(
    "name", ["ca_head_kin9", "kr6r900", "gantry_robot_kin210", "irb2600_table", "parallelogram_nr"]
)
def test_a_machine_with_its_own_values_is_the_same(name: str) -> None:
    machine = chainbuild.load(name)
    own = machine.with_values({one: one.value for one in machine.geometry()})
    here, there = chainbuild.Robot(machine.chain()), chainbuild.Robot(own.chain())
    tried = chainbuild.Robot(own.trial_chain())
    for row in make_samples(here, 5, ("random",)).axes:
        for other in (there, tried):
            np.testing.assert_allclose(other.fk(row).homogeneous, here.fk(row).homogeneous, atol=1e-12)


def test_other_values_keep_their_places(gantry: Machine) -> None:
    before = datum(gantry, "HD5")
    after = datum(gantry.with_values({before: 41.5}), "HD5")
    assert (after.value, after.span) == (41.5, before.span)
    assert datum(gantry, "HD5") == before  # the machine itself is not changed
    robot, other = (chainbuild.Robot(m.chain()) for m in (gantry, gantry.with_values({before: 41.5})))
    moved = other.fk([0.0] * 5).translation - robot.fk([0.0] * 5).translation
    np.testing.assert_allclose(np.abs(moved), [0.0, 0.0815, 0.0], atol=1e-12)


def test_rules_of_the_geometry_are_passed_only_while_trying() -> None:
    machine = chainbuild.load("kr6r900")
    odd = machine.with_values({datum(machine, "$MC_ROBX_DHPAR4_5ALPHA[0]"): 37.0})
    with pytest.raises(chainbuild.ChainbuildError, match="DHPAR4_5ALPHA"):
        odd.chain()
    assert len(odd.trial_chain().axes) == 6


def test_the_calibrated_arm_is_where_it_was_measured() -> None:
    robot = chainbuild.Robot.load(CALIBRATED)
    # Poses measured on the arm [mm], to 1 µm: public data of another author.
    assert np.abs(robot.fk([0, 0, -90, 0, 0, 0]).translation * 1e3 - [2073.926, 0.0, 2259.005]).max() < 1e-3
    last = robot.fk([10, 20, -70, 30, 20, 10])
    assert np.abs(last.translation * 1e3 - [2418.558, -466.396, 2119.864]).max() < 1e-3
    R = [[0.895723, 0.075436, 0.438167], [-0.331583, 0.769876, 0.545293], [-0.296199, -0.63372, 0.714608]]
    assert np.abs(last.rotation - R).max() < 2e-5


def test_data_of_the_older_package_and_of_the_second_step(tmp_path: Path) -> None:
    shipped = shipped_path("kr6r900")
    assert shipped is not None
    text = re.sub(r"N62\d\d\d \$MC_ROBX_", "$MC_TRAFO6_", shipped.read_text("utf-8"))
    older = tmp_path / "older.tea"
    older.write_text(text.replace("TRAFO_TYPE_1=4100", "TRAFO_TYPE_1=4099"), "utf-8")
    steps = tmp_path / "steps.lis"
    upper = "kin_step[1].trafo[0].id 58\nkin_step[1].trafo[0].param[5] -600000\n"
    steps.write_text(f"kin_step[0].trafo[0].id 9\nkin_step[0].trafo[0].param[1] 3000000\n{upper}Ende\n", "utf-8")
    for path, kinematic, name in (
        (older, None, "$MC_TRAFO6_TX3P3_POS[2]"),
        (steps, (9, 58), "kin_step[1].trafo[0].param[5]"),
    ):
        machine = chainbuild.load(path)
        one = next(one for one in machine.geometry(kinematic) if one.name == name)
        robots = [chainbuild.Robot(m.chain(kinematic)) for m in (machine, machine.with_values({one: one.value + 50.0}))]
        here, there = (robot.fk(np.zeros(len(robot.axes))).translation for robot in robots)
        assert np.linalg.norm(there - here) == pytest.approx(0.05)
