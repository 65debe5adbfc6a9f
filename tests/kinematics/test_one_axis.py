"""Chains of one axis, whose Jacobian Pinocchio hands back as a vector: every public function takes them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild import CollisionModel, IkOptions, Robot
from chainbuild.chain.assemble import Element, assemble, linear, rotary, shift
from chainbuild.chain.elements import Axis, Chain
from chainbuild.kinematics.screws import joint_screws


def one_axis(kind: str, carries: str = "tool") -> Robot:
    """Return a robot of one axis A, whose tool is 100 mm along x behind it, or whose workpiece turns or slides."""
    axes = (Axis.unlimited("A", "rotary" if kind == "rotary" else "linear"),)
    move: Element = rotary("A", "z") if kind == "rotary" else linear("A", "z")
    tool, workpiece = ([move, shift(x=100.0)], []) if carries == "tool" else ([shift(x=100.0)], [move])
    body = assemble(axes, tool, workpiece)
    parts = (body.links, body.joints, body.frames, axes, body.axis_map)
    return Robot(Chain("one", "One axis", "test", "one axis", *parts, "orirpy"))


CASES = [("rotary", "tool"), ("linear", "tool"), ("rotary", "workpiece"), ("linear", "workpiece")]


@pytest.mark.parametrize(("kind", "carries"), CASES)
def test_jacobian_and_solvers(kind: str, carries: str) -> None:
    robot = one_axis(kind, carries)
    T = robot.fk([30.0])
    step = 1e-6 / robot.kinematics.si_factors[0]
    difference = (robot.fk([30.0 + step]).translation - robot.fk([30.0 - step]).translation) / 2e-6
    for J in (robot.jacobian([30.0]), joint_screws(robot, [30.0])):
        assert J.shape == (6, 1)
        np.testing.assert_allclose(T.rotation @ J[:3, 0], difference, atol=1e-8)
    np.testing.assert_allclose(robot.jacobian([30.0], frame="workpiece")[:3, 0], difference, atol=1e-8)
    for compiled in (True, False):
        assert robot.ik(T, options=IkOptions(compiled=compiled)).axes == pytest.approx([30.0])
    assert [row[0] for row in robot.ik_all(T).axes] == pytest.approx([30.0])
    assert robot.ik_batch([T, T]).axes == pytest.approx(np.full((2, 1), 30.0))
    assert robot.ik_path([T, T]).axes == pytest.approx(np.full((2, 1), 30.0))
    assert not robot.ik(robot.fk([30.0]).act(robot.fk([0.0]))).success


@pytest.mark.parametrize(("kind", "carries"), CASES)
def test_everything_else(kind: str, carries: str, tmp_path: Path) -> None:
    robot = one_axis(kind, carries)
    assert chainbuild.examine(robot, [30.0]).measures.singular_values.shape == (1,)
    assert chainbuild.measure_batch(robot, np.array([[30.0], [40.0]])).smallest.shape == (2,)
    assert not chainbuild.nearest_singularity(robot, [30.0]).found
    assert not CollisionModel(robot).collides([30.0])
    assert chainbuild.write_urdf(robot, tmp_path).is_file()
    assert chainbuild.export_page(robot, tmp_path / "page.html").is_file()
    assert chainbuild.crosscheck(robot, robot.fk).agrees
