"""Maps: right values, the same on any number of processes, resumable, of constant memory."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.analysis.singularity.measures import smallest_value
from chainbuild.analysis.workspace import maps
from chainbuild.analysis.workspace.maps import make_map, read_map
from chainbuild.analysis.workspace.mapspec import MapSpec
from chainbuild.errors import ChainbuildError, FileAccessError


@pytest.fixture(scope="module")
def robot() -> chainbuild.Robot:
    return chainbuild.Robot.load("kr6r900")


def test_a_map_over_two_axes_holds_the_measure_of_each_cell(robot: chainbuild.Robot) -> None:
    at = (0.0, -80.0, 70.0, 10.0, 20.0, 0.0)
    found = make_map(robot, MapSpec("axes", ("A3", "A5"), at, cells=12), workers=1)
    assert found.complete
    assert (found.count == 1).all()
    for i, j in ((0, 0), (3, 7), (11, 11)):
        axes = list(at)
        for name, n, k in (("A3", i, 0), ("A5", j, 1)):
            edge = found.grid.edges[k]
            axes[[a.name for a in robot.axes].index(name)] = (edge[n] + edge[n + 1]) / 2.0
        assert found.smallest[i, j] == pytest.approx(smallest_value(robot, axes), abs=1e-12)
    assert found.grid.labels == ("A3 [deg]", "A5 [deg]")


def test_a_map_leaves_out_what_limits_on_sums_forbid() -> None:
    robot = chainbuild.Robot.load("parallelogram_nr")
    (limit,) = robot.chain.constraints
    found = make_map(robot, MapSpec("axes", ("A2", "A3"), cells=16), workers=1)
    a2, a3 = ((edges[:-1] + edges[1:]) / 2.0 for edges in found.grid.edges)
    row = np.array(limit.sum.coefficients)
    total = row[1] * a2[:, None] + row[2] * a3[None, :] + limit.sum.offset
    allowed = (total >= limit.lower) & (total <= limit.upper)
    assert 0 < allowed.sum() < allowed.size
    assert ((found.count > 0) == allowed).all()


def test_all_processes_make_the_same_map(robot: chainbuild.Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(maps, "PART", 700)
    spec = MapSpec("rz", cells=30, samples=5000)
    steps: list[tuple[int, int]] = []
    alone = make_map(robot, spec, workers=1, progress=lambda done, total: steps.append((done, total)))
    together = make_map(robot, spec, workers=2)
    np.testing.assert_array_equal(alone.count, together.count)
    np.testing.assert_array_equal(alone.smallest, together.smallest)
    assert steps == [(n, 8) for n in range(1, 9)]
    assert alone.count.sum() <= 5000
    assert alone.count.sum() > 4900


@pytest.mark.parametrize("kind", ["xz", "xy", "yz", "volume"])
def test_sections_and_volumes(robot: chainbuild.Robot, kind: str) -> None:
    found = make_map(robot, MapSpec(kind, cells=12, samples=3000, collisions=True), workers=1)  # type: ignore[arg-type]
    assert found.count.shape == (12,) * (3 if kind == "volume" else 2)
    assert 0 < found.count.sum() <= 3000
    assert np.isfinite(found.smallest[found.count > 0]).all()
    assert np.isnan(found.smallest[found.count == 0]).all()
    assert found.collided > 0 or kind == "xy"


def test_a_stopped_map_goes_on(robot: chainbuild.Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(maps, "PART", 500)
    monkeypatch.setattr(maps, "_PARTS_BETWEEN_SAVES", 1)
    spec, path = MapSpec("rz", cells=20, samples=4000, seed=5), tmp_path / "map.npz"

    def stop(done: int, _: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        make_map(robot, spec, path, workers=1, progress=stop)
    half = read_map(path)
    assert half.done.tolist() == [True] * 3 + [False] * 5
    steps: list[int] = []
    done = make_map(robot, spec, path, workers=1, progress=lambda n, _: steps.append(n))
    assert steps == [4, 5, 6, 7, 8]
    whole = make_map(robot, spec, workers=1)
    np.testing.assert_array_equal(done.count, whole.count)
    np.testing.assert_array_equal(read_map(path).smallest, whole.smallest)
    assert [p.name for p in tmp_path.iterdir()] == ["map.npz"]
    with pytest.raises(ChainbuildError, match="a map of another specification"):
        make_map(robot, MapSpec("rz", cells=21, samples=4000, seed=5), path, workers=1)


def test_files_that_are_no_maps(robot: chainbuild.Robot, tmp_path: Path) -> None:
    path = tmp_path / "map.npz"
    path.write_text("no map", "ascii")
    with pytest.raises(FileAccessError, match="cannot be read"):
        make_map(robot, MapSpec(samples=10), path)
    with pytest.raises(FileAccessError, match="cannot be written"):
        make_map(robot, MapSpec(cells=5, samples=10), tmp_path / "no" / "map.npz", workers=1)


@pytest.mark.parametrize(
    ("spec", "text"),
    [
        (MapSpec("disc"), "unknown map 'disc'"),  # type: ignore[arg-type]
        (MapSpec("axes", ("A1",)), "two different axes"),
        (MapSpec("axes", ("A1", "A1")), "two different axes"),
        (MapSpec("axes", ("A1", "B9")), "two different axes"),
        (MapSpec("axes", ("A1", "A2"), (0.0,)), "expected one value for each axis"),
        (MapSpec(cells=1), "1 cells per side"),
        (MapSpec("volume", cells=1000), "1000 cells"),
        (MapSpec(samples=0), "no sample"),
    ],
)
def test_specifications_that_cannot_be(robot: chainbuild.Robot, spec: MapSpec, text: str) -> None:
    with pytest.raises(ChainbuildError, match=text):
        make_map(robot, spec)


@pytest.mark.slow
def test_a_million_points_take_constant_memory(robot: chainbuild.Robot) -> None:
    import tracemalloc

    peaks = []
    for samples in (100_000, 1_000_000):
        tracemalloc.start()
        make_map(robot, MapSpec(samples=samples), workers=1)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.2 * peaks[0]
