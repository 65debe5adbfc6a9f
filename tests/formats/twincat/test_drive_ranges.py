"""Ranges that limits of drives leave, the places of such limits in an overlay, and the channel's names in messages."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild import ChainbuildError, MapSpec, Robot, make_map
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.drives import AffineDrives, DrivesSideBySide
from chainbuild.comparison.samples import make_samples
from chainbuild.formats.twincat.maps.drives import BevelAxes, BevelDrives
from chainbuild.inspect.sweep import rest_pose, swept_poses
from tests.kit.machine_files import machine_file
from tests.kit.named_axes import bezeichnungen

LINEAR = "X = [-3000, 3000]\nY = [-3000, 3000]\nZ = [-3000, 3000]\n"
# KIN_TYP 28, A_drive = 2·A + C/3 or 2·A + C/2.
THIRD = {11: 1, 12: 3, 13: 1, 14: 1, 15: 2, 16: 1}
HALF = {**THIRD, 12: 2}
CARDAN = {6: 450000}
NAMES = {3: "C_DREH", 4: "W_TILT"}


def text_of(kin_typ: int, parameters: Mapping[int, int], names: Mapping[int, str] | None = None) -> str:
    """Return a list; parameters by their index."""
    rows = [f"trafo[0].param[{n}] {value}\n" for n, value in parameters.items()]
    return f"trafo[0].id {kin_typ}\n{''.join(rows)}{bezeichnungen(names or {})}Ende\n"


def geared(folder: Path, limits: str = "C = [-180, 180]\n", gear: Mapping[int, int] = THIRD) -> Robot:
    overlay = f"[limits]\n{LINEAR}{limits}[limits.drives]\nA = [-100, 100]\n"
    return Robot.load(machine_file(folder, text_of(28, gear), overlay))


def test_what_is_shown_and_sampled_is_the_whole_range(tmp_path: Path) -> None:
    """A drive at ±100: ±50 at C = 0, but ±80 with C at its ends."""
    robot = geared(tmp_path)
    assert robot.axes[4].widest == (-80.0, 80.0)
    assert [bound[4] for bound in shown_limits(robot.chain)] == [-80.0, 80.0]
    assert [bound[4] for bound in shown_limits(robot.chain, at_middle=True)] == [-50.0, 50.0]
    samples = make_samples(robot, 300)
    assert np.abs(samples.axes[:, 4]).max() == 80.0
    assert robot.limits.inside_rows(samples.axes).all()
    assert samples.kinds.count("random") == 100


def test_maps_reach_the_whole_range(tmp_path: Path) -> None:
    robot = geared(tmp_path)
    found = make_map(robot, MapSpec("axes", ("C", "A"), cells=20), workers=1)
    a = found.grid.edges[1]
    assert (a[0], a[-1]) == (-80.0, 80.0)
    centres = [(edges[:-1] + edges[1:]) / 2.0 for edges in found.grid.edges]
    allowed = np.abs(centres[0][:, None] / 3.0 + 2.0 * centres[1][None, :]) <= 100.0
    assert (found.count.reshape(20, 20) > 0).tolist() == allowed.tolist()


def test_the_page_moves_an_axis_as_far_as_the_others_let_it(tmp_path: Path) -> None:
    """The middle of C is 100, it rests at 0: A moves ±50 there."""
    robot = geared(tmp_path, "C = [-100, 300]\nA = [-360, 360]\n", HALF)
    assert (robot.axes[4].lower, robot.axes[4].upper) == (-75.0, 25.0)
    assert rest_pose(robot)[3:].tolist() == [0.0, 0.0]
    swept = np.array(swept_poses(robot, rest_pose(robot)))
    assert robot.limits.inside_rows(swept).all()
    assert [swept[:, 4].min(), swept[:, 4].max()] == [-50.0, 50.0]
    assert [swept[:, 3].min(), swept[:, 3].max()] == [-100.0, 200.0]


def test_the_page_moves_a_bent_axis_likewise(tmp_path: Path) -> None:
    overlay = f"[limits]\n{LINEAR}C = [-180, 180]\n[limits.drives]\nA = [-60, 100]\nC = [-150, 100]\n"
    robot = Robot.load(machine_file(tmp_path, text_of(59, CARDAN), overlay))
    swept = np.array(swept_poses(robot, rest_pose(robot)))
    assert robot.limits.inside_rows(swept).all()
    assert swept[:, 3].min() == pytest.approx(-150.0)
    assert swept[:, 3].max() == pytest.approx(100.0)


@pytest.mark.parametrize("zero", [-1200000, 1200000])
def test_a_turn_without_limits_of_its_own_has_those_of_its_drive(zero: int, tmp_path: Path) -> None:
    """At A = 0 the drive of C stands at C + HD16: its limits reach ∓120 degrees further on the axis."""
    overlay = f"[limits]\n{LINEAR}A = [-30, 30]\n[limits.drives]\nC = [-150, 100]\n"
    robot = Robot.load(machine_file(tmp_path, text_of(59, {**CARDAN, 15: zero}), overlay))
    off = robot.drives([0, 0, 0, 0, 0])[3]
    assert abs(off) == pytest.approx(120.0)
    assert (robot.axes[3].lower, robot.axes[3].upper) == pytest.approx((-150.0 - off, 100.0 - off), abs=1e-9)


def test_a_held_axis_is_told_the_limits_that_are_tested(tmp_path: Path) -> None:
    robot = geared(tmp_path)
    refused = robot.ik(robot.fk([0, 0, 0, 0, 30]), held={"A": 120.0})
    assert refused.reason == "an axis is held outside its limits: A is 120, outside -80 … 80 deg"


@pytest.mark.parametrize("kin_typ", [59, 60])
def test_refusals_of_drives_name_the_channels_axis(tmp_path: Path, kin_typ: int) -> None:
    robot = Robot.load(machine_file(tmp_path, text_of(kin_typ, CARDAN, NAMES)))
    for refusing in (robot.q, robot.drives):
        with pytest.raises(ChainbuildError, match="by W_TILT = 120 deg") as error:
            refusing([0, 0, 0, 0, 120])
        assert error.value.parameter == "W_TILT"


def test_refusals_of_76_name_the_channels_axes(tmp_path: Path) -> None:
    path = machine_file(tmp_path, text_of(76, {6: 650000}, NAMES))
    robot = Robot.load(path, conventions={"kin76_machine_axes": "upright"})
    with pytest.raises(ChainbuildError, match="by W_TILT = 140 deg at C_DREH = 7 deg") as error:
        robot.drives([0, 0, 0, 7, 140])
    assert error.value.parameter == "W_TILT"
    bevel = BevelDrives(65.0, 0.0, "upright")
    beside = DrivesSideBySide(AffineDrives.shifted(2, {}), bevel, 2).named([*"UVXYZ", "C2", "A2"])
    refused = beside.refusal(np.array([0.0, 0.0, 0.0, 0.0, 0.0, 7.0, 140.0]))
    assert refused is not None
    assert "A2 = 140 deg at C2 = 7 deg" in refused.message


@pytest.mark.parametrize("first", [9, 59])
def test_refusals_of_two_steps_name_the_channels_axis(tmp_path: Path, first: int) -> None:
    """Both steps: the axis that step 0 passes on is the machine's."""
    rows = [f"kin_step[0].trafo[0].id {first}", "kin_step[1].trafo[0].id 59", "kin_step[1].trafo[0].param[6] 450000"]
    rows += ["kin_step[0].trafo[0].param[6] 450000"] if first == 59 else []
    rows += [f"default_id_of_kin_step[0] {first}", "default_id_of_kin_step[1] 59"]
    robot = Robot.load(machine_file(tmp_path, "\n".join(rows) + f"\n{bezeichnungen(NAMES)}Ende\n"))
    with pytest.raises(ChainbuildError, match="by W_TILT = 120 deg") as error:
        robot.q([0, 0, 0, 0, 120])
    assert error.value.parameter == "W_TILT"


