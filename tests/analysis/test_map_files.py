"""Files of maps: of one machine, limits and tool alone; damaged ones are one error; workers end with their parent."""

from __future__ import annotations

import io
import json
import os
import resource
import shutil
import signal
import subprocess
import time
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.analysis.workspace.fingerprint import fingerprint
from chainbuild.analysis.workspace.maps import make_map, read_map
from chainbuild.analysis.workspace.mapspec import MapSpec
from chainbuild.errors import ChainbuildError, FileAccessError
from chainbuild.machines import shipped
from tests.kit.bad_mutants import mutants
from tests.kit.command_line import PROGRAM

SPEC = MapSpec("rz", cells=8, samples=200)
MUTANTS = 20_000


@pytest.fixture(scope="module")
def robot() -> chainbuild.Robot:
    return chainbuild.Robot.load("kr6r900")


@pytest.fixture
def path(robot: chainbuild.Robot, tmp_path: Path) -> Path:
    """Return the file of a finished map."""
    make_map(robot, SPEC, tmp_path / "map.npz", workers=1)
    return tmp_path / "map.npz"


def chain_with_limit(chain: chainbuild.Chain, by: float) -> chainbuild.Chain:
    axes = (replace(chain.axes[0], upper=chain.axes[0].upper + by), *chain.axes[1:])
    return replace(chain, axes=axes)


@pytest.mark.parametrize("other", ["machine", "tool", "limits"])
def test_a_map_of_another_machine_is_refused(other: str, robot: chainbuild.Robot, path: Path) -> None:
    before = path.read_bytes()
    chain = {
        "machine": lambda: chainbuild.load("irb2600").chain(),
        "tool": lambda: chainbuild.load("kr6r900").chain(tool_length_mm=0.01),
        "limits": lambda: chain_with_limit(robot.chain, -0.001),
    }[other]()
    with pytest.raises(ChainbuildError, match="map of another machine, or of other limits or another tool"):
        make_map(chainbuild.Robot(chain), SPEC, path, workers=1)
    assert path.read_bytes() == before
    # The same machine, read again under another title and with other speeds, is the same.
    axes = tuple(replace(axis, max_speed=1.0) for axis in robot.chain.axes)
    same = replace(robot.chain, title="another title", axes=axes)
    assert make_map(chainbuild.Robot(same), SPEC, path, workers=1).complete


def test_every_shipped_machine_has_its_own_fingerprint() -> None:
    chains = [chainbuild.load(name).chain() for name in shipped()]
    found = [fingerprint(chain, bodies=True) for chain in chains]
    assert len(set(found)) == len(found)
    assert [fingerprint(chainbuild.load(name).chain(), bodies=True) for name in shipped()[:9]] == found[:9]


def test_the_last_bit_of_a_number_is_not_another_machine(robot: chainbuild.Robot) -> None:
    joint = robot.chain.joints[2]
    T = joint.T_parent_joint * (1.0 + 2e-16)
    chain = replace(
        robot.chain, joints=(*robot.chain.joints[:2], replace(joint, T_parent_joint=T), *robot.chain.joints[3:])
    )
    assert fingerprint(chain, bodies=False) == fingerprint(robot.chain, bodies=False)


def test_meshes_count_where_bodies_do(robot: chainbuild.Robot, tmp_path: Path) -> None:
    mesh = tmp_path / "arm.stl"
    found = []
    for text in ("solid a", "solid b"):
        mesh.write_text(text)
        shape = chainbuild.chain.bodies.geometry.Shape("mesh", file=mesh)  # type: ignore[attr-defined]
        chain = replace(robot.chain, geometry=replace(robot.chain.geometry, shapes={"A1_link": (shape,)}))
        found.append([fingerprint(chain, bodies=bodies) for bodies in (True, False)])
    assert found[0][0] != found[1][0]
    assert found[0][1] == found[1][1]


def rewritten(path: Path, **arrays: object) -> bytes:
    """Return the bytes of a map whose arrays are replaced; None leaves one out."""
    with np.load(path) as data:
        kept = {name: data[name] for name in data.files} | arrays
    stream = io.BytesIO()
    np.savez(stream, **{name: np.asarray(value) for name, value in kept.items() if value is not None})  # type: ignore[arg-type]
    return stream.getvalue()


