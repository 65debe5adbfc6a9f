"""From what the controller displays back to axis values."""

from __future__ import annotations

import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.errors import ChainbuildError
from chainbuild.ik.displayed import side_of
from chainbuild.ik.rtcp import _solved
from tests.kit.random_types import CHOSEN, channel_list, random_axes, random_machine

SHIPPED = {name: chainbuild.Robot.load(name) for name in chainbuild.shipped()}
BY_SLIDES = [name for name, robot in SHIPPED.items() if robot.chain.solves_linear_axes]
OTHERS = [name for name in SHIPPED if name not in BY_SLIDES]
TYPES = [number for number, kind in chainbuild.catalogue().items() if kind.hd and number != 98]
VECTORS = 2_000


def rows_inside(robot: chainbuild.Robot, count: int, seed: int = 0) -> np.ndarray:
    """Return axis values inside all limits, rotary ones within a turn."""
    lower, upper = (np.array([getattr(axis, end) for axis in robot.axes]) for end in ("lower", "upper"))
    wide = np.array([170.0 if axis.kind == "rotary" else 2_000.0 for axis in robot.axes])
    middle, rng = np.clip(0.0, lower, upper), np.random.default_rng(seed)
    lower, upper = np.maximum(lower, middle - wide), np.minimum(upper, middle + wide)
    rows = lower + (upper - lower) * rng.random((count, len(lower)))
    return rows[robot.limits.inside_rows(rows)]


def shown_of(robot: chainbuild.Robot, rows: np.ndarray) -> dict[str, np.ndarray]:
    """Return what is displayed at rows of axis values, column by column."""
    shown = [robot.display(row) for row in rows]
    return {name: np.array([one[name] for one in shown]) for name in shown[0]}


def test_slides_at_odd_angles_are_solved_for() -> None:
    """The slides of no machine here are oblique to each other: three equations, by a general solver."""
    rng = np.random.default_rng(7)
    rates, missing = rng.normal(size=(20, 3, 3)), rng.normal(size=(20, 3))
    np.testing.assert_allclose(_solved(rates, missing), np.linalg.solve(rates, missing[:, :, None])[:, :, 0], rtol=1e-9)


@pytest.mark.parametrize("name", BY_SLIDES)
def test_rotary_columns_bring_the_axes_back_exactly(name: str) -> None:
    robot = SHIPPED[name]
    rows = rows_inside(robot, VECTORS)
    shown = shown_of(robot, rows)
    for compiled in (True, False):
        table = robot.from_display_batch(shown, compiled=compiled)
        assert table.success.all()
        assert np.abs(table.axes - rows).max() < 1e-8
        assert np.array_equal(table.axes[:, list(robot.chain.display.axes)], rows[:, list(robot.chain.display.axes)])
        assert table.position_error.max() < 1e-9
    for row in range(0, len(rows), 400):
        found = robot.from_display({column: values[row] for column, values in shown.items()})
        assert np.abs(found.axes - rows[row]).max() < 1e-8