@pytest.mark.parametrize(
    ("kin_typ", "parameters", "overlay", "code", "line"),
    [
        (59, CARDAN, f"[limits]\n{LINEAR}A = [-180, 180]\n", "CB432", 5),
        (59, CARDAN, f"[limits]\n{LINEAR}A = [100, 180]\n", "CB433", 5),
        (28, THIRD, "[limits]\nA = [90, 95]\n[limits.drives]\nA = [-10, 10]\n", "CB433", 4),
        (28, HALF, f"[limits]\n{LINEAR}C = [200, 360]\nA = [-20, 20]\n[limits.drives]\nA = [-100, 95]\n", "CB434", 8),
    ],
)
def test_findings_point_at_the_line_as_it_is_written(
    tmp_path: Path, kin_typ: int, parameters: Mapping[int, int], overlay: str, code: str, line: int
) -> None:
    path = machine_file(tmp_path, text_of(kin_typ, parameters, NAMES), overlay)
    spans = [one.span for one in chainbuild.check(path) if one.code == code and one.parameter == "W_TILT"]
    assert [(one.file, one.line) for one in spans if one] == [(str(tmp_path / "machine.chainbuild.toml"), line)]


def test_without_a_line_of_its_own_a_finding_points_at_the_axis_or_the_machine(tmp_path: Path) -> None:
    overlay = f"[limits]\n{LINEAR}C = [200, 360]\nA = [-20, 20]\n[limits.drives]\nA = [-100, 95]\n"
    path = machine_file(tmp_path, text_of(28, HALF, NAMES), overlay)
    (of_c,) = [one.span for one in chainbuild.check(path) if one.code == "CB434" and one.parameter == "C_DREH"]
    assert of_c is not None
    assert (of_c.file, of_c.line) == (str(tmp_path / "machine.chainbuild.toml"), 5)
    path = machine_file(tmp_path, text_of(59, CARDAN, NAMES), 'axis_lists = ["a.lis"]\n[limits]\nX = [-1, 1]\n')
    rows = "kopf.log_achs_name W_TILT\nkenngr.swe_neg 1000000\nkenngr.swe_pos 1000001\nEnde\n"
    (tmp_path / "a.lis").write_text(rows, "utf-8")
    found = [one.span for one in chainbuild.check(path) if one.code in ("CB433", "CB434") and one.span]
    assert {one.file for one in found} <= {str(path)}


