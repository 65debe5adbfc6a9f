"""How objects show themselves in an interpreter: at most two lines of text, numbers rounded, units said.

>>> number(-1.2e-15)
'0'
>>> length_shown(0.00123456), angle_shown(0.0)
('1.23 mm', '0 deg')
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, fields, is_dataclass
from typing import Any, Final, TypeVar

from chainbuild.units import AxisLabels, deg_from_rad, mm_from_m

T = TypeVar("T")

WIDTH: Final = 120  # columns of a line
_ROUNDED: Final = 9  # decimals of mm and degrees beyond which there is only noise
_FEW: Final = 8  # values that are shown one by one
_WORDS: Final = 60  # characters of a text within others


def two_lines(text: str) -> str:
    """Return a text on at most two lines; what is longer ends in … and its last character."""
    if len(text) <= WIDTH and "\n" not in text:
        return text
    lines = textwrap.wrap(" ".join(text.split()), WIDTH, break_on_hyphens=False)
    if len(lines) <= 2:
        return "\n".join(lines)
    return f"{lines[0]}\n{lines[1][: WIDTH - 3].rstrip()} …{text[-1]}"


def number(value: float) -> str:
    """Return a number with six digits, noise as 0."""
    return f"{round(value, _ROUNDED) + 0.0:.6g}"


def numbers_shown(values: Iterable[float]) -> str:
    """Return numbers in a row."""
    return ", ".join(number(float(value)) for value in values)


def axes_shown(labels: AxisLabels, values: Iterable[float]) -> str:
    """Return axis values by name, and their units."""
    pairs = ", ".join(f"{name} {number(float(value))}" for name, value in zip(labels.names, values, strict=True))
    return f"{pairs} [{', '.join(dict.fromkeys(labels.units_of_axes))}]"


def length_shown(metres: float) -> str:
    """Return a length in mm."""
    return f"{mm_from_m(metres):.3g} mm"


def angle_shown(radians: float) -> str:
    """Return an angle in degrees."""
    return f"{deg_from_rad(radians):.3g} deg"


def compact(cls: type[T]) -> type[T]:
    """Make a dataclass show its fields on at most two lines, those that stand at their defaults left out."""
    cls.__repr__ = _fields_shown  # type: ignore[method-assign]
    return cls


def _fields_shown(self: Any) -> str:
    parts = []
    for field in fields(self):
        value = getattr(self, field.name)
        default = field.default_factory() if field.default_factory is not MISSING else field.default
        if field.repr and not (type(value) is type(default) and _plain(value) and value == default):
            parts.append(f"{field.name}={_value_shown(value)}")
    return two_lines(f"{type(self).__name__}({', '.join(parts)})")


def _plain(value: object) -> bool:
    return isinstance(value, str | int | float | tuple | Mapping | None)


def _value_shown(value: Any) -> str:
    shape = getattr(value, "shape", None)
    if shape is not None and shape != ():
        few = len(shape) == 1 and shape[0] <= _FEW
        return f"[{numbers_shown(value)}]" if few else f"array{tuple(shape)}"
    for kind, show in _SHOWN.items():
        if isinstance(value, kind):
            return show(value)
    if is_dataclass(value):
        return str(getattr(value, "name", type(value).__name__))
    return textwrap.shorten(repr(value), _WORDS, placeholder=" …")


def _row_shown(values: Any) -> str:
    more = f", … {len(values)} in all" if len(values) > _FEW else ""
    return f"({', '.join(_value_shown(value) for value in list(values)[:_FEW])}{more})"


_SHOWN: Final[dict[type, Callable[[Any], str]]] = {
    bool: str,
    int: str,
    float: number,
    str: lambda text: repr(textwrap.shorten(text, _WORDS, placeholder=" …")),
    tuple: _row_shown,
    list: _row_shown,
    Mapping: lambda table: _row_shown(tuple(table)),
}