@pytest.mark.parametrize("kin", TYPES)
def test_every_type_comes_back(kin: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(kin)
    path = tmp_path / "machine.lis"
    path.write_text(channel_list(kin, random_machine(kin, rng)), "utf-8")
    robot = chainbuild.Robot.load(path, conventions=CHOSEN.get(kin))
    rows = np.array([random_axes(kin, rng) for _ in range(VECTORS if robot.chain.solves_linear_axes else 20)])
    rows = rows[robot.limits.inside_rows(rows)]
    assert len(rows) > 4
    shown = shown_of(robot, rows)
    if robot.chain.solves_linear_axes:
        assert np.abs(robot.from_display_batch(shown).axes - rows).max() < 1e-6
        return
    for n, row in enumerate(rows):
        found = robot.from_display({column: values[n] for column, values in shown.items()}, start=row)
        assert found.success, (row, found)
        assert np.abs(found.axes - row).max() < 1e-3


def comes_back(robot: chainbuild.Robot, rows: np.ndarray) -> None:
    for row in rows:
        shown = robot.display(row)
        found = robot.from_display(shown, start=row)
        assert found.success, (row, found)
        again = robot.display(found.axes)
        for column, value in shown.items():
            gap = again[column] - value
            gap = gap if column.endswith("_mm") else (gap + 180.0) % 360.0 - 180.0
            assert abs(gap) < 1e-2, (column, row, found.axes)


@pytest.mark.parametrize("name", OTHERS)
def test_poses_come_back(name: str) -> None:
    comes_back(SHIPPED[name], rows_inside(SHIPPED[name], 40))


@pytest.mark.slow
@pytest.mark.parametrize("name", OTHERS)
def test_many_poses_come_back(name: str) -> None:
    comes_back(SHIPPED[name], rows_inside(SHIPPED[name], VECTORS, seed=1))


SIDED = ("c_face_kin14", "scara_kin36", "lever_kin85", "cyl_2rot_kin202", "eccentric_disc_kin205")


def without_limits(name: str) -> chainbuild.Robot:
    chain = SHIPPED[name].chain
    return chainbuild.Robot(chain.with_axes(tuple(replace(axis, lower=-4e3, upper=4e3) for axis in chain.axes)))


@pytest.mark.parametrize("name", SIDED)
def test_the_side_of_the_start_is_kept(name: str) -> None:
    """The sign of X, the hand, the side of a lever: the other side is not taken, near as it may be."""
    robot = without_limits(name)
    assert robot.chain.display.keeps_side
    rows = rows_inside(robot, 400)
    sides = np.array([side_of(robot, row) for row in rows])
    assert set(sides) == {1, -1}
    for n, row in enumerate(rows[:40]):
        for side in (1, -1):
            start = rows[sides == side][n]
            found = robot.from_display(robot.display(row), start=start)
            assert found.success
            assert side_of(robot, found.axes) == side


def test_the_sign_of_x_of_a_face() -> None:
    robot = without_limits("c_face_kin14")
    shown = robot.display([100.0, 20.0, 50.0])
    for x in (40.0, -40.0):
        assert robot.from_display(shown, start=[x, 100.0, 0.0]).axes[0] == pytest.approx(2.5 * x)
    beyond = SHIPPED["c_face_kin14"].from_display(shown, start=[-40.0, 100.0, 0.0])
    assert (beyond.success, "side" in beyond.reason) == (False, True)


def test_a_lever_is_programmed_in_x_and_z() -> None:
    robot = SHIPPED["lever_kin85"]
    axes = rows_inside(robot, 5)[0]
    shown = robot.display(axes)
    assert shown["y_mm"] == 0.0
    found = robot.from_display({"x_mm": shown["x_mm"], "z_mm": shown["z_mm"]}, start=axes)
    assert np.abs(found.axes - axes).max() < 1e-6


def test_z_of_a_plunging_saw_is_kept() -> None:
    """With the programmed point on the plane z = HD11 no position determines Z."""
    robot = chainbuild.Robot.load("inclined_saw_kin207", conventions={"kin207_programmed_point": "slid_xyz"})
    assert robot.chain.display.solved == (0, 1)
    rows = rows_inside(robot, 20)
    for row in rows:
        found = robot.from_display(robot.display(row), start=[0.0, 0.0, row[2], 0.0])
        assert np.abs(found.axes - row).max() < 1e-9
    elsewhere = {**robot.display(rows[0]), "z_mm": robot.display(rows[0])["z_mm"] + 5.0}
    assert robot.from_display(elsewhere, start=rows[0]).status == "unreachable"


def test_beyond_limits_and_reach() -> None:
    robot = SHIPPED["ac_table_kin58"]
    shown = robot.display([0.0, 0.0, -200.0, 10.0, 40.0])
    far = robot.from_display({**shown, "x_mm": 5_000.0})
    assert (far.success, far.status, "X" in far.violated) == (False, "limits", True)
    assert "X is" in far.reason
    table = robot.from_display_batch({**{k: np.array([v, v]) for k, v in shown.items()}, "x_mm": [0.0, 5_000.0]})
    assert table.status == ["ok", "limits"] or table.status[1] == "limits"
    assert table[1].violated == robot.from_display({**shown, "x_mm": 5_000.0}).violated
    tilted = SHIPPED["cardan_head_kin59"]
    asked = {**tilted.display(rows_inside(tilted, 3)[0]), "A": 179.0}
    refused = tilted.from_display(asked)
    assert (refused.success, refused.status) == (False, "unreachable")
    assert "tilt" in refused.reason


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"a_deg": 1.0}, "unknown column 'a_deg'"),
        ({"C": None}, "missing column 'C'"),
        ({"x_mm": None}, "missing column 'x_mm'"),
        ({"x_mm": float("nan")}, "x_mm is nan"),
        ({"x_mm": float("inf")}, "x_mm is inf"),
        ({"x_mm": 1e12}, "x_mm is"),
        ({"A": "ten"}, "A is 'ten'"),
    ],
)
def test_wrong_columns_are_refused_with_the_right_ones(change: dict[str, object], words: str) -> None:
    robot = SHIPPED["ac_table_kin58"]
    shown = {"x_mm": 1.0, "y_mm": 2.0, "z_mm": 3.0, "A": 10.0, "C": 40.0, **change}
    given = {name: value for name, value in shown.items() if value is not None}
    for call in (robot.from_display, robot.from_display_batch):
        with pytest.raises(ChainbuildError) as caught:
            call(given)  # type: ignore[operator]
        assert words in caught.value.message
        if "column" in words:
            assert "rotary axes A, C" in str(caught.value)


