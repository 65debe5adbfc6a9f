"""A robot in a meshcat scene: bodies, labelled frames, grid and light, scaled to the machine."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild import frames
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.bodies.body import Body, Colour
from chainbuild.chain.bodies.shapes import machine_size
from chainbuild.chain.elements import BASE_LINK, FRAME_NAMES, Chain, Frame
from chainbuild.chain.poses import link_placements
from chainbuild.drawing.machine import drawn_bodies
from chainbuild.drawing.shown import shown_chain
from chainbuild.inspect.labels import Side, draw_label
from chainbuild.inspect.sweep import joint_transforms
from chainbuild.meshes import Triangles, creased, lighter

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Mechanism

# Red, green, blue in 0…1. Light and grey: the bodies stand out against it.
BACKGROUND_TOP: Final[Colour] = (0.97, 0.98, 0.99)
BACKGROUND_BOTTOM: Final[Colour] = (0.80, 0.84, 0.88)
GRID_COLOUR: Final[Colour] = (0.62, 0.67, 0.72)
# Red, green, blue for x, y, z, as everywhere.
_TRIAD_COLOURS: Final[tuple[Colour, Colour, Colour]] = ((0.86, 0.16, 0.16), (0.13, 0.62, 0.20), (0.13, 0.33, 0.87))
MOST_TRIANGLES: Final = 150_000  # of a page, which they make 4 MB larger; browsers turn as many without a hitch
_TRIAD_SHARE: Final = 0.13  # length of a triad's arms over the machine's size


def as_shown(robot: Mechanism) -> Mechanism:
    """Return the robot with the rods of its parallelogram, which a page shows; the same where it has none."""
    chain = shown_chain(robot.chain)
    return robot if chain is robot.chain else type(robot)(chain)


class Scene:
    """Draws one robot into a meshcat visualizer and moves it.

    Args:
        viewer: `meshcat.Visualizer`; what it already shows outside the root stays.
        robot: What to draw.
        root: Name of its place in the scene.

    Attributes:
        size: Of the machine [m].
        bodies: What is drawn.
        link_paths: Name of a link → its path in the scene.
    """

    def __init__(self, viewer: Any, robot: Mechanism, root: str = "robot") -> None:
        self.viewer = viewer
        self.robot = robot
        chain = robot.chain
        self.size = machine_size(chain)
        self.bodies = _light_enough(drawn_bodies(chain))
        self.link_paths = _link_paths(chain, root)

    def draw(self, axes: ArrayLike, *, labels: bool = True) -> None:
        """Draw everything, the robot at axis values (n_axes,), mm and degrees; labels: the names of the frames, too."""
        self._draw_surroundings(self.floor(self.robot.q(axes)))
        self.draw_robot(axes, labels=labels)

    def draw_robot(self, axes: ArrayLike, *, frames: bool = True, labels: bool = True) -> None:
        """Draw the robot alone, at axis values (n_axes,), mm and degrees; without frames: its bodies only."""
        for n, body in enumerate(self.bodies):
            self._draw_body(self.viewer[f"{self.link_paths[body.link]}/{body.part}{n}"], body)
        for label, frame in labelled_frames(self.robot.chain) if frames else ():
            self._draw_triad(
                f"{self.link_paths[frame.link]}/frame {frame.name}", label if labels else None, frame.T_link_frame
            )
        self._place(self.robot.q(axes))

    def update(self, axes: ArrayLike) -> None:
        """Move the robot that was drawn to axis values (n_axes,), mm and degrees."""
        self._place(self.robot.q(axes))

    def bounds(self, motion: Iterable[Vector]) -> tuple[Vector, Vector]:
        """Return the lowest and highest x, y, z [m] that any body reaches over joint values (n_q,) of a motion."""
        corners = np.array([_corners(body) for body in self.bodies])
        low, high = np.full(3, np.inf), np.full(3, -np.inf)
        for q in motion:
            placed = link_placements(self.robot.chain, q)
            T = np.array([placed[body.link] for body in self.bodies])
            points = np.einsum("bij,bkj->bki", T[:, :3, :3], corners) + T[:, None, :3, 3]
            low, high = np.minimum(low, points.min(axis=(0, 1))), np.maximum(high, points.max(axis=(0, 1)))
        return low, high

    def floor(self, q: Vector) -> float:
        """Return the height [m] of the grid: the base's origin, or lower if the machine extends below it."""
        lowest = float(self.bounds([q])[0][2])
        return lowest if lowest < -0.15 * self.size else 0.0

    @property
    def grid_cell(self) -> float:
        """Side of a grid square [m]: 1, 2 or 5 times a power of ten, about a quarter of the machine."""
        rough = self.size / 4
        power = 10.0 ** math.floor(math.log10(rough))
        return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= rough * 1.001)

    def frame_place(self, name: str) -> tuple[str, Matrix]:
        """Return the scene path of the link that carries a frame, and the frame in it (4, 4) [m]."""
        frame = self.robot.chain.frame(name)
        return self.link_paths[frame.link], frame.T_link_frame

    def _place(self, q: Vector) -> None:
        chain = self.robot.chain
        for joint, T in zip(chain.joints, joint_transforms(chain, q), strict=True):
            self.viewer[self.link_paths[joint.child]].set_transform(T)

    def _draw_body(self, node: Any, body: Body) -> None:
        from meshcat import geometry

        T = body.T_link_body
        if body.surface is not None:
            # The viewer makes the normals: means of the triangles at each vertex.
            shape = geometry.TriangularMeshGeometry(*_for_light(body.surface))
        elif body.kind == "box":
            shape = geometry.Box(list(body.dimensions))
        elif body.kind == "sphere":
            shape = geometry.Sphere(body.dimensions[0])
        else:
            radius, length = body.dimensions
            shape = geometry.Cylinder(length, radius)
            shape.radialSegments = 32
            # three.js lays cylinders along y.
            T = T @ frames.transform(frames.rot_x(90.0))
        node.set_object(shape, geometry.MeshLambertMaterial(color=_hex(body.colour)))
        node.set_transform(T)

    @property
    def triad_length(self) -> float:
        """Length of a frame's arms [m]."""
        return _TRIAD_SHARE * self.size

    def _draw_triad(self, path: str, label: str | None, T: Matrix) -> None:
        from meshcat import geometry

        length, thickness = self.triad_length, 0.006 * self.size
        self.viewer[path].set_transform(T)
        for n, (letter, colour) in enumerate(zip("xyz", _TRIAD_COLOURS, strict=True)):
            centre = np.eye(3)[n] * length / 2
            turn = (frames.rot_z(-90.0), np.eye(3), frames.rot_x(90.0))[n]
            node = self.viewer[f"{path}/{letter}"]
            node.set_object(geometry.Cylinder(length, thickness), geometry.MeshBasicMaterial(color=_hex(colour)))
            node.set_transform(frames.transform(turn, centre))
        if label is None:
            return
        side: Side = "left" if label == "flange" else "below" if "base" in label else "right"
        draw_label(self.viewer[f"{path}/label"], label, side)

    def _draw_surroundings(self, floor: float) -> None:
        from meshcat import geometry

        viewer, cell = self.viewer, self.grid_cell
        viewer["/Background"].set_property("top_color", list(BACKGROUND_TOP))
        viewer["/Background"].set_property("bottom_color", list(BACKGROUND_BOTTOM))
        viewer["/Grid"].set_property("visible", False)
        viewer["/Axes"].set_property("visible", False)
        points = geometry.PointsGeometry(_grid(cell, 2.2 * self.size, floor))
        viewer["grid"].set_object(geometry.LineSegments(points, geometry.LineBasicMaterial(color=_hex(GRID_COLOUR))))
        # meshcat's own lamps are at 2 m and reach 10 m: moved out so that a gantry is lit, too.
        for lamp, side in (("PointLightNegativeX", 1.0), ("PointLightPositiveX", -1.0)):
            node = viewer[f"/Lights/{lamp}/<object>"]
            node.set_property("position", [side * 4 * self.size, side * 3 * self.size, 5 * self.size])
            node.set_property("distance", 0)


