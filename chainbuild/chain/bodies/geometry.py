"""What an overlay or a URDF says about the bodies of a machine: radii, shapes, meshes, rods. Frozen data, no maths."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

from chainbuild.chain.bodies.inertia import Inertia
from chainbuild.shown import fields_shown

ShapeKind = Literal["capsule", "sphere", "box", "cylinder", "hull", "mesh"]
Numbers = tuple[float, ...]
Style = Literal["portal", "column"]
ColumnSide = Literal["+x", "-x", "+y", "-y"]


@dataclass(frozen=True, slots=True)
class Shape:
    """One body fixed to a link, in place of the one drawn by rule.

    Attributes:
        kind: "capsule", "sphere", "box", "cylinder", "hull" (convex hull of a mesh) or "mesh".
        points: Capsule and cylinder: both ends of the axis, (x, y, z, x, y, z); sphere: the centre [m].
        radius: Of capsule, cylinder and sphere [m].
        size: Edges of the box along x, y, z [m].
        place: Box, hull and mesh: x, y, z [m] in the link's frame, then A, B, C [deg] of Rz(A)·Ry(B)·Rx(C).
        file: Hull and mesh: the file, STL, OBJ or whatever else the mesh reader knows.
        scale: Hull and mesh: metres per unit of the file along its x, y, z.
        colour: Red, green, blue in 0…1; None: that of its link by rule.
    """

    __repr__ = fields_shown

    kind: ShapeKind
    points: Numbers = ()
    radius: float = 0.0
    size: Numbers = ()
    place: Numbers = (0.0,) * 6
    file: Path | None = None
    scale: tuple[float, float, float] = (0.001, 0.001, 0.001)
    colour: tuple[float, float, float] | None = None


@dataclass(frozen=True, slots=True)
class RodData:
    """Dimensions of a parallelogram's rods.

    Attributes:
        crank: Length of the crank [m]; None: a quarter of the upper arm.
        angle_deg: Angle from the forearm's direction to the crank, about the axis of the elbow; 180: behind it.
        radius: Radius of crank and rod [m]; None: a fifth of the crank.
        sideways: Offset of the rods along the axis of the elbow [m].
    """

    __repr__ = fields_shown

    crank: float | None = None
    angle_deg: float = 180.0
    radius: float | None = None
    sideways: float = 0.0


@dataclass(frozen=True, slots=True)
class Stand:
    """How a machine tool is built where its data leave it open. It changes drawings alone.

    Attributes:
        style: "portal": a beam on end posts; "column": one column behind the table; None: by the slides.
        column: Side on which beams and columns stand, as seen from the workpiece; None: +y, and -x of beams along y.
        table: Diameter of the plate, or width of the bed [m]; None: by the strokes.
        part: Edges of the part along x, y, z [m], an edge of 0: no part; None: by the table and the lowest tip.
    """

    __repr__ = fields_shown

    style: Style | None = None
    column: ColumnSide | None = None
    table: float | None = None
    part: Numbers | None = None


@dataclass(frozen=True, slots=True)
class Geometry:
    """The overlay's table `[geometry]`, or what a URDF gives.

    Attributes:
        radii: Link → radius [m] of its drawn body.
        shapes: Link → bodies in place of the drawn one; none: it has no body.
        visuals: Link → bodies to look at, where they are others than those of `shapes`.
        inertias: Link → its inertia. Empty: nobody gives any; else a link that is left out has no mass.
        rods: Whether the parallelogram's rods are links of the chain. They add joints.
        rod_data: Their dimensions, also for analyses that add them for themselves.
        ignore: Pairs of links whose collision does not count.
        stand: How a machine tool is drawn.
        source: The URDF that bodies and masses are from, which no output may replace; None: there is none.
    """

    __repr__ = fields_shown

    radii: Mapping[str, float] = field(default_factory=dict)
    shapes: Mapping[str, tuple[Shape, ...]] = field(default_factory=dict)
    visuals: Mapping[str, tuple[Shape, ...]] = field(default_factory=dict)
    inertias: Mapping[str, Inertia] = field(default_factory=dict)
    rods: bool = False
    rod_data: RodData = RodData()
    ignore: tuple[tuple[str, str], ...] = ()
    stand: Stand = Stand()
    source: Path | None = None

    @property
    def links(self) -> tuple[str, ...]:
        """Every link that is named, in order."""
        return (*self.radii, *self.shapes, *(link for pair in self.ignore for link in pair))

    def over(self, given: Geometry) -> Geometry:
        """Return this with a file's name and masses, and with its bodies of the links that have none here.

        Args:
            given: What the file gives.
        """
        visuals = {link: shapes for link, shapes in given.visuals.items() if link not in self.shapes}
        shapes = {**given.shapes, **self.shapes}
        return replace(self, shapes=shapes, visuals=visuals, inertias=given.inertias, source=given.source)

    def renamed(self, names: Mapping[str, str]) -> Geometry:
        """Return the same of links with other names.

        Args:
            names: Old name → new name; others stay.
        """
        return replace(
            self,
            radii={names.get(link, link): radius for link, radius in self.radii.items()},
            shapes={names.get(link, link): shapes for link, shapes in self.shapes.items()},
            visuals={names.get(link, link): shapes for link, shapes in self.visuals.items()},
            inertias={names.get(link, link): inertia for link, inertia in self.inertias.items()},
            ignore=tuple((names.get(a, a), names.get(b, b)) for a, b in self.ignore),
        )


NO_GEOMETRY = Geometry()
