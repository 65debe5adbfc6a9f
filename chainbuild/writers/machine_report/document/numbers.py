"""Numbers of a report: the same digits on every processor.

The last bits of sines and products differ between processors. A number is therefore brought to a grid finer than the
one it is shown on first: a length given to the digit shown does not fall with its last bit.

>>> decimal(0.1 + 0.2, 6), decimal(-1.2e-15, 6), decimal(25.0, 6), fixed(-0.00004, 3)
('0.3', '0', '25', '0.000')
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Final

from chainbuild.chain.elements import Axis
from chainbuild.units import AxisUnit

_FINER: Final = 3  # decimals more in which the noise of a product lies
_SHORTER: Final = 3  # decimals fewer of a number that noise made long
_NOISE: Final = 50.0  # last digits: what URDF files, which round right angles, leave in products
_DATA: Final = 6  # decimals of mm and degrees: finer than any machine datum
_HALF_TURN: Final = -180.0  # degrees: the same angle as +180, between which the last bit would choose
_SIGNS: Final[dict[AxisUnit, str]] = {"deg": "°", "mm": "\u00a0mm"}


def decimal(value: float, places: int = _DATA) -> str:
    """Return a number with at most so many decimals, those that are 0 left out."""
    text = fixed(value, places)
    return text.rstrip("0").rstrip(".") if "." in text else text


def fixed(value: float, places: int) -> str:
    """Return a number with so many decimals, 0 without a sign."""
    return f"{round(round(value, places + _FINER), places) + 0.0:.{places}f}"


def neat(value: float, places: int) -> float:
    """Return a number without the noise of its last two of so many decimals, where a shorter number is as near.

    >>> neat(-89.159000004, 9), neat(817.25012345, 9)
    (-89.159, 817.25012345)
    """
    shorter = round(value, places - _SHORTER)
    return shorter if abs(value - shorter) < _NOISE * 10.0**-places else value


def angle(value: float, places: int) -> str:
    """Return an angle [degrees] with so many decimals: half a turn is positive."""
    return fixed(-value if round(value, places) == _HALF_TURN else value, places)


def named_values(axes: Sequence[Axis], values: Iterable[float], places: int = _DATA) -> str:
    """Return axis values by name: "A1 30°, X 12.5 mm"."""
    # No line ends between a name and its value.
    pairs = zip(axes, values, strict=True)
    return ", ".join(f"{axis.name}\u00a0{with_unit(float(value), axis.unit, places)}" for axis, value in pairs)


def with_unit(value: float, unit: AxisUnit, places: int = _DATA) -> str:
    """Return a value with its unit: "30°", "12.5 mm"."""
    return f"{decimal(value, places)}{_SIGNS[unit]}"
