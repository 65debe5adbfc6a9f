"""Values and indices of SINUMERIK machine data: syntax, and what the catalogue permits."""

from __future__ import annotations

import math
import re
from typing import Final

from chainbuild import tolerances
from chainbuild.formats.sinumerik.reading.catalogue import MachineDatum

Value = float | str
ElementIndex = int | str | tuple[int, int] | None

_ANY_CASE = re.IGNORECASE | re.ASCII
_NUMBER = re.compile(r"([+-]?)\s*((?:\d+(?:\.\d*)?|\.\d+)(?:EX?[+-]?\d+)?)", _ANY_CASE)
_MASK = re.compile(r"'\s*([HB])\s*([0-9A-F]+)\s*'", _ANY_CASE)
_STRING = re.compile(r'"([^"]*)"')
_COMMA = re.compile(r"[+-]?\d*,\d+(?:EX?[+-]?\d+)?", _ANY_CASE)
_NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity|1\.#\w+)", _ANY_CASE)
_AXIS = re.compile(r"(?:\d+\s*,\s*)?([A-Z_][A-Z0-9_]*)", _ANY_CASE)
_TOOL = re.compile(r"(\d{1,9})(?:\s*,\s*(\d{1,9}))?", re.ASCII)
_ELEMENT = re.compile(r"\d{1,9}", re.ASCII)
_ARRAY = re.compile(r"(SET|REP)\s*\((.*)\)", _ANY_CASE)
_REP_ARGUMENTS: Final = 2  # value and count
_LONGEST_ARRAY: Final = 100  # elements: more than any array of machine data that is read here
_CHECKSUM = re.compile(r"[0-9A-F]{1,4}", _ANY_CASE)
_WORDS = {"TRUE": 1.0, "FALSE": 0.0}
_BASES = {"H": 16, "B": 2}
_MASK_BITS: Final = 32  # machine data of type DWORD


class Refusal(Exception):
    """A value or an index that is refused.

    Args:
        code: Finding number.
        text: What is wrong.
        permitted: What would be accepted.
    """

    def __init__(self, code: str, text: str, permitted: str) -> None:
        super().__init__(text)
        self.code = code
        self.text = text
        self.permitted = permitted


def without_checksum(text: str) -> str:
    """Cut off the checksum that archives may carry behind a value (MD11230 MD_FILE_STYLE, bit 0).

    >>> without_checksum("1444 '2F34"), without_checksum("'B101' '1a"), without_checksum("'B101'")
    ('1444', "'B101'", "'B101'")
    """
    value, quote, digits = text.removesuffix("'").rpartition("'")
    if quote and value.strip() and value[-1] in ' \t"' and _CHECKSUM.fullmatch(digits):
        return value.rstrip()
    return text


def elements_of(text: str, room: int = 0) -> list[str] | None:
    """Return the texts of the elements of an array assignment, or None for a single value.

    >>> elements_of('SET(1, -1.5,"A,B")'), elements_of("1"), elements_of("REP(7, 2)"), elements_of("REP(7)", 3)
    (['1', ' -1.5', '"A,B"'], None, ['7', '7'], ['7', '7', '7'])

    Args:
        text: The value.
        room: Elements from the assigned one to the end of the array, which REP(value) fills; 0 where not known.

    Raises:
        Refusal: REP without a value, or with a count that is none.
    """
    match = _ARRAY.fullmatch(text.strip())
    if match is None:
        return None
    parts = _split(match[2])
    if match[1].upper() == "SET":
        return parts
    count = parts[1].strip() if len(parts) == _REP_ARGUMENTS else str(room or _LONGEST_ARRAY)
    if len(parts) > _REP_ARGUMENTS or not _ELEMENT.fullmatch(count) or not 0 < int(count) <= _LONGEST_ARRAY:
        raise Refusal("CB102", f"'{text[:40]}' is no repetition", "REP(value) or REP(value, number of elements)")
    return [parts[0].strip()] * int(count)


def printed_elements(index: str | None, text: str) -> list[str] | None:
    """Return the elements that the manual prints in one cell: NAME [25, 500] or NAME = [25, 500]; else None.

    >>> printed_elements("25, 500", ""), printed_elements(None, "[25,500]"), printed_elements("1", "500")
    (['25', ' 500'], ['25', '500'], None)
    """
    if index is not None and "," in index and not text:
        return _split(index)
    text = text.strip()
    return _split(text[1:-1]) if index is None and text.startswith("[") and text.endswith("]") else None


def _split(text: str) -> list[str]:
    """Return the parts between commas outside double quotes."""
    parts: list[list[str]] = [[]]
    quoted = False
    for character in text:
        quoted ^= character == '"'
        if character == "," and not quoted:
            parts.append([])
        else:
            parts[-1].append(character)
    return ["".join(part) for part in parts]


