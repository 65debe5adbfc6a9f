"""One singularity: kind, axes and sentence."""

from __future__ import annotations

from dataclasses import dataclass

from chainbuild.analysis.singularity.structure import SingularityKind
from chainbuild.shown import fields_shown


@dataclass(frozen=True, slots=True)
class Singularity:
    """A singularity at or close to a position.

    Attributes:
        kind: "wrist", "elbow", "shoulder", "pole", "tilt_end"; of closed loops "strut", "platform", "twist" (see
            `chainbuild.chain.closing.Loss`); "other"; "gimbal_lock" of the pose angles and "dead_point" of a
            parallelogram lose no motion of the tool.
        alias: The manual's name where it has one: "alpha5", …; else an empty string.
        value: The function that vanishes there, without unit (`chainbuild.analysis.singularity.factors`).
        axes: Names of the axes concerned.
        condition: The geometric condition, as text.
        sentence: Condition, lost motion and required axis speed.
        remark: Difference from a manual's description; else an empty string.
    """

    __repr__ = fields_shown

    kind: SingularityKind
    alias: str
    value: float
    axes: tuple[str, ...]
    condition: str
    sentence: str
    remark: str = ""
