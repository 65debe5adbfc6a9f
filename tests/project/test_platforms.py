"""Interpreters and versions: what is asked for where, and the versions that continuous integration takes."""

from __future__ import annotations

import importlib
import re
import sys
import tomllib

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.kit.paths import ROOT
from tests.kit.platforms import PEERS, StandIn, applies, requirements, stand_in, without
from tests.project.constraints import FILE, needed

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
PINS = dict(
    line.split("==") for line in FILE.read_text("utf-8").splitlines() if not line.startswith("#")
)  # package → version


def test_every_python_is_in_the_classifiers_and_the_readme() -> None:
    versions = [c.rpartition(" ")[2] for c in PROJECT["classifiers"] if ":: Python :: 3." in c]
    assert versions[0] == PROJECT["requires-python"].removeprefix(">=")
    assert f"Python {versions[0]} to {versions[-1]}" in (ROOT / "README.md").read_text("utf-8")


def test_the_constraints_hold_what_the_tests_require_and_nothing_else() -> None:
    asked = [r for r in requirements("test") if applies(r, {"python_version": "3.11"})]
    for requirement in asked:
        version = PINS[canonicalize_name(requirement.name)]
        assert requirement.specifier.contains(version), f"{requirement} but {version}: run `make constraints`"
    assert list(PINS) == sorted(PINS)
    assert set(needed()) <= set(PINS) or sys.version_info[:2] != (3, 11), "run `make constraints`"
    assert all(re.fullmatch(r"[a-z0-9-]+", name) and re.fullmatch(r"[\w.+]+", PINS[name]) for name in PINS)


def test_without_a_wheel_a_library_is_not_asked_for() -> None:
    assert without({"python_version": "3.13"}) == []
    assert sorted(without({"python_version": "3.14"})) == sorted(PEERS)
    marked = {r.name for r in requirements("test") if r.marker is not None}
    assert marked == set(PEERS)  # each has a stand-in


def test_libraries_that_are_asked_for_are_the_real_ones() -> None:
    for package in set(PEERS) - set(without()):
        for name in PEERS[package]:
            assert not isinstance(importlib.import_module(name), StandIn)


def test_a_stand_in_skips_what_calls_it_and_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in PEERS["EAIK"]:
        monkeypatch.setitem(sys.modules, name, None)
    stand_in(["EAIK"])
    eaik = importlib.import_module("eaik.IK_HP")
    with pytest.raises(pytest.skip.Exception, match="EAIK is not asked for on Python"):
        eaik.HPRobot([], [])


def test_requirements_read_alike_in_every_extra() -> None:
    """A library that several extras ask for is asked for with one version and one marker."""
    said: dict[str, set[str]] = {}
    for extra in PROJECT["optional-dependencies"].values():
        for text in extra:
            said.setdefault(canonicalize_name(Requirement(text).name), set()).add(text)
    assert {name: texts for name, texts in said.items() if len({str(Requirement(t).marker) for t in texts}) > 1} == {}
