"""Closed loops in Pinocchio: gaps, freedoms, the elimination against differences, and the parallelogram as a loop."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from chainbuild import Loop, Robot, load, write_urdf
from chainbuild.chain.bodies.geometry import RodData
from chainbuild.chain.bodies.linkage import rod_loops, with_linkage
from chainbuild.chain.bodies.rods import (
    CRANK,
    HEAD_ROD,
    LEVEL_PLATE,
    LEVEL_ROD,
    ROD,
    ROD_END,
    ROD_PIN,
    with_rods,
)
from chainbuild.chain.followers import followers
from chainbuild.errors import ChainbuildError, ChainError
from chainbuild.kinematics.closure import Closure, check_closure, closing_axes, closure_of
from chainbuild.writers.models.notes import urdf_limitations
from chainbuild.writers.models.srdf import write_srdf
from tests.hand.loops_cases import channel_list, random_closing, random_hd
from tests.hand.loops_hand import LOOPS
from tests.kit.six_rods import SixRods

MACHINES = ("tripod_kin12", "tripod_table_kin209", "delta_kin37", "lambda_kin21", "rod_table_kin19")


def states(name: str, count: int) -> tuple[Robot, np.ndarray]:
    robot = Robot.load(name)
    rows = closing_axes(robot, np.random.default_rng(4), count)
    assert len(rows) == count
    return robot, rows


@pytest.mark.parametrize("name", MACHINES)
def test_random_states_close_to_rounding_and_leave_one_freedom_an_axis(name: str) -> None:
    robot, rows = states(name, 1000)
    closure = closure_of(robot)
    assert max(closure.gap(robot.q(row)) for row in rows) < 1e-12
    assert {closure.mobility(robot.q(row)) for row in rows[:20]} == {len(robot.axes)}
    check_closure(robot)


@pytest.mark.parametrize("name", MACHINES)
def test_an_open_state_is_polished_back_to_the_closed_form(name: str) -> None:
    robot, rows = states(name, 30)
    closure, rng = closure_of(robot), np.random.default_rng(2)
    passive = np.isin(np.arange(robot.model.nv), closure.passive)
    assert passive.sum() == robot.model.nv - len(robot.axes)
    for row in rows:
        q = robot.q(row)
        pushed = q + rng.normal(size=len(q)) * 1e-3 * passive
        assert closure.gap(pushed) > 1e-6
        assert np.abs(closure.polished(pushed) - q).max() < 1e-9


@pytest.mark.parametrize("name", MACHINES)
def test_the_jacobian_is_that_of_the_constraints(name: str) -> None:
    """What Pinocchio's own constraints leave of the joints' velocities is what the map's elimination says."""
    robot, rows = states(name, 25)
    closure = closure_of(robot)
    for row in rows:
        q = robot.q(row)
        _, constraints = closure.error(q)
        rates = robot.chain.axis_map.dq_daxes(row)
        assert np.abs(constraints @ rates).max() < 1e-9 * max(1.0, np.abs(rates).max())
        step = 1e-5
        for n, factor in enumerate(robot.kinematics.si_factors):
            ahead, behind = (robot.fk(row + sign * step / factor * np.eye(len(row))[n]) for sign in (1.0, -1.0))
            moved = (ahead.translation - behind.translation) / (2.0 * step)
            expected = robot.fk(row).rotation @ robot.jacobian(row)[:3, n]
            assert np.abs(moved - expected).max() < 1e-6


def test_the_same_axes_give_the_same_pose_after_any_other_call() -> None:
    robot, rows = states("delta_kin37", 20)
    first = [robot.fk(row).homogeneous for row in rows]
    for row in rows[::-1]:
        robot.fk(row)
        robot.ik(robot.fk(row))
        robot.jacobian(row)
    assert all((robot.fk(row).homogeneous == T).all() for row, T in zip(rows, first, strict=True))


