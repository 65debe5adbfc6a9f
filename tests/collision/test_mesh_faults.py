"""Meshes that make no body are refused with their file and link, before coal sees them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.bodies.geometry import Geometry, Shape, ShapeKind
from chainbuild.collision.model import CollisionModel
from chainbuild.collision.solids import solids_of
from chainbuild.errors import FileAccessError, FileContentError
from chainbuild.frames import rot_x, rot_z
from chainbuild.meshes import read_triangles

SQUARE = ((0.0, 0.0, 0.0), (100.0, 0.0, 0.0), (100.0, 80.0, 0.0), (0.0, 80.0, 0.0))
PYRAMID = ((1, 2, 3), (1, 3, 4), (1, 2, 5), (2, 3, 5), (3, 4, 5), (4, 1, 5))
LINK = "A3_link"


def robot_with(tmp_path: Path, kind: ShapeKind, points: Sequence[Sequence[float]], faces: Sequence[Sequence[int]]):
    file = tmp_path / "body.obj"
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(points, dtype=float).tolist()]
    file.write_text("\n".join([*lines, *(f"f {a} {b} {c}" for a, b, c in faces)]) + "\n")
    chain = chainbuild.load("kr6r900").chain()
    shapes = {LINK: (Shape(kind, file=file),)}
    return chainbuild.Robot(replace(chain, geometry=Geometry(shapes=shapes))), file


def pyramid(height: float) -> list[tuple[float, ...]]:
    return [*SQUARE, (50.0, 40.0, height)]


@pytest.mark.parametrize(
    ("points", "faces"),
    [
        (pyramid(0.0), PYRAMID),
        (pyramid(1e-7), PYRAMID),
        (SQUARE[:3], [(1, 2, 3)]),
        ([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (2.0, 0.0, 0.0), (3.0, 0.1, 0.0)], [(1, 2, 4), (2, 3, 4)]),
        ((np.array(pyramid(0.0)) @ (rot_z(30.0) @ rot_x(40.0)).T).tolist(), PYRAMID),
    ],
    ids=["flat", "nearly flat", "one triangle", "a strip", "flat and tilted"],
)
def test_a_flat_hull_is_refused_and_a_flat_mesh_is_not(
    tmp_path: Path, points: Sequence[Sequence[float]], faces: Sequence[Sequence[int]]
) -> None:
    robot, file = robot_with(tmp_path, "hull", points, faces)
    with pytest.raises(FileContentError, match=f"the hull of link {LINK} is flat") as caught:
        CollisionModel(robot)
    assert (caught.value.file, caught.value.parameter) == (str(file), LINK)
    mesh, _ = robot_with(tmp_path, "mesh", points, faces)
    assert np.isfinite(CollisionModel(mesh).distances([0.0, -90.0, 90.0, 0.0, 30.0, 0.0])).all()


def test_a_thin_hull_keeps_its_place(tmp_path: Path) -> None:
    robot, _ = robot_with(tmp_path, "hull", pyramid(0.01), PYRAMID)
    solid = next(solid for solid in solids_of(robot.chain) if solid.link == LINK)
    assert solid.kind == "hull"
    assert solid.reach == pytest.approx(math.hypot(0.1, 0.08), rel=1e-3)


def test_more_edges_in_a_corner_than_coal_counts(tmp_path: Path) -> None:
    """A cone with 300 faces: coal counts to 255."""
    angles = np.linspace(0.0, 2.0 * np.pi, 300, endpoint=False)
    points = [*((100.0 * math.cos(a), 100.0 * math.sin(a), 0.0) for a in angles), (0, 0, 200), (0, 0, 0)]
    faces = [face for n in range(300) for face in ((n + 1, (n + 1) % 300 + 1, 301), ((n + 1) % 300 + 1, n + 1, 302))]
    mesh, _ = robot_with(tmp_path, "mesh", points, faces)
    assert np.isfinite(CollisionModel(mesh).distances([0.0, -90.0, 90.0, 0.0, 30.0, 0.0])).all()
    hull, file = robot_with(tmp_path, "hull", points, faces)
    for refused in (lambda: CollisionModel(hull), lambda: read_triangles(file, (0.001, 0.001, 0.001), hull=True)):
        with pytest.raises(FileContentError, match="more than 255 edges meet") as caught:
            refused()
        assert caught.value.file == str(file)


def test_a_fan_on_a_flat_face_leaves_a_hull(tmp_path: Path) -> None:
    """A disc with 300 corners: its ends are flat, and how they are cut into triangles is free."""
    angles = np.linspace(0.0, 2.0 * np.pi, 300, endpoint=False)
    points = [(100.0 * math.cos(a), 100.0 * math.sin(a), z) for z in (0.0, 10.0) for a in angles]
    faces = [(1, n + 1, n) for n in range(2, 300)] + [(301, 300 + n, 301 + n) for n in range(2, 300)]
    robot, _ = robot_with(tmp_path, "hull", points, faces)
    solid = next(solid for solid in solids_of(robot.chain) if solid.link == LINK)
    assert solid.around.computeVolume() == pytest.approx(0.1**2 * math.pi * 0.01, rel=1e-3)


@pytest.mark.parametrize("kind", ["hull", "mesh"])
@pytest.mark.parametrize("height", [math.nan, math.inf, -math.inf, 1e200, 1e10])
def test_vertices_that_are_no_places_are_refused(tmp_path: Path, kind: ShapeKind, height: float) -> None:
    robot, file = robot_with(tmp_path, kind, pyramid(height), PYRAMID)
    with pytest.raises(FileContentError, match=f"the {kind} of link {LINK} has vertices that are not finite") as caught:
        CollisionModel(robot)
    assert (caught.value.file, caught.value.parameter) == (str(file), LINK)
    assert "1e+06 m" in str(caught.value.permitted)


@pytest.mark.parametrize("points", [[(1.0, 1.0, 1.0)] * 5, [(0.0, 0.0, 0.0)]], ids=["one place", "no faces"])
def test_what_is_no_mesh_is_refused_with_its_link(tmp_path: Path, points: Sequence[Sequence[float]]) -> None:
    robot, file = robot_with(tmp_path, "hull", points, PYRAMID if len(points) > 1 else [])
    with pytest.raises(FileAccessError, match=f"the hull of link {LINK} cannot be read") as caught:
        CollisionModel(robot)
    assert caught.value.file == str(file)
