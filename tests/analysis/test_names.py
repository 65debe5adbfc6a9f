"""What is said about singularities: names, sentences, remarks, notices."""

from __future__ import annotations

import math

import numpy as np
import pytest

import chainbuild
from chainbuild.analysis.singularity.names import examine, examine_path, kinds, names_at
from chainbuild.analysis.singularity.nearest import nearest_singularity
from chainbuild.chain.assemble import linear, rotary, shift
from tests.kit.chains import chain_from
from tests.kit.singular_machines import OrthoArm, axis


def robot(name: str) -> chainbuild.Robot:
    return chainbuild.Robot.load(name)


def test_a_wrist_is_said_as_an_engineer_would() -> None:
    (found,) = names_at(robot("kr6r900"), [0.0, -90.0, 90.0, 0.0, 0.3, 0.0])
    assert (found.kind, found.alias, found.axes) == ("wrist", "alpha5", ("A4", "A5", "A6"))
    assert found.condition == "A4 and A6 are nearly parallel (A5 = 0.3°)"
    assert "rotation about the flange's X" in found.sentence
    assert "10 mm/s at the TCP needs 246°/s of A4" in found.sentence
    assert found.value == pytest.approx(math.sin(math.radians(0.3)))
    (exact,) = names_at(robot("kr6r900"), [0.0, -90.0, 90.0, 0.0, 0.0, 0.0])
    assert "A4 and A6 are parallel" in exact.sentence
    assert "infinite speed of A4 and A6" in exact.sentence


def test_the_elbow_goes_by_geometry_and_says_where_the_manual_differs() -> None:
    arm = robot("irb2600")
    # Forearm 795 mm, 115 mm above the elbow: stretched where the mathematical angle is their arc tangent, not 0.
    a3 = math.degrees(math.atan2(115.0, 795.0)) - 90.0
    (found,) = names_at(arm, [0.0, 10.0, a3, 10.0, 30.0, 0.0])
    assert (found.kind, found.alias) == ("elbow", "alpha2")
    assert found.value < 1e-12
    assert "stretched" in found.condition
    assert "A3 = 0" in found.remark
    kuka = robot("kr6r900_2")
    near = nearest_singularity(kuka, [0.0, -60.0, 0.0, 10.0, 30.0, 0.0])
    (other,) = names_at(kuka, near.axes)
    assert other.value < 1e-6
    assert "HD12" in other.remark


def test_a_folded_elbow_is_called_so() -> None:
    arm = OrthoArm(0.0, 0.0, 0.0, 400.0, 450.0, 420.0, 80.0).robot()
    (found,) = [f for f in names_at(arm, [0.0, 50.0, 180.0, 20.0, 40.0, 0.0]) if f.kind == "elbow"]
    assert "folded" in found.condition


def test_the_shoulder_of_an_arm_with_a_sideways_offset_is_a_cylinder() -> None:
    arm = OrthoArm(120.0, -40.0, 75.0, 400.0, 500.0, 600.0, 90.0)
    q = arm.onto("shoulder", np.array([0.3, -0.5, 0.0, 0.4, 1.0, 0.2]), np.random.default_rng(0))
    assert q is not None
    (found,) = names_at(arm.robot(), np.degrees(q))
    assert found.condition == "the wrist point lies on the cylinder of radius 75 mm about axis A1"
    straight = OrthoArm(120.0, -40.0, 0.0, 400.0, 500.0, 600.0, 90.0)
    q = straight.onto("shoulder", np.array([0.3, -0.5, 0.0, 0.4, 1.0, 0.2]), np.random.default_rng(0))
    assert q is not None
    assert names_at(straight.robot(), np.degrees(q))[0].condition == "the wrist point lies on axis A1"
    q[2] += 0.01
    assert " but for " in names_at(straight.robot(), np.degrees(q))[0].condition


def test_shipped_machines_are_named_right() -> None:
    cases = {
        "ca_head_kin9": ([0.0, 0.0, 0.0, 30.0, 0.0], "pole"),
        "ac_table_kin58": ([0.0, 0.0, 0.0, 0.0, 40.0], "pole"),
        "cardan_head_kin60": ([0.0, 0.0, 0.0, 30.0, 180.0], "tilt_end"),
        "scara_kin36": ([10.0, 0.0, -50.0, 20.0], "elbow"),
        "palletiser_kin96": ([0.0, 55.0, -35.0, 0.0], "elbow"),
        "arm_nn": ([10.0, 40.0, 30.0, 20.0, 0.0, 0.0], "wrist"),
        "arm_rr": ([10.0, 20.0, 100.0, 20.0, 0.0, 0.0], "wrist"),
        "gantry_ss": ([10.0, 20.0, 100.0, 20.0, 0.0, 0.0], "wrist"),
        "tx2_60": ([0.0, 0.0, 90.0, 0.0, 0.0, 0.0], "wrist"),
    }
    for name, (axes, kind) in cases.items():
        found = names_at(robot(name), axes)
        assert kinds(found)[0] == kind, name
        assert found[0].alias == ""


