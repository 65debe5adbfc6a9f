"""Robots assembled by hand for the solvers: an arm, a machine with a table, and any other from its elements."""

from __future__ import annotations

from chainbuild.chain.assemble import Element, linear, mark, rotary, shift
from chainbuild.chain.elements import Axis, Chain
from chainbuild.robot import Robot
from tests.kit.chains import chain_from

LIMITS = {
    "A1": (-170, 170), "A2": (-190, 45), "A3": (-120, 156), "A4": (-185, 185), "A5": (-120, 120), "A6": (-350, 350),
}  # fmt: skip


def make_chain(tool: list[Element], workpiece: list[Element], names: str, held: tuple[str, ...] = ()) -> Chain:
    """Return a chain of the named axes, linear where the name begins with X, Y or Z."""
    axes = []
    for name in names.split():
        kind = "linear" if name[0] in "XYZ" else "rotary"
        bound = 500.0 if kind == "linear" else 180.0
        lower, upper = LIMITS.get(name, (-bound, bound))
        axes.append(Axis(name, kind, "mm" if kind == "linear" else "deg", lower, upper, False, held=name in held))
    return chain_from(axes, tool, workpiece)


def robot_from(tool: list[Element], workpiece: list[Element] | None = None) -> Robot:
    """Return a robot whose axes are its joints, in their order."""
    moves = [e.name for e in [*tool, *(workpiece or [])] if hasattr(e, "name")]
    return Robot(make_chain(tool, workpiece or [], " ".join(moves)))


def arm_elements() -> list[Element]:
    """Return what the arm is assembled of."""
    return [
        shift(z=400.0), rotary("A1", "z", sign=-1.0), shift(x=25.0), rotary("A2", "y"), shift(x=455.0),
        rotary("A3", "y"), shift(z=35.0), rotary("A4", "x", sign=-1.0), shift(x=420.0), rotary("A5", "y"),
        rotary("A6", "x", sign=-1.0), shift(x=80.0), mark("flange"), shift(x=10.0, y=20.0, z=30.0),
    ]  # fmt: skip


def arm() -> Robot:
    """Return an articulated arm with a spherical wrist and a tool that stands askew."""
    return Robot(make_chain(arm_elements(), [], "A1 A2 A3 A4 A5 A6"))


def table_machine() -> Robot:
    """Return a machine of three linear axes with a rotary/swivel table."""
    tool: list[Element] = [linear("X", "x"), linear("Y", "y"), linear("Z", "z"), shift(z=-87.5), mark("flange")]
    workpiece: list[Element] = [
        shift(-100.0, 5.0, -30.0),
        rotary("A", "x", sign=-1.0, offset_deg=12.0),
        shift(z=50.0),
        rotary("C", "z"),
    ]
    return Robot(make_chain(tool, workpiece, "X Y Z A C"))


def ur5() -> Robot:
    """Return a UR5: its wrist is not spherical."""
    return robot_from([
        shift(z=89.159), rotary("A1", "z"), shift(y=135.85), rotary("A2", "y"), shift(y=-119.7, z=425.0),
        rotary("A3", "y"), shift(z=392.25), rotary("A4", "y"), shift(y=93.0), rotary("A5", "z"), shift(z=94.65),
        rotary("A6", "y"), shift(y=82.3),
    ])  # fmt: skip
