"""Machine code kept on disk: damaged files, folders that cannot be written, and the note of the first compilation."""

from __future__ import annotations

import gc
import importlib.util
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("numba")

import numba
from numba.core import event as numba_events
from numba.core.caching import CacheImpl

from chainbuild.ik.branches.opw.compiled import write_branches
from chainbuild.ik.search.compiled import entries
from chainbuild.ik.search.compiled.entries import KeptCode, kept_jit
from chainbuild.ik.search.compiled.slides import write_linear_axes

Load = Callable[[], Any]


@pytest.fixture
def load(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Load:
    """Return a function that gives a fresh compiled function, whose source stands in a folder of its own."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    source = tmp_path / "doubling.py"
    source.write_text("def doubled(x):\n    return 2.0 * x\n", "utf-8")

    def fresh() -> Any:
        monkeypatch.setattr(KeptCode, "told", False)  # as in a new process
        spec = importlib.util.spec_from_file_location("doubling", source)
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, "doubling", module)  # what is kept names its module
        spec.loader.exec_module(module)
        return kept_jit()(module.doubled)

    return fresh


def kept_files(tmp_path: Path) -> list[Path]:
    return [path for path in tmp_path.rglob("*") if path.suffix in {".nbi", ".nbc"}]


def test_the_first_compilation_is_noted_once(load: Load, capsys: pytest.CaptureFixture[str]) -> None:
    function = load()
    assert function(2.0) == 4.0
    assert function(3) == 6.0  # another signature: compiled, too
    said = capsys.readouterr()
    assert said.err == "chainbuild: compiling the solver (only once; `chainbuild warm` does it ahead)\n"
    assert said.out == ""
    assert load()(2.0) == 4.0
    assert capsys.readouterr().err == ""  # it was kept


@pytest.mark.parametrize("suffix", [".nbi", ".nbc"])
@pytest.mark.parametrize("content", [b"", b"damaged", b"\x80\x04\x95"])
def test_a_damaged_file_is_replaced(
    load: Load, tmp_path: Path, capsys: pytest.CaptureFixture[str], suffix: str, content: bytes
) -> None:
    assert load()(2.0) == 4.0
    capsys.readouterr()
    (file,) = (path for path in kept_files(tmp_path) if path.suffix == suffix)
    file.write_bytes(content)
    assert load()(2.0) == 4.0
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert said.startswith("chainbuild: compiling the solver anew: what was kept in ")
    assert load()(2.0) == 4.0
    assert capsys.readouterr().err == ""


def test_without_a_folder_to_write_code_is_compiled_in_memory(
    load: Load, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(CacheImpl, "_locator_classes", [])
    with pytest.raises(RuntimeError, match="no locator"):
        numba.njit(cache=True)(lambda x: x)
    for _ in range(2):
        assert load()(2.0) == 4.0
        said = capsys.readouterr().err
        assert said.startswith("chainbuild: compiling the solver in memory")
        assert "NUMBA_CACHE_DIR" in said
        assert said.count("\n") == 1
    assert not kept_files(tmp_path)


def test_code_kept_beside_a_package_that_cannot_be_written_is_used(
    load: Load, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert load()(2.0) == 4.0
    assert len(kept_files(tmp_path)) == 2
    capsys.readouterr()
    monkeypatch.setattr(CacheImpl, "_locator_classes", [])
    assert load()(2.0) == 4.0
    assert capsys.readouterr().err == ""


def test_a_folder_that_fails_later_is_noted(
    load: Load, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("numba.core.caching.IndexDataCacheFile._save_index", full)
    function = load()
    assert (function(2.0), function(2)) == (4.0, 4.0)
    said = capsys.readouterr().err
    assert "cannot be kept in" in said
    assert "No space left" in said
    assert said.count("\n") == 2


def test_every_entry_point_is_kept_so() -> None:
    found = (entries.search_one, entries.search_many, entries.track_many, write_branches, write_linear_axes)
    assert all(isinstance(entry._cache, KeptCode) for entry in found)


def test_the_collector_rests_and_the_bar_stands_until_an_entry_point_is_compiled(
    load: Load, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[tuple[str, int]] = []

    class Ends(numba_events.Listener):
        def on_start(self, event: Any) -> None: ...

        def on_end(self, event: Any) -> None:
            seen.append((event.data["dispatcher"].__name__, gc.get_threshold()[0]))

    @contextmanager
    def shown(text: str) -> Iterator[None]:
        seen.append((text, gc.get_threshold()[0]))
        yield
        seen.append(("end", gc.get_threshold()[0]))

    monkeypatch.setattr(entries, "working", shown)
    usual = gc.get_threshold()
    halved = numba.njit(**entries.inner.INNER)(lambda x: 0.5 * x)
    quartered = kept_jit()(lambda x: 0.5 * halved(x))
    with numba_events.install_listener("numba:compile", Ends()):
        assert quartered(8.0) == 2.0
    inner_end = ("<lambda>", entries._OBJECTS)
    assert seen[:3] == [("compiling the solver", entries._OBJECTS), inner_end, ("end", entries._OBJECTS)]
    assert gc.get_threshold() == usual
