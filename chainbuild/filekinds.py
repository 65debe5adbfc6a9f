"""What a file is that is neither machine data nor a table: told by its first bytes, with what to do instead."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

_AS_CSV: Final = "save its sheet as CSV UTF-8 (Excel: Save As, CSV UTF-8) and give that file"
_NO_TABLE: Final = "give a table of text: column names in the first line"
_NO_DATA: Final = "give machine data as text: a SINUMERIK archive, a TwinCAT list, DH parameters or a URDF"
_UNPACK: Final = "unpack it, and give the file inside"
_BODIES: Final = (
    "it holds shapes and no joints: give the machine data, and name this file as a body in [geometry] of the overlay"
)
_ARCHIVE: Final = (
    "unpack it and give the machine data inside as text; of a SINUMERIK commissioning archive (.dsf, .arc) write the "
    "channel's machine data with `Save as`, or export them as .tea or .mpf"
)


@dataclass(frozen=True, slots=True)
class FileKind:
    """A kind of file that is not read.

    Attributes:
        name: What it is, with its article.
        machine: What to do where a machine file is expected.
        table: What to do where a table is expected.
    """

    name: str
    machine: str
    table: str


_EXCEL: Final = FileKind("an Excel workbook", f"DH parameters: {_AS_CSV}; {_NO_DATA}", _AS_CSV)
_ZIP: Final = FileKind("a zip archive", _ARCHIVE, _UNPACK)
# First bytes → what begins with them; the longest stand first where one begins like another.
_MAGIC: Final = (
    (b"\x1f\x8b", FileKind("a file compressed with gzip", f"{_UNPACK}: gunzip FILE", f"{_UNPACK}: gunzip FILE")),
    (b"BZh", FileKind("a file compressed with bzip2", _UNPACK, _UNPACK)),
    (b"\xfd7zXZ\0", FileKind("a file compressed with xz", _UNPACK, _UNPACK)),
    (b"7z\xbc\xaf\x27\x1c", FileKind("a 7-Zip archive", _ARCHIVE, _UNPACK)),
    (b"Rar!\x1a\x07", FileKind("a RAR archive", _ARCHIVE, _UNPACK)),
    (b"%PDF", FileKind("a PDF", _NO_DATA, _NO_TABLE)),
    (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", FileKind("an old Office file (.xls, .doc)", _NO_DATA, _AS_CSV)),
    (b"\x89PNG\r\n", FileKind("a picture (PNG)", _NO_DATA, _NO_TABLE)),
    (b"\xff\xd8\xff", FileKind("a picture (JPEG)", _NO_DATA, _NO_TABLE)),
    (b"glTF", FileKind("a mesh (glTF)", _BODIES, _NO_TABLE)),
    (b"SQLite format 3\0", FileKind("an SQLite database", _NO_DATA, _NO_TABLE)),
    (b"\x7fELF", FileKind("a program", _NO_DATA, _NO_TABLE)),
    (b"MZ\x90\0", FileKind("a program", _NO_DATA, _NO_TABLE)),
)
_PACKED: Final = b"PK\x03\x04"  # zip, and all that are zip inside
_INSIDE: Final = (
    (b"xl/", _EXCEL),
    (b"opendocument.spreadsheet", FileKind("a LibreOffice sheet", _EXCEL.machine, _AS_CSV)),
    (b"word/", FileKind("a Word document", _NO_DATA, _NO_TABLE)),
    (b"opendocument.text", FileKind("a LibreOffice document", _NO_DATA, _NO_TABLE)),
)
_STL_HEAD: Final = 84  # bytes: 80 of anything, 4 with the number of triangles
_STL_TRIANGLE: Final = 50  # bytes


def binary_kind(head: bytes, size: int = 0) -> FileKind | None:
    r"""Return what a binary file is by its first bytes; None: a text, or unknown.

    >>> binary_kind(b"%PDF-1.7\n").name, binary_kind(b"A1,A2\n1,2\n")
    ('a PDF', None)

    Args:
        head: The first bytes, a few thousand.
        size: Bytes of the whole file, where known.
    """
    if head.startswith(_PACKED):
        return next((kind for mark, kind in _INSIDE if mark in head), _ZIP)
    for mark, kind in _MAGIC:
        if head.startswith(mark):
            return kind
    triangles = int.from_bytes(head[_STL_HEAD - 4 : _STL_HEAD], "little")
    if size > _STL_HEAD and size == _STL_HEAD + _STL_TRIANGLE * triangles and b"\0" in head:
        return FileKind("a mesh (STL)", _BODIES, _NO_TABLE)
    return None
