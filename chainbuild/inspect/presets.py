"""Poses that the page offers by name: its first one, zeros, the middle, the overlay's, a singular one of each kind."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Final, get_args

import numpy as np

from chainbuild.analysis.singularity.measures import scaling_of, smallest_value
from chainbuild.analysis.singularity.names import examine
from chainbuild.analysis.singularity.nearest import nearest_singularity
from chainbuild.analysis.singularity.structure import SingularityKind
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.followers import followers
from chainbuild.errors import ChainbuildError
from chainbuild.kinematics.closure import closing_axes

if TYPE_CHECKING:
    from chainbuild.arrays import Vector
    from chainbuild.chain.elements import Chain
    from chainbuild.kinematics.mechanism import Mechanism

_ROBX: Final = "SINUMERIK ROBX"
_SAME: Final = 1e-9  # mm or degrees: rounding of one position computed in two ways
_SEED: Final = 5  # the page of a machine does not change
_STARTS: Final = 24  # random positions: with half as many two of the shipped arms lack their shoulder
_SINGULAR: Final = 1e-9  # smallest singular value: what a search leaves is below 1e-10
_EXACT: Final = 1e-6  # of the function that a kind stands for: below it no sentence says "nearly"
_DIGITS: Final = (3, 6, 9)  # decimals of mm and degrees, the most readable ones first
_TITLES: Final = {"tilt_end": "end of the tilt"}


def presets_of(robot: Mechanism, rest: Vector) -> list[dict[str, Any]]:
    """Return the named poses of a page: each with `name`, `title`, `axes` (mm and degrees) and `note`.

    What the kinematic cannot take is left out; what is outside the limits says so in its note.

    Args:
        robot: The robot.
        rest: (n_axes,) axis values at which the page opens, mm and degrees.
    """
    chain = robot.chain
    mechanical = " (mechanical zero)" if chain.dialect == _ROBX else ""
    wanted = [("start", "Start", rest, ""), ("zero", f"Axes zero{mechanical}", np.zeros(len(rest)), "")]
    mathematical = _mathematical_zero(chain)
    if mathematical is not None and np.abs(mathematical).max() > _SAME:
        note = "every joint stands where the transformation counts from, as the ROBX manual draws the machine"
        wanted.append(("mathematical_zero", "Mathematical zero", mathematical, note))
    wanted.append(("middle", "Middle of the limits", _middle(chain), ""))
    wanted += [(f"pose:{pose.name}", pose.name, np.array(pose.axes), "") for pose in chain.named_poses]
    poses = [_preset(robot, *one) for one in wanted if _has_pose(robot, one[2])]
    singular = _SingularPoses(robot, rest).of_each_kind()
    return poses + [_preset(robot, f"singular:{kind}", _title(kind), *found) for kind, found in singular]


def _preset(robot: Mechanism, name: str, title: str, axes: Vector, note: str) -> dict[str, Any]:
    outside = robot.limits.words(axes) if robot.violated_limits(axes) else ""
    said = "; ".join(part for part in (note, outside) if part)
    return {"name": name, "title": title, "axes": (axes + 0.0).tolist(), "note": said}


def _title(kind: SingularityKind) -> str:
    return f"Singular: {_TITLES.get(kind, kind)}"


def _has_pose(robot: Mechanism, axes: Vector) -> bool:
    try:
        return bool(np.isfinite(robot.fk(axes).homogeneous).all())
    except ChainbuildError:
        return False


def _middle(chain: Chain) -> Vector:
    """Return the middle (n_axes,) of the limits; without limits, of the range that is shown."""
    low, high = shown_limits(chain, at_middle=True)
    middle = (low + high) / 2.0
    for n, axis in enumerate(chain.axes):
        if not axis.assumed and not axis.endless:
            middle[n] = (axis.lower + axis.upper) / 2.0
    return middle


def _mathematical_zero(chain: Chain) -> Vector | None:
    """Return axis values (n_axes,) with every joint of a ROBX robot at the zero of the transformation, else None."""
    axis_map = chain.axis_map
    if chain.dialect != _ROBX or not isinstance(axis_map, AffineMap):
        return None
    masters = followers(chain)  # drawn rods follow and have no zero of their own
    own = [n for n, joint in enumerate(chain.joints) if joint.name not in masters]
    zero = np.array([chain.joints[n].zero for n in own])
    found = np.linalg.lstsq(axis_map.A[own], zero - axis_map.b[own], rcond=None)[0] / axis_map.si_factors
    return np.round(found, 9)  # rounding of right angles


class _SingularPoses:
    """Singular poses of a robot inside its limits: of each kind the one that is nearest to where the page opens."""

    def __init__(self, robot: Mechanism, rest: Vector) -> None:
        self.robot, self.rest = robot, rest
        linear = np.array([axis.kind == "linear" for axis in robot.axes])
        self.weights = robot.kinematics.si_factors / np.where(linear, scaling_of(robot).length, 1.0)

    def of_each_kind(self) -> list[tuple[SingularityKind, tuple[Vector, str]]]:
        """Return each kind that was found with axis values (n_axes,) and the sentence on it there."""
        best: dict[SingularityKind, tuple[tuple[int, float], Vector, str]] = {}
        for kind, axes in self._candidates():
            axes = self._readable(kind, axes)  # noqa: PLW2901
            sentences = self._exact(axes)
            if kind not in sentences:
                continue
            # A pose of one kind alone says more than one of several at once.
            key = (len(sentences), round(float(np.linalg.norm((axes - self.rest) * self.weights)), 6))
            if kind not in best or key < best[kind][0]:
                best[kind] = (key, axes, sentences[kind])
        return [(kind, best[kind][1:]) for kind in get_args(SingularityKind) if kind in best]

    def _candidates(self) -> Iterator[tuple[SingularityKind, Vector]]:
        drawn = list(closing_axes(self.robot, np.random.default_rng(_SEED), _STARTS))
        if drawn and all(smallest_value(self.robot, axes) < _SINGULAR for axes in drawn):
            return  # a kinematic that is singular everywhere
        for start in (self.rest, *drawn):
            try:
                # Closed loops are expensive to follow where hardly anything closes.
                near = nearest_singularity(self.robot, start, inside=bool(self.robot.chain.loops))
            except ChainbuildError:
                continue
            if near.found and near.inside:
                yield from ((kind, near.axes) for kind in self._exact(near.axes))

    def _exact(self, axes: Vector) -> dict[SingularityKind, str]:
        """Return the kinds of the singularities at axis values (n_axes,), with their sentences; nothing if outside."""
        try:
            if not smallest_value(self.robot, axes) < _SINGULAR or self.robot.violated_limits(axes):
                return {}
            names = examine(self.robot, axes).names
        except ChainbuildError:
            return {}
        found: dict[SingularityKind, str] = {}
        for one in names:
            if one.value < _EXACT:
                found.setdefault(one.kind, one.sentence)
        return found

    def _readable(self, kind: SingularityKind, axes: Vector) -> Vector:
        """Return a pose of the kind with as many axes at rest as it leaves free, rounded where it stays singular."""
        for n, value in enumerate(self.rest):
            tried = axes.copy()
            tried[n] = value
            axes = tried if kind in self._exact(tried) else axes
        rounded = (np.round(axes, digits) for digits in _DIGITS)
        return next((tried for tried in rounded if kind in self._exact(tried)), axes)
