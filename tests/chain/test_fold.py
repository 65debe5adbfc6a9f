"""Signs and zeros of axes lie in the joints: `q` is the axis value in SI, and nothing that can be seen has changed."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import chainbuild
from chainbuild.analysis.singularity.names import names_at
from chainbuild.chain.assemble import assemble, linear, mark, rotary, shift
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.bodies.rods import CRANK, LEVEL_CRANK, LEVEL_PLATE, ROD
from chainbuild.chain.compose import stack
from chainbuild.chain.elements import Axis, Chain
from chainbuild.chain.fold import drawn, drawn_bounds, drawn_values, folded, joint_motion
from chainbuild.chain.followers import followers
from chainbuild.chain.poses import link_placements
from chainbuild.frames import f_frame, rot_z
from chainbuild.kinematics.task_error import _joints
from chainbuild.writers.models.notes import axis_map_in_words, header
from chainbuild.writers.models.urdf import urdf_text
from tests.kit import before_fold
from tests.kit.straight import check_joint_values, sample_axes, straight_joints

BEFORE: dict[str, dict[str, Any]] = json.loads(before_fold.FILE.read_text("utf-8"))
# How far from what was recorded: poses and derivatives [m, 1], sizes [m], what is drawn [m], distances of coal [m].
TOLERANCE = {"fk": 1e-12, "J": 1e-12, "size": 2e-9, "reach": 2e-9, "length": 2e-9, "weights": 1e-5, "nearest": 2e-6}
DRAWN = 1.1e-6

# Joints that bear no axis: what follows under the names of rods, tables that ride, heads that stay level.
AXES_OF = {
    "EX1_table": "EX1", "UP_EX1_table": "UP_EX1", "OTHER_EX1_table": "OTHER_EX1", "level": "G3",
}  # fmt: skip
ELBOWS = {"45": "B2", "213": "G3", "96": "G3"}


@cache
def chains() -> dict[str, Chain]:
    return dict(before_fold.cases())


def test_the_record_is_of_these_cases() -> None:
    # Built after the fold: a shipped arm, and the closed loops, whose passive joints have no axis to fold.
    since = {name for name in chains() if name.startswith("comau_calibrated/") or chains()[name].loops}
    assert set(BEFORE) | since == set(chains())


@pytest.mark.parametrize("name", BEFORE)
def test_nothing_seen_has_changed(name: str) -> None:
    """Poses, sizes, bodies, rods, status bits and collisions are those of the version without the fold."""
    before = BEFORE[name]
    after = json.loads(json.dumps(before_fold.record(name, chains()[name], "bodies" in before)))
    assert after.keys() >= before.keys()
    for what, wanted in before.items():
        found = list(flat(after[what]))
        for ours, theirs in zip(found, list(flat(wanted)), strict=True):
            if isinstance(theirs, float):
                assert ours == pytest.approx(theirs, abs=TOLERANCE.get(what, DRAWN)), what
            else:
                assert ours == theirs, what


def flat(values: Any) -> Iterator[Any]:
    if isinstance(values, list):
        for value in values:
            yield from flat(value)
    else:
        yield values


@pytest.mark.parametrize("name", [name for name, before in BEFORE.items() if "rods" in before])
def test_rods_meet_the_forearm_and_follow_their_masters(name: str) -> None:
    pin, end = BEFORE[name]["rods"]
    assert pin == pytest.approx(end, abs=2e-6)
    chain = chains()[name]
    masters = followers(chain)
    assert {CRANK, ROD} <= set(masters)
    for axes in sample_axes(chain):
        q = dict(zip([joint.name for joint in chain.joints], chain.axis_map.q(axes), strict=True))
        for joint, (master, factor, offset) in masters.items():
            assert q[joint] == pytest.approx(factor * q[master] + offset, abs=1e-12)


@pytest.mark.parametrize("name", BEFORE)
def test_a_joint_that_one_axis_drives_has_its_value(name: str) -> None:
    chain = chains()[name]
    axes_of = dict(AXES_OF)
    if "rods" in name:
        elbow = next((axis for number, axis in ELBOWS.items() if f"type {number}" in name), "A3")
        axes_of |= {CRANK: elbow, ROD: elbow}
        if "level flange" in name:
            axes_of |= {LEVEL_PLATE: "G2", ROD: "G2"}
        if "type 96" in name:
            axes_of |= {LEVEL_PLATE: "G2", ROD: "G2", LEVEL_CRANK: "G3"}
    count = check_joint_values(chain, axes_of)
    nonlinear = {"59": 3, "60": 3, "70": 3}
    number = name.removeprefix("type ").split()[0]
    if name.startswith("type ") and number in nonlinear and not isinstance(chain.axis_map, AffineMap):
        assert count == nonlinear[number]
    elif name.startswith(("type 25", "type 98")):
        assert count == 5  # the last joint grows with the tilt


def test_most_shipped_machines_need_no_map() -> None:
    identical = [name for name in chainbuild.shipped() if is_identity(chainbuild.load(name).chain())]
    assert len(identical) == 43  # 24 before; what is left couples axes or bends them


def is_identity(chain: Chain) -> bool:
    """Return whether each joint has the value of the axis of its name, in whatever order, and there is no other."""
    straight = straight_joints(chain)
    same = [chain.joints[n].name == chain.axes[k].name for n, k in straight.items()]
    return len(straight) == len(chain.joints) == len(chain.axes) and all(same) and not axis_map_in_words(chain)


def test_a_direction_drawn_has_no_signed_zeros() -> None:
    (joint,) = assemble([Axis.unlimited("A", "rotary")], [rotary("A", "z")]).joints
    turned = folded(joint, -1.0, 0.0)
    for direction, wanted in ((turned.direction, -1.0), (drawn(turned).direction, 1.0)):
        assert direction.tolist() == [0.0, 0.0, wanted]
        assert not np.signbit(direction[:2]).any()


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_folding_moves_nothing_and_is_undone(kind: str, sign: float) -> None:
    rng = np.random.default_rng(1)
    for offset in (0.0, 90.0, -180.0, 37.5, -1234.5):
        move = rotary("A", rng.normal(size=3)) if kind == "revolute" else linear("A", rng.normal(size=3))
        axis = Axis.unlimited("A", "rotary" if kind == "revolute" else "linear")
        place = shift(*rng.normal(size=3) * 300.0)
        (joint,) = assemble([axis], [place, move]).joints
        assert math.copysign(1.0, folded(joint, -1.0, 0.0).zero) == 1.0  # zero has no sign where it is written
        si = math.radians(offset) if kind == "revolute" else offset / 1000.0
        once = folded(joint, sign, offset)
        twice = folded(once, -1.0, -17.0)
        for value in rng.normal(size=5):
            wanted = joint.T_parent_joint @ joint_motion(joint, sign * value + si)
            np.testing.assert_allclose(once.T_parent_joint @ joint_motion(once, value), wanted, atol=1e-14)
            assert drawn_values([once], np.array([value])) == pytest.approx(sign * value + si, abs=1e-14)
            inner = drawn_values([twice], np.array([value]))
            wanted = joint.T_parent_joint @ joint_motion(joint, float(inner[0]))
            np.testing.assert_allclose(twice.T_parent_joint @ joint_motion(twice, value), wanted, atol=1e-14)
        for back in (drawn(once), drawn(twice)):
            np.testing.assert_allclose(back.T_parent_joint, joint.T_parent_joint, atol=1e-14)
            np.testing.assert_array_equal(back.direction, joint.direction)
            assert (back.zero, back.reversed) == (0.0, False)
        low, high = drawn_bounds([once], np.array([-2.0]), np.array([5.0]))
        assert low < high
        assert {float(low[0]), float(high[0])} == {float(drawn_values([once], np.array([v]))[0]) for v in (-2.0, 5.0)}


@pytest.mark.parametrize("turns", [(-180.0, 90.0, -90.0), (270.0, -90.0, 180.0)])
def test_right_angles_stay_exact(turns: tuple[float, ...]) -> None:
    names = [f"A{n}" for n in range(3)]
    tool = [rotary(n, d, sign=-1.0, offset_deg=o) for n, d, o in zip(names, ("z", "-y", "x"), turns, strict=True)]
    body = assemble([Axis.unlimited(name, "rotary") for name in names], tool)
    for joint in body.joints:
        assert set(np.abs(joint.T_parent_joint).ravel()) == {0.0, 1.0}
        assert set(np.abs(drawn(joint).T_parent_joint).ravel()) == {0.0, 1.0}
        assert not any(value == 0.0 and math.copysign(1.0, value) < 0.0 for value in joint.direction)


def two_slides(**options: Any) -> Chain:
    """Return a chain whose joints are driven crosswise."""
    axes = [Axis.unlimited("X", "linear"), Axis.unlimited("Y", "linear")]
    tool = [linear("X", "x", drive={"Y": 1.0}), linear("Y", "y", drive={"X": -1.0}, offset_mm=50.0), mark("flange")]
    body = assemble(axes, tool)
    return Chain("two", "Two", "test", "test", body.links, body.joints, body.frames, tuple(axes), body.axis_map, "ypr")


def test_an_axis_of_another_name_is_told() -> None:
    chain = two_slides()
    assert axis_map_in_words(chain) == ("q[X] = Y/1000", "q[Y] = X/1000")
    assert not is_identity(chain)
    robot = chainbuild.Robot(chain)
    np.testing.assert_allclose(robot.fk([30.0, 70.0]).translation, [0.07, 0.02, 0.0], atol=1e-15)
    assert "except these" in header(chain)


def test_a_permutation_is_no_identity() -> None:
    """The joints of an exchanged gantry stand in another order than its axes: only names tell."""
    chain = chains()["robx permuted"]
    robot = chainbuild.Robot(chain)
    assert isinstance(chain.axis_map, AffineMap)
    first, second = (np.array([10.0, 20.0, 30.0, 1.0, 2.0, 3.0]), np.zeros(6))
    assert not np.array_equal(chain.axis_map.A, np.eye(6))
    assert axis_map_in_words(chain) == ()
    q, slopes = _joints(robot.kinematics, np.arange(6), np.zeros(6))(first)
    assert slopes is not None
    np.testing.assert_array_equal(q, robot.kinematics.q(first))
    found = robot.ik(robot.fk(first), start=second)
    assert found.success
    np.testing.assert_allclose(found.axes[:3], first[:3], atol=1e-6)


def test_the_stretched_elbow_is_looked_for_where_the_arm_is_drawn() -> None:
    """The manual's "A3 = 0" is the mathematical joint: without an offset across the forearm it is right, at A3 = 70."""
    robot = chainbuild.Robot(before_fold.robx("irb2600", before_fold.TURNED | {"TX3P3_POS[2]": 0.0}))
    bent = chainbuild.Robot(before_fold.robx("irb2600", before_fold.TURNED))
    for arm, lateral in ((robot, 0.0), (bent, math.degrees(math.atan2(115.0, 795.0)))):
        found = [f for f in names_at(arm, [20.0, -30.0, 70.0 - lateral, 10.0, 40.0, 5.0]) if f.kind == "elbow"]
        assert len(found) == 1
        assert ("elsewhere" in found[0].remark) == (lateral != 0.0)