def test_a_drive_at_its_axis_value_is_refused_by_the_key_that_is_written(tmp_path: Path) -> None:
    overlay = "[limits]\nA = [60, 80]\n[limits.drives]\nA = [-10, 10]\n"
    with pytest.raises(ChainbuildError, match="no value in common") as error:
        Robot.load(machine_file(tmp_path, text_of(9, {}, NAMES), overlay))
    assert error.value.parameter == "limits.drives.A"
    assert error.value.span is not None
    assert error.value.span.line == 4


@pytest.mark.parametrize(("arrangement", "lean", "turned"), [("upright", 2.0, 180.0), ("b_outside", 1.0, 90.0)])
def test_76_at_the_edge_of_its_reach(arrangement: BevelAxes, lean: float, turned: float) -> None:
    """Upright, A leans twice HD7 at half a turn; with B outside, HD7 across at a quarter. Rounding is no excess."""
    for tilt in np.linspace(20.0, 45.0, 60):
        bevel = BevelDrives(float(tilt), 0.0, arrangement)
        for sense in (1.0, -1.0):
            at = bevel.drives(np.array([0.0, 0.0, 0.0, 0.0, sense * lean * tilt]))
            assert abs(at[3]) == pytest.approx(turned, abs=1e-4)
            beyond = bevel.drives(np.array([0.0, 0.0, 0.0, 0.0, sense * (lean * tilt + 1e-3)]))
            assert not np.isfinite(beyond[3])
