"""A machine at axis values, stood upright: its bodies and frames in the site, z up, metres.

Every place is rounded here, so that the last bits of matrix products, in which processors differ, never reach a file.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.bodies.body import Body
from chainbuild.chain.elements import BASE_LINK
from chainbuild.chain.poses import link_placements, path_to
from chainbuild.drawing.machine import drawn_bodies
from chainbuild.drawing.shown import shown_chain
from chainbuild.drawing.site import Site
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.painting.views import Arrow, View, Window, window_around
from chainbuild.shown import fields_shown

_GRID: Final = 1e-6  # m: places are rounded to it
_FINE: Final = 1e-9  # likewise directions
_OFF_HALF: Final = 0.4871  # rounds up from here: a half, where data may well lie, would be up to the last bit


_LAST_TURNS: Final = 3  # axes that a detail shows: a wrist or a head has no more
_HOLDING: Final = ("cheek", "bridge", "housing", "guide")  # parts of its carrier that a head hangs in


@dataclass(frozen=True, slots=True, eq=False)
class PlacedBody:
    """A body placed in the site.

    Attributes:
        body: The body.
        T: (4, 4) placement of its centre [m].
    """

    __repr__ = fields_shown

    body: Body
    T: Matrix


class Stage:
    """A machine at axis values, in its site.

    Args:
        robot: The machine.
        axes: Axis values (n_axes,), mm and degrees; None: home, every axis at 0 or at the limit next to it.
        bodies: What is shown; None: what the rules of drawing give.

    Raises:
        AxisValueError: wrong count or not finite.
        ChainbuildError: the machine has no pose there.

    Attributes:
        axes: The axis values.
        size: Size of the machine [m].
        bodies: What is shown; the number of a body is its place here.
    """

    def __init__(self, robot: Mechanism, axes: ArrayLike | None = None, bodies: Iterable[Body] | None = None) -> None:
        chain, site = shown_chain(robot.chain), Site(robot.chain)
        self._robot, self._chain = robot, chain
        self.axes = site.home if axes is None else robot.axis_values(axes)
        self.size = site.size
        robot.q(self.axes)  # raises where the machine has no pose
        placed = link_placements(chain, chain.axis_map.q(self.axes))
        self._links = {name: site.links[BASE_LINK] @ T for name, T in placed.items()}
        self.bodies = tuple(
            PlacedBody(body, snapped(self._links[body.link] @ body.T_link_body))
            for body in (drawn_bodies(chain) if bodies is None else bodies)
        )

    @property
    def tool_end(self) -> list[PlacedBody]:
        """What lies beyond the slides of a machine tool, or the last axes of an arm, with what holds it."""
        path = path_to(self._chain, self._chain.frame("tool").link)
        turns = [n for n, joint in enumerate(path) if joint.kind == "revolute"][-_LAST_TURNS:]
        beyond = {joint.child for joint in path[turns[0] :]} if turns else {path[-1].child} if path else set()
        holder = path[turns[0]].parent if turns else ""
        return [
            placed
            for placed in self.bodies
            if placed.body.link in beyond or (placed.body.link == holder and placed.body.part in _HOLDING)
        ] or list(self.bodies)

    @property
    def pointing(self) -> Vector:
        """Where the tool points (3,), from what carries it to its tip; no unit vector."""
        link = self._chain.frame("tool").link
        centres = [placed.T[:3, 3] for placed in self.bodies if placed.body.link == link]
        tip: Vector = self.frame("tool")[:3, 3]
        return tip - np.mean(centres, axis=0) if centres else np.zeros(3)

    def place(self, link: str, T_link: Matrix) -> Matrix:
        """Return a frame of a link (4, 4) in the site."""
        return snapped(self._links[link] @ T_link)

    def frame(self, name: str) -> Matrix:
        """Return a frame of the chain (4, 4) in the site."""
        frame = self._robot.chain.frame(name)
        return self.place(frame.link, frame.T_link_frame)

    def trace(self, rows: Matrix) -> Matrix:
        """Return where the tool is (n, 3), as a mark on the workpiece, at rows of axis values (n, n_axes).

        Raises:
            ChainbuildError: the machine has no pose in some row.
        """
        poses = self._robot.fk_batch(rows)
        T = self.frame("workpiece")
        points = np.einsum("ij,nj->ni", T[:3, :3], poses[:, :3, 3]) + T[:3, 3]
        rounded: Matrix = np.floor(points / _GRID + _OFF_HALF) * _GRID
        return rounded


def snapped(T: Matrix) -> Matrix:
    """Return a placement (4, 4) rounded to micrometres, and its directions to 1e-9."""
    result = T.copy()
    result[:3, :3] = np.floor(T[:3, :3] / _FINE + _OFF_HALF) * _FINE
    result[:3, 3] = np.floor(T[:3, 3] / _GRID + _OFF_HALF) * _GRID
    return result


def coordinate(vector: Sequence[float] | Matrix, direction: Arrow) -> float:
    """Return the coordinate of a vector (3,) along a direction."""
    x, y, z = (float(part) for part in vector)
    return x * direction[0] + y * direction[1] + z * direction[2]


def half_span(placed: PlacedBody, direction: Arrow) -> float:
    """Return how far [m] a body extends from its centre in a direction, given as a unit vector."""
    a, b, c = (coordinate(placed.T[:3, n], direction) for n in range(3))
    size = placed.body.dimensions
    if placed.body.kind in ("box", "mesh"):
        return (abs(a) * size[0] + abs(b) * size[1] + abs(c) * size[2]) / 2.0
    if placed.body.kind == "sphere":
        return size[0]
    return float(size[0] * (a * a + b * b) ** 0.5 + abs(c) * size[1] / 2.0)


def extent(
    bodies: Sequence[PlacedBody], direction: Arrow, points: Sequence[Sequence[float]] = ()
) -> tuple[float, float]:
    """Return the lowest and the highest coordinate [m] of bodies and points along a direction."""
    spans = [(coordinate(placed.T[:3, 3], direction), half_span(placed, direction)) for placed in bodies]
    spans += [(coordinate(point, direction), 0.0) for point in points]
    return min(middle - half for middle, half in spans), max(middle + half for middle, half in spans)


def framed(
    bodies: Sequence[PlacedBody], view: View, width: int, height: int, margin: int = 36,
    points: Sequence[Sequence[float]] = (),
) -> Window:  # fmt: skip
    """Return the window that shows bodies and points as large as they fit.

    Args:
        bodies: The bodies.
        view: From where one looks.
        width: Pixels.
        height: Pixels.
        margin: Pixels left free on each side at least.
        points: Places (3,) that are to be seen, too [m].
    """
    (left, right), (low, high) = extent(bodies, view.right, points), extent(bodies, view.up, points)
    return window_around((left, low), (right, high), width, height, margin)


def within(bodies: Sequence[PlacedBody], view: View, window: Window) -> list[PlacedBody]:
    """Return the bodies that a window may show: those beside it hide nothing in it, and large ones cost much."""
    width, height = window.width / window.scale, window.height / window.scale

    def meets(placed: PlacedBody) -> bool:
        u, v = (coordinate(placed.T[:3, 3], side) for side in (view.right, view.up))
        du, dv = half_span(placed, view.right), half_span(placed, view.up)
        beside = u + du < window.left or u - du > window.left + width
        return not (beside or v - dv > window.top or v + dv < window.top - height)

    return [placed for placed in bodies if meets(placed)]
