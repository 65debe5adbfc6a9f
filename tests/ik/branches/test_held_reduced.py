"""Branches with axes held are those of the chain built without them: the joint is a constant transform there."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from chainbuild.chain.assemble import Element, Fixed, Move, linear, mark, rotary, shift
from chainbuild.robot import Robot
from tests.kit.compare import same_turns
from tests.kit.draws import random_axes
from tests.kit.robots import arm_elements, make_chain

ARM = arm_elements()
GANTRY = [linear("X1", "x"), linear("Y1", "y"), linear("Z1", "-z")]
SCARA: list[Element] = [
    rotary("A1", "z"), shift(x=300.0), rotary("A2", "z"), shift(x=250.0), linear("Z3", "-z"), rotary("A4", "-z"),
    mark("flange"), shift(x=40.0, z=-60.0),
]  # fmt: skip
TABLE: list[Element] = [
    shift(900.0, 100.0, 300.0),
    rotary("D1", "y", offset_deg=15.0),
    shift(z=80.0),
    rotary("D2", "z"),
]
# Elements to the tool and to the workpiece, and the axes that are held.
MACHINES: dict[str, tuple[list[Element], list[Element], tuple[str, ...]]] = {
    "linear unit": ([linear("X1", "y", sign=-1.0, offset_mm=50.0), *ARM], [], ("X1",)),
    "slanted unit": ([linear("X1", (1.0, 0.2, 0.1)), shift(y=100.0), *ARM], [], ("X1",)),
    "rotating column": ([rotary("D1", "z", offset_deg=-20.0), shift(x=500.0), *ARM], [], ("D1",)),
    "tilting table": (ARM, TABLE, ("D1", "D2")),
    "unit and table": ([linear("X1", "y"), *ARM], TABLE, ("X1", "D1", "D2")),
    "gantry": ([*GANTRY, *ARM], [], ("X1", "Y1", "Z1")),
    "gantry, the arm's column still": ([*GANTRY, *ARM], [], ("A1", "X1", "Z1")),
    "scara on a unit": ([linear("X1", "x"), *SCARA], [], ("X1",)),
    "scara over a table": (SCARA, [shift(x=300.0), rotary("D1", "z")], ("D1",)),
}


def reduced(elements: Sequence[Element], held: Mapping[str, float]) -> list[Element]:
    """Return elements in which held joints are constant transforms."""
    return [still(one, held[one.name]) if isinstance(one, Move) and one.name in held else one for one in elements]


def still(move: Move, value: float) -> Fixed:
    """Return the transform (mm) of a joint whose axis has a value, mm or degrees."""
    drawn, T = move.drive[move.name] * value + move.offset, np.eye(4)
    if move.kind == "revolute":
        T[:3, :3] = Rotation.from_rotvec(np.radians(drawn) * np.array(move.direction)).as_matrix()
    else:
        T[:3, 3] = drawn * np.array(move.direction)
    return Fixed(T)


def built(tool: Sequence[Element], workpiece: Sequence[Element], task: str) -> Robot:
    names = [one.name for one in [*tool, *workpiece] if isinstance(one, Move)]
    return Robot(replace(make_chain(list(tool), list(workpiece), " ".join(names)), task=task))


def compare(tool: Sequence[Element], workpiece: Sequence[Element], held: Sequence[str], seed: int, count: int) -> int:
    """Compare branches with axes held to those of the reduced chain; return how many there are."""
    rng, compared = np.random.default_rng(seed), 0
    whole = built(tool, workpiece, "pose")
    kept = np.array([axis.name not in held for axis in whole.axes])
    for _ in range(count):
        axes, start = random_axes(whole, rng), random_axes(whole, rng)
        values = {axis.name: float(axes[n]) for n, axis in enumerate(whole.axes) if axis.name in held}
        alone = built(reduced(tool, values), reduced(workpiece, values), "pose")
        target = whole.fk(axes)
        np.testing.assert_allclose(alone.fk(axes[kept]).homogeneous, target.homogeneous, atol=1e-12)
        found, wanted = whole.ik_all(target, start, held=values), alone.ik_all(target, start[kept])
        assert whole.plan(values).name == alone.plan().name
        assert len(found) == len(wanted) > 0
        np.testing.assert_allclose(found.axes[:, ~kept], np.broadcast_to(axes[~kept], (len(found), sum(~kept))))
        for row in wanted.axes:
            assert any(same_turns(alone, one, row, 1e-5) for one in found.axes[:, kept])
        assert any(same_turns(alone, one, axes[kept], 1e-4) for one in found.axes[:, kept])
        compared += len(found)
    return compared


@pytest.mark.parametrize("name", MACHINES)
def test_additional_axes_held(name: str) -> None:
    tool, workpiece, held = MACHINES[name]
    assert compare(tool, workpiece, held, 5, 4) >= 4


@pytest.mark.parametrize("name", ["A1", "A2", "A3", "A4", "A5", "A6"])
def test_one_of_six_axes_held_at_a_pose_that_allows_it(name: str) -> None:
    assert compare(ARM, [], [name], 6, 4) >= 4


@pytest.mark.slow
@pytest.mark.parametrize("name", MACHINES)
def test_additional_axes_held_at_many_poses(name: str) -> None:
    tool, workpiece, held = MACHINES[name]
    compare(tool, workpiece, held, 7, 80)
