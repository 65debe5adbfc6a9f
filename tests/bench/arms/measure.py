"""Every solver of an arm on the same poses, one after another, and what came of it by classes."""

from __future__ import annotations

import gc
import resource
import time
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Final

import numpy as np

from tests.bench.arms.geometry import Arm
from tests.bench.arms.peers import OURS, PLAIN, Peer
from tests.bench.arms.truth import truths

RANDOM, RIGHT_ANGLES, BESIDE_3, BESIDE_6 = "random", "right angles", "1e-3 rad beside", "1e-6 rad beside"
KINDS: Final = (RANDOM, RIGHT_ANGLES, BESIDE_3, BESIDE_6)
_OFF: Final = {RIGHT_ANGLES: 0.0, BESIDE_3: 1e-3, BESIDE_6: 1e-6}  # rad
_WARM: Final = 1  # poses of a kind before the clock counts: prepares what is prepared at first use
_AGAIN_NS: Final = 1_000_000  # a call that takes less is repeated
_CALLS: Final = 3  # of which the quickest counts: the others met something else
_ATTEMPTS: Final = 8  # calls at most, with those that were interrupted
_LONG_NS: Final = 50_000_000  # a call that takes more is not repeated: it is interrupted anyway
_PLAIN_EACH: Final = 10  # the plain path answers every tenth pose: it is slow, and beside the point here
_AT_ONCE: Final = 20  # poses whose truth is sought together


@dataclass
class Tally:
    """What a solver did with one class of poses.

    Attributes:
        poses: Poses that it was asked.
        isolated: Isolated branches of these.
        missed: Those that it lacks.
        wrong: Rows that miss their pose.
        nothing: Poses without any right row.
        times: µs of each pose.
        ours: µs of chainbuild at the same poses.
    """

    poses: int = 0
    isolated: int = 0
    missed: int = 0
    wrong: int = 0
    nothing: int = 0
    times: list[float] = field(default_factory=list)
    ours: list[float] = field(default_factory=list)

    def summary(self) -> dict[str, float]:
        """Return the counts, median and 95 % [µs] of both times."""
        found: dict[str, float] = {k: v for k, v in asdict(self).items() if k not in ("times", "ours")}
        for name, times in (("", self.times), ("ours_", self.ours)):
            if times:
                found |= {
                    f"{name}median": round(float(np.median(times)), 1),
                    f"{name}p95": round(float(np.percentile(times, 95)), 1),
                }
        return found


@dataclass
class Findings:
    """What a run has found.

    Attributes:
        tallies: (family, calibrated, kind of poses, solver) → its tally.
        misses: Where chainbuild lacks branches, has wrong ones, or nothing: arm, kind, number and joint values of the
            pose, the branches.
        touching: Poses with solutions that are not isolated.
        alone: Isolated branches that random starts found without any solver.
    """

    tallies: dict[tuple[str, bool, str, str], Tally] = field(default_factory=dict)
    misses: list[dict[str, Any]] = field(default_factory=list)
    touching: int = 0
    alone: int = 0


def joint_values(arm: Arm, kind: str, count: int, seed: int = 0) -> np.ndarray:
    """Return the joint values (count, 6) [rad] that poses of a kind are made from, seeded by arm and kind."""
    rng = np.random.default_rng([zlib.crc32(f"{arm.name} {kind}".encode()), seed])
    if kind == RANDOM:
        return rng.uniform(-np.pi, np.pi, (count, 6))
    q = rng.integers(-1, 3, (count, 6)) * (np.pi / 2.0)
    away = rng.normal(size=(count, 6))
    return q + _OFF[kind] * away / np.linalg.norm(away, axis=1, keepdims=True)


def measure(arm: Arm, solvers: Sequence[Peer], count: int, findings: Findings, kinds: Iterable[str] = KINDS) -> None:
    """Ask every solver of an arm for the branches of `count` poses of each kind, and enter what came of it."""
    for kind in kinds:
        q = joint_values(arm, kind, count)
        T = np.array([arm.pose(row) for row in q])
        times, answers = ask(solvers, T)
        rng = np.random.default_rng(zlib.crc32(f"{arm.name} {kind} starts".encode()))
        for at in range(0, count, _AT_ONCE):
            part = slice(at, at + _AT_ONCE)
            judged = truths(arm, T[part], q[part], [rows[part] for rows in answers], rng)
            for i, truth in enumerate(judged, start=at):
                findings.touching += truth.touching
                findings.alone += truth.alone
                for s, peer in enumerate(solvers):
                    if answers[s][i] is None:
                        continue
                    key = (arm.family, arm.calibrated, kind, peer.name)
                    tally = findings.tallies.setdefault(key, Tally())
                    tally.poses += 1
                    tally.isolated += len(truth.branches)
                    tally.missed += len(truth.missed[s])
                    tally.wrong += truth.wrong[s]
                    tally.nothing += truth.right[s] == 0
                    tally.times.append(times[s][i])
                    tally.ours.append(times[0][i])
                    if peer.name in (OURS, PLAIN) and (truth.missed[s] or truth.wrong[s] or not truth.right[s]):
                        branches = [truth.branches[b].round(9).tolist() for b in truth.missed[s]]
                        findings.misses.append(
                            {
                                "solver": peer.name,
                                "arm": arm.name,
                                "kind": kind,
                                "pose": i,
                                "q": q[i].tolist(),
                                "missed": branches,
                                "of": len(truth.branches),
                                "wrong": truth.wrong[s],
                                "nothing": truth.right[s] == 0,
                            }
                        )


def ask(solvers: Sequence[Peer], T: np.ndarray) -> tuple[list[list[float]], list[list[np.ndarray | None]]]:
    """Return µs and rows (k, 6) of each solver at poses (n, 4, 4), or NaN and None where it was not asked."""
    times: list[list[float]] = [[] for _ in solvers]
    answers: list[list[np.ndarray | None]] = [[] for _ in solvers]
    for peer in solvers:
        with peer.around():
            for pose in T[:_WARM]:
                peer.solve(peer.prepare(pose))
    gc.collect()
    gc.disable()
    try:
        for i, pose in enumerate(T):
            for s, peer in enumerate(solvers):
                if peer.name == PLAIN and i % _PLAIN_EACH:
                    times[s].append(float("nan"))
                    answers[s].append(None)
                    continue
                with peer.around():
                    took, answer = clocked(peer, peer.prepare(pose))
                times[s].append(took)
                answers[s].append(peer.joints(answer, pose))
    finally:
        gc.enable()
    return times, answers


def clocked(peer: Peer, handed: Any) -> tuple[float, Any]:
    """Return µs of one call and its answer; short calls are repeated and the quickest counts.

    A call that was interrupted for another process does not count, unless all were.
    """
    calm: list[int] = []
    least = 0
    for attempt in range(_ATTEMPTS):
        before = _interruptions()
        begin = time.perf_counter_ns()
        answer = peer.solve(handed)
        took = time.perf_counter_ns() - begin
        least = took if not attempt else min(least, took)
        if _interruptions() == before:
            calm.append(took)
        if len(calm) >= (_CALLS if took < _AGAIN_NS else 1) or took > _LONG_NS:
            break
    return (min(calm) if calm else least) / 1e3, answer


def _interruptions() -> int:
    """Return how often the system took the processor away from this thread."""
    return resource.getrusage(resource.RUSAGE_THREAD).ru_nivcsw
