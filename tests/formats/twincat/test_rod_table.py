"""KIN_TYP 19, the table on three rods, against formulas by hand: states, choices, branches, what is refused."""

from __future__ import annotations

import itertools
import math
import signal
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild.chain.axismap import SamplingMap
from chainbuild.chain.bodies.body import TOOL_SIDE, WORKPIECE_SIDE
from chainbuild.chain.bodies.shapes import detail_bodies, link_bodies
from chainbuild.chain.closing import LosingMap, RangingMap
from chainbuild.convention import applying_to, conventions
from chainbuild.errors import AxisValueError, ChainbuildError, ConventionError
from chainbuild.formats.load import check
from chainbuild.formats.twincat.maps.table_rods import TableRods
from chainbuild.kinematics.closure import check_closure, closing_axes, closure_of
from tests.hand.loops_table import (
    TABLE_CHOICES,
    channel_list,
    continued,
    heights,
    placed,
    random_hd,
    random_state,
    residuals,
    table_of,
    tool_in_workpiece,
    turn,
)
from tests.hand.tables_algebra import Matrix
from tests.kit.draws import seed_of

GUIDES = TABLE_CHOICES["kin19_guide"]
POSITION_MM = 1e-6
ROTATION = 1e-9
FOUND_AGAIN = 1e-6  # mm
STATES = 2000  # of both guides and all choices
DRAWN = 2  # beside them, a machine
SHIPPED = {1: 80.0, 2: 500.0, 3: 150.0, 4: 300.0, 5: 40.0}
FLAT = {1: 80.0, 2: 110.0, 3: 100.0, 4: 200.0, 5: 40.0}  # rods that may come to lie flat before the table is upright

ENDLESS_S = 30.0  # of processor time in one test: the longest takes two

Hd = dict[int, float]
Conv = dict[str, str]


@pytest.fixture(autouse=True)
def ends(request: pytest.FixtureRequest) -> Iterator[None]:
    """Fail a test whose way from home never ends: each step that is not found must be tried shorter."""

    def endless(*_: object) -> None:
        raise TimeoutError("a way from home does not end")

    before = signal.signal(signal.SIGVTALRM, endless)
    signal.setitimer(signal.ITIMER_VIRTUAL, 0.0 if request.node.get_closest_marker("slow") else ENDLESS_S)
    yield
    signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
    signal.signal(signal.SIGVTALRM, before)


def build(folder: Path, hd: Hd, conv: Conv, length: float = 0.0) -> chainbuild.Robot:
    path = folder / "kin19.lis"
    path.write_text(channel_list(hd))
    return chainbuild.Robot(chainbuild.load(path).chain(tool_length_mm=length, conventions=conv))


def guided(guide: str) -> chainbuild.Robot:
    return chainbuild.Robot(chainbuild.load("rod_table_kin19").chain(conventions={"kin19_guide": guide}))


def metres(T: Matrix) -> pin.SE3:
    return pin.SE3(T[:3, :3], T[:3, 3] / 1000.0)


def millimetres(T: pin.SE3) -> Matrix:
    M: Matrix = T.homogeneous
    M[:3, 3] *= 1000.0
    return M


def compare(robot: chainbuild.Robot, hd: Hd, conv: Conv, length: float, rng: np.random.Generator, states: int) -> None:
    """Poses drawn by hand, with the way there looked at, come out; of any others rods, guide and torsion are right."""
    for _ in range(DRAWN):
        axes, M = random_state(hd, conv, rng)
        T, wanted = millimetres(robot.fk(axes)), tool_in_workpiece(hd, axes[0], axes[1], M, length)
        where = f"{conv}, HD {hd}, L {length}, axes {axes}"
        assert np.abs(T - wanted)[:3, 3].max() <= POSITION_MM, where
        assert np.abs(T - wanted)[:3, :3].max() <= ROTATION, where
    rows = closing_axes(robot, rng, states)
    assert len(rows) == states
    for row in rows.tolist():
        M = table_of(hd, row, millimetres(robot.fk(row)), length)
        assert np.abs(residuals(hd, row, M, conv)).max() <= POSITION_MM, (conv, hd, row)


