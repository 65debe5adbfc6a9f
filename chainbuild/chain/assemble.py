"""Recipes: a chain written down like its drawing, element by element from the base to a tip.

A branch is a sequence of `Fixed`, `Move` and `Mark`, after a `Start` if it does not begin at the base. Lengths are mm
and angles degrees here, as in the manuals; `assemble` turns them into SI. Where one axis alone drives a joint, it folds
sign and offset into the joint, whose value then is the axis value. A recipe for a table machine reads:

    assemble(..., tool=[linear("X", "x"), linear("Y", "y"), linear("Z", "z"), shift(z=-120.0), mark("flange")],
             workpiece=[rotary("A", "x"), shift(z=50.0), rotary("C", "z")])
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from chainbuild import frames
from chainbuild.arrays import Matrix
from chainbuild.chain.axismap import AffineMap, AxisMap
from chainbuild.chain.elements import BASE_LINK, Axis, Frame, Joint, JointKind, Link
from chainbuild.chain.fold import folded
from chainbuild.errors import ChainError
from chainbuild.units import AxisKind, m_from_mm, rad_from_deg

_AXIS_KINDS: dict[JointKind, AxisKind] = {"revolute": "rotary", "prismatic": "linear"}
_DIRECTIONS = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


@dataclass(frozen=True, slots=True, eq=False)
class Fixed:
    """A constant transform; T is (4, 4) with its translation in mm."""

    T: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class Mark:
    """A frame's place on the branch, or beside it by T (4, 4) with its translation in mm."""

    frame: str
    T: Matrix | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Start:
    """Where a branch starts instead of the base: the place of a frame that a branch before it has named."""

    frame: str


@dataclass(frozen=True, slots=True, eq=False)
class Move:
    """A joint and how axes drive it.

    Attributes:
        name: Joint name.
        kind: Revolute or prismatic.
        direction: (3,) direction in the frame reached so far.
        drive: Axis name → factor; joint value as drawn = Σ factor·axis + offset. Empty: a nonlinear map drives it.
        offset: mm or degrees, added after the factors.
        follows: True for a joint that keeps a value of its own although one axis alone drives it (`<mimic>` of a URDF).
    """

    name: str
    kind: JointKind
    direction: tuple[float, float, float]
    drive: dict[str, float] = field(default_factory=dict)
    offset: float = 0.0
    follows: bool = False


Element = Fixed | Mark | Move | Start


def _vector(direction: str | Sequence[float]) -> tuple[float, float, float]:
    if isinstance(direction, str):
        sign = -1.0 if direction.startswith("-") else 1.0
        x, y, z = (sign * component + 0.0 for component in _DIRECTIONS[direction.lstrip("+-")])
        return x, y, z
    x, y, z = (float(component) for component in frames.unit(direction))
    return x, y, z


def rotary(
    name: str,
    direction: str | Sequence[float],
    *,
    sign: float = 1.0,
    offset_deg: float = 0.0,
    drive: dict[str, float] | None = None,
) -> Move:
    """Return a revolute joint: angle as drawn = sign·axis + offset_deg, or Σ drive·axes + offset_deg.

    Args:
        name: Joint name; also the axis name where `drive` is None.
        direction: "x", "-y", … or three numbers of any length but zero.
        sign: +1 or -1.
        offset_deg: Degrees, added after the sign.
        drive: Axis name → factor (rotary axis: 1 = 1:1).
    """
    return Move(name, "revolute", _vector(direction), {name: sign} if drive is None else drive, offset_deg)


def linear(
    name: str,
    direction: str | Sequence[float],
    *,
    sign: float = 1.0,
    offset_mm: float = 0.0,
    drive: dict[str, float] | None = None,
) -> Move:
    """Return a prismatic joint: shift as drawn = sign·axis + offset_mm, or Σ drive·axes + offset_mm."""
    return Move(name, "prismatic", _vector(direction), {name: sign} if drive is None else drive, offset_mm)


