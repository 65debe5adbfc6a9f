"""Builds any KIN_TYP from HD values in mm, degrees and bare numbers, without a file around it."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from chainbuild.convention import Choices
from chainbuild.findings import Collector
from chainbuild.formats.twincat.lists.hdtable import HdRow, TypeData
from chainbuild.formats.twincat.recipes.recipe import Params
from chainbuild.formats.twincat.types.catalogue import catalogue
from chainbuild.formats.twincat.types.displays import display_of
from chainbuild.robot import Robot
from tests.kit.chains import chain_from

Vector = NDArray[np.float64]
# The types that move a tool head.
HEADS = (2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 16, 17, 18, 22, 25, 28, 30, 33, 59, 60, 70, 76, 207)


@dataclass(frozen=True)
class Built:
    """A robot with what its recipe asked and remarked."""

    robot: Robot
    choose: Choices
    collector: Collector

    def mm(self, axes: list[float] | Vector) -> Vector:
        """Place of the tool in the workpiece frame, mm."""
        place: Vector = self.robot.fk(axes).translation * 1000.0
        return place

    def tool_vector(self, axes: list[float] | Vector) -> Vector:
        """Direction of the tool in the workpiece frame."""
        direction: Vector = self.robot.fk(axes).rotation[:, 2]
        return direction

    def base_mm(self, frame: str, axes: list[float] | Vector) -> Vector:
        """Place of a frame in the machine base, mm."""
        place: Vector = self.robot.frame_placements(axes)[frame].translation * 1000.0
        return place

    def base_rotation(self, frame: str, axes: list[float] | Vector) -> Vector:
        """Rotation of a frame in the machine base."""
        rotation: Vector = self.robot.frame_placements(axes)[frame].rotation
        return rotation

    def asked(self) -> set[str]:
        """Names of the conventions that the recipe asked for."""
        return {used.convention.name for used in self.choose.used()}

    def codes(self) -> list[str]:
        """Numbers of the findings."""
        return [finding.code for finding in self.collector.findings]

    def zeros(self) -> list[float]:
        """All axes at 0."""
        return [0.0] * len(self.robot.axes)


def count(row: HdRow, value: float) -> float:
    """Return the list's count of a value in mm, degrees or a bare number."""
    return value * 10_000.0 if row.unit else value


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
    chain = chain_from(
        recipe.axes or params.axes, recipe.tool, recipe.workpiece, recipe.axis_map,
        name=f"kin{kin}", title=kind.title, dialect="TwinCAT CNC", kinematic=f"KIN_TYP {kin}", angle_mode="ypr",
        task=recipe.task, display=display_of(params, recipe.axes or params.axes, "ypr", choose),
    )  # fmt: skip
    return Built(Robot(chain), choose, collector)


def generic_hd(data: TypeData) -> dict[int | str, float]:
    """Return values for every HD, none of them 0 where it is a length or an angle; repeatable."""
    rng = np.random.default_rng(zlib.crc32(data.title.encode()))
    values: dict[int | str, float] = {}
    for row in data.hd:
        if row.kind == "length":
            values[row.n] = float(rng.uniform(40.0, 300.0) * rng.choice([-1, 1]))
        elif row.kind == "angle":
            values[row.n] = float(rng.uniform(5.0, 25.0) * rng.choice([-1, 1]))
        elif row.kind == "sign":
            values[row.n] = 1.0
    if data.number == 205:
        values[17] = 1.0
    return values


def head_hd(kin: int) -> dict[int | str, float]:
    """Return a head's value for every HD: lengths and angles different and none 0, every direction reversed."""
    values: dict[int | str, float] = {}
    for row in catalogue()[kin].data.hd:
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


def axes_anywhere(robot: Robot, n: int, seed: int = 0) -> Vector:
    """Return n axis vectors, ±500 mm and ±170 degrees, whatever the limits."""
    rng = np.random.default_rng(seed)
    half = np.array([500.0 if axis.kind == "linear" else 170.0 for axis in robot.axes])
    values: Vector = (rng.random((n, len(half))) * 2.0 - 1.0) * half
    return values


def axes_inside(robot: Robot, n: int, seed: int = 0) -> Vector:
    """Return n axis vectors inside ±500 mm, ±170 degrees and nine tenths of the limits."""
    rng = np.random.default_rng(seed)
    axes = robot.axes
    middle = np.array([(axis.lower + axis.upper) / 2.0 for axis in axes])
    half = np.array(
        [min(500.0 if a.kind == "linear" else 170.0, 0.45 * (a.upper - a.lower)) for a in axes],
    )
    values: Vector = middle + (rng.random((n, len(axes))) * 2.0 - 1.0) * half
    return values


def distance(T: pin.SE3, other: pin.SE3) -> float:
    """Return how far two poses are apart: metres and rotation matrix entries."""
    return float(np.abs(T.homogeneous - other.homogeneous).max())
