"""A whole path, chunk by chunk: `path_report`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sized
from dataclasses import dataclass, field, replace
from itertools import chain, islice
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.analysis.path.collect import BlockRun, Growing, Point, StretchCollector
from chainbuild.analysis.path.feeds import SpeedWatch, speeds_at
from chainbuild.analysis.path.limitwatch import LimitWatch
from chainbuild.analysis.path.motion import BETWEEN, Between, motion_of
from chainbuild.analysis.path.nearby import KindLows, Near, leaving, nearby
from chainbuild.analysis.path.places import PathMinimum, PathPlace, PathReport, PathSpeed, PathStretch, PathViolation
from chainbuild.analysis.singularity.measures import measure_batch, smallest_value
from chainbuild.analysis.singularity.names import NEAR, NEAR_FACTOR, sentence_at, vector_words
from chainbuild.analysis.singularity.speeds import speeds
from chainbuild.arrays import Matrix, Vector
from chainbuild.errors import ChainbuildError
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.progress import Progress, counting

_CHUNK: Final = 1024  # blocks worked on at a time: memory does not grow with the path
_SECONDS_A_MINUTE: Final = 60.0  # feeds are per minute, speeds per second


@dataclass(frozen=True, slots=True)
class PathOptions:
    """How a path is looked at.

    Attributes:
        near: Threshold of the functions of named singularities (`chainbuild.analysis.singularity.factors`).
        smallest: Threshold of the smallest scaled singular value, for robots without such functions.
        feed_mm_min: Speed of the tip [mm/min]; None: times and largest speeds are left out.
        tool_speed_mm: Speed of the tip at which the minima's axis speeds are given [mm/s; deg/s where it stands still];
            the feed where one is given.
    """

    near: float = NEAR_FACTOR
    smallest: float = NEAR
    feed_mm_min: float | None = None
    tool_speed_mm: float = 10.0

    @property
    def feed(self) -> float | None:
        """The feed in mm/s."""
        return None if self.feed_mm_min is None else self.feed_mm_min / _SECONDS_A_MINUTE

    def check(self) -> None:
        """Refuse values that make no sense.

        Raises:
            ChainbuildError: a threshold or a speed is not a finite number above 0, or `near` is 1 or more.
        """
        for name, value, most in (("near", self.near, 1.0), ("smallest", self.smallest, np.inf)):
            if not 0.0 < value < most:
                permitted = "a number above 0 and below 1" if most == 1.0 else "a finite number above 0"
                raise ChainbuildError("wrong threshold", parameter=name, permitted=permitted)
        for name, speed in (("feed", self.feed_mm_min), ("speed", self.tool_speed_mm)):
            if speed is not None and not (np.isfinite(speed) and speed > 0.0):
                raise ChainbuildError(f"wrong {name}", parameter=name, permitted="a finite number above 0")


DEFAULT_PATH: Final = PathOptions()  # the thresholds of names, no feed


def path_report(
    robot: Mechanism,
    rows: ArrayLike | Iterable[ArrayLike],
    *,
    between: Between = "ptp",
    options: PathOptions = DEFAULT_PATH,
    progress: Progress = False,
) -> PathReport:
    """Return what happens along a path: singularities, limits and speeds, between its rows, too.

    What is proven and what is sampled is listed in docs/paths.md; the report marks what was sampled.

    Args:
        robot: The robot.
        rows: (N, n_axes) axis values, mm and degrees, or an iterable of rows (n_axes,); a row of NaN interrupts the
            path.
        between: "ptp": axes change evenly between rows; "cp": the tip moves along a straight line and the tool turns
            about one axis (programmed by rotary axes: these change evenly); "rows": only the rows are looked at.
        options: Thresholds, feed and speed.
        progress: True: a bar on standard error; a function: called with the rows done and all rows.

    Raises:
        ChainbuildError: a wrong option, a row of the wrong length, or one with infinite values.
    """
    options.check()
    if between not in BETWEEN:
        raise ChainbuildError(f"unknown motion '{between}'", parameter="between", permitted=", ".join(BETWEEN))
    total = len(rows) if isinstance(rows, Sized) else 0
    walk = _Walk(robot, between, options)
    with counting(total, progress, "rows") as advance:
        for part in _parts(robot, rows):
            walk.take(part)
            advance(len(part))
    return walk.finish()


def _parts(robot: Mechanism, rows: ArrayLike | Iterable[ArrayLike]) -> Iterator[Matrix]:
    """Yield the rows in chunks (n, n_axes)."""
    count = len(robot.axes)
    source = iter(_as_rows(rows))
    while part := list(islice(source, _CHUNK)):
        try:
            values = np.array(part, dtype=float)
        except ValueError:
            values = np.empty(0)
        without = np.isnan(values).all(axis=1, keepdims=True) if values.ndim == 2 else np.empty(0)
        if values.ndim != 2 or values.shape[1] != count or not (np.isfinite(values) | without).all():
            raise ChainbuildError(f"expected finite axis values of shape (N, {count}), or rows of NaN")
        yield values


def _as_rows(rows: ArrayLike | Iterable[ArrayLike]) -> Iterable[ArrayLike]:
    """Return rows that can be gone through; a single row of numbers is one."""
    if isinstance(rows, np.ndarray):
        return np.atleast_2d(np.asarray(rows, float))
    if not isinstance(rows, (list, tuple)):
        return rows  # type: ignore[return-value]
    single = bool(rows) and all(np.ndim(value) == 0 for value in rows)
    return [np.asarray(rows, float)] if single else rows


@dataclass(slots=True, eq=False)
class _Walk:
    """What is known of a path up to a row."""

    robot: Mechanism
    between: Between
    options: PathOptions
    rows: int = 0
    way_mm: float = 0.0
    gaps: list[int] = field(default_factory=list)
    smallest: list[Vector] = field(default_factory=list)
    stretches: list[PathStretch] = field(default_factory=list)
    violations: list[PathViolation] = field(default_factory=list)
    leaves: list[PathPlace] = field(default_factory=list)
    collectors: dict[str, StretchCollector] = field(default_factory=dict)
    remarks: dict[str, None] = field(default_factory=dict)
    limits: LimitWatch = field(init=False)
    feeds: SpeedWatch | None = field(init=False)
    last: Vector | None = None
    alone: bool = False

    def __post_init__(self) -> None:
        self.limits = LimitWatch(self.robot.limits)
        self.feeds = None if self.options.feed is None else SpeedWatch(self.robot, self.options.feed)

    def take(self, part: Matrix) -> None:
        """Take the next rows."""
        known = np.isfinite(part).all(axis=1)
        measured = np.full(len(part), np.nan)
        measured[known] = measure_batch(self.robot, part[known]).smallest
        known &= np.isfinite(measured)  # the others have no pose
        self.smallest.append(measured)
        self.gaps += [self.rows + int(n) for n in np.flatnonzero(~known)]
        begin = 0
        for end in [*np.flatnonzero(~known).tolist(), len(part)]:
            run = part[begin:end]
            first = self.rows + begin
            if self.last is not None and begin == 0:
                run, first = np.concatenate([self.last[None], run]), first - 1
            if len(run):
                self._run(run, first)
            if end < len(part):
                self._interrupt(run, first)
            elif len(run):
                self.last = run[-1].copy()
            begin = end + 1
        self.rows += len(part)

    def _run(self, rows: Matrix, first: int) -> None:
        """Take rows without gaps, the first of them that of `last` if there is one."""
        if self.between == "rows":
            self._rows_alone(rows if self.last is None else rows[1:], first + (self.last is not None))
            return
        if len(rows) < 2:
            self.alone = self.alone or self.last is None
            return  # the next rows begin with it
        self.alone = False
        motion = motion_of(self.robot, rows, self.between)
        count = len(rows) - 1
        ways = motion.lengths(np.arange(count), np.ones(count))
        if not np.isfinite(ways).all():
            self.remarks["the way of blocks on which places have no pose is not counted"] = None
            ways = np.where(np.isfinite(ways), ways, 0.0)
        begins = self.way_mm + np.concatenate([[0.0], np.cumsum(ways[:-1])])
        chunk = BlockRun(motion, first, begins, self.options.feed)
        merged = _merged(nearby(motion, Near(self.options.near, self.options.smallest)))
        for kind in [*self.collectors, *(kind for kind in merged if kind not in self.collectors)]:
            found = merged.get(kind)
            if found is None:
                self.stretches += [self._stretch(one) for one in self.collectors[kind].finish()]
                continue
            collector = self.collectors.setdefault(kind, StretchCollector(found.kind))
            self.stretches += [self._stretch(one) for one in collector.take(chunk, found)]
            if not found.proven:
                self.remarks[self._sampled_words()] = None
        lows = [
            (block, part.least) for found in merged.values() for block, parts in found.parts.items() for part in parts
        ]
        close = np.array([block for block, _ in lows], dtype=np.intp), np.array([t for _, t in lows], dtype=float)
        self.violations += self.limits.take(chunk, np.unique(close[0]))
        if self.feeds is not None:
            self.feeds.take(chunk, ways, close)
        if self.between == "cp":
            self.leaves += [chunk.places([block], [t])[0] for block, t in leaving(motion)]
        self.way_mm += float(ways.sum())

    def _rows_alone(self, rows: Matrix, first: int) -> None:
        """Look at rows only: each is a block that stands still."""
        feed = None if self.between == "rows" else self.options.feed
        for n in range(len(rows)):
            still = motion_of(self.robot, rows[[n, n]], "ptp")
            chunk = BlockRun(still, first + n, np.full(1, self.way_mm), feed)
            merged = _merged(nearby(still, Near(self.options.near, self.options.smallest)))
            for found in merged.values():
                collector = StretchCollector(found.kind)
                grown = [*collector.take(chunk, found), *collector.finish()]
                self.stretches += [self._stretch(_at_begin(one)) for one in grown]
            violated = [*self.limits.take(chunk, np.empty(0, np.intp)), *self.limits.finish()]
            self.violations += [replace(one, end=one.begin, worst=one.begin) for one in violated]

    def _interrupt(self, run: Matrix, first: int) -> None:
        """End what the path is in; a row that stands alone between gaps is looked at for itself."""
        for collector in self.collectors.values():
            self.stretches += [self._stretch(one) for one in collector.finish()]
        self.violations += self.limits.finish()
        if self.alone:
            self._rows_alone(run[-1:], first + len(run) - 1)
        self.last, self.alone = None, False

    def _sampled_words(self) -> str:
        if self.between == "ptp":
            return "the axis map is not affine: singularities between rows are sampled"
        return "the pose alone does not tell what is singular: singularities between rows are sampled"

    def _stretch(self, found: Growing) -> PathStretch:
        minima = tuple(self._minimum(found, point) for point in found.minima)
        throughout = found.held and bool(found.zeros)
        of_vector = self.robot.chain.solves_linear_axes
        return PathStretch(found.kind, found.begin, found.end, minima, found.proven, throughout, of_vector)

    def _minimum(self, found: Growing, point: Point) -> PathMinimum:
        axes, speed = point.place.axes, self.options.feed or self.options.tool_speed_mm
        singular = point in found.zeros
        value = 0.0 if singular else point.value
        vector = self.between == "cp" and self.robot.chain.solves_linear_axes
        if vector or not np.isfinite(axes).all():
            # A vector turns on the great circle, not as the rotary axes do that `axes` shows.
            words = vector_words(self.robot, point.value) if vector else "no axis values are found there"
            return PathMinimum(point.place, value, np.nan, singular, words, (), (), speed)
        worst = speeds(self.robot, axes, speed)
        return PathMinimum(
            point.place,
            value,
            smallest_value(self.robot, axes),
            singular,
            sentence_at(self.robot, axes, found.kind, speed),
            speeds_at(self.robot, point, speed),
            (*worst.axes, *worst.drives),
            speed,
        )

    def finish(self) -> PathReport:
        """Return the report."""
        last = np.empty((0, len(self.robot.axes))) if self.last is None else self.last[None]
        self._interrupt(last, self.rows - 1)
        self.stretches.sort(key=lambda one: (one.begin.row, one.begin.share))
        self.violations.sort(key=lambda one: (one.begin.row, one.begin.share))
        made: tuple[PathSpeed, ...] = ()
        if self.feeds is not None:
            made = self.feeds.finish()
            if self.feeds.without_way:
                self.remarks[f"{self.feeds.without_way} blocks without a way of the tip have no feed"] = None
        feed = self.options.feed
        return PathReport(
            self.between, self.rows, self.way_mm, None if feed is None else self.way_mm / feed,
            tuple(self.stretches), tuple(self.violations), made, tuple(self.leaves), tuple(self.gaps),
            self.options.near, np.concatenate(self.smallest) if self.smallest else np.empty(0), tuple(self.remarks),
        )  # fmt: skip


def _merged(found: Iterable[KindLows]) -> dict[str, KindLows]:
    """Return what was found by kind; a kind found in two ways is proven if both are."""
    merged: dict[str, KindLows] = {}
    for one in found:
        before = merged.get(one.kind)
        if before is None:
            merged[one.kind] = one
        else:
            parts = {n: [*before.parts.get(n, []), *one.parts.get(n, [])] for n in chain(before.parts, one.parts)}
            merged[one.kind] = KindLows(
                one.kind, before.proven and one.proven, parts, max(before.singular, one.singular)
            )
    return merged


def _at_begin(one: Growing) -> Growing:
    """Return what was found on a block that stands still as found at its row."""
    zeros = [replace(point, place=one.begin) for point in one.zeros[:1]]
    return replace(one, end=one.begin, least=replace(one.least, place=one.begin), zeros=zeros)
