"""Specification and grid of a map."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Final, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from chainbuild.analysis.singularity.measures import measure_batch
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import random_axis_values
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.names import axis_index
from chainbuild.errors import ChainbuildError
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.shown import fields_shown

MapKind = Literal["axes", "rz", "xz", "xy", "yz", "volume"]

KINDS: Final[tuple[MapKind, ...]] = get_args(MapKind)
MAX_CELLS: Final = 50_000_000  # cells: 800 MB at 16 bytes each
_PROBES: Final = 8192  # positions that the box of the map is found by
_MARGIN: Final = 0.03  # share of the box added on each side: probes do not touch its walls
_PLANES: Final = {"xz": (0, 2, 1), "xy": (0, 1, 2), "yz": (1, 2, 0)}


@dataclass(frozen=True, slots=True)
class MapSpec:
    """What a map shows.

    Attributes:
        kind: "axes": over two axes, the others fixed; "rz": tool positions by distance from the workpiece
            frame's z axis and by height; "xz", "xy", "yz": a slab through the origin of the workpiece frame, one cell
            thick; "volume": all of space.
        axes: The two axes of kind "axes": across, then up.
        at: Values of all axes for kind "axes", mm and degrees; empty: the middle of the limits.
        cells: Cells along each side.
        samples: Number of positions, drawn uniformly from the axis limits; kind "axes" takes one per cell.
        seed: Seed of the positions.
        collisions: Leave out positions at which the robot collides with itself.
    """

    __repr__ = fields_shown

    kind: MapKind = "rz"
    axes: tuple[str, ...] = ()
    at: tuple[float, ...] = ()
    cells: int = 200
    samples: int = 1_000_000
    seed: int = 0
    collisions: bool = False

    def data(self) -> dict[str, Any]:
        """Return the values for JSON."""
        return asdict(self)


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """The cells of a map.

    Attributes:
        labels: Name and unit of each direction.
        edges: Cell borders along each direction, rising; m, or mm and degrees of axes.
        shape: Cells along each direction.
    """

    __repr__ = fields_shown

    labels: tuple[str, ...]
    edges: tuple[Vector, ...]

    @property
    def shape(self) -> tuple[int, ...]:
        """Cells along each direction."""
        return tuple(len(edge) - 1 for edge in self.edges)

    def cells_of(self, points: Matrix) -> NDArray[np.int64]:
        """Return the flat index of the cell of each point (n, dimensions), -1 outside."""
        flat = np.zeros(len(points), dtype=np.int64)
        inside = np.ones(len(points), dtype=bool)
        for n, edge in enumerate(self.edges):
            count = len(edge) - 1
            share = (points[:, n] - edge[0]) / (edge[-1] - edge[0])
            # Not a number, where there is no pose, is outside.
            place = np.floor(np.where(np.isfinite(share), share, -1.0) * count).astype(np.int64)
            inside &= (place >= 0) & (place < count)
            flat = flat * count + place
        flat[~inside] = -1
        return flat


def check_spec(robot: Mechanism, spec: MapSpec) -> None:
    """Refuse a map that cannot be drawn.

    Raises:
        ChainbuildError: unknown kind or axis, wrong counts, or more cells than memory should hold.
    """
    names = tuple(axis.name for axis in robot.axes)
    if spec.kind not in KINDS:
        raise ChainbuildError(f"unknown map '{spec.kind}'", permitted=", ".join(KINDS))
    if spec.kind == "axes":
        chosen = {axis_index(robot.axes, name) for name in spec.axes}
        if len(spec.axes) != 2 or len(chosen) != 2 or None in chosen:
            raise ChainbuildError(
                "expected two different axes for this map", parameter="axes", permitted=", ".join(names)
            )
        if spec.at and len(spec.at) != len(names):
            raise ChainbuildError("expected one value for each axis", parameter="at", permitted=", ".join(names))
    dimensions = 3 if spec.kind == "volume" else 2
    if spec.cells < 2 or spec.cells**dimensions > MAX_CELLS:
        most = int(MAX_CELLS ** (1.0 / dimensions))
        raise ChainbuildError(f"{spec.cells} cells per side", parameter="cells", permitted=f"2 … {most}")
    if spec.samples < 1:
        raise ChainbuildError("the map has no samples", parameter="samples", permitted="at least 1")


def grid_of(robot: Mechanism, spec: MapSpec) -> Grid:
    """Return the grid of a map: the limits of two axes, or the box that the tool stays in."""
    if spec.kind == "axes":
        lower, upper = shown_limits(robot.chain)
        chosen = mapped_axes(robot, spec)
        labels = tuple(f"{robot.axes[n].name} [{robot.axes[n].unit}]" for n in chosen)
        return Grid(labels, tuple(np.linspace(lower[n], upper[n], spec.cells + 1) for n in chosen))
    probes = random_axes(robot, np.random.default_rng(spec.seed), _PROBES)
    positions = measure_batch(robot, probes).positions
    positions = positions[np.isfinite(positions).all(axis=1)]
    if not len(positions):
        raise ChainbuildError("no position within the limits has a pose")
    points = directions(spec.kind, positions)
    low, high = points.min(axis=0), points.max(axis=0)
    margin = _MARGIN * max(float((high - low).max()), 1e-3)
    low, high = low - margin, high + margin
    if spec.kind == "rz":
        low[0] = max(low[0], 0.0)
    names = ["x", "y", "z"] if spec.kind == "volume" else list(spec.kind)
    edges = tuple(np.linspace(a, b, spec.cells + 1) for a, b in zip(low, high, strict=True))
    return Grid(tuple(f"{name} [m]" for name in names), edges)


def mapped_axes(robot: Mechanism, spec: MapSpec) -> list[int]:
    """Return the indices of the two axes of a map of kind "axes": across, then up."""
    return [n for name in spec.axes if (n := axis_index(robot.axes, name)) is not None]


def random_axes(robot: Mechanism, rng: np.random.Generator, count: int) -> Matrix:
    """Return axis values (count, n_axes) drawn uniformly from the limits; input axes are at 0 or the nearest limit."""
    lower, upper = shown_limits(robot.chain)
    values = random_axis_values(robot.chain.axis_map, rng, lower, upper, count)
    for n, axis in enumerate(robot.axes):
        if axis.held:
            values[:, n] = min(max(0.0, lower[n]), upper[n])
    return values


def directions(kind: MapKind, positions: Matrix) -> Matrix:
    """Return the coordinates of positions (n, 3) [m] that a map of tool positions spans."""
    if kind == "volume":
        return positions
    if kind == "rz":
        return np.column_stack([np.hypot(positions[:, 0], positions[:, 1]), positions[:, 2]])
    first, second, _ = _PLANES[kind]
    return positions[:, [first, second]]


def in_slab(kind: MapKind, positions: Matrix, thickness: float) -> NDArray[np.bool_]:
    """Return which positions (n, 3) lie in the slab of a section."""
    if kind not in _PLANES:
        return np.ones(len(positions), dtype=bool)
    across = positions[:, _PLANES[kind][2]]
    return np.asarray(np.abs(across) <= thickness / 2.0, dtype=bool)