def shift(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Fixed:
    """Return a constant translation in mm."""
    return Fixed(frames.translation(x, y, z))


def turn(rotation: Matrix) -> Fixed:
    """Return a constant rotation (3×3)."""
    return Fixed(frames.transform(rotation))


def mark(frame: str, beside: Matrix | None = None) -> Mark:
    """Name the frame reached so far, or one that stands beside it (4, 4), its translation in mm."""
    return Mark(frame, beside)


@dataclass(frozen=True, slots=True, eq=False)
class Assembly:
    """Links, joints, frames and the axis map of a recipe: what a translator puts into a `Chain`."""

    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    frames: tuple[Frame, ...]
    axis_map: AxisMap


def assemble(
    axes: Sequence[Axis],
    tool: Sequence[Element],
    workpiece: Sequence[Element] = (),
    axis_map: AxisMap | None = None,
    branches: Sequence[Sequence[Element]] = (),
) -> Assembly:
    """Turn two branches into links, joints, frames and an axis map.

    Args:
        axes: The controller's axes in channel order.
        tool: Base → tool; the end is frame `tool`. Without a mark "flange" the flange is the tool.
        workpiece: Base → workpiece; the end is frame `workpiece`.
        axis_map: A nonlinear map over the joints in the order tool branch, workpiece branch; None: the affine one
            that the joints' drives describe. Joints that a nonlinear map couples or bends have no drive; joints that
            one axis alone drives are folded all the same, and the map passes that axis on.
        branches: Further branches, from the base or from a frame of those before, without a tip: the arms of closed
            loops. Their joints come last.

    Raises:
        ChainError: a drive names an unknown axis, a name is duplicate, or the map is singular.
    """
    links, joints, marks = [Link(BASE_LINK)], [], [Frame("base", BASE_LINK, np.eye(4))]
    kinds = {axis.name: axis.kind for axis in axes}
    moves: list[Move] = []
    starts: dict[str, tuple[str, Matrix]] = {}
    tips: list[Sequence[Element]] = [(*tool, Mark("tool")), (*workpiece, Mark("workpiece")), *branches]
    for branch in tips:
        parent, T = BASE_LINK, np.eye(4)
        for element in branch:
            if isinstance(element, Fixed):
                T = T @ element.T
            elif isinstance(element, Start):
                parent, T = starts[element.frame]
            elif isinstance(element, Mark):
                beside = T if element.T is None else T @ element.T
                marks.append(Frame(element.frame, parent, _in_metres(beside)))
                starts[element.frame] = parent, beside
            else:
                child = f"{element.name}_link"
                direction = np.array(element.direction)
                joint = Joint(element.name, element.kind, parent, child, _in_metres(T), direction)
                alone = _alone(element, kinds)
                if alone is not None:
                    joint = folded(joint, element.drive[alone], element.offset)
                    element = replace(element, drive={**element.drive, alone: 1.0}, offset=0.0)  # noqa: PLW2901
                joints.append(joint)
                links.append(Link(child))
                moves.append(element)
                parent, T = child, np.eye(4)
    if "flange" not in {frame.name for frame in marks}:
        end = next(frame for frame in marks if frame.name == "tool")
        marks.append(Frame("flange", end.link, end.T_link_frame))
    return Assembly(tuple(links), tuple(joints), tuple(marks), axis_map or _affine(axes, moves))


def _alone(move: Move, kinds: Mapping[str, AxisKind]) -> str | None:
    """Return the axis that alone drives a joint of its own kind with factor ±1, or None."""
    driving = [name for name, factor in move.drive.items() if factor != 0.0]
    if move.follows or len(driving) != 1 or abs(move.drive[driving[0]]) != 1.0:
        return None
    return driving[0] if kinds.get(driving[0]) == _AXIS_KINDS[move.kind] else None


def _in_metres(T_mm: Matrix) -> Matrix:
    T = T_mm.copy()
    T[:3, 3] /= 1000.0
    return T


def _affine(axes: Sequence[Axis], moves: Sequence[Move]) -> AffineMap:
    index = {axis.name: n for n, axis in enumerate(axes)}
    A, b = np.zeros((len(moves), len(axes))), np.zeros(len(moves))
    for row, move in enumerate(moves):
        b[row] = rad_from_deg(move.offset) if move.kind == "revolute" else m_from_mm(move.offset)
        for name, factor in move.drive.items():
            if name not in index:
                raise ChainError(f"joint {move.name} is driven by axis {name}, which the channel does not have")
            A[row, index[name]] = factor
    return AffineMap.of(A, b, [axis.kind for axis in axes])
