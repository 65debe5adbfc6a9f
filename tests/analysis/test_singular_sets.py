"""Singular sets known in closed form: found to 1e-6, named right, and no name far from them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from chainbuild.analysis.singularity.measures import measure_batch, scaling_of
from chainbuild.analysis.singularity.names import NEAR, kinds, names_at
from chainbuild.analysis.singularity.nearest import nearest_singularity
from tests.kit.singular_machines import OrthoArm, mill

ARMS, INSTANCES = 40, 1000
# Letters from the frame of the machine outwards: the C/A head, called AC head too, carries A on C.
MILLS = ["CA head", "CB head", "AB head", "BA head", "AC table", "BC table"]
CLEAR = 0.2  # other singularities are at least this far away in the random instances


@pytest.mark.parametrize("kind", ["wrist", "elbow", "shoulder"])
def test_singularities_of_ortho_parallel_arms(kind: str) -> None:
    rng = np.random.default_rng(3)
    found = 0
    for n in range(ARMS):
        arm = OrthoArm.random(rng, lateral=n % 2 == 1)
        robot = arm.robot()
        done = 0
        while done < INSTANCES // ARMS:
            q = arm.onto(kind, rng.uniform(-2.8, 2.8, 6), rng)
            if q is None or arm.others(kind, q) < CLEAR:
                continue
            done += 1
            names = names_at(robot, np.degrees(q))
            assert kinds(names) == (kind,)
            assert measure_batch(robot, [np.degrees(q)]).smallest[0] < 1e-6
            # From a little way off the steps end on the same set, by its closed form.
            near = nearest_singularity(robot, np.degrees(q + rng.uniform(-0.02, 0.02, 6)))
            assert near.found
            assert abs(getattr(arm, kind)(np.radians(near.axes))) < 1e-6
            assert kinds(names_at(robot, near.axes))[0] == kind
            found += 1
    assert found == INSTANCES


@pytest.mark.parametrize("name", MILLS)
def test_pole_of_heads_and_tables(name: str) -> None:
    rng = np.random.default_rng(4)
    found = 0
    for _ in range(20):
        robot, tilt = mill(name, rng)
        for _ in range(INSTANCES // 20):
            axes = np.array([rng.uniform(-a.upper, a.upper) for a in robot.axes])
            # C/A and C/B stand at the pole with the tool along C; A/B and B/A with it along their outer axis.
            pole = "C" if "C" in name else name[0]
            axes[tilt] = rng.choice([0.0, 180.0, -180.0] if pole == "C" else [90.0, -90.0])
            names = names_at(robot, axes)
            assert kinds(names) == ("pole",)
            assert names[0].axes == (pole,)
            assert names[0].value < 1e-6
            start = axes + np.where([a.kind == "rotary" for a in robot.axes], rng.uniform(-2, 2, 5), 0.0)
            near = nearest_singularity(robot, start)
            assert near.found
            at = math.radians(near.axes[tilt])
            assert abs(math.sin(at) if pole == "C" else math.cos(at)) < 1e-6
            assert kinds(names_at(robot, near.axes)) == ("pole",)
            found += 1
    assert found == INSTANCES


def test_no_name_is_given_far_from_singularities() -> None:
    rng = np.random.default_rng(5)
    far = 0
    for n in range(60):
        robot = OrthoArm.random(rng, lateral=n % 2 == 1).robot() if n % 2 else mill(MILLS[n // 2 % 6], rng)[0]
        axes = np.array([[rng.uniform(-a.upper, a.upper) for a in robot.axes] for _ in range(260)])
        clear = axes[measure_batch(robot, axes).smallest > NEAR]
        far += len(clear)
        assert all(not names_at(robot, row) for row in clear)
    assert far > 10_000


def test_names_do_not_hang_on_where_the_machine_stands() -> None:
    """Close to a singularity the function that vanishes tells the name, also where the measure alone could not."""
    arm = OrthoArm(50.0, -35.0, 0.0, 400.0, 455.0, 420.0, 80.0)
    robot = arm.robot()
    assert scaling_of(robot).length == pytest.approx(0.05 + 0.455 + math.hypot(0.035) + 0.42 + 0.08 + 0.06)
    for value, expected in ((0.0, ("wrist",)), (0.5, ("wrist",)), (30.0, ())):
        assert kinds(names_at(robot, [10.0, 20.0, 60.0, 30.0, value, 40.0])) == expected
