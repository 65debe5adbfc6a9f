"""Builds any KIN_TYP from HD values in mm, degrees and bare numbers, without a file around it."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from chainbuild.chain.assemble import assemble
from chainbuild.chain.elements import Chain
from chainbuild.convention import Choices
from chainbuild.findings import Collector
from chainbuild.formats.twincat.lists.hdtable import HdRow, TypeData
from chainbuild.formats.twincat.recipes.recipe import Params
from chainbuild.formats.twincat.types.catalogue import catalogue
from chainbuild.robot import Robot

Vector = NDArray[np.float64]


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
        direction: Vector = self.robot.fk(axes).rotation[:, 2]
        return direction

    def base_mm(self, frame: str, axes: list[float] | Vector) -> Vector:
        """Place of a frame in the machine base, mm."""
        place: Vector = self.robot.frame_placements(axes)[frame].translation * 1000.0
        return place

    def base_rotation(self, frame: str, axes: list[float] | Vector) -> Vector:
        rotation: Vector = self.robot.frame_placements(axes)[frame].rotation
        return rotation

    def asked(self) -> set[str]:
        return {used.convention.name for used in self.choose.used()}

    def codes(self) -> list[str]:
        return [finding.code for finding in self.collector.findings]

    def zeros(self) -> list[float]:
        return [0.0] * len(self.robot.axes)


def count(row: HdRow, value: float) -> float:
    """Return the list's count of a value in mm, degrees or a bare number."""
    return value * 10_000.0 if row.unit else value


def build(
    kin: int,
    hd: Mapping[int | str, float] | None = None,
    length: float = 0.0,
    strict: bool = True,
    **conventions: str,
) -> Built:
    """Build a type; HD values by number or name, in mm, degrees or bare numbers."""
    kind = catalogue()[kin]
    raw = {}
    for key, value in (hd or {}).items():
        row = kind.data.row(key)
        raw[row.n] = count(row, value)
    collector = Collector(strict=strict)
    params = Params(kind.data, raw, tool_length_mm=length, collector=collector)
    choose = Choices(conventions)
    recipe = kind.recipe(params, choose)
    body = assemble(params.axes, recipe.tool, recipe.workpiece, recipe.axis_map)
    chain = Chain(
        name=f"kin{kin}",
        title=kind.title,
        dialect="TwinCAT CNC",
        kinematic=f"KIN_TYP {kin}",
        links=body.links,
        joints=body.joints,
        frames=body.frames,
        axes=params.axes,
        axis_map=body.axis_map,
        angle_mode="ypr",
        task=recipe.task,
    )
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


def random_axes(robot: Robot, n: int, seed: int = 0) -> Vector:
    """Return n axis vectors, ±500 mm and ±170 degrees."""
    rng = np.random.default_rng(seed)
    half = np.array([500.0 if axis.kind == "linear" else 170.0 for axis in robot.axes])
    values: Vector = (rng.random((n, len(half))) * 2.0 - 1.0) * half
    return values


def distance(T: pin.SE3, other: pin.SE3) -> float:
    """Return how far two poses are apart: metres and rotation matrix entries."""
    return float(np.abs(T.homogeneous - other.homogeneous).max())
