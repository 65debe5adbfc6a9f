"""Branches of a machine with one axis too many: the redundant axis stands at samples of its range."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from chainbuild.arrays import Indices, Integers, Vector
from chainbuild.chain.names import axis_index
from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.core.branches import Branches
from chainbuild.ik.request import Held, held_by_name
from chainbuild.kinematics.mechanism import Mechanism

Redundant = str | Sequence[str]  # name of the redundant axis, or names of several

REDUNDANT_SAMPLES: Final = 12  # values of a redundant axis: 30° apart on a whole turn
_MAX_COMBINATIONS: Final = 10_000  # of the values of several redundant axes


def held_samples(
    mechanism: Mechanism, redundant: Redundant, samples: int, held: Held | None, start: Vector | None
) -> list[dict[str, float]]:
    """Return what is held, for each combination of the values of redundant axes, mm and degrees.

    The values are spread evenly over the limits, both ends included; over a whole turn where an axis is endless or its
    range is one, then without the second end. The value of the start comes in addition.

    Args:
        mechanism: The mechanism.
        redundant: Name of the redundant axis, or names of several.
        samples: Number of values of each.
        held: What is held besides, as for `ik_all`.
        start: (n_axes,) mm and degrees, or None.

    Raises:
        AxisValueError: held has a wrong number of values, an unknown name, or names an axis twice.
        ChainbuildError: an unknown axis, one that is held, or too many values.
    """
    names = (redundant,) if isinstance(redundant, str) or not isinstance(redundant, Sequence) else tuple(redundant)
    if not names:
        raise ChainbuildError("no redundant axis is named", parameter="redundant", permitted="one or more")
    known = held_by_name(mechanism, held)
    if not isinstance(samples, int) or isinstance(samples, bool) or not 1 <= samples <= _MAX_COMBINATIONS:
        raise ChainbuildError(f"samples is {samples!r}", parameter="samples", permitted=f"1 … {_MAX_COMBINATIONS}")
    columns: dict[int, list[float]] = {}
    for name in names:
        n = axis_index(mechanism.axes, name) if isinstance(name, str) else None
        if n is None or n in columns:
            said = f"there is no axis {name!r}" if n is None else f"'{name}' is named twice"
            permitted = ", ".join(mechanism.labels.names)
            raise ChainbuildError(said, parameter="redundant", permitted=permitted)
        if mechanism.labels.names[n] in known:
            text = f"axis {name} is both held and redundant"
            raise ChainbuildError(text, parameter="redundant", permitted="one of them")
        columns[n] = _values(mechanism, n, samples, None if start is None else float(start[n]))
    count = int(np.prod([len(values) for values in columns.values()]))
    if count > _MAX_COMBINATIONS:
        text = f"{count} combinations of values"
        raise ChainbuildError(text, parameter="redundant", permitted=f"up to {_MAX_COMBINATIONS}")
    axes = [mechanism.labels.names[n] for n in columns]
    return [{**known, **dict(zip(axes, row, strict=True))} for row in itertools.product(*columns.values())]


def _values(mechanism: Mechanism, n: int, samples: int, own: float | None) -> list[float]:
    axis, (lower, upper) = mechanism.axes[n], mechanism.axes[n].range
    whole = axis.kind == "rotary" and (axis.endless or upper - lower >= 360.0)
    if whole:
        middle = 0.0 if axis.endless else 0.5 * (lower + upper)
        lower, upper = middle - 180.0, middle + 180.0
    if samples == 1:
        lower = 0.5 * (lower + upper)
    row: list[float] = np.linspace(lower, upper, samples, endpoint=not whole).tolist()
    return row if own is None or own in row else [own, *row]


def joined_branches(parts: Sequence[Branches], x0: Vector) -> Branches:
    """Return the branches of several held values as one, nearest to a start first.

    Args:
        parts: Branches of each, at least one.
        x0: (n_axes,) start in SI.
    """
    first = parts[0]
    axes = np.concatenate([part.axes for part in parts])
    order = np.argsort(np.linalg.norm(axes * first.labels.to("si").factors - x0, axis=1), kind="stable")
    free = [names for part in parts for names in part.free_axes]
    directions = [one for part in parts for one in part.free_directions]
    return replace(
        first,
        axes=axes[order],
        position_error=np.concatenate([part.position_error for part in parts])[order],
        rotation_error=np.concatenate([part.rotation_error for part in parts])[order],
        iterations=np.concatenate([part.iterations for part in parts])[order],
        free_axes=tuple(free[n] for n in order),
        free_directions=tuple(directions[n] for n in order),
        status_bits=_bits([part.status_bits for part in parts], order),
        turn_bits=_bits([part.turn_bits for part in parts], order),
    )


def _bits(columns: Sequence[Integers | None], order: Indices) -> Integers | None:
    known = [column for column in columns if column is not None]
    return np.concatenate(known)[order] if known else None