def parse_value(text: str, *, string: bool = False) -> Value:
    """Return the number or string that a text stands for.

    >>> parse_value("-1.5e2"), parse_value("'H1F'"), parse_value('"A1"')
    (-150.0, 31.0, 'A1')

    Args:
        text: The value.
        string: True where a string is expected.

    Raises:
        Refusal: no value, no number, not finite or a decimal comma; no string where one is expected.
    """
    text = text.strip()
    if not text:
        raise Refusal("CB101", "the value is missing", "a string in double quotes" if string else "a number")
    if string and not _STRING.fullmatch(text):
        raise Refusal("CB107", f"{text[:40]} is not a string", "a string in double quotes")
    if match := _NUMBER.fullmatch(text):
        number = float(match[1] + match[2].upper().replace("EX", "E"))
        if math.isfinite(number):
            return number
        raise Refusal("CB103", f"'{text[:40]}' is not finite", "a finite number")
    if match := _MASK.fullmatch(text):
        return _mask(text[:40], match[1].upper(), match[2])
    if match := _STRING.fullmatch(text):
        return match[1]
    if text.upper() in _WORDS:
        return _WORDS[text.upper()]
    if _COMMA.fullmatch(text):
        raise Refusal("CB104", f"'{text[:40]}' has a decimal comma", "a decimal point")
    if _NOT_FINITE.fullmatch(text):
        raise Refusal("CB103", f"'{text[:40]}' is not finite", "a finite number")
    raise Refusal("CB102", f"'{text[:40]}' is not a number", "a number such as 12.5, -3, 1e-6 or 'H1F'")


def _mask(text: str, base: str, digits: str) -> float:
    try:
        value = int(digits, _BASES[base])
    except ValueError:
        raise Refusal("CB102", f"{text} is not a binary number", "digits 0 and 1 after 'B") from None
    if value.bit_length() > _MASK_BITS:
        raise Refusal("CB102", f"{text} has more than {_MASK_BITS} bits", f"at most {_MASK_BITS} bits")
    return float(value)


def parse_index(datum: MachineDatum, text: str | None) -> ElementIndex:
    """Return the index in brackets behind a datum: element number, axis name, (tool, edge), or None for a scalar.

    Raises:
        Refusal: a missing index, one outside the dimension, or one of the wrong kind.
    """
    if datum.indexed_by == "axis":
        match = _AXIS.fullmatch((text or "").strip())
        if match is None:
            raise Refusal("CB105", f"the index [{text or ''}] names no machine axis", "an axis such as [AX1]")
        return match[1].upper()
    if datum.indexed_by == "tool":
        match = _TOOL.fullmatch((text or "").strip())
        if match is None:
            raise Refusal("CB105", f"the index [{text or ''}] names no tool", "[tool, cutting edge] such as [1,1]")
        return int(match[1]), int(match[2] or 1)
    return _element(datum, text)


def _element(datum: MachineDatum, text: str | None) -> int | None:
    dimension = datum.dimension
    permitted = f"[0] to [{dimension - 1}]" if dimension > 1 else "[0] or no index" if dimension else "[0], [1] …"
    if text is None:
        if dimension > 1:
            raise Refusal("CB105", "the index is missing", permitted)
        return None
    digits = text.strip()
    if not _ELEMENT.fullmatch(digits) or (dimension and int(digits) >= dimension):
        raise Refusal("CB105", f"the index [{text.strip()[:20]}] lies outside the dimension", permitted)
    return None if dimension == 1 else int(digits)


def check_value(datum: MachineDatum, element: int, value: Value) -> None:
    """Refuse a value that the catalogue does not permit.

    Raises:
        Refusal: a string for a number or the reverse, a fraction for an integer, a value out of range.
    """
    if isinstance(value, str) or datum.type == "string":
        if isinstance(value, str) != (datum.type == "string"):
            kind = "a string in double quotes" if datum.type == "string" else "a number"
            raise Refusal("CB107", "the value has the wrong type", kind)
        return
    if datum.type != "float" and value != int(value):
        raise Refusal("CB107", f"{value:g} is not an integer", f"an integer: {datum.permitted_text(element)}")
    if not datum.permits(value, element):
        raise Refusal("CB106", f"{value:.10g} is out of range", datum.permitted_text(element))
    if abs(value) > tolerances.HUGE_AXIS_VALUE and datum.type == "float":
        raise Refusal("CB106", f"{value:.10g} is out of range", f"at most {tolerances.HUGE_AXIS_VALUE:g} in size")
