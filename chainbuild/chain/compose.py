"""Chains made of chains: one carried by another, or one whose workpiece another carries.

Both are one operation: the tree of a guest, re-rooted at its workpiece frame, is grafted on a link of its host. Where
the guest's workpiece moves, the path to it is reversed: the joints between base and workpiece keep their values and
point the other way, their placements are inverted as drawn. That is exact, and nothing else of the guest changes.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix
from chainbuild.chain.axismap import Block, side_by_side
from chainbuild.chain.bodies.inertia import joined_inertias
from chainbuild.chain.bodies.placed import joined_geometry
from chainbuild.chain.drives import joined_drives
from chainbuild.chain.elements import Axis, Chain, Frame, Joint, Link, Loop, Partial
from chainbuild.chain.fold import drawn, joint_motion
from chainbuild.chain.names import Names, as_name, free_name
from chainbuild.chain.poses import path_to
from chainbuild.chain.programmed.display import POSE_ANGLES
from chainbuild.chain.sums import AxisConstraint, AxisSum
from chainbuild.errors import ChainError
from chainbuild.findings import Findings
from chainbuild.frames import inverse, is_rigid


def padded_constraints(chain: Chain, before: int, after: int) -> Iterable[AxisConstraint]:
    """Yield the limits on sums of axes of a chain, with other axes before and after its own."""
    for constraint in chain.constraints:
        yield replace(constraint, sum=padded(constraint.sum, before, after))


def padded(total: AxisSum, before: int, after: int) -> AxisSum:
    """Return a sum over more axes, those before and after having no part in it."""
    return AxisSum((0.0,) * before + total.coefficients + (0.0,) * after, total.offset)


def carried_c(lower: Chain, T_offset: Matrix, upper: Chain) -> AxisSum | None:
    """Return upper's running angle C, which still is one where lower and the offset only shift."""
    turned = any(joint.kind == "revolute" for joint in lower.joints) or not np.array_equal(T_offset[:3, :3], np.eye(3))
    if upper.absolute_c is None or turned:
        return None
    return padded(upper.absolute_c, len(lower.axes), 0)


def stack(
    lower: Chain, T_offset: Matrix, upper: Chain, *, lower_name: str | None = None, upper_name: str | None = None
) -> Chain:
    """Return two chains one on top of the other: the pose is lower's · T_offset · upper's.

    Axes, constraints, conventions and findings of both are carried over, lower's first. Frames `tool` and `flange` are
    upper's, `workpiece` is lower's; the frames they hide keep prefixed names (`LOWER_tool`, `LOWER_flange`,
    `UPPER_base`).

    Args:
        lower: The chain whose tool frame carries the other.
        T_offset: (4, 4) upper's workpiece frame in lower's tool frame [m].
        upper: The carried chain.
        lower_name: Prefix of lower's hidden frames; None: the name of its topmost partial.
        upper_name: Prefix of upper's names that lower has already; None: its name.

    Raises:
        ChainError: T_offset is no rigid transform.
    """
    T_offset = np.asarray(T_offset)
    if T_offset.shape != (4, 4) or T_offset.dtype.kind not in "iuf" or not is_rigid(T_offset):
        raise ChainError("T_offset is no rigid 4×4 transform", parameter="T_offset", permitted="a rigid transform")
    tool = lower.frame("tool")
    low, up = as_name(lower_name or _top(lower)), as_name(upper_name or upper.name)
    host = replace(lower, frames=_hidden(lower, low, "tool", "flange"))
    guest = replace(upper, frames=_renamed(upper.frames, {"workpiece": ""}))
    joined = _graft(host, tool.link, tool.T_link_frame @ T_offset, guest, up, root=upper.frame("workpiece"))
    return replace(
        joined,
        name=f"{lower.name}_{upper.name}",
        title=f"{upper.title} on {lower.title}",
        angle_mode=upper.angle_mode,
        vectors=upper.vectors,
        tool_axis=upper.tool_axis,
        absolute_c=carried_c(lower, T_offset, upper),
        display=upper.display if upper.display.kind == "angles" and not upper.display.follows else POSE_ANGLES,
        partials=_numbered((*_partials(lower, low), *_carried(upper, up, T_offset, len(lower.axes)))),
    )


def follow(chain: Chain, *, workpiece_of: Chain, name: str | None = None, other_name: str | None = None) -> Chain:
    """Return a chain whose workpiece frame rides on the tool frame of another: the pose is other's⁻¹ · chain's.

    Both refer to one coordinate system: the workpiece frame of `chain` and that of the other.

    Args:
        chain: The chain that carries the tool.
        workpiece_of: The chain that carries the workpiece.
        name: Name of `chain` among the partials; None: its own.
        other_name: Prefix of the other's names that `chain` has already; None: the name of its topmost partial.
    """
    other = workpiece_of
    place = chain.frame("workpiece")
    own, prefix = as_name(name or chain.name), as_name(other_name or _top(other))
    rider = replace(
        other,
        axes=tuple(replace(axis, carries="workpiece") for axis in other.axes),
        frames=_renamed(other.frames, {"tool": "workpiece", "workpiece": "", "flange": f"{prefix}_flange"}),
    )
    host = replace(chain, frames=_hidden(chain, own, "workpiece"))
    T_workpiece = other.frame("workpiece")
    joined = _graft(host, place.link, place.T_link_frame, rider, prefix, root=T_workpiece)
    return replace(
        joined,
        name=f"{chain.name}_{other.name}",
        title=f"{chain.title} at {other.title}",
        display=POSE_ANGLES,
        absolute_c=None,
        partials=_with_new_group(chain, own, other, prefix),
    )


