"""The page's own mathematics against Python: poses, display, drives, limits, singular values, solutions."""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Browser, Page

from chainbuild.analysis.singularity.measures import measure_batch
from chainbuild.errors import ChainbuildError
from chainbuild.formats.overlay import Overlay
from chainbuild.inspect.chain_data import chain_data
from chainbuild.kinematics.closure import closing_axes
from chainbuild.machines import shipped
from chainbuild.robot import Robot
from tests.kit.before_fold import cases, two_steps, type_chain
from tests.kit.module_page import computed, module_page, page_modules
from tests.kit.paths import PACKAGE
from tests.kit.twincat_files import machine

# One of each kind: arms of both controls, a parallelogram, held axes, heads, tables, gears, nonlinear maps, composed
# chains, SCARAs whose C turns on, closed loops by closed form and by continuation.
KINDS = (
    "kr6r900", "tx2_60", "parallelogram_nr", "irb2600_table", "scara_cc", "palletiser_nr4", "gantry_robot_kin210",
    "bed_mill_kin1", "ac_table_kin58", "geared_head_kin28", "bevel_head_kin76", "cardan_head_kin59",
    "rotated_head_kin70", "plasma_head_kin25", "cyl_2rot_kin202", "palletiser_kin213", "tripod_kin12",
    "tripod_table_kin209", "delta_kin37", "lambda_kin21", "rod_table_kin19",
)  # fmt: skip

_STATES = """
async ({ chain: data, rows }) => {
  const { Chain } = await import("cb/chain");
  const { displayed } = await import("cb/display");
  const { Limits } = await import("cb/limits");
  const { measure } = await import("cb/singular");
  const chain = new Chain(data);
  const limits = new Limits(chain);
  return rows.map((axes) => ({
    pose: chain.fk(axes), shown: displayed(chain, axes), drives: limits.driveValues(axes),
    violated: limits.violated(axes), measures: measure(chain, axes),
  }));
}
"""
_SOLUTIONS = """
async ({ chain: data, asked }) => {
  const { Chain } = await import("cb/chain");
  const { Limits } = await import("cb/limits");
  const { Solver } = await import("cb/ik");
  const { solveDisplayed } = await import("cb/typed");
  const chain = new Chain(data);
  const solver = new Solver(chain, new Limits(chain));
  return asked.map(({ pose, shown, start }) => [solver.solve(pose, start), solveDisplayed(solver, shown, start)]);
}
"""
_DRAGS = """
async ({ chain: data, drags }) => {
  const { Chain } = await import("cb/chain");
  const { Limits } = await import("cb/limits");
  const { Solver } = await import("cb/ik");
  const chain = new Chain(data);
  const solver = new Solver(chain, new Limits(chain));
  return drags.map(({ start, poses }) => {
    let axes = start;
    return poses.map((T) => {
      const reached = solver.approach(T, axes);
      axes = reached.axes;
      return reached;
    });
  });
}
"""


@cache
def robot(name: str) -> Robot:
    return Robot.load(name)


@pytest.fixture(scope="module")
def modules(browser: Browser) -> Iterator[Page]:
    page = module_page(browser, page_modules())
    yield page
    page.close()


def states(modules: Page, one: Robot, rows: NDArray[np.float64]) -> list[dict[str, Any]]:
    """Return what the page computes at rows of axis values."""
    found: list[dict[str, Any]] = computed(
        modules, _STATES, {"chain": chain_data(one.chain, one.task), "rows": rows.tolist()}
    )
    return found


def off(a: float, b: float, column: str) -> float:
    """Return the difference of two displayed values, whole turns not counted."""
    difference = a - b
    return abs(difference - 360.0 * round(difference / 360.0)) if column.endswith("_deg") else abs(difference)


