"""Self-collisions at axis values, for the page."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from chainbuild.collision.model import CollisionModel
from chainbuild.errors import ChainbuildError
from chainbuild.units import mm_from_m

if TYPE_CHECKING:
    from chainbuild.arrays import Vector
    from chainbuild.kinematics.mechanism import Mechanism

_LISTED: Final = 6  # pairs that are told: what is far away does not matter


class Contacts:
    """Which bodies of a robot touch, and which are nearest to one another.

    Args:
        robot: The robot.
    """

    def __init__(self, robot: Mechanism) -> None:
        self._robot = robot

    @cached_property
    def _model(self) -> CollisionModel | str:
        """The bodies, made when they are first asked for; else why there are none."""
        try:
            return CollisionModel(self._robot)
        except ChainbuildError as error:
            return str(error)

    def at(self, axes: Vector) -> dict[str, Any]:
        """Return what touches at axis values (n_axes,), mm and degrees.

        Returns:
            "pairs": the nearest bodies, smallest distance first, with names, links, distance in mm (negative: how deep)
            and nearest points (2, 3) in the base [m]; "touching": names of the pairs that touch; "watched": how many
            pairs are; "words": why nothing can be told, else empty.
        """
        nothing: dict[str, Any] = {"pairs": [], "touching": [], "watched": 0, "words": ""}
        model = self._model
        if isinstance(model, str):
            return {**nothing, "words": model}
        if not np.isfinite(self._robot.chain.axis_map.q(axes)).all():
            return {**nothing, "words": "the kinematic has no pose here"}
        links = {solid.name: solid.link for solid in model.solids}
        table = model.distance_table(axes)
        touching = [list(pair) for pair in model.colliding_pairs(axes)]
        pairs = [
            {
                "bodies": list(one.pair),
                "links": [links[name] for name in one.pair],
                "mm": mm_from_m(one.distance),
                "points": one.points.tolist(),
            }
            for one in table[: max(_LISTED, len(touching))]
        ]
        return {**nothing, "pairs": pairs, "touching": touching, "watched": len(model.pairs)}
