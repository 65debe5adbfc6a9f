"""Self-collision along paths, with a bound that covers the motion between samples.

Between two rows the axes move along a straight line, or the tip does: then the way is cut into pieces along which the
axes are nearly straight (`chainbuild.analysis.collision.pieces`), and what is said of them is sampled. A pair of bodies
at distance d cannot touch before one of the joints between them has moved them by d together: joint j moves a body by
at most |dq_j|·r_j, r_j the largest distance of any of its points from the joint's line. The next step is therefore as
long as the smallest distance allows.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.analysis.collision.pieces import line_pieces
from chainbuild.analysis.path.motion import BETWEEN, Between
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.elements import BASE_LINK, Chain
from chainbuild.chain.fold import drawn, drawn_values
from chainbuild.collision.model import CollisionModel, LinkPair, bodies_of
from chainbuild.errors import ChainbuildError
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.progress import Progress, counted, counting
from chainbuild.shown import length_shown, numbers_shown, two_lines

# Bodies closer than this count as touching: without it the steps towards a contact would never end.
CONTACT: Final = 1e-5
_SHORTEST_STEP: Final = 1e-7  # share of a segment
# Positions of a step at which a nonlinear map is asked how far the joints are from its start.
_NONLINEAR_SAMPLES: Final = 8
_NONLINEAR_MARGIN: Final = 1.5  # for what joints may move beyond that between two of them


@dataclass(frozen=True, slots=True, eq=False)
class Contact:
    """The first place of a segment at which a pair touches or comes too close.

    Attributes:
        row: First row of the segment, from 0.
        share: Place on the segment, 0 … 1.
        axes: (n_axes,) axis values there, mm and degrees.
        pair: Names of the bodies.
        distance: Their distance [m].
    """

    row: int
    share: float
    axes: Vector
    pair: LinkPair
    distance: float

    def __repr__(self) -> str:
        where = f"row {self.row}" if self.share == 0.0 else f"{self.share:.1%} behind row {self.row}"
        distance = f"{length_shown(self.distance)} apart at {numbers_shown(self.axes)}"
        return two_lines(f"<Contact {where}: {' – '.join(self.pair)}, {distance}>")


def first_contact(
    robot: Mechanism, path: ArrayLike, *, clearance: float = 0.0, bodies: CollisionModel | None = None
) -> Contact | None:
    """Return where a path first collides, or None where it certainly does not; see `contacts`."""
    return next(contacts(robot, path, clearance=clearance, bodies=bodies), None)


def contacts(
    robot: Mechanism,
    path: ArrayLike,
    *,
    clearance: float = 0.0,
    bodies: CollisionModel | None = None,
    between: Between = "ptp",
    progress: Progress = False,
) -> Iterator[Contact]:
    """Yield the first contact of each segment of a path that has one.

    None is missed where the axes are straight between the rows and the axis map is affine; `collision_remarks` tells
    what is sampled.

    Args:
        robot: The robot.
        path: (N, n_axes) axis values, mm and degrees.
        clearance: Smallest permitted distance [m].
        bodies: Its bodies and the pairs watched; None: all pairs that can collide.
        between: "ptp": straight lines of the axes in between; "cp": of the tip; "rows": only the rows are looked at.
        progress: True: a bar on standard error; a function: called with the rows done and all rows.

    Raises:
        ChainbuildError: the path has the wrong shape or is not finite, the clearance is negative, or the bodies are
            another robot's.
    """
    model = bodies_of(robot, bodies)
    rows = np.atleast_2d(np.asarray(path, dtype=float))
    if rows.shape[1] != len(model.robot.axes) or not np.isfinite(rows).all():
        raise ChainbuildError(f"expected a path of finite axis values of shape (N, {len(model.robot.axes)})")
    check_clearance(clearance)
    if between not in BETWEEN:
        raise ChainbuildError(f"unknown motion '{between}'", parameter="between", permitted=", ".join(BETWEEN))
    if not model.pairs:
        return
    if between == "cp" and len(rows) > 1:
        yield from _on_lines(model, rows, clearance, progress)
        return
    walk = _ConservativeAdvancement(model, rows, clearance)
    alone = between == "rows" or len(rows) == 1
    count = len(rows) if alone else len(rows) - 1
    for row in counted(range(count), count, progress, "rows"):
        found = walk.place(row) if alone else walk.segment(row)
        if found is not None:
            yield found


def _on_lines(model: CollisionModel, rows: Matrix, clearance: float, progress: Progress) -> Iterator[Contact]:
    """Yield the contacts of the segments of a path along which the tip moves on lines."""
    done, last = -1, 0
    with counting(len(rows) - 1, progress, "rows") as advance:
        for part in line_pieces(model.robot, rows):
            advance(part.block - last)
            last = part.block
            if part.block == done:
                continue
            walk = _ConservativeAdvancement(model, part.axes, clearance)
            found = next(filter(None, map(walk.segment, range(len(part.shares) - 1))), None)
            if found is not None:
                done = part.block
                begin, end = part.shares[found.row : found.row + 2].tolist()
                yield replace(found, row=done, share=begin + found.share * (end - begin))


def collision_remarks(robot: Mechanism, between: Between) -> tuple[str, ...]:
    """Return what `contacts` samples on such a path, in words; empty: nothing is missed.

    Args:
        robot: The robot.
        between: What happens between rows.
    """
    remarks = []
    if between == "rows":
        remarks.append("only the rows were looked at, nothing between them")
    if between == "cp":
        remarks.append(
            "along a line the axes are sampled, and straight in between; beyond the reach nothing was looked at"
        )
    if between != "rows" and not isinstance(robot.chain.axis_map, AffineMap):
        remarks.append("the axis map is not affine: contacts between rows are sampled, with a margin")
    return tuple(remarks)


def check_clearance(clearance: float) -> None:
    """Refuse a clearance [m] that is negative or not finite.

    Raises:
        ChainbuildError: it is.
    """
    if not (np.isfinite(clearance) and clearance >= 0.0):
        raise ChainbuildError("wrong clearance", parameter="clearance", permitted="a finite length of at least 0")


class _ConservativeAdvancement:
    """Walks along the segments of one path."""

    def __init__(self, model: CollisionModel, rows: Matrix, clearance: float) -> None:
        self.model, self.rows, self.clearance = model, rows, clearance
        self.map = model.robot.chain.axis_map
        q = np.array([self.map.q(row) for row in rows])
        self.weights = pair_weights(model, np.abs(drawn_values(model.robot.chain.joints, q)).max(axis=0))

    def place(self, row: int) -> Contact | None:
        """Return the contact at a row itself."""
        axes = self.rows[row]
        return self._touching(row, 0.0, axes, self.model.distances(axes) - self.clearance)

    def segment(self, row: int) -> Contact | None:
        """Return the first contact from a row to the next."""
        start = self.rows[row]
        way = self.rows[min(row + 1, len(self.rows) - 1)] - start
        share = 0.0
        while True:
            axes = start + share * way
            free = self.model.distances(axes) - self.clearance
            found = self._touching(row, share, axes, free)
            if found is not None or share >= 1.0:
                return found
            share = min(1.0, share + max(self._step(start, way, share, free), _SHORTEST_STEP))

    def _touching(self, row: int, share: float, axes: Vector, free: Vector) -> Contact | None:
        closest = int(np.argmin(free))
        if free[closest] >= CONTACT:
            return None
        return Contact(row, share, axes, self._names(closest), float(free[closest]) + self.clearance)

    def _step(self, start: Vector, way: Vector, share: float, free: Vector) -> float:
        """Return a step, as a share of the segment, within which no pair can touch."""
        if isinstance(self.map, AffineMap):
            rates = self.weights @ np.abs(self.map.A @ (way * self.map.si_factors))
            moving = rates > 0.0
            return float((free[moving] / rates[moving]).min()) if moving.any() else 1.0
        step, q = 1.0 - share, self.map.q(start + share * way)
        while step > _SHORTEST_STEP:
            shares = share + step * np.linspace(0.0, 1.0, _NONLINEAR_SAMPLES)[1:]
            moved = np.abs(np.array([self.map.q(start + s * way) for s in shares]) - q).max(axis=0)
            if (self.weights @ moved * _NONLINEAR_MARGIN < free).all():
                return step
            step /= 2.0
        return _SHORTEST_STEP

    def _names(self, n: int) -> LinkPair:
        a, b = self.model.pairs[n]
        return self.model.solids[a].name, self.model.solids[b].name


def pair_weights(model: CollisionModel, largest: Vector) -> Matrix:
    """Return (n_pairs, n_q): how far each joint can move the bodies of a pair towards one another, per unit.

    Args:
        model: Bodies and pairs.
        largest: (n_q,) largest absolute values of the joints as drawn on the way: they lengthen linear joints.
    """
    chain = model.robot.chain
    ways = _joints_to_links(chain)
    lengths = [float(np.linalg.norm(drawn(joint).T_parent_joint[:3, 3])) for joint in chain.joints]
    weights = np.zeros((len(model.pairs), len(chain.joints)))
    for n, pair in enumerate(model.pairs):
        first, second = (model.solids[index] for index in pair)
        shared = set(ways[first.link]) & set(ways[second.link])
        for solid in (first, second):
            reach = solid.reach
            # From the body towards the base: what lies beyond a joint adds up.
            for j in reversed(ways[solid.link]):
                joint = chain.joints[j]
                if j in shared:
                    break
                weights[n, j] += reach if joint.kind == "revolute" else 1.0
                reach += lengths[j]
                if joint.kind == "prismatic":
                    reach += float(largest[j])
    return weights


def _joints_to_links(chain: Chain) -> dict[str, tuple[int, ...]]:
    """Return for each link the joints from the base to it."""
    ways: dict[str, tuple[int, ...]] = {BASE_LINK: ()}
    for n, joint in enumerate(chain.joints):
        ways[joint.child] = (*ways[joint.parent], n)
    return ways
