"""Text of machine files: encodings, bounds and line ends, the same for both dialects."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from chainbuild import tolerances
from chainbuild.errors import FileAccessError, Span

_BOMS = ((b"\xef\xbb\xbf", "utf-8"), (b"\xff\xfe", "utf-16-le"), (b"\xfe\xff", "utf-16-be"))


@dataclass(frozen=True, slots=True)
class SourceText:
    """A text file as read.

    Attributes:
        file: Name for messages, as the user gave it.
        text: Content with LF line ends, without byte order mark.
        encoding: "utf-8", "latin-1" or a UTF-16 told by its mark.
    """

    file: str
    text: str
    encoding: str

    def lines(self) -> list[str]:
        """Return the lines without their ends."""
        return self.text.split("\n")


def read_source(path: Path) -> SourceText:
    """Read a machine file: UTF-8 or Latin-1, any line ends, with bounds on size and line length.

    Raises:
        FileAccessError: missing, a directory, not permitted, empty, binary, too large or a line too long.
    """
    name = str(path)
    raw = _read_bytes(path)
    if not raw.strip():
        raise FileAccessError("the file is empty", span=Span(name))
    text, encoding = _decode(raw)
    if "\0" in text:
        line = text[: text.index("\0")].count("\n") + 1
        raise FileAccessError("the file holds NUL bytes: it is not a text file", span=Span(name, line))
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    for number, content in enumerate(text.split("\n"), start=1):
        if len(content) > tolerances.MAX_LINE_CHARACTERS:
            raise FileAccessError(
                f"the line has {len(content)} characters",
                span=Span(name, number, 1, content[:80]),
                permitted=f"at most {tolerances.MAX_LINE_CHARACTERS} characters a line",
            )
    return SourceText(name, text, encoding)


def _read_bytes(path: Path) -> bytes:
    name = str(path)
    if path.is_dir():
        raise FileAccessError("this is a folder, not a machine file", span=Span(name))
    try:
        size = path.stat().st_size
        if size > tolerances.MAX_FILE_BYTES:
            raise FileAccessError(
                f"the file has {size} bytes", span=Span(name), permitted=f"at most {tolerances.MAX_FILE_BYTES} bytes"
            )
        return path.read_bytes()
    except FileNotFoundError:
        raise FileAccessError("no such file", span=Span(name)) from None
    except PermissionError:
        raise FileAccessError("the file may not be read (permission denied)", span=Span(name)) from None
    except (OSError, ValueError) as error:
        raise FileAccessError(f"the file cannot be read: {error}", span=Span(name)) from None


def _decode(raw: bytes) -> tuple[str, str]:
    for mark, encoding in _BOMS:
        if raw.startswith(mark):
            return raw[len(mark) :].decode(encoding, errors="replace"), encoding
    try:
        return raw.decode("utf-8"), "utf-8"
    except UnicodeDecodeError:
        return raw.decode("latin-1"), "latin-1"
