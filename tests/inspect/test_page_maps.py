"""The page's twins of closed axis maps and of drives compute what Python computes."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Browser

from chainbuild.chain.axismap import AxisMap, random_axis_values
from chainbuild.chain.closing import drawn_range
from chainbuild.chain.drives import AffineDrives, DriveMap, DrivesSideBySide
from chainbuild.formats.twincat.axis_offsets import ShiftedDrives
from chainbuild.formats.twincat.maps.arms import Column, Lever
from chainbuild.formats.twincat.maps.drives import BevelDrives, SpatialDrives, VirtualTurnDrives
from chainbuild.formats.twincat.maps.heads import SpatialAnglesMap, VirtualTurnMap
from chainbuild.formats.twincat.maps.scissors import LambdaMap
from chainbuild.formats.twincat.maps.struts import ThreeRodsMap
from chainbuild.formats.twincat.maps.table import TableMap
from chainbuild.formats.twincat.maps.table_rods import TableRods
from chainbuild.inspect.chain_data import as_json
from chainbuild.kinematics.closure import closing_axes
from chainbuild.kinematics.inputs import Pose
from chainbuild.robot import Robot
from tests.kit.module_page import computed, module_page, page_modules

SAME = 1e-12  # m, rad
POSITION = 1e-9  # m, of poses reached again
MACHINES = ("delta_kin37", "lambda_kin21", "tripod_kin12", "tripod_table_kin209", "rod_table_kin19")
ROWS, OTHERS, BESIDE, POSED = 1000, 200, 100, 40  # of a machine, of another map; where nothing closes; with branches

Rows = NDArray[np.float64]

SCRIPT = """
async ({ maps, drives }) => {
  const loops = await import("cb/loops");
  const { driveMap } = await import("cb/drives");
  const inMap = ({ data, rows, beside, between, poses, frames }) => {
    const map = new loops[data.class](data);
    return {
      q: rows.map((row) => map.q(row)),
      beside: beside.map((row) => map.q(row)),
      closing: between.map((q) => map.closing(q)),
      posed: poses.map((pose) => map.posed(pose, ...frames)),
    };
  };
  const each = (cases, made) => Object.fromEntries(Object.entries(cases).map(([name, one]) => [name, made(one)]));
  const inDrives = ({ data, rows }) => {
    const { drives } = driveMap(data);
    return rows.map((row) => drives(row));
  };
  return { maps: each(maps, inMap), drives: each(drives, inDrives) };
}
"""


@dataclass(frozen=True)
class LoopCase:
    """A closed map, axis values at which it closes and others at which it does not; its machine, if it has one."""

    axis_map: Any
    rows: Rows
    beside: Rows
    robot: Robot | None = None

    @property
    def between(self) -> list[list[float]]:
        return [self.axis_map.q(row).tolist() for row in self.rows[:POSED]]

    @property
    def poses(self) -> list[Pose]:
        return [self.robot.fk(row) for row in self.rows[:POSED]] if self.robot else []

    @property
    def targets(self) -> list[Rows]:
        return [pose.homogeneous for pose in self.poses] if isinstance(self.axis_map, TableMap) else []

    @property
    def frames(self) -> list[Rows]:
        return [self.robot.chain.frame(name).T_link_frame for name in ("tool", "workpiece")] if self.robot else []

    def data(self) -> dict[str, Any]:
        return {
            "data": as_json(self.axis_map),
            "rows": self.rows.tolist(),
            "beside": self.beside.tolist(),
            "between": self.between,
            "poses": [T.ravel().tolist() for T in self.targets],
            "frames": [T.ravel().tolist() for T in self.frames],
        }


def not_closing(axis_map: AxisMap, lower: Rows, upper: Rows) -> Rows:
    """Return axis values out of five times a box at which nothing closes."""
    rng, found = np.random.default_rng(7), []
    middle, half = (lower + upper) / 2.0, 2.5 * (upper - lower)
    while len(found) < BESIDE:
        row = rng.uniform(middle - half, middle + half)
        if not np.isfinite(axis_map.q(row)).all():
            found.append(row)
    return np.array(found)


def of_machine(name: str) -> LoopCase:
    robot = Robot.load(name)
    rows = closing_axes(robot, np.random.default_rng(5), ROWS)
    return LoopCase(robot.chain.axis_map, rows, not_closing(robot.chain.axis_map, *drawn_range(robot.chain)), robot)


def far_tables(axis_map: TableMap, rng: np.random.Generator, count: int) -> Rows:
    """Return axis values of tables with carriages as far apart as they close at all."""
    reach, found = 1e3 * (axis_map.rods.length + axis_map.rods.table), []
    while len(found) < count:
        row = rng.uniform(-reach / 2.0, reach / 2.0, 5)
        if np.isfinite(axis_map.q(row)).all():
            found.append(row)
    return np.array(found)


def of_map(axis_map: AxisMap, *box: tuple[float, float]) -> LoopCase:
    lower, upper = np.array(box).T
    rng = np.random.default_rng(6)
    rows = random_axis_values(axis_map, rng, lower, upper, OTHERS)
    if isinstance(axis_map, TableMap):  # others by long ways that pass singular positions closely
        rows[OTHERS // 2 :] = far_tables(axis_map, rng, OTHERS // 2)
    closing = np.array([row for row in rows if np.isfinite(axis_map.q(row)).all()])
    return LoopCase(axis_map, closing, not_closing(axis_map, lower, upper))


def table(radial: bool, hanging: float, sizes: tuple[float, float, float] = (0.15, 0.3, 0.5)) -> TableMap:
    return TableMap(TableRods.of((40.0, 160.0, 280.0), *sizes, hanging, radial))


def loop_cases() -> dict[str, LoopCase]:
    """Return the shipped machines, and maps with every number other than 0 and every choice of a side."""
    slides, wide, turn = ((-900.0, 900.0),) * 2, (-300.0, 300.0), (-180.0, 180.0)
    carriages = (wide, wide, *((-150.0, 150.0),) * 3)
    levers = tuple(Lever(20.0 + 120.0 * n, 0.11 + 0.01 * n, 0.2, 12.0 + n) for n in range(3))
    columns = tuple(Column(25.0 + 120.0 * n, 0.45 + 0.01 * n, (-1.0) ** n) for n in range(3))
    scissors = LambdaMap((0.05, -0.03), (-1.1, -0.98), (0.9, 0.8), -1.0, (1, 0), 0.17, by_arm=False)
    return {
        **{name: of_machine(name) for name in MACHINES},
        "lambda": of_map(scissors, *slides, wide, turn),
        "lambda by the arm": of_map(replace(scissors, side=1.0, by_arm=True), *slides, wide, turn),
        "levers": of_map(ThreeRodsMap(levers, 0.5, 1.0), *((-60.0, 80.0),) * 3),
        "standing levers": of_map(ThreeRodsMap(levers, 0.5, -1.0, 1), *((-80.0, 60.0),) * 3, turn),
        "columns": of_map(ThreeRodsMap(columns, 1.0, -1.0, 2), *((-600.0, 600.0),) * 3, turn, turn),
        "table on the axis": of_map(table(False, 1.0), *carriages),
        "standing table on the axis": of_map(table(False, -1.0), *carriages),
        "radial table": of_map(table(True, 1.0), *carriages),
        "flat rods": of_map(table(True, -1.0, (0.11, 0.1, 0.15)), *carriages),
    }


def drive_cases() -> dict[str, tuple[DriveMap | None, Rows]]:
    """Return drives with axis values, some out of reach."""
    rng = np.random.default_rng(8)
    five = rng.uniform([-500.0] * 3 + [-400.0, -170.0], [500.0] * 3 + [400.0, 170.0], (ROWS, 5))
    six = rng.uniform([-500.0] * 3 + [-400.0] * 3, [500.0] * 3 + [400.0] * 3, (ROWS, 6))
    five[0, 3:] = 40.0, 130.0  # the edge of what the upright head reaches
    geared = Robot.load("geared_head_kin28").chain.drives
    assert isinstance(geared, AffineDrives)
    bevel = BevelDrives(65.0, 17.0, "b_outside")
    spatial = SpatialDrives(SpatialAnglesMap.of(40.0, (11.0, -7.0), -1.0), (5.0, -8.0))
    turned = VirtualTurnDrives(VirtualTurnMap.of((1.0, 1.0, 1.0, -1.0, 1.0, -1.0), (0.0, 0.0, 0.0, 10.0, -20.0, 30.0)))
    offset = AffineDrives(np.eye(5) + np.diag([0.0] * 3 + [0.25], 1), np.arange(5.0))
    return {
        **{name: (Robot.load(name).chain.drives, five) for name in ("cardan_head_kin59", "geared_head_kin28")},
        "rotated_head_kin70": (Robot.load("rotated_head_kin70").chain.drives, six),
        **{
            f"bevel_head_kin76 {axes}": (replace(bevel, arrangement=axes), five)
            for axes in ("b_outside", "a_outside", "upright")
        },
        "spatial": (spatial, five),
        "turned": (turned, six),
        "affine": (offset, five),
        "side by side": (DrivesSideBySide(offset, turned, 5), np.hstack([five, six])),
        "shifted": (ShiftedDrives(bevel, np.array([1.0, 2.0, 3.0, 4.0, -5.0])), five),
        "none": (None, five),
    }


@dataclass(frozen=True)
class Compared:
    """What Python computes from, and what the page computed."""

    loops: dict[str, LoopCase]
    drives: dict[str, tuple[DriveMap | None, Rows]]
    page: dict[str, Any]


@pytest.fixture(scope="module")
def compared(browser: Browser) -> Compared:
    loops, drives = loop_cases(), drive_cases()
    data = {
        "maps": {name: case.data() for name, case in loops.items()},
        "drives": {name: {"data": as_json(one), "rows": rows.tolist()} for name, (one, rows) in drives.items()},
    }
    page = module_page(browser, page_modules())
    return Compared(loops, drives, computed(page, SCRIPT, data))


def numbers(found: list[Any]) -> Rows:
    return np.array(found, dtype=float)


def test_closed_maps(compared: Compared) -> None:
    for name, case in compared.loops.items():
        q = np.array([case.axis_map.q(row) for row in case.rows])
        assert len(q) == (ROWS if name in MACHINES else OTHERS)
        np.testing.assert_allclose(numbers(compared.page["maps"][name]["q"]), q, rtol=0.0, atol=SAME, err_msg=name)


def test_closed_maps_have_no_values_where_nothing_closes(compared: Compared) -> None:
    for name, case in compared.loops.items():
        found = numbers(compared.page["maps"][name]["beside"])
        assert found.shape == (BESIDE, len(case.between[0]))
        assert np.isnan(found).all(), name


def test_values_that_close(compared: Compared) -> None:
    for name, case in compared.loops.items():
        for q, found in zip(case.between, compared.page["maps"][name]["closing"], strict=True):
            wanted = case.axis_map.closing(np.array(q))
            assert [len(values) for values in found] == [len(values) for values in wanted], name
            flat = [list(itertools.chain(*values)) for values in (found, wanted)]
            np.testing.assert_allclose(*flat, rtol=0.0, atol=1e3 * SAME, err_msg=name)


def test_table_posed(compared: Compared) -> None:
    case = compared.loops["rod_table_kin19"]
    found = numbers(compared.page["maps"]["rod_table_kin19"]["posed"])
    wanted = [case.axis_map.posed(T, *case.frames) for T in case.targets]
    np.testing.assert_allclose(found, wanted, rtol=0.0, atol=SAME)
    np.testing.assert_allclose(found[:, :8], np.array(case.between)[:, :8], rtol=0.0, atol=POSITION)


def test_drives(compared: Compared) -> None:
    lost = 0
    for name, (drives, rows) in compared.drives.items():
        wanted = np.array([row if drives is None else drives.drives(row) for row in rows])
        found = numbers(compared.page["drives"][name])
        lost += int(np.isnan(wanted).any(axis=1).sum())
        # Values are mm and degrees.
        np.testing.assert_allclose(found, wanted, rtol=0.0, atol=math.degrees(SAME), err_msg=name)
    assert lost > BESIDE
