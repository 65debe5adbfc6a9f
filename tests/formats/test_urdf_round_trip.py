"""Public URDF files read, written and read again: axes, mimic, masses, efforts, dampings, frames and poses stay."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import ArrayLike

import chainbuild
from chainbuild.chain.axismap import AffineMap
from chainbuild.frames import f_frame
from tests.kit.urdf_files import deepest_link, example_files, few_files


def same(found: ArrayLike, expected: ArrayLike) -> None:
    np.testing.assert_allclose(np.asarray(found, float), np.asarray(expected, float), rtol=1e-12, atol=1e-12)


def round_trip(path: Path, folder: Path) -> None:
    """Compare a robot with what its URDF gives; speeds and efforts that are unknown are written as some."""
    first = chainbuild.Robot.from_urdf(path, tool=deepest_link(path))
    masses = first.chain.geometry.inertias
    file = chainbuild.write_urdf(first, folder, inertia=bool(masses))
    second = chainbuild.Robot.from_urdf(file, tool="tool")
    same_axes(first, second)
    same_joints(first, second)
    found = same_bodies(first, second)
    assert found or "<visual" not in path.read_text("utf-8") or "CB526" in {one.code for one in first.chain.findings}
    assert second.chain.geometry.inertias.keys() == masses.keys()
    for name, one in masses.items():
        other = second.chain.geometry.inertias[name]
        assert other.mass == pytest.approx(one.mass, rel=1e-14)
        same(other.centre, one.centre)
        np.testing.assert_allclose(other.moments, one.moments, rtol=1e-12, atol=1e-12 * np.abs(one.moments).max())
    assert [one.name for one in second.chain.links] == [one.name for one in first.chain.links]
    assert {frame.name: frame.link for frame in second.chain.frames} == {
        frame.name: frame.link for frame in first.chain.frames
    }
    for frame in first.chain.frames:
        placed = second.chain.frame(frame.name).T_link_frame
        same(placed, frame.T_link_frame)
    assert not {"CB523", "CB524", "CB525"} & {finding.code for finding in second.chain.findings}
    rng = np.random.default_rng(5)
    for _ in range(3):
        axes = [rng.uniform(axis.lower, axis.upper) for axis in first.axes]
        places, again = first.frame_placements(axes), second.frame_placements(axes)
        assert places.keys() == again.keys()
        for name, place in places.items():
            same(again[name].homogeneous, place.homogeneous)


def same_axes(first: chainbuild.Robot, second: chainbuild.Robot) -> None:
    assert [(axis.name, axis.kind) for axis in second.axes] == [(axis.name, axis.kind) for axis in first.axes]
    for one, other in zip(first.axes, second.axes, strict=True):
        same([other.lower, other.upper], [one.lower, one.upper])
        assert one.max_speed is None or other.max_speed == pytest.approx(one.max_speed, rel=1e-12)


def same_joints(first: chainbuild.Robot, second: chainbuild.Robot) -> None:
    """Compare joints by name: those on one link may change places."""
    before = [joint.name for joint in first.chain.joints]
    after = [joint.name for joint in second.chain.joints]
    order = [after.index(name) for name in before]
    assert len(before) == len(after)
    own, other = first.chain.axis_map, second.chain.axis_map
    assert isinstance(own, AffineMap)
    assert isinstance(other, AffineMap)
    same(other.A[order], own.A)
    same(other.b[order], own.b)
    for n, one in zip(order, first.chain.joints, strict=True):
        again = second.chain.joints[n]
        assert (again.parent, again.child, again.kind) == (one.parent, one.child, one.kind)
        assert one.dynamics.effort is None or again.dynamics.effort == pytest.approx(one.dynamics.effort, rel=1e-14)
        given = one.dynamics.damping, one.dynamics.friction
        assert (again.dynamics.damping, again.dynamics.friction) == pytest.approx(given, rel=1e-14)
        same(again.T_parent_joint, one.T_parent_joint)
        same(again.direction, one.direction)


def same_bodies(first: chainbuild.Robot, second: chainbuild.Robot) -> int:
    """Compare the bodies that a file gives; return how many there are. Of links without any a rule draws some."""
    count = 0
    for table in ("shapes", "visuals"):
        given, again = (getattr(robot.chain.geometry, table) for robot in (first, second))
        for link, bodies in given.items():
            parts = [part for body in bodies for part in apart(body)]
            others = again.get(link, ())
            assert len(others) == len(parts), (table, link)
            for one, other in zip(parts, others, strict=True):
                same_body(one, other)
                if table == "visuals" and one.colour is not None:  # of those that collide nobody sees one
                    same(other.colour, one.colour)
            count += len(parts)
    return count


def apart(body: chainbuild.Shape) -> list[chainbuild.Shape]:
    """Return what a file without capsules has for a body."""
    if body.kind != "capsule":
        return [body]
    ends = (replace(body, kind="sphere", points=body.points[n : n + 3]) for n in (0, 3))
    return [replace(body, kind="cylinder"), *ends]


def same_body(one: chainbuild.Shape, other: chainbuild.Shape) -> None:
    assert other.kind == one.kind
    same(other.points, one.points)
    same([other.radius, *other.size, *other.scale], [one.radius, *one.size, *one.scale])
    same(f_frame(other.place[:3], other.place[3:]), f_frame(one.place[:3], one.place[3:]))
    if one.file is not None:
        assert other.file is not None
        assert other.file.read_bytes() == one.file.read_bytes()


@pytest.mark.parametrize("path", few_files(), ids=lambda path: path.stem)
def test_some_public_files_come_back(path: Path, tmp_path: Path) -> None:
    round_trip(path, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("name", example_files())
def test_all_public_files_come_back(name: str, tmp_path: Path) -> None:
    round_trip(example_files()[name], tmp_path)


def test_there_are_many_public_files() -> None:
    assert len(example_files()) >= 60


def test_the_file_that_is_read_is_not_written_over(tmp_path: Path) -> None:
    path = chainbuild.write_urdf(chainbuild.Robot.load("kr6r900"), tmp_path)
    before = path.read_bytes()
    robot = chainbuild.Robot.from_urdf(path, tool="tool")
    with pytest.raises(chainbuild.ChainbuildError, match="also an input"):
        chainbuild.write_urdf(robot, tmp_path, inertia=False)
    assert path.read_bytes() == before
    assert chainbuild.write_urdf(robot, tmp_path / "other", inertia=False).read_bytes() != before
