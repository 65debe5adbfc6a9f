"""Writing files: all or nothing, with text that is text, and with numbers that are the same on every machine.

The last bit of a sine or a matrix product differs between processors and C libraries. Numbers are therefore brought
to a coarser grid before they are written, and whatever lies within that noise of a short decimal number (a length in
machine data) or of a short decimal angle in degrees is taken to be exactly that.

>>> number_text(0.1 + 0.2)
'0.3'
>>> number_text(-6.1e-17)
'0'
>>> angle_text(1.5707963267948963)
'1.5707963267949'
"""

from __future__ import annotations

import errno
import io
import os
import re
import secrets
import stat
import unicodedata
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from io import BufferedWriter, TextIOWrapper
from pathlib import Path
from typing import BinaryIO, Final, TextIO

from chainbuild.errors import FileAccessError, OverwriteError, Span
from chainbuild.units import deg_from_rad, rad_from_deg

_NOISE: Final = 1e-14  # sums and products of a few rounded factors, relative, absolute below 1
_SHORT_DECIMALS: Final = 11  # 10 pm: finer than any machine datum
_SHORT_DEGREES: Final = 9  # 1e-9 degrees: finer than any machine datum
_DECIMALS: Final = 13  # of all other numbers: 0.1 pm, 1e-13 rad is 0.2 pm at 2 m

_RANDOM_BYTES: Final = 8  # of a temporary name: no two writers draw the same

_BINARY: Final = getattr(os, "O_BINARY", 0)  # Windows translates line ends without it

_DOUBTFUL: Final = re.compile(r"[^ -~\n\t]")
# Categories of characters that are no text: control, format (such as the direction of writing), surrogate, separators.
_UNSEEN: Final = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})

FilePlace = tuple[int, int] | str

_parts: set[Path] = set()  # temporary files of what is being written
_inputs: set[FilePlace] = set()  # files that must not be written over


def number_text(value: float) -> str:
    """Return a number (SI) with at most 15 significant digits and 13 decimals, without signed zero."""
    short = round(value, _SHORT_DECIMALS)
    if abs(value - short) > _NOISE * max(1.0, abs(value)):
        short = round(value, _DECIMALS)
    return f"{short + 0.0:.15g}"


def angle_text(value: float) -> str:
    """Return an angle in radians like `number_text`, exact to 15 digits where it is a decimal number of degrees."""
    degrees = deg_from_rad(value)
    short = round(degrees, _SHORT_DEGREES)
    if abs(degrees - short) <= deg_from_rad(_NOISE) * max(1.0, abs(value)):
        return f"{rad_from_deg(short) + 0.0:.15g}"
    return number_text(value)


def numbers_text(values: Iterable[float]) -> str:
    """Return numbers (SI) separated by single spaces, each as `number_text` writes it."""
    return " ".join(number_text(float(value)) for value in values)


def printable(text: str, *, lines: bool = True) -> str:
    r"""Return a text that a reader shows and does not obey: control and format characters escaped.

    Args:
        text: The text.
        lines: False: a name or a message, whose line ends are escaped, too.

    >>> print(printable("\x1b[31mred\u202e"), printable("one\ntwo", lines=False))
    \x1b[31mred\u202e one\ntwo
    """
    shown = text if text.isprintable() else _DOUBTFUL.sub(_escaped, text)
    return shown if lines else shown.replace("\n", "\\n")


def _escaped(found: re.Match[str]) -> str:
    known = unicodedata.category(found[0]) not in _UNSEEN
    return found[0] if known else found[0].encode("unicode_escape").decode("ascii")


def printable_tree(root: ET.Element) -> ET.Element:
    """Make every text of an XML tree printable, in place: some characters may stand in no XML; return the tree."""
    for element in root.iter():
        if isinstance(element.text, str):
            element.text = printable(element.text)
    return root


def xml_text(root: ET.Element) -> str:
    """Return an XML tree as the text of a file, indented, in place."""
    ET.indent(root, "  ")
    buffer = io.BytesIO()
    ET.ElementTree(root).write(buffer, encoding="utf-8", xml_declaration=True)
    return buffer.getvalue().decode("utf-8") + "\n"


def write_text(path: Path, text: str) -> None:
    """Write a UTF-8 text file with LF line ends, all or nothing.

    Raises:
        FileAccessError: the file cannot be written; an earlier file of that name is unchanged.
    """
    with open_atomic(path) as stream:
        stream.write(text)


def write_all(contents: Mapping[Path, str | bytes]) -> None:
    """Write several files, texts as UTF-8: none appears under its name before all of them are written.

    Folders that are missing are created.

    Raises:
        FileAccessError: a file cannot be written; earlier files of these names are unchanged.
    """
    with ExitStack() as stack:
        for path, content in contents.items():
            make_folder(path.parent)
            data = content.encode("utf-8") if isinstance(content, str) else content
            stack.enter_context(open_binary_atomic(path)).write(data)


