"""Names of a composed chain: a guest keeps its own, except where the host has them already."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from chainbuild.chain.elements import BASE_LINK, Chain


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
        return cls(
            links=links,
            joints=_free((joint.name for joint in guest.joints), prefix, {joint.name for joint in host.joints}),
            frames=_free((frame.name for frame in guest.frames), prefix, {frame.name for frame in host.frames}),
            axes=_free((axis.name for axis in guest.axes), prefix, {axis.name for axis in host.axes}),
            loops=_free((loop.name for loop in guest.loops), prefix, {loop.name for loop in host.loops}),
        )


def free_name(name: str, taken: Iterable[str]) -> str:
    """Return a name, with a number where it is taken.

    >>> free_name("arm", ["arm", "arm_2"])
    'arm_3'
    """
    used, number, new = set(taken), 1, name
    while new in used:
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
