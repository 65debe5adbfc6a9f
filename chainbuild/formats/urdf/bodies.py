"""The bodies of a URDF: what its links look like and what counts in collisions, as shapes of the chain's links.

A file that has any `<collision>` says of every link what counts: nothing where it has none. One with `<visual>` alone
means these. One without either leaves the bodies to the rules of drawing, as machine data do.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final, Literal
from urllib.parse import unquote, urlsplit
from urllib.request import url2pathname

from chainbuild import tolerances
from chainbuild.arrays import Matrix
from chainbuild.chain.bodies.body import Colour
from chainbuild.chain.bodies.geometry import Geometry, Numbers, Shape, ShapeKind
from chainbuild.chain.bodies.placed import shape_place
from chainbuild.errors import ChainbuildError, ParseError
from chainbuild.findings import Collector
from chainbuild.formats.urdf.joints import placement
from chainbuild.formats.urdf.xml import Node
from chainbuild.meshes import Scale, check_mesh, dae_unit

Places = Mapping[str, tuple[str, Matrix]]
_Tag = Literal["visual", "collision"]

_TOLD: Final = 5  # files that a finding names
_WHERE: Final = "package://NAME/… is sought in the folders above the URDF, ROS_PACKAGE_PATH and AMENT_PREFIX_PATH"
_ROUND: Final[Mapping[str, ShapeKind]] = {"cylinder": "cylinder", "capsule": "capsule"}


def urdf_bodies(robot: Node, places: Places, file: Path, collector: Collector) -> Geometry:
    """Return what a URDF says about the bodies of a chain: its `shapes` and `visuals`, nothing else.

    A link whose mesh cannot be read is left out, so that its drawn body stands for it, and a finding tells so.

    Args:
        robot: The element <robot>.
        places: Link of the file → the chain's link that carries it, and its placement (4, 4) in that [m].
        file: The URDF: meshes are relative to it.
        collector: Takes the findings.

    Raises:
        ParseError: a measure, place or colour is no number that it may be.
    """
    links = [node for node in robot.children if node.name == "link"]
    given = {child.name for link in links for child in link.children}
    reader = _Reader(robot, places, file)
    shapes, visuals = {}, {}
    if "collision" in given:
        shapes = reader.read(links, "collision")
    if "visual" in given:
        visuals = reader.read(links, "visual")
    reader.tell(collector)
    return Geometry(shapes=shapes, visuals=visuals) if "collision" in given else Geometry(shapes=visuals)


class _Reader:
    """Reads the bodies of links; what cannot be read is kept, to be told once."""

    def __init__(self, robot: Node, places: Places, file: Path) -> None:
        self._robot, self._places, self._file = robot, places, file
        self._colours = _named_colours(robot)
        self._unread: dict[str, Node] = {}
        self._textured: dict[str, Node] = {}

    def read(self, links: Sequence[Node], tag: _Tag) -> dict[str, tuple[Shape, ...]]:
        """Return the bodies of each of the chain's links; a link with one that cannot be read is not among them."""
        found: dict[str, list[Shape]] = {link: [] for link, _ in self._places.values()}
        broken = set()
        for node in links:
            name = node.attributes.get("name", "")
            if name not in self._places:
                continue
            link, T = self._places[name]
            for body in (child for child in node.children if child.name == tag):
                shapes = self._shapes(body, T, name)
                if shapes is None:
                    broken.add(link)
                else:
                    found[link] += shapes
        return {link: tuple(shapes) for link, shapes in found.items() if link not in broken}

    def tell(self, collector: Collector) -> None:
        """Tell what could not be read, and whose colours are not shown."""
        if self._unread:
            names = list(self._unread)
            more = f" and {len(names) - _TOLD} more" if len(names) > _TOLD else ""
            text = f"bodies that cannot be read: {', '.join(names[:_TOLD])}{more}; their links are drawn by rule"
            collector.add("CB526", text, span=self._unread[names[0]].span, hint=_WHERE)
        if self._textured:
            text = f"textures are not shown: link {', '.join(self._textured)} has no other colour"
            collector.add("CB527", text, span=next(iter(self._textured.values())).span)

    def _shapes(self, body: Node, T_link: Matrix, name: str) -> list[Shape] | None:
        """Return the shapes of a <visual> or <collision>, none for one without extent; None: it cannot be read."""
        geometry = body.child("geometry")
        node = geometry.children[0] if geometry is not None and geometry.children else None
        T = T_link @ placement(body.child("origin"), f"a body of link {name}")
        colour = self._colour(body, name)
        if node is None or node.name not in {"box", "sphere", "mesh", *_ROUND}:
            self._unread.setdefault(f"<{node.name if node else 'geometry'}> of link {name}", body)
            return None
        if node.name == "mesh":
            return self._mesh(node, T, colour)
        if node.name == "box":
            size = _lengths(node, "size", 3)
            return [Shape("box", size=size, place=shape_place(T), colour=colour)] if min(size) > 0.0 else []
        [radius] = _lengths(node, "radius", 1)
        centre = T[:3, 3]
        if node.name == "sphere":
            return (
                [Shape("sphere", points=tuple(centre.tolist()), radius=radius, colour=colour)] if radius > 0.0 else []
            )
        [length] = _lengths(node, "length", 1)
        if min(radius, length) <= 0.0:
            return []
        half = T[:3, 2] * length / 2.0
        ends = (*(centre - half).tolist(), *(centre + half).tolist())
        return [Shape(_ROUND[node.name], points=ends, radius=radius, colour=colour)]

    def _mesh(self, node: Node, T: Matrix, colour: Colour | None) -> list[Shape] | None:
        name = node.text("filename")
        x, y, z = node.numbers("scale", (1.0, 1.0, 1.0))
        if not 0.0 < min(map(abs, (x, y, z))) <= max(map(abs, (x, y, z))) < tolerances.HUGE_POSITION_M:
            raise ParseError(
                f'scale="{node.attributes["scale"]}" in <mesh>', span=node.span, parameter="scale",
                permitted="three factors other than 0; a negative one mirrors",
            )  # fmt: skip
        file = _found(name, self._file)
        if file is not None:
            unit = dae_unit(file)
            scale = (x * unit, y * unit, z * unit)
            if _readable(file, scale):
                return [Shape("mesh", place=shape_place(T), file=file, scale=scale, colour=colour)]
        self._unread.setdefault(name if file is not None else f"{name} (not found)", node)
        return None

    def _colour(self, body: Node, name: str) -> Colour | None:
        material = body.child("material")
        if material is None:
            return None
        colour = _own_colour(material) or self._colours.get(material.attributes.get("name", ""))
        if colour is None and material.child("texture") is not None:
            self._textured.setdefault(name, material)
        return colour


