"""Meshes: what is read of a file, edges that light does not run around, fewer triangles, bodies of a URDF drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.elements import BASE_LINK
from chainbuild.drawing.machine import drawn_bodies
from chainbuild.drawing.shown import shown_chain
from chainbuild.errors import FileAccessError, FileContentError
from chainbuild.meshes import Triangles, creased, lighter, read_triangles
from tests.kit.mesh_files import box, joined, surface, write_arm, write_obj, write_stl


def ball(count: int) -> Triangles:
    """Return a ball of radius 1 with 2·count bands."""
    turns = np.linspace(0.0, 2 * np.pi, 2 * count, endpoint=False)
    rises = np.linspace(-np.pi / 2, np.pi / 2, count + 1)[1:-1]
    rings = [[np.cos(r) * np.cos(t), np.cos(r) * np.sin(t), np.sin(r)] for r in rises for t in turns]
    points = np.array([*rings, [0, 0, -1], [0, 0, 1]])
    south, north, around = len(points) - 2, len(points) - 1, 2 * count
    faces = []
    for k in range(around):
        after = (k + 1) % around
        faces += [(south, after, k), (north, len(points) - 2 - around + k, len(points) - 2 - around + after)]
        for ring in range(count - 2):
            a, b = ring * around + k, ring * around + after
            faces += [(a, b, b + around), (a, b + around, a + around)]
    return Triangles(points, np.array(faces))


def volume(found: Triangles) -> float:
    return float(np.einsum("ij,ij->", found.points[found.corners[:, 0]], found.normals)) / 6.0


def test_a_box_has_a_vertex_for_every_side_and_a_ball_none_more() -> None:
    block = creased(surface(box((0, 0, 0), (1, 2, 3))))
    assert (len(block.points), len(block.corners)) == (24, 12)
    normals = block.normals / np.linalg.norm(block.normals, axis=1, keepdims=True)
    for vertex in range(24):
        own = normals[(block.corners == vertex).any(axis=1)]
        np.testing.assert_allclose(own, np.broadcast_to(own[0], own.shape), atol=1e-12)
    assert volume(block) == pytest.approx(6.0)
    round_one = ball(12)
    assert len(creased(round_one).points) == len(round_one.points)


def test_round_and_flat_meet_in_a_crease() -> None:
    # A prism of many sides: round around, flat at its ends.
    turns = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
    ring = np.column_stack([np.cos(turns), np.sin(turns)])
    points = np.vstack([np.column_stack([ring, np.zeros(24)]), np.column_stack([ring, np.ones(24)])])
    sides = [face for k in range(24) for face in ((k, (k + 1) % 24, 24 + k), ((k + 1) % 24, 24 + (k + 1) % 24, 24 + k))]
    caps = [face for k in range(1, 23) for face in ((0, k + 1, k), (24, 24 + k, 25 + k))]
    assert len(creased(Triangles(points, np.array([*sides, *caps]))).points) == 4 * 24


def test_a_mesh_becomes_lighter_and_keeps_its_shape() -> None:
    fine, block = ball(60), surface(box((0, 0, 0), (0.5, 0.5, 0.5)))
    assert lighter([fine, block], 20_000)[0] is fine
    light, small = lighter([fine, block], 3000)
    assert 1500 < len(light.corners) + len(small.corners) <= 3000
    assert volume(light) == pytest.approx(volume(fine), rel=0.03)
    assert np.abs(np.linalg.norm(light.points, axis=1) - 1.0).max() < 0.05
    assert volume(small) == pytest.approx(0.125, rel=0.05)


def test_hulls_run_counter_clockwise(tmp_path: Path) -> None:
    mesh = joined(box((0, 0, 0), (3, 1, 1)), box((0, 0, 1), (1, 1, 3)))
    hull = read_triangles(write_obj(tmp_path / "l.obj", mesh), (0.1, 0.1, -0.1), hull=True)
    assert volume(hull) == pytest.approx(1e-3 * (9 - 2))
    outwards = hull.points[hull.corners].mean(axis=1) - hull.points.mean(axis=0)
    assert (np.einsum("ij,ij->i", outwards, hull.normals) > 0.0).all()


def test_a_file_that_has_changed_is_read_again(tmp_path: Path) -> None:
    path = write_stl(tmp_path / "a.stl", box((0, 0, 0), (1, 1, 1)))
    assert read_triangles(path, (1.0, 1.0, 1.0)).points.max() == 1.0
    write_stl(path, box((0, 0, 0), (1, 1, 12)))
    assert read_triangles(path, (1.0, 1.0, 1.0)).points.max() == 12.0


def test_what_makes_no_surface_is_refused(tmp_path: Path) -> None:
    flat = write_obj(tmp_path / "flat.obj", ([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], [(0, 1, 2), (1, 3, 2)]))
    far = write_obj(tmp_path / "far.obj", box((0, 0, 0), (1, 1, 1e7)))
    with pytest.raises(FileContentError, match="flat"):
        read_triangles(flat, (1.0, 1.0, 1.0), hull=True)
    assert len(read_triangles(flat, (1.0, 1.0, 1.0)).corners) == 2
    with pytest.raises(FileContentError, match="too far away"):
        read_triangles(far, (1.0, 1.0, 1.0))
    for name in ("gone.stl", "nul\0.stl"):
        with pytest.raises(FileAccessError, match="cannot be read"):
            read_triangles(tmp_path / name, (1.0, 1.0, 1.0))


def test_a_urdf_is_drawn_as_it_looks_and_by_no_rule(tmp_path: Path) -> None:
    chain = chainbuild.from_urdf(write_arm(tmp_path))
    bodies = drawn_bodies(chain)
    assert [(body.link, body.kind, body.part) for body in bodies] == [
        (BASE_LINK, "mesh", "link"), ("one", "mesh", "link"), ("two", "sphere", "link")
    ]  # fmt: skip
    one = bodies[1]
    assert (one.colour, one.origin) == ((0.0, 0.0, 1.0), "data")
    assert one.surface is not None
    points = one.surface.points @ one.T_link_body[:3, :3].T + one.T_link_body[:3, 3]
    np.testing.assert_allclose([points.min(axis=0), points.max(axis=0)], [(0.0, 0, 0), (0.1, 0.3, 0.3)], atol=1e-7)
    assert shown_chain(chain) is chain


def test_a_link_whose_mesh_is_gone_is_drawn_by_rule(tmp_path: Path) -> None:
    path = write_arm(tmp_path)
    chain = chainbuild.from_urdf(path)
    (tmp_path / "l.stl").unlink()
    bodies = drawn_bodies(chain)
    assert {body.origin for body in bodies if body.link in (BASE_LINK, "one")} <= {"drawn", "data"}
    assert {body.link for body in bodies} >= {BASE_LINK, "one", "two"}
    assert not any(body.kind == "mesh" for body in bodies)
    again = chainbuild.from_urdf(path)
    assert [finding.code for finding in again.findings] == ["CB526"]
    assert (set(again.geometry.shapes), set(again.geometry.visuals)) == ({BASE_LINK, "one"}, {"two"})