def beside(chain: Chain, other: Chain, *, name: str | None = None, other_name: str | None = None) -> Chain:
    """Return a chain with another beside it that carries neither its tool nor its workpiece.

    The other's tips remain as frames `OTHER_tool` and `OTHER_flange`; the pose does not depend on its axes.
    """
    own, prefix = as_name(name or chain.name), as_name(other_name or _top(other))
    place = chain.frame("workpiece")
    guest = replace(
        other, frames=_renamed(other.frames, {"tool": f"{prefix}_tool", "workpiece": "", "flange": f"{prefix}_flange"})
    )
    joined = _graft(chain, place.link, place.T_link_frame, guest, prefix, root=other.frame("workpiece"))
    return replace(
        joined,
        name=f"{chain.name}_{other.name}",
        title=f"{chain.title} beside {other.title}",
        absolute_c=None if chain.absolute_c is None else padded(chain.absolute_c, 0, len(other.axes)),
        partials=_with_new_group(chain, own, other, prefix),
    )


def _with_new_group(chain: Chain, own: str, other: Chain, prefix: str) -> tuple[Partial, ...]:
    """Return the partials of a chain, then the other's in groups of their own."""
    partials = _partials(chain, own)
    group = 1 + max(partial.group for partial in partials)
    others = _carried(other, prefix, np.eye(4), len(chain.axes))
    return _numbered((*partials, *(replace(partial, group=group + partial.group) for partial in others)))


def displaced(chain: Chain, T: Matrix, *, name: str | None = None) -> Chain:
    """Return a chain with a displaced workpiece frame: the pose is T · the chain's.

    Args:
        chain: The chain.
        T: (4, 4) its workpiece frame in the new one [m].
        name: Its name among the partials; None: its own.
    """
    back = inverse(T)
    frames = tuple(
        replace(frame, T_link_frame=frame.T_link_frame @ back) if frame.name == "workpiece" else frame
        for frame in chain.frames
    )
    first, *rest = _partials(chain, as_name(name or chain.name))
    moved = replace(first, T_carrier_mcs=T @ first.T_carrier_mcs)
    return replace(chain, frames=frames, partials=(moved, *rest))


@dataclass(frozen=True, slots=True, eq=False)
class _Rerooted:
    """The tree of a chain seen from one of its frames.

    Attributes:
        root: Link that takes the place of the base.
        joints: Joints, parents first.
        order: Index of each of them in the chain.
        placements: Link → (4, 4) left factor of its old placements.
    """

    root: str
    joints: tuple[Joint, ...]
    order: NDArray[np.intp]
    placements: dict[str, Matrix]


def _reroot(chain: Chain, root: Frame) -> _Rerooted:
    """Reverse the joints between the base and a frame, so that the frame's link becomes the root."""
    path = path_to(chain, root.link)
    T = inverse(root.T_link_frame)
    placements = {root.link: T}
    turned: dict[str, Joint] = {}
    for joint in reversed(path):
        back = replace(joint, parent=joint.child, child=joint.parent, direction=-joint.direction + 0.0)
        # T is the joint's placement as drawn; its zero is folded into the placement again.
        placement = T @ joint_motion(back, -joint.zero) if joint.zero else T
        turned[joint.name] = replace(back, T_parent_joint=placement)
        # The frame of the former parent link is now the joint's own, moved.
        T = inverse(drawn(joint).T_parent_joint)
        placements[joint.parent] = T
    index = {joint.name: n for n, joint in enumerate(chain.joints)}
    joints = [turned[joint.name] for joint in reversed(path)]
    for joint in chain.joints:
        if joint.name not in turned:
            before = placements.get(joint.parent)
            moved = joint.T_parent_joint if before is None else before @ joint.T_parent_joint
            joints.append(replace(joint, T_parent_joint=moved))
    return _Rerooted(root.link, tuple(joints), np.array([index[j.name] for j in joints], dtype=np.intp), placements)


