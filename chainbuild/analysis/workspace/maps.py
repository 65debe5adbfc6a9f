"""Workspace and singularity maps: many positions, all cores, constant memory, resumable.

The work is cut into parts whose positions follow from the seed and the part's number alone. Each part is reduced to the
cells it hit before it leaves its process, and the map is the sum of its parts in any order. Finished parts are
saved from time to time, so that a stopped run resumes.
"""

from __future__ import annotations

import json
import multiprocessing
import os
import signal
import zipfile
from collections.abc import Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import connection
from pathlib import Path
from threading import Thread
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.analysis.singularity.measures import measure_batch
from chainbuild.analysis.workspace.fingerprint import fingerprint
from chainbuild.analysis.workspace.mapspec import (
    Grid,
    MapSpec,
    check_spec,
    directions,
    grid_of,
    in_slab,
    mapped_axes,
    random_axes,
)
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.elements import Chain
from chainbuild.collision.model import CollisionModel
from chainbuild.errors import ChainbuildError, FileAccessError, Span
from chainbuild.files import open_binary_atomic
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.progress import Progress, counting
from chainbuild.shown import two_lines

PART: Final = 20_000  # positions of a part: a fraction of a second
_PARTS_BETWEEN_SAVES: Final = 16  # a few seconds of work, of which little is lost and little spent on writing
_AHEAD: Final = 2  # parts queued for each process beyond its current one


@dataclass(slots=True, eq=False)
class Map:
    """A map, finished or under way.

    Attributes:
        spec: What it shows.
        grid: Its cells.
        count: Free positions in each cell.
        smallest: Largest of the smallest scaled singular values in each cell; NaN if none was free.
        collided: Number of positions left out for self-collision.
        done: (parts,) which parts are in it.
        machine: Of which machine, with which limits and tool: a fingerprint of the chain.
    """

    spec: MapSpec
    grid: Grid
    count: NDArray[np.int64]
    smallest: Vector
    collided: int
    done: NDArray[np.bool_]
    machine: str

    def __repr__(self) -> str:
        size = "×".join(str(count) for count in self.grid.shape)
        hit = f"{int((self.count > 0).sum())} reached"
        done = "complete" if self.complete else f"{self.done.mean():.0%} done"
        return two_lines(f"<Map {self.spec.kind} of {size} cells over {', '.join(self.grid.labels)}: {hit}, {done}>")

    @property
    def complete(self) -> bool:
        """Whether every part is in it."""
        return bool(self.done.all())

    def save(self, path: Path) -> None:
        """Write the map as NPZ, all or nothing.

        Raises:
            FileAccessError: the file cannot be written.
        """
        edges: dict[str, Any] = {f"edges_{n}": edge for n, edge in enumerate(self.grid.edges)}
        text = json.dumps({"spec": self.spec.data(), "labels": self.grid.labels, "machine": self.machine})
        with open_binary_atomic(path) as stream:
            np.savez_compressed(
                stream,
                header=np.array(text),
                count=self.count,
                smallest=self.smallest,
                collided=np.array(self.collided),
                done=self.done,
                **edges,
            )


def read_map(path: Path) -> Map:
    """Read a map that `Map.save` wrote.

    Raises:
        FileAccessError: the file cannot be read or holds no map.
    """
    try:
        with path.open("rb") as stream:
            if not zipfile.is_zipfile(stream):
                raise ValueError("it is no complete NPZ file")
            stream.seek(0)
            with np.load(stream, allow_pickle=False) as data:
                return _from_arrays(data)
    except Exception as error:  # numpy, zipfile, zlib and json have an error each for what is damaged
        reason = error.strerror if isinstance(error, OSError) else None
        raise FileAccessError(
            f"the map cannot be read: {reason or error or type(error).__name__}",
            span=_span(path),
            permitted="a map written by `workspace -o`, or a file that does not exist",
        ) from None


