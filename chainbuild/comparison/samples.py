"""Axis values for a comparison: random, on a grid, and at singularities of arms and heads."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, get_args

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.axismap import random_axis_values
from chainbuild.chain.closing import strut_range
from chainbuild.errors import ChainbuildError
from chainbuild.shown import fields_shown

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Mechanism

SampleKind = Literal["random", "grid", "singular", "recorded"]
MADE_KINDS: Final = tuple(kind for kind in get_args(SampleKind) if kind != "recorded")

_WIDEST_LINEAR_MM: Final = 500.0  # of axes without given limits
_WIDEST_ROTARY_DEG: Final = 180.0  # one turn shows all poses
_REDRAWN: Final = 20  # times that random samples are drawn again: enough where a tenth of them keeps all limits
_SPECIAL_DEG: Final = (0.0, 90.0, -90.0, 180.0, -180.0)  # where solvers divide by zero or take the other branch


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """Axis values.

    Attributes:
        axes: (n, n_axes) mm and degrees.
        kinds: (n,) the kind of each.
    """

    __repr__ = fields_shown

    axes: Vector
    kinds: tuple[SampleKind, ...]

    def __len__(self) -> int:
        return len(self.kinds)


def make_samples(robot: Mechanism, count: int, kinds: Sequence[str] = MADE_KINDS, seed: int = 0) -> Samples:
    """Return axis values inside the limits, the count shared among the kinds.

    Args:
        robot: The robot.
        count: Number in all, at least one per kind.
        kinds: Of "random", "grid", "singular".
        seed: Seed of the samples.

    Raises:
        ChainbuildError: an unknown kind, or a count below 1.
    """
    unknown = [kind for kind in kinds if kind not in MADE_KINDS]
    if unknown or not kinds or count < 1:
        what = f"unknown samples '{unknown[0]}'" if unknown else "no samples requested: expected at least 1"
        raise ChainbuildError(what, parameter="samples", permitted=", ".join(MADE_KINDS))
    rng = np.random.default_rng(seed)
    share = max(1, count // len(kinds))
    makers = {"random": random_samples, "grid": grid_samples, "singular": singular_samples}
    rows: list[Vector] = []
    names: list[SampleKind] = []
    for kind in dict.fromkeys(kinds):
        made = _usable(robot, makers[kind](robot, share, rng))
        for _ in range(_REDRAWN if kind == "random" else 0):
            if len(made) == share:
                break
            made = np.vstack([made, _usable(robot, random_samples(robot, share, rng))])[:share]
        rows.append(made)
        names += [kind] * len(made)  # type: ignore[list-item]
    return Samples(np.vstack(rows), tuple(names))


def _usable(robot: Mechanism, axes: Vector) -> Vector:
    """Return the rows that keep the limits on several axes and on drives, too, and have a finite pose."""
    kinematics = robot.kinematics
    inside: Vector = axes[robot.limits.inside_rows(axes)]
    finite = [bool(np.isfinite(kinematics.pose(robot.chain.axis_map.q(row)).homogeneous).all()) for row in inside]
    kept: Vector = inside[np.array(finite, dtype=bool)]
    return kept


def _range(robot: Mechanism) -> tuple[Vector, Vector]:
    """Return the range of samples: what the limits ever leave of each axis, or a usual range if there are none."""
    lower, upper = [], []
    for n, axis in enumerate(robot.axes):
        wide = _WIDEST_LINEAR_MM if axis.kind == "linear" else _WIDEST_ROTARY_DEG
        assumed = axis.assumed or axis.endless
        low, high = strut_range(robot.chain, n) or axis.range
        lower.append(max(low, -wide) if assumed else low)
        upper.append(min(high, wide) if assumed else high)
    return np.array(lower), np.array(upper)


def random_samples(robot: Mechanism, count: int, rng: np.random.Generator) -> Vector:
    """Return axis values drawn uniformly from the limits."""
    return random_axis_values(robot.chain.axis_map, rng, *_range(robot), count)


def grid_samples(robot: Mechanism, count: int, rng: np.random.Generator) -> Vector:
    """Return points of a regular grid over the limits; where it has more, an even choice of them."""
    lower, upper = _range(robot)
    points = max(2, round(count ** (1.0 / len(lower))))
    steps = [np.linspace(low, high, points) for low, high in zip(lower, upper, strict=True)]
    size = points ** len(lower)
    chosen = np.arange(size) if size <= count else np.sort(rng.choice(size, count, replace=False))
    places = np.unravel_index(chosen, (points,) * len(lower))
    return np.column_stack([step[place] for step, place in zip(steps, places, strict=True)])


def singular_samples(robot: Mechanism, count: int, rng: np.random.Generator) -> Vector:
    """Return random values with one or two axes at 0, ±90, ±180 degrees or a limit."""
    lower, upper = _range(robot)
    special = []
    for n, axis in enumerate(robot.axes):
        places = [0.0] if axis.kind == "linear" else list(_SPECIAL_DEG)
        inside = [place for place in places if lower[n] <= place <= upper[n]]
        special += [(n, place) for place in dict.fromkeys([*inside, float(lower[n]), float(upper[n])])]
    single = [[one] for one in special]
    pairs = [[one, other] for one, other in itertools.combinations(special, 2) if one[0] != other[0]]
    order = [*single, *(pairs[n] for n in rng.permutation(len(pairs)))]
    rows = random_samples(robot, count, rng)
    for row, settings in zip(rows, itertools.cycle(order), strict=False):
        for n, place in settings:
            row[n] = place
    return rows
