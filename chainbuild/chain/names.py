"""Names: which axis a name means, the channel's own names put on a chain, and the names of a composed chain.

An axis is called by the channel's own name. The generic one, of the type or the transformation, is accepted wherever an
axis is named, except where it means another axis of the channel; so is either in another case, where one axis alone can
be meant. A guest of a composed chain keeps its names, except where the host has them already.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.axismap import named_map
from chainbuild.chain.drives import named_drives
from chainbuild.chain.elements import BASE_LINK, Axis, Chain, Partial
from chainbuild.chain.programmed.display import (
    ANGLE_COLUMNS,
    POSITION_COLUMNS,
    QUATERNION_COLUMNS,
    STATUS_COLUMNS,
    TOOL_COLUMNS,
)
from chainbuild.chain.programmed.vectors import VECTOR_COLUMNS

# Columns that tables have beside the axes; an axis of such a name could not have a column of its own.
RESERVED_COLUMNS: Final = (
    *POSITION_COLUMNS, *QUATERNION_COLUMNS, *TOOL_COLUMNS, *VECTOR_COLUMNS, *ANGLE_COLUMNS,
    *(*STATUS_COLUMNS, "row", "status", "position_error_mm", "rotation_error_deg", "violations"),
)  # fmt: skip
_FRAMES: Final = frozenset(("tool", "workpiece", "universe"))  # looked up by name where Pinocchio also has the joints
DRIVE_SUFFIX: Final = "_drive"  # of a column that holds what a drive stands at
# What CSV, JSON, XML, HTML and `PARTIAL.AXIS` on the command line leave as it is.
_SAFE: Final = re.compile(r"[^\W\d][\w-]*")
_SAFE_POSE: Final = re.compile(r"[^\W\d](?:[\w -]*[\w-])?")  # the same, and words


def axis_index(axes: Sequence[Axis], name: str) -> int | None:
    """Return the index of the axis that a name means, or None where it means none or might mean several.

    The axes' names come before the generic ones, also in another case.

    Args:
        axes: The axes.
        name: A name, in any case.
    """
    named, generic = [axis.name for axis in axes], [axis.generic for axis in axes]
    if name in named:
        return named.index(name)
    folded = name.casefold()
    for wanted, known in (
        (folded, [one.casefold() for one in named]),
        (name, generic),
        (folded, [one.casefold() for one in generic]),
    ):
        if name and wanted in known:
            return known.index(wanted) if known.count(wanted) == 1 else None
    return None


def name_meaning(axes: Sequence[Axis], n: int, names: Iterable[str]) -> str | None:
    """Return the first of some names that means the n-th axis; None where none does."""
    return next((name for name in names if axis_index(axes, name) == n), None)


def pose_name_fault(name: str) -> str | None:
    """Return what is permitted where a name of a pose is not, else None."""
    return None if _SAFE_POSE.fullmatch(name) else "a letter, then letters, digits, spaces, _ and -"


def pose_named(chain: Chain, text: str) -> Vector | None:
    """Return the axis values (n_axes,), mm and degrees, of the named pose that a text means, or None.

    Args:
        chain: The chain.
        text: A name, in any case where one pose alone can be meant.
    """
    name, known = text.strip(), chain.named_poses
    same = [one for one in known if one.name == name]
    same = same or [one for one in known if one.name.casefold() == name.casefold()]
    return np.array(same[0].axes) if len(same) == 1 else None


def generic_name(axis: Axis) -> str:
    """Return the name that the type or the transformation gives an axis."""
    return axis.generic or axis.name


def name_fault(name: str) -> tuple[str, str] | None:
    """Return what is wrong with a name of an axis, and what is permitted; None where nothing is.

    >>> name_fault("X_LIN"), name_fault("Status")
    (None, ("the axis is called 'Status' like a column of the tables", 'another name than status'))
    """
    if (fault := reserved_fault(name)) is not None:
        return fault
    if not _SAFE.fullmatch(name):
        return f"the axis is called {name[:40]!r}", "a letter, then letters, digits, _ and -"
    return None


def reserved_fault(name: str) -> tuple[str, str] | None:
    """Return what is wrong with a name that means something else, and what is permitted; None if nothing is."""
    folded, shown = name.casefold(), repr(name[:40])
    if folded in RESERVED_COLUMNS:
        return f"the axis is called {shown} like a column of the tables", f"another name than {folded}"
    if folded.endswith(DRIVE_SUFFIX):
        text = f"the axis is called {shown} like the column of a drive in tables"
        return text, f"a name that does not end with {DRIVE_SUFFIX}"
    if name in _FRAMES:
        return (
            f"the axis is called {shown} like a frame of the model",
            f"another name than {', '.join(sorted(_FRAMES))}",
        )
    return None


def channel_names(axes: Sequence[Axis], given: Sequence[str]) -> tuple[tuple[str, ...], tuple[int, ...]]:
    """Return the names of axes of which a channel names some, and the indices of those that lose their own name.

    An axis that the channel does not name keeps its name, with a number where the channel calls another axis so.

    Args:
        axes: The axes by their generic names.
        given: The channel's name of each, or an empty string.
    """
    called = {name.casefold() for name in given if name}
    taken = set(called)
    names: list[str] = []
    lost: list[int] = []
    for n, (axis, name) in enumerate(zip(axes, given, strict=True)):
        if not name and axis.name.casefold() in called:
            lost.append(n)
        names.append(name or free_name(axis.name, taken, fold=True))
        taken.add(names[-1].casefold())
    return tuple(names), tuple(lost)


def renamed(chain: Chain, names: Sequence[str]) -> Chain:
    """Return a chain whose axes have other names; joints, links and partials follow, the old names become generic.

    Args:
        chain: The chain.
        names: The new name of each axis.
    """
    new = {axis.name: name for axis, name in zip(chain.axes, names, strict=True)}
    if all(old == name for old, name in new.items()):
        return chain
    joints = _following([joint.name for joint in chain.joints], new)
    links = _following([link.name for link in chain.links], new)
    display = chain.display
    if display.kind == "axes":
        display = replace(display, columns=tuple(new.get(column, column) for column in display.columns))
    return replace(
        chain,
        links=tuple(replace(link, name=links[link.name]) for link in chain.links),
        joints=tuple(
            replace(joint, name=joints[joint.name], parent=links[joint.parent], child=links[joint.child])
            for joint in chain.joints
        ),
        frames=tuple(replace(frame, link=links[frame.link]) for frame in chain.frames),
        axes=tuple(_with_name(axis, new[axis.name]) for axis in chain.axes),
        axis_map=named_map(chain.axis_map, names),
        drives=None if chain.drives is None else named_drives(chain.drives, names),
        partials=tuple(_renamed_partial(partial, chain.axes, names) for partial in chain.partials),
        geometry=chain.geometry.renamed(links),
        display=display,
    )


def _with_name(axis: Axis, name: str) -> Axis:
    generic = generic_name(axis)
    return replace(axis, name=name, generic="" if name == generic else generic)


def _following(known: Sequence[str], new: Mapping[str, str]) -> dict[str, str]:
    """Return the names of joints or links, old → new: `C` and `C_link` follow axis C, others make way for them."""
    wanted = {name: _owned(name, new) for name in known}
    order = sorted(known, key=lambda name: (name not in new, wanted[name] is None))
    found: dict[str, str] = {}
    for name in order:
        found[name] = free_name(wanted[name] or name, found.values())
    return found


def _owned(name: str, new: Mapping[str, str]) -> str | None:
    """Return a name that is an axis' name or begins with one and `_`, with the new one; None for others."""
    owner = max((old for old in new if name == old or name.startswith(f"{old}_")), key=len, default=None)
    return None if owner is None else new[owner] + name[len(owner) :]