def test_a_coupled_elbow_stays_coupled() -> None:
    chain = chainbuild.load("parallelogram_nr").chain()
    (line,) = axis_map_in_words(chain)
    assert line.startswith("q[A3] = ")
    assert "A2" in line
    (elbow,) = (n for n in range(len(chain.joints)) if n not in straight_joints(chain))
    assert chain.joints[elbow].zero == 0.0
    assert not chain.joints[elbow].reversed


def test_a_mimic_joint_keeps_the_value_of_its_file(tmp_path: Path) -> None:
    path = tmp_path / "follows.urdf"
    joint = '<joint name="{0}" type="revolute"><parent link="{1}"/><child link="{2}"/><axis xyz="0 0 1"/>{3}</joint>'
    links = "".join(f'<link name="{name}"/>' for name in "abc")
    mimic = '<mimic joint="lead" multiplier="-1" offset="0.25"/>'
    joints = joint.format("lead", "a", "b", "") + joint.format("follower", "b", "c", mimic)
    path.write_text(f'<robot name="follows">{links}{joints}</robot>', "utf-8")
    robot = chainbuild.Robot(chainbuild.from_urdf(path))
    np.testing.assert_allclose(robot.q([30.0]), [math.radians(30.0), 0.25 - math.radians(30.0)], atol=1e-15)


