"""Builds the tool-head types from HD values in mm, degrees and bare numbers, without a file around them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from chainbuild.chain.assemble import assemble
from chainbuild.chain.elements import Chain
from chainbuild.convention import Choices
from chainbuild.findings import Collector
from chainbuild.formats.twincat.lists.hdtable import type_data
from chainbuild.formats.twincat.recipes.recipe import Params
from chainbuild.formats.twincat.types.catalogue import catalogue
from chainbuild.robot import Robot
from tests.twincat.table_kit import Built, Vector, count

HEADS = (2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 22, 25, 28, 30, 33, 59, 60, 70, 76, 207)


def build(
    kin: int,
    hd: Mapping[int | str, float] | None = None,
    length: float = 0.0,
    radius: float = 0.0,
    strict: bool = True,
    **conventions: str,
) -> Built:
    """Build a type; HD values by number or name, in mm, degrees or bare numbers."""
    kind = catalogue()[kin]
    rows = {kind.data.row(key).n: count(kind.data.row(key), value) for key, value in (hd or {}).items()}
    collector = Collector(strict=strict)
    params = Params(kind.data, rows, tool_length_mm=length, tool_radius_mm=radius, collector=collector)
    choose = Choices(conventions)
    recipe = kind.recipe(params, choose)
    axes = recipe.axes or params.axes
    body = assemble(axes, recipe.tool, recipe.workpiece, recipe.axis_map)
    chain = Chain(
        name=f"kin{kin}",
        title=kind.title,
        dialect="TwinCAT CNC",
        kinematic=f"KIN_TYP {kin}",
        links=body.links,
        joints=body.joints,
        frames=body.frames,
        axes=axes,
        axis_map=body.axis_map,
        angle_mode="ypr",
        task=recipe.task,
    )
    return Built(Robot(chain), choose, collector)


def generic_hd(kin: int) -> dict[int | str, float]:
    """Return a value for every HD, all lengths and angles different and none 0, every direction reversed."""
    values: dict[int | str, float] = {}
    for row in type_data()[kin].hd:
        if row.kind == "length":
            values[row.n] = 37.0 + 13.0 * row.n
        elif row.kind == "angle":
            values[row.n] = 11.0 + 1.7 * row.n
        elif row.kind == "sign":
            values[row.n] = -1.0
        elif row.kind == "ratio":
            values[row.n] = 1.0 + 0.3 * row.n
    if kin in (59, 60):
        values[7] = 48.0
    if kin == 207:
        values[4] = 65.0
    return values


def random_axes(built: Built, n: int, seed: int = 0) -> Vector:
    """Return n axis vectors inside ±500 mm, ±170 degrees and nine tenths of the limits."""
    rng = np.random.default_rng(seed)
    axes = built.robot.axes
    middle = np.array([(axis.lower + axis.upper) / 2.0 for axis in axes])
    half = np.array(
        [min(500.0 if a.kind == "linear" else 170.0, 0.45 * (a.upper - a.lower)) for a in axes],
    )
    values: Vector = middle + (rng.random((n, len(axes))) * 2.0 - 1.0) * half
    return values
