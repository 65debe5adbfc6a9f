"""Tool: lengths by plane and tool direction, orientation by $TC_DPC angles or $TC_DPV vectors (ROBX manual 6.1).

The active tool is the overlay's, else the only cutting edge that the file gives.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild import frames, tolerances
from chainbuild.arrays import Matrix
from chainbuild.convention import Choices
from chainbuild.errors import MachineDataError, OverlayError, Span
from chainbuild.findings import Collector
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.sinumerik.reading.assignment import Assignment
from chainbuild.formats.sinumerik.reading.catalogue import lookup
from chainbuild.formats.sinumerik.reading.data_table import DataTable
from chainbuild.formats.sinumerik.reading.robx import Robx, Vector3

# Flange axis along which lengths 1, 2 and 3 act. Only G17 is printed.
_PLANES: Mapping[str, Mapping[int, str]] = {
    "cyclic": {17: "zyx", 18: "yxz", 19: "xzy"},
    "swapped": {17: "zyx", 18: "yzx", 19: "xyz"},
    "as_g17": {17: "zyx", 18: "zyx", 19: "zyx"},
}


@dataclass(frozen=True, slots=True)
class Tool:
    """The active tool.

    Attributes:
        lengths_mm: Lengths 1, 2, 3: $TC_DP3 … $TC_DP5, with wear $TC_DP12 … and base lengths $TC_DP21 … added.
        radius_mm: Radius with its wear: $TC_DP6 + $TC_DP15.
        angles_deg: $TC_DPC1 … $TC_DPC10.
        predefined: $TC_DPV; 0 takes the vector.
        direction: $TC_DPV3 … $TC_DPV5.
        normal: $TC_DPVN3 … $TC_DPVN5.
        plane: 17, 18 or 19.
        name: "T1 D1" where a file gives it, "overlay", or empty for no tool.
        span: Where it is given.
    """

    lengths_mm: Vector3 = (0.0, 0.0, 0.0)
    radius_mm: float = 0.0
    angles_deg: tuple[float, ...] = (0.0,) * 10
    predefined: int = 0
    direction: Vector3 = (0.0, 0.0, 0.0)
    normal: Vector3 = (0.0, 0.0, 0.0)
    plane: int = 17
    name: str = ""
    span: Span | None = None

    def along_flange(self, components: Vector3, choose: Choices) -> Matrix:
        """Return a vector whose components are counted like lengths 1, 2, 3 in flange axes."""
        axes = _PLANES["as_g17" if self.plane == 17 else choose["tool_length_plane"]][self.plane]
        result = np.zeros(3)
        for component, axis in zip(components, axes, strict=True):
            result["xyz".index(axis)] = component
        return result


def length_transform(robx: Robx, tool: Tool, tool_length_mm: float, choose: Choices) -> Matrix:
    """Return Trans(lengths) along the carrier's axes; TOOL_DIR other than 0 negates them (ROBX manual 6.1.3)."""
    first, second, third = tool.lengths_mm
    sign = 1.0 if robx.tool_dir == 0 else -1.0
    return frames.transform(None, sign * tool.along_flange((first + tool_length_mm, second, third), choose) + 0.0)


def turn_transform(robx: Robx, tool: Tool, choose: Choices) -> Matrix:
    """Return the rotation of the tool about its tip: $TC_DPC angles, $TC_DPV vectors, or none (MD62936)."""
    start = robx.toa_start
    if start > 0:
        a, b, c = tool.angles_deg[start - 1 : start + 2]
        return frames.f_frame((0.0, 0.0, 0.0), (a, b, c))
    return frames.transform(_from_vectors(robx, tool, choose)) if start < 0 else np.eye(4)


def _from_vectors(robx: Robx, tool: Tool, choose: Choices) -> Matrix:
    """Return the rotation whose tool axis is $TC_DPV and whose normal axis is $TC_DPVN."""
    if tool.predefined:
        raise MachineDataError(
            f"$TC_DPV = {tool.predefined} selects a predefined direction that the ROBX manual does not describe",
            span=tool.span,
            parameter="$TC_DPV",
            permitted="0, with the vector in $TC_DPV3 to $TC_DPV5",
            code="CB336",
        )
    vector = tool.along_flange(tool.direction, choose)
    if np.linalg.norm(vector) < tolerances.ZERO_VECTOR:
        return np.eye(3)
    forward = frames.unit(vector)
    along_z = robx.tool_dir == 1
    normal = tool.along_flange(tool.normal, choose)
    across = normal - forward * (normal @ forward)
    if np.linalg.norm(across) <= tolerances.UNIT_VECTOR * max(float(np.linalg.norm(normal)), tolerances.ZERO_VECTOR):
        return _smallest_turn(np.array([0.0, 0.0, 1.0] if along_z else [1.0, 0.0, 0.0]), forward)
    n = frames.unit(across)
    third = np.cross(forward, n)
    if choose["dpvn_axis"] == "y":
        columns = (-third, n, forward) if along_z else (forward, n, third)
    else:
        columns = (n, third, forward) if along_z else (forward, -third, n)
    return np.column_stack(columns)


