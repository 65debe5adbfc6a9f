"""`chainbuild workspace`: maps of the workspace and of singularities."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from chainbuild.cli.axisvalues import At, values_of
from chainbuild.cli.show import STDOUT, console, empty_table, note, print_json
from chainbuild.cli.usage import DEFAULT_OPTIONS, Json, MachineOptions, Output, UsageError, Whole
from chainbuild.progress import bars_shown

if TYPE_CHECKING:
    from chainbuild.analysis.workspace.maps import Map
    from chainbuild.analysis.workspace.mapspec import MapSpec
    from chainbuild.robot import Robot

MapPlane = Literal["rz", "xz", "xy", "yz", "volume"]


@Parameter(name="*", group="Map")
@dataclass(frozen=True, slots=True)
class MapOptions:
    """What the map shows.

    Attributes:
        section: rz: distance from the z axis and height; xz, xy, yz: a slab through the origin; volume: all of space.
        over: Axis shown across or up; give it twice for a map over two axes instead of a section.
        at: Values of all axes for a map over two axes, separated by commas; those of --over do not count.
        cells: Number of cells along each side.
        samples: Number of positions, drawn uniformly from the axis limits.
        seed: Seed of the positions.
        collisions: Leave out positions at which the robot collides with itself.
        workers: Number of processes. Default: one per core.
    """

    section: MapPlane = "rz"
    over: Annotated[tuple[str, ...], Parameter(negative="", show_default=False)] = ()
    at: At = ()
    cells: Whole = 200
    samples: Whole = 1_000_000
    seed: Whole = 0
    collisions: Annotated[bool, Parameter(negative="")] = False
    workers: Whole | None = None

    def spec(self, robot: Robot) -> MapSpec:
        """Return the specification of the map."""
        from chainbuild.analysis.workspace.mapspec import MapSpec

        if self.at and not self.over:
            raise UsageError("--at requires --over")
        at = tuple(values_of(robot, self.at[-1]).tolist()) if self.at else ()
        kind = "axes" if self.over else self.section
        return MapSpec(kind, self.over, at, self.cells, self.samples, self.seed, self.collisions)


DEFAULT_MAP = MapOptions()


def workspace(
    file: str,
    /,
    *,
    output_file: Output = None,
    picture: Path | None = None,
    json: Json = False,
    chart: MapOptions = DEFAULT_MAP,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Map where the tool reaches and how close it is to singularities there.

    Each cell holds the largest value of the smallest scaled singular value found in it. A run that was stopped resumes
    when it is started again with the same output.

    Example: `chainbuild workspace kr6r900 --samples 100000 --picture map.svg`

    Args:
        file: A machine file, or the name of a shipped machine.
        output_file: NPZ file to write the map to.
        picture: SVG file to write.
        json: Print JSON.
        chart: What the map shows.
        options: Which kinematic.
    """
    from chainbuild.analysis.workspace.maps import make_map

    if output_file == STDOUT:
        raise UsageError("--output -: the map is no text: expected NAME.npz")
    robot = options.robot(file)
    spec = chart.spec(robot)
    if chart.workers is not None and chart.workers < 1:
        raise UsageError(f"--workers {chart.workers}: expected at least 1")
    found = make_map(robot, spec, output_file, workers=chart.workers, progress=bars_shown())
    if output_file:
        note(f"wrote {output_file}")
    if picture:
        from chainbuild.writers.picture import map_picture, write_picture

        note(f"wrote {write_picture(picture, map_picture(found, robot.chain.title))}")
    _print(found, json)
    return 0


def _print(found: Map, as_json: bool) -> None:
    import numpy as np

    from chainbuild.analysis.singularity.names import NEAR

    values = found.smallest[np.isfinite(found.smallest)]
    extents = [(float(edge[0]), float(edge[-1])) for edge in _hit_edges(found)]
    data: dict[str, Any] = {
        "spec": found.spec.data(),
        "directions": [
            {"name": label, "from": low, "to": high}
            for label, (low, high) in zip(found.grid.labels, extents, strict=True)
        ],
        "cells": int(found.count.size),
        "reached": int((found.count > 0).sum()),
        "positions": int(found.count.sum()),
        "collided": found.collided,
        "singular_cells": int((values <= NEAR).sum()),
        "best": float(values.max()) if values.size else None,
    }
    if as_json:
        print_json("workspace", data)
        return
    shown = empty_table(f"Map ({found.spec.kind})", "What", "Value")
    for entry in data["directions"]:
        shown.add_row(entry["name"], f"{entry['from']:.4g} … {entry['to']:.4g}")
    shown.add_row("cells reached", f"{data['reached']} of {data['cells']}")
    shown.add_row("positions", str(data["positions"]))
    if found.spec.collisions:
        shown.add_row("left out for self-collision", str(found.collided))
    shown.add_row(f"cells with no value above {NEAR}", str(data["singular_cells"]))
    shown.add_row("largest smallest singular value", "–" if data["best"] is None else f"{data['best']:.4g}")
    console().print(shown)


def _hit_edges(found: Map) -> list[Any]:
    """Return for each direction the borders of the cells that were hit."""
    import numpy as np

    edges = []
    for n, edge in enumerate(found.grid.edges):
        others = tuple(m for m in range(found.count.ndim) if m != n)
        hit = np.flatnonzero((found.count > 0).any(axis=others))
        edges.append(edge[hit[0] : hit[-1] + 2] if hit.size else edge)
    return edges
