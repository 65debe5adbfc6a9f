"""Links of URDF files: names, places, masses, and the same gravity and inertia as Pinocchio's own reader."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild.arrays import Vector
from chainbuild.errors import ChainbuildError, ParseError
from chainbuild.formats.urdf.joints import Joints
from chainbuild.formats.urdf.robot import way_to
from chainbuild.formats.urdf.tree import Tree, link_places
from chainbuild.formats.urdf.xml import parse
from tests.kit.urdf_files import deepest_link, example_files, few_files, joint, link, written

G = 9.81
Y = '<axis xyz="0 1 0"/>'
LIMIT = '<limit lower="-2" upper="2" effort="{}" velocity="{}"/>'
DRIVES = Y + LIMIT.format(50, 1.5) + '<dynamics damping="0.7" friction="0.3"/>'

ARM = (
    link("pedestal", 30, "0 0 0.2"),
    link("upper", 2, "0.3 0 0", "0.01 0 0 0.02 0 0.03"),
    link("camera", 0.5, "0.05 0 0", "0.001 0 0 0.002 0 0.003"),
    link("hand", 1, "0.1 0 0.02"),
    link("pad", 0.1, "0.01 0 0"),
    link("claw", 0.2, "0.04 0 0"),
    '<link name="tcp"/>',
    joint("foot", "fixed", "world", "pedestal", "0 0 0.1"),
    joint("A", "revolute", "pedestal", "upper", "0 0 0.3", DRIVES),
    joint("mount", "fixed", "upper", "camera", "0.2 0 0.1", rpy=f"0 0 {np.pi / 2}"),
    joint("B", "revolute", "upper", "hand", "0.6 0 0", Y + LIMIT.format(20, 3)),
    joint("P", "prismatic", "hand", "pad", "0.15 0 0", '<axis xyz="1 0 0"/><limit lower="0.02" upper="0.05"/>'),
    joint("C", "revolute", "hand", "claw", "0.1 0 0", Y + '<mimic joint="B" multiplier="-2" offset="0.1"/>'),
    joint("end", "fixed", "hand", "tcp", "0.3 0 0"),
)


def arm(tmp_path: Path) -> chainbuild.Robot:
    return chainbuild.Robot.from_urdf(written(tmp_path, *ARM), tool="tcp")


def turned(x: float, z: float, angle: float) -> tuple[float, float]:
    """Return a point turned about y."""
    return x * np.cos(angle) + z * np.sin(angle), z * np.cos(angle) - x * np.sin(angle)


def by_hand(q: Vector) -> list[float]:
    """Return the torques that hold the arm, with joints A, B, C each on its own: Σ m·g·(lever along x), about +y."""
    a, b, c = q[0], q[0] + q[1], q[0] + q[1] + q[2]
    elbow = turned(0.6, 0.0, a)[0]
    knuckle = elbow + turned(0.1, 0.0, b)[0]
    C = 0.2 * turned(0.04, 0.0, c)[0], 0.2
    B = (
        1.0 * turned(0.1, 0.02, b)[0] + 0.1 * turned(0.15 + 0.02 + 0.01, 0.0, b)[0] + 0.2 * (knuckle - elbow) + C[0],
        1.3,
    )
    A = 2.0 * turned(0.3, 0.0, a)[0] + 0.5 * turned(0.2, 0.1, a)[0] + B[1] * elbow + B[0]
    return [-G * A, -G * B[0], -G * C[0]]


@pytest.mark.parametrize("q", [(0.0, 0.0, 0.0), (0.4, -1.1, 0.3), (-1.2, 0.7, 1.9)])
def test_torques_of_gravity_are_those_of_a_hand_formula(tmp_path: Path, q: tuple[float, ...]) -> None:
    model = arm(tmp_path).model
    assert list(model.names) == ["universe", "A", "B", "C"]
    torques = pin.computeGeneralizedGravity(model, model.createData(), np.array(q))
    np.testing.assert_allclose(torques, by_hand(np.array(q)), atol=1e-13)


def test_what_a_link_carries_is_lumped_into_it(tmp_path: Path) -> None:
    inertias = arm(tmp_path).chain.geometry.inertias
    assert {name: round(one.mass, 12) for name, one in inertias.items()} == {
        "base": 30.0, "upper": 2.5, "hand": 1.1, "claw": 0.2,
    }  # fmt: skip
    np.testing.assert_allclose(inertias["base"].centre, [0.0, 0.0, 0.3])
    # The camera's x is the arm's y: (0.2, 0.05, 0.1), and its moments change places.
    upper, centre = inertias["upper"], np.array([0.28, 0.01, 0.02])
    np.testing.assert_allclose(upper.centre, centre, atol=1e-15)
    expected = np.diag([0.012, 0.021, 0.033])
    for mass, place in ((2.0, (0.3, 0.0, 0.0)), (0.5, (0.2, 0.05, 0.1))):
        x, y, z = place - centre
        expected += mass * np.array(
            [[y * y + z * z, -x * y, -x * z], [-x * y, x * x + z * z, -y * z], [-x * z, -y * z, x * x + y * y]]
        )
    np.testing.assert_allclose(upper.moments, expected, atol=1e-15)


def test_links_keep_their_names_as_links_and_frames(tmp_path: Path) -> None:
    robot = arm(tmp_path)
    assert [one.name for one in robot.chain.links] == ["base", "upper", "hand", "claw"]
    assert [frame.name for frame in robot.chain.frames] == [
        "base", "tool", "workpiece", "flange", "world", "pedestal", "tcp", "pad", "camera",
    ]  # fmt: skip
    placed = robot.frame_placements([10.0, 20.0])
    np.testing.assert_allclose(placed["pad"].translation - placed["hand"].translation, [
        0.17 * np.cos(np.radians(30.0)), 0.0, -0.17 * np.sin(np.radians(30.0)),
    ], atol=1e-15)  # fmt: skip
    np.testing.assert_allclose(placed["camera"].rotation @ [1, 0, 0], [0, 1, 0], atol=1e-15)
    np.testing.assert_allclose(placed["tcp"].homogeneous, robot.fk([10.0, 20.0]).homogeneous, atol=1e-15)
    (held,) = robot.chain.findings
    assert (held.code, held.span and held.span.line) == ("CB525", 13)
    assert held.text == "joints beside the way to link tcp are held: P at 0.02 m"


def test_places_of_all_links(tmp_path: Path) -> None:
    path = written(tmp_path, *ARM)
    robot = parse(path.read_text(), str(path))
    joints = Joints(robot)
    places = link_places(Tree(robot, joints, way_to("tcp", joints.all, robot.span)))
    assert {name: place[0] for name, place in places.items()} == {
        "world": "base", "pedestal": "base", "upper": "upper", "camera": "upper", "hand": "hand", "pad": "hand",
        "claw": "claw", "tcp": "hand",
    }  # fmt: skip
    np.testing.assert_allclose(places["pad"][1][:3, 3], [0.17, 0.0, 0.0])


def test_speeds_efforts_dampings_and_frictions(tmp_path: Path) -> None:
    robot = arm(tmp_path)
    model = robot.model
    np.testing.assert_allclose(model.velocityLimit, [1.5, 3.0, 6.0])
    np.testing.assert_array_equal(model.effortLimit, [50.0, 20.0, np.inf])
    np.testing.assert_array_equal(model.damping, [0.7, 0.0, 0.0])
    np.testing.assert_array_equal(model.upperDryFrictionLimit, [0.3, 0.0, 0.0])
    assert [one.dynamics.effort for one in robot.chain.joints] == [50.0, 20.0, None]


def test_without_inertials_there_are_no_inertias(tmp_path: Path) -> None:
    path = written(tmp_path, joint("A", "revolute", "a", "b", inside=Y))
    assert chainbuild.from_urdf(path).geometry.inertias == {}


@pytest.mark.parametrize(
    ("element", "line", "parameter", "message"),
    [
        (link("b", -1), 2, "value", "the mass of link b is -1"),
        (link("b", float("nan")), 2, "value", 'value="nan" in <mass>'),
        (link("b", 1e12), 2, "value", "the mass of link b is 1e+12"),
        (link("b", 1).replace("ixx", "axx"), 2, "ixx", "<inertia> lacks the attribute ixx"),
        (link("b", 1, moments="-0.1 0 0 1 0 1"), 2, "ixx", "ixx of link b is -0.1"),
        (link("b", 1, moments="1 0 1e300 1 0 1"), 2, "ixz", "ixz of link b is 1e+300"),
        (link("b", 1, "0 1e9 0"), 2, "xyz", "the centre of mass of link b is too far away"),
        ('<link name="b"><inertial>\n<mass value="1"/></inertial></link>', 2, "inertia", "link b lacks <inertia>"),
        ('<link name="b">\n<inertial/></link>', 3, "mass", "inertial of link b lacks <mass>"),
        ('<link name="b"/>\n<link name="b"/>', 3, "name", "link b occurs twice"),
        ('<link name="b"/>\n<link name="c"/>', 3, None, "no joint holds link c"),
        ("<link/>", 2, "name", "<link> lacks the attribute name"),
    ],
)  # fmt: skip
def test_a_bad_link_is_one_error_with_its_line(
    tmp_path: Path, element: str, line: int, parameter: str | None, message: str
) -> None:
    path = written(tmp_path, element, joint("A", "revolute", "a", "b", inside=Y))
    with pytest.raises(ParseError) as caught:
        chainbuild.from_urdf(path, tool="b")
    assert message in caught.value.message
    assert (caught.value.line, caught.value.parameter) == (line, parameter)
    if parameter == "ixz":
        assert caught.value.permitted == "-1e+09 up to 1e+09"


@pytest.mark.parametrize(
    ("inside", "parameter"),
    [
        (LIMIT.format(-1, 1), "effort"),
        ('<dynamics damping="-1"/>', "damping"),
        ('<dynamics friction="-0.5"/>', "friction"),
    ],
)
def test_an_effort_damping_or_friction_below_0_is_refused(tmp_path: Path, inside: str, parameter: str) -> None:
    path = written(tmp_path, joint("A", "revolute", "a", "b", inside=Y + inside))
    with pytest.raises(ParseError, match=f"the {parameter} of joint A is -") as caught:
        chainbuild.from_urdf(path)
    assert (caught.value.line, caught.value.parameter) == (2, parameter)


def test_a_mass_of_0_and_moments_rounded_below_0_are_taken(tmp_path: Path) -> None:
    a, b = link("b", 0, "1 2 3", "1 0 0 1 0 1"), link("c", 0, "0 0 0", "-1e-20 0 0 1 0 1")
    ends = joint("A", "revolute", "a", "b", inside=Y), joint("F", "fixed", "b", "c")
    inertia = chainbuild.from_urdf(written(tmp_path, a, b, *ends)).geometry.inertias["b"]
    assert inertia.mass == 0.0
    np.testing.assert_allclose(inertia.moments, np.diag([1.0, 2.0, 2.0]))


@pytest.mark.parametrize("kind", ["floating", "planar"])
def test_other_joints_beside_the_way_stay_at_their_origin(tmp_path: Path, kind: str) -> None:
    elements = joint("A", "revolute", "a", "b", inside=Y), joint("F", kind, "b", "c", "0 0 0.5")
    robot = chainbuild.Robot.from_urdf(written(tmp_path, *elements), tool="b")
    assert robot.chain.frame("c").T_link_frame[2, 3] == 0.5
    assert [finding.text.rpartition(": ")[2] for finding in robot.chain.findings] == ["F"]
    with pytest.raises(ParseError, match=f"joint F is of type {kind}"):
        chainbuild.Robot.from_urdf(written(tmp_path, *elements), tool="c")


def test_a_held_joint_that_follows_another_stands_where_that_puts_it(tmp_path: Path) -> None:
    slide = '<axis xyz="1 0 0"/><limit lower="{}" upper="{}"/>'
    elements = (
        joint("A", "revolute", "a", "b", inside=Y),
        joint("P", "prismatic", "b", "c", inside=slide.format(-0.05, -0.02)),
        joint("Q", "prismatic", "b", "d", inside='<axis xyz="1 0 0"/><mimic joint="P" multiplier="3" offset="0.5"/>'),
    )
    chain = chainbuild.from_urdf(written(tmp_path, *elements), tool="b")
    assert [chain.frame(name).T_link_frame[0, 3] for name in "cd"] == pytest.approx([-0.02, 0.44])
    assert chain.findings[0].text.endswith("are held: P at -0.02 m, Q at 0.44 m")


def test_a_circle_of_links_is_refused(tmp_path: Path) -> None:
    elements = joint("A", "revolute", "a", "b", inside=Y), joint("F", "fixed", "c", "d"), joint("H", "fixed", "d", "c")
    with pytest.raises(ChainbuildError, match=r"link . is its own ancestor") as caught:
        chainbuild.Robot.from_urdf(written(tmp_path, *elements), tool="b")
    assert caught.value.line == 3


def frames_of(robot: chainbuild.Robot) -> dict[str, tuple[str, float]]:
    return {frame.name: (frame.link, float(frame.T_link_frame[2, 3])) for frame in robot.chain.frames}


def test_links_with_the_names_of_frames(tmp_path: Path) -> None:
    """The flange beside the tool is the chain's; the workpiece stands elsewhere, and a moved link is called base."""
    elements = (
        joint("A", "revolute", "world", "base", "0 0 0.1", Y),
        joint("B", "revolute", "base", "end", "0 0 0.2", Y),
        joint("f", "fixed", "end", "flange", "0 0 0.3"),
        joint("t", "fixed", "flange", "tool", "0 0 0.4"),
        joint("w", "fixed", "base", "workpiece", "0 0 0.5"),
        joint("u", "fixed", "world", "base_link"),
    )
    robot = chainbuild.Robot.from_urdf(written(tmp_path, *elements), tool="tool")
    assert [one.name for one in robot.chain.links] == ["base", "base_link_2", "end"]
    assert frames_of(robot) == {
        "base": ("base", 0.0), "workpiece": ("base", 0.0), "flange": ("end", 0.3), "tool": ("end", pytest.approx(0.7)),
        "world": ("base", 0.0), "base_link": ("base", 0.0), "workpiece_link": ("base_link_2", 0.5),
    }  # fmt: skip
    told = [(one.code, one.text.partition(":")[0]) for one in robot.chain.findings]
    assert told == [
        ("CB524", "link base is called base_link_2"), ("CB524", "link workpiece is called workpiece_link"),
    ]  # fmt: skip
    again = chainbuild.Robot.from_urdf(chainbuild.write_urdf(robot, tmp_path / "out"), tool="tool")
    assert frames_of(again) == frames_of(robot)
    assert not again.chain.findings