def test_a_chain_turned_round_keeps_link_frames_and_values() -> None:
    """What a guest's links see of one another does not depend on the side it hangs on."""
    T = f_frame((0.4, -0.3, 0.2), (20.0, -30.0, 90.0))
    host, guest = chains()["robx turned"], chains()["robx riding table"]
    both = stack(host, T, guest, upper_name="UP")
    for axes in sample_axes(both):
        q = both.axis_map.q(axes)
        there = link_placements(both, q)
        here = link_placements(guest, guest.axis_map.q(axes[len(host.axes) :]))
        named = {link: f"UP_{link}" for link in here if f"UP_{link}" in there}
        tool = both.frame("tool")
        end = here[guest.frame("tool").link] @ guest.frame("tool").T_link_frame
        for link, name in named.items():
            seen = np.linalg.inv(there[tool.link] @ tool.T_link_frame) @ there[name]
            np.testing.assert_allclose(seen, np.linalg.inv(end) @ here[link], atol=1e-12)
        assert len(named) > 4


def test_heads_of_files_say_what_is_not_the_axis() -> None:
    plain, coupled, bent = (chainbuild.load(n).chain() for n in ("kr6r900_2", "parallelogram_nr", "rotated_head_kin70"))
    assert "q[" not in header(plain)
    assert "Joint values are the controller's axis values in metres and radians, by name." in header(plain)
    assert header(coupled).count("q[") == 1
    assert "nonlinear map" in header(bent)
    text = urdf_text(chainbuild.Robot(plain))
    for axis in plain.axes:
        lower, upper = (f"{math.radians(value):.9g}"[:8] for value in (axis.lower, axis.upper))
        limits = text.split(f'<joint name="{axis.name}"')[1].split("<limit")[1].split("/>")[0]
        assert lower in limits
        assert upper in limits


def test_a_turned_zero_is_where_the_manual_puts_it() -> None:
    """One arm by hand: reversed and off zero, its link stands at -a + 30 degrees."""
    axes = [Axis.unlimited("A", "rotary")]
    body = assemble(axes, [rotary("A", "z", sign=-1.0, offset_deg=30.0), shift(x=100.0)])
    chain = Chain("one", "One", "test", "test", body.links, body.joints, body.frames, tuple(axes), body.axis_map, "ypr")
    for angle in (0.0, 50.0, -120.0):
        wanted = rot_z(30.0 - angle) @ [0.1, 0.0, 0.0]
        np.testing.assert_allclose(chainbuild.Robot(chain).fk([angle]).translation, wanted, atol=1e-15)
        np.testing.assert_array_equal(chain.axis_map.q(np.array([angle])), [angle * math.pi / 180.0])
