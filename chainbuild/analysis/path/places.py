"""What is found on a path: places, stretches, minima, violated limits, speeds."""

from __future__ import annotations

from dataclasses import dataclass

from chainbuild.analysis.path.motion import Between
from chainbuild.analysis.singularity.speeds import AxisSpeed
from chainbuild.analysis.singularity.structure import SingularityKind
from chainbuild.arrays import Vector
from chainbuild.shown import fields_shown, two_lines


@dataclass(frozen=True, slots=True, eq=False)
class PathPlace:
    """A place on a path.

    Attributes:
        row: The row before it, from 0.
        share: Share of the way to the next row, 0 … 1.
        axes: (n_axes,) axis values there, mm and degrees; not a number where none are found.
        path_mm: Way of the tip from the first row [mm].
        seconds: Time from the first row at the given feed; None: no feed.
    """

    __repr__ = fields_shown

    row: int
    share: float
    axes: Vector
    path_mm: float
    seconds: float | None = None

    @property
    def label(self) -> str:
        """The place as tables count rows, from 1: "3" or "3 + 0.412"."""
        shown = f"{self.share:.6g}"  # of a share next to 1 nothing is left to show
        if not 0.0 < float(shown) < 1.0:
            return f"{self.row + 1 + round(self.share)}"
        return f"{self.row + 1} + {shown}"


@dataclass(frozen=True, slots=True, eq=False)
class PathMinimum:
    """Where a path is closest to a singularity.

    Attributes:
        place: Where.
        value: The function of the kind there (`chainbuild.analysis.singularity.factors`), 0 at the singularity; of kind
            "other" the smallest scaled singular value.
        smallest: The smallest scaled singular value; not a number where there are no axis values.
        singular: Whether it lies in the singularity, up to rounding.
        sentence: What it is, in words.
        speeds: Speeds that the motion itself needs of axes and drives, at `tool_speed`.
        worst: Those of a motion in the worst direction for each axis.
        tool_speed: mm/s of the tip; deg/s of the tool where the tip stands still.
    """

    __repr__ = fields_shown

    place: PathPlace
    value: float
    smallest: float
    singular: bool
    sentence: str
    speeds: tuple[AxisSpeed, ...]
    worst: tuple[AxisSpeed, ...]
    tool_speed: float


@dataclass(frozen=True, slots=True, eq=False)
class PathStretch:
    """A part of a path on which the function of one singularity is at or below its threshold.

    Attributes:
        kind: "wrist", "elbow", "shoulder", "pole"; "other": the smallest singular value.
        begin: First place.
        end: Last place.
        minima: Where it is singular, or closest to it, in order.
        proven: Whether it is certain that no such part was missed; else it was sampled.
        throughout: Whether it is singular all the way.
        of_vector: Whether it matters only to a tool vector as the target: with rotary axes programmed nothing is lost.
    """

    __repr__ = fields_shown

    kind: SingularityKind
    begin: PathPlace
    end: PathPlace
    minima: tuple[PathMinimum, ...]
    proven: bool
    throughout: bool = False
    of_vector: bool = False

    @property
    def length_mm(self) -> float:
        """Way of the tip over it [mm]."""
        return self.end.path_mm - self.begin.path_mm

    @property
    def seconds(self) -> float | None:
        """Its time at the given feed; None: no feed."""
        if self.begin.seconds is None or self.end.seconds is None:
            return None
        return self.end.seconds - self.begin.seconds


@dataclass(frozen=True, slots=True, eq=False)
class PathViolation:
    """A part of a path on which a limit of an axis, a sum of axes or a drive is violated.

    Attributes:
        name: What is limited.
        begin: First place.
        end: Last place.
        worst: Where it is farthest beyond.
        excess: By how much [mm, deg].
        words: What is wrong there.
        proven: Whether no other part of the path violates it for certain; else it was sampled.
    """

    __repr__ = fields_shown

    name: str
    begin: PathPlace
    end: PathPlace
    worst: PathPlace
    excess: float
    words: str
    proven: bool


@dataclass(frozen=True, slots=True, eq=False)
class PathSpeed:
    """The largest speed that a path needs of an axis or a drive, at the given feed.

    Attributes:
        speed: How much, beside what it can.
        place: Where.
        begin: Begin of the first block that needs more than it can; None: none does.
        end: End of the last one.
    """

    __repr__ = fields_shown

    speed: AxisSpeed
    place: PathPlace
    begin: PathPlace | None = None
    end: PathPlace | None = None


@dataclass(frozen=True, slots=True, eq=False)
class PathReport:
    """What happens on a path, between its rows, too.

    Attributes:
        between: PathMotion between rows: "ptp", "cp" or "rows" (nothing between them was looked at).
        rows: Number of rows.
        length_mm: Way of the tip [mm].
        seconds: Time at the given feed; None: no feed. Blocks without a way of the tip take none.
        stretches: Parts close to a singularity, in order.
        violations: Parts outside limits, in order.
        speeds: Largest speeds at the given feed, by axis, then by drive; empty: no feed.
        leaves: Places at which a line leaves the reach of the arm.
        gaps: Rows without axis values or without a pose, from 0.
        near: Threshold of the functions of named kinds.
        smallest: (rows,) smallest scaled singular value at the rows; not a number at gaps.
        remarks: What was sampled, and other notes.
    """

    between: Between
    rows: int
    length_mm: float
    seconds: float | None
    stretches: tuple[PathStretch, ...]
    violations: tuple[PathViolation, ...]
    speeds: tuple[PathSpeed, ...]
    leaves: tuple[PathPlace, ...]
    gaps: tuple[int, ...]
    near: float
    smallest: Vector
    remarks: tuple[str, ...] = ()

    def __repr__(self) -> str:
        parts = f"{len(self.stretches)} stretches close to singularities, {len(self.violations)} outside limits"
        return two_lines(f"<PathReport of {self.rows} rows ({self.between}), {self.length_mm:.6g} mm: {parts}>")

    @property
    def proven(self) -> bool:
        """Whether nothing was sampled."""
        return not self.remarks and self.between != "rows"
