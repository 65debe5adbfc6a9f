"""Robots of all sizes and kinds for the drawing tests, built by hand."""

from __future__ import annotations

from typing import Literal

import numpy as np

from chainbuild.chain.assemble import Element, linear, mark, rotary, shift, turn
from chainbuild.chain.elements import Axis
from chainbuild.robot import Robot
from chainbuild.units import unit_of
from tests.kit.chains import chain_from


def axis(name: str, lower: float, upper: float, carries: Literal["tool", "workpiece"] = "tool") -> Axis:
    """Return an axis, linear where its name begins with X, Y or Z."""
    kind = "linear" if name[0] in "XYZ" else "rotary"
    return Axis(name, kind, unit_of(kind), lower, upper, False, carries=carries)


def build(title: str, axes: list[Axis], tool: list[Element], workpiece: tuple[Element, ...] = ()) -> Robot:
    """Return a robot under its title."""
    return Robot(chain_from(axes, tool, workpiece, title=title, dialect="hand made"))


def arm(title: str = "Arm") -> Robot:
    """An articulated arm of 0.9 m."""
    upright = turn(np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]))
    tool = [
        shift(z=400.0), rotary("A1", "z", sign=-1.0), shift(x=25.0), rotary("A2", "y"), shift(x=455.0),
        rotary("A3", "y", offset_deg=10.0), shift(z=35.0), rotary("A4", "x", sign=-1.0), shift(x=420.0),
        rotary("A5", "y"), rotary("A6", "x", sign=-1.0), shift(x=80.0), upright, mark("flange"), shift(z=120.0),
    ]  # fmt: skip
    limits = {"A1": 170, "A2": 190, "A3": 156, "A4": 185, "A5": 120, "A6": 350}
    return build(title, [axis(name, -bound, bound) for name, bound in limits.items()], tool)


def scara() -> Robot:
    """A SCARA of 0.5 m."""
    tool = [
        shift(z=200.0), rotary("A1", "z"), shift(x=250.0), rotary("A2", "z"), shift(x=250.0), linear("Z3", "z"),
        shift(z=-100.0), rotary("A4", "z"), shift(z=-20.0), turn(np.diag([1.0, -1.0, -1.0])),
    ]  # fmt: skip
    axes = [axis("A1", -130, 130), axis("A2", -150, 150), axis("Z3", -150, 0), axis("A4", -1080, 1080)]
    return build("SCARA", axes, tool)


def gantry() -> Robot:
    """A gantry mill of 20 m."""
    tool = [
        linear("X", "x"), linear("Y", "y"), linear("Z", "z"), rotary("C", "z"), shift(z=-300.0), rotary("A", "x"),
        shift(z=-250.0), mark("flange"), shift(z=-120.0),
    ]  # fmt: skip
    axes = [
        axis("X", 0, 20000),
        axis("Y", -2500, 2500),
        axis("Z", -2000, 0),
        axis("C", -360, 360),
        axis("A", -110, 110),
    ]
    return build("Gantry", axes, tool, (shift(z=-3000.0),))


def table() -> Robot:
    """A mill with a trunnion table whose linear limits nobody gave."""
    tool = [linear("X", "x"), linear("Y", "y"), linear("Z", "z"), shift(z=-87.5), mark("flange"), shift(z=-100.0)]
    workpiece = (shift(-100.0, 5.0, -500.0), rotary("A", "x", sign=-1.0), shift(z=50.0), rotary("C", "z"))
    axes = [Axis.unlimited(name, "linear") for name in "XYZ"]
    axes += [axis("A", -120, 30, "workpiece"), Axis.unlimited("C", "rotary", "workpiece")]
    return build("Table", axes, tool, workpiece)


ROBOTS = {"arm": arm, "scara": scara, "gantry": gantry, "table": table}
