"""Panda and UR10 with their makers' meshes: hulls against meshes, capsules against hulls."""

from __future__ import annotations

import sys
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import coal
import numpy as np
import pytest

from chainbuild import frames
from chainbuild.chain.bodies.geometry import Geometry, Shape
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.elements import BASE_LINK, Chain
from chainbuild.collision.model import CollisionModel
from chainbuild.formats.load import from_urdf
from chainbuild.robot import Robot

DATA = Path(sys.prefix) / "lib" / f"python{sys.version_info.major}.{sys.version_info.minor}" / "site-packages"
ROBOTS = DATA / "cmeel.prefix/share/example-robot-data/robots"
CASES = {
    "ur10": (ROBOTS / "ur_description/urdf/ur10_robot.urdf", "tool0"),
    "panda": (ROBOTS / "panda_description/urdf/panda.urdf", "panda_link8"),
}

pytestmark = pytest.mark.slow


def mesh_shapes(chain: Chain, urdf: Path) -> dict[str, Shape]:
    """The collision mesh of each moving link and of the first one, as convex hulls."""
    root = ET.parse(urdf).getroot()
    child_of = {j.get("name"): j.find("child").get("link") for j in root.findall("joint")}  # type: ignore[union-attr]
    urdf_link = {joint.child: child_of[joint.name] for joint in chain.joints}
    first = next(j for j in root.findall("joint") if j.get("name") == chain.joints[0].name)
    urdf_link[BASE_LINK] = first.find("parent").get("link")  # type: ignore[union-attr]
    shapes = {}
    for link, name in urdf_link.items():
        collision = root.find(f"./link[@name='{name}']/collision")
        mesh = None if collision is None else collision.find("./geometry/mesh")
        if collision is None or mesh is None:
            continue
        origin = collision.find("origin")
        xyz = [float(v) for v in (origin.get("xyz", "0 0 0") if origin is not None else "0 0 0").split()]
        roll, pitch, yaw = (float(v) for v in (origin.get("rpy", "0 0 0") if origin is not None else "0 0 0").split())
        file = ROBOTS.parent.parent / str(mesh.get("filename")).removeprefix("package://")
        place = (*xyz, *np.degrees([yaw, pitch, roll]).tolist())
        shapes[link] = Shape("hull", file=file, place=place, scale=(1.0, 1.0, 1.0))
    return shapes


def enclosing_capsule(shape: Shape) -> Shape:
    """A capsule along the longest principal axis of a mesh that holds all its vertices."""
    points = np.array(coal.MeshLoader().load(str(shape.file), np.ones(3)).vertices())
    T = frames.f_frame(shape.place[:3], shape.place[3:])
    points = points @ T[:3, :3].T + T[:3, 3]
    centre = (points.min(axis=0) + points.max(axis=0)) / 2.0
    along = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][0]
    place = (points - centre) @ along
    across = np.linalg.norm(points - centre - np.outer(place, along), axis=1)
    radius = float(across.max())
    # A vertex at height h and distance d from the axis is inside where the segment reaches to h - sqrt(r² - d²).
    inset = np.sqrt(np.maximum(radius**2 - across**2, 0.0))
    low, high = float((place + inset).min()), float((place - inset).max())
    if high - low < 1e-3:
        middle = (low + high) / 2.0
        low, high = middle - 5e-4, middle + 5e-4
        radius += 1e-3
    return Shape("capsule", points=(*(centre + low * along), *(centre + high * along)), radius=radius * (1 + 1e-9))


@pytest.mark.parametrize("name", CASES)
def test_capsules_hulls_and_meshes_agree(name: str, record_property) -> None:
    urdf, tool = CASES[name]
    chain = from_urdf(urdf, tool=tool)
    hulls = mesh_shapes(chain, urdf)
    assert len(hulls) >= 6
    by_kind = {
        "capsule": {link: (enclosing_capsule(shape),) for link, shape in hulls.items()},
        "hull": {link: (shape,) for link, shape in hulls.items()},
        "mesh": {link: (replace(shape, kind="mesh"),) for link, shape in hulls.items()},
    }
    robots = {kind: Robot(replace(chain, geometry=Geometry(shapes=shapes))) for kind, shapes in by_kind.items()}
    # Pairs that are never in touch at rest: links at least three joints apart.
    order = [BASE_LINK, *(joint.child for joint in chain.joints)]
    pairs = [(a, b) for n, a in enumerate(order) for b in order[n + 3 :] if a in hulls and b in hulls]
    models = {kind: CollisionModel(robot, pairs) for kind, robot in robots.items()}
    lower, upper = shown_limits(chain)
    rng = np.random.default_rng(0)
    gaps, disagree, count = [], 0, 60
    for _ in range(count):
        axes = lower + (upper - lower) * rng.random(len(lower))
        found = {kind: model.distances(axes) for kind, model in models.items()}
        free = found["hull"] > 1e-3
        # A hull holds its mesh, a capsule the hull: each is at most as far.
        assert (found["hull"][free] <= found["mesh"][free] + 1e-5).all()
        assert (found["capsule"][free] <= found["hull"][free] + 1e-5).all()
        gaps.extend(found["hull"][free] - found["capsule"][free])
        disagree += bool(models["capsule"].collides(axes)) != bool(models["hull"].collides(axes))
    record_property("mean gap of capsules to hulls [mm]", 1000.0 * float(np.mean(gaps)))
    record_property("share of positions judged differently", disagree / count)
    print(f"{name}: capsules are {1000 * np.mean(gaps):.1f} mm nearer than hulls on average, {disagree}/{count} differ")
    assert np.mean(gaps) < 0.08
    assert disagree < count / 2
