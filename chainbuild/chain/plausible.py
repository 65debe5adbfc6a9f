"""Doubts about the lengths of arms, the same for both dialects: warnings only, for a strange machine is still one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from chainbuild import tolerances
from chainbuild.errors import Span
from chainbuild.findings import Collector


@dataclass(frozen=True, slots=True)
class ArmLength:
    """A length that an arm cannot do without.

    Attributes:
        what: "the upper arm", "the second arm" … .
        parameter: Where the file gives it: "HD9 b2_to_b3_x".
        length_mm: Its size.
        span: Its place.
    """

    what: str
    parameter: str
    length_mm: float
    span: Span | None = None


def doubt_lengths(lengths: Sequence[ArmLength], collector: Collector) -> None:
    """Warn of main lengths of an arm that are 0, or far apart from each other."""
    for one in lengths:
        if one.length_mm == 0.0:
            text = f"{one.what} ({one.parameter}) has length 0: the axes at its ends coincide"
            collector.add("CB512", text, span=one.span, parameter=one.parameter)
    real = sorted((one for one in lengths if one.length_mm), key=lambda one: one.length_mm)
    if len(real) > 1 and real[-1].length_mm > tolerances.ARM_LENGTH_RATIO * real[0].length_mm:
        short, long = real[0], real[-1]
        text = f"{short.what} is {_mm(short.length_mm)} long and {long.what} {_mm(long.length_mm)}"
        hint = f"is the unit or the index of {short.parameter} or {long.parameter} right?"
        collector.add("CB513", text, span=short.span, parameter=short.parameter, hint=hint)


def doubt_reach(reach_mm: float, span: Span | None, hint: str, collector: Collector) -> None:
    """Warn of an arm whose lengths together are too short or too long for a machine; nothing is said of none at all.

    Args:
        reach_mm: Sum of its lengths.
        span: Place of a length.
        hint: What unit may have been mistaken.
        collector: Takes the finding.
    """
    least, most = tolerances.ARM_REACH_MM
    if reach_mm and not least <= reach_mm <= most:
        text = f"all lengths of the arm together are {_mm(reach_mm)}"
        collector.add("CB514", text, span=span, hint=hint, permitted=f"{least:g} to {most:g} mm is usual")


def _mm(length_mm: float) -> str:
    return f"{length_mm:.4g} mm" if length_mm < tolerances.ARM_REACH_MM[1] else f"{length_mm / 1000.0:.6g} m"
