"""Which pairs of links can collide: sampled, with the confidence of the sampling."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from chainbuild.chain.axismap import random_axis_values
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.collision.model import CollisionModel, LinkPair
from chainbuild.errors import ChainbuildError
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.progress import Progress, counted

Verdict = Literal["adjacent", "always", "never", "sometimes"]

DEFAULT_SAMPLES: Final = 10_000  # bounds what was missed at 3e-4 of all positions, with the confidence below
_CONFIDENCE: Final = 0.95  # the usual one of a statistical bound


@dataclass(frozen=True, slots=True)
class PairVerdict:
    """What sampling found about two links.

    Attributes:
        links: Their names.
        verdict: "adjacent" (a joint connects them), "always", "never" or "sometimes".
        hits: Number of positions at which they touched.
    """

    links: LinkPair
    verdict: Verdict
    hits: int


@dataclass(frozen=True, slots=True)
class PairTable:
    """Verdicts on all pairs of links.

    Attributes:
        pairs: One for each pair, in the order of the chain's links.
        samples: Number of positions, drawn uniformly from the axis limits.
        confidence: Probability with which `bound` holds.
        bound: A pair that never touched (or always did) does otherwise at less than this share of all positions.
    """

    pairs: tuple[PairVerdict, ...]
    samples: int
    confidence: float
    bound: float

    def of(self, verdict: Verdict) -> tuple[LinkPair, ...]:
        """Return the pairs of a verdict."""
        return tuple(pair.links for pair in self.pairs if pair.verdict == verdict)


def classify_pairs(
    robot: Mechanism,
    samples: int = DEFAULT_SAMPLES,
    seed: int = 0,
    confidence: float = _CONFIDENCE,
    *,
    progress: Progress = False,
) -> PairTable:
    """Return which pairs of links touch never, sometimes or always.

    Args:
        robot: The robot.
        samples: Number of positions.
        seed: Seed of the positions: the same seed gives the same table.
        confidence: Confidence of the bound on what sampling may have missed: 1 − (1 − confidence)^(1/samples).
        progress: True: a bar on standard error; a function: called with the positions done and all positions.

    Raises:
        ChainbuildError: samples below 1, or a confidence outside 0 … 1.
    """
    if samples < 1 or not 0.0 < confidence < 1.0:
        raise ChainbuildError("wrong sampling options", permitted="at least 1 sample, a confidence between 0 and 1")
    chain = robot.chain
    names = [link.name for link in chain.links]
    adjacent = {frozenset((joint.parent, joint.child)) for joint in chain.joints}
    every = [(a, b) for n, a in enumerate(names) for b in names[n + 1 :]]
    model = CollisionModel(robot, [pair for pair in every if frozenset(pair) not in adjacent])
    lower, upper = shown_limits(chain)
    rng = np.random.default_rng(seed)
    hits: dict[frozenset[str], int] = {}
    link_of = {solid.name: solid.link for solid in model.solids}
    for _ in counted(range(samples), samples, progress, "positions"):
        found = model.colliding_pairs(random_axis_values(chain.axis_map, rng, lower, upper)[0])
        for touching in {frozenset(link_of[name] for name in pair) for pair in found}:
            hits[touching] = hits.get(touching, 0) + 1
    verdicts = []
    for pair in every:
        key = frozenset(pair)
        count = hits.get(key, 0)
        verdict: Verdict = "always" if count == samples else "sometimes" if count else "never"
        verdicts.append(PairVerdict(pair, "adjacent" if key in adjacent else verdict, count))
    bound = 1.0 - (1.0 - confidence) ** (1.0 / samples)
    return PairTable(tuple(verdicts), samples, confidence, bound)
