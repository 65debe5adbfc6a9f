"""Write `constraints.txt`: the versions of all packages that the tests were green with; `make constraints`."""

from __future__ import annotations

import sys
from importlib.metadata import distribution

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.kit.paths import ROOT
from tests.kit.platforms import applies, requirements

FILE = ROOT / "constraints.txt"
HEAD = """\
# What `make test` was green with, on Linux with Python {}. `make constraints` writes it anew.
# make takes these versions; where one is not to be had it says so and takes the newest.
"""


def needed() -> dict[str, str]:
    """Return package → installed version of what the tests require, and what that requires in turn."""
    found: dict[str, str] = {}
    waiting: list[Requirement] = requirements("test")
    while waiting:
        requirement = waiting.pop()
        if not applies(requirement, {"extra": ""}):
            continue
        name = canonicalize_name(requirement.name)
        installed = distribution(name)
        extras = requirement.extras or {""}
        new = name not in found
        found[name] = installed.version
        if not new and extras == {""}:
            continue
        for text in installed.requires or []:
            inner = Requirement(text)
            if any(applies(inner, {"extra": extra}) for extra in extras):
                inner.marker = None
                waiting.append(inner)
    return found


def text() -> str:
    """Return the file for what is installed."""
    pins = "".join(f"{name}=={version}\n" for name, version in sorted(needed().items()))
    return HEAD.format(".".join(map(str, sys.version_info[:2]))) + pins


if __name__ == "__main__":
    FILE.write_text(text(), "utf-8")
    print(f"{FILE.name}: {len(needed())} packages")
