"""The token of a live page: kept for its port, readable by its owner alone, so that a restart is met again."""

from __future__ import annotations

import os
import re
import secrets
import stat
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Final

from chainbuild.errors import ChainbuildError

_BYTES: Final = 24  # of a token: more than anybody guesses
_FORM: Final = re.compile(r"[A-Za-z0-9_-]{16,128}")


def checked_token(text: str) -> str:
    """Return a token that a user has chosen.

    Raises:
        ChainbuildError: it is too short to keep others out, or does not fit into an address.
    """
    if not _FORM.fullmatch(text):
        raise ChainbuildError("the token is refused", parameter="--token", permitted="16 to 128 of A-Z a-z 0-9 _ -")
    return text


def token_for(port: int) -> str:
    """Return the token of a port: that of an earlier run, else a new one, which is kept if it can be kept safely."""
    file = _folder_file(port)
    if file is None:
        return secrets.token_urlsafe(_BYTES)
    kept = _read(file)
    if kept is not None:
        return kept
    token = secrets.token_urlsafe(_BYTES)
    keep_token(port, token)
    return token


def keep_token(port: int, token: str) -> None:
    """Keep a token for a port; where it cannot be kept safely, it is not."""
    file = _folder_file(port)
    if file is None:
        return
    part = file.with_name(f"{file.name}.{secrets.token_hex(4)}")
    with suppress(OSError):
        try:
            # A new file: nobody has it open, and nobody chose where it leads.
            with os.fdopen(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w", encoding="ascii") as stream:
                stream.write(token)
            part.replace(file)
        finally:
            part.unlink(missing_ok=True)


def _folder_file(port: int) -> Path | None:
    """Return the file of a port in a folder that only its owner can open; None where there is no such folder."""
    if not hasattr(os, "getuid"):  # Windows
        return None
    given = Path(os.environ.get("XDG_RUNTIME_DIR", ""))
    for base in (given, Path(tempfile.gettempdir())):
        if not base.is_absolute():
            continue
        folder = base / f"chainbuild-{os.getuid()}"
        with suppress(OSError, ValueError):
            folder.mkdir(mode=0o700, exist_ok=True)
            found = folder.lstat()
            # Somebody else may have made it before, or a link of that name.
            if stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and not found.st_mode & 0o077:
                return folder / f"inspect-{port}.token"
    return None


def _read(file: Path) -> str | None:
    with suppress(OSError, UnicodeDecodeError):
        # Neither does a link lead elsewhere, nor a pipe keep the reader waiting.
        flags = os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
        with os.fdopen(os.open(file, flags), encoding="ascii") as stream:
            found = os.fstat(stream.fileno())
            ours = found.st_uid == os.getuid() and not found.st_mode & 0o077
            text = stream.read(256).strip() if ours else ""
        if _FORM.fullmatch(text):
            return text
    return None
