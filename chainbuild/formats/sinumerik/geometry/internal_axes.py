"""Machine axis ↔ mathematical joint: AXIS_SEQ, AXES_DIR, MAMES and parallelogram (ROBX manual 5.3.15–5.3.17, 5.2.3).

    q_math[i] = AXES_DIR[i] · machine[AXIS_SEQ[i]] − MAMES[i]

AXIS_SEQ says which machine axis serves as internal axis i, AXES_DIR its sense, MAMES its zero.
"""

from __future__ import annotations

from dataclasses import dataclass

from chainbuild.chain.assemble import Move, linear, rotary
from chainbuild.convention import Choices
from chainbuild.formats.sinumerik.reading.robx import Robx


@dataclass(frozen=True, slots=True)
class InternalAxis:
    """One axis as the transformation numbers it.

    Attributes:
        name: Name of the machine axis that stands for it.
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