def test_no_mapping_and_columns_of_other_lengths() -> None:
    robot = SHIPPED["ac_table_kin58"]
    with pytest.raises(ChainbuildError, match="mapping"):
        robot.from_display([1, 2, 3])  # type: ignore[arg-type]
    with pytest.raises(ChainbuildError, match="length"):
        robot.from_display_batch({"x_mm": [1, 2], "y_mm": [1, 2, 3], "z_mm": 0, "A": 0, "C": 0})


def test_a_full_orientation_asks_for_all_axes() -> None:
    robot = SHIPPED["ac_table_kin58"]
    axes = np.array([10.0, 20.0, -200.0, -30.0, 40.0])
    shown = robot.display(axes)
    tool = dict(zip(("tool_x", "tool_y", "tool_z"), robot.fk(axes).rotation[:, 2], strict=True))
    place = {name: shown[name] for name in ("x_mm", "y_mm", "z_mm")}
    found = robot.from_display({**place, **tool}, start=axes + 1.0)
    assert np.abs(found.axes - axes).max() < 1e-5


def test_two_steps_show_the_rotary_axes_of_the_machine(tmp_path: Path) -> None:
    """As the outer step: its rotary axes are those that the inner one passes on."""
    path = tmp_path / "steps.lis"
    lines = [
        "kin_step[0].trafo[0].id 9",
        "kin_step[0].trafo[0].param[0] 1000000",
        "kin_step[0].trafo[0].param[5] 300000",
    ]
    lines += ["kin_step[1].trafo[0].id 58", "kin_step[1].trafo[0].param[6] 500000", "Ende", ""]
    path.write_text("\n".join(lines), "utf-8")
    robot = chainbuild.Robot.load(path, kinematic=(9, 58))
    rows = np.random.default_rng(0).uniform(-100.0, 100.0, (50, 5))
    shown = shown_of(robot, rows)
    assert list(shown) == ["x_mm", "y_mm", "z_mm", "C", "A"]
    assert np.array_equal(shown["C"], rows[:, 3])
    assert np.abs(robot.from_display_batch(shown).axes - rows).max() < 1e-9


def test_input_axes_are_part_of_the_display() -> None:
    robot = SHIPPED["irb2600_track"]
    axes = np.array([10.0, 20.0, -30.0, 40.0, 50.0, 60.0, 700.0])
    shown = robot.display(axes)
    assert shown["EX1"] == 700.0
    assert np.abs(robot.from_display(shown, start=axes).axes - axes).max() < 1e-6
    del shown["EX1"]
    assert robot.from_display(shown).axes[6] == 0.0
    assert robot.from_display(shown, held={"EX1": 500.0}).axes[6] == 500.0


def test_columns_may_be_written_as_in_tables() -> None:
    robot = SHIPPED["ac_table_kin58"]
    plain = robot.from_display({"x_mm": 1.0, "y_mm": 2.0, "z_mm": 3.0, "A": 10.0, "C": 40.0}).axes
    for name in ("c", "C [deg]", "c [degrees]"):
        shown = {"X_MM": 1.0, "Y_mm": 2.0, "z_mm": 3.0, "A": 10.0, name: 40.0}
        assert np.array_equal(robot.from_display(shown).axes, plain)
    with pytest.raises(ChainbuildError, match="the same: C"):
        robot.from_display({"x_mm": 1.0, "y_mm": 2.0, "z_mm": 3.0, "A": 10.0, "C": 40.0, "c": 1.0})
    with pytest.raises(ChainbuildError, match="shape"):
        robot.from_display({"x_mm": [1.0, 2.0], "y_mm": 2.0, "z_mm": 3.0, "A": 10.0, "C": 40.0})  # type: ignore[dict-item]


