"""The numbers of a URDF that place its joints, to be shown and tried with other values: origins in mm and degrees."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Final

from chainbuild.formats.entries import Datum, ParameterRow
from chainbuild.formats.urdf.joints import UrdfJoint
from chainbuild.formats.urdf.xml import Node
from chainbuild.units import deg_from_rad, m_from_mm, mm_from_m, rad_from_deg

_ZERO: Final = (0.0, 0.0, 0.0)  # what URDF takes for an attribute that is not given
# Attribute of <origin> → its parts, and what one of them does.
_PARTS: Final = {"xyz": ("x", "y", "z"), "rpy": ("roll", "pitch", "yaw")}
_MEANINGS: Final = {
    "x": "shift along x", "y": "shift along y", "z": "shift along z",
    "roll": "turn about x, before pitch and yaw", "pitch": "turn about y, before yaw", "yaw": "turn about z",
}  # fmt: skip


def origin_data(joints: Sequence[UrdfJoint], channel: int) -> tuple[Datum, ...]:
    """Return the origin of each joint as six numbers, called "NAME.x" … "NAME.yaw"; a 0 counts as not given."""
    return tuple(datum for joint in joints for datum in _of(joint, channel))


def _of(joint: UrdfJoint, channel: int) -> Iterator[Datum]:
    origin = joint.node.child("origin")
    for attribute, parts in _PARTS.items():
        values = _ZERO if origin is None else origin.numbers(attribute, _ZERO)
        for n, (part, value) in enumerate(zip(parts, values, strict=True)):
            length = attribute == "xyz"
            shown, unit = (mm_from_m(value), "mm") if length else (deg_from_rad(value), "deg")
            span = None if origin is None or not value else origin.span
            yield Datum(f"{joint.name}.{part}", "", shown + 0.0, unit, span, channel, (f"{joint.name} {attribute}", n))


def origin_rows(data: Sequence[Datum]) -> tuple[ParameterRow, ...]:
    """Return data of origins with their meaning."""
    return tuple(
        ParameterRow(
            one.name, "", one.value, one.unit, _MEANINGS[one.name.rpartition(".")[2]],
            given=one.span is not None, source="URDF", span=one.span,
        )
        for one in data
    )  # fmt: skip


def with_origins(robot: Node, values: Mapping[Datum, float]) -> Node:
    """Return an element <robot> with other origins of some joints.

    Args:
        robot: The element.
        values: Data of `origin_data` → new values, mm and degrees.
    """
    new = {datum.key: value for datum, value in values.items()}
    return replace(robot, children=[_changed(node, new) for node in robot.children])


def _changed(node: Node, new: Mapping[tuple[str, int | tuple[int, int] | None], float]) -> Node:
    name = node.attributes.get("name", "")
    if node.name != "joint" or not any((f"{name} {one}", n) in new for one in _PARTS for n in range(3)):
        return node
    origin = node.child("origin") or Node("origin", {}, node.span)
    attributes = dict(origin.attributes)
    for attribute in _PARTS:
        given = list(origin.numbers(attribute, _ZERO))
        for n in range(3):
            value = new.get((f"{name} {attribute}", n))
            if value is not None:
                given[n] = m_from_mm(value) if attribute == "xyz" else rad_from_deg(value)
        attributes[attribute] = " ".join(map(repr, given))
    rest = [child for child in node.children if child is not origin]
    return replace(node, children=[replace(origin, attributes=attributes), *rest])
