"""Every branch of a closed chain: the open way from workpiece to tool first, then each strut alone.

The joints between the tips, each driven by an axis of its own, are an open chain: a platform is a machine with three
slides, the lambda kinematic an arm with one. Its closed form gives their joint values; the axis map then tells which
axis values close the loops there. Where a guide couples these joints, the axis map tells their values, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import product
from typing import Final

import numpy as np

from chainbuild import tolerances
from chainbuild.arrays import Vector
from chainbuild.chain.axismap import AffineMap, ClosingMap, PosedMap
from chainbuild.chain.elements import BASE_LINK, Axis
from chainbuild.ik.branches.core.branches import Branch, Branches, Solutions, collect
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.request import IkRequest
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.screws import joints_between_tips

_WIDE: Final = 10.0  # times the limits assumed for axes: what no axis drives has none
_KINDS: Final = {"revolute": "rotary", "prismatic": "linear"}


def opened_query(query: BranchQuery) -> BranchQuery | None:
    """Return the query of the open chain between the tips, or None where it cannot be asked.

    Args:
        query: That of a chain with loops.
    """
    request = opened_request(query)
    return None if request is None else BranchQuery.of(request)


def opened_request(query: BranchQuery) -> IkRequest | None:
    """Return the request of the open chain between the tips; see `opened_query`."""
    mechanism = query.mechanism
    axis_map = mechanism.chain.axis_map
    if not isinstance(axis_map, ClosingMap) or isinstance(axis_map, PosedMap):
        return None
    opened = mechanism.prepared("opened", lambda: _opened(mechanism))
    free = set(query.structure.free.tolist())
    shown = query.shown(query.x0).tolist()
    held = {axis.name: shown[n] for n, axis in enumerate(mechanism.axes) if n not in free}
    if not held.keys() <= set(opened.labels.names):
        return None  # a strut stands still: the way between the tips is not free
    q = mechanism.kinematics.q(query.x0)[list(joints_between_tips_in_order(mechanism))]
    start = None if not np.isfinite(q).all() else q / opened.kinematics.si_factors
    return IkRequest.of(opened, query.target, start, held)


def is_posed(query: BranchQuery) -> bool:
    """Return whether the axis map alone tells the joint values between the tips: where no axis is held."""
    return isinstance(query.mechanism.chain.axis_map, PosedMap) and len(query.structure.free) == len(query.x0)


def find_closed(query: BranchQuery, solve: Callable[[BranchQuery], Solutions]) -> Solutions:
    """Return the branches of a chain with loops.

    Args:
        query: One that `is_posed`, or for which `opened_query` is not None.
        solve: What finds every branch of the open chain.
    """
    return collect(query, _candidates(query, solve))


def usual_branch(mechanism: Mechanism, branches: Branches) -> Branch:
    """Return the branch that is taken where nothing says which: of those that stand alike the first."""
    axis_map = mechanism.chain.axis_map
    assert isinstance(axis_map, ClosingMap)
    ranks = [axis_map.rank(axes) for axes in branches.axes]
    return branches[ranks.index(min(ranks))]


def unreached_words(query: BranchQuery, solve: Callable[[BranchQuery], Solutions]) -> str:
    """Return which rod cannot reach the pose of a query, and by how much; empty where that is not what is wrong."""
    axis_map = query.mechanism.chain.axis_map
    if not isinstance(axis_map, ClosingMap):
        return ""
    for _, q in _joint_values(query, solve):
        if words := axis_map.unreached(q):
            return words
    return ""


def _joint_values(
    query: BranchQuery, solve: Callable[[BranchQuery], Solutions]
) -> Iterator[tuple[tuple[str, ...], Vector]]:
    """Yield joint values (n_q,), those between the tips set, with the free axes of the branch of the open chain."""
    mechanism = query.mechanism
    chain, axis_map = mechanism.chain, mechanism.chain.axis_map
    if isinstance(axis_map, PosedMap) and is_posed(query):
        tool, workpiece = chain.frame("tool").T_link_frame, chain.frame("workpiece").T_link_frame
        yield (), axis_map.posed(query.target.homogeneous, tool, workpiece)
    opened = opened_query(query)
    if opened is None:
        return
    places = list(joints_between_tips_in_order(mechanism))
    found = solve(opened)
    # Where limits of axes are in the way of all branches, the nearest one beyond: the closed chain names them.
    for branch in found.branches or filter(None, [found.beyond]):
        q = np.zeros(len(chain.joints))
        q[places] = branch.axes * opened.mechanism.kinematics.si_factors
        yield branch.free_axes, q


def _candidates(
    query: BranchQuery, solve: Callable[[BranchQuery], Solutions]
) -> Iterator[tuple[Vector, tuple[str, ...]]]:
    mechanism = query.mechanism
    axis_map, own = mechanism.chain.axis_map, {axis.name for axis in mechanism.axes}
    assert isinstance(axis_map, ClosingMap)
    for loose, q in _joint_values(query, solve):
        free = tuple(name for name in loose if name in own)
        for axes in product(*axis_map.closing(q)):
            yield np.array(axes) * mechanism.kinematics.si_factors, free


def joints_between_tips_in_order(mechanism: Mechanism) -> tuple[int, ...]:
    """Return the indices of the joints between the tips, in the order of the chain."""
    return tuple(sorted(joints_between_tips(mechanism.chain)))


def _opened(mechanism: Mechanism) -> Mechanism:
    """Return the open chain: the joints between the tips, each with an axis of its own."""
    chain = mechanism.chain
    joints = [chain.joints[n] for n in joints_between_tips_in_order(mechanism)]
    known = {axis.name: axis for axis in chain.axes}
    axes = tuple(known.get(joint.name) or _free(joint.name, _KINDS[joint.kind]) for joint in joints)
    links = {BASE_LINK, *(joint.child for joint in joints)}
    frames = tuple(frame for frame in chain.frames if frame.link in links)
    count = len(joints)
    body = replace(
        chain,
        links=tuple(link for link in chain.links if link.name in links),
        joints=tuple(joints),
        frames=frames,
        axes=axes,
        axis_map=AffineMap.of(np.eye(count), np.zeros(count), [axis.kind for axis in axes]),
        loops=(),
        task=mechanism.task,
        constraints=(),
        drives=None,
        drive_limits=(),
    )
    return Mechanism(body)


def _free(name: str, kind: str) -> Axis:
    bound = tolerances.ASSUMED_LINEAR_LIMIT_MM if kind == "linear" else tolerances.ASSUMED_ROTARY_LIMIT_DEG
    axis = Axis.unlimited(name, "linear" if kind == "linear" else "rotary")
    return replace(axis, lower=-_WIDE * bound, upper=_WIDE * bound)