def test_what_does_not_close_names_the_rod_and_by_how_much() -> None:
    robot = Robot.load("tripod_kin12")
    with pytest.raises(ChainbuildError, match=r"those of Z1 and Z3 together are 2839\.65 mm too short"):
        robot.fk([5000.0, 900.0, 900.0])  # √(3 · 330² + 4100²) - 2 · 650
    with pytest.raises(ChainbuildError, match=r"the rod of Z[13] is [0-9.]+ mm too short for where the others") as told:
        robot.fk([900.0, 900.0, 2050.0])
    assert told.value.parameter in {"Z1", "Z3"}
    T = robot.fk([900.0, 900.0, 900.0])
    T.translation[0] += 1.0
    found = robot.ik(T)
    assert found.status == "unreachable"
    assert "the rod of Z" in found.reason
    assert "mm too short" in found.reason
    apart = Robot.load("lambda_kin21")
    with pytest.raises(ChainbuildError, match=r"the rods do not meet: .* 1[0-9.]+ mm too short"):
        apart.fk([-900.0, 1000.0, 200.0, 0.0])


def test_check_refuses_loops_that_leave_other_freedoms_than_the_axes() -> None:
    robot = Robot.load("delta_kin37")
    fewer = Robot(replace(robot.chain, loops=robot.chain.loops[:2]))
    with pytest.raises(ChainError, match="leave 6 freedoms for 3 axes"):
        check_closure(fewer)
    moved = [
        replace(frame, T_link_frame=frame.T_link_frame + np.diag([0.0] * 4) + np.eye(4, k=3) * 1e-3)
        if frame.name.endswith("J1_pin")
        else frame
        for frame in robot.chain.frames
    ]
    with pytest.raises(ChainError, match=r"do not close: a gap of 0\.001 m"):
        check_closure(Robot(replace(robot.chain, frames=tuple(moved))))


def test_rods_are_looked_at_inside_the_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not at their ends, where arms that stand in line or square may hide what is wrong."""
    robot = Robot(with_linkage(Robot.load("palletiser_kin96").chain, RodData()))
    seen: list[np.ndarray] = []
    gap = Closure.gap
    monkeypatch.setattr(Closure, "gap", lambda closure, q: [seen.append(q), gap(closure, q)][1])
    for seed in range(20):
        check_closure(robot, seed)
    drawn = np.array([robot.axes_from_q(q) for q in seen])
    lower, upper = np.array([axis.range for axis in robot.axes]).T
    assert len(drawn) == 20
    assert ((drawn > lower) & (drawn < upper)).all()
    assert (np.ptp(drawn, axis=0) > 0.6 * (upper - lower)).all()


@pytest.mark.parametrize("kin", [12, 21])
def test_rows_are_posed_one_by_one_however_many(kin: int, tmp_path: Path) -> None:
    """More of them than are computed at a time: each pose is that of the formula by hand."""
    rng = np.random.default_rng(kin)
    hd = random_hd(kin, rng, {})
    path = tmp_path / f"kin{kin}.lis"
    path.write_text(channel_list(kin, hd))
    robot = Robot.load(path)
    rows = np.array([random_closing(kin, hd, {}, rng) for _ in range(5)])
    wanted = np.array([LOOPS[kin](hd, row.tolist(), 0.0, {}) for row in rows])
    wanted[:, :3, 3] /= 1000.0
    which = np.arange(4999) % 5
    found = robot.fk_batch(rows[which])
    assert np.abs(found - wanted[which]).max() < 1e-9
    many = rows[which]
    many[4321, 0] += 1e5  # an arm that stands far away from the others
    with pytest.raises(ChainbuildError, match=r"^row 4321: "):
        robot.fk_batch(many)


def test_only_balls_close() -> None:
    robot = Robot.load("delta_kin37")
    hinge = replace(robot.chain.loops[0], kind="hinge")
    with pytest.raises(ChainError, match="only balls close here"):
        Closure(robot, [hinge])


LINKAGES = [
    ("palletiser_kin96", {}, {}),
    ("palletiser_kin96", {"kin96_arm2_angle": "relative"}, {"crank": 0.3}),
    ("palletiser_kin96", {"kin96_zero_pose": "arm1_forward"}, {}),
]


@pytest.mark.parametrize(("name", "conventions", "data"), LINKAGES)
def test_the_level_linkage_as_loops_agrees_with_the_affine_rows(
    name: str, conventions: dict[str, str], data: dict[str, float]
) -> None:
    """Plate, head and both level rods closed by balls: the axes' rows close them, and Newton comes back to them."""
    plain = Robot.load(name, conventions=conventions)
    robot = Robot(with_linkage(plain.chain, RodData(**data)))
    loops = rod_loops(robot.chain)
    assert [loop.name for loop in loops] == [ROD, LEVEL_ROD, HEAD_ROD]
    names = [joint.name for joint in robot.chain.joints]
    plate, head = names.index(LEVEL_PLATE), names.index(level_joint(robot))
    pairs = [(plate, names.index(LEVEL_ROD)), (head, names.index(HEAD_ROD))]
    closures = [Closure(robot, [loop]) for loop in loops[1:]]
    lower, upper = np.array([axis.range for axis in robot.axes]).T
    rng, polished = np.random.default_rng(9), [0, 0]
    for _ in range(150):
        axes = lower + (upper - lower) * rng.random(len(lower))
        q = robot.q(axes)
        assert np.abs(robot.fk(axes).homogeneous - plain.fk(axes).homogeneous).max() < 1e-14
        for n, (moving, closure) in enumerate(zip(pairs, closures, strict=True)):
            assert closure.gap(q) < 1e-12
            _, J = closure.error(q)
            values = np.linalg.svd(J[:, moving], compute_uv=False)
            assert values[1] > 0.0
            if values[1] < np.sin(np.radians(0.5)) * values[0]:
                continue  # rod and arm in line
            polished[n] += 1
            pushed = q.copy()
            pushed[list(moving)] += rng.normal(size=2) * 1e-4
            assert np.abs(closure.polished(pushed, np.array(moving)) - q).max() < 1e-12 / values[1]
    assert min(polished) > 140
    # In the middle of the range each pin stands across its arm, farthest from lying in line.
    placed = robot.frame_placements((lower + upper) / 2.0)
    for rod, end in ((LEVEL_ROD, LEVEL_PLATE), (HEAD_ROD, names[head])):
        arm = placed[end].translation - placed[before(robot, rod)].translation
        beside = placed[f"{rod}_pin"].translation - placed[end].translation
        assert abs(float(arm @ beside)) < 1e-9
    # The rods are as long as the arms, between pins that stand apart alike; the fixed pin carries no angle.
    placed = robot.frame_placements(axes)
    for rod, arm in ((LEVEL_ROD, placed[LEVEL_PLATE]), (HEAD_ROD, placed[names[head]])):
        assert np.linalg.norm(placed[f"{rod}_pin"].translation - placed[rod].translation) == pytest.approx(
            np.linalg.norm(arm.translation - placed[before(robot, rod)].translation), abs=1e-12
        )


