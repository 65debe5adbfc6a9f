"""Cost of measures and self-distances beside the raw library call: `python -m tests.bench.analysis`."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pinocchio as pin

import chainbuild
from chainbuild.analysis.singularity.measures import measure_batch, smallest_value
from chainbuild.chain.bodies.geometry import Geometry, Shape
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.collision.model import CollisionModel

MACHINE = "kr6r900"
ROUNDS = 9


def median_us(work: Callable[[], object], count: int) -> float:
    """Return the median time of one of `count` items of a piece of work, in microseconds."""
    times = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        work()
        times.append((time.perf_counter() - start) / count)
    return 1e6 * statistics.median(times)


def rows() -> list[tuple[str, float, float, str]]:
    """Return (what, microseconds, mark, unit of the mark)."""
    robot = chainbuild.Robot.load(MACHINE)
    lower, upper = shown_limits(robot.chain)
    axes = lower + (upper - lower) * np.random.default_rng(0).random((2000, len(lower)))
    batch = median_us(lambda: measure_batch(robot, axes), len(axes))
    single = median_us(lambda: [smallest_value(robot, row) for row in axes[:400]], 400)
    found = [("singularity measure, batch", batch, 6.0, "us"), ("singularity measure, single", single, 25.0, "us")]
    for kind in ("capsule", "hull"):
        ours, raw = distance_cost(robot, kind, axes[:400])
        found.append((f"self-distance, {kind}s, over the raw loop", ours / raw, 1.3, "times"))
    return found


def distance_cost(robot: chainbuild.Robot, kind: str, axes: np.ndarray) -> tuple[float, float]:
    """Return microseconds of `CollisionModel.smallest_at` and of Pinocchio's own loop on the same bodies."""
    if kind == "hull":
        robot = chainbuild.Robot(replace(robot.chain, geometry=Geometry(shapes=hulls(robot))))
    model = CollisionModel(robot)
    geometry, data = model._model, robot.model.createData()
    results = pin.GeometryData(geometry)
    joints = [robot.q(row) for row in axes]

    def raw() -> None:
        for q in joints:
            best = pin.computeDistances(robot.model, data, geometry, results, q)
            float(results.distanceResults[best].min_distance)

    return median_us(lambda: [model.smallest_at(q) for q in joints], len(axes)), median_us(raw, len(axes))


def hulls(robot: chainbuild.Robot) -> dict[str, tuple[Shape, ...]]:
    """Return a rounded hull of 80 points for each capsule of a robot, written where it can be read."""
    import tempfile
    from pathlib import Path

    folder = Path(tempfile.mkdtemp())
    shapes = {}
    rng = np.random.default_rng(1)
    for solid in CollisionModel(robot).solids:
        if solid.kind not in ("capsule", "sphere"):
            continue
        radius, half = solid.size[0], solid.size[1] / 2.0 if solid.kind == "capsule" else 0.0
        points = rng.normal(size=(80, 3))
        points *= radius / np.linalg.norm(points, axis=1)[:, None]
        points[:, 2] += np.where(points[:, 2] > 0.0, half, -half)
        points = points @ solid.T_link_solid[:3, :3].T + solid.T_link_solid[:3, 3]
        path = folder / f"{solid.name}.obj"
        lines = [f"v {x} {y} {z}" for x, y, z in points] + [f"f {n} {n + 1} {n + 2}" for n in range(1, 79)]
        path.write_text("\n".join(lines), "ascii")
        shapes[solid.link] = (Shape("hull", file=path, scale=(1.0, 1.0, 1.0)),)
    return shapes


def main() -> None:
    """Print the table."""
    print("| what | value | mark |\n|---|---|---|")
    for what, value, mark, unit in rows():
        print(f"| {what} | {value:.2f} {unit} | {mark:g} {unit} |")


if __name__ == "__main__":
    main()
