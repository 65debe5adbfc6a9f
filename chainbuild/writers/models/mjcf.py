"""MJCF: the chain for MuJoCo, its loops and couplings as equality constraints, its axes as actuators."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.bodies.body import Body, by_link
from chainbuild.chain.bodies.inertia import Inertia
from chainbuild.chain.bodies.shapes import machine_size
from chainbuild.chain.elements import BASE_LINK, Axis, Chain
from chainbuild.drawing.machine import drawn_bodies
from chainbuild.errors import ChainError
from chainbuild.files import number_text, numbers_text, xml_text
from chainbuild.frames import quaternion_from_matrix
from chainbuild.units import si_factor
from chainbuild.writers.models import notes
from chainbuild.writers.models.home import home, leading_joints
from chainbuild.writers.models.masses import MASSLESS, link_inertias, turnable
from chainbuild.writers.models.robotfiles import check_robot, write_robot_files

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Mechanism

# Joint of MuJoCo by that of the chain.
_KINDS: Final = {"revolute": "hinge", "prismatic": "slide"}
_SHAPES: Final = {"box": "box", "cylinder": "cylinder", "sphere": "sphere"}
_RIGHT: Final = 1e-9  # factors below this are rounding
# Constraints: as stiff as the step permits, so that a loop stays closed under its weight and while it moves.
_STEP_S: Final = 0.0005
_STIFF: Final[dict[str, str]] = {"solref": "0.001 1", "solimp": "0.999 0.9999 0.0001"}
_DRIVE_RAD_S: Final = 125.0  # of a drive with the whole machine as its load, 20 Hz: it gives way by less than 1 mm
_ARMATURE: Final = {"hinge": 1.0, "slide": 10.0}  # kg·m², kg: of rotor and gear, which machine data do not hold


def write_mjcf(robot: Mechanism, folder: Path | str = "urdf_out") -> Path:
    """Write a robot as folder/NAME/NAME.xml for MuJoCo and return that path.

    Joints bear the names of the chain, actuators those of the axes in their order; a control is an axis value in
    metres or radians. Loops are `connect`, joints that follow others `joint` or `tendon` constraints. Masses are
    estimates.

    Args:
        robot: The robot.
        folder: Folder in which the folder NAME is created.

    Raises:
        ChainbuildError: the argument is not a robot, or the kinematic has no pose to start from.
        FileAccessError: the folder is not a path, or the file cannot be written.
    """
    check_robot(robot)
    name = f"{robot.name}.xml"
    return write_robot_files(robot, folder, {name: mjcf_text(robot)})[name]


def mjcf_text(robot: Mechanism) -> str:
    """Return the MJCF of a robot."""
    chain = robot.chain
    axes, bodies = home(robot), drawn_bodies(robot.chain)
    root = ET.Element("mujoco", model=chain.name)
    root.append(ET.Comment(f"\n{notes.mjcf_header(chain)}\n"))
    _sub(root, "compiler", angle="radian", autolimits="false", balanceinertia="true")
    _sub(root, "option", timestep=number_text(_STEP_S), integrator="implicitfast", iterations="200", tolerance="1e-12")
    inertias = link_inertias(chain, bodies)
    _add_bodies(_sub(root, "worldbody"), robot, bodies, inertias)
    tendons, equality = _sub(root, "tendon"), _sub(root, "equality")
    for loop in chain.loops:
        if loop.kind != "ball":
            raise ChainError(f"loop {loop.name}: MJCF is written for balls only")
        _sub(equality, "connect", name=loop.name, site1=loop.frame_a, site2=loop.frame_b, **_STIFF)
    mass = sum(inertia.mass for inertia in inertias.values())
    actuators = _Drives(_sub(root, "actuator"), mass, machine_size(chain))
    if isinstance(chain.axis_map, AffineMap):
        lead = leading_joints(chain, chain.axis_map)
        _add_couplings(chain, chain.axis_map, lead, tendons, equality)
        _add_coupled_actuators(robot, chain.axis_map, lead, tendons, actuators)
    else:
        _add_own_actuators(robot, actuators)
    keys = _sub(root, "keyframe")
    controls = [float(value) * si_factor(axis.kind) for value, axis in zip(axes, chain.axes, strict=True)]
    kept = [value for value, axis in zip(controls, chain.axes, strict=True) if axis.name in actuators.names]
    _sub(keys, "key", name="home", qpos=numbers_text(_in_order(robot, robot.q(axes))), ctrl=numbers_text(kept))
    for empty in (tendons, equality):
        if not len(empty):
            root.remove(empty)
    return xml_text(root)


def _add_bodies(world: ET.Element, robot: Mechanism, bodies: Sequence[Body], inertias: Mapping[str, Inertia]) -> None:
    """Write the tree of links with joints, inertias, bodies to look at, and frames as sites."""
    chain = robot.chain
    shown = by_link(bodies)
    made: dict[str, ET.Element] = {BASE_LINK: _sub(world, "body", name=BASE_LINK)}
    lower, upper = robot.model.lowerPositionLimit, robot.model.upperPositionLimit
    for n, joint in enumerate(chain.joints):
        element = _sub(made[joint.parent], "body", name=joint.child, **_place(joint.T_parent_joint))
        made[joint.child] = element
        kind = _KINDS[joint.kind]
        limited = bool(np.isfinite([lower[n], upper[n]]).all())
        more = {"limited": "true", "range": numbers_text([lower[n], upper[n]])} if limited else {"limited": "false"}
        axis, given = numbers_text(joint.direction.tolist()), joint.dynamics
        losses = {"damping": given.damping, "frictionloss": given.friction}
        more |= {name: number_text(loss) for name, loss in losses.items() if loss}
        armature = number_text(_ARMATURE[kind])
        _sub(element, "joint", name=joint.name, type=kind, axis=axis, armature=armature, **more)
    for link, element in made.items():
        inertia = turnable(inertias.get(link, MASSLESS))
        moments = [float(inertia.moments[place]) for place in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
        place = {"pos": numbers_text(inertia.centre.tolist()), "mass": f"{inertia.mass:.15g}"}
        _sub(element, "inertial", **place, fullinertia=" ".join(f"{moment + 0.0:.15g}" for moment in moments))
        for body in (body for body in shown.get(link, ()) if body.kind != "mesh" and min(body.dimensions) > 0.0):
            size = [value / 2.0 for value in body.dimensions] if body.kind == "box" else list(body.dimensions)
            if body.kind == "cylinder":
                size[1] /= 2.0
            _sub(
                element, "geom", type=_SHAPES[body.kind], size=numbers_text(size), **_place(body.T_link_body),
                rgba=numbers_text((*body.colour, 1.0)), contype="0", conaffinity="0", group="2",
            )  # fmt: skip
    for frame in chain.frames:
        _sub(made[frame.link], "site", name=frame.name, **_place(frame.T_link_frame))


def _sub(parent: ET.Element, tag: str, **attributes: str) -> ET.Element:
    return ET.SubElement(parent, tag, attributes)


def _place(T: Matrix) -> dict[str, str]:
    x, y, z, w = quaternion_from_matrix(T[:3, :3])
    return {"pos": numbers_text(T[:3, 3].tolist()), "quat": numbers_text((w, x, y, z))}


def _in_order(robot: Mechanism, q: Vector) -> list[float]:
    """Return joint values in the order of the file: depth first, as MuJoCo counts."""
    chain = robot.chain
    children: dict[str, list[int]] = {link.name: [] for link in chain.links}
    for n, joint in enumerate(chain.joints):
        children[joint.parent].append(n)
    found: list[float] = []

    def walk(link: str) -> None:
        for n in children[link]:
            found.append(float(q[n]))
            walk(chain.joints[n].child)

    walk(BASE_LINK)
    return found


def _add_couplings(
    chain: Chain, axis_map: AffineMap, lead: list[int], tendons: ET.Element, equality: ET.Element
) -> None:
    """Write joints that follow others."""
    A, b, joints = axis_map.A, axis_map.b, chain.joints
    for n in (n for n in range(len(joints)) if n not in lead):
        factors = np.linalg.lstsq(A[lead].T, A[n], rcond=None)[0]
        offset = float(b[n] - factors @ b[lead])
        on = [(lead[k], float(factor)) for k, factor in enumerate(factors) if abs(factor) > _RIGHT]
        if len(on) < 2:
            follows = {"joint2": joints[on[0][0]].name} if on else {}
            poly = numbers_text([offset, on[0][1] if on else 0.0, 0.0, 0.0, 0.0])
            _sub(equality, "joint", joint1=joints[n].name, **follows, polycoef=poly, **_STIFF)
            continue
        name = f"{joints[n].name}_follows"
        _add_tendon(tendons, name, {joints[n].name: 1.0, **{joints[m].name: -factor for m, factor in on}})
        poly = numbers_text([offset, 0.0, 0.0, 0.0, 0.0])
        _sub(equality, "tendon", tendon1=name, polycoef=poly, **_STIFF)


def _add_tendon(tendons: ET.Element, name: str, factors: Mapping[str, float]) -> None:
    # Where the length is zero does not matter to a fixed tendon: it is the sum of the joints itself.
    element = _sub(tendons, "fixed", name=name)
    for joint, factor in factors.items():
        _sub(element, "joint", joint=joint, coef=number_text(factor))


def _add_coupled_actuators(
    robot: Mechanism, axis_map: AffineMap, lead: list[int], tendons: ET.Element, actuators: _Drives
) -> None:
    """Write a drive for each axis: on a joint, or on the sum of joints that is the axis value."""
    chain = robot.chain
    inverse = np.linalg.pinv(axis_map.A[lead])
    shift = inverse @ axis_map.b[lead]
    for k, axis in enumerate(chain.axes):
        on = {chain.joints[lead[m]].name: float(v) for m, v in enumerate(inverse[k]) if abs(v) > _RIGHT}
        if list(on.values()) == [1.0] and abs(shift[k]) <= _RIGHT:
            actuators.add(axis, {"joint": next(iter(on))})
        elif on:
            drive = f"{axis.name}_axis"
            _add_tendon(tendons, drive, on)
            actuators.add(axis, {"tendon": drive}, float(shift[k]))


def _add_own_actuators(robot: Mechanism, actuators: _Drives) -> None:
    """Write a drive for each axis that has a joint of its own; of a nonlinear map no other is known."""
    joints = {joint.name for joint in robot.chain.joints}
    for axis in robot.axes:
        if axis.name in joints:
            actuators.add(axis, {"joint": axis.name})


class _Drives:
    """Writes drives that hold their axes with the whole machine as their load.

    Args:
        root: Where they are written.
        mass: Of the machine [kg].
        arm: Its size [m].

    Attributes:
        names: Of the axes that have one, in order.
    """

    def __init__(self, root: ET.Element, mass: float, arm: float) -> None:
        self._root = root
        self.names: list[str] = []
        self._stiff = {"slide": mass * _DRIVE_RAD_S**2, "hinge": mass * arm**2 * _DRIVE_RAD_S**2}

    def add(self, axis: Axis, on: dict[str, str], shift: float = 0.0) -> None:
        """Write a drive that holds (length of what it is on) − shift at its control, without overshoot.

        Args:
            axis: Its axis.
            on: The joint or the tendon.
            shift: [m, rad].
        """
        self.names.append(axis.name)
        stiff = float(f"{self._stiff['slide' if axis.kind == 'linear' else 'hinge']:.3g}")
        ends = [si_factor(axis.kind) * end for end in axis.range]
        bias = [stiff * shift, -stiff, -2.0 * stiff / _DRIVE_RAD_S]
        _sub(
            self._root, "general", name=axis.name, **on, gaintype="fixed", biastype="affine",
            gainprm=number_text(stiff), biasprm=numbers_text(bias), ctrllimited="true", ctrlrange=numbers_text(ends),
        )  # fmt: skip
