"""Machine code kept on disk: damaged files, folders that cannot be written, and the note of the first compilation."""

from __future__ import annotations

import importlib.util
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("numba")

import numba
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