def _graft(host: Chain, link: str, T: Matrix, guest: Chain, prefix: str, *, root: Frame) -> Chain:
    """Return host and guest as one tree: the guest's root frame sits on a link of the host at T."""
    tree = _reroot(guest, root)
    names = Names.of(host, guest, prefix, link, tree.root)
    places = {**tree.placements, tree.root: T @ tree.placements[tree.root]}
    inertias = joined_inertias(host.geometry.inertias, guest.geometry.inertias, names.links, places)
    bodies = joined_geometry(host.geometry, guest.geometry, names.links, places, tree.root)
    return replace(
        host,
        links=(*host.links, *(_link(known, names) for known in guest.links if known.name != tree.root)),
        joints=(*host.joints, *(_joint(joint, tree.root, T, names) for joint in tree.joints)),
        frames=(*host.frames, *(_frames(guest, tree, T, names))),
        axes=(*host.axes, *(_axis(axis, names) for axis in guest.axes)),
        axis_map=side_by_side(_blocks(host, guest, tree.order), _shape(host, guest)),
        loops=(*host.loops, *(_loop(loop, names) for loop in guest.loops)),
        dialect=host.dialect if guest.dialect in host.dialect else f"{host.dialect} + {guest.dialect}",
        kinematic=f"{host.kinematic} + {guest.kinematic}",
        task="auto",
        constraints=(*padded_constraints(host, 0, len(guest.axes)), *padded_constraints(guest, len(host.axes), 0)),
        drives=joined_drives(host.drives, len(host.axes), guest.drives, len(guest.axes)),
        drive_limits=(
            *host.drive_limits,
            *(replace(one, axis=one.axis + len(host.axes)) for one in guest.drive_limits),
        ),
        follows_c=False,
        controller_solver=None,
        named_poses=(),
        geometry=replace(bodies, inertias=inertias),
        conventions=tuple({used.convention.name: used for used in (*host.conventions, *guest.conventions)}.values()),
        findings=Findings(dict.fromkeys((*host.findings, *guest.findings))),
    )


def _axis(axis: Axis, names: Names) -> Axis:
    return replace(axis, name=names.axes[axis.name], generic=names.generics[axis.generic])


def _link(link: Link, names: Names) -> Link:
    return replace(link, name=names.links[link.name])


def _joint(joint: Joint, root: str, T: Matrix, names: Names) -> Joint:
    placement = T @ joint.T_parent_joint if joint.parent == root else joint.T_parent_joint
    return replace(
        joint,
        name=names.joints[joint.name],
        parent=names.links[joint.parent],
        child=names.links[joint.child],
        T_parent_joint=placement,
    )


def _frames(guest: Chain, tree: _Rerooted, T: Matrix, names: Names) -> Iterable[Frame]:
    for frame in guest.frames:
        before = tree.placements.get(frame.link)
        placement = frame.T_link_frame if before is None else before @ frame.T_link_frame
        if frame.link == tree.root:
            placement = T @ placement
        yield Frame(names.frames[frame.name], names.links[frame.link], placement)


def _loop(loop: Loop, names: Names) -> Loop:
    a, b = names.frames[loop.frame_a], names.frames[loop.frame_b]
    return replace(loop, name=names.loops[loop.name], frame_a=a, frame_b=b)


def _blocks(host: Chain, guest: Chain, order: NDArray[np.intp]) -> tuple[Block, Block]:
    n_axes, n_q = len(host.axes), len(host.joints)
    # order says which old joint is at each new place; the map needs the new place of each old joint.
    places = np.empty_like(order)
    places[order] = np.arange(len(order))
    return (
        Block(host.axis_map, slice(0, n_axes), np.arange(n_q)),
        Block(guest.axis_map, slice(n_axes, n_axes + len(guest.axes)), n_q + places),
    )


def _shape(host: Chain, guest: Chain) -> tuple[int, int]:
    return len(host.joints) + len(guest.joints), len(host.axes) + len(guest.axes)


def _renamed(frames: Iterable[Frame], names: dict[str, str]) -> tuple[Frame, ...]:
    """Return frames under other names; those whose new name is empty are dropped."""
    kept = (frame for frame in frames if names.get(frame.name, frame.name))
    return tuple(replace(frame, name=names.get(frame.name, frame.name)) for frame in kept)


def _hidden(chain: Chain, prefix: str, *names: str) -> tuple[Frame, ...]:
    """Return the frames with some of them under prefixed names that are not in use."""
    taken = [frame.name for frame in chain.frames]
    new = {name: free_name(f"{prefix}_{name}", taken) for name in names}
    return _renamed(chain.frames, new)


def _top(chain: Chain) -> str:
    """Return the name of the partial that carries the tool."""
    return next((partial.name for partial in reversed(chain.partials) if partial.group == 0), chain.name)


def _partials(chain: Chain, name: str) -> tuple[Partial, ...]:
    return chain.partials or (Partial(name, chain, np.eye(4), 0),)


def _numbered(partials: tuple[Partial, ...]) -> tuple[Partial, ...]:
    """Return partials, each with a name of its own."""
    names: list[str] = []
    for partial in partials:
        names.append(free_name(partial.name, names))
    return tuple(replace(partial, name=name) for partial, name in zip(partials, names, strict=True))


def _carried(chain: Chain, name: str, T: Matrix, first_axis: int) -> tuple[Partial, ...]:
    """Return the partials of a chain that is put on another: the lowest sits at T, all axes follow."""
    first, *rest = (replace(p, first_axis=p.first_axis + first_axis) for p in _partials(chain, name))
    return (replace(first, T_carrier_mcs=T @ first.T_carrier_mcs), *rest)