def test_robots_that_are_programmed_by_c_cannot_lock() -> None:
    assert examine(robot("scara_cc"), [0.0, 10.0, 20.0, 30.0]).notices == ()


def test_the_pole_of_a_head_costs_turns_not_shifts() -> None:
    (found,) = names_at(robot("ca_head_kin9"), [0.0, 0.0, 0.0, 30.0, 0.2])
    assert found.sentence.startswith("the tool lies nearly along C (A = 0.2°): rotation about the flange's Y")
    assert "10°/s of the tool needs" in found.sentence
    assert "of C" in found.sentence


def test_what_has_no_name_is_still_described() -> None:
    tool = [rotary("A", "z"), shift(x=300.0), linear("X", "y")]
    crank = chainbuild.Robot(chain_from([axis("A", 180.0), axis("X", 500.0)], tool, dialect="hand made"))
    assert crank.task == "position"
    found = names_at(crank, [0.0, 0.0])
    assert kinds(found) == ("other",)
    assert set(found[0].axes) == {"A", "X"}
    assert "work against one another" in found[0].sentence


def test_gimbal_lock_of_the_angles_in_use_and_of_euler_angles() -> None:
    arm = robot("kr6r900")  # flange along +X, tool frame z along it: B = 90
    report = examine(arm, [0.0, -90.0, 90.0, 0.0, 20.0, 0.0])
    assert report.notices == ()
    locked = examine(arm, [0.0, -90.0, 90.0, 0.0, 0.0, 0.0])
    (notice,) = locked.notices
    assert notice.kind == "gimbal_lock"
    assert "B = 90°" in notice.condition
    assert "ROBX manual 10.1.3 names B = 0" in notice.remark
    down = examine(arm, [0.0, -90.0, 90.0, 0.0, 90.0, 0.0])
    assert ["Euler" in found.condition for found in down.notices] == [True]


def test_a_path_names_the_rows_that_matter() -> None:
    arm = robot("kr6r900")
    path = [[0.0, -90.0, 90.0, 10.0, a5, 0.0] for a5 in np.linspace(-40.0, 40.0, 41)]
    found = dict(examine_path(arm, path))
    assert 20 in found
    assert all(kinds(report.names) == ("wrist",) for report in found.values())
    assert 15 not in found


def test_a_pole_matters_only_where_a_vector_is_the_target() -> None:
    """Rotary words run linearly with the block; kinematics that solve rotary axes keep their singular positions."""
    for name, axes in {"ca_head_kin9": [0, 0, 0, 30, 0], "ac_table_kin58": [0, 0, 0, 0, 40]}.items():
        found = examine(robot(name), axes).names
        assert found
        assert all(one.remark.startswith("only where a vector or an orientation is the target") for one in found)
    for name, axes in {"scara_kin36": [10, 0, 200, 0], "kr6r900_2": [0, -90, 90, 0, 0, 0]}.items():
        assert not any(one.remark.startswith("only where") for one in examine(robot(name), axes).names)


def test_a_search_inside_the_limits_stops_where_it_leaves_them() -> None:
    delta, start = robot("delta_kin37"), [0.0, 0.0, 0.0]
    anywhere, inside = nearest_singularity(delta, start), nearest_singularity(delta, start, inside=True)
    assert (anywhere.found, anywhere.inside) == (True, False)
    assert (inside.found, inside.inside) == (False, False)
    assert 1 < inside.steps < anywhere.steps
    arm = [0.0, -90.0, 90.0, 10.0, 5.0, 0.0]
    assert nearest_singularity(robot("kr6r900"), arm, inside=True).found


def test_the_nearest_singularity_is_found_and_says_when_there_is_none() -> None:
    near = nearest_singularity(robot("kr6r900"), [0.0, -90.0, 90.0, 10.0, 5.0, 0.0])
    assert near.found
    assert near.axes[4] == pytest.approx(0.0, abs=1e-6)
    assert near.distance == pytest.approx(math.radians(5.0), rel=1e-2)
    assert near.inside
    np.testing.assert_allclose(near.axes - near.change, [0.0, -90.0, 90.0, 10.0, 5.0, 0.0], atol=1e-9)
    none = nearest_singularity(robot("cross_head_kin5"), [0.0, 0.0, 0.0, 10.0])
    assert not none.found
