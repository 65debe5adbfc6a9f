"""A whole path, chunk by chunk: `singularity_verdicts`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Final, Literal

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.analysis.path.along import PathOptions, path_report
from chainbuild.analysis.path.collect import BlockRun
from chainbuild.analysis.path.motion import PathMotion, motion_of
from chainbuild.analysis.path.nearby import leaving
from chainbuild.analysis.path.places import PathSpeed
from chainbuild.analysis.vanishing.lows import Low
from chainbuild.analysis.verdicts.blockverdicts import (
    BLOCK_TOO_LONG_ALARM,
    POLE_ALARM,
    BlockVerdict,
    SingularityVerdicts,
    VerdictPart,
)
from chainbuild.analysis.verdicts.controlmeasure import measure_in_force
from chainbuild.analysis.verdicts.thresholds import Level, Thresholds, thresholds_of
from chainbuild.analysis.verdicts.zones import zones
from chainbuild.arrays import Matrix
from chainbuild.errors import ChainbuildError
from chainbuild.kinematics.mechanism import Mechanism

LONGEST_SINGULAR_MM: Final = 30.0  # ROBX manual 10.3: from here on alarm 75327
_ROUNDING_MM: Final = 1e-6  # ways are sums of chords and roots: 30 mm must not become 29.9999999999
_WHOLE: Final = 1e-9  # of a block: a part this close to both ends is the whole block
_CHUNK: Final = 1024  # blocks worked on at a time


def singularity_verdicts(
    robot: Mechanism, rows: ArrayLike, *, between: Literal["ptp", "cp"] = "ptp", feed_mm_min: float | None = None
) -> SingularityVerdicts:
    """Return what the control makes of a path close to singularities: one verdict for each block that is.

    A control that handles singular blocks (ROBX: six robot axes, at most three additional ones, MD28592 = 1) splits
    them; one singular block that is too long raises 75327. Elsewhere a block through the pole raises 10911, and an axis
    that would be too fast 10910.

    Args:
        robot: The robot.
        rows: (N, n_axes) axis values, mm and degrees; a row of NaN interrupts the path.
        between: "ptp": axes change evenly between rows; "cp": the tip moves along a straight line.
        feed_mm_min: Speed of the tip, for 10910; None: speeds are not judged.

    Raises:
        ChainbuildError: a control without known thresholds, a wrong feed or motion, or rows of the wrong shape.
    """
    limits = thresholds_of(robot.chain)
    if limits is None:
        raise ChainbuildError(f"no thresholds of singularities are known for {robot.chain.kinematic}")
    if between not in ("ptp", "cp"):
        raise ChainbuildError(f"unknown motion '{between}'", parameter="between", permitted="ptp, cp")
    path = _path(robot, rows)
    measure = measure_in_force(robot, limits.measure)
    blocks: list[BlockVerdict] = []
    proven, remarks, way_mm = True, dict[str, None](), 0.0
    for first, part in _runs(path):
        motion = motion_of(robot, part, between)
        count = np.arange(len(part) - 1)
        ways = motion.lengths(count, np.ones(len(count)))
        run = BlockRun(motion, first, way_mm + np.concatenate([[0.0], np.cumsum(ways[:-1])]), None)
        judged = _Judged(run, ways.tolist(), measure, limits)
        blocks += judged.verdicts()
        proven = proven and judged.proven
        way_mm += float(ways.sum())
        remarks |= {
            f"the line leaves the reach at row {run.places([n], [t])[0].label}": None for n, t in leaving(motion)
        }
    if between == "ptp":
        remarks["straight axes: where the control moves the tip on a line, it passes other places"] = None
    return SingularityVerdicts(
        between, len(path), measure, limits.block, limits.threshold, limits.clearance, not limits.lacks,
        _sentence(limits, measure), tuple(blocks), _excessive(robot, path, between, feed_mm_min, limits),
        proven, tuple(remarks),
    )  # fmt: skip


def _path(robot: Mechanism, rows: ArrayLike) -> Matrix:
    path = np.atleast_2d(np.asarray(rows, dtype=float))
    without = np.isnan(path).all(axis=1, keepdims=True)
    if path.ndim != 2 or path.shape[1] != len(robot.axes) or not (np.isfinite(path) | without).all():
        raise ChainbuildError(f"expected finite axis values of shape (N, {len(robot.axes)}), or rows of NaN")
    return path


def _runs(path: Matrix) -> Iterator[tuple[int, Matrix]]:
    """Yield chunks of rows without gaps, each with its first row; one begins with the last row of the one before."""
    gaps = np.flatnonzero(np.isnan(path).all(axis=1)).tolist()
    begin = 0
    for end in [*gaps, len(path)]:
        for first in range(begin, end - 1, _CHUNK):
            yield first, path[first : min(first + _CHUNK + 1, end)]
        begin = end + 1


class _Judged:
    """The blocks of a chunk."""

    def __init__(self, run: BlockRun, ways_mm: list[float], measure: str, limits: Thresholds) -> None:
        self.run, self.ways_mm, self.limits = run, ways_mm, limits
        motion: PathMotion = run.motion
        singular = zones(motion, measure, limits.threshold)
        self.levels: dict[int, tuple[Level, list[Low]]] = {n: ("singular", own) for n, own in singular.parts.items()}
        self.proven = singular.proven
        if not limits.lacks and limits.clearance > limits.threshold:
            watched = zones(motion, measure, limits.clearance)
            self.proven = self.proven and watched.proven
            for n, own in watched.parts.items():
                self.levels.setdefault(n, ("watched", own))

    def verdicts(self) -> Iterator[BlockVerdict]:
        """Yield the verdicts in order."""
        flat = [(block, low) for block, (_, lows) in self.levels.items() for low in lows]
        if not flat:
            return
        shares = [t for _, low in flat for t in (low.begin, low.end, low.least)]
        places = iter(self.run.places([block for block, _ in flat for _ in range(3)], shares))
        parts: dict[int, list[VerdictPart]] = {}
        for block, low in flat:
            parts.setdefault(block, []).append(VerdictPart(next(places), next(places), next(places), low.value))
        for block in sorted(parts):
            level, lows = self.levels[block]
            alarm = self._alarm(block, level, lows, parts[block])
            yield BlockVerdict(self.run.first + block, level, tuple(parts[block]), self.ways_mm[block], alarm)

    def _alarm(self, block: int, level: Level, lows: list[Low], parts: list[VerdictPart]) -> int | None:
        if level != "singular":
            return None
        if self.limits.lacks:
            return POLE_ALARM
        if self.limits.block == "stretch":
            counted = max(part.length_mm for part in parts)
        else:
            whole = lows[0].begin <= _WHOLE and lows[0].end >= 1.0 - _WHOLE
            counted = self.ways_mm[block] if whole else 0.0
        return BLOCK_TOO_LONG_ALARM if counted >= LONGEST_SINGULAR_MM - _ROUNDING_MM else None


def _excessive(
    robot: Mechanism, path: Matrix, between: Literal["ptp", "cp"], feed: float | None, limits: Thresholds
) -> tuple[PathSpeed, ...]:
    if feed is None:
        return ()
    options = replace(PathOptions(), feed_mm_min=feed)
    options.check()
    if not limits.lacks:
        return ()
    report = path_report(robot, path, between=between, options=options)
    return tuple(speed for speed in report.speeds if speed.speed.excessive)


def _sentence(limits: Thresholds, measure: str) -> str:
    own = {
        "SINGULARITY_THRESHOLD": f"SD41670 {limits.threshold:g}",
        "MIN_DIST_TO_SINGULARITY": f"SD41671 {limits.clearance:g}",
    }
    shown = {name: text if name in limits.given else f"{text} (recommended)" for name, text in own.items()}
    threshold, clearance = shown.values()
    if not limits.lacks:
        return f"{measure} against {threshold} and {clearance}; 75327 by {limits.block}"
    unused = f"; {clearance} has no effect" if "MIN_DIST_TO_SINGULARITY" in limits.given else ""
    return (
        f"singularity handling does not exist here: {limits.lacks}; 10911 applies where {measure} is at most"
        f" {threshold}, 10910 to axes that are too fast{unused}"
    )
