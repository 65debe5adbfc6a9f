"""The overlay `NAME.chainbuild.toml` beside a machine file: what machine data do not contain."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final, TypeVar

from chainbuild.chain.bodies.geometry import NO_GEOMETRY, Geometry
from chainbuild.chain.bodies.geometry_table import geometry_from_table
from chainbuild.chain.bodies.linkage import with_linkage
from chainbuild.chain.drives import DriveLimit
from chainbuild.chain.elements import Axis, Chain, Link
from chainbuild.chain.names import DRIVE_SUFFIX, axis_index, link_names, name_meaning, pose_name_fault
from chainbuild.convention import check_choice
from chainbuild.errors import ChainError, MachineDataError, OverlayError, Span
from chainbuild.formats.text import (
    COUPLED,
    DRIVES,
    POSES,
    SUMS,
    parsed_toml,
    read_source,
    toml_number,
    toml_number_tables,
    toml_refusal,
    toml_span,
    toml_table,
    toml_text,
)

SUFFIX = ".chainbuild.toml"
_T = TypeVar("_T")
_Ends = tuple[float, float]
_INNER: Final = {("limits", DRIVES): "drive_limits", ("limits", SUMS): "sums", ("speeds", DRIVES): "drive_speeds"}


@dataclass(frozen=True, slots=True)
class Overlay:
    """Contents of an overlay; every key is optional.

    Attributes:
        path: The overlay's file, None where there is none.
        name: Display name of the machine.
        source: Where its numbers come from.
        limits: Axis name, the channel's or the generic one → (lower, upper) in mm or degrees.
        drive_limits: The same of drives (`[limits.drives]`), by the names of their axes.
        sums: Sum of axes such as "A2+A3" → (lower, upper) (`[limits.sums]`).
        speeds: Axis name → mm/s or deg/s.
        drive_speeds: The same of drives (`[speeds.drives]`).
        endless: Names of axes that turn without end.
        conventions: Convention name → choice.
        tool_length_mm: Length of the tool in the spindle, added to `tool_length_mm` of `Machine.chain`.
        tool: ROBX tool data such as `TC_DP3`, names as in the machine data without `$`.
        axis_lists: Files with TwinCAT axis lists, relative to the overlay.
        kinematic: Default kinematic id, name or transformation number, or a pair of these for two steps.
        poses: Name of a pose → its axis values in channel order, or axis name → value; mm or degrees.
        geometry: Bodies for drawings and collision.
        coupling: Axis name → name of another axis → share of that one's value in the joint of the first.
    """

    path: Path | None = None
    name: str | None = None
    source: str | None = None
    limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    drive_limits: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    sums: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    speeds: Mapping[str, float] = field(default_factory=dict)
    drive_speeds: Mapping[str, float] = field(default_factory=dict)
    endless: tuple[str, ...] = ()
    conventions: Mapping[str, str] = field(default_factory=dict)
    tool_length_mm: float = 0.0
    tool: Mapping[str, float | tuple[float, ...]] = field(default_factory=dict)
    axis_lists: tuple[Path, ...] = ()
    kinematic: int | str | tuple[int | str, int | str] | None = None
    poses: Mapping[str, Mapping[str, float] | tuple[float, ...]] = field(default_factory=dict)
    geometry: Geometry = NO_GEOMETRY
    coupling: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    def apply_limits(self, axes: tuple[Axis, ...], behind: Collection[int] = ()) -> tuple[Axis, ...]:
        """Return the axes with the overlay's limits, speeds and endless axes.

        Args:
            axes: The axes.
            behind: Indices of axes whose drives do not stand at their values; what is said of these is left out.

        Raises:
            OverlayError: the overlay names an axis that the kinematic does not have, one axis by two names, an endless
                one that is linear, or limits of an axis and its drive that leave nothing.
        """
        limits = self.by_axis(axes, ("limits",), self.limits)
        speeds = self.by_axis(axes, ("speeds",), self.speeds)
        drive_limits = self.by_axis(axes, ("limits", DRIVES), self.drive_limits)
        drive_speeds = self.by_axis(axes, ("speeds", DRIVES), self.drive_speeds)
        endless = self.by_axis(axes, ("endless",), dict.fromkeys(self.endless, True))
        for n in endless:
            if axes[n].kind == "linear":
                rotary = ", ".join(axis.name for axis in axes if axis.kind == "rotary") or "none"
                name = name_meaning(axes, n, self.endless) or axes[n].name
                raise self.error(f"axis '{name}' is linear and cannot turn without end", ("endless", name), rotary)
        found = []
        for n, given in enumerate(axes):
            axis = given
            if n in limits:
                axis = replace(axis, lower=limits[n][0], upper=limits[n][1], assumed=False)
            axis = replace(axis, max_speed=speeds.get(n, axis.max_speed), endless=axis.endless or n in endless)
            known = limits.get(n), drive_limits.get(n), drive_speeds.get(n), name_meaning(axes, n, self.drive_limits)
            found.append(axis if n in behind else self._by_drive(axis, *known))
        return tuple(found)

    def limits_of(self, axes: Sequence[Axis], n: int, *, drives: bool = False) -> tuple[float, float] | None:
        """Return the overlay's limits of the n-th axis, or of its drive, mm or degrees; None where it gives none."""
        given = self.drive_limits if drives else self.limits
        return given.get(name_meaning(axes, n, given) or "")

    def limits_span(self, axes: Sequence[Axis], n: int, *, drives: bool = False) -> Span | None:
        """Return the place of the limits of the n-th axis, or of its drive; None where the overlay gives none."""
        name = name_meaning(axes, n, self.drive_limits if drives else self.limits)
        return None if name is None else self.span("limits", *([DRIVES] if drives else []), name)

    def drive_limit(self, axes: Sequence[Axis], known: DriveLimit) -> DriveLimit:
        """Return the limits and speed of an axis' drive, those of the overlay where it gives them."""
        lower, upper = self.limits_of(axes, known.axis, drives=True) or (known.lower, known.upper)
        speeds = self.by_axis(axes, ("speeds", DRIVES), self.drive_speeds)
        return DriveLimit(known.axis, lower, upper, speeds.get(known.axis, known.max_speed))

    def for_axes(self, axes: Sequence[Axis]) -> Overlay:
        """Return the overlay without what it says of axes that a kinematic does not have."""
        rotary = [n for n, axis in enumerate(axes) if axis.kind == "rotary"]

        def known(values: Mapping[str, _T]) -> dict[str, _T]:
            return {name: value for name, value in values.items() if axis_index(axes, name) is not None}

        return replace(
            self,
            limits=known(self.limits),
            drive_limits=known(self.drive_limits),
            speeds=known(self.speeds),
            drive_speeds=known(self.drive_speeds),
            endless=tuple(name for name in self.endless if axis_index(axes, name) in rotary),
        )

    def by_axis(self, axes: Sequence[Axis], keys: tuple[str, ...], values: Mapping[str, _T]) -> dict[int, _T]:
        """Return values by the index of the axis that their names mean; `keys` names their table for errors."""
        found: dict[int, _T] = {}
        names: dict[int, str] = {}
        for name, value in values.items():
            n = axis_index(axes, name)
            known = ", ".join(axis.name for axis in axes)
            if n is None:
                raise self.error(f"the kinematic has no axis '{name}'", (*keys, name), known)
            if n in names:
                text = f"'{names[n]}' and '{name}' are the same axis {axes[n].name}"
                raise self.error(text, (*keys, name), "one of the two")
            found[n], names[n] = value, name
        return found

    def apply_geometry(self, chain: Chain, also: Mapping[str, str] | None = None) -> Chain:
        """Return the chain with the overlay's radii, bodies and rods; `also`: other names of links → their names there.

        Raises:
            OverlayError: the overlay names a link that the chain does not have, or rods where there can be none.
        """
        if self.geometry == NO_GEOMETRY:
            return chain
        if self.geometry.rods:
            try:
                chain = with_linkage(chain, self.geometry.rod_data)
            except ChainError as error:
                permitted = "rods of arms whose axes 2 and 3 are parallel"
                raise self.error(error.message, ("geometry", "rods"), permitted) from None
        names = {**(also or {}), **link_names(chain)}
        for name in self.geometry.links:
            if name not in names:
                known = ", ".join(link.name for link in chain.links)
                raise self.error(f"the kinematic has no link '{name}'", ("geometry", name), known)
        for table in (self.geometry.radii, self.geometry.shapes):
            seen: dict[str, str] = {}
            for name in table:
                if (other := seen.setdefault(names[name], name)) != name:
                    text = f"'{other}' and '{name}' are the same link {names[name]}"
                    raise self.error(text, ("geometry", name), "one of the two")
        geometry = self.geometry.renamed(names).over(chain.geometry)
        links = tuple(Link(link.name, geometry.radii.get(link.name, link.radius)) for link in chain.links)
        return replace(chain, links=links, geometry=geometry)

    def _by_drive(
        self, axis: Axis, own: _Ends | None, drive: _Ends | None, drive_speed: float | None, written: str | None
    ) -> Axis:
        """Return an axis with the limits and speed of a drive that stands at its value."""
        lower, upper = drive or (axis.lower, axis.upper)
        if own:
            lower, upper = max(lower, axis.lower), min(upper, axis.upper)
        if not lower < upper:
            text = f"the limits of axis '{axis.name}' and those of its drive have no value in common"
            raise self.error(text, ("limits", DRIVES, written or axis.name), "ranges that overlap")
        speeds = [one for one in (axis.max_speed, drive_speed) if one is not None]
        assumed = axis.assumed and not drive
        return replace(axis, lower=lower, upper=upper, assumed=assumed, max_speed=min(speeds, default=None))

    def span(self, *keys: str) -> Span | None:
        """Return the place of a key in the file, such as ("limits", "A1"); None where there is no file."""
        return None if self.path is None else toml_span(self.path, *keys)

    def at_key(self, error: MachineDataError, key: str) -> MachineDataError:
        """Return an error that points at the overlay's key, where it gives one, in place of the machine file."""
        if getattr(self, key) is not None:
            error.span = self.span(key) or error.span
        return error

    def error(self, text: str, keys: tuple[str, ...], permitted: str) -> OverlayError:
        """Return an error that points at a key."""
        return OverlayError(text, span=self.span(*keys), parameter=".".join(keys), permitted=permitted)