def _named_colours(robot: Node) -> dict[str, Colour]:
    """Return the colours of materials by name: those of the robot first, then those that links define."""
    bodies = (body for link in robot.children if link.name == "link" for body in link.children)
    holders: Iterator[Node] = (node for parent in (robot, *bodies) for node in parent.children)
    found: dict[str, Colour] = {}
    for material in (node for node in holders if node.name == "material"):
        colour = _own_colour(material)
        if colour is not None:
            found.setdefault(material.attributes.get("name", ""), colour)
    return found


def _own_colour(material: Node) -> Colour | None:
    node = material.child("color")
    if node is None or "rgba" not in node.attributes:
        return None
    red, green, blue, _ = (min(max(part, 0.0), 1.0) for part in node.numbers("rgba", (0.0, 0.0, 0.0, 1.0)))
    return red, green, blue


def _lengths(node: Node, name: str, count: int) -> Numbers:
    node.text(name)
    values = node.numbers(name, (0.0,) * count)
    if not 0.0 <= min(values) <= max(values) < tolerances.HUGE_POSITION_M:
        text = f'{name}="{node.attributes[name]}" in <{node.name}>'
        raise ParseError(text, span=node.span, parameter=name, permitted="lengths in metres, 0 and more")
    return values


def _found(name: str, urdf: Path) -> Path | None:
    """Return the file that a mesh's name means; None: there is none."""
    parts = urlsplit(name)
    if parts.scheme == "package":
        wanted = unquote(f"{parts.netloc}{parts.path}").lstrip("/")
        candidates = _in_package(*wanted.partition("/")[::2], urdf)
    elif parts.scheme == "file":
        candidates = iter([urdf.parent / url2pathname(f"{parts.netloc}{parts.path}")])
    else:
        # What else looks like a scheme is none of the file's folder: nothing is fetched from elsewhere.
        candidates = iter([] if "://" in name else [urdf.parent / name])
    return next((path for path in candidates if _is_file(path)), None)


def _in_package(package: str, rest: str, urdf: Path) -> Iterator[Path]:
    """Yield where a file of a package may be: in folders above the URDF, then where ROS says."""
    for start in dict.fromkeys((urdf.absolute(), urdf.resolve())):
        for folder in start.parents:
            if folder.name == package:
                yield folder / rest
            yield folder / package / rest
    for entry in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep):
        if entry:
            yield Path(entry) / package / rest
            if Path(entry).name == package:
                yield Path(entry) / rest
    for entry in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        if entry:
            yield Path(entry) / "share" / package / rest


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def _readable(file: Path, scale: Scale) -> bool:
    try:
        check_mesh(file, scale)
    except ChainbuildError:
        return False
    return True
