"""Chains written down by hand for the tests of what is written from a chain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from chainbuild.chain import assemble as recipe
from chainbuild.chain.axismap import AxisMap
from chainbuild.chain.elements import Axis, Chain, Task
from chainbuild.frames import f_frame, rot_x, rot_y, rot_z
from tests.kit.chains import chain_from


def chain_of(
    name: str,
    axes: Sequence[Axis],
    tool: Sequence[recipe.Element],
    workpiece: Sequence[recipe.Element] = (),
    axis_map: AxisMap | None = None,
    task: Task = "auto",
) -> Chain:
    """Return a chain with the given branches."""
    title, dialect, kinematic = f"Test machine {name}", "TwinCAT CNC", "KIN_TYP 0"
    return chain_from(
        axes, tool, workpiece, axis_map,
        name=name, title=title, dialect=dialect, kinematic=kinematic, angle_mode="cba", task=task,
    )  # fmt: skip


def rotary_axis(name: str, lower: float = -170.0, upper: float = 170.0, speed: float | None = None) -> Axis:
    """Return a rotary axis with given limits."""
    return Axis(name, "rotary", "deg", lower, upper, False, max_speed=speed)


def arm(skew_deg: float = 0.0) -> Chain:
    """Return a six-axis arm with offsets, reversed axes, and joint frames turned by an odd angle where asked."""
    axes = [rotary_axis(name, speed=200.0) for name in ("Z1", "B1", "B2", "A1", "A2", "C9")]
    odd = recipe.turn(rot_z(skew_deg) @ rot_y(skew_deg / 3.0) @ rot_x(-skew_deg / 7.0))
    tool = [
        odd,
        recipe.rotary("Z1", "z", sign=-1.0),
        recipe.shift(0.16, 0.03, 0.445),
        recipe.shift(25.0, 0.0, 400.0),
        odd,
        recipe.rotary("B1", "y", offset_deg=-90.0),
        recipe.shift(z=615.0),
        recipe.rotary("B2", "y", offset_deg=12.5),
        recipe.shift(x=-25.0),
        recipe.turn(rot_y(90.0)),
        recipe.rotary("A1", "z", sign=-1.0),
        recipe.shift(z=640.0),
        recipe.rotary("A2", (0.0, 1.0, 0.0)),
        recipe.shift(z=90.0),
        recipe.rotary("C9", "z"),
        recipe.mark("flange"),
        recipe.Fixed(f_frame((10.0, 20.0, 150.0), (15.0, skew_deg, -30.0))),
    ]
    return chain_of("arm", axes, tool, [recipe.shift(500.0, 100.0, 50.0)])


def table_machine() -> Chain:
    """Return a five-axis machine whose two branches hang on the base, named so that readers reorder them."""
    axes = [
        Axis("Y", "linear", "mm", -400.0, 400.0, False, max_speed=500.0),
        Axis("X", "linear", "mm", -300.0, 300.0, False),
        Axis("Z", "linear", "mm", -500.0, 100.0, False),
        rotary_axis("B", -110.0, 110.0),
        replace(Axis.unlimited("A", "rotary", "workpiece"), endless=True),
    ]
    tool = [
        recipe.linear("Y", "y"),
        recipe.linear("X", "x"),
        recipe.linear("Z", "z", sign=-1.0, offset_mm=3.0),
        recipe.turn(rot_x(180.0)),
        recipe.mark("flange"),
        recipe.shift(z=120.0),
    ]
    workpiece = [
        recipe.shift(z=-350.0),
        recipe.rotary("B", (0.0, 1.0, 1.0)),
        recipe.rotary("A", "z"),
        recipe.shift(z=25.0),
    ]
    return chain_of("table", axes, tool, workpiece)