NO_OVERLAY: Final = Overlay()


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
    data = parsed_toml(path, text)
    values: dict[str, Any] = {}
    for key, value in data.items():
        reader = _READERS.get(key)
        if reader is None:
            known = ", ".join(_READERS)
            raise OverlayError(f"unknown key '{key}'", span=toml_span(path, key), parameter=key, permitted=known)
        inner = [name for table, name in _INNER if table == key and isinstance(value, dict)]
        for name in (name for name in inner if isinstance(value.get(name), dict)):
            given = {axis.removesuffix(DRIVE_SUFFIX): one for axis, one in value.pop(name).items()}
            values[_INNER[key, name]] = reader(path, f"{key}.{name}", given)
        values[key] = reader(path, key, value)
    return Overlay(path=path, **values)


def _limits(path: Path, key: str, value: object) -> dict[str, tuple[float, float]]:
    result = {}
    for axis, pair in toml_table(path, key, value).items():
        place = f"{key}.{axis}"
        if not isinstance(pair, list) or len(pair) != 2:
            raise toml_refusal(path, place, "[lower, upper] in mm or degrees")
        lower, upper = toml_number(path, place, pair[0]), toml_number(path, place, pair[1])
        if not lower < upper:
            text = f"the limits of axis '{axis}' leave no range: {lower:g} to {upper:g}"
            raise toml_refusal(path, place, "lower below upper", text)
        result[axis] = (lower, upper)
    return result


