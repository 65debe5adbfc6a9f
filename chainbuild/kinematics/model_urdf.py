"""Any Pinocchio model as URDF, which Pinocchio itself cannot write. This file imports Pinocchio alone.

A joint of the model becomes a joint of the same name. Its body is the link that it moves; frames become links that are
fixed to it. Joints of several freedoms that follow one another (translation, universal, three angles ZYX) become that
many joints in a row.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any, Final
from xml.sax.saxutils import quoteattr

import pinocchio as pin

_DIGITS: Final = 16  # significant, of computed angles: the last bit differs between machines, and is not written
_ENDLESS: Final = 1.7976931348623157e308  # what a limit says that is none; URDF knows no infinity
_ROOT: Final = "universe"  # Pinocchio's frame of the ground, and where no link bears another name
# Joints that one turn or slide makes, and those that a row of them makes.
_SLIDES: Final = ("JointModelPX", "JointModelPY", "JointModelPZ", "JointModelPrismaticUnaligned")
_TURNS: Final = ("JointModelRX", "JointModelRY", "JointModelRZ", "JointModelRevoluteUnaligned")
_ENDLESS_TURNS: Final = ("JointModelRUBX", "JointModelRUBY", "JointModelRUBZ", "JointModelRevoluteUnboundedUnaligned")
_ROWS: Final = {
    "JointModelTranslation": (("prismatic", (1, 0, 0)), ("prismatic", (0, 1, 0)), ("prismatic", (0, 0, 1))),
    "JointModelSphericalZYX": (("revolute", (0, 0, 1)), ("revolute", (0, 1, 0)), ("revolute", (1, 0, 0))),
}
_FREE: Final = {"JointModelFreeFlyer": "floating", "JointModelPlanar": "planar"}


def model_to_urdf(
    pin_model: pin.Model, collision: pin.GeometryModel | None = None, visual: pin.GeometryModel | None = None
) -> str:
    """Return a model as URDF text.

    Read back by Pinocchio (`mimic=True` where it mimics), poses, joint names, limits, masses and inertias are those of
    the model. What URDF cannot hold stands in a comment: rotor inertias, a mass fixed to the ground, lower limits of
    velocity and effort.

    Args:
        pin_model: The model.
        collision: Bodies for collisions: boxes, spheres, cylinders, capsules, meshes that were read from a file.
        visual: Bodies to look at.

    Raises:
        ValueError: the model has a joint that URDF cannot express (spherical, ellipsoid, helical, composite), or a body
            has no form in URDF; the message names it.
    """
    writer = _Writer(pin_model)
    for joint in range(1, pin_model.njoints):
        writer.joint(joint)
    writer.frames()
    for tag, geometry in (("collision", collision), ("visual", visual)):
        for body in geometry.geometryObjects if geometry is not None else ():
            writer.body(tag, body)
    return writer.text()


class _Writer:
    """Collects links and joints.

    Args:
        model: The model.
    """

    def __init__(self, model: pin.Model) -> None:
        self._model = model
        self._taken: set[str] = set()
        self._taken_joints = {str(name) for name in model.names}
        self._links: dict[str, list[str]] = {}  # name → elements
        self._joints: list[str] = []
        self._lost: list[str] = []  # what URDF cannot hold
        self._named = self._main_frames()
        self._of_joint = {0: self._link(self._named.get(0, _ROOT), model.inertias[0])}
        if float(model.inertias[0].mass) > 0.0:
            self._lost.append("the mass fixed to the ground counts in no sum of Pinocchio")
        self._note_lost()

    def _main_frames(self) -> dict[int, str]:
        """Return the name of the body of each joint: of its frames without displacement the first body."""
        found: dict[int, str] = {}
        for frame in self._model.frames:
            still = frame.placement.isIdentity(0.0)
            if frame.type == pin.FrameType.BODY and still and frame.parentJoint not in found:
                found[frame.parentJoint] = frame.name
        return found

    def _note_lost(self) -> None:
        model = self._model
        if any(value for value in model.armature) or any(value for value in model.rotorInertia):
            self._lost.append("rotor inertias (armature)")
        pairs = (
            ("velocity", model.lowerVelocityLimit, model.velocityLimit),
            ("effort", model.lowerEffortLimit, model.effortLimit),
        )
        for word, lower, upper in pairs:
            # Pinocchio's own readers give the lower one either sign.
            if any(abs(low) != abs(high) for low, high in zip(lower, upper, strict=True)):
                self._lost.append(f"lower limits of {word}")

    def _link(self, name: str, inertia: Any = None) -> str:
        """Add a link; its name is that of the model, or one that nothing bears yet."""
        free = _unused(name, self._taken)
        self._taken.add(free)
        self._links[free] = [] if inertia is None or float(inertia.mass) == 0.0 else [_inertial(inertia)]
        return free

    def joint(self, n: int) -> None:
        """Add a joint of the model, with the link that it moves."""
        model = self._model
        kind, name = model.joints[n].shortname(), str(model.names[n])
        parent = self._of_joint[model.parents[n]]
        child = self._named.get(n, f"{name}_link")
        parts = self._parts(n, kind, name)
        place = model.jointPlacements[n]
        for k, (part, type_, axis, extra) in enumerate(parts):
            last = k == len(parts) - 1
            link = self._link(child if last else f"{part}_link", model.inertias[n] if last else None)
            self._add(part, type_, parent, link, place, axis, extra)
            parent, place = link, pin.SE3.Identity()
        self._of_joint[n] = parent

    def _parts(self, n: int, kind: str, name: str) -> list[tuple[str, str, Sequence[float] | None, list[str]]]:
        """Return the joints that make one joint of the model: name, type, axis, further elements."""
        model, joint = self._model, self._model.joints[n]
        if kind in _FREE:
            return [(name, _FREE[kind], (0, 0, 1) if kind == "JointModelPlanar" else None, [])]
        if kind in _ROWS or kind == "JointModelUniversal":
            made: list[tuple[str, str, Sequence[float] | None, list[str]]] = []
            for k, (type_, axis) in enumerate(_ROWS[kind] if kind in _ROWS else self._universal(n)):
                part = _unused(f"{name}_{k + 1}", self._taken_joints)
                self._taken_joints.add(part)
                made.append(
                    (
                        part,
                        type_,
                        axis,
                        [self._limit(joint.idx_q + k, joint.idx_v + k), *self._dynamics(joint.idx_v + k)],
                    )
                )
            return made
        if kind == "JointModelMimic":
            mimic = joint.extract()
            if mimic.scaling == 0.0:
                raise ValueError(f"joint '{name}' follows another one by the factor 0: URDF has no such joint")
            driver = dict(zip(model.mimicking_joints, model.mimicked_joints, strict=True))[n]
            type_, axis = self._screw(n, mimic.scaling)
            driven = model.joints[driver]
            element = _element(
                "mimic", joint=str(model.names[driver]), multiplier=_text(mimic.scaling), offset=_text(mimic.offset)
            )
            ends = sorted(
                mimic.scaling * self._end(end[driven.idx_q]) + mimic.offset
                for end in (model.lowerPositionLimit, model.upperPositionLimit)
            )
            effort = velocity = _text(_ENDLESS)
            return [
                (
                    name,
                    type_,
                    axis,
                    [
                        _element("limit", lower=_text(ends[0]), upper=_text(ends[1]), effort=effort, velocity=velocity),
                        element,
                    ],
                )
            ]
        if kind in _ENDLESS_TURNS:
            effort, velocity = (
                _text(self._end(limit[joint.idx_v])) for limit in (model.effortLimit, model.velocityLimit)
            )
            limit = _element("limit", effort=effort, velocity=velocity)
            return [(name, "continuous", self._screw(n)[1], [limit, *self._dynamics(joint.idx_v)])]
        if kind in _TURNS or kind in _SLIDES:
            type_, axis = self._screw(n)
            return [(name, type_, axis, [self._limit(joint.idx_q, joint.idx_v), *self._dynamics(joint.idx_v)])]
        raise ValueError(f"joint '{name}' is a {kind.removeprefix('JointModel')}: URDF has no such joint")

    def _screw(self, n: int, scale: float = 1.0) -> tuple[str, list[float]]:
        """Return the type and the axis of a joint of one freedom."""
        joint = self._model.joints[n]
        data = joint.createData()
        joint.calc(data, pin.neutral(self._model))
        motion = [float(value) / scale for value in data.S.reshape(-1)]
        turns = any(motion[3:])
        return ("revolute", motion[3:]) if turns else ("prismatic", motion[:3])

    def _universal(self, n: int) -> Iterator[tuple[str, list[float]]]:
        """Yield the two turns of a universal joint, the first about an axis that stands still."""
        joint = self._model.joints[n]
        data = joint.createData()
        joint.calc(data, pin.neutral(self._model))
        for column in data.S.T:
            yield "revolute", [float(value) for value in column[3:]]

    @staticmethod
    def _end(value: float) -> float:
        return max(-_ENDLESS, min(_ENDLESS, float(value)))

    def _limit(self, q: int, v: int) -> str:
        model = self._model
        values = {
            "lower": model.lowerPositionLimit[q],
            "upper": model.upperPositionLimit[q],
            "effort": model.effortLimit[v],
            "velocity": model.velocityLimit[v],
        }
        return _element("limit", **{name: _text(self._end(value)) for name, value in values.items()})

    def _dynamics(self, v: int) -> list[str]:
        damping, friction = float(self._model.damping[v]), float(self._model.friction[v])
        if damping == 0.0 and friction == 0.0:
            return []
        return [_element("dynamics", damping=_text(damping), friction=_text(friction))]

    def frames(self) -> None:
        """Add the frames that are no joints and no bodies of joints, as links that are fixed."""
        model = self._model
        carriers = {frame.parentFrame for frame in model.frames if frame.type == pin.FrameType.BODY}
        used = set(self._named.items())
        for index, frame in enumerate(model.frames):
            if frame.type == pin.FrameType.JOINT or index == 0:
                continue
            if frame.type == pin.FrameType.FIXED_JOINT and index in carriers:
                continue  # its body names the joint
            key = (frame.parentJoint, frame.name)
            if frame.type == pin.FrameType.BODY and key in used:
                used.discard(key)
                continue
            carrier = model.frames[frame.parentFrame]
            named = (
                frame.type == pin.FrameType.BODY and carrier.type == pin.FrameType.FIXED_JOINT and carrier.name != _ROOT
            )
            name = _unused(carrier.name if named else f"{frame.name}_fixed", self._taken_joints)
            self._taken_joints.add(name)
            self._add(
                name, "fixed", self._of_joint[frame.parentJoint], self._link(frame.name), frame.placement, None, []
            )

    def body(self, tag: str, body: pin.GeometryObject) -> None:
        """Add a body to the link that carries it.

        Raises:
            ValueError: it has no form in URDF.
        """
        elements = self._links[self._of_joint[body.parentJoint]]
        for n, (shape, place) in enumerate(_shapes(body)):
            name = body.name if n == 0 else f"{body.name}_{n + 1}"
            colour = ""
            if tag == "visual":
                rgba = " ".join(_text(value) for value in body.meshColor)
                colour = f"<material name={quoteattr(f'{body.name}_colour')}>{_element('color', rgba=rgba)}</material>"
            elements.append(
                f"<{tag} name={quoteattr(name)}>{_origin(place)}<geometry>{shape}</geometry>{colour}</{tag}>"
            )

    def _add(
        self, name: str, type_: str, parent: str, child: str, place: Any, axis: Sequence[float] | None, extra: list[str]
    ) -> None:
        lines = [_element("parent", link=parent), _element("child", link=child), _origin(place)]
        if axis is not None:
            lines.append(_element("axis", xyz=" ".join(_text(value) for value in axis)))
        inner = "".join(f"\n    {line}" for line in (*lines, *extra) if line)
        self._joints.append(f"  <joint name={quoteattr(name)} type={quoteattr(type_)}>{inner}\n  </joint>")

    def text(self) -> str:
        """Return the file."""
        lines = ['<?xml version="1.0"?>', f"<robot name={quoteattr(self._model.name or 'robot')}>"]
        if self._lost:
            lines.append(f"  <!-- not in this file: {'; '.join(self._lost)} -->")
        for name, elements in self._links.items():
            inner = "".join(f"\n    {element}" for element in elements)
            lines.append(
                f"  <link name={quoteattr(name)}>{inner}\n  </link>" if inner else f"  <link name={quoteattr(name)}/>"
            )
        return "\n".join([*lines, *self._joints, "</robot>", ""])


def _unused(name: str, taken: set[str]) -> str:
    free, n = name, 2
    while free in taken:
        free, n = f"{name}_{n}", n + 1
    return free


def _text(value: float) -> str:
    """Return a number as text that is read as the same number; no signed zeros."""
    return f"{float(value) + 0.0!r}".removesuffix(".0")


def _element(tag: str, **attributes: str) -> str:
    return f"<{tag} {' '.join(f'{name}={quoteattr(value)}' for name, value in attributes.items())}/>"


def _origin(place: Any) -> str:
    """Return a placement; nothing where there is none."""
    if place.isIdentity(0.0):
        return ""
    xyz = " ".join(_text(value) for value in place.translation)
    rpy = " ".join(f"{value + 0.0:.{_DIGITS}g}" for value in _angles(place.rotation))
    return _element("origin", xyz=xyz, rpy=rpy)


def _angles(R: Any) -> tuple[float, float, float]:
    """Return roll, pitch, yaw, R = Rz(yaw)·Ry(pitch)·Rx(roll), also where the pitch is a right angle.

    Roll and pitch are those of what is left when the yaw has been turned back, so that all three fit together although
    the yaw alone is not determined there.
    """
    yaw = math.atan2(R[1, 0], R[0, 0])
    c, s = math.cos(yaw), math.sin(yaw)
    pitch = math.atan2(-R[2, 0], c * R[0, 0] + s * R[1, 0])
    roll = math.atan2(s * R[0, 2] - c * R[1, 2], c * R[1, 1] - s * R[0, 1])
    return roll, pitch, yaw


def _inertial(inertia: Any) -> str:
    """Return mass, centre and the moments about it."""
    moments = inertia.inertia
    names = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}
    parts = [
        _element("origin", xyz=" ".join(_text(value) for value in inertia.lever), rpy="0 0 0"),
        _element("mass", value=_text(inertia.mass)),
        _element("inertia", **{name: _text(moments[place]) for name, place in names.items()}),
    ]
    return f"<inertial>{''.join(parts)}</inertial>"


def _shapes(body: pin.GeometryObject) -> Iterator[tuple[str, Any]]:
    """Yield the shapes that make a body, with their places; a capsule is a cylinder and two spheres."""
    shape, place = body.geometry, body.placement
    kind = type(shape).__name__
    if kind == "Box":
        yield _element("box", size=" ".join(_text(2.0 * value) for value in shape.halfSide)), place
    elif kind == "Sphere":
        yield _element("sphere", radius=_text(shape.radius)), place
    elif kind in ("Cylinder", "Capsule"):
        yield _element("cylinder", radius=_text(shape.radius), length=_text(2.0 * shape.halfLength)), place
        for side in (1.0, -1.0) if kind == "Capsule" else ():
            end = pin.SE3(place)
            end.translation = place.translation + side * shape.halfLength * place.rotation[:, 2]
            yield _element("sphere", radius=_text(shape.radius)), end
    elif body.meshPath and body.meshPath not in {"BOX", "SPHERE", "CYLINDER", "CAPSULE"}:
        scale = " ".join(_text(value) for value in body.meshScale)
        yield _element("mesh", filename=body.meshPath, scale=scale), place
    else:
        raise ValueError(f"body '{body.name}' is a {kind} without a file: URDF has no such body")