def test_a_moved_link_that_is_the_tool_or_the_flange(tmp_path: Path) -> None:
    elements = joint("A", "revolute", "base", "flange", inside=Y), joint("B", "revolute", "flange", "tool", inside=Y)
    robot = chainbuild.Robot.from_urdf(written(tmp_path, *elements))
    assert [one.name for one in robot.chain.links] == ["base", "flange_link", "tool_link"]
    assert frames_of(robot)["flange"][0] == frames_of(robot)["tool"][0] == "tool_link"
    assert [one.text.partition(":")[0] for one in robot.chain.findings] == ["link flange is called flange_link"]


def test_joints_beside_the_way_come_depth_first(tmp_path: Path) -> None:
    """As Pinocchio wants them: its mass matrix is wrong where what a joint carries is not together."""
    drive = Y + LIMIT.format(1, 1)
    elements = (
        '<link name="a"/>',
        *(link(name, 1, "0.1 0.2 0.3", "1 0 0 1 0 1") for name in "bcdefg"),
        joint("S", "revolute", "b", "e", "0.1 0 0", drive + '<mimic joint="A"/>'),
        joint("T", "revolute", "e", "f", "0.1 0 0", drive + '<mimic joint="S"/>'),
        joint("A", "revolute", "a", "b", inside=drive),
        joint("B", "revolute", "b", "c", "0.3 0 0", drive),
        joint("C", "revolute", "c", "d", "0.3 0 0", drive),
        joint("U", "revolute", "c", "g", "0.1 0 0", drive + '<mimic joint="A"/>'),
    )
    path = written(tmp_path, *elements)
    robot = chainbuild.Robot.from_urdf(path, tool="d")
    assert [one.name for one in robot.chain.joints] == ["A", "B", "C", "U", "S", "T"]
    assert_as_pinocchio(path, "d")