@pytest.mark.parametrize(("near", "good"), [({}, True), ({"x_mm": 1.0}, False), ({"B": 1.0}, False), (None, True)])
def test_what_was_displayed_before_must_have_the_angles(
    near: dict[str, float] | None, good: bool, tmp_path: Path
) -> None:
    path = tmp_path / "machine.lis"
    path.write_text(channel_list(208, random_machine(208, np.random.default_rng(0))), "utf-8")
    robot = chainbuild.Robot.load(path)
    assert robot.chain.display.kind == "direction"
    if good:
        assert robot.display(np.zeros(len(robot.axes)), near=near)
        return
    with pytest.raises(ChainbuildError, match="near is no such display"):
        robot.display(np.zeros(len(robot.axes)), near=near)


@pytest.mark.parametrize("name", ["ca_head_kin9", "kr6r900_2"])
def test_a_vector_without_a_direction_is_refused(name: str) -> None:
    robot = SHIPPED[name]
    columns = ("tool_x", "tool_y", "tool_z") if name == "ca_head_kin9" else ("qx", "qy", "qz", "qw")
    place = {"x_mm": 100.0, "y_mm": 0.0, "z_mm": 0.0}
    for call in (robot.from_display, robot.from_display_batch):
        for value in (0.0, 2.0):
            with pytest.raises(ChainbuildError, match="has the length"):
                call({**place, **dict.fromkeys(columns, value)})  # type: ignore[operator]


def test_held_values_in_order_remain_beside_displayed_ones() -> None:
    robot = SHIPPED["irb2600_table"]
    names = [axis.name for axis in robot.axes if axis.held]
    axes = np.zeros(len(robot.axes)) + 20.0
    shown = robot.display(axes)
    del shown[names[1]]
    for held in ([0.0, 25.0], {names[1]: 25.0}, {names[0].lower(): 99.0, names[1]: 25.0}):
        found = robot.from_display(shown, held=held)
        assert [found.axes[robot.labels.names.index(name)] for name in names] == [20.0, 25.0]


@pytest.mark.parametrize("name", ["palletiser_kin213", "palletiser_nr4", "scara_kin36", "kr6r900"])
def test_a_batch_gives_what_single_poses_give(name: str) -> None:
    robot = SHIPPED[name]
    rows = rows_inside(robot, 20)
    table = robot.from_display_batch(shown_of(robot, rows))
    for n, row in enumerate(rows):
        assert table.success[n]
        again, wanted = robot.display(table.axes[n]), robot.display(row)
        assert all(abs(np.remainder(again[c] - wanted[c] + 180.0, 360.0) - 180.0) < 1e-3 for c in wanted), (
            again,
            wanted,
        )


def test_axes_that_are_solved_for_may_be_held(tmp_path: Path) -> None:
    robot = SHIPPED["ca_head_kin9"]
    shown = robot.display([10.0, 20.0, -300.0, 10.0, 20.0])
    assert robot.from_display(shown, held={"X": 10.0}).success
    found = robot.from_display(shown, held={"X": 33.0})
    assert (found.success, found.axes[0]) == (False, 33.0)
    assert robot.from_display(shown, held={"A": 20.0}).success
    with pytest.raises(ChainbuildError, match="held at 50 and programmed at 20"):
        robot.from_display(shown, held={"A": 50.0})


@pytest.mark.parametrize("name", ["scara_kin36", "ca_head_kin9", "kr6r900_2"])
def test_tables_can_be_pickled(name: str) -> None:
    robot = SHIPPED[name]
    table = robot.from_display_batch(shown_of(robot, rows_inside(robot, 8)[:3]))
    again = pickle.loads(pickle.dumps(table))
    assert np.array_equal(again.axes, table.axes)
    assert [again[n].reason for n in range(len(again.axes))] == [table[n].reason for n in range(len(table.axes))]
