"""Compiling ahead: every entry point of the compiled path is called."""

from __future__ import annotations

import json
from collections.abc import Callable

import pytest

import chainbuild
from chainbuild.errors import ChainbuildError
from chainbuild.ik.search.compiled import packing
from tests.kit.command_line import Run


def test_every_entry_point_is_called(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("numba")
    from chainbuild.ik.branches.compiled import entries as branches
    from chainbuild.ik.branches.opw import compiled as opw
    from chainbuild.ik.branches.planar import compiled as planar
    from chainbuild.ik.search.compiled import entries, slides

    called: list[str] = []

    def noting(name: str, entry: Callable[..., object]) -> Callable[..., object]:
        def call(*words: object) -> object:
            called.append(name)
            return entry(*words)

        return call

    names = {"search_one", "search_many", "track_many", "write_branches", "write_planar_branches"}
    names |= {"write_linear_axes", "finish_poses", "beside_pose", "nearest_places", "status_rows"}
    for module in (entries, opw, planar, slides, branches):
        for name in names:
            if (entry := getattr(module, name, None)) is not None:
                monkeypatch.setattr(module, name, noting(name, entry))
    outcome = run("warm", "--json")
    assert outcome.code == 0
    assert set(called) == names
    seconds = json.loads(outcome.out)["seconds"]
    assert len(seconds) == 12
    assert all(value > 0.0 for value in seconds.values())


def test_the_command_says_how_long_it_took(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("chainbuild.ik.warm.warm_up", lambda *, progress: {"one pose": 3.25, "a path": 1.5})
    outcome = run("warm")
    assert outcome.code == 0
    assert outcome.out.splitlines() == ["   3.2 s  one pose", "   1.5 s  a path", "   4.8 s  in all"]


def test_without_numba_there_is_nothing_to_compile(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(packing, "available", lambda: False)
    with pytest.raises(ChainbuildError, match="numba is not installed"):
        chainbuild.warm_up()
    outcome = run("warm")
    assert outcome.code == 1
    assert outcome.err.count("\n") <= 2
    assert "fast" in outcome.err