def labelled_frames(chain: Chain) -> list[tuple[str, Frame]]:
    """Return the named frames with their labels; frames in one place share a label: "flange = tool"."""
    groups: list[list[Frame]] = []
    for frame in (chain.frame(name) for name in FRAME_NAMES):
        for group in groups:
            same = group[0].link == frame.link
            if same and np.allclose(group[0].T_link_frame, frame.T_link_frame, rtol=0, atol=1e-9):
                group.append(frame)
                break
        else:
            groups.append([frame])
    return [(" = ".join(frame.name for frame in group), group[0]) for group in groups]


def _light_enough(bodies: Sequence[Body]) -> tuple[Body, ...]:
    """Return the bodies with so few triangles that a page can hold them; what is too small for these is left out."""
    surfaces = iter(lighter([body.surface for body in bodies if body.surface is not None], MOST_TRIANGLES))
    made = (body if body.surface is None else replace(body, surface=next(surfaces)) for body in bodies)
    return tuple(body for body in made if body.surface is None or len(body.surface.corners))


def _for_light(surface: Triangles) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    found = creased(surface)
    return found.points.astype(np.float32), found.corners.astype(np.uint32)


def _link_paths(chain: Chain, root: str) -> dict[str, str]:
    """Return the scene path of every link; children are nested in their parents: a joint moves one node only."""
    paths = {BASE_LINK: root}
    for joint in chain.joints:
        paths[joint.child] = f"{paths[joint.parent]}/{joint.child.replace('/', '_')}"
    return paths


def _corners(body: Body) -> Matrix:
    """Return the corners (8, 3) [m] of a box around a body, in its link."""
    if body.kind in ("box", "mesh"):
        half = np.array(body.dimensions) / 2
    elif body.kind == "sphere":
        half = np.full(3, body.dimensions[0])
    else:
        radius, length = body.dimensions
        half = np.array([radius, radius, length / 2])
    signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, 8).T
    corners: Matrix = (signs * half) @ body.T_link_body[:3, :3].T + body.T_link_body[:3, 3]
    return corners


def _grid(cell: float, extent: float, height: float) -> Matrix:
    """Return the ends (3, n) [m] of grid lines at least `extent` either way."""
    count = math.ceil(extent / cell)
    edge = count * cell
    lines = []
    for k in range(-count, count + 1):
        lines += [(-edge, k * cell), (edge, k * cell), (k * cell, -edge), (k * cell, edge)]
    flat = np.array(lines).T
    return np.vstack([flat, np.full(flat.shape[1], height)]).astype(np.float32)


def _hex(colour: Colour) -> int:
    red, green, blue = (round(255 * part) for part in colour)
    return red << 16 | green << 8 | blue
