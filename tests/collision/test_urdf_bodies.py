"""Collisions by the bodies of a URDF: the verdicts of Pinocchio's own reader, and distances between meshes."""

from __future__ import annotations

import importlib.metadata
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild import Robot
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.collision.model import CollisionModel
from chainbuild.collision.solids import solids_of
from tests.kit.mesh_files import write_arm

ARMS = {
    "ur5": ("ur_description/urdf/ur5_robot.urdf", "tool0"),
    "ur10": ("ur_description/urdf/ur10_robot.urdf", "tool0"),
    "panda": ("panda_description/urdf/panda.urdf", "panda_link8"),
    "panda_primitives": ("panda_description/urdf/panda_collision.urdf", "panda_link8"),
    "kinova": ("kinova_description/robots/kinova.urdf", "j2s6s200_end_effector"),
    "tiago": ("tiago_description/robots/tiago_no_hand.urdf", "wrist_ft_tool_link"),
    "z1": ("z1_description/urdf/z1.urdf", None),
    "xarm7": ("xarm_description/urdf/xarm7.urdf", None),
}


def robots() -> Path:
    files = importlib.metadata.files("example-robot-data") or []
    found = next(file for file in files if str(file).endswith("ur_description/urdf/ur5_robot.urdf"))
    return Path(str(found.locate())).resolve().parents[2]


class Reference:
    """Pinocchio's own reading of a URDF and its bodies, with the pairs of a model.

    Attributes:
        count: How many pairs of bodies it watches.
    """

    def __init__(self, path: Path, bodies: CollisionModel) -> None:
        self.model = pin.buildModelFromUrdf(str(path))
        self.bodies = pin.buildGeomFromUrdf(
            self.model, str(path), pin.GeometryType.COLLISION, None, [str(robots().parents[1])]
        )
        carried = {joint.name: joint.child for joint in bodies.robot.chain.joints}
        links = [self._link(one.parentJoint, carried) for one in self.bodies.geometryObjects]
        watched = {frozenset(pair) for pair in bodies.pairs_by_link()}
        for a in range(len(links)):
            for b in range(a + 1, len(links)):
                if frozenset((links[a], links[b])) in watched:
                    self.bodies.addCollisionPair(pin.CollisionPair(a, b))
        self.count = len(self.bodies.collisionPairs)
        self.data, self.found = self.model.createData(), self.bodies.createData()

    def _link(self, joint: int, carried: dict[str, str]) -> str:
        """Return the chain's link that carries a joint of the file: what the chain holds hangs on it."""
        while joint and self.model.names[joint] not in carried:
            joint = self.model.parents[joint]
        return carried[self.model.names[joint]] if joint else "base"

    def collides(self, values: dict[str, float]) -> bool:
        q = pin.neutral(self.model)
        for name, value in values.items():
            joint = self.model.joints[self.model.getJointId(name)]
            q[joint.idx_q : joint.idx_q + joint.nq] = value if joint.nq == 1 else (np.cos(value), np.sin(value))
        return bool(pin.computeCollisions(self.model, self.data, self.bodies, self.found, q, True))


def share_that_collides(name: str, count: int) -> float:
    """Return the share of random positions that collide; the verdict is the reference's at each."""
    file, tool = ARMS[name]
    robot = Robot.from_urdf(robots() / file, tool=tool)
    assert all(finding.code != "CB526" for finding in robot.chain.findings)
    bodies = CollisionModel(robot)
    reference = Reference(robots() / file, bodies)
    assert reference.count == len(bodies.pairs) > 10
    lower, upper = shown_limits(robot.chain)
    rng = np.random.default_rng(3)
    verdicts = []
    for _ in range(count):
        axes = lower + (upper - lower) * rng.random(len(lower))
        values = dict(zip((joint.name for joint in robot.chain.joints), robot.q(axes).tolist(), strict=True))
        verdicts.append(bodies.collides(axes))
        assert verdicts[-1] == reference.collides(values), axes.tolist()
    return float(np.mean(verdicts))


def test_a_ur5_collides_where_pinocchios_own_bodies_do() -> None:
    assert 0.18 < share_that_collides("ur5", 400) < 0.30


@pytest.mark.slow
@pytest.mark.parametrize("name", ARMS)
def test_arms_collide_where_pinocchios_own_bodies_do(name: str, record_property) -> None:
    share = share_that_collides(name, 2000)
    record_property("share of positions that collide", share)
    assert 0.02 < share < 0.5


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    """Two links: a box at the elbow's far side and an L, whose hull is larger than it; the root has no body."""
    return Robot.from_urdf(write_arm(tmp_path_factory.mktemp("arm")))


def test_links_without_a_body_have_none(arm: Robot) -> None:
    assert [(solid.link, solid.kind) for solid in solids_of(arm.chain)] == [("one", "box"), ("two", "mesh")]
    bodies = CollisionModel(arm)
    assert bodies.pairs == ()
    assert bodies.nearest([0.0, 0.0]) is None
    assert not bodies.collides([0.0, 0.0])


def test_a_mesh_is_not_its_hull(arm: Robot) -> None:
    # Turned by 180° about y and 0.5 m ahead, the L spans x 0.2 … 0.5, z −0.3 … 0: by hand, the box ends at 0.05.
    bodies = CollisionModel(arm, [("one", "two")])
    for turn, distance in ((0.0, 0.45), (180.0, 0.15)):
        found = bodies.nearest([20.0, turn])
        assert found is not None
        assert found.distance == pytest.approx(distance, abs=1e-6)
    assert bodies.solids[1].kind == "mesh"
    assert bodies.solids[1].around is not bodies.solids[1].geometry


@pytest.mark.parametrize("tilt", [-120.0, -60.0, 0.0, 60.0, 120.0])
def test_the_nearest_pair_is_the_smallest_of_all(tilt: float) -> None:
    robot = Robot.from_urdf(robots() / ARMS["ur5"][0], tool="tool0")
    bodies = chainbuild.CollisionModel(robot)
    axes = [0.0, -90.0, tilt, 10.0, 20.0, 0.0]
    found = bodies.nearest(axes)
    assert found is not None
    assert found.distance == pytest.approx(float(bodies.distances(axes).min()), abs=1e-6)
    assert bodies.smallest_at(robot.q(axes)) == pytest.approx(found.distance, abs=1e-6)
    apart = float(np.linalg.norm(found.points[0] - found.points[1]))
    assert found.distance == 0.0 or apart == pytest.approx(found.distance, abs=1e-5)