def as_path(path: str | os.PathLike[str]) -> Path:
    """Return a path given as such or as a string.

    Raises:
        FileAccessError: it is neither.
    """
    try:
        return Path(path)
    except TypeError as error:
        raise FileAccessError(f"not a path: {error}") from None


def make_folder(path: Path) -> None:
    """Create a folder and those above it where they are missing.

    Raises:
        FileAccessError: it cannot be created.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        raise _refusal(path, error, "the folder cannot be created") from None


def place_of(path: Path) -> FilePlace:
    """Return what all names of one file have in common: device and inode, its full path where it does not exist."""
    try:
        found = path.stat()
    except (OSError, ValueError):
        return str(path) if "\0" in str(path) else os.path.realpath(path)
    return found.st_dev, found.st_ino


def folder_of(folder: Path | str, name: str) -> Path:
    """Return folder/NAME for a robot's files, not created.

    Raises:
        FileAccessError: the folder is not a path, or the name would lead out of it.
    """
    place = as_path(folder)
    if name in ("", ".", "..") or any(c in "/\\:" or not c.isprintable() for c in name):
        raise FileAccessError(f"{name[:80]!r} cannot be the name of a file", permitted="a name without / and \\")
    return place / name


@contextmanager
def protected(inputs: Iterable[Path]) -> Iterator[None]:
    """Refuse to write over files while the block runs, by whatever name: those that a command reads."""
    added = {place_of(path) for path in inputs} - _inputs
    _inputs.update(added)
    try:
        yield
    finally:
        _inputs.difference_update(added)


@contextmanager
def open_atomic(path: Path) -> Iterator[TextIO]:
    """Open a UTF-8 text file for writing, as `open_binary_atomic` does.

    Raises:
        FileAccessError: the file cannot be written; an earlier file of that name is unchanged.
    """
    with open_binary_atomic(path) as stream, _as_text(stream) as text:
        yield text


@contextmanager
def _as_text(stream: BinaryIO) -> Iterator[TextIO]:
    """Yield a text stream on a binary one, which stays open behind it."""
    text = TextIOWrapper(stream, encoding="utf-8", newline="\n")
    try:
        yield text
    finally:
        text.detach()  # writes out what is left


@contextmanager
def open_binary_atomic(path: Path) -> Iterator[BinaryIO]:
    """Open a file for writing that appears under its name only when the block ends without an error.

    What is written goes to a temporary file in the same folder, which then takes the place of `path`. A path that is no
    regular file, such as /dev/null or a pipe, is written to directly.

    Raises:
        FileAccessError: the file cannot be written; an earlier file of that name is unchanged.
        OverwriteError: the file is one of those that `protected` names.
    """
    if "\0" in str(path):
        raise FileAccessError("the file cannot be written: its name holds a NUL character", span=Span(str(path)))
    try:
        if path.exists() and not path.is_file() and not path.is_dir():
            with path.open("wb") as stream:
                yield stream
            return
        if place_of(path) in _inputs:
            raise OverwriteError("this file is also an input; it is left as it is", span=Span(str(path)))
        with _temporary(Path(os.path.realpath(path))) as stream:
            yield stream
    except OSError as error:
        raise _refusal(path, error, "the file cannot be written") from None


@contextmanager
def _temporary(target: Path) -> Iterator[BufferedWriter]:
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    part = target.with_name(f".{target.name[:40]}.{secrets.token_hex(_RANDOM_BYTES)}.part")
    try:
        _parts.add(part)  # before it exists: a signal may come between any two steps
        with os.fdopen(os.open(part, os.O_CREAT | os.O_EXCL | os.O_WRONLY | _BINARY, 0o600), "wb") as stream:
            yield stream
        part.chmod(_mode(target))
        part.replace(target)
    except BaseException:
        part.unlink(missing_ok=True)
        raise
    finally:
        _parts.discard(part)


def discard_parts() -> None:
    """Remove the temporary files of all files being written: for a process that is about to end."""
    for part in tuple(_parts):
        with suppress(OSError):
            part.unlink(missing_ok=True)


def _mode(target: Path) -> int:
    """Return the permissions of the file that is replaced, else those of a new file under the umask."""
    with suppress(OSError):
        return stat.S_IMODE(target.stat().st_mode)
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask


def _refusal(path: Path, error: OSError | ValueError, text: str) -> FileAccessError:
    reason = error.strerror if isinstance(error, OSError) else None
    return FileAccessError(f"{text}: {reason or error}", span=Span(str(path)))
