"""The overlay's table `[geometry]` as `Geometry`: lengths in mm become metres."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final, get_args

from chainbuild.chain.bodies.geometry import ColumnSide, Geometry, Numbers, RodData, Shape, ShapeKind, Stand, Style
from chainbuild.errors import ChainbuildError
from chainbuild.units import m_from_mm

# From a key and what it permits to the error.
Refuse = Callable[[str, str], ChainbuildError]

_ROD_KEYS: Final = ("crank_mm", "crank_angle_deg", "rod_radius_mm", "rod_sideways_mm")
_STAND_KEYS: Final = ("style", "column", "table_mm", "part_mm")
_KEYS: Final = ("radii_mm", "shapes", "rods", *_ROD_KEYS, "ignore", *_STAND_KEYS)
_STYLES: Final = get_args(Style)
_SIDES: Final = get_args(ColumnSide)
_SHAPE_COUNTS: Final[Mapping[ShapeKind, int]] = {"capsule": 6, "cylinder": 6, "sphere": 3, "box": 3}
_FILE_KINDS: Final[tuple[ShapeKind, ...]] = ("hull", "mesh")
_MESH_UNIT: Final = 0.001  # meshes of machines are drawn in mm


def geometry_from_table(table: Mapping[str, object], folder: Path, refuse: Refuse) -> Geometry:
    """Return the geometry that a table of an overlay gives.

    Args:
        table: The table as TOML gives it.
        folder: Folder of the overlay: files of meshes are relative to it.
        refuse: Makes the error for a key and what it permits.

    Raises:
        ChainbuildError: an unknown key or a value of the wrong kind, made by `refuse`.
    """
    reader = _Reader(folder, refuse)
    for key in table:
        if key not in _KEYS:
            raise refuse(key, ", ".join(_KEYS))
    rods = table.get("rods", False)
    if not isinstance(rods, bool):
        raise refuse("rods", "true or false")
    return Geometry(
        radii={link: reader.length(link, value) for link, value in reader.table("radii_mm", table).items()},
        shapes={link: reader.shapes(link, value) for link, value in reader.table("shapes", table).items()},
        rods=rods,
        rod_data=reader.rods(table),
        ignore=reader.pairs(table.get("ignore", [])),
        stand=reader.stand(table),
    )


class _Reader:
    """Reads values of the table; every refusal names its key."""

    def __init__(self, folder: Path, refuse: Refuse) -> None:
        self.folder, self.refuse = folder, refuse

    def table(self, key: str, table: Mapping[str, object]) -> Mapping[str, object]:
        value = table.get(key, {})
        if not isinstance(value, dict):
            raise self.refuse(key, f"a table [geometry.{key}]")
        return value

    def number(self, key: str, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e9:
            raise self.refuse(key, "a finite number")
        return float(value)

    def length(self, key: str, value: object) -> float:
        """Return a length above 0 given in mm, in metres."""
        number = self.number(key, value)
        if number <= 0.0:
            raise self.refuse(key, "a length above 0 in mm")
        return m_from_mm(number)

    def numbers(self, key: str, value: object, count: int) -> Numbers:
        if not isinstance(value, list) or len(value) != count:
            raise self.refuse(key, f"a list of {count} numbers")
        return tuple(self.number(key, item) for item in value)

    def rods(self, table: Mapping[str, object]) -> RodData:
        default = RodData()
        crank, radius = table.get("crank_mm"), table.get("rod_radius_mm")
        angle = table.get("crank_angle_deg", default.angle_deg)
        return RodData(
            crank=None if crank is None else self.length("crank_mm", crank),
            angle_deg=self.number("crank_angle_deg", angle),
            radius=None if radius is None else self.length("rod_radius_mm", radius),
            sideways=m_from_mm(self.number("rod_sideways_mm", table.get("rod_sideways_mm", 0.0))),
        )

    def stand(self, table: Mapping[str, object]) -> Stand:
        style, column, plate, part = (table.get(key) for key in _STAND_KEYS)
        if style not in (None, *_STYLES):
            raise self.refuse("style", f"one of {', '.join(_STYLES)}")
        if column not in (None, *_SIDES):
            raise self.refuse("column", f"one of {', '.join(_SIDES)}")
        edges = None if part is None else tuple(m_from_mm(edge) for edge in self.numbers("part_mm", part, 3))
        if edges is not None and min(edges) < 0.0:
            raise self.refuse("part_mm", "three edges of at least 0 in mm")
        return Stand(
            style=style,  # type: ignore[arg-type]
            column=column,  # type: ignore[arg-type]
            table=None if plate is None else self.length("table_mm", plate),
            part=edges,
        )

    def pairs(self, value: object) -> tuple[tuple[str, str], ...]:
        if not isinstance(value, list):
            raise self.refuse("ignore", "a list of pairs of links")
        found = []
        for pair in value:
            if not isinstance(pair, list) or len(pair) != 2 or not all(isinstance(link, str) for link in pair):
                raise self.refuse("ignore", "a list of pairs of links")
            found.append((pair[0], pair[1]))
        return tuple(found)

    def shapes(self, link: str, value: object) -> tuple[Shape, ...]:
        if not isinstance(value, list) or not all(isinstance(entry, dict) for entry in value):
            raise self.refuse(link, "a list of bodies such as {sphere = [0, 0, 0], radius_mm = 50}")
        return tuple(self._shape(link, entry) for entry in value)

    def _shape(self, link: str, entry: Mapping[str, object]) -> Shape:
        kinds = [kind for kind in (*_SHAPE_COUNTS, *_FILE_KINDS) if kind in entry]
        if len(kinds) != 1:
            raise self.refuse(link, f"one of {', '.join((*_SHAPE_COUNTS, *_FILE_KINDS))} in each body")
        kind = kinds[0]
        extra = {"radius_mm"} if kind in ("capsule", "cylinder", "sphere") else {"at"}
        extra |= {"scale"} if kind in _FILE_KINDS else set()
        unknown = sorted(entry.keys() - {kind} - extra)
        if unknown:
            raise self.refuse(link, f"{kind} with {', '.join(sorted(extra))}, not {unknown[0]}")
        place = self._place(link, entry.get("at"))
        if kind in _FILE_KINDS:
            return self._from_file(link, kind, entry, place)
        count = _SHAPE_COUNTS[kind]
        values = tuple(m_from_mm(number) for number in self.numbers(link, entry[kind], count))
        if kind == "box":
            if min(values) <= 0.0:
                raise self.refuse(link, "edges above 0 in mm")
            return Shape("box", size=values, place=place)
        if count == 6 and values[:3] == values[3:]:
            raise self.refuse(link, f"two different ends of the {kind}")
        return Shape(kind, points=values, radius=self.length(link, entry.get("radius_mm")))

    def _place(self, link: str, value: object) -> Numbers:
        if value is None:
            return (0.0,) * 6
        numbers = self.numbers(link, value, 6)
        return (*(m_from_mm(number) for number in numbers[:3]), *numbers[3:])

    def _from_file(self, link: str, kind: ShapeKind, entry: Mapping[str, object], place: Numbers) -> Shape:
        name = entry[kind]
        if not isinstance(name, str):
            raise self.refuse(link, "the file name of a mesh")
        scale = self.number(link, entry.get("scale", _MESH_UNIT))
        if scale <= 0.0:
            raise self.refuse(link, "a scale above 0, metres per unit of the file")
        return Shape(kind, place=place, file=self.folder / name, scale=(scale, scale, scale))
