"""The robot's own axes: from machine axis to joint, seven arrangements of basic axes, the wrist.

Machine axis ↔ mathematical joint: AXIS_SEQ, AXES_DIR, MAMES and parallelogram (ROBX manual 5.3.15–5.3.17, 5.2.3).

    q_math[i] = AXES_DIR[i] · machine[AXIS_SEQ[i]] − MAMES[i]

AXIS_SEQ says which machine axis serves as internal axis i, AXES_DIR its sense, MAMES its zero.


Basic axes: seven arrangements of the first three axes, at mathematical zero stretched along +X (ROBX manual 5.3.7).

           Z                              A1 … A3 are internal axes, IRO is the frame at the left,
           |   Y     A         B          P3 sits on A3, parallel to IRO at zero.
           |  /    <----><--------->
    IRO    | /     A1    A2         A3 --> forearm: TX3P3
           |/______(|)____(o)_______(o)___________ X         (NR: Rz, Ry, Ry)

R turns about an axis of IRO, T shifts along it. What only the manual's missing figures would show is
a convention.


Wrist: one to three rotary axes in standard Denavit-Hartenberg form (ROBX manual 5.3.10–5.3.14).

    Rz(q4) · Tz(d0) Tx(a0) Rx(α0) · Rz(q5) · Tz(d1) Tx(a1) Rx(α1) · Rz(q6)

Five axes end after Rz(q5), four after Rz(q4).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from chainbuild import frames
from chainbuild.chain.assemble import Element, Fixed, Move, linear, rotary, shift
from chainbuild.convention import Choices
from chainbuild.formats.sinumerik.reading.robx import Robx


@dataclass(frozen=True, slots=True)
class InternalAxis:
    """One axis as the transformation numbers it.

    Attributes:
        name: Name of the machine axis that serves as it.
        drive: Machine axis → factor.
        offset: mm or degrees: value = Σ drive·machine + offset.
    """

    name: str
    drive: dict[str, float]
    offset: float


@dataclass(frozen=True, slots=True)
class InternalAxes:
    """The axes of the transformation in its own order.

    Attributes:
        math: q_math of each axis, after AXIS_SEQ, AXES_DIR and MAMES.
        joints: What the joints of the chain move by; it differs from `math` at the elbow of a parallelogram.
    """

    math: tuple[InternalAxis, ...]
    joints: tuple[InternalAxis, ...]

    def joint(self, number: int, motion: str) -> Move:
        """Return the joint of an internal axis.

        Args:
            number: Internal axis number, from 1.
            motion: "Rz" turns about Z, "Tx" shifts along X; "-Ry" turns about -Y.
        """
        axis = self.joints[number - 1]
        direction = motion.replace("R", "").replace("T", "")
        if "R" in motion:
            return rotary(axis.name, direction, drive=axis.drive, offset_deg=axis.offset)
        return linear(axis.name, direction, drive=axis.drive, offset_mm=axis.offset)


def internal_axes(robx: Robx, choose: Choices) -> InternalAxes:
    """Return the internal axes of a transformation.

    Conventions: `axes_dir_index` where AXIS_SEQ permutes, `special_kin_2` for a parallelogram.
    """
    inputs = [number - 1 for number in robx.axis_seq[: robx.num_axes]]
    permuted = inputs != list(range(robx.num_axes))
    by_input = permuted and choose["axes_dir_index"] == "input"
    math = []
    for i, k in enumerate(inputs):
        source = k if by_input else i
        name = f"A{k + 1}"
        math.append(InternalAxis(name, {name: float(robx.axes_dir[source])}, -robx.mames[source]))
    joints = list(math)
    if robx.special_kin == 2:
        joints[2] = _elbow(math[1], math[2], choose["special_kin_2"])
    return InternalAxes(tuple(math), tuple(joints))


def _elbow(shoulder: InternalAxis, pitch: InternalAxis, choice: str) -> InternalAxis:
    """Return the elbow joint of a parallelogram arm: axis 3 holds the forearm's pitch while axis 2 moves.

    absolute_pitch: q3 − q2. relative_at_zero: q3 − (q2 + m2), m2 the MAMES in q2, so that axis 2 at its machine zero
    leaves q3 as the elbow angle.
    """
    drive = pitch.drive | {name: -factor for name, factor in shoulder.drive.items()}
    zero = shoulder.offset if choice == "absolute_pitch" else 0.0
    return InternalAxis(pitch.name, drive, pitch.offset - zero)


@dataclass(frozen=True, slots=True)
class ArmData:
    """Input of a recipe.

    Attributes:
        axes: The internal axes.
        a: Length A [mm].
        b: Length B [mm].
        choose: Conventions.
    """

    axes: InternalAxes
    a: float
    b: float
    choose: Choices

    def joint(self, number: int, motion: str) -> Move:
        """Return the joint of internal axis `number`; motion as "Rz", "Tx", "-Ry"."""
        return self.axes.joint(number, motion)


Recipe = Callable[[ArmData], Sequence[Element]]


def ss(arm: ArmData) -> Sequence[Element]:
    """Gantry: three linear axes at right angles, no length."""
    first, second, third = {"xyz": ("Tx", "Ty", "Tz"), "zyx": ("Tz", "Ty", "Tx")}[arm.choose["ss"]]
    return arm.joint(1, first), arm.joint(2, second), arm.joint(3, third)


def cc(arm: ArmData) -> Sequence[Element]:
    """SCARA: a linear and two rotary axes, all parallel to Y; A: origin → A2, B: A2 → A3."""
    lift = "Ty" if arm.choose["cc_linear_sign"] == "plus" else "-Ty"
    turn = "Ry" if arm.choose["cc_rotary_sign"] == "plus" else "-Ry"
    return arm.joint(1, lift), shift(x=arm.a), arm.joint(2, turn), shift(x=arm.b), arm.joint(3, turn)


def nr(arm: ArmData) -> Sequence[Element]:
    """Articulated arm: column, shoulder, elbow; A: A1 → A2, B: A2 → A3."""
    return arm.joint(1, "Rz"), shift(x=arm.a), arm.joint(2, "Ry"), shift(x=arm.b), arm.joint(3, "Ry")


def sc(arm: ArmData) -> Sequence[Element]:
    """Two linear axes carry a rotary one; A: origin → A3."""
    first, second = {"zy": ("Tz", "Ty"), "yx": ("Ty", "Tx")}[arm.choose["sc"]]
    return arm.joint(1, first), arm.joint(2, second), shift(x=arm.a), arm.joint(3, "Ry")


def rr(arm: ArmData) -> Sequence[Element]:
    """Two perpendicular rotary axes and a linear one; A along the arm."""
    order = arm.choose["rr"]
    if order == "rot_rot_lin":
        return arm.joint(1, "Rz"), shift(x=arm.a), arm.joint(2, "Ry"), arm.joint(3, "Tx")
    if order == "rot_lin_rot":
        return arm.joint(1, "Rz"), shift(x=arm.a), arm.joint(2, "Tx"), arm.joint(3, "Ry")
    return arm.joint(1, "Tz"), arm.joint(2, "Rz"), shift(x=arm.a), arm.joint(3, "Ry")


def cs(arm: ArmData) -> Sequence[Element]:
    """A rotary axis carries two linear ones; A along the arm."""
    turn, lift, reach = {
        "zx": ("Rz", "Tz", "Tx"),
        "zy": ("Rz", "Tz", "Ty"),
        "rotary_about_y": ("Ry", "Ty", "Tx"),
    }[arm.choose["cs"]]
    return arm.joint(1, turn), arm.joint(2, lift), shift(x=arm.a), arm.joint(3, reach)


def nn(arm: ArmData) -> Sequence[Element]:
    """Three rotary axes; A: A1 → A2, B: A2 → A3."""
    last = {"zyz": "Rz", "zyx": "Rx"}[arm.choose["nn"]]
    return arm.joint(1, "Rz"), shift(x=arm.a), arm.joint(2, "Ry"), shift(x=arm.b), arm.joint(3, last)


RECIPES: Mapping[int, Recipe] = {1: ss, 2: cc, 3: nr, 4: sc, 5: rr, 6: cs, 7: nn}


def basic_moves(elements: Sequence[Element]) -> tuple[Move, Move, Move]:
    """Return the three joints of a recipe."""
    first, second, third = (element for element in elements if isinstance(element, Move))
    return first, second, third


def wrist(robx: Robx, axes: InternalAxes) -> Sequence[Element]:
    """Return the wrist's joints; the flange frame follows on the last of them."""
    elements: list[Element] = [axes.joint(4, "Rz")]
    for n in range(robx.num_axes - 4):
        elements += [dh(robx, n), axes.joint(5 + n, "Rz")]
    return elements


def dh(robx: Robx, n: int) -> Fixed:
    """Return the fixed part from wrist axis 4 + n to the next one."""
    link = robx.dh[n]
    return Fixed(frames.dh_link(link.d_mm, link.a_mm, link.alpha_deg))
