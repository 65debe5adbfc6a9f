"""The shipped machines of the table, mixed, face, lever and arm families load, move and come back."""

from __future__ import annotations

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.elements import Chain

MACHINES = (
    "ac_table_kin58",
    "cac_table_kin64",
    "bed_mill_kin1",
    "b_head_a_table_kin61",
    "ba_head_c_table_kin82",
    "c_face_kin14",
    "cyl_2rot_kin202",
    "eccentric_disc_kin205",
    "lever_kin85",
    "scara_kin36",
    "palletiser_kin96",
    "palletiser_kin213",
    "linear_robot_kin206",
)


def has_table(chain: Chain) -> bool:
    return any(axis.kind == "rotary" and axis.carries == "workpiece" for axis in chain.axes)


@pytest.mark.parametrize("name", MACHINES)
def test_loads_without_a_remark(name: str) -> None:
    chain = chainbuild.load(name).chain()
    assert chain.kinematic == f"KIN_TYP {name.rsplit('kin', maxsplit=1)[1]}"
    # Of a table only the open sense is told.
    assert [finding.code for finding in chain.findings] == ["CB465"] * has_table(chain)
    assert not any(axis.assumed for axis in chain.axes)
    assert all(axis.max_speed for axis in chain.axes)


@pytest.mark.parametrize("name", MACHINES)
def test_poses_inside_the_limits_are_found_again(name: str) -> None:
    robot = chainbuild.Robot(chainbuild.load(name).chain(tool_length_mm=0.0))
    lower = np.array([axis.lower for axis in robot.axes])
    upper = np.array([axis.upper for axis in robot.axes])
    rng = np.random.default_rng(3)
    for _ in range(25):
        T = robot.fk(lower + (upper - lower) * rng.random(len(lower)))
        result = robot.ik(T)
        assert result.success, result.status
        found = robot.fk(result.axes)
        assert found.translation == pytest.approx(T.translation, abs=2e-6)
        assert robot.violated_limits(result.axes) == ()
