"""What an inverse-kinematics solver returns."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields, make_dataclass, replace
from typing import Any, Final, Literal, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from chainbuild.chain.elements import Task
from chainbuild.html import html_table
from chainbuild.shown import angle_shown, axes_shown, length_shown, number, two_lines
from chainbuild.units import AxisLabels, Units

Status = Literal["ok", "unreachable", "limits", "stalled"]
_Made = TypeVar("_Made", bound="AxisValues")
STATUSES: Final[tuple[Status, ...]] = ("ok", "limits", "stalled", "unreachable")  # by the outcome of a search


class AxisValues:
    """Axis values that know whose they are: what results of one pose and of many have in common."""

    __slots__ = ()

    axes: NDArray[np.float64]
    labels: AxisLabels

    @property
    def units(self) -> Units:
        """Those of `axes`: "controller", mm and degrees, or "si", metres and radians."""
        return self.labels.units

    def to(self, units: Units) -> Self:
        """Return the same with its axis values in other units.

        Raises:
            ChainbuildError: there are no such units.
        """
        labels = self.labels.to(units)
        if labels is self.labels:
            return self
        factors = np.divide(labels.factors, self.labels.factors)
        return replace(self, axes=self.axes * factors, labels=labels)  # type: ignore[type-var]


@dataclass(frozen=True, slots=True, eq=False)
class IkResult(AxisValues):
    """Axis values for a pose, or the best found and the reason of failure.

    Attributes:
        success: True if the pose is met within tolerance and all limits are kept.
        axes: (n_axes,) axis values, mm and degrees; on failure the best found.
        status: "ok"; "unreachable": the pose is beyond the reach of the chain with its linear axes inside their
            limits, or no axis values were found for it even without limits; "limits": only values outside the
            limits were found; "stalled": the budget ended close to the pose.
        position_error: Distance between the requested and the reached pose [m].
        rotation_error: Angle between them [rad]; that of the tool vector if the task is not a full pose.
        iterations: Steps taken over all starts.
        restarts: Starts after the first.
        task: "pose", "direction" or "position": what was solved for.
        labels: Names and units of the axis values.
        reason: Why it failed, as text; empty on success.
        violated: With status "limits", where it is known: the names of the limits in the way.
    """

    success: bool
    axes: NDArray[np.float64]
    status: Status
    position_error: float
    rotation_error: float
    iterations: int
    restarts: int
    task: Task
    labels: AxisLabels
    reason: str = ""
    violated: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return two_lines(f"<{type(self).__name__} {self._in_words()}>")

    def _in_words(self) -> str:
        missed = f"off by {length_shown(self.position_error)}, {angle_shown(self.rotation_error)}"
        why = f"; {self.reason}" if self.reason else ""
        return f"{self.status}: {axes_shown(self.labels, self.axes)}; {missed}{why}"

    def _repr_html_(self) -> str:
        return html_table(*axes_rows(self.labels, [self]), html_caption(self.status, self.reason))


def quick_constructor(cls: type[_Made]) -> Callable[..., _Made]:
    """Return a function that makes what cls(*values) makes, in a third of the time.

    A frozen dataclass writes each attribute around its own ban. Here a class of the same layout without it writes them,
    and what it made becomes one of cls.

    Args:
        cls: A frozen dataclass with slots that is a kind of `AxisValues`.
    """
    own = [(each.name, each.type, each) for each in fields(cls)]  # type: ignore[arg-type]
    writable = make_dataclass(cls.__name__, own, bases=(AxisValues,), slots=True, eq=False)

    def make(*values: Any) -> _Made:
        made: Any = writable(*values)
        made.__class__ = cls
        result: _Made = made
        return result

    return make


# Every call of inverse kinematics makes one, which takes up to a tenth of it.
quick_result: Final = quick_constructor(IkResult)


def axes_rows(labels: AxisLabels, results: Iterable[IkResult]) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Return titles and rows of a table of results."""
    axes = (f"{name} [{unit}]" for name, unit in zip(labels.names, labels.units_of_axes, strict=True))
    head = (*axes, "Status", "Position error", "Rotation error")
    rows = []
    for one in results:
        missed = length_shown(one.position_error), angle_shown(one.rotation_error)
        rows.append((*(number(float(value)) for value in one.axes), one.status, *missed))
    return head, rows


def html_caption(*parts: str) -> str:
    """Return what stands above a table of results."""
    return ": ".join(part for part in parts if part)
