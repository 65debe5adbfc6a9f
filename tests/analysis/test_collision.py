"""Self-collision: distances in closed form, pairs left out, paths that miss nothing, ik that keeps clear, SRDF."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.analysis.collision.free_ik import collision_free_ik
from chainbuild.analysis.collision.pairs import classify_pairs
from chainbuild.analysis.collision.paths import contacts, first_contact
from chainbuild.chain.bodies.geometry import Geometry, Shape
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.collision.model import CollisionModel
from chainbuild.errors import ChainbuildError, FileAccessError
from chainbuild.writers.models.srdf import srdf_text
from tests.kit.planar import segment_distance


def arm(name: str = "kr6r900_2") -> chainbuild.Robot:
    return chainbuild.Robot.load(name)


def samples(robot: chainbuild.Robot, count: int, seed: int = 0) -> np.ndarray:
    lower, upper = shown_limits(robot.chain)
    return lower + (upper - lower) * np.random.default_rng(seed).random((count, len(lower)))


def capsule_ends(model: CollisionModel, axes: np.ndarray) -> list[tuple[np.ndarray, np.ndarray, float]]:
    """Ends and radius of every body in the base frame, spheres as capsules without length."""
    places = model.robot.frame_placements(axes)
    joint_of = {joint.child: joint.name for joint in model.robot.chain.joints}
    found = []
    for solid in model.solids:
        T = solid.T_link_solid
        if solid.link in joint_of:
            T = places[joint_of[solid.link]].homogeneous @ T
        half = solid.size[1] / 2.0 if solid.kind == "capsule" else 0.0
        found.append((T[:3, 3] - half * T[:3, 2], T[:3, 3] + half * T[:3, 2], solid.size[0]))
    return found


@pytest.mark.parametrize("name", ["kr6r900_2", "scara_kin36", "palletiser_kin96", "parallelogram_nr"])
def test_distances_are_those_of_capsules_in_closed_form(name: str) -> None:
    model = CollisionModel(arm(name))
    assert {solid.kind for solid in model.solids} <= {"capsule", "sphere", "box"}
    seen = 0
    for axes in samples(model.robot, 60):
        ends = capsule_ends(model, axes)
        distances = model.distances(axes)
        for (a, b), distance in zip(model.pairs, distances, strict=True):
            if "box" in (model.solids[a].kind, model.solids[b].kind):
                continue
            (a0, a1, ra), (b0, b1, rb) = ends[a], ends[b]
            expected = segment_distance(a0, a1, b0, b1) - ra - rb
            assert distance == pytest.approx(expected, abs=2e-6)
            seen += 1
        assert model.collides(axes) == (distances.min() <= 0.0)
        table = model.distance_table(axes)
        assert table[0].distance == pytest.approx(distances.min())
        nearest = model.nearest(axes)
        assert nearest is not None
        assert nearest.distance == pytest.approx(distances.min())
        if nearest.distance > 0.0:
            assert np.linalg.norm(nearest.points[0] - nearest.points[1]) == pytest.approx(nearest.distance, abs=1e-6)
        names = {frozenset(pair) for pair in model.colliding_pairs(axes)}
        assert len(names) == int((distances <= 0.0).sum())
    assert seen > 100


def test_neighbours_and_what_always_touches_are_left_out() -> None:
    model = CollisionModel(arm())
    joints = {frozenset((j.parent, j.child)) for j in model.robot.chain.joints}
    watched = {frozenset(pair) for pair in model.pairs_by_link()}
    assert not watched & joints
    assert not watched & {frozenset(pair) for pair in model.always}
    assert ("B2_link", "B3_link") in model.always
    ignoring = replace(model.robot.chain, geometry=Geometry(ignore=(("base", "B2_link"),)))
    assert frozenset(("base", "B2_link")) not in {
        frozenset(pair) for pair in CollisionModel(chainbuild.Robot(ignoring)).pairs_by_link()
    }


def test_drawn_slides_of_a_mill_are_no_collision_but_given_ones_are() -> None:
    chain = chainbuild.load("ca_head_kin9").chain()
    assert CollisionModel(chainbuild.Robot(chain)).pairs == ()
    given = replace(chain, geometry=Geometry(radii={"A_link": 0.1, "X_link": 0.1}))
    assert ("X_link", "A_link") in CollisionModel(chainbuild.Robot(given)).pairs_by_link()


# Pairs of shipped machines that touch at home or in the middle of the limits, and why.
TOUCHING = {
    "cac_table_kin64": ({("C1_link", "C2_link")}, "the outer C reaches from below the table to the A axis above it"),
    "lambda_kin21": ({("theta_link", "C_link")}, "the arm's link ends at the plane in which the gripper turns"),
    "linear_robot_kin206": ({("A2_link", "A4_link"), ("A2_link", "A5_link")}, "in the middle its arm is folded"),
    "oblique_head_kin11": (
        {("B_link", "A_link")},
        "the tip stands on the zero of the workpiece, which is in the A axis",
    ),
    "robot_head_kin210": (
        {("B2_link", "C_link"), ("A1_link", "C_link"), ("B3_link", "A_link")},
        "the head is short, and capsules are as thick as looks right for the robot",
    ),
}


@pytest.mark.parametrize("name", chainbuild.shipped())
def test_shipped_machines_at_rest_collide_only_where_it_is_told_why(name: str) -> None:
    model = CollisionModel(chainbuild.Robot.load(name))
    low, high = shown_limits(model.robot.chain)
    links = {solid.name: solid.link for solid in model.solids}
    touching = {
        frozenset(links[body] for body in pair)
        for axes in (np.clip(0.0, low, high), (low + high) / 2)
        for pair in model.colliding_pairs(axes)
    }
    wanted, _ = TOUCHING.get(name, (set(), ""))
    assert touching == {frozenset(pair) for pair in wanted}


def test_pairs_that_touch_at_home() -> None:
    assert CollisionModel(chainbuild.Robot.load("cac_table_kin64")).touching_at_home() == (("C1_link", "C2_link"),)
    assert CollisionModel(arm()).touching_at_home() == ()


def test_what_a_drawing_assumes_is_no_body() -> None:
    links = [solid.link for solid in CollisionModel(chainbuild.Robot.load("ac_table_kin58")).solids]
    assert links == ["A_link", "C_link", "C_link"]
    with_table = [solid.link for solid in CollisionModel(chainbuild.Robot.load("irb2600_table")).solids]
    assert with_table[0] == "base"


def test_watched_pairs_can_be_chosen() -> None:
    robot = arm()
    model = CollisionModel(robot, [("B2_link", "base")])
    assert model.pairs_by_link() == (("base", "B2_link"),)
    with pytest.raises(ChainbuildError, match="no link 'nose'"):
        CollisionModel(robot, [("nose", "base")])


def test_shapes_of_every_kind(tmp_path: Path) -> None:
    cube = tmp_path / "cube.stl"
    write_cube(cube, 100.0)
    place = (0.0, 0.0, 0.5, 0.0, 0.0, 0.0)
    shapes = {
        "sphere": Shape("sphere", points=(0.0, 0.0, 0.5), radius=0.05),
        "capsule": Shape("capsule", points=(0.0, 0.0, 0.45, 0.0, 0.0, 0.55), radius=0.05),
        "cylinder": Shape("cylinder", points=(0.0, 0.0, 0.45, 0.0, 0.0, 0.55), radius=0.05),
        "box": Shape("box", size=(0.1, 0.1, 0.1), place=place),
        "hull": Shape("hull", file=cube, place=place),
        "mesh": Shape("mesh", file=cube, place=place),
    }
    other = Shape("sphere", points=(0.0, 0.0, 0.0), radius=0.1)
    chain = arm("scara_kin36").chain
    distances: dict[str, float] = {}
    for kind, shape in shapes.items():
        geometry = Geometry(shapes={"base": (shape,), "C2_link": (other,)})
        model = CollisionModel(chainbuild.Robot(replace(chain, geometry=geometry)), [("base", "C2_link")])
        assert [s.kind for s in model.solids if s.link == "base"] == [kind]
        axes = [20.0, 30.0, -50.0, 0.0]
        found = model.nearest(axes)
        assert found is not None
        distances[kind] = found.distance
        centre = model.robot.frame_placements(axes)["C2"].translation
    to_middle = float(np.linalg.norm(centre - [0.0, 0.0, 0.5]))
    ends = np.array([0.0, 0.0, 0.45]), np.array([0.0, 0.0, 0.55])
    assert distances["sphere"] == pytest.approx(to_middle - 0.15, abs=2e-6)
    assert distances["capsule"] == pytest.approx(segment_distance(centre, centre, *ends) - 0.15, abs=2e-6)
    outside = np.maximum(np.abs(centre - [0.0, 0.0, 0.5]) - 0.05, 0.0)
    assert distances["box"] == pytest.approx(float(np.linalg.norm(outside)) - 0.1, abs=2e-6)
    flat = max(float(np.hypot(centre[0], centre[1])) - 0.05, 0.0)
    assert distances["cylinder"] == pytest.approx(float(np.hypot(flat, outside[2])) - 0.1, abs=2e-6)
    assert distances["hull"] == pytest.approx(distances["box"], abs=2e-6)
    assert distances["mesh"] == pytest.approx(distances["box"], abs=2e-6)
    missing = replace(chain, geometry=Geometry(shapes={"base": (Shape("mesh", file=tmp_path / "no.stl"),)}))
    with pytest.raises(FileAccessError, match="the mesh of link base cannot be read"):
        CollisionModel(chainbuild.Robot(missing))


def write_cube(path: Path, edge: float) -> None:
    """An ASCII STL of a cube about the origin."""
    corners = [np.array([x, y, z]) * edge / 2.0 for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    lines = ["solid cube"]
    for a, b, c, d in faces:
        for triangle in ((a, b, c), (a, c, d)):
            lines += ["facet normal 0 0 0", "outer loop"]
            lines += [f"vertex {' '.join(f'{v:g}' for v in corners[n])}" for n in triangle]
            lines += ["endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid cube"]), "ascii")


@pytest.mark.parametrize("count", [60, pytest.param(1000, marks=pytest.mark.slow)])
def test_paths_miss_nothing_that_dense_sampling_finds(count: int) -> None:
    model = CollisionModel(arm())
    rng = np.random.default_rng(8)
    hits = 0
    for n in range(count):
        path = samples(model.robot, 2, seed=1000 + n)
        found = first_contact(model.robot, path, bodies=model)
        shares = np.sort(rng.random(60))
        dense = [s for s in shares if model.collides(path[0] + s * (path[1] - path[0]))]
        if dense:
            hits += 1
            assert found is not None
            assert found.share <= dense[0]
        if found is not None:
            assert found.distance < 1.1e-5
            np.testing.assert_allclose(found.axes, path[0] + found.share * (path[1] - path[0]))
            before = path[0] + 0.999 * found.share * (path[1] - path[0])
            assert found.share == 0.0 or not model.collides(before)
    assert hits > count // 20


def test_thin_obstacles_between_two_free_rows_are_found() -> None:
    robot = arm()
    model = CollisionModel(robot)
    # The forearm sweeps through the column: both ends are free, only the way is not.
    start, end = np.array([0.0, -90.0, -150.0, 0.0, 0.0, 0.0]), np.array([0.0, -200.0, 170.0, 0.0, 0.0, 0.0])
    dense = [s for s in np.linspace(0, 1, 4001) if model.collides(start + s * (end - start))]
    found = first_contact(model.robot, [start, end], bodies=model)
    assert (found is not None) == bool(dense)
    if found is not None:
        assert found.share <= dense[0] + 1e-9


def test_clearance_and_bad_paths() -> None:
    model = CollisionModel(arm())
    axes = [0.0, -90.0, 90.0, 0.0, 0.0, 0.0]
    nearest = model.nearest(axes)
    assert nearest is not None
    assert first_contact(model.robot, axes, bodies=model) is None
    close = first_contact(model.robot, axes, bodies=model, clearance=nearest.distance + 1e-3)
    assert close is not None
    assert close.pair == nearest.pair
    for wrong, clearance in (([[0.0] * 5], 0.0), ([[np.nan] * 6], 0.0), (axes, -1.0)):
        with pytest.raises(ChainbuildError):
            list(contacts(model.robot, wrong, clearance=clearance, bodies=model))


def test_nonlinear_axis_maps_are_walked_too() -> None:
    chain = chainbuild.load("cardan_head_kin59").chain()
    shapes = {
        "base": (Shape("box", size=(0.4, 0.4, 0.2), place=(0.0, 0.0, -0.6, 0.0, 0.0, 0.0)),),
        "A_link": (Shape("sphere", points=(0.0, 0.0, -0.2), radius=0.05),),
    }
    robot = chainbuild.Robot(replace(chain, geometry=Geometry(shapes=shapes)))
    model = CollisionModel(robot, [("base", "A_link")])
    path = np.array([[0.0, 0.0, 400.0, 0.0, 0.0], [0.0, 0.0, -400.0, 40.0, 30.0]])
    found = first_contact(model.robot, path, bodies=model)
    dense = [s for s in np.linspace(0, 1, 2001) if model.collides(path[0] + s * (path[1] - path[0]))]
    assert dense
    assert found is not None
    assert found.share <= dense[0]
    assert found.share == pytest.approx(dense[0], abs=1e-3)


def test_ik_keeps_clear_when_asked() -> None:
    plain = arm()
    kept = 0
    for n, axes in enumerate(samples(plain, 60, seed=3)):
        if kept == 3:
            break
        # An obstacle where another branch of the same pose has its elbow: that branch has to be left.
        other = plain.ik(plain.fk(axes), start=samples(plain, 1, seed=100 + n)[0])
        if not other.success:
            continue
        place = plain.frame_placements(other.axes)["B2"].translation
        ball = Shape("sphere", points=tuple(place.tolist()), radius=0.12)
        robot = chainbuild.Robot(replace(plain.chain, geometry=Geometry(shapes={"base": (ball,)})))
        model = CollisionModel(robot)
        if model.collides(axes) or not model.collides(other.axes):
            continue
        result = collision_free_ik(robot, robot.fk(axes), start=other.axes)
        assert result.success
        assert result.restarts > 0
        assert not model.collides(result.axes)
        np.testing.assert_allclose(robot.fk(result.axes).homogeneous, robot.fk(axes).homogeneous, atol=1e-5)
        assert collision_free_ik(robot, robot.fk(axes), start=axes, bodies=model).restarts == 0
        failed = collision_free_ik(robot, robot.fk(axes), start=axes, bodies=model, clearance=5.0, attempts=2)
        assert (failed.success, failed.status) == (False, "limits")
        assert "collides" in failed.reason
        kept += 1
    assert kept == 3


def test_pairs_by_sampling_and_their_srdf() -> None:
    robot = arm()
    table = classify_pairs(robot, 400, seed=1)
    assert table == classify_pairs(robot, 400, seed=1)
    count = len(robot.chain.links)
    assert len(table.pairs) == count * (count - 1) // 2
    assert ("base", "C1_link") in table.of("adjacent")
    assert ("B2_link", "B3_link") in table.of("always")
    assert table.of("never")
    assert table.bound == pytest.approx(1.0 - 0.05 ** (1 / 400))
    root = ET.fromstring(srdf_text(robot, table))
    assert root.get("name") == robot.name
    reasons = [(e.get("link1"), e.get("link2"), e.get("reason")) for e in root.findall("disable_collisions")]
    assert ("base", "C1_link", "Adjacent") in reasons
    assert len(reasons) == sum(len(table.of(v)) for v in ("adjacent", "always", "never"))
    for wrong in ((0, 0.95), (10, 1.0)):
        with pytest.raises(ChainbuildError):
            classify_pairs(robot, wrong[0], confidence=wrong[1])


@pytest.mark.parametrize("clearance", [np.nan, np.inf, -1e-9])
def test_a_clearance_is_a_length(clearance: float) -> None:
    robot = chainbuild.Robot.load("kr6r900")
    with pytest.raises(chainbuild.ChainbuildError, match=r"wrong clearance; .*a finite length of at least 0"):
        collision_free_ik(robot, robot.fk([0, -90, 90, 0, 30, 0]), clearance=clearance)