def assert_as_pinocchio(path: Path, tool: str) -> None:
    """Compare with Pinocchio's reader: what all links weigh, torques, mass matrix and placements with others held."""
    robot = chainbuild.Robot.from_urdf(path, tool=tool)
    own, other = robot.model, pin.buildModelFromUrdf(str(path))
    tree = {frame.name: frame for frame in robot.chain.frames}
    moved = {one.name: other.joints[other.getJointId(one.name)] for one in robot.chain.joints}
    q_held = held_values(path, tool, robot, other)
    order = [one.idx_v for one in moved.values()]
    rng = np.random.default_rng(3)
    data, found = other.createData(), own.createData()
    assert sum(one.mass for one in own.inertias) == pytest.approx(sum(one.mass for one in other.inertias), rel=1e-12)
    for _ in range(3):
        q, q_other = rng.uniform(-2.0, 2.0, own.nq), q_held.copy()
        for value, place in zip(q, moved.values(), strict=True):
            q_other[place.idx_q : place.idx_q + place.nq] = value if place.nq == 1 else (np.cos(value), np.sin(value))
        expected = pin.computeGeneralizedGravity(other, data, q_other)[order]
        torques = pin.computeGeneralizedGravity(own, found, q)
        np.testing.assert_allclose(torques, expected, rtol=0, atol=1e-12 * max(1.0, np.abs(expected).max()))
        M = whole(pin.crba(other, data, q_other))[np.ix_(order, order)]
        np.testing.assert_allclose(whole(pin.crba(own, found, q)), M, rtol=0, atol=1e-11 * max(1.0, np.abs(M).max()))
        pin.framesForwardKinematics(other, data, q_other)
        pin.framesForwardKinematics(own, found, q)
        for n, frame in enumerate(own.frames):
            at = other.getFrameId(frame.name, pin.FrameType.BODY)
            given = frame.name not in ("base", "flange", "tool", "workpiece") and frame.type != pin.FrameType.JOINT
            if given and at < len(other.frames):
                np.testing.assert_allclose(found.oMf[n].homogeneous, data.oMf[at].homogeneous, atol=1e-12)
    bodies = {frame.name for frame in other.frames if frame.type == pin.FrameType.BODY}
    assert bodies - {one.name for one in robot.chain.links} - tree.keys() <= {"base"}


