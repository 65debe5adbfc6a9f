"""A section through the workspace for the page: how well the tool can be moved where."""

from __future__ import annotations

import base64
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final, get_args

import numpy as np

from chainbuild.analysis.workspace.maps import make_map
from chainbuild.analysis.workspace.mapspec import MapKind, MapSpec
from chainbuild.errors import ChainbuildError

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Mechanism

# A slab holds few of the positions drawn from the limits: it takes more of them and larger cells than a turned section.
_SIZES: Final[dict[str, tuple[int, int]]] = {
    "rz": (120, 120_000),
    "xz": (60, 400_000),
    "xy": (60, 400_000),
    "yz": (60, 400_000),
}
SECTIONS: Final = tuple(_SIZES)
_CLOSING: Final = 0.05  # share of the positions where loops are closed at each: some seconds, too


class _Unwanted(Exception):
    """Nobody waits for the section any more."""


def section(robot: Mechanism, kind: str, wanted: Callable[[], bool] = lambda: True) -> dict[str, Any] | None:
    """Return a map of the workspace as the page draws it; None when it is no longer wanted.

    Args:
        robot: The robot.
        kind: "rz": turned about the workpiece frame's z axis; "xz", "xy", "yz": a slab through its origin.
        wanted: Asked several times a second; False: give up.

    Returns:
        "kind"; "low", "high": the ends across and up [m]; "cells" across and up; "values": the largest of the smallest
        scaled singular values of each cell, row by row from the lowest, as base64 of 32-bit floats, NaN where the tool
        was not seen; "positions": how many positions were drawn.

    Raises:
        ChainbuildError: there is no such section, or no position within the limits has a pose.
    """
    if kind not in _SIZES or kind not in get_args(MapKind):
        raise ChainbuildError(f"unknown section '{kind}'", permitted=", ".join(_SIZES))

    def heed(_done: int, _total: int) -> None:
        if not wanted():
            raise _Unwanted

    cells, samples = _SIZES[kind]
    if robot.chain.loops:
        samples = int(_CLOSING * samples)
    spec = MapSpec(kind, cells=cells, samples=samples)  # type: ignore[arg-type]
    try:
        found = make_map(robot, spec, workers=1, progress=heed)
    except _Unwanted:
        return None
    values = np.where(found.count > 0, found.smallest, np.nan).T  # across the first, up the second
    return {
        "kind": kind,
        "low": [float(edge[0]) for edge in found.grid.edges],
        "high": [float(edge[-1]) for edge in found.grid.edges],
        "cells": list(found.grid.shape),
        "values": base64.b64encode(np.ascontiguousarray(values, dtype="<f4").tobytes()).decode("ascii"),
        "positions": samples,
    }
