"""The active tool: from the overlay, else the only cutting edge that the file gives."""

from __future__ import annotations

from collections.abc import Mapping

from chainbuild.errors import OverlayError, Span
from chainbuild.findings import Collector
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.sinumerik.geometry.tool import Tool
from chainbuild.formats.sinumerik.reading.catalogue import lookup
from chainbuild.formats.sinumerik.reading.data_table import DataTable

_CHOOSERS = ("number", "edge", "plane")
_PLANES = (17, 18, 19)
_G17 = 17
_DATA = (
    "DP1", "DP3", "DP4", "DP5", *(f"DPC{n}" for n in range(1, 11)),
    "DPV", "DPV3", "DPV4", "DPV5", "DPVN3", "DPVN4", "DPVN5",
)  # fmt: skip


def active_tool(table: DataTable, overlay: Overlay, collector: Collector) -> Tool:
    """Return the active tool.

    The overlay's table `tool` may hold tool data (`TC_DP3 = 120`), name a tool of the file (`number = 4`, `edge = 1`)
    and the working plane (`plane = 18`); its data win over the file's. Without it the only cutting edge of the file is
    active; of several none is.

    Raises:
        OverlayError: an unknown key, a list, a plane other than 17, 18, 19, or a tool the file does not hold.
    """
    settings = _settings(overlay)
    plane = int(settings.get("plane", _G17))
    if plane not in _PLANES:
        raise _error(overlay, "plane", "17, 18 or 19")
    values, name, span = _from_file(table, overlay, settings, collector)
    own = {key.removeprefix("TC_"): value for key, value in settings.items() if key not in _CHOOSERS}
    if own:
        values, name = {**values, **own}, f"{name} and overlay" if name else "overlay"
    return _tool(values, plane, name, span)


def _settings(overlay: Overlay) -> dict[str, float]:
    settings: dict[str, float] = {}
    for key, value in overlay.tool.items():
        name = key.removeprefix("TC_")
        if key not in _CHOOSERS and (name not in _DATA or not key.startswith("TC_")):
            raise _error(overlay, key, ", ".join((*_CHOOSERS, *(f"TC_{known}" for known in _DATA))))
        if isinstance(value, tuple):
            raise _error(overlay, key, "a number")
        datum = None if key in _CHOOSERS else lookup(f"$TC_{name}")
        whole = key in _CHOOSERS or (datum is not None and datum.type == "int")
        if whole and value != int(value):
            raise _error(overlay, key, "an integer")
        settings[key] = value
    return settings


def _error(overlay: Overlay, key: str, permitted: str) -> OverlayError:
    return overlay.error(f"the overlay's tool cannot hold this {key}", ("tool", key), permitted)


def _from_file(
    table: DataTable, overlay: Overlay, settings: Mapping[str, float], collector: Collector
) -> tuple[dict[str, float], str, Span | None]:
    edges = table.tools()
    if "number" in settings:
        wanted = (int(settings["number"]), int(settings.get("edge", 1)))
        if wanted not in edges:
            known = ", ".join(f"T{t} D{d}" for t, d in sorted(edges)) or "none: the file holds no tools"
            raise _error(overlay, "number", known)
    elif len(edges) == 1:
        (wanted,) = edges
        span = next(iter(edges[wanted].values())).span
        collector.add("CB338", f"tool T{wanted[0]} D{wanted[1]} is the only one of the file and is active", span=span)
    else:
        if edges and not settings.keys() - set(_CHOOSERS):
            text = f"the file holds {len(edges)} cutting edges; none is active"
            collector.add("CB337", text, span=Span(table.reading.file), hint="name one in the overlay: tool.number")
        return {}, "", None
    rows = edges[wanted]
    values = {name: row.value for name, row in rows.items() if not isinstance(row.value, str)}
    return values, f"T{wanted[0]} D{wanted[1]}", next(iter(rows.values())).span


def _tool(values: Mapping[str, float], plane: int, name: str, span: Span | None) -> Tool:
    def get(key: str) -> float:
        return values.get(key, 0.0)

    return Tool(
        lengths_mm=(get("DP3"), get("DP4"), get("DP5")),
        angles_deg=tuple(get(f"DPC{n}") for n in range(1, 11)),
        predefined=int(get("DPV")),
        direction=(get("DPV3"), get("DPV4"), get("DPV5")),
        normal=(get("DPVN3"), get("DPVN4"), get("DPVN5")),
        plane=plane,
        name=name,
        span=span,
    )
