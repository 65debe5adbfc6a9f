"""The overlay `NAME.chainbuild.toml` beside a machine file: what machine data do not contain."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final

from chainbuild import tolerances
from chainbuild.chain.bodies.geometry import NO_GEOMETRY, Geometry
from chainbuild.chain.bodies.geometry_table import geometry_from_table
from chainbuild.chain.bodies.rods import with_rods
from chainbuild.chain.drives import DriveLimit
from chainbuild.chain.elements import Axis, Chain, Link
from chainbuild.convention import check_choice
from chainbuild.errors import ChainError, FileAccessError, MachineDataError, OverlayError, Span
from chainbuild.formats.text import read_source, toml_line

SUFFIX = ".chainbuild.toml"
_DRIVES: Final = "drives"  # the table within [limits] and [speeds]
_DEEP_KEY = re.compile(r"""(?:\.[ \t]*["']?[\w-]+["']?[ \t]*){50}""")


@dataclass(frozen=True, slots=True)
class Overlay:
    """Contents of an overlay; every key is optional.

    Attributes:
        path: The overlay's file, None where there is none.
        name: Display name of the machine.
        source: Where its numbers come from.
        limits: Axis name → (lower, upper) in mm or degrees.
        drive_limits: The same of drives (`[limits.drives]`), by the names of their axes.
        speeds: Axis name → mm/s or deg/s.
        drive_speeds: The same of drives (`[speeds.drives]`).
        endless: Names of axes that turn without end.
        conventions: Convention name → choice.
        tool_length_mm: Length of the tool in the spindle, added to `tool_length_mm` of `Machine.chain`.
        tool: ROBX tool data such as `TC_DP3`, names as in the machine data without `$`.
        axis_lists: Files with TwinCAT axis lists, relative to the overlay.
        kinematic: Default kinematic id, name or transformation number.
        geometry: Bodies for drawings and collision.
    """

    path: Path | None = None
    name: str | None = None
    source: str | None = None
    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    drive_limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    speeds: Mapping[str, float] = field(default_factory=dict)
    drive_speeds: Mapping[str, float] = field(default_factory=dict)
    endless: tuple[str, ...] = ()
    conventions: Mapping[str, str] = field(default_factory=dict)
    tool_length_mm: float = 0.0
    tool: Mapping[str, float | tuple[float, ...]] = field(default_factory=dict)
    axis_lists: tuple[Path, ...] = ()
    kinematic: int | str | None = None
    geometry: Geometry = NO_GEOMETRY

    def apply_limits(self, axes: tuple[Axis, ...], behind: Collection[str] = ()) -> tuple[Axis, ...]:
        """Return the axes with the overlay's limits, speeds and endless axes.

        Args:
            axes: The axes.
            behind: Names of axes whose drives do not stand at their values; what is said of these drives is left out.

        Raises:
            OverlayError: the overlay names an axis that the kinematic does not have, an endless one that is linear, or
                limits of an axis and its drive that leave nothing.
        """
        kinds = {axis.name: axis.kind for axis in axes}
        named: list[tuple[tuple[str, ...], str]] = [(("limits", name), name) for name in self.limits]
        named += [(("speeds", name), name) for name in self.speeds]
        named += [(("limits", _DRIVES, name), name) for name in self.drive_limits]
        named += [(("speeds", _DRIVES, name), name) for name in self.drive_speeds]
        for keys, name in (*named, *((("endless", name), name) for name in self.endless)):
            if name not in kinds:
                raise self.error(f"the kinematic has no axis '{name}'", keys, ", ".join(kinds))
            if keys[0] == "endless" and kinds[name] == "linear":
                rotary = ", ".join(axis for axis, kind in kinds.items() if kind == "rotary") or "none"
                raise self.error(f"axis '{name}' is linear and cannot turn without end", keys, rotary)
        limited = (self._limited(axis) for axis in axes)
        return tuple(axis if axis.name in behind else self._by_drive(axis) for axis in limited)

    def drive_limit(self, axis: Axis, known: DriveLimit) -> DriveLimit:
        """Return the limits and speed of an axis' drive, those of the overlay where it gives them."""
        lower, upper = self.drive_limits.get(axis.name, (known.lower, known.upper))
        return DriveLimit(known.axis, lower, upper, self.drive_speeds.get(axis.name, known.max_speed))

    def apply_geometry(self, chain: Chain) -> Chain:
        """Return the chain with the overlay's radii, bodies and rods.

        Raises:
            OverlayError: the overlay names a link that the chain does not have, or rods where there can be none.
        """
        if self.geometry == NO_GEOMETRY:
            return chain
        if self.geometry.rods:
            try:
                chain = with_rods(chain, self.geometry.rod_data)
            except ChainError as error:
                permitted = "rods of arms whose axes 2 and 3 are parallel"
                raise self.error(error.message, ("geometry", "rods"), permitted) from None
        known = [link.name for link in chain.links]
        for name in self.geometry.links:
            if name not in known:
                raise self.error(f"the kinematic has no link '{name}'", ("geometry", name), ", ".join(known))
        radii = self.geometry.radii
        links = tuple(Link(link.name, radii.get(link.name, link.radius)) for link in chain.links)
        return replace(chain, links=links, geometry=self.geometry)

    def _limited(self, axis: Axis) -> Axis:
        if axis.name in self.limits:
            lower, upper = self.limits[axis.name]
            axis = replace(axis, lower=lower, upper=upper, assumed=False)
        if axis.name in self.speeds:
            axis = replace(axis, max_speed=self.speeds[axis.name])
        return replace(axis, endless=axis.endless or axis.name in self.endless)

    def _by_drive(self, axis: Axis) -> Axis:
        """Return an axis with the limits of a drive that stands at its value."""
        lower, upper = self.drive_limits.get(axis.name, (axis.lower, axis.upper))
        if axis.name in self.limits:
            lower, upper = max(lower, axis.lower), min(upper, axis.upper)
        if not lower < upper:
            text = f"the limits of axis '{axis.name}' and those of its drive have no value in common"
            raise self.error(text, ("limits", _DRIVES, axis.name), "ranges that overlap")
        speeds = [one for one in (axis.max_speed, self.drive_speeds.get(axis.name)) if one is not None]
        assumed = axis.assumed and axis.name not in self.drive_limits
        return replace(axis, lower=lower, upper=upper, assumed=assumed, max_speed=min(speeds, default=None))

    def span(self, *keys: str) -> Span | None:
        """Return the place of a key in the file, such as ("limits", "A1"); None where there is no file."""
        return None if self.path is None else _span(self.path, *keys)

    def at_key(self, error: MachineDataError, key: str) -> MachineDataError:
        """Return an error that points at the overlay's key, where it gives one, in place of the machine file."""
        if getattr(self, key) is not None:
            error.span = self.span(key) or error.span
        return error

    def error(self, text: str, keys: tuple[str, ...], permitted: str) -> OverlayError:
        """Return an error that points at a key."""
        return OverlayError(text, span=self.span(*keys), parameter=".".join(keys), permitted=permitted)


def _span(path: Path, *keys: str) -> Span:
    try:
        lines = read_source(path, may_be_empty=True).lines()
    except FileAccessError:
        return Span(str(path))
    number = toml_line(lines, keys)
    return Span(str(path), number, 1, lines[number - 1]) if number else Span(str(path))


def overlay_path(machine_file: Path) -> Path:
    """Return where the overlay of a machine file is looked for."""
    return machine_file.with_name(machine_file.stem + SUFFIX)


def read_overlay(path: Path) -> Overlay:
    """Read an overlay.

    Raises:
        FileAccessError: the file cannot be read; an empty one is permitted.
        OverlayError: TOML syntax, an unknown key (the known ones are listed), or a value of the wrong kind.
    """
    text = read_source(path, may_be_empty=True).text
    data = _toml(path, text)
    values: dict[str, Any] = {}
    for key, value in data.items():
        reader = _READERS.get(key)
        if reader is None:
            raise OverlayError(
                f"unknown key '{key}'", span=_span(path, key), parameter=key, permitted=", ".join(_READERS)
            )
        if key in ("limits", "speeds") and isinstance(value, dict) and isinstance(value.get(_DRIVES), dict):
            values[f"drive_{key}"] = reader(path, f"{key}.{_DRIVES}", value[_DRIVES])
            value = {name: one for name, one in value.items() if name != _DRIVES}  # noqa: PLW2901
        values[key] = reader(path, key, value)
    return Overlay(path=path, **values)


def _toml(path: Path, text: str) -> dict[str, Any]:
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


def find_overlay(machine_file: Path, named: Path | None = None) -> Overlay:
    """Return the overlay named, else the one beside the machine file, else an empty one."""
    if named is not None:
        return read_overlay(named)
    beside = overlay_path(machine_file)
    try:
        present = beside.is_file()
    except OSError as error:
        raise FileAccessError(f"cannot look for the overlay: {error}", span=Span(str(beside))) from None
    return read_overlay(beside) if present else Overlay()


def _refuse(path: Path, key: str, permitted: str, text: str = "") -> OverlayError:
    """Return the error of a value; `key` has its table before a dot."""
    text = text or f"the value of '{key}' has the wrong type"
    table, _, name = key.partition(".")
    inner, _, of_drive = name.partition(".")
    keys = (inner, of_drive) if inner == _DRIVES and of_drive else (name,) if name else ()
    return OverlayError(text, span=_span(path, table, *keys), parameter=key, permitted=permitted)


def _number(path: Path, key: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise _refuse(path, key, "a finite number")
    if not abs(value) < tolerances.HUGE_AXIS_VALUE:
        shown = f"'{key}' is {value:g}" if isinstance(value, float) else f"'{key}' is too large"
        raise _refuse(path, key, f"a finite number below {tolerances.HUGE_AXIS_VALUE:g}", shown)
    return float(value)


def _text(path: Path, key: str, value: object) -> str:
    if not isinstance(value, str):
        raise _refuse(path, key, "a string")
    return value


def _table(path: Path, key: str, value: object) -> dict[str, object]:
    if not isinstance(value, dict):
        raise _refuse(path, key, f"a table [{key}]")
    return value


def _limits(path: Path, key: str, value: object) -> dict[str, tuple[float, float]]:
    result = {}
    for axis, pair in _table(path, key, value).items():
        place = f"{key}.{axis}"
        if not isinstance(pair, list) or len(pair) != 2:
            raise _refuse(path, place, "[lower, upper] in mm or degrees")
        lower, upper = _number(path, place, pair[0]), _number(path, place, pair[1])
        if not lower < upper:
            text = f"the limits of axis '{axis}' leave no range: {lower:g} to {upper:g}"
            raise _refuse(path, place, "lower below upper", text)
        result[axis] = (lower, upper)
    return result


def _speeds(path: Path, key: str, value: object) -> dict[str, float]:
    speeds = {axis: _number(path, f"{key}.{axis}", speed) for axis, speed in _table(path, key, value).items()}
    for axis, speed in speeds.items():
        if speed <= 0:
            text = f"the speed of axis '{axis}' is {speed:g}"
            raise _refuse(path, f"{key}.{axis}", "a speed above 0 in mm/s or deg/s", text)
    return speeds


def _names(path: Path, key: str, value: object) -> tuple[str, ...]:
    if not isinstance(value, list) or not all(isinstance(item, str) for item in value):
        raise _refuse(path, key, "a list of strings")
    return tuple(value)


def _conventions(path: Path, key: str, value: object) -> dict[str, str]:
    chosen = {name: _text(path, f"{key}.{name}", choice) for name, choice in _table(path, key, value).items()}
    for name, choice in chosen.items():
        check_choice(name, choice, _span(path, key, name))
    return chosen


def _tool(path: Path, key: str, value: object) -> dict[str, float | tuple[float, ...]]:
    result: dict[str, float | tuple[float, ...]] = {}
    for name, entry in _table(path, key, value).items():
        place = f"{key}.{name}"
        if isinstance(entry, list):
            result[name] = tuple(_number(path, place, item) for item in entry)
        else:
            result[name] = _number(path, place, entry)
    return result


def _files(path: Path, key: str, value: object) -> tuple[Path, ...]:
    return tuple(path.parent / name for name in _names(path, key, value))


def _kinematic(path: Path, key: str, value: object) -> int | str:
    if isinstance(value, bool) or not isinstance(value, int | str) or value == "":
        raise _refuse(path, key, "an id or a name")
    return value


def _geometry(path: Path, key: str, value: object) -> Geometry:
    table = _table(path, key, value)

    def refuse(name: str, permitted: str) -> OverlayError:
        text = f"the value of '{name}' has the wrong type"
        return OverlayError(text, span=_span(path, key, name), parameter=name, permitted=permitted)

    return geometry_from_table(table, path.parent, refuse)


_READERS = {
    "name": _text,
    "source": _text,
    "limits": _limits,
    "speeds": _speeds,
    "endless": _names,
    "conventions": _conventions,
    "tool_length_mm": _number,
    "tool": _tool,
    "axis_lists": _files,
    "kinematic": _kinematic,
    "geometry": _geometry,
}