@pytest.mark.parametrize(
    "damage", ["empty", "cut", "flipped", "foreign zip", "foreign npz", "text", "npy", "shape", "done", "old", "dtype"]
)
def test_a_damaged_or_foreign_file_is_one_error(damage: str, robot: chainbuild.Robot, path: Path) -> None:
    good = path.read_bytes()
    flipped = bytearray(good)
    flipped[len(good) // 2] ^= 0xFF
    foreign, npz, npy = io.BytesIO(), io.BytesIO(), io.BytesIO()
    with zipfile.ZipFile(foreign, "w") as archive:
        archive.writestr("header.npy", "no array")
    np.savez(npz, a=np.zeros(3))
    np.save(npy, np.zeros(3))
    with np.load(path) as data:
        header = json.loads(str(data["header"]))
    del header["machine"]
    content = {
        "empty": b"",
        "cut": good[: len(good) // 2],
        "flipped": bytes(flipped),
        "foreign zip": foreign.getvalue(),
        "foreign npz": npz.getvalue(),
        "text": b"no map",
        "npy": npy.getvalue(),
        "shape": rewritten(path, count=np.zeros((3, 3), dtype=np.int64)),
        "done": rewritten(path, done=np.ones(7, dtype=bool)),
        "old": rewritten(path, header=json.dumps(header)),
        "dtype": rewritten(path, smallest=np.full((8, 8), "x")),
    }[damage]
    path.write_bytes(content)
    with pytest.raises(FileAccessError, match=r"the map cannot be read: .") as caught:
        make_map(robot, SPEC, path, workers=1)
    assert caught.value.file == str(path)
    assert path.read_bytes() == content


def test_a_map_is_saved_like_every_output(robot: chainbuild.Robot, path: Path, tmp_path: Path) -> None:
    link = tmp_path / "link.npz"
    (tmp_path / "there").mkdir()
    link.symlink_to("there/map.npz")
    neighbour = tmp_path / "there" / ".map.npz.part"
    neighbour.write_text("somebody's")
    found = read_map(path)
    found.save(link)
    assert link.is_symlink()
    assert read_map(tmp_path / "there" / "map.npz").spec == found.spec
    assert neighbour.read_text() == "somebody's"
    found.save(Path(os.devnull))
    assert make_map(robot, SPEC, Path(os.devnull), workers=1).complete


def test_a_full_disk_leaves_the_map_as_it_was(path: Path, tmp_path: Path) -> None:
    before, found = path.read_bytes(), read_map(path)
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, hard))
    try:
        with pytest.raises(FileAccessError, match="cannot be written: File too large"):
            found.save(path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        signal.signal(signal.SIGXFSZ, ignored)
    assert path.read_bytes() == before
    assert [one.name for one in tmp_path.iterdir()] == ["map.npz"]


def children(process: int) -> set[int]:
    """Return the processes that a process has started and that run."""
    done = subprocess.run(["ps", "-o", "pid=", "--ppid", str(process)], capture_output=True, text=True, check=False)
    return {int(word) for word in done.stdout.split()}


def runs(process: int) -> bool:
    """Return whether a process runs: one that has ended and waits to be collected does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.skipif(shutil.which("ps") is None or not Path("/proc").is_dir(), reason="looks processes up in /proc")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_workers_end_with_their_parent(number: signal.Signals, tmp_path: Path) -> None:
    words = ["workspace", "kr6r900", "--samples", "100000000", "--workers", "2", "-o", str(tmp_path / "map.npz")]
    process = subprocess.Popen([*PROGRAM, *words], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 60.0
    while len(workers := children(process.pid)) < 2:
        assert process.poll() is None
        assert time.monotonic() < deadline
        time.sleep(0.02)
    time.sleep(0.3)  # the second has begun
    process.send_signal(number)
    assert process.wait(timeout=60) == -number
    while any(runs(worker) for worker in workers):
        assert time.monotonic() < deadline, workers
        time.sleep(0.02)
    if number == signal.SIGTERM:
        assert not list(tmp_path.glob(".*.part"))


@pytest.mark.slow
def test_thousands_of_damaged_maps_are_read_or_refused(path: Path, tmp_path: Path) -> None:
    """Headers changed in structure, and files with bytes flipped, cut and doubled."""
    good, bad, refused = path.read_bytes(), tmp_path / "bad.npz", 0
    with np.load(path) as data:
        header = str(data["header"])
    rng = np.random.default_rng(5)
    for n, text in enumerate(mutants(header, MUTANTS, 4)):
        changed = bytearray(good)
        if n % 2:
            changed = bytearray(rewritten(path, header=text.replace("\x00", "")))
        for _ in range(0 if n % 2 else int(rng.integers(1, 4))):
            at = int(rng.integers(len(changed)))
            how = int(rng.integers(3))
            changed[at : at + 1 if how == 0 else at + 40] = bytes([int(rng.integers(256))]) * how
        bad.write_bytes(changed)
        try:
            read_map(bad)
        except FileAccessError:
            refused += 1
    assert MUTANTS / 4 < refused < MUTANTS