def level_joint(robot: Robot) -> str:
    """Return the joint that keeps the head level."""
    return next(joint.name for joint in robot.chain.joints if joint.child == robot.chain.frame(f"{HEAD_ROD}_pin").link)


def before(robot: Robot, rod: str) -> str:
    """Return the joint at which the arm begins that a level rod is parallel to."""
    child = robot.chain.frame(ROD_PIN).link
    if rod == LEVEL_ROD:
        child = next(joint.parent for joint in robot.chain.joints if joint.name == LEVEL_PLATE)
    return next(joint.name for joint in robot.chain.joints if joint.child == child)


def test_an_overlay_draws_the_level_linkage_and_says_what_is_assumed(tmp_path: Path) -> None:
    file = tmp_path / "palletiser.lis"
    file.write_text(load("palletiser_kin96").path.read_text("utf-8"), "utf-8")
    overlay = tmp_path / "palletiser.chainbuild.toml"
    overlay.write_text("[geometry]\nrods = true\n", "utf-8")
    robot = Robot.load(file)
    check_closure(robot)
    masters = followers(robot.chain)
    assert {LEVEL_ROD, HEAD_ROD, LEVEL_PLATE} <= set(masters)
    assert masters[LEVEL_ROD][0] == "G2"
    told = [note for note in urdf_limitations(robot.chain) if "assumed" in note]
    assert told[0] == (
        "the lengths are assumed of the crank and between the pins of the level linkage: no machine data give them, and"
        " they move no tool"
    )
    overlay.write_text("[geometry]\nrods = true\ncrank_mm = 250\n", "utf-8")
    told = [note for note in urdf_limitations(Robot.load(file).chain) if "assumed" in note]
    assert told[0].startswith("the length is assumed between the pins of the level linkage: ")
    # Dimensions of the linkage move no tool and no other link.
    axes = [10.0, 20.0, -5.0, 30.0]
    wider = Robot.load(file)
    for name, T in robot.frame_placements(axes).items():
        if not name.startswith(("level_rod", "level_head_rod", "rod", "crank", "level_crank")):
            assert wider.frame_placements(axes)[name].isApprox(T, 1e-12), name
    moved = [
        replace(frame, T_link_frame=frame.T_link_frame + np.eye(4, k=3) * 1e-3)
        if frame.name == f"{HEAD_ROD}_pin"
        else frame
        for frame in robot.chain.frames
    ]
    with pytest.raises(ChainError, match=r"do not close: a gap of 0\.001 m"):
        check_closure(Robot(replace(robot.chain, frames=tuple(moved))))