def _speeds(path: Path, key: str, value: object) -> dict[str, float]:
    speeds = {axis: toml_number(path, f"{key}.{axis}", speed) for axis, speed in toml_table(path, key, value).items()}
    for axis, speed in speeds.items():
        if speed <= 0:
            text = f"the speed of axis '{axis}' is {speed:g}"
            raise toml_refusal(path, f"{key}.{axis}", "a speed above 0 in mm/s or deg/s", text)
    return speeds


def _names(path: Path, key: str, value: object) -> tuple[str, ...]:
    if not isinstance(value, list) or not all(isinstance(item, str) for item in value):
        raise toml_refusal(path, key, "a list of strings")
    return tuple(value)


def _conventions(path: Path, key: str, value: object) -> dict[str, str]:
    chosen = {name: toml_text(path, f"{key}.{name}", choice) for name, choice in toml_table(path, key, value).items()}
    for name, choice in chosen.items():
        check_choice(name, choice, toml_span(path, key, name))
    return chosen


def _poses(path: Path, key: str, value: object) -> dict[str, dict[str, float] | tuple[float, ...]]:
    result: dict[str, dict[str, float] | tuple[float, ...]] = {}
    for name, given in toml_table(path, key, value).items():
        place = f"{key}.{name}"
        if (fault := pose_name_fault(name)) is not None:
            text = f"the pose is called {name[:40]!r}"
            raise OverlayError(text, span=toml_span(path, key, name), parameter=key, permitted=fault)
        if isinstance(given, list):
            result[name] = tuple(toml_number(path, place, one) for one in given)
        elif isinstance(given, dict):
            result[name] = {axis: toml_number(path, f"{place}.{axis}", one) for axis, one in given.items()}
        else:
            raise toml_refusal(path, place, "a list of axis values, or a table of axis = value, in mm and degrees")
    return result


