"""A chain as data for the page's own mathematics: links, joints, axis map, limits, display, all as JSON.

Axis maps and drive maps are frozen dataclasses whose fields are their whole data. They are written as they are, with
the name of their class, and the page has a class of the same name for each.
"""

from __future__ import annotations

import math
from dataclasses import fields, is_dataclass
from functools import singledispatch
from typing import Any

import numpy as np
from numpy.typing import NDArray

from chainbuild.analysis.singularity.measures import characteristic_length
from chainbuild.chain.elements import Axis, Chain, Task
from chainbuild.frames import ANGLE_MODES
from chainbuild.ik.region import periodic_axes
from chainbuild.kinematics.limits import Limits
from chainbuild.kinematics.screws import joints_between_tips


@singledispatch
def as_json(value: Any) -> Any:
    """Return a value as what JSON can hold: arrays as nested lists, complex numbers as pairs, no end as null.

    A dataclass becomes an object of its fields with the name of its class under "class".

    Raises:
        TypeError: there is no form for it.
    """
    if is_dataclass(value) and not isinstance(value, type):
        own = {one.name: as_json(getattr(value, one.name)) for one in fields(value)}
        return {"class": type(value).__name__, **own}
    if value is None or isinstance(value, str | bool | int):
        return value
    raise TypeError(f"{type(value).__name__} has no form in JSON")


@as_json.register
def _(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


@as_json.register
def _(value: complex) -> list[float]:
    return [value.real, value.imag]


@as_json.register
def _(value: slice) -> list[int]:
    return [value.start, value.stop]


@as_json.register(np.ndarray)
def _(value: NDArray[Any]) -> Any:
    return as_json(value.tolist())


@as_json.register(tuple)
@as_json.register(list)
def _(value: Any) -> list[Any]:
    return [as_json(one) for one in value]


@as_json.register
def _(value: Chain) -> dict[str, Any]:
    return chain_data(value)


def chain_data(chain: Chain, task: Task | None = None) -> dict[str, Any]:
    """Return what the page computes with: lengths in metres, angles of joints in radians, limits in mm and degrees.

    Args:
        chain: The chain.
        task: What inverse kinematics solves for; None: what the chain says.
    """
    link_index = {link.name: n for n, link in enumerate(chain.links)}
    limits = Limits.of(chain)
    return {
        "title": chain.title,
        "kinematic": chain.kinematic,
        "axes": [_axis(axis) for axis in chain.axes],
        "links": [link.name for link in chain.links],
        "joints": [
            {
                "name": joint.name,
                "kind": joint.kind,
                "parent": link_index[joint.parent],
                "child": link_index[joint.child],
                "T": joint.T_parent_joint.ravel().tolist(),
                "direction": joint.direction.tolist(),
            }
            for joint in chain.joints
        ],
        "frames": {
            frame.name: {"link": link_index[frame.link], "T": frame.T_link_frame.ravel().tolist()}
            for frame in chain.frames
        },
        "map": as_json(chain.axis_map),
        "drives": as_json(chain.drives),
        "driveLimits": [
            {"axis": one.axis, "name": limits.drive_name(one), "lower": as_json(one.lower), "upper": as_json(one.upper)}
            for one in limits.drives
        ],
        "differing": [] if chain.drives is None else list(chain.drives.differing),
        "sums": [
            {
                "name": one.name,
                "label": one.label,
                "coefficients": list(one.sum.coefficients),
                "offset": one.sum.offset,
                "lower": as_json(one.lower),
                "upper": as_json(one.upper),
            }
            for one in chain.constraints
        ],
        "display": {
            name: as_json(getattr(chain.display, name))
            for name in ("kind", "columns", "axes", "solved", "letters", "along", "zero_deg", "plane_xz")
        },
        "displayColumns": list(chain.display_columns),
        "factors": [list(factor) for factor in ANGLE_MODES[chain.angle_mode].factors],
        "absoluteC": None
        if chain.absolute_c is None
        else {"coefficients": list(chain.absolute_c.coefficients), "offset": chain.absolute_c.offset},
        "task": task or chain.task,
        "toolColumn": chain.tool_column,
        "length": characteristic_length(chain),
        "periodic": np.flatnonzero(periodic_axes(chain)).tolist(),
        "between": sorted(joints_between_tips(chain)),
        "loops": bool(chain.loops),
        "followsC": chain.follows_c,
        "solvesLinear": chain.solves_linear_axes,
        "hasStatus": chain.has_status,
    }


def _axis(axis: Axis) -> dict[str, Any]:
    lower, upper = (None, None) if axis.endless else axis.range
    return {
        "name": axis.name,
        "generic": axis.generic,
        "kind": axis.kind,
        "unit": axis.unit,
        "lower": lower,
        "upper": upper,
        "assumed": axis.assumed,
        "endless": axis.endless,
        "held": axis.held,
        "carries": axis.carries,
    }
