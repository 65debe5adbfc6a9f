"""A named pose: axis values that somebody gave a name."""

from __future__ import annotations

from dataclasses import dataclass

from chainbuild.shown import fields_shown


@dataclass(frozen=True, slots=True)
class NamedPose:
    """Axis values with a name, such as the position in which a machine is parked.

    Attributes:
        name: A letter, then letters, digits, spaces, `_`, `.` and `-`.
        axes: (n_axes,) axis values, mm and degrees.
    """

    __repr__ = fields_shown

    name: str
    axes: tuple[float, ...]
