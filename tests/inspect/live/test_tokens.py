"""The token of a port is kept where its owner alone reads it, and nothing that somebody has planted is trusted."""

from __future__ import annotations

import os
import stat
import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest

from chainbuild.errors import ChainbuildError
from chainbuild.inspect.live.tokens import checked_token, keep_token, token_for

PLANTED = "planted-by-somebody"
PORT = 7421


@pytest.fixture
def runtime(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the folder of the runtime files; that of temporary files is another one."""
    folders = [tmp_path / name for name in ("runtime", "temporary", "elsewhere")]
    for one in folders:
        one.mkdir()
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(folders[0]))
    monkeypatch.setattr(tempfile, "gettempdir", lambda: str(folders[1]))
    return folders[0]


def _file(base: Path) -> Path:
    return base / f"chainbuild-{os.getuid()}" / f"inspect-{PORT}.token"


def test_token_is_kept(runtime: Path) -> None:
    """For its port alone, in a file and a folder of its owner alone."""
    token = token_for(PORT)
    assert token == token_for(PORT)
    assert token != token_for(PORT + 1)
    file = _file(runtime)
    assert file.read_text() == token == checked_token(token)
    assert [stat.S_IMODE(one.stat().st_mode) for one in (file, file.parent)] == [0o600, 0o700]
    keep_token(PORT, PLANTED)
    assert token_for(PORT) == PLANTED


def _mode(file: Path) -> None:
    file.write_text(PLANTED)
    file.chmod(0o640)


def _link(file: Path) -> None:
    target = file.parents[2] / "elsewhere" / "target"
    target.write_text(PLANTED)
    target.chmod(0o600)
    file.symlink_to(target)


def _pipe(file: Path) -> None:
    os.mkfifo(file, 0o600)


def _folder(file: Path) -> None:
    file.mkdir(mode=0o700)


def _garbage(file: Path) -> None:
    file.write_bytes(b"\xff" * 20)
    file.chmod(0o600)


def _short(file: Path) -> None:
    file.write_text("short")
    file.chmod(0o600)


@pytest.mark.parametrize("plant", [_mode, _link, _pipe, _folder, _garbage, _short])
def test_planted_files_are_not_trusted(runtime: Path, plant: Callable[[Path], None]) -> None:
    """A new token takes the place of what somebody else could have written; what a link leads to stays as it is."""
    file = _file(runtime)
    file.parent.mkdir(mode=0o700)
    plant(file)
    token = token_for(PORT)
    assert token != PLANTED
    assert (token_for(PORT) == token) is not (plant is _folder)
    assert [one.name for one in file.parent.iterdir()] == [file.name]  # nothing half-written
    target = runtime.parent / "elsewhere" / "target"
    assert not target.exists() or target.read_text() == PLANTED


def test_foreign_file_is_not_trusted(runtime: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not even with the right mode."""
    file = _file(runtime)
    keep_token(PORT, PLANTED)
    real = os.fstat

    def foreign(number: int) -> os.stat_result:
        found = list(real(number))
        found[stat.ST_UID] += 1
        return os.stat_result(found)

    monkeypatch.setattr(os, "fstat", foreign)
    assert token_for(PORT) != PLANTED
    assert file.exists()


@pytest.mark.parametrize("kind", ["link", "open", "file"])
def test_planted_folders_are_not_used(runtime: Path, kind: str) -> None:
    """The token is kept with the temporary files, if the folder there is its owner's alone."""
    folder = _file(runtime).parent
    if kind == "link":
        folder.symlink_to(runtime.parent / "elsewhere")
    elif kind == "open":
        folder.mkdir()
        folder.chmod(0o750)
    else:
        folder.write_text("")
    token = token_for(PORT)
    assert token_for(PORT) == token == _file(runtime.parent / "temporary").read_text()
    assert not list((runtime.parent / "elsewhere").iterdir())
    _file(runtime.parent / "temporary").parent.chmod(0o755)
    assert token_for(PORT) != token_for(PORT)


@pytest.mark.parametrize("given", [None, "", "relative", "/proc", "/nonexistent", "/dev/null"])
def test_without_a_runtime_folder(runtime: Path, monkeypatch: pytest.MonkeyPatch, given: str | None) -> None:
    """The token is kept with the temporary files."""
    if given is None:
        monkeypatch.delenv("XDG_RUNTIME_DIR")
    else:
        monkeypatch.setenv("XDG_RUNTIME_DIR", given)
    assert token_for(PORT) == token_for(PORT) == _file(runtime.parent / "temporary").read_text()


@pytest.mark.parametrize("text", ["", 15 * "a", 129 * "a", "a b" * 8, "a" * 16 + "\n", "é" * 16, "a/" * 8])
def test_tokens_that_are_refused(text: str) -> None:
    """What is guessed, or does not fit into an address."""
    with pytest.raises(ChainbuildError, match="permitted: 16 to 128"):
        checked_token(text)