def test_only_a_level_flange_has_a_level_linkage() -> None:
    for name in ("parallelogram_nr", "palletiser_kin213"):
        robot = Robot(with_linkage(Robot.load(name).chain, RodData()))
        assert [loop.name for loop in rod_loops(robot.chain)] == [ROD]
    assert rod_loops(Robot.load("palletiser_kin96").chain) == ()


@pytest.mark.parametrize("name", ["parallelogram_nr", "palletiser_kin96"])
def test_the_parallelogram_as_a_loop_agrees_with_the_affine_rows(name: str) -> None:
    """Crank and rod closed by a ball: the affine rows close it, and outside the flat band Newton comes back to them."""
    robot = Robot(with_rods(Robot.load(name).chain, RodData()))
    closure = Closure(robot, [Loop("rod", "ball", ROD_END, ROD_PIN)])
    names = [joint.name for joint in robot.chain.joints]
    crank, rod = names.index(CRANK), names.index(ROD)
    rng = np.random.default_rng(8)
    lower, upper = np.array([axis.range for axis in robot.axes]).T
    polished = 0
    for _ in range(300):
        q = robot.q(lower + (upper - lower) * rng.random(len(lower)))
        assert closure.gap(q) < 1e-12
        _, J = closure.error(q)
        values = np.linalg.svd(J[:, [crank, rod]], compute_uv=False)
        if values[1] < np.sin(np.radians(0.5)) * values[0]:
            continue  # the band in which crank and rod lie in line: closed to 6e-15 they are open to 1e-7 rad
        polished += 1
        pushed = q.copy()
        pushed[[crank, rod]] += rng.normal(size=2) * 1e-4
        assert np.abs(closure.polished(pushed, np.array([crank, rod])) - q).max() < 1e-11
    assert polished > 200


def test_six_rods_keep_the_platform_from_turning() -> None:
    """With all rods and a platform that may turn the closed form closes as well, and nothing that is left turns it."""
    hd = {4: 40.0, 5: 150.0, 6: 500.0, 7: 200.0}
    six, (robot, rows) = SixRods(hd), states("delta_kin37", 200)
    for row in rows:
        q = six.q(robot, row)
        errors, J = six.closure.error(q)
        assert J.shape == (18, 21)
        assert np.abs(errors).max() < 1e-12
        _, values, Vt = np.linalg.svd(J)
        assert values[-1] > 1e-4  # m: the three axes are all that is left …
        assert np.abs(Vt[18:, 3:6]).max() < 1e-12  # … and turn nothing
    rng = np.random.default_rng(5)
    for row in rows[:20]:
        q = six.q(robot, row)
        pushed = q.copy()
        pushed[six.passive] += rng.normal(size=18) * 1e-3
        assert np.abs(six.closure.polished(pushed, six.passive) - q).max() < 1e-9


def test_outputs_name_the_loops_and_their_passive_joints(tmp_path: Path) -> None:
    robot = Robot.load("delta_kin37")
    written = write_srdf(robot, tmp_path, samples=5).read_text("utf-8")
    passive = [joint.name for joint in robot.chain.joints if joint.name not in ("J1", "J2", "J3")]
    assert re.findall(r'passive_joint name="([^"]+)"', written) == passive
    assert len(passive) == 9
    assert "at random where the loops close" in written
    text = write_urdf(robot, tmp_path).read_text("utf-8")
    for loop in robot.chain.loops:
        assert f"loop {loop.name} (ball between {loop.frame_a} and {loop.frame_b}) is open" in text
    assert all(f'<joint name="{joint.name}"' in text for joint in robot.chain.joints)
    plain = Robot.load("kr6r900")
    assert "passive_joint" not in write_srdf(plain, tmp_path, samples=5).read_text("utf-8")