def _tool(path: Path, key: str, value: object) -> dict[str, float | tuple[float, ...]]:
    result: dict[str, float | tuple[float, ...]] = {}
    for name, entry in toml_table(path, key, value).items():
        place = f"{key}.{name}"
        if isinstance(entry, list):
            result[name] = tuple(toml_number(path, place, item) for item in entry)
        else:
            result[name] = toml_number(path, place, entry)
    return result


def _files(path: Path, key: str, value: object) -> tuple[Path, ...]:
    return tuple(path.parent / name for name in _names(path, key, value))


def _kinematic(path: Path, key: str, value: object) -> int | str | tuple[int | str, int | str]:
    def one(part: object) -> int | str:
        if isinstance(part, bool) or not isinstance(part, int | str) or part == "":
            raise toml_refusal(path, key, "an id or a name, or a list of two for the two transformation steps")
        return part

    if isinstance(value, list) and len(value) == 2:
        return one(value[0]), one(value[1])
    return one(value)


def _geometry(path: Path, key: str, value: object) -> Geometry:
    table = toml_table(path, key, value)

    def refuse(name: str, permitted: str) -> OverlayError:
        text = f"the value of '{name}' has the wrong type"
        return OverlayError(text, span=toml_span(path, key, name), parameter=name, permitted=permitted)

    return geometry_from_table(table, path.parent, refuse)


_READERS = {
    "name": toml_text,
    "source": toml_text,
    "limits": _limits,
    "speeds": _speeds,
    "endless": _names,
    "conventions": _conventions,
    "tool_length_mm": toml_number,
    "tool": _tool,
    "axis_lists": _files,
    "kinematic": _kinematic,
    POSES: _poses,
    "geometry": _geometry,
    COUPLED: toml_number_tables,
}