EVERY = [
    {"kin19_guide": guide} | ({name: choice} if name != "kin19_guide" else {})
    for guide in GUIDES
    for name in TABLE_CHOICES
    for choice in (TABLE_CHOICES[name] if name != "kin19_guide" else ("",))
]


@pytest.mark.parametrize("conv", EVERY, ids=lambda conv: "-".join(conv.values()))
def test_the_table_closes_by_its_hand_formula(conv: Conv, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("rod table", *conv.values()))
    machines = 2
    for _ in range(machines):
        hd, length = random_hd(rng), float(rng.choice([0.0, rng.uniform(10.0, 200.0)]))
        robot = build(tmp_path, hd, conv, length)
        assert [axis.name for axis in robot.axes] == ["X", "Y", "Z1", "Z2", "Z3"]
        compare(robot, hd, conv, length, rng, STATES // machines // len(EVERY) + 1)


def test_the_choices_are_those_of_the_hand_formulas() -> None:
    own = {convention.name for convention in applying_to(["KIN 19"])}
    assert own == set(TABLE_CHOICES)
    for name, choices in TABLE_CHOICES.items():
        assert tuple(conventions()[name].choices) == choices
        assert conventions()[name].default == ("" if name == "kin19_guide" else choices[0])


@pytest.mark.parametrize("guide", GUIDES)
def test_the_state_is_that_which_continues_from_level(guide: str, tmp_path: Path) -> None:
    """Followed by hand in small steps with six unknowns, also to where another solution is near."""
    rng = np.random.default_rng(seed_of("continued", guide))
    for hd in (SHIPPED, FLAT):
        conv = {"kin19_guide": guide}
        robot = build(tmp_path, hd, conv)
        for axes in closing_axes(robot, rng, 2):
            M = continued(hd, axes.tolist(), conv)
            T = tool_in_workpiece(hd, axes[0], axes[1], M, 0.0)
            assert np.abs(millimetres(robot.fk(axes)) - T).max() < 1e-5


@pytest.mark.parametrize("guide", GUIDES)
def test_the_loops_close_and_leave_one_freedom_an_axis(guide: str) -> None:
    robot = guided(guide)
    closure = closure_of(robot)
    rows = closing_axes(robot, np.random.default_rng(6), 1000)
    assert len(rows) == 1000
    assert max(closure.gap(robot.q(row)) for row in rows) < 1e-12
    assert {closure.mobility(robot.q(row)) for row in rows[:20]} == {5}
    check_closure(robot)
    for row in rows[:50]:
        _, constraints = closure.error(robot.q(row))
        rates = robot.chain.axis_map.dq_daxes(row)
        assert np.abs(constraints @ rates).max() < 1e-9 * np.abs(rates).max()
    passive = [name for name in robot.model.names if name not in {"universe", *(axis.name for axis in robot.axes)}]
    turns = ["table_a", "table_b", "table_c"]
    if guide == "radial_planes":
        assert passive == ["table_z", "table_x", "table_y", *turns, *(f"Z{n}_swing" for n in (1, 2, 3))]
    else:
        rods = [f"Z{n}_{turned}" for n in (1, 2, 3) for turned in ("swing", "lean")]
        assert passive == ["table_z", *turns, *rods, "guide_lower", "guide_upper"]


@pytest.mark.parametrize("guide", GUIDES)
def test_what_is_drawn_stays_inside_and_meets_the_range(guide: str) -> None:
    axis_map = guided(guide).chain.axis_map
    assert isinstance(axis_map, SamplingMap)
    rng = np.random.default_rng(seed_of("rod table drawn", guide))
    lower, upper = np.array([-100.0, 40.0, -900.0, -850.0, -800.0]), np.array([300.0, 190.0, -500.0, -450.0, -400.0])
    rows = [axis_map.drawn_axes(rng, lower, upper) for _ in range(300)]
    drawn = np.array([row for row in rows if row is not None])
    assert len(drawn) > 30
    assert ((drawn >= lower) & (drawn <= upper)).all()
    assert (np.ptp(drawn, axis=0) > 0.6 * (upper - lower)).all()


@pytest.mark.parametrize("guide", GUIDES)
def test_joint_values_and_their_derivative(guide: str) -> None:
    """q comes back as axes, stays inside its bounds, and changes as its derivative says; so does the tool."""
    robot = guided(guide)
    axis_map = robot.chain.axis_map
    lower, upper = axis_map.q_bounds(*np.array([axis.range for axis in robot.axes]).T)
    step = 1e-3
    for row in closing_axes(robot, np.random.default_rng(7), 40):
        q, J = robot.q(row), axis_map.dq_daxes(row)
        assert axis_map.axes(q) == pytest.approx(row, abs=1e-9)
        assert ((q >= lower) & (q <= upper)).all()
        if np.abs(J).max() > 30.0:
            continue  # close to a singular position differences say nothing
        ends = [(row + step * one, row - step * one) for one in np.eye(5)]
        moved = np.array([(robot.q(ahead) - robot.q(behind)) for ahead, behind in ends]).T / (2e-3 * step)
        assert np.abs(moved - J).max() < 1e-5
        tool = robot.jacobian(row)
        for n, (ahead, behind) in enumerate(ends):
            way = robot.fk(row).actInv(robot.fk(ahead)), robot.fk(row).actInv(robot.fk(behind))
            rate = (pin.log6(way[0]).vector - pin.log6(way[1]).vector) / (2e-3 * step)
            assert np.abs(rate - tool[:, n]).max() < 1e-6 * max(1.0, np.abs(tool).max())


def round_trip(folder: Path, guide: str, count: int) -> None:
    robot = build(folder, SHIPPED, {"kin19_guide": guide})  # without limits, up to where it is singular or upright
    rows = closing_axes(robot, np.random.default_rng(8), count)
    assert len(rows) == count
    for row in rows:
        T = robot.fk(row)
        if np.abs(robot.chain.axis_map.dq_daxes(row)).max() > 200.0:
            continue  # so close to a singular position that digits are lost
        found = robot.ik(T)
        assert found.success, (row, found)
        assert np.abs(found.axes - row).max() < FOUND_AGAIN


@pytest.mark.parametrize("guide", GUIDES)
def test_axes_are_found_again(guide: str, tmp_path: Path) -> None:
    round_trip(tmp_path, guide, 150)


@pytest.mark.slow
@pytest.mark.parametrize("guide", GUIDES)
def test_ten_thousand_axes_are_found_again(guide: str, tmp_path: Path) -> None:
    round_trip(tmp_path, guide, 5000)


@pytest.mark.parametrize("guide", GUIDES)
def test_every_branch_is_one_that_the_way_from_level_leads_to(guide: str, tmp_path: Path) -> None:
    """Each rod reaches from two heights; of the eight combinations those count that forward kinematics returns."""
    rng = np.random.default_rng(seed_of("rods", guide))
    conv = {"kin19_guide": guide}
    robot = build(tmp_path, FLAT, conv)
    rank = robot.chain.axis_map.rank
    assert rank(np.zeros(5)) == 0  # at home all carriages stand on their side
    passed = others = 0
    for _ in range(400):
        axes = [5.0, 6.0, *rng.uniform(-100.0, 100.0, 3)]
        try:
            T = robot.fk(axes)
        except ChainbuildError:
            continue
        if passed % 4 and rank(np.array(axes)) == 0:
            continue
        passed += 1
        each = heights(FLAT, table_of(FLAT, axes, millimetres(T), 0.0), conv)
        wanted = []
        for own in itertools.product(*each):
            try:
                there = robot.fk([5.0, 6.0, *own])
            except ChainbuildError:
                continue
            if np.abs(there.homogeneous - T.homogeneous).max() < 1e-7:
                wanted.append([5.0, 6.0, *own])
        found = robot.ik_all(T).axes
        assert len(found) == len(wanted) > 0
        assert np.abs(found - axes).max(axis=1).min() < 1e-4
        for one in wanted:
            assert np.abs(found - one).max(axis=1).min() < 1e-4
        assert rank(robot.ik(T).axes) == min(map(rank, found))
        others += rank(np.array(axes)) > 0
    assert others > 1, "no carriage went past its rod lying flat"


@pytest.mark.parametrize(("table", "columns"), [(150.0, 300.0), (200.0, 60.0)])
def test_rods_may_lie_flat_where_they_are_short(table: float, columns: float) -> None:
    """In radial planes the joints are HD3/2 beyond the axis, or 3/2 HD3 out, when the table comes to stand upright."""
    reach = max(columns + table / 2.0, 1.5 * table - columns)
    angle = math.radians(89.99)
    for longer in (-0.1, 0.1):
        hd = {2: reach + longer, 3: table, 4: columns}
        rods = TableRods.of([0.0, 120.0, 240.0], table, columns, hd[2], -1.0, radial=True)
        assert rods.may_lie_flat == (longer < 0.0)
        conv = {"kin19_guide": "radial_planes"}
        tilts = [[0.0, angle, 0.0], [angle, 0.0, 0.0]]
        reached = [all(heights(hd, placed(hd, turn(tilt), 0.0, conv), conv)) for tilt in tilts]
        assert all(reached) == (longer > 0.0)


@pytest.mark.parametrize("guide", GUIDES)
def test_a_path_through_the_workspace_never_jumps(guide: str, tmp_path: Path) -> None:
    conv = {"kin19_guide": guide}
    robot = build(tmp_path, SHIPPED, conv)
    share = np.linspace(0.0, 1.0, 1000)
    path, wanted = [], []
    for tilt, where in zip(np.radians(50.0) * np.sin(0.5 * np.pi * share), 14.0 * np.pi * share, strict=True):
        M = placed(SHIPPED, turn([tilt * np.cos(where), tilt * np.sin(where), 0.0]), 300.0 * np.sin(where / 5.0), conv)
        own = [one[0] for one in heights(SHIPPED, M, conv)]
        path.append([100.0 * np.cos(where), 80.0 * np.sin(where), *own])
        wanted.append(tool_in_workpiece(SHIPPED, path[-1][0], path[-1][1], M, 0.0))
    there = [robot.fk(axes) for axes in path]
    assert np.abs([millimetres(T) - M for T, M in zip(there, wanted, strict=True)]).max() < POSITION_MM
    joints = np.array([robot.q(axes) for axes in path])
    steps = np.abs(np.diff(joints, axis=0)).max(axis=1)
    assert steps.max() < 5.0 * steps.mean()
    back = robot.ik_path(there[-40:], start=path[-40])
    assert set(back.status) == {"ok"}
    assert np.abs(back.axes - path[-40:]).max() < 1e-3
    rows = robot.ik_batch([T.homogeneous for T in there[::40]])  # each from a start of its own
    assert set(rows.status) == {"ok"}


@pytest.mark.parametrize("guide", GUIDES)
def test_a_state_depends_on_its_axes_alone(guide: str) -> None:
    robot = guided(guide)
    first, other = closing_axes(robot, np.random.default_rng(9), 2)
    T, J, q = robot.fk(first).homogeneous, robot.jacobian(first), robot.q(first)

    def refused() -> None:
        with pytest.raises(ChainbuildError):
            robot.fk([0.0, 0.0, 0.0, -700.0, -900.0])

    calls: list[Callable[[], object]] = [
        lambda: robot.fk(other),
        lambda: robot.ik(robot.fk(other)),
        lambda: robot.ik_all(robot.fk(other)),
        lambda: robot.jacobian(other),
        lambda: robot.fk_batch([other, first]),
        lambda: robot.ik_path([robot.fk(first), robot.fk(other)]),
        refused,
    ]
    for call in calls:
        call()
        assert np.array_equal(robot.fk(first).homogeneous, T)
        assert np.array_equal(robot.jacobian(first), J)
        assert np.array_equal(robot.q(first), q)
    assert np.array_equal(guided(guide).fk(first).homogeneous, T)
    raised = robot.fk(first + [0.0, 0.0, 7.0, 7.0, 7.0])  # all carriages alike only lift the table
    assert raised.translation == pytest.approx(robot.fk(first).translation - 7e-3 * raised.rotation[:, 2], abs=1e-12)


def test_the_guides_differ_by_a_millimetre_at_ten_degrees(tmp_path: Path) -> None:
    """The same tool vector, the same X, Y and height of the table: the middle of the joints stands aside by 1.1 mm."""
    tilt = math.radians(10.0)
    v = [0.0, math.sin(tilt), math.cos(tilt)]
    poses = []
    for guide in GUIDES:
        robot = build(tmp_path, SHIPPED, {"kin19_guide": guide})
        found = robot.from_display(
            {"x_mm": 0.0, "y_mm": 0.0, "z_mm": 0.0} | dict(zip(robot.chain.display.columns, v, strict=True))
        )
        assert found.success
        poses.append(found.axes)
        shown = robot.display(found.axes)
        assert [shown[name] for name in ("tool_x", "tool_y", "tool_z")] == pytest.approx(v, abs=1e-9)
    aside = np.hypot(*(poses[0] - poses[1])[:2])
    assert aside == pytest.approx(150.0 * math.sin(tilt / 2.0) ** 2, abs=1e-6)
    assert aside == pytest.approx(1.1, abs=0.05)


def test_vector_alone_is_programmed(tmp_path: Path) -> None:
    robot = guided("radial_planes")
    assert robot.chain.display.kind == "vector"
    assert robot.task == "direction"
    assert robot.plan().name == "struts"
    assert robot.plan(held=["X"]).name == "search"
    row = closing_axes(robot, np.random.default_rng(10), 1)[0]
    T = robot.fk(row)
    spun = T * pin.SE3(pin.rpy.rpyToMatrix(0.0, 0.0, 1.0), np.zeros(3))  # the turn about the tool vector does not count
    assert np.abs(robot.ik(spun).axes - row).max() < FOUND_AGAIN
    held = robot.ik(T, held={"X": row[0]})
    assert held.success and np.abs(held.axes - row).max() < 1e-3


# refused


def bare(folder: Path, hd: Hd | None = None) -> Path:
    path = folder / "bare.lis"
    path.write_text(channel_list(hd or SHIPPED))
    return path


def test_a_guide_must_be_chosen(tmp_path: Path) -> None:
    path = bare(tmp_path)
    with pytest.raises(ConventionError) as told:
        chainbuild.Robot.load(path)
    words = str(told.value)
    assert (told.value.parameter, told.value.code, told.value.line) == ("kin19_guide", "CB438", 1)
    assert told.value.permitted == "radial_planes, centre_on_axis"
    assert "--convention kin19_guide=radial_planes" in words and "[conventions]" in words
    for meaning in conventions()["kin19_guide"].choices.values():
        assert meaning in words
    assert [(finding.code, finding.severity) for finding in check(path)] == [("CB438", "error")]
    assert [entry.title for entry in chainbuild.load(path).kinematics()] == ["Table on three rods"]
    assert len(chainbuild.load(path).parameters()) >= 5
    path.with_suffix(".chainbuild.toml").write_text('[conventions]\nkin19_guide = "centre_on_axis"\n')
    assert chainbuild.Robot.load(path).model.existJointName("guide_lower")
    assert not any(finding.severity == "error" for finding in check(path))


@pytest.mark.parametrize(
    ("hd", "words"),
    [
        ({2: 0.0}, "rod length is 0 mm"),
        ({3: 0.0}, "table radius is 0 mm"),
        ({4: 0.0}, "column radius is 0 mm"),
        ({2: 150.0}, "rods of 150 mm do not reach from 300 mm, the radius of the columns, to 150 mm"),
        ({2: 149.0}, "do not reach"),
    ],
)
def test_tables_that_no_machine_can_have(hd: Hd, words: str, tmp_path: Path) -> None:
    path = bare(tmp_path, SHIPPED | hd)
    with pytest.raises(ChainbuildError, match=words):
        chainbuild.load(path).chain(conventions={"kin19_guide": "radial_planes"})
    path.with_suffix(".chainbuild.toml").write_text('[conventions]\nkin19_guide = "radial_planes"\n')
    assert any(words in finding.text for finding in check(path))


def test_upright_rods_are_no_singularity(tmp_path: Path) -> None:
    """Unlike those of the tripods (12) rods of equal radii hold the table: the guide does the rest."""
    robot = build(tmp_path, SHIPPED | {4: 150.0}, {"kin19_guide": "radial_planes"})
    J = robot.jacobian([0.0] * 5)
    assert np.linalg.svd(J, compute_uv=False)[4] > 0.1


def test_what_is_not_reached_names_the_rod_and_by_how_much() -> None:
    robot = guided("radial_planes")
    axes = [0.0, 0.0, -300.0, -720.0, -690.0]
    for call in (robot.fk, robot.jacobian, robot.q, robot.frame_placements):
        with pytest.raises(
            AxisValueError, match=r"stops at a tilt of [0-9.]+ deg, where the rod of Z1 is [0-9.]+ mm too (short|long)"
        ):
            call(axes)
    # A carriage that goes down runs away from the table, one that rises comes closer, and far up runs away again.
    for height, words in (
        (-900.0, "3.70586 mm too short"),
        (-300.0, "33.0621 mm too long"),
        (5000.0, "2776.64 mm too short"),
    ):
        with pytest.raises(AxisValueError, match=rf"the rod of Z3 is {words}") as told:
            robot.fk([0.0, 0.0, -750.0, -750.0, height])
        assert told.value.parameter == "Z3"
    with pytest.raises(
        AxisValueError, match=r"after 95\.68 % of the way from equal heights it stops at a tilt of 58\.84 deg"
    ):
        robot.fk([0.0, 0.0, -750.0, -750.0, -900.0])
    with pytest.raises(ChainbuildError):
        robot.fk_batch([[0.0, 0.0, -700.0, -700.0, -700.0], axes])
    assert np.isnan(robot.chain.axis_map.q(np.array(axes))).all()


def test_poses_that_no_table_can_have(tmp_path: Path) -> None:
    robot = guided("radial_planes")
    T = robot.fk([0.0, 0.0, -700.0, -700.0, -700.0])
    T.rotation = pin.rpy.rpyToMatrix(2.0, 0.0, 0.0)
    found = robot.ik(T)
    assert (found.status, found.reason) == ("unreachable", "the table would stand upright, or beyond")
    short = build(tmp_path, SHIPPED | {2: 205.0, 4: 350.0}, {"kin19_guide": "centre_on_axis"})
    T = short.fk([0.0] * 5)
    T.rotation = pin.rpy.rpyToMatrix(0.0, 0.5, 0.0)
    found = short.ik(T)
    assert found.status == "unreachable"
    assert "the rod of Z1 is " in found.reason and "mm too short" in found.reason
    T.rotation = pin.rpy.rpyToMatrix(0.0, math.radians(-85.0), 0.0)
    found = build(tmp_path, SHIPPED, {"kin19_guide": "centre_on_axis"}).ik(T)
    assert (found.status, found.reason) == (
        "unreachable",
        "a singular position lies on the way there from equal heights",
    )


# singular


@pytest.mark.parametrize("guide", GUIDES)
def test_the_way_ends_where_the_table_moves_by_itself(guide: str, tmp_path: Path) -> None:
    """Lowering one carriage: the measure falls from what the level table has to 0, by a motion across every rod."""
    robot = build(tmp_path, SHIPPED, {"kin19_guide": guide})
    axis_map = robot.chain.axis_map
    assert isinstance(axis_map, LosingMap)
    level = axis_map.losses(np.zeros(5))
    upright = math.sqrt(1.0 - 0.3**2)  # 150 mm out in 500
    assert [loss.value for loss in level] == pytest.approx([upright] * 4, abs=1e-12)
    assert [loss.axes for loss in level] == [(2,), (3,), (4,), (2, 3, 4)]
    near, far = 0.0, 300.0
    while far - near > 1e-6:
        middle = (near + far) / 2.0
        near, far = (middle, far) if axis_map.losses(np.array([0.0] * 4 + [-middle])) else (near, middle)
    axes = [0.0] * 4 + [-near]
    loss = axis_map.losses(np.array(axes))[-1]
    assert loss.kind == "platform" and 0.0 < loss.value < 2e-3
    assert loss.rates is not None
    q = robot.q(axes)
    closure = closure_of(robot)
    frames = [[robot.model.getFrameId(f"Z{n}_{end}") for end in ("link", "pin")] for n in (1, 2, 3)]
    lengths = []
    for step in (1e-5, -1e-5):
        pin.framesForwardKinematics(robot.model, closure.mechanism.kinematics.data, q + step * loss.rates)
        placed_at = [one.translation.copy() for one in closure.mechanism.kinematics.data.oMf]
        lengths.append([float(np.linalg.norm(placed_at[b] - placed_at[a])) for a, b in frames])
    assert np.abs(np.diff(lengths, axis=0) / 2e-5).max() < 2e-3 * np.abs(loss.rates).max()
    assert loss.condition(True) == "the rods of Z1, Z2 and Z3 nearly stand across a motion of the table"
    carriage = axis_map.losses(np.array([0.0, 0.0, 20.0, -10.0, 0.0]))
    rises = [robot.frame_placements([0.0, 0.0, 20.0, -10.0, 0.0])[f"Z{n}_pin"].translation[2] for n in (1, 2, 3)]
    wanted = (np.array(rises) - [0.02, -0.01, 0.0]) / 0.5
    assert [loss.value for loss in carriage[:3]] == pytest.approx(wanted, abs=1e-12)
    ranges = axis_map.strut_ranges() if isinstance(axis_map, RangingMap) else ()
    assert ranges == (None, None, *((-150.0, 150.0),) * 3)


# drawn


def test_arms_are_drawn_on_the_side_of_the_workpiece() -> None:
    """The rods carry the table, which has an arm to each; nothing stands where the table hangs on no slide."""
    bodies = {guide: {body.link: body for body in link_bodies(guided(guide).chain)} for guide in GUIDES}
    for drawn in bodies.values():
        assert {drawn[f"Z{n}_swing_link"].colour for n in (1, 2, 3)} <= set(WORKPIECE_SIDE)
        assert {drawn[f"{name}_link"].colour for name in "XY"} <= set(TOOL_SIDE)
        assert drawn["base"].kind == "cylinder"
    assert bodies["centre_on_axis"]["guide_upper_link"].colour in WORKPIECE_SIDE
    levers = [body for body in detail_bodies(guided("radial_planes").chain) if body.part == "lever"]
    assert [body.link for body in levers] == ["table_c_link"] * 3
    tripod = link_bodies(chainbuild.Robot.load("tripod_kin12").chain)
    assert not any(body.colour in WORKPIECE_SIDE for body in tripod)


def test_an_option_chooses_for_check_and_a_second_kinematic_may_stay_open(tmp_path: Path, run: Any) -> None:
    path = str(bare(tmp_path))
    assert run("check", path).code == 1
    assert run("check", path, "--convention", "kin19_guide=radial_planes").code == 0
    shown = run("info", path)
    assert shown.code == 1 and "table_height" not in shown.out and "HD5" in shown.out
    assert "kin19_guide [?] (no default: choose)" in run("types", "19").out
    Path(path).write_text("trafo[0].id 9\ntrafo[1].id 19\ntrafo[1].param[1] 5000000\n")
    (finding,) = [one for one in check(path) if one.severity != "info"]
    assert (finding.code, finding.parameter) == ("CB223", "kin19_guide")
    assert chainbuild.load(path).chain().kinematic == "KIN_TYP 9"


def test_a_step_out_of_the_poses_is_halved() -> None:
    """The damped search alone, also to tilts beside which nothing closes any more."""
    chain = guided("radial_planes").chain
    limits = {"Z1": 70.0, "Z2": 70.0, "Z3": 70.0}
    wide = (
        replace(axis, lower=axis.lower - limits.get(axis.name, 0.0), upper=axis.upper + limits.get(axis.name, 0.0))
        for axis in chain.axes
    )
    robot = chainbuild.Robot(chain.with_axes(tuple(wide)))
    rows = closing_axes(robot, np.random.default_rng(13), 60)
    poses = [robot.fk(row) for row in rows if np.abs(robot.chain.axis_map.dq_daxes(row)).max() < 40.0]
    assert len(poses) > 50
    assert set(robot.ik_batch([T.homogeneous for T in poses]).status) == {"ok"}
