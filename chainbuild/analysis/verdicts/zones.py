"""Parts of blocks on which the measure of a control is at or below a threshold.

| motion | measure                      | looked at                                                       |
|--------|------------------------------|-----------------------------------------------------------------|
| ptp    | one_minus_cosine             | the factors' own sums of cosines: proven                        |
| ptp    | product, determinant_squared | their product, which is a sum of cosines again: proven          |
| ptp    | smallest                     | parts where the product is low enough for it, sampled there     |
| cp     | one_minus_cosine             | the factors of the pose, traced in ever narrower parts: proven  |
| cp     | any other                    | parts where a factor is low, sampled there                      |

This holds for robots whose factors are their determinant; of others the smallest singular value stands for the factors,
and everything is sampled. Zones are as narrow as a millionth of a block: samples start from the zeros and minima of the
factors, so that no zero falls between two of them.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from chainbuild.analysis.path.motion import LineMotion, PathMotion, StraightMotion
from chainbuild.analysis.path.nearby import KindLows, Near, nearby
from chainbuild.analysis.vanishing.functions import SingularFunctions, singular_functions
from chainbuild.analysis.vanishing.line import LineBlocks, rotations_of
from chainbuild.analysis.vanishing.lows import Low, lows
from chainbuild.analysis.vanishing.waves import Waves
from chainbuild.analysis.verdicts.controlmeasure import factor_of_measure, joint_rows, measure_of_factor
from chainbuild.analysis.verdicts.sampledzones import ZoneSearch, joined, low_within, sampled_parts
from chainbuild.arrays import Matrix
from chainbuild.chain.axismap import AffineMap

_HALVINGS: Final = 3  # of all blocks at once, before those that are left are gone through one by one
_LEAST: Final = 1e-12  # of a measure: below it there is rounding only, and a threshold of 0 asks for this
_WIDE: Final = 0.1  # factor, 6 degrees: so wide a zone is not stepped over
_WIDE_SMALLEST: Final = 0.05  # smallest singular value likewise
_NARROWER: Final = 4.0  # step of thresholds: within a zone the next narrower one is not stepped over
_COLUMN: Final = 2.0  # squared norm of a scaled joint's column: a turn of 1, and a shift of at most the length


@dataclass(frozen=True, slots=True)
class Zones:
    """Parts of blocks at or below a threshold.

    Attributes:
        parts: Block → its parts, `Low.value` in the measure; blocks without are left out.
        proven: Whether none is missed for certain.
    """

    parts: dict[int, list[Low]]
    proven: bool


def zones(motion: PathMotion, measure: str, limit: float) -> Zones:
    """Return the parts of blocks on which a measure is at most a limit.

    Args:
        motion: Between rows without gaps.
        measure: Of `measure_in_force`.
        limit: Not below 0.
    """
    search = ZoneSearch(motion, measure, max(limit, _LEAST))
    known = singular_functions(motion.robot)
    if isinstance(motion, StraightMotion) and known.complete:
        if measure == "one_minus_cosine":
            return _of_factors(nearby(motion, Near(factor_of_measure(search.limit), search.limit)), search)
        product = _of_determinant(motion, known, _product_bound(search))
        if measure == "smallest":
            return Zones(sampled_parts(search, product), False)
        return Zones({n: [_squared(one, measure) for one in parts] for n, parts in product.items()}, True)
    if measure == "one_minus_cosine":
        return _narrowed(search)
    found = list(nearby(motion, Near(_wide_factor(search, known), _wide_smallest(search))))
    return Zones(sampled_parts(search, _by_block(found)), False)


def _product_bound(search: ZoneSearch) -> float:
    """Return what the product of the singular values is at most where the measure is at most its limit."""
    if search.measure != "smallest":
        return search.limit if search.measure == "product" else float(np.sqrt(search.limit))
    robot = search.motion.robot
    axis_map = robot.chain.axis_map
    assert isinstance(axis_map, AffineMap)
    moving = [n for n, axis in enumerate(robot.axes) if not axis.held]
    norm = _COLUMN * float((np.abs(axis_map.A[:, moving]).sum(axis=0) ** 2).sum())
    # All but the smallest multiply to the most where they are alike.
    others = max(len(moving) - 1, 1)
    return search.limit * float((norm / others) ** (others / 2.0))


def _wide_factor(search: ZoneSearch, known: SingularFunctions) -> float:
    """Return a threshold of the factors: where the measure is low, one of them is below it."""
    if not known.complete:
        return _WIDE
    lowest = float((_product_bound(search) / known.constant) ** (1.0 / len(known.functions)))
    return min(max(lowest, _WIDE), 1.0)


def _wide_smallest(search: ZoneSearch) -> float:
    """Return a threshold of the smallest singular value likewise."""
    count = 1 if search.measure == "smallest" else sum(not axis.held for axis in search.motion.robot.axes)
    power = 0.5 if search.measure == "determinant_squared" else 1.0
    return max(float(search.limit ** (power / count)), _WIDE_SMALLEST)


def _squared(low: Low, measure: str) -> Low:
    return replace(low, value=low.value**2) if measure == "determinant_squared" else low


def _of_determinant(motion: StraightMotion, known: SingularFunctions, limit: float) -> dict[int, list[Low]]:
    function = motion.robot.prepared("singular determinant", known.determinant)
    waves = Waves.along(function, joint_rows(motion.robot, motion.rows))
    found = {int(n): lows(waves.block(n), limit) for n in waves.not_clear(limit, _HALVINGS)}
    return {n: parts for n, parts in found.items() if parts}


def _by_block(found: Iterable[KindLows]) -> dict[int, list[Low]]:
    by_block: dict[int, list[Low]] = {}
    for one in found:
        for block, parts in one.parts.items():
            by_block.setdefault(block, []).extend(parts)
    return by_block


def _of_factors(found: Iterable[KindLows], search: ZoneSearch) -> Zones:
    """Return the parts of named kinds, each value in the measure; those of the smallest singular value are sampled."""
    parts: dict[int, list[Low]] = {}
    proven = True
    for one in found:
        proven = proven and one.proven and one.kind != "other"
        if one.kind == "other":
            own = sampled_parts(search, one.parts)
        else:
            own = {
                n: [replace(low, value=measure_of_factor(low.value)) for low in all_] for n, all_ in one.parts.items()
            }
        for block, more in own.items():
            parts.setdefault(block, []).extend(more)
    return Zones({block: joined(own) for block, own in parts.items()}, proven)


def _narrowed(search: ZoneSearch) -> Zones:
    """Return the parts along lines: the widest zone first, then narrower ones within it."""
    motion, target = search.motion, factor_of_measure(search.limit)
    assert isinstance(motion, LineMotion)
    level = max(target, _WIDE)
    found = list(nearby(motion, Near(level, _WIDE_SMALLEST)))
    while level > target:
        level = max(level / _NARROWER, target)
        found = [one if one.kind == "other" else _within(motion, one, level) for one in found]
    return _of_factors(found, search)


def _within(motion: LineMotion, wide: KindLows, level: float) -> KindLows:
    """Return the parts of one kind at or below a level, within wider ones."""
    pieces = [
        (block, begin, end)
        for block, parts in wide.parts.items()
        for low in parts
        for begin, end in itertools.pairwise(sorted({low.begin, *low.zeros, low.least, low.end}))
    ]
    if not pieces:
        return wide
    blocks = np.array([block for block, _, _ in pieces])
    begins, ends = np.array([p[1] for p in pieces]), np.array([p[2] for p in pieces])
    # Each piece is a block between the rows of its own, which tell the branch; between two stands one that rests.
    rows = motion.rows[np.stack([blocks, blocks + 1], axis=1).ravel()]
    lines = motion.lines
    turned = lines.rotations[blocks] @ rotations_of(begins[:, None] * lines.turns[blocks])
    origins = lines.origins[blocks] + begins[:, None] * lines.ways[blocks]
    share = (ends - begins)[:, None]
    apart = LineBlocks(
        np.repeat(origins, 2, axis=0)[:-1],
        _with_rests(share * lines.ways[blocks]),
        np.repeat(turned, 2, axis=0)[:-1],
        _with_rests(share * lines.turns[blocks]),
    )
    found: dict[int, list[Low]] = {}
    for one in nearby(LineMotion(motion.robot, rows, apart), Near(level, _WIDE_SMALLEST)):
        if one.kind != wide.kind:
            continue
        for piece in sorted(piece for piece in one.parts if piece % 2 == 0):
            block, begin, end = pieces[piece // 2]
            found.setdefault(block, []).extend(low_within(low, begin, end) for low in one.parts[piece])
    return replace(wide, parts={block: joined(parts) for block, parts in found.items()})


def _with_rests(moves: Matrix) -> Matrix:
    """Return moves (n, 3) with one of 0 between each two: (2n - 1, 3)."""
    found = np.zeros((2 * len(moves) - 1, 3))
    found[::2] = moves
    return found