def _renamed_partial(partial: Partial, axes: Sequence[Axis], names: Sequence[str]) -> Partial:
    """Return a partial whose axes have the new names of a composed chain; names that stay are its own."""
    own, first = partial.chain.axes, partial.first_axis
    pairs = list(zip(axes[first : first + len(own)], names[first : first + len(own)], strict=True))
    given = ["" if axis.name == name else name for axis, name in pairs]
    return replace(partial, chain=renamed(partial.chain, channel_names(own, given)[0]))


def link_names(chain: Chain) -> dict[str, str]:
    """Return what links may be called → their names.

    `X_link` is the link that joint X moves, whatever a URDF calls it; also that of an axis whose generic name is X.
    """
    generic = {axis.name: axis.generic for axis in chain.axes if axis.generic}
    known = {f"{joint.name}_link": joint.child for joint in chain.joints}
    known |= {link.name: link.name for link in chain.links}
    also = {other: link for name, link in known.items() if (other := _owned(name, generic)) is not None}
    return {**also, **known}


def as_name(text: str) -> str:
    """Return a text as a prefix that is safe in files: letters, digits and `_`.

    >>> as_name("XY unit")
    'XY_unit'
    """
    return "".join(c if c.isascii() and (c.isalnum() or c == "_") else "_" for c in text) or "part"


