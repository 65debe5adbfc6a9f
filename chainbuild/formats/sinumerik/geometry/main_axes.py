"""Basic axes: seven arrangements of the first three axes, at mathematical zero stretched along +X (ROBX manual 5.3.7).

           Z                              A1 … A3 are internal axes, IRO is the frame at the left,
           |   Y     A         B          P3 sits on A3, parallel to IRO at zero.
           |  /    <----><--------->
    IRO    | /     A1    A2         A3 --> forearm: TX3P3
           |/______(|)____(o)_______(o)___________ X         (NR: Rz, Ry, Ry)

R turns about an axis of IRO, T shifts along it. What the manual's figures would have shown and its text does not say is
a convention.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from chainbuild.chain.assemble import Element, Move, shift
from chainbuild.convention import Choices
from chainbuild.formats.sinumerik.geometry.internal_axes import InternalAxes


@dataclass(frozen=True, slots=True)
class Arm:
    """What a recipe is made of.

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


Recipe = Callable[[Arm], Sequence[Element]]


def ss(arm: Arm) -> Sequence[Element]:
    """Gantry: three linear axes at right angles, no length."""
    first, second, third = {"xyz": ("Tx", "Ty", "Tz"), "zyx": ("Tz", "Ty", "Tx")}[arm.choose["ss"]]
    return arm.joint(1, first), arm.joint(2, second), arm.joint(3, third)


def cc(arm: Arm) -> Sequence[Element]:
    """SCARA: a linear and two rotary axes, all parallel to Y; A: origin → A2, B: A2 → A3."""
    lift = "Ty" if arm.choose["cc_linear_sign"] == "plus" else "-Ty"
    turn = "Ry" if arm.choose["cc_rotary_sign"] == "plus" else "-Ry"
    return arm.joint(1, lift), shift(x=arm.a), arm.joint(2, turn), shift(x=arm.b), arm.joint(3, turn)


def nr(arm: Arm) -> Sequence[Element]:
    """Articulated arm: column, shoulder, elbow; A: A1 → A2, B: A2 → A3."""
    return arm.joint(1, "Rz"), shift(x=arm.a), arm.joint(2, "Ry"), shift(x=arm.b), arm.joint(3, "Ry")


def sc(arm: Arm) -> Sequence[Element]:
    """Two linear axes carry a rotary one; A: origin → A3."""
    first, second = {"zy": ("Tz", "Ty"), "yx": ("Ty", "Tx")}[arm.choose["sc"]]
    return arm.joint(1, first), arm.joint(2, second), shift(x=arm.a), arm.joint(3, "Ry")


def rr(arm: Arm) -> Sequence[Element]:
    """Two perpendicular rotary axes and a linear one; A along the arm."""
    order = arm.choose["rr"]
    if order == "rot_rot_lin":
        return arm.joint(1, "Rz"), shift(x=arm.a), arm.joint(2, "Ry"), arm.joint(3, "Tx")
    if order == "rot_lin_rot":
        return arm.joint(1, "Rz"), shift(x=arm.a), arm.joint(2, "Tx"), arm.joint(3, "Ry")
    return arm.joint(1, "Tz"), arm.joint(2, "Rz"), shift(x=arm.a), arm.joint(3, "Ry")


def cs(arm: Arm) -> Sequence[Element]:
    """A rotary axis carries two linear ones; A along the arm."""
    turn, lift, reach = {
        "zx": ("Rz", "Tz", "Tx"),
        "zy": ("Rz", "Tz", "Ty"),
        "rotary_about_y": ("Ry", "Ty", "Tx"),
    }[arm.choose["cs"]]
    return arm.joint(1, turn), arm.joint(2, lift), shift(x=arm.a), arm.joint(3, reach)


def nn(arm: Arm) -> Sequence[Element]:
    """Three rotary axes; A: A1 → A2, B: A2 → A3."""
    last = {"zyz": "Rz", "zyx": "Rx"}[arm.choose["nn"]]
    return arm.joint(1, "Rz"), shift(x=arm.a), arm.joint(2, "Ry"), shift(x=arm.b), arm.joint(3, last)


RECIPES: Mapping[int, Recipe] = {1: ss, 2: cc, 3: nr, 4: sc, 5: rr, 6: cs, 7: nn}


def basic_moves(elements: Sequence[Element]) -> tuple[Move, Move, Move]:
    """Return the three joints of a recipe."""
    first, second, third = (element for element in elements if isinstance(element, Move))
    return first, second, third