def _smallest_turn(start: Matrix, end: Matrix) -> Matrix:
    """Return the smallest rotation from one unit vector to another; for opposite ones half a turn about Y."""
    axis = np.cross(start, end)
    sine, cosine = float(np.linalg.norm(axis)), float(start @ end)
    if sine < tolerances.ZERO_VECTOR:
        return np.eye(3) if cosine > 0 else frames.rot_y(180.0)
    return frames.rot_about(axis, float(np.degrees(np.arctan2(sine, cosine))))


_CHOOSERS = ("number", "edge", "plane")
_WORKING_PLANES: Final = (17, 18, 19)  # G codes of the working planes
_G17: Final = 17  # the plane that the control starts with
_DATA = (
    "DP1", "DP3", "DP4", "DP5", "DP6", "DP12", "DP13", "DP14", "DP15", "DP21", "DP22", "DP23",
    *(f"DPC{n}" for n in range(1, 11)), "DPV", "DPV3", "DPV4", "DPV5", "DPVN3", "DPVN4", "DPVN5",
)  # fmt: skip


# Each length is the sum of geometry, wear and base dimension.
_LENGTHS = (("DP3", "DP12", "DP21"), ("DP4", "DP13", "DP22"), ("DP5", "DP14", "DP23"))
_RADIUS = ("DP6", "DP15")


def tools_of_channels(
    table: DataTable, channels: Sequence[int], overlay: Overlay, collector: Collector
) -> Mapping[int, Tool]:
    """Return the active tool of each channel: that of the tool area the channel is linked to (MD28085).

    Raises:
        OverlayError: see `active_tool`.
    """
    areas = {number: _area(table, number) for number in channels}
    others = [area for area in table.tool_areas() if area not in areas.values()]
    if others:
        text = f"tools of other channels are not used: tool area {', '.join(map(str, others))}"
        collector.add("CB126", text, span=Span(table.reading.file), hint="$MC_MM_LINK_TOA_UNIT links a channel to one")
    tools = {area: active_tool(table, overlay, collector, area) for area in dict.fromkeys(areas.values())}
    return {number: tools[area] for number, area in areas.items()}


def _area(table: DataTable, channel: int) -> int:
    """Return the tool area of a channel, 0 where the file has no areas; by default the channel's own number."""
    if not table.tool_areas():
        return 0
    return int(table.channel(channel).number("MM_LINK_TOA_UNIT")) or channel


def active_tool(table: DataTable, overlay: Overlay, collector: Collector, area: int = 0) -> Tool:
    """Return the active tool of a tool area.

    The overlay's table `tool` may hold tool data (`TC_DP3 = 120`), name a tool of the file (`number = 4`, `edge = 1`)
    and the working plane (`plane = 18`); its data win over the file's. Without it the only cutting edge of the file is
    active; with several, none is.

    Raises:
        OverlayError: an unknown key, a list, a plane other than 17, 18, 19, or a tool the file does not hold.
    """
    settings = _settings(overlay)
    plane = int(settings.get("plane", _G17))
    if plane not in _WORKING_PLANES:
        raise _error(overlay, "plane", "17, 18 or 19")
    rows, name = _from_file(table, area, overlay, settings, collector)
    values = {datum: row.value for datum, row in rows.items() if not isinstance(row.value, str)}
    own = _own(settings)
    if own:
        values, name = {**values, **own}, f"{name} and overlay" if name else "overlay"
    return _tool(values, plane, name, next(iter(rows.values())).span if rows else None)


def active_data(
    table: DataTable, overlay: Overlay, channel: int
) -> tuple[Mapping[str, Assignment], Mapping[str, float]]:
    """Return the active tool's data in the file, and those of the overlay, which win, by names such as "DP3".

    Raises:
        OverlayError: see `active_tool`.
    """
    settings = _settings(overlay)
    rows, _ = _from_file(table, _area(table, channel), overlay, settings, Collector(strict=False))
    return rows, _own(settings)


def _own(settings: Mapping[str, float]) -> dict[str, float]:
    """Return the overlay's tool data by their names."""
    return {key.removeprefix("TC_"): value for key, value in settings.items() if key not in _CHOOSERS}


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
    return overlay.error(f"the overlay's [tool] has an invalid {key}", ("tool", key), permitted)


def _from_file(
    table: DataTable, area: int, overlay: Overlay, settings: Mapping[str, float], collector: Collector
) -> tuple[Mapping[str, Assignment], str]:
    edges = table.tools(area)
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
            collector.add("CB337", text, span=Span(table.reading.file), hint="choose one in the overlay: tool.number")
        return {}, ""
    return edges[wanted], f"T{wanted[0]} D{wanted[1]}"


def _tool(values: Mapping[str, float], plane: int, name: str, span: Span | None) -> Tool:
    def get(key: str) -> float:
        return values.get(key, 0.0)

    return Tool(
        lengths_mm=_sums(values),
        radius_mm=math.fsum(get(name) for name in _RADIUS),
        angles_deg=tuple(get(f"DPC{n}") for n in range(1, 11)),
        predefined=int(get("DPV")),
        direction=(get("DPV3"), get("DPV4"), get("DPV5")),
        normal=(get("DPVN3"), get("DPVN4"), get("DPVN5")),
        plane=plane,
        name=name,
        span=span,
    )


def _sums(values: Mapping[str, float]) -> Vector3:
    first, second, third = (math.fsum(values.get(name, 0.0) for name in parts) for parts in _LENGTHS)
    return first, second, third