def _from_arrays(data: Mapping[str, Any]) -> Map:
    """Return the map of the arrays of a file.

    Raises:
        Exception: of any kind; the arrays are no map.
    """
    header = json.loads(str(data["header"]))
    labels = tuple(header["labels"])
    given = header["spec"] | {"axes": tuple(header["spec"]["axes"]), "at": tuple(header["spec"]["at"])}
    grid = Grid(labels, tuple(data[f"edges_{n}"] for n in range(len(labels))))
    count, smallest, done = data["count"], data["smallest"], data["done"]
    found = Map(MapSpec(**given), grid, count, smallest, int(data["collided"]), done, str(header["machine"]))
    kinds = (count.dtype, smallest.dtype, done.dtype) == (np.int64, np.float64, np.bool_)
    shapes = count.shape == smallest.shape == grid.shape and done.shape == (_part_count(found.spec),)
    if not (kinds and shapes and all(np.isfinite(edge).all() for edge in grid.edges)):
        raise ValueError("its arrays do not belong together")
    return found


def _span(path: Path) -> Span:
    return Span(str(path))


def make_map(
    robot: Mechanism,
    spec: MapSpec,
    path: Path | None = None,
    *,
    workers: int | None = None,
    progress: Progress = False,
) -> Map:
    """Return the map of a specification.

    Args:
        robot: The robot.
        spec: What to show.
        path: NPZ file that the map is kept in; an unfinished map of the same
            specification in it is resumed.
        workers: Number of processes; None: one per core.
        progress: Called with the numbers of parts done and of all parts.

    Raises:
        ChainbuildError: the specification is invalid, or the file holds another map.
        FileAccessError: the file cannot be read or written.
    """
    check_spec(robot, spec)
    result = _begin(robot, spec, path)
    todo = np.flatnonzero(~result.done).tolist()
    with counting(len(result.done), progress, "map", int(result.done.sum())) as advance:
        for count, (part, found) in enumerate(_parts(robot.chain, spec, result.grid, todo, workers), start=1):
            _merge(result, part, found)
            if path is not None and count % _PARTS_BETWEEN_SAVES == 0:
                result.save(path)
            advance(1)
    if path is not None:
        result.save(path)
    return result


def _begin(robot: Mechanism, spec: MapSpec, path: Path | None) -> Map:
    machine = _machine(robot, spec)
    if path is not None and path.exists() and (path.is_file() or path.is_dir()):
        old = read_map(path)
        other = "specification" if old.spec != spec else "machine, or of other limits or another tool"
        if (old.spec, old.machine) != (spec, machine):
            raise ChainbuildError(
                f"the file holds a map of another {other}",
                span=_span(path),
                permitted="the same map, or a file that does not exist",
            )
        return old
    grid = grid_of(robot, spec)
    cells = int(np.prod(grid.shape))
    done = np.zeros(_part_count(spec), dtype=bool)
    shape = grid.shape
    smallest = np.full(cells, np.nan).reshape(shape)
    return Map(spec, grid, np.zeros(cells, dtype=np.int64).reshape(shape), smallest, 0, done, machine)