@dataclass(frozen=True, slots=True)
class Names:
    """New names of the guest: old name → new name."""

    links: Mapping[str, str]
    joints: Mapping[str, str]
    frames: Mapping[str, str]
    axes: Mapping[str, str]
    generics: Mapping[str, str]
    loops: Mapping[str, str]

    @classmethod
    def of(cls, host: Chain, guest: Chain, prefix: str, link: str, root: str) -> Names:
        """Find the guest's names.

        Args:
            host: The chain that is grafted on.
            guest: The chain that is grafted.
            prefix: Put before a name that the host has already.
            link: The host's link that the guest's root link becomes one with.
            root: The guest's root link.
        """
        taken_links = {entry.name for entry in host.links} | {frame.name for frame in host.frames}
        # A base that moves is no longer one; as a link it must not have the name of the guest's frame `base`.
        own = [f"{prefix}_{BASE_LINK}_link" if e.name == BASE_LINK else e.name for e in guest.links]
        links = dict(zip((entry.name for entry in guest.links), _free(own, prefix, taken_links).values(), strict=True))
        links[root] = link
        known = {axis.name for axis in host.axes} | {axis.generic for axis in host.axes}
        return cls(
            links=links,
            joints=_free((joint.name for joint in guest.joints), prefix, {joint.name for joint in host.joints}),
            frames=_free((frame.name for frame in guest.frames), prefix, taken_links),
            axes=_free((axis.name for axis in guest.axes), prefix, {axis.name for axis in host.axes}),
            generics={"": "", **_free((axis.generic for axis in guest.axes if axis.generic), prefix, known)},
            loops=_free((loop.name for loop in guest.loops), prefix, {loop.name for loop in host.loops}),
        )


def free_name(name: str, taken: Iterable[str], *, fold: bool = False) -> str:
    """Return a name, with a number where it is taken.

    >>> free_name("arm", ["arm", "arm_2"])
    'arm_3'

    Args:
        name: The name.
        taken: Names that are in use.
        fold: True: names that differ in case alone are the same; `taken` are in lower case.
    """
    used, number, new = set(taken), 1, name
    while (new.casefold() if fold else new) in used:
        number += 1
        new = f"{name}_{number}"
    return new


def _free(names: Iterable[str], prefix: str, taken: Iterable[str]) -> dict[str, str]:
    """Return each name as it is where it is free, else with the prefix, else also with a number."""
    wanted = list(names)
    used, found = {*taken}, dict[str, str]()
    for name in wanted:
        found[name] = name if name not in used else free_name(f"{prefix}_{name}", used.union(wanted))
        used.add(found[name])
    return found
