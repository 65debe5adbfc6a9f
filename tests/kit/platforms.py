"""What `pyproject.toml` asks for on an interpreter, and how tests without it are told apart from broken ones.

Some libraries that results are compared with have no wheels for the newest Python. Their requirement then carries an
environment marker. Where it does not apply, a stand-in takes the place of the library and skips whatever test comes to
use it, with the reason, which pytest lists at the end. Where it applies, a library that is missing stays an error.
"""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Mapping
from types import ModuleType
from typing import Any

import pytest
from packaging.requirements import Requirement

from tests.kit.paths import ROOT

# Package → the modules of it that are imported, where its requirement has a marker.
PEERS: Mapping[str, tuple[str, ...]] = {
    "EAIK": ("eaik", "eaik.IK_HP"),
    "py-opw-kinematics": ("py_opw_kinematics",),
}


def requirements(*extras: str) -> list[Requirement]:
    """Return what `pyproject.toml` requires, with extras, whatever the interpreter."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    texts = [*project["dependencies"]]
    for extra in extras:
        texts += project["optional-dependencies"][extra]
    return [Requirement(text) for text in texts]


def applies(requirement: Requirement, environment: Mapping[str, str] | None = None) -> bool:
    """Return whether a requirement counts in an environment; None: this one."""
    return requirement.marker is None or requirement.marker.evaluate(dict(environment) if environment else None)


def without(environment: Mapping[str, str] | None = None) -> list[str]:
    """Return the packages of `PEERS` that the tests do without in an environment; None: this one."""
    return [r.name for r in requirements("test") if r.name in PEERS and not applies(r, environment)]


class StandIn(ModuleType):
    """A module all of whose functions skip the test that calls them."""

    def __init__(self, name: str, package: str) -> None:
        super().__init__(name)
        self.__path__: list[str] = []
        self._package = package

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)

        def skips(*_: object, **__: object) -> None:
            version = ".".join(map(str, sys.version_info[:2]))
            pytest.skip(
                f"{self._package} is not asked for on Python {version} (pyproject.toml): nothing to compare with"
            )

        return skips


def stand_in(packages: list[str]) -> None:
    """Put stand-ins in the place of packages."""
    for package in packages:
        for name in PEERS[package]:
            sys.modules[name] = StandIn(name, package)
