"""The check of a chain: a tree, unique names, both tips, an axis map of the right shape.

Also warnings about implausible arm lengths, the same for both dialects: an unusual machine is not refused.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild import tolerances
from chainbuild.chain.elements import BASE_LINK, FRAME_NAMES, Chain
from chainbuild.chain.names import reserved_fault
from chainbuild.errors import ChainError, Span
from chainbuild.findings import Collector
from chainbuild.frames import is_rigid

_PLACED: Final = 1e-9  # products of exact rotations are off by rounding alone


def check_chain(chain: Chain) -> None:
    """Refuse a chain that contradicts itself.

    Raises:
        ChainError: a duplicate or reserved name, a link with no or two parents, a missing frame, a placement that is
            not a rigid transform, a direction not of length 1, or an axis map of the wrong shape.
    """
    _unique("link", (link.name for link in chain.links))
    _unique("joint", (joint.name for joint in chain.joints))
    _unique("frame", (frame.name for frame in chain.frames))
    _unique("axis", (axis.name for axis in chain.axes))
    _check_names(chain)
    _check_tree(chain)
    _check_placements(chain)
    _check_axes(chain)


def _unique(what: str, names: Iterable[str]) -> None:
    for name, count in Counter(names).items():
        if count > 1:
            raise ChainError(f"{what} {name} occurs {count} times in the chain")


def _check_names(chain: Chain) -> None:
    """Refuse names of axes that tables have for other columns: what they write could not be read."""
    for axis in chain.axes:
        if (fault := reserved_fault(axis.name)) is not None:
            raise ChainError(fault[0], parameter=axis.name, permitted=fault[1])


def _check_tree(chain: Chain) -> None:
    reached = {BASE_LINK}
    known = {link.name for link in chain.links}
    for joint in chain.joints:
        if joint.parent not in reached:
            raise ChainError(f"joint {joint.name} starts at link {joint.parent}, which no earlier joint moves")
        if joint.child in reached:
            raise ChainError(f"link {joint.child} has two parents; a closed loop is a Loop record, not a joint")
        if joint.child not in known:
            raise ChainError(f"joint {joint.name} moves the unknown link {joint.child}")
        reached.add(joint.child)
    if known - reached:
        raise ChainError(f"no joint moves link {', '.join(sorted(known - reached))}")
    named = {frame.name for frame in chain.frames}
    missing = [name for name in FRAME_NAMES if name not in named]
    if missing:
        raise ChainError(f"the chain has no frame {', '.join(missing)}")
    for frame in chain.frames:
        if frame.link not in known:
            raise ChainError(f"frame {frame.name} is fixed to the unknown link {frame.link}")
    for loop in chain.loops:
        for end in (loop.frame_a, loop.frame_b):
            if end not in named:
                raise ChainError(f"loop {loop.name} closes at the unknown frame {end}")


def _check_placements(chain: Chain) -> None:
    placements = [(f"joint {j.name}", j.T_parent_joint) for j in chain.joints]
    placements += [(f"frame {f.name}", f.T_link_frame) for f in chain.frames]
    for what, T in placements:
        if T.shape != (4, 4) or not is_rigid(T, _PLACED):
            raise ChainError(f"the placement of {what} is not a finite rigid transform")
    for joint in chain.joints:
        if abs(float(np.linalg.norm(joint.direction)) - 1.0) > 1e-12:
            raise ChainError(f"the direction of joint {joint.name} is not a unit vector")


def _check_axes(chain: Chain) -> None:
    middle = np.array([(axis.lower + axis.upper) / 2 for axis in chain.axes])
    shape = chain.axis_map.dq_daxes(middle).shape
    if shape != (len(chain.joints), len(chain.axes)):
        raise ChainError(f"expected an axis map of shape {(len(chain.joints), len(chain.axes))}, got {shape}")
    for axis in chain.axes:
        if not axis.lower < axis.upper:
            raise ChainError(f"axis {axis.name} has an empty range: {axis.lower} … {axis.upper}")
    for pose in chain.named_poses:
        if len(pose.axes) != len(chain.axes):
            raise ChainError(f"pose {pose.name} has {len(pose.axes)} values for {len(chain.axes)} axes")


@dataclass(frozen=True, slots=True)
class ArmLength:
    """A length that an arm needs.

    Attributes:
        what: "the upper arm", "the second arm" … .
        parameter: Where the file gives it: "HD9 b2_to_b3_x".
        length_mm: Its size.
        span: Its place.
    """

    what: str
    parameter: str
    length_mm: float
    span: Span | None = None


def check_length_magnitudes(lengths: Sequence[ArmLength], collector: Collector) -> None:
    """Warn of main lengths of an arm that are 0 or differ widely."""
    for one in lengths:
        if one.length_mm == 0.0:
            text = f"{one.what} ({one.parameter}) has length 0: the axes at its ends coincide"
            collector.add("CB512", text, span=one.span, parameter=one.parameter)
    real = sorted((one for one in lengths if one.length_mm), key=lambda one: one.length_mm)
    if len(real) > 1 and real[-1].length_mm > tolerances.ARM_LENGTH_RATIO * real[0].length_mm:
        short, long = real[0], real[-1]
        text = f"{short.what} is {_mm(short.length_mm)} long and {long.what} {_mm(long.length_mm)}"
        hint = f"check the unit and the index of {short.parameter} and {long.parameter}"
        collector.add("CB513", text, span=short.span, parameter=short.parameter, hint=hint)


def check_reach_magnitude(reach_mm: float, span: Span | None, hint: str, collector: Collector) -> None:
    """Warn of an arm whose lengths together are too short or too long for a machine; a reach of 0 leaves no warning.

    Args:
        reach_mm: Sum of its lengths.
        span: Place of a length.
        hint: Which unit may be wrong.
        collector: Takes the finding.
    """
    least, most = tolerances.ARM_REACH_MM
    if reach_mm and not least <= reach_mm <= most:
        text = f"all lengths of the arm together are {_mm(reach_mm)}"
        collector.add("CB514", text, span=span, hint=hint, permitted=f"{least:g} to {most:g} mm is usual")


def _mm(length_mm: float) -> str:
    return f"{length_mm:.4g} mm" if length_mm < tolerances.ARM_REACH_MM[1] else f"{length_mm / 1000.0:.6g} m"
