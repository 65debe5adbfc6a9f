"""Joint bounds of nonlinear maps: they hold everything the axis limits allow, and not much more."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import chainbuild

MACHINES = {
    25: ("trafo[0].param[0] 1500000\ntrafo[0].param[2] 50000", {"A": (-60.0, 70.0)}),
    59: (
        "trafo[0].param[6] 500000\ntrafo[0].param[13] -60000\ntrafo[0].param[14] 70000",
        {"C": (-170.0, 170.0), "A": (-80.0, 60.0)},
    ),
    60: ("trafo[0].param[6] 400000\ntrafo[0].param[14] -50000", {"C": (-90.0, 90.0), "B": (-30.0, 70.0)}),
    70: ("trafo[0].param[6] 40000", {"B": (-80.0, 60.0), "A": (-50.0, 70.0), "CV": (-180.0, 180.0)}),
}


@pytest.mark.parametrize("kin", MACHINES)
def test_bounds_hold_every_reachable_joint_value(kin: int, tmp_path: Path) -> None:
    lines, limits = MACHINES[kin]
    path = tmp_path / "machine.lis"
    path.write_text(f"trafo[0].id {kin}\n{lines}\nEnde\n")
    given = {axis.name: (-500.0, 500.0) for axis in chainbuild.catalogue()[kin].axes if axis.kind == "linear"} | limits
    rows = [f"{name} = [{lower}, {upper}]" for name, (lower, upper) in given.items()]
    if kin == 25:
        rows.append("C = [-180.0, 180.0]")
    (tmp_path / "machine.chainbuild.toml").write_text("\n".join(["[limits]", *rows, ""]))
    robot = chainbuild.Robot(chainbuild.load(path).chain(tool_length_mm=80.0))
    rng = np.random.default_rng(kin)
    lower = np.array([axis.lower for axis in robot.axes])
    upper = np.array([axis.upper for axis in robot.axes])
    corners = rng.integers(0, 2, (2000, len(lower)))
    inner = rng.random((2000, len(lower)))
    found = np.array([robot.q(lower + (upper - lower) * share) for share in (*corners, *inner)])
    low, high = robot.model.lowerPositionLimit, robot.model.upperPositionLimit
    assert (found >= low - 1e-9).all(), (found.min(axis=0), low)
    assert (found <= high + 1e-9).all(), (found.max(axis=0), high)
    span = found.max(axis=0) - found.min(axis=0)
    assert (high - low <= 2.0 * span + 1e-9).all(), (high - low, span)


def test_a_quarter_turn_is_not_left(tmp_path: Path) -> None:
    """70 at ±90 degrees: wherever CV stands the head turns its axes no further, and no rounding says otherwise."""
    path = tmp_path / "machine.lis"
    path.write_text("trafo[0].id 70\nEnde\n")
    (tmp_path / "machine.chainbuild.toml").write_text("[limits]\nB = [-90.0, 90.0]\nA = [-90.0, 90.0]\n")
    model = chainbuild.Robot.load(path).model
    assert np.degrees(model.lowerPositionLimit[3:]).tolist() == pytest.approx([-90.0, -90.0])
    assert np.degrees(model.upperPositionLimit[3:]).tolist() == pytest.approx([90.0, 90.0])


@pytest.mark.parametrize("offset", [-50000, 50000])
def test_a_nozzle_is_longest_at_its_larger_tilt(offset: int, tmp_path: Path) -> None:
    """25: length·(1/cos a - 1) with a = A ± 5 degrees, for A within ±60 degrees: from 0 to that at 65 degrees."""
    path = tmp_path / "machine.lis"
    path.write_text(f"trafo[0].id 25\ntrafo[0].param[0] 1500000\ntrafo[0].param[2] {offset}\nEnde\n")
    (tmp_path / "machine.chainbuild.toml").write_text("[limits]\nA = [-60.0, 60.0]\n")
    chain = chainbuild.load(path).chain(tool_length_mm=80.0, conventions={"kin25_length": "head_and_gap"})
    robot = chainbuild.Robot(chain)
    n = [joint.name for joint in robot.chain.joints].index("nozzle")
    longest = (0.15 + 0.08) * (1.0 / np.cos(np.radians(65.0)) - 1.0)
    bounds = robot.model.lowerPositionLimit[n], robot.model.upperPositionLimit[n]
    assert bounds == pytest.approx((0.0, longest), abs=1e-12)