def whole(M: np.ndarray) -> np.ndarray:
    """Return a mass matrix of which Pinocchio fills the upper triangle."""
    full: np.ndarray = np.triu(M) + np.triu(M, 1).T
    return full


def held_values(path: Path, tool: str, robot: chainbuild.Robot, model: pin.Model) -> np.ndarray:
    """Return joint values of Pinocchio's model with every joint that the chain does not have where it is held."""
    root = parse(path.read_text("utf-8", "replace"), str(path))
    joints = Joints(root)
    way = way_to(tool, joints.all, root.span)
    tree = Tree(root, joints, way)
    q: np.ndarray = pin.neutral(model)
    own = {one.name for one in robot.chain.joints}
    for one in joints.all:
        if one.moves and one.name not in own:
            value = tree.held[one] if one in tree.held else joints.fixed_at(one) or 0.0
            place = model.joints[model.getJointId(one.name)]
            q[place.idx_q : place.idx_q + place.nq] = value if place.nq == 1 else (np.cos(value), np.sin(value))
    return q


@pytest.mark.parametrize("path", few_files(), ids=lambda path: path.stem)
def test_some_public_files_weigh_what_pinocchio_reads(path: Path) -> None:
    assert_as_pinocchio(path, deepest_link(path))


@pytest.mark.slow
@pytest.mark.parametrize("name", example_files())
def test_all_public_files_weigh_what_pinocchio_reads(name: str) -> None:
    path = example_files()[name]
    assert_as_pinocchio(path, deepest_link(path))


@pytest.mark.parametrize("moments", ["-1e-13 0 0 0 0 0", "0 1e-20 0 0 0 0", "1e-3 1e-2 0 1e-3 0 1e-3"])
def test_moments_that_no_body_has_are_those_of_the_model(moments: str, tmp_path: Path) -> None:
    """Pinocchio's reader takes them, its constructor does not."""
    links = (link("base", 0), link("arm", 2.0, "0.1 0 0", moments, "0.3 0.2 0.1"))
    path = written(tmp_path, *links, joint("A1", "revolute", "base", "arm", inside='<axis xyz="0 0 1"/>'))
    robot = chainbuild.Robot.from_urdf(path)
    given = robot.chain.geometry.inertias["arm"].moments
    np.testing.assert_allclose(robot.model.inertias[1].inertia, given, rtol=1e-14, atol=1e-30)
    assert robot.model.inertias[1].mass == 2.0
    np.testing.assert_array_equal(robot.model.inertias[1].lever, [0.1, 0.0, 0.0])