def _part_count(spec: MapSpec) -> int:
    total = spec.cells**2 if spec.kind == "axes" else spec.samples
    return -(-total // PART)


def _machine(robot: Mechanism, spec: MapSpec) -> str:
    try:
        return fingerprint(robot.chain, bodies=spec.collisions)
    except OSError as error:
        raise FileAccessError(f"a mesh cannot be read: {error.strerror}", span=Span(str(error.filename))) from None


@dataclass(frozen=True, slots=True, eq=False)
class _Part:
    """Cells that a part hit, each once, with what it found there."""

    cells: NDArray[np.int64]
    count: NDArray[np.int64]
    smallest: Vector
    collided: int


def _merge(result: Map, number: int, part: _Part) -> None:
    result.count.reshape(-1)[part.cells] += part.count
    flat = result.smallest.reshape(-1)
    flat[part.cells] = np.fmax(flat[part.cells], part.smallest)
    result.collided += part.collided
    result.done[number] = True


def _parts(
    chain: Chain, spec: MapSpec, grid: Grid, todo: list[int], workers: int | None
) -> Iterator[tuple[int, _Part]]:
    """Yield the parts as they are done."""
    processes = min(workers or os.cpu_count() or 1, max(len(todo), 1))
    if processes == 1:
        worker = _Worker(chain, spec, grid)
        for number in todo:
            yield number, worker.part(number)
        return
    with ProcessPoolExecutor(processes, initializer=_start, initargs=(chain, spec, grid)) as pool:
        waiting: dict[Future[_Part], int] = {}
        queue = iter(todo)
        try:
            while True:
                # A bounded number is under way, so that results cannot pile up.
                for number in queue:
                    waiting[pool.submit(_work, number)] = number
                    if len(waiting) >= processes * (1 + _AHEAD):
                        break
                if not waiting:
                    return
                finished, _ = wait(waiting, return_when=FIRST_COMPLETED)
                for future in finished:
                    yield waiting.pop(future), future.result()
        except BrokenProcessPool:
            raise ChainbuildError("a process of the map has ended: out of memory?", hint="--workers 1") from None
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


class _Worker:
    """Computes parts of one map."""

    def __init__(self, chain: Chain, spec: MapSpec, grid: Grid) -> None:
        self.robot, self.spec, self.grid = Mechanism(chain), spec, grid
        self.bodies = CollisionModel(self.robot) if spec.collisions else None

    def part(self, number: int) -> _Part:
        axes, cells = self._positions(number)
        table = measure_batch(self.robot, axes)
        smallest = table.smallest
        if cells is None:
            points = directions(self.spec.kind, table.positions)
            cells = self.grid.cells_of(points)
            edge = self.grid.edges[0]
            cells[~in_slab(self.spec.kind, table.positions, float(edge[1] - edge[0]))] = -1
        inside = (cells >= 0) & np.isfinite(smallest)
        inside[inside] = self.robot.limits.inside_rows(axes[inside])
        collided = 0
        if self.bodies is not None:
            for n in np.flatnonzero(inside).tolist():
                if self.bodies.collides(axes[n]):
                    inside[n] = False
                    collided += 1
        unique, places, count = np.unique(cells[inside], return_inverse=True, return_counts=True)
        best = np.zeros(len(unique))
        np.maximum.at(best, places, smallest[inside])
        return _Part(unique, count.astype(np.int64), best, collided)

    def _positions(self, number: int) -> tuple[Matrix, NDArray[np.int64] | None]:
        """Return the axis values of a part, and their cells if these are known before the pose."""
        spec = self.spec
        first = number * PART
        if spec.kind != "axes":
            count = min(PART, spec.samples - first)
            return random_axes(self.robot, np.random.default_rng([spec.seed, number]), count), None
        flat = np.arange(first, min(first + PART, spec.cells**2), dtype=np.int64)
        lower, upper = shown_limits(self.robot.chain)
        base = np.array(spec.at) if spec.at else (lower + upper) / 2.0
        axes = np.repeat(base[None, :], len(flat), axis=0)
        places = np.unravel_index(flat, self.grid.shape)
        for n, edge, place in zip(mapped_axes(self.robot, spec), self.grid.edges, places, strict=True):
            axes[:, n] = (edge[place] + edge[place + 1]) / 2.0
        return axes, flat


_worker: _Worker | None = None


def _start(chain: Chain, spec: MapSpec, grid: Grid) -> None:
    global _worker  # noqa: PLW0603 - one worker a process, built when the process starts
    _end_with_parent()
    _worker = _Worker(chain, spec, grid)


def _end_with_parent() -> None:
    """Have this process end as soon as its parent has, however that ended; what it does on a signal is its own."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent stops the work
    for name in ("SIGTERM", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_DFL)  # temporary files are the parent's
    parent = multiprocessing.parent_process()
    assert parent is not None, "the process was not started by make_map"

    def watch() -> None:
        connection.wait([parent.sentinel])
        os._exit(1)

    Thread(target=watch, daemon=True).start()


def _work(number: int) -> _Part:
    assert _worker is not None, "the process was not started by make_map"
    return _worker.part(number)
