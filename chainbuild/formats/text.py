"""Text of machine files: encodings, bounds and line ends, the same for all dialects; and which dialect it is.

Also the values of TOML files beside them, with errors that point at their line.

The dialect is detected by content alone, without the code of any one.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from chainbuild import tolerances
from chainbuild.errors import FileAccessError, FileContentError, OverlayError, Span
from chainbuild.filekinds import binary_kind

DRIVES: Final = "drives"  # the table within [limits] and [speeds] of an overlay
SUMS: Final = "sums"  # the table within [limits] of an overlay
COUPLED: Final = "coupling"  # the overlay's table of axes that others move along
POSES: Final = "poses"  # the overlay's table of named poses, which may be tables
URDF: Final = "URDF"  # the dialect
_TOML_HEADER = re.compile(r"\s*\[\[?([^\[\]]+)\]")
_DEEP_KEY = re.compile(r"""(?:\.[ \t]*["']?[\w-]+["']?[ \t]*){50}""")
_TOML_NAME = re.compile(r'"[^"]*"|\'[^\']*\'|[^.\s"\']+')
_LISTED: Final = 8  # files of a folder that a message names
_HEAD_BYTES: Final = 4096  # enough to tell what a file is
_BOMS = ((b"\xef\xbb\xbf", "utf-8"), (b"\xff\xfe", "utf-16-le"), (b"\xfe\xff", "utf-16-be"))


@dataclass(frozen=True, slots=True)
class SourceText:
    """A text file as read.

    Attributes:
        file: Name for messages, as the user gave it.
        text: Content with LF line ends, without byte order mark.
        encoding: "utf-8", "latin-1" or a UTF-16 detected by its mark.
    """

    file: str
    text: str
    encoding: str

    def lines(self) -> list[str]:
        """Return the lines without their ends."""
        return self.text.split("\n")


def read_source(path: Path, *, may_be_empty: bool = False) -> SourceText:
    """Read a machine file or overlay: UTF-8 or Latin-1, any line ends, with bounds on size and line length.

    Args:
        path: The file.
        may_be_empty: True where an empty file is permitted.

    Raises:
        FileAccessError: missing, a directory or not permitted.
        FileContentError: empty, binary, too large or a line too long.
    """
    name = str(path)
    raw = _read_bytes(path)
    if not raw.strip() and not may_be_empty:
        raise FileContentError("the file is empty", span=Span(name))
    head = raw[:_HEAD_BYTES]
    kind = binary_kind(head, len(raw)) if b"\0" in head or not head.isascii() else None
    if kind is not None:
        raise FileContentError(f"this is {kind.name}, not a text file", span=Span(name), hint=kind.machine)
    text, encoding = _decode(raw)
    if "\0" in text:
        line = text[: text.index("\0")].count("\n") + 1
        raise FileContentError("the file holds NUL bytes: it is not a text file", span=Span(name, line))
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    for number, content in enumerate(text.split("\n"), start=1):
        if len(content) > tolerances.MAX_LINE_CHARACTERS:
            raise FileContentError(
                f"the line has {len(content)} characters",
                span=Span(name, number, 1, content[:80]),
                permitted=f"at most {tolerances.MAX_LINE_CHARACTERS} characters a line",
            )
    return SourceText(name, text, encoding)


def toml_line(lines: Sequence[str], keys: Sequence[str]) -> int:
    """Return the number of the line that gives a key in a TOML text; tomllib keeps none.

    >>> toml_line(["[limits]", "A1 = [-10, 10]"], ("limits", "A1"))
    2
    >>> toml_line(["limits = {A1 = [0, 1]}"], ("limits", "A1"))
    1

    Args:
        lines: The text.
        keys: Name of the table and name within it, at any depth; or one name.

    Returns:
        The line, else that of the table, else 0.
    """
    first, last = keys[0], keys[-1]
    inline = re.compile(rf"""(?<![\w"'-])["']?{re.escape(last)}["']?\s*=""")
    table: list[str] = []
    nearest = 0
    for number, line in enumerate(lines, start=1):
        header = _TOML_HEADER.match(line)
        name, equals, rest = line.partition("=")
        path = table = _toml_names(header[1]) if header else table
        if not header and equals:
            path = [*table, *_toml_names(name)]
        if not path or path[0] != first or not (header or equals):
            continue
        nearest = nearest or number
        if any(key not in path and key not in rest for key in keys[1:-1]):
            continue  # a key of that name in another table
        if (path[-1] == last and len(path) >= len(keys)) or inline.search(rest):
            return number
    return nearest


def _toml_names(text: str) -> list[str]:
    return [name.strip("\"'") for name in _TOML_NAME.findall(text)]


def _read_bytes(path: Path) -> bytes:
    name = str(path)
    if path.is_dir():
        raise FileAccessError("this is a folder, not a machine file", span=Span(name), hint=_inside(path))
    try:
        with path.open("rb") as stream:
            # The bytes read decide, not the size on the file system: a device or a pipe has size 0 and may never end.
            raw = stream.read(tolerances.MAX_FILE_BYTES + 1)
        if len(raw) > tolerances.MAX_FILE_BYTES:
            raise FileContentError(
                f"the file has {max(len(raw), path.stat().st_size)} bytes",
                span=Span(name),
                permitted=f"at most {tolerances.MAX_FILE_BYTES} bytes",
            )
        return raw
    except FileNotFoundError:
        raise FileAccessError("no such file", span=Span(name)) from None
    except PermissionError:
        raise FileAccessError("the file may not be read (permission denied)", span=Span(name)) from None
    except (OSError, ValueError) as error:
        raise FileAccessError(f"the file cannot be read: {error}", span=Span(name)) from None


def _inside(folder: Path) -> str | None:
    """Return a hint at the files of a folder, by name."""
    try:
        files = sorted(one.name for one in folder.iterdir() if one.is_file() and not one.name.startswith("."))
    except OSError:
        return None
    more = "" if len(files) <= _LISTED else f" and {len(files) - _LISTED} more"
    return f"name one of its files: {', '.join(files[:_LISTED])}{more}" if files else None


def _decode(raw: bytes) -> tuple[str, str]:
    for mark, encoding in _BOMS:
        if raw.startswith(mark):
            return raw[len(mark) :].decode(encoding, errors="replace"), encoding
    try:
        return raw.decode("utf-8"), "utf-8"
    except UnicodeDecodeError:
        return raw.decode("latin-1"), "latin-1"


# Structures of a TwinCAT list that say something about kinematics, tools or axes; all others are ignored.
TWINCAT_ROOTS: Final = frozenset(
    {
        "trafo", "kin_step", "kinematik", "trafo_pcs", "wz", "gruppe", "kenngr", "kopf", "kinematik_id",
        "kinematik_name", "kinematic_id", "default_id_of_kin_step", "default_name_of_kin_step", "ori_rotation_angle",
        "ori",
    }
)  # fmt: skip
_NUMBERS: Final = re.compile(r"[-+.\deE,;\t ]+")
_UNIT: Final = re.compile(r"[\[(][^\[\]()\n]*[\])]")
_HEADER_CHARACTERS: Final = 20_000  # comments before a header are shorter
_DH_NAMES: Final = 3  # of a, d, alpha, theta: a header that lacks one is told so
_XML_ROOT: Final = re.compile(r"(?:\s|<\?[^>]*>|<!--.*?-->|<!DOCTYPE[^>]*>)*<([A-Za-z_][\w.:-]*)", re.DOTALL)
_XML: Final = re.compile(r"\s*<(\?xml|!--|!DOCTYPE|TcSm|[A-Za-z])")
_TWINCAT: Final = re.compile(
    rf"^[ \t]*(?:{'|'.join(sorted(TWINCAT_ROOTS - {'ori'}))})(?=[ \t\[.]|$)", re.MULTILINE | re.IGNORECASE
)
_SINUMERIK: Final = re.compile(
    r"\\?\$(?:M[NCA]|S[NCA]|TC|ON|NK|NT)_[A-Z]"
    r"|^[ \t]*(?:CHANDATA[ \t]*\(|%_N_\w|(?:ROBX|TRAFO6|TRAFO_TYPE)_[A-Z0-9]|(?:N|MD)[ \t]*62[69]\d\d\b)",
    re.IGNORECASE | re.ASCII | re.MULTILINE,
)


def is_xml(text: str) -> bool:
    """Return True where a text is XML."""
    return _XML.match(text) is not None


def is_twincat(text: str) -> bool:
    """Return True where a text is a TwinCAT CNC parameter list, or XML: a project that may hold one."""
    return is_xml(text) or _TWINCAT.search(text) is not None


def xml_root(text: str) -> str:
    """Return the name of the outermost element of an XML text; an empty string where it is none.

    >>> xml_root("<?xml version='1.0'?><!-- an arm --><robot name='arm'>"), xml_root("A1,A2")
    ('robot', '')
    """
    found = _XML_ROOT.match(text) if is_xml(text) else None
    return found[1] if found is not None else ""


def is_urdf(text: str) -> bool:
    """Return True where a text is URDF, or a template of it."""
    return xml_root(text) == "robot"


def is_dh(text: str) -> bool:
    r"""Return True where a text is a table of Denavit-Hartenberg parameters: its header has three of their four names.

    >>> is_dh("# modified\n a [mm]; D; alpha [deg]; theta"), is_dh("A1,A2,A3")
    (True, False)
    """
    rows = [line.strip().strip('"') for line in text[:_HEADER_CHARACTERS].split("\n")]
    full = [row for row in rows if row.strip(",;\t ") and not row.startswith("sep=")]
    place = next((n for n, row in enumerate(full) if not row.startswith("#")), 0)
    header = full[place] if full else ""
    if place and _NUMBERS.fullmatch(header):  # the comment before numbers names the columns, as numpy writes it
        header = full[place - 1].lstrip("# ")
    names = {name.strip(' "').split("_")[0].casefold() for name in re.split(r"[,;\t]", _UNIT.sub("", header))}
    return len(names & {"a", "d"}) + bool(names & {"alpha", "α"}) + bool(names & {"theta", "θ"}) >= _DH_NAMES


def is_sinumerik(text: str) -> bool:
    r"""Tell by content whether a text holds SINUMERIK machine data.

    >>> is_sinumerik("N62905 $MC_ROBX_NUM_AXES=6"), is_sinumerik("trafo[0].id 9"), is_sinumerik("MD62905 6")
    (True, False, True)
    """
    return _SINUMERIK.search(text) is not None


def parsed_toml(path: Path, text: str) -> dict[str, Any]:
    """Return the contents of an overlay.

    Raises:
        OverlayError: TOML syntax.
    """
    deep = _DEEP_KEY.search(text)  # tomllib takes seconds for thousands of dots
    if deep is not None:
        line = text.count("\n", 0, deep.start()) + 1
        raise OverlayError("not a valid overlay: a key is nested too deeply", span=Span(str(path), line))
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise OverlayError("not valid TOML: nested too deeply", span=Span(str(path))) from None
    except tomllib.TOMLDecodeError as error:
        found = re.search(r"line (\d+)", str(error))
        raise OverlayError(f"not valid TOML: {error}", span=Span(str(path), int(found[1]) if found else 0)) from None
    except ValueError:  # from int()
        raise OverlayError("not valid TOML: a number has thousands of digits", span=Span(str(path))) from None


def toml_span(path: Path, *keys: str) -> Span:
    """Return the place of a key of a TOML file, such as ("limits", "A1"); the file alone where it is not found."""
    try:
        lines = read_source(path, may_be_empty=True).lines()
    except FileAccessError:
        return Span(str(path))
    number = toml_line(lines, keys)
    return Span(str(path), number, 1, lines[number - 1]) if number else Span(str(path))


def toml_refusal(path: Path, key: str, permitted: str, text: str = "") -> OverlayError:
    """Return the error of a value.

    Args:
        path: The file.
        key: Its table, a dot and its name; of a table within that table also a dot and the name there.
        permitted: What is permitted.
        text: What is wrong; empty: it has the wrong type.
    """
    text = text or f"the value of '{key}' has the wrong type"
    table, _, name = key.partition(".")
    inner, _, last = name.partition(".")
    nested = last and (table in (POSES, COUPLED) or inner in (DRIVES, SUMS))  # other names may hold a dot
    keys = (inner, last) if nested else (name,) if name else ()
    return OverlayError(text, span=toml_span(path, table, *keys), parameter=key, permitted=permitted)


def toml_number(path: Path, key: str, value: object) -> float:
    """Return a value that must be a finite number; `key` as for `toml_refusal`."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise toml_refusal(path, key, "a finite number")
    if not abs(value) < tolerances.HUGE_AXIS_VALUE:
        shown = f"'{key}' is {value:g}" if isinstance(value, float) else f"'{key}' is too large"
        raise toml_refusal(path, key, f"a finite number below {tolerances.HUGE_AXIS_VALUE:g}", shown)
    return float(value)


def toml_text(path: Path, key: str, value: object) -> str:
    """Return a value that must be a string; `key` as for `toml_refusal`."""
    if not isinstance(value, str):
        raise toml_refusal(path, key, "a string")
    return value


def toml_number_tables(path: Path, key: str, value: object) -> dict[str, dict[str, float]]:
    """Return a value that must be a table of tables of finite numbers; `key` as for `toml_refusal`."""
    inner = {name: toml_table(path, f"{key}.{name}", given) for name, given in toml_table(path, key, value).items()}
    return {
        name: {last: toml_number(path, f"{key}.{name}.{last}", number) for last, number in table.items()}
        for name, table in inner.items()
    }


def toml_table(path: Path, key: str, value: object) -> dict[str, object]:
    """Return a value that must be a table; `key` as for `toml_refusal`."""
    if not isinstance(value, dict):
        raise toml_refusal(path, key, f"a table [{key}]")
    return value
