"""What a control makes of a path close to singularities."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

from chainbuild.analysis.path.places import PathPlace, PathSpeed
from chainbuild.analysis.verdicts.thresholds import Level
from chainbuild.shown import fields_shown, two_lines


@dataclass(frozen=True, slots=True, eq=False)
class VerdictPart:
    """A part of a block at or below a threshold.

    Attributes:
        begin: First place.
        end: Last place.
        least: Where the measure is least.
        value: The measure there.
    """

    __repr__ = fields_shown

    begin: PathPlace
    end: PathPlace
    least: PathPlace
    value: float

    @property
    def length_mm(self) -> float:
        """Way of the tip over it [mm]."""
        return self.end.path_mm - self.begin.path_mm


@dataclass(frozen=True, slots=True, eq=False)
class BlockVerdict:
    """The verdict on the block between two rows.

    Attributes:
        row: The row it begins at, from 0.
        level: "singular": at or below SD41670 somewhere; "watched": below SD41671 only.
        parts: Its singular parts, or its watched ones, in order.
        length_mm: Way of the tip over the whole block.
        alarm: 75327 or 10911; None: no alarm.
    """

    __repr__ = fields_shown

    row: int
    level: Level
    parts: tuple[VerdictPart, ...]
    length_mm: float
    alarm: int | None

    @property
    def value(self) -> float:
        """The least value of the measure on the block."""
        return min(part.value for part in self.parts)


@dataclass(frozen=True, slots=True, eq=False)
class SingularityVerdicts:
    """What a control makes of a path close to singularities (ROBX manual 10).

    Attributes:
        between: Motion between rows.
        rows: Number of rows.
        measure: What is compared with the thresholds, of the choices of convention `singularity_measure`.
        singular_block: What alarm 75327 counts: choice of convention `singular_block`.
        threshold: SD41670, the file's or the manual's recommendation.
        clearance: SD41671 likewise.
        handled: Whether the control handles singular blocks of this kinematic.
        sentence: What was compared with what; why the function does not exist, and what holds instead.
        blocks: Verdicts on the blocks close to a singularity, in order.
        excessive: Axes and drives that need more than they can at the given feed, which raises 10910; only where
            singular blocks are not handled.
        proven: Whether no block is missed for certain; else some were searched by samples.
        remarks: Notes.
    """

    between: Literal["ptp", "cp"]
    rows: int
    measure: str
    singular_block: str
    threshold: float
    clearance: float
    handled: bool
    sentence: str
    blocks: tuple[BlockVerdict, ...]
    excessive: tuple[PathSpeed, ...]
    proven: bool
    remarks: tuple[str, ...] = ()

    def __repr__(self) -> str:
        counts = [f"{sum(b.level == level for b in self.blocks)} {level}" for level in ("singular", "watched")]
        alarms = ", ".join(map(str, self.alarms)) or "none"
        return two_lines(
            f"<SingularityVerdicts on {self.rows} rows ({self.between}) by {self.measure}: {', '.join(counts)} blocks,"
            f" alarms: {alarms}>"
        )

    @property
    def alarms(self) -> tuple[int, ...]:
        """The alarms, each once, in rising order."""
        found = {block.alarm for block in self.blocks if block.alarm is not None}
        return tuple(sorted(found | ({EXCESSIVE_SPEED_ALARM} if self.excessive else set())))


BLOCK_TOO_LONG_ALARM: Final = 75327  # ROBX manual 10.3, 11.5
POLE_ALARM: Final = 10911  # ROBX manual 10.1.4.2: travel through the pole
EXCESSIVE_SPEED_ALARM: Final = 10910  # ROBX manual 10.1.4.2: irregular velocity run in a path axis
