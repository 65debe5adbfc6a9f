"""The screws of the single joints: how each moves the tool against the workpiece."""

from __future__ import annotations

import pinocchio as pin
from numpy.typing import ArrayLike

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.elements import BASE_LINK, Chain
from chainbuild.kinematics.evaluation import frame_jacobian
from chainbuild.kinematics.mechanism import Mechanism


def joint_screws(robot: Mechanism, axes: ArrayLike) -> Matrix:
    """Return the Jacobian (6, n_q) by joint values at axis values (n_axes,), mm and degrees.

    Linear rows [m], then angular; tool relative to workpiece, expressed in the tool frame. Where axes are coupled, as
    in a parallelogram, these columns still show the lines that the joints turn about.

    Raises:
        AxisValueError: wrong count or not finite.
    """
    return screws_at(robot, robot.q(axes))


def screws_at(robot: Mechanism, q: Vector) -> Matrix:
    """Return the Jacobian (6, n_q) by joint values at joint values (n_q,); see `joint_screws`."""
    model, data = robot.model, robot.kinematics.data
    pin.computeJointJacobians(model, data, q)
    tool, workpiece = model.getFrameId("tool"), model.getFrameId("workpiece")
    T_tool, T_workpiece = (pin.updateFramePlacement(model, data, frame).copy() for frame in (tool, workpiece))
    back = T_tool.actInv(T_workpiece).toActionMatrix()
    return frame_jacobian(model, data, tool) - back @ frame_jacobian(model, data, workpiece)


def joints_between_tips(chain: Chain) -> tuple[int, ...]:
    """Return the indices of the joints that move the tool against the workpiece, from the workpiece to the tool."""
    carrier = {joint.child: n for n, joint in enumerate(chain.joints)}

    def way(link: str) -> list[int]:
        found: list[int] = []
        while link != BASE_LINK:
            n = carrier[link]
            found.insert(0, n)
            link = chain.joints[n].parent
        return found

    down, up = way(chain.frame("workpiece").link), way(chain.frame("tool").link)
    while down and up and down[0] == up[0]:  # a joint that carries both tips moves neither against the other
        del down[0], up[0]
    return (*reversed(down), *up)
