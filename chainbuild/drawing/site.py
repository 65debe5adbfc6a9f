"""What the rules of a drawing look up and build with: the machine at home, upright, and its strokes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.bodies.body import (
    BASE_COLOUR,
    TOOL_SIDE,
    WORKPIECE_SIDE,
    Body,
    Colour,
    Origin,
    Part,
    along,
    rounded_body,
)  # fmt: skip
from chainbuild.chain.bodies.shapes import machine_size, shown_limits
from chainbuild.chain.elements import BASE_LINK, Chain, Joint
from chainbuild.chain.fold import drawn as as_drawn
from chainbuild.chain.fold import drawn_bounds, drawn_values
from chainbuild.chain.poses import link_placements
from chainbuild.errors import ChainError
from chainbuild.frames import inverse, transform

UP: Final = np.array([0.0, 0.0, 1.0])
_DIGITS: Final = 6  # decimals of a direction: of axes that are equally near, z is first
_SHORT: Final = 1e-6  # m: what is shorter cannot be seen, and has no direction


class Site:
    """A chain at home, stood upright: all places here are in the site's frame, z up, metres.

    Home is every axis at 0, or at the limit next to it; where closed loops have no pose there, the middle of the limits
    or their ends. Up is the base's axis nearest to the workpiece's z at home, on most machines its own z.

    Args:
        chain: The chain.

    Raises:
        ChainError: the chain has a pose at none of these.

    Attributes:
        chain: The chain.
        size: Size of the machine [m]; see `machine_size`.
        home: Axis values (n_axes,), mm and degrees.
        joints: The joints as their recipe draws them, by name.
        links: Placement (4, 4) of every link at home.
        tool_path: Joints from the base to the tool, in order.
        workpiece_path: Joints from the base to the workpiece, in order.
        tip: Where the tool's tip is at home.
        tool_direction: Unit vector (3,) of the tool frame's z at home: from the tip to the holder on machine tools.
        T_workpiece: (4, 4) workpiece frame at home.
    """

    def __init__(self, chain: Chain) -> None:
        self.chain = chain
        self.size = machine_size(chain)
        low, high = shown_limits(chain)
        home = home_of(chain)
        if home is None:
            raise ChainError("there is no pose to draw: at 0, in the middle and at the ends of the axes no loop closes")
        self.home = home
        q = chain.axis_map.q(self.home)
        placed = link_placements(chain, q)
        workpiece = chain.frame("workpiece")
        R = _upright((placed[workpiece.link] @ workpiece.T_link_frame)[:3, 2])
        self._T_site_base = transform(R)
        self.links = {name: self._T_site_base @ T for name, T in placed.items()}
        drawn_joints = [as_drawn(joint) for joint in chain.joints]
        self.joints = {joint.name: joint for joint in drawn_joints}
        self._carrier = {joint.child: joint for joint in drawn_joints}
        at_home = drawn_values(chain.joints, q)
        lows, highs = drawn_bounds(chain.joints, *chain.axis_map.q_bounds(low, high))
        self._range = {
            joint.name: (float(a - here), float(b - here))
            for joint, a, b, here in zip(drawn_joints, lows, highs, at_home, strict=True)
        }
        self.tool_path = self.path_to(chain.frame("tool").link)
        self.workpiece_path = self.path_to(workpiece.link)
        tool = self.frame("tool")
        self.tip: Vector = tool[:3, 3]
        self.tool_direction: Vector = tool[:3, 2]
        self.T_workpiece = self.frame("workpiece")
        self._below = {joint.child for joint in self.workpiece_path} - {joint.child for joint in self.tool_path}

    def path_to(self, link: str) -> tuple[Joint, ...]:
        """Return the joints from the base to a link, in order."""
        path: list[Joint] = []
        while link in self._carrier:
            path.insert(0, self._carrier[link])
            link = path[0].parent
        return tuple(path)

    def frame(self, name: str) -> Matrix:
        """Return the placement (4, 4) of a frame at home."""
        frame = self.chain.frame(name)
        placed: Matrix = self.links[frame.link] @ frame.T_link_frame
        return placed

    def origin(self, joint: Joint) -> Vector:
        """Return a point (3,) on the axis of a joint at home: where its child's origin is at drawn value 0."""
        place: Vector = (self.links[joint.parent] @ joint.T_parent_joint)[:3, 3]
        return place

    def direction(self, joint: Joint) -> Vector:
        """Return the direction (3,) in which a joint moves or turns at home, as a unit vector."""
        turned: Vector = (self.links[joint.parent] @ joint.T_parent_joint)[:3, :3] @ joint.direction
        return turned

    def stroke(self, joint: Joint) -> tuple[float, float]:
        """Return how far a joint moves from home against and along its direction, (≤ 0, ≥ 0) [m, rad]."""
        low, high = self._range[joint.name]
        return min(low, 0.0), max(high, 0.0)

    def radius(self, link: str, default: float) -> float:
        """Return the radius [m] that the overlay gives a link, else the default."""
        given = next(entry.radius for entry in self.chain.links if entry.name == link)
        return default if given is None else given

    def colour(self, link: str, shade: int | None = None) -> Colour:
        """Return the colour of a link by what it carries; neighbours differ.

        Args:
            link: The link.
            shade: 0 or 1, for neighbours that the joints' count does not tell apart; None: by the count.
        """
        if link == BASE_LINK:
            return BASE_COLOUR
        pair = WORKPIECE_SIDE if link in self._below else TOOL_SIDE
        return pair[(len(self.path_to(link)) - 1) % 2 if shade is None else shade]

    def box(
        self,
        link: str,
        part: Part,
        low: ArrayLike,
        high: ArrayLike,
        R: Matrix | None = None,
        at: Vector | None = None,
        *,
        colour: Colour | None = None,
        origin: Origin = "drawn",
    ) -> Body:
        """Return a box between two opposite corners (3,).

        Args:
            link: Link that carries it.
            part: What it stands for.
            low: One corner, along the axes of the box.
            high: The opposite corner, likewise.
            R: (3, 3) axes of the box; None: the site's.
            at: Point (3,) from which the corners count; None: the site's origin.
            colour: None: the link's.
            origin: Where its measures come from.
        """
        a, b = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
        turn = np.eye(3) if R is None else R
        T = transform(turn, turn @ ((a + b) / 2) + (0.0 if at is None else at))
        edges = tuple(np.abs(b - a).tolist())
        return self._body(link, part, T, "box", edges, colour, origin)

    def cylinder(
        self,
        link: str,
        part: Part,
        start: ArrayLike,
        end: ArrayLike,
        radius: float,
        *,
        colour: Colour | None = None,
        origin: Origin = "drawn",
    ) -> Body:
        """Return a cylinder about the line between two points (3,)."""
        a, b = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
        length = float(np.linalg.norm(b - a))
        T = along(b - a, (a + b) / 2) if length > _SHORT else transform(None, a)
        return self._body(link, part, T, "cylinder", (radius, max(length, _SHORT)), colour, origin)

    def ball(
        self, link: str, part: Part, centre: ArrayLike, radius: float, *,
        colour: Colour | None = None, origin: Origin = "drawn",
    ) -> Body:  # fmt: skip
        """Return a ball about a point (3,)."""
        return self._body(
            link, part, transform(None, np.asarray(centre, dtype=float)), "sphere", (radius,), colour, origin
        )

    def bounds(self, body: Body) -> Matrix:
        """Return the lowest and highest x, y, z (2, 3) [m] of a body at home."""
        T = self.links[body.link] @ body.T_link_body
        turn, size = T[:3, :3], np.array(body.dimensions)
        if body.kind in ("box", "mesh"):
            half = np.abs(turn) @ size / 2
        elif body.kind == "sphere":
            half = np.full(3, size[0])
        else:
            half = size[0] * np.hypot(turn[:, 0], turn[:, 1]) + np.abs(turn[:, 2]) * size[1] / 2
        return np.array([T[:3, 3] - half, T[:3, 3] + half])

    def _body(
        self, link: str, part: Part, T: Matrix, kind: str, size: Sequence[float], colour: Colour | None, origin: Origin
    ) -> Body:
        local = inverse(self.links[link]) @ T
        shown = self.colour(link) if colour is None else colour
        return rounded_body(link, part, local, kind, tuple(size), shown, origin)  # type: ignore[arg-type]


def home_of(chain: Chain) -> Vector | None:
    """Return the axis values (n_axes,) at which a machine is drawn, mm and degrees; None: it has no pose there."""
    low, high = shown_limits(chain)
    for axes in (np.clip(np.zeros(len(low)), low, high), (low + high) / 2, low, high):
        if np.isfinite(chain.axis_map.q(axes)).all():
            return axes
    return None


def upright_frame(direction: Vector) -> Matrix:
    """Return axes (3, 3) whose x is a direction, and whose z is as upright as that leaves it.

    Args:
        direction: A unit vector (3,) that is not upright.
    """
    y = np.cross(UP, direction)
    y = y / np.linalg.norm(y)
    return np.column_stack([direction, y, np.cross(direction, y)])


def _upright(up: Vector) -> Matrix:
    """Return the quarter turns (3, 3) that bring the base's axis nearest to a direction to z."""
    n = int(np.argmax(np.abs(up[[2, 1, 0]]).round(_DIGITS)))
    axis = (2, 1, 0)[n]
    turn = np.eye(3)[[(axis + 1) % 3, (axis + 2) % 3, axis]]
    flipped: Matrix = turn if up[axis] > 0.0 else np.diag([1.0, -1.0, -1.0]) @ turn
    return flipped
