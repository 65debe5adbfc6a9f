"""A delta robot with all its six rods and a platform that may turn, in Pinocchio: 21 joints, 18 rows of constraints."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pinocchio as pin

from chainbuild import Loop, Robot
from chainbuild.kinematics.closure import Closure

APART = 0.05  # m between the rods of a pair: in no machine data
_AZIMUTHS = (-90.0, 30.0, 150.0)


class SixRods:
    """The machine of HD values in mm and degrees, beside the robot that chainbuild builds from them.

    Attributes:
        model: Platform first (three shifts, three turns), then each arm: lever, swing and lean of its two rods.
        closure: Its balls.
        passive: Indices of the joints that no axis drives.
    """

    def __init__(self, hd: dict[int, float]) -> None:
        base, platform, lever, rod = (hd[n] / 1000.0 for n in (5, 4, 7, 6))
        model, joint = pin.Model(), 0
        for kind, name in ((pin.JointModelPX, "x"), (pin.JointModelPY, "y"), (pin.JointModelPZ, "z")):
            joint = model.addJoint(joint, kind(), pin.SE3.Identity(), f"platform_{name}")
        for kind, name in ((pin.JointModelRX, "a"), (pin.JointModelRY, "b"), (pin.JointModelRZ, "c")):
            joint = model.addJoint(joint, kind(), pin.SE3.Identity(), f"platform_{name}")
        balls = []
        for n, azimuth in enumerate(_AZIMUTHS):
            R = pin.utils.rotate("z", math.radians(azimuth))
            foot = pin.SE3(R, R @ np.array([base, 0.0, 0.0]))
            arm = model.addJoint(0, pin.JointModelRY(), foot, f"J{n + 1}")
            for side in (-APART / 2.0, APART / 2.0):
                upper = pin.SE3(np.eye(3), np.array([lever, side, 0.0]))
                swing = model.addJoint(arm, pin.JointModelRY(), upper, f"swing_{n}_{side}")
                lean = model.addJoint(swing, pin.JointModelRX(), pin.SE3.Identity(), f"lean_{n}_{side}")
                end = pin.SE3(np.eye(3), np.array([0.0, 0.0, -rod]))
                pinned = pin.SE3(R, R @ np.array([platform, side, 0.0]))
                names = f"end_{n}_{side}", f"pin_{n}_{side}"
                for name, carrier, place in zip(names, (lean, joint), (end, pinned), strict=True):
                    model.addFrame(pin.Frame(name, carrier, place, pin.FrameType.OP_FRAME))
                balls.append(names)
        self.model, self.passive = model, np.array([n for n in range(21) if n not in (6, 11, 16)])
        mechanism: Any = SimpleNamespace(
            model=model,
            kinematics=SimpleNamespace(data=model.createData()),
            chain=SimpleNamespace(name="six rods", joints=()),
            axes=(),
        )
        self.closure = Closure(mechanism, [Loop(f"rod {n}", "ball", *ends) for n, ends in enumerate(balls)])

    def q(self, robot: Robot, axes: np.ndarray) -> np.ndarray:
        """Return the joint values (21,) at axis values of the machine with one rod a pair: both rods stand alike."""
        values = dict(zip([joint.name for joint in robot.chain.joints], robot.q(axes), strict=True))
        q = [*(values[f"platform_{letter}"] for letter in "xyz"), 0.0, 0.0, 0.0]
        for n in (1, 2, 3):
            rod = [values[f"J{n}_swing"], values[f"J{n}_lean"]]
            q += [values[f"J{n}"], *rod, *rod]
        return np.array(q)
