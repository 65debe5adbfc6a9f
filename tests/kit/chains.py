"""A chain from what is assembled: the test says only what matters to it."""

from __future__ import annotations

from collections.abc import Sequence

from chainbuild.chain.assemble import Element, assemble
from chainbuild.chain.axismap import AxisMap
from chainbuild.chain.elements import Axis, Chain, Task
from chainbuild.chain.programmed.display import POSE_ANGLES, Display


def chain_from(
    axes: Sequence[Axis],
    tool: Sequence[Element],
    workpiece: Sequence[Element] = (),
    axis_map: AxisMap | None = None,
    *,
    name: str = "test",
    title: str = "Test",
    dialect: str = "test",
    kinematic: str = "test",
    angle_mode: str = "orirpy",
    task: Task = "auto",
    display: Display = POSE_ANGLES,
) -> Chain:
    """Return the chain of two branches; names and angle mode where they matter."""
    body = assemble(axes, tool, workpiece, axis_map)
    parts = (body.links, body.joints, body.frames, tuple(axes), body.axis_map)
    return Chain(name, title, dialect, kinematic, *parts, angle_mode, task=task, display=display)