def agrees(modules: Page, one: Robot, count: int) -> None:
    """Compare what the page computes at random axis values with what Python does."""
    rows = closing_axes(one, np.random.default_rng(18), count)
    if not len(rows):  # data with which the loops close nowhere
        rows = np.array([[0.37 * axis.lower + 0.63 * axis.upper for axis in one.axes]])
        assert states(modules, one, rows)[0]["pose"] is None
        assert not np.isfinite(one.chain.axis_map.q(rows[0])).any()
        return
    found = states(modules, one, rows)
    poses = np.array([state["pose"] for state in found]).reshape(-1, 4, 4)
    np.testing.assert_allclose(poses, one.fk_batch(rows), rtol=0, atol=1e-12)
    smallest = np.array([state["measures"]["smallest"] for state in found])
    np.testing.assert_allclose(smallest, measure_batch(one, rows).smallest, rtol=1e-6, atol=1e-9)
    for state, axes in zip(found, rows, strict=True):
        assert tuple(state["violated"]) == one.violated_limits(axes)
    for state, axes in list(zip(found, rows, strict=True))[:200]:
        shown = one.display(axes)
        assert list(state["shown"]) == list(shown)
        assert max(off(state["shown"][column], value, column) for column, value in shown.items()) < 1e-8
        try:
            drives = one.drives(axes)
        except ChainbuildError:  # a direction beyond the reach of a bevel head
            assert None in state["drives"]
            continue
        np.testing.assert_allclose(np.array(state["drives"], dtype=float), drives, rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", KINDS)
def test_the_page_computes_what_python_computes(name: str, modules: Page) -> None:
    agrees(modules, robot(name), 1000 if name in {"kr6r900", "tripod_kin12"} else 150)


@pytest.mark.slow
def test_the_page_computes_what_python_computes_of_every_kinematic(modules: Page) -> None:
    failed = []
    for name, chain in cases():
        try:
            agrees(modules, Robot(chain), 60)
        except AssertionError as error:
            failed.append(f"{name}: {error}")
    assert failed == []


def test_two_steps_and_shifted_axes_are_computed_alike(modules: Page) -> None:
    agrees(modules, Robot(two_steps(206, 9)), 50)
    agrees(modules, Robot(two_steps(9, 58)), 50)
    agrees(modules, Robot(type_chain(98, True)), 50)
    cardan = ("trafo[0].id 59", "trafo[0].param[0] 1000000", "trafo[0].param[6] 450000")
    offsets = ("wz[2].ax_versatz[3] 100000", "wz[2].ax_versatz[4] -75000")
    shifted = machine("\n".join((*cardan, *offsets)), overlay=Overlay(tool={"number": 2})).chain()
    assert "Shifted" in type(shifted.axis_map).__name__
    agrees(modules, Robot(shifted), 50)


def test_every_axis_map_and_drive_map_has_a_twin(modules: Page) -> None:
    known = set(
        computed(modules, "async () => [...(await import('cb/maps')).MAPS, ...(await import('cb/drives')).DRIVES]", 0)
    )
    written = {
        node.name
        for path in PACKAGE.rglob("*.py")
        if {"dq_daxes", "differing"} & set(re.findall(r"def (\w+)", text := path.read_text("utf-8")))
        for node in ast.parse(text).body
        if isinstance(node, ast.ClassDef)
        and not any(isinstance(base, ast.Name) and base.id == "Protocol" for base in node.bases)
        and {"dq_daxes", "differing"} & {one.name for one in node.body if isinstance(one, ast.FunctionDef)}
    }
    assert written == known


@pytest.mark.parametrize("name", KINDS)
def test_limits_are_judged_alike_outside_them(name: str, modules: Page) -> None:
    one, rng = robot(name), np.random.default_rng(19)
    rows = closing_axes(one, rng, 60)
    ends = np.array([axis.range for axis in one.axes])
    beyond = rows + rng.choice((0.0, 0.0, 1.0), rows.shape) * rng.normal(size=rows.shape) * np.ptp(ends, axis=1)
    # On the limits themselves, and by as much beyond as still counts as inside, and a little more.
    rows = np.vstack([beyond, ends[:, 0], ends[:, 1], ends[:, 1] + 5e-7, ends[:, 0] - 5e-6])
    for state, axes in zip(states(modules, one, rows), rows, strict=True):
        assert tuple(state["violated"]) == one.violated_limits(axes)


def solved(modules: Page, name: str, count: int) -> tuple[int, int]:
    """Return of how many poses the page has as many solutions as Python, and of how many both were asked.

    Every solution is verified by Python: the pose, the limits, the held axes.
    """
    one, rng = robot(name), np.random.default_rng(20)
    rows = closing_axes(one, rng, count)
    starts = closing_axes(one, rng, count)
    held = [n for n, axis in enumerate(one.axes) if axis.held]
    starts[:, held] = rows[:, held]
    poses, shown = one.fk_batch(rows), [one.display(axes) for axes in rows]
    asked = [
        {"pose": T.ravel().tolist(), "shown": columns, "start": start.tolist()}
        for T, columns, start in zip(poses, shown, starts, strict=True)
    ]
    found = computed(modules, _SOLUTIONS, {"chain": chain_data(one.chain, one.task), "asked": asked})
    alike = compared = 0
    for T, start, columns, (by_pose, by_display) in zip(poses, starts, shown, found, strict=True):
        for axes in by_pose["branches"]:
            errors = one.kinematics.errors(np.array(axes) * one.kinematics.si_factors, _pose(T), one.task)
            assert max(errors[: 1 if one.task == "position" else 2]) < 1e-9
            assert one.violated_limits(axes) == ()
            np.testing.assert_array_equal(np.array(axes)[held], start[held])
        assert by_display["status"] == "ok"
        again = one.display(by_display["axes"])
        assert max(off(again[column], value, column) for column, value in columns.items()) < 1e-6
        if by_pose["family"]:
            continue
        compared += 1
        alike += len(by_pose["branches"]) == len(one.ik_all(T, start, dict(_held(one, start)) or None))
    return alike, compared


def _pose(T: NDArray[np.float64]) -> Any:
    import pinocchio as pin

    return pin.SE3(T)


def _held(one: Robot, axes: NDArray[np.float64]) -> Iterator[tuple[str, float]]:
    return ((axis.name, float(axes[n])) for n, axis in enumerate(one.axes) if axis.held)


@pytest.mark.parametrize("name", KINDS)
def test_solutions_are_those_of_python(name: str, modules: Page) -> None:
    alike, compared = solved(modules, name, 5)
    assert alike == compared


@pytest.mark.slow
@pytest.mark.parametrize("name", shipped())
def test_solutions_are_those_of_python_on_every_machine(name: str, modules: Page) -> None:
    alike, compared = solved(modules, name, 100)
    assert alike >= 0.99 * compared


@pytest.mark.parametrize("name", KINDS)
def test_a_dragged_machine_follows_within_its_limits(name: str, modules: Page) -> None:
    one, rng = robot(name), np.random.default_rng(21)
    starts = closing_axes(one, rng, 8)
    lower, upper = (np.array([axis.range[k] for axis in one.axes]) for k in (0, 1))
    held = np.array([axis.held for axis in one.axes])
    # Small steps somewhere, ten of them, held axes at rest; of some drags the last is beyond every reach.
    ways = rng.normal(size=starts.shape) * np.where(held, 0.0, 0.003 * np.minimum(upper - lower, 400.0))
    drags = []
    for start, way in zip(starts, ways, strict=True):
        rows = [np.clip(start + share * way, lower, upper) for share in np.linspace(0.1, 1.0, 10)]
        if not all(np.isfinite(one.chain.axis_map.q(row)).all() for row in rows):
            continue
        far = one.fk(start).homogeneous
        far[:3, 3] += 1000.0
        poses = [one.fk(row).homogeneous for row in rows] + [far]
        drags.append({"start": start.tolist(), "poses": [T.ravel().tolist() for T in poses]})
    assert len(drags) > 3
    found = computed(modules, _DRAGS, {"chain": chain_data(one.chain, one.task), "drags": drags})
    met = 0
    for drag, states_ in zip(drags, found, strict=True):
        for T, state in zip(drag["poses"], states_, strict=True):
            assert one.violated_limits(state["axes"]) == ()
            np.testing.assert_array_equal(np.array(state["axes"])[held], np.array(drag["start"])[held])
            if state["met"]:
                met += 1
                wanted = _pose(np.array(T).reshape(4, 4))
                errors = one.kinematics.errors(np.array(state["axes"]) * one.kinematics.si_factors, wanted, one.task)
                assert max(errors[: 1 if one.task == "position" else 2]) < 1e-9
        assert not states_[-1]["met"]
    assert met > 0.9 * 10 * len(drags)


def test_a_pose_out_of_reach_has_no_solution(modules: Page) -> None:
    one = robot("kr6r900")
    far = [1.0, 0.0, 0.0, 5.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]
    start = [0.0, -90.0, 90.0, 0.0, 20.0, 0.0]
    shown = {"x_mm": 5000.0, "y_mm": 0.0, "z_mm": 0.0, "a_deg": 0.0, "b_deg": 0.0, "c_deg": 0.0}
    asked = [{"pose": far, "shown": shown, "start": start}]
    found = computed(modules, _SOLUTIONS, {"chain": chain_data(one.chain, one.task), "asked": asked})[0]
    for one_way in found:
        assert one_way["status"] == "unreachable"
        assert one_way["branches"] == []
        assert one.violated_limits(one_way["axes"]) == ()


def test_every_number_of_a_chain_is_json() -> None:
    for name in shipped():
        text = json.dumps(chain_data(robot(name).chain), allow_nan=False)
        assert json.loads(text)["title"]
