"""What a page may say: each message is a JSON object of one kind, and is refused unless it is exactly that."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final

from chainbuild.errors import ChainbuildError
from chainbuild.inspect.live.sections import SECTIONS

LARGEST_MESSAGE: Final = 65_536  # characters: hundreds of machine data take a few thousand
_SHOWN: Final = 40  # characters of what is refused
_LARGEST_NUMBER: Final = 1e100  # the square of a larger one could overflow
_DIGITS: Final = 40  # of a whole number in JSON: Python takes quadratic time for thousands


@dataclass(frozen=True, slots=True)
class Message:
    """A message of a page.

    Attributes:
        kind: "axes", "datum", "reset", "convention", "moves", "kinematic", "section", "restore", "model", "presets" or
            "ask".
        content: What it says; of the form that its kind has.
    """

    kind: str
    content: Any

    @property
    def about(self) -> tuple[str, str]:
        """Its kind, and what it is about: of two messages about the same only the later matters."""
        if self.kind == "reset":
            return self.kind, self.content or ""
        return self.kind, str(self.content[_ABOUT[self.kind]]) if self.kind in _ABOUT else ""


def parsed(text: str | bytes) -> Message:
    """Return what a page says.

    Raises:
        ChainbuildError: it is no such message.
    """
    if isinstance(text, bytes):
        raise _refusal("bytes")
    if len(text) > LARGEST_MESSAGE:
        raise ChainbuildError(f"a message of {len(text)} characters", permitted=f"at most {LARGEST_MESSAGE}")
    try:
        data = json.loads(text, parse_int=_whole, object_pairs_hook=_object)
    except (ValueError, RecursionError):
        raise _refusal(text) from None
    if not isinstance(data, dict) or len(data) != 1:
        raise _refusal(text)
    [(kind, content)] = data.items()
    if kind not in _FORMS or not _FORMS[kind](content):
        raise _refusal(text)
    return Message(kind, content)


def _whole(digits: str) -> int:
    if len(digits) > _DIGITS:
        raise ValueError(digits[:_DIGITS])
    return int(digits)


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("a key twice")
    return found


def _refusal(text: object) -> ChainbuildError:
    return ChainbuildError(f"not a message: {str(text)[:_SHOWN]!r}", permitted=", ".join(_FORMS))


def _number(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return abs(value) < _LARGEST_NUMBER  # a NaN is not


def _numbers(value: object) -> bool:
    return isinstance(value, list) and all(_number(one) for one in value)


def _text(value: object) -> bool:
    return isinstance(value, str)


def _shape(**forms: Callable[[Any], bool]) -> Callable[[Any], bool]:
    """Return what tells an object with exactly some keys, each of its form."""

    def fits(value: object) -> bool:
        return (
            isinstance(value, dict)
            and value.keys() == forms.keys()
            and all(forms[key](one) for key, one in value.items())
        )

    return fits


def _table(form: Callable[[Any], bool]) -> Callable[[Any], bool]:
    return lambda value: isinstance(value, dict) and all(form(one) for one in value.values())


def _absent(value: object) -> bool:
    return value is None


_ABOUT: Final[Mapping[str, str]] = MappingProxyType({"datum": "key", "convention": "name", "ask": "id"})
_FK = _shape(id=_number, fk=_numbers)
_IK = _shape(id=_number, ik=_numbers, start=_numbers)
_IK_ALL = _shape(id=_number, ik_all=_numbers, start=_numbers)
_FORMS: Final[Mapping[str, Callable[[Any], bool]]] = MappingProxyType(
    {
        "axes": _numbers,
        "datum": _shape(key=_text, value=_number),
        "reset": lambda value: value is None or isinstance(value, str),
        "convention": _shape(name=_text, choice=_text),
        "moves": _text,
        "kinematic": lambda value: isinstance(value, int) and not isinstance(value, bool),
        "section": lambda value: value is None or (isinstance(value, str) and value in SECTIONS),
        "restore": _shape(values=_table(_number), choices=_table(_text), axes=_numbers),
        "model": _absent,
        "presets": _absent,
        "ask": lambda value: _FK(value) or _IK(value) or _IK_ALL(value),
    }
)
