"""The solvers beside each other: pose (4, 4) → what they answer → joint values (k, 6).

What a solver wants to be handed instead of the pose is made before the clock starts; joint values are taken out of its
answer after it has stopped.
"""

from __future__ import annotations

import importlib
import importlib.util
import sys
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final
from unittest.mock import patch

import numpy as np

from chainbuild.chain.assemble import Fixed, Mark, Move
from chainbuild.chain.elements import Axis
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.opw.parameters import opw_arm
from chainbuild.ik.request import IkRequest
from chainbuild.ik.search.compiled import packing
from chainbuild.robot import Robot
from tests.bench.arms.geometry import Arm
from tests.bench.arms.truth import is_right
from tests.kit.chains import chain_from

OURS, PLAIN, SSIK, EAIK, OPW = "chainbuild", "chainbuild, plain", "ssik", "EAIK", "py-opw-kinematics"
SOLVERS: Final = (OURS, PLAIN, SSIK, EAIK, OPW)
BUILT: Final = ("irb120 calibrated", "ur5 calibrated", "fanuc_crx10ia calibrated")  # one of each class, see `build`


@dataclass(frozen=True, eq=False)
class Peer:
    """A solver of one arm.

    Attributes:
        name: Its name.
        prepare: Pose (4, 4) → what it wants to be handed.
        solve: → what it answers; this is timed.
        joints: Its answer and the pose (4, 4) → joint values (k, 6) [rad].
        around: What holds while it solves.
    """

    name: str
    prepare: Callable[[np.ndarray], Any]
    solve: Callable[[Any], Any]
    joints: Callable[[Any, np.ndarray], np.ndarray]
    around: Callable[[], AbstractContextManager[Any]] = nullcontext


def rows(values: Any) -> np.ndarray:
    """Return joint values as (k, 6) without those that are not finite."""
    found = np.asarray(values, dtype=float).reshape(-1, 6)
    return found[np.isfinite(found).all(axis=1)]


def robot_of(arm: Arm) -> Robot:
    """Return the arm as chainbuild takes it, all axes endless: limits play no role."""
    names = [f"A{i + 1}" for i in range(6)]
    axes = [Axis(name, "rotary", "deg", -180.0, 180.0, assumed=False, endless=True) for name in names]
    tool: list[Any] = []
    for name, axis, offset in zip(names, arm.axes, arm.offsets(), strict=False):
        tool += [Fixed(_shift(offset * 1e3)), Move(name, "revolute", tuple(axis.tolist()), {name: 1.0})]
    last = _shift(arm.offsets()[6] * 1e3)
    last[:3, :3] = arm.M[:3, :3]
    return Robot(chain_from(axes, [*tool, Mark("flange"), Fixed(last)]))


def ours(arm: Arm, *, plain: bool) -> Peer:
    """`Robot.ik_all`, compiled where it is; plain: as without numba."""
    robot = robot_of(arm)

    def without() -> AbstractContextManager[Any]:
        return patch.object(packing, "available", return_value=False)

    return Peer(
        PLAIN if plain else OURS,
        np.ascontiguousarray,
        robot.ik_all,
        lambda found, _: rows(np.radians(found.axes)),
        without if plain else nullcontext,
    )


def ssik(arm: Arm, module: Any) -> Peer:
    """`solve` of a module that ssik ships or has built, C++; every branch once, as ssik's own benchmark calls it."""
    solve = module.solve
    return Peer(
        SSIK,
        np.ascontiguousarray,
        lambda T: solve(T, respect_limits=False, enumerate_windings=False),
        lambda found, _: rows([solution.q for solution in found]),
    )


def eaik(arm: Arm) -> Peer | None:
    """EAIK: subproblems, C++; None where it does not know the arm.

    What it marks as approximation counts where it is right: at the edge of the reach some are, but for rounding.
    """
    from eaik.IK_HP import HPRobot

    model = HPRobot(arm.axes, arm.offsets())
    if not model.hasKnownDecomposition():
        return None

    def prepare(T: np.ndarray) -> np.ndarray:
        pose = T.copy()
        pose[:3, :3] = T[:3, :3] @ arm.M[:3, :3].T
        return pose

    def joints(found: Any, T: np.ndarray) -> np.ndarray:
        values = np.asarray(found.Q, dtype=float).reshape(-1, 6)
        approximate = np.asarray(found.is_LS, dtype=bool).reshape(-1)
        marked = rows(values[approximate])
        return np.vstack([rows(values[~approximate]), marked[is_right(arm, marked, T)]])

    return Peer(EAIK, prepare, model.IK, joints)


def opw(arm: Arm) -> Peer | None:
    """py-opw-kinematics: the closed form of ortho-parallel arms with a spherical wrist, Rust."""
    import py_opw_kinematics
    from scipy.spatial.transform import RigidTransform

    known = opw_arm(BranchQuery.of(IkRequest(robot_of(arm), np.eye(4))).serial())
    if known is None:
        return None
    model = py_opw_kinematics.Robot(py_opw_kinematics.KinematicModel(**known.parameters), degrees=False)
    before, after = np.linalg.inv(known.T_base_arm), np.linalg.inv(known.T_flange_tool)

    def joints(found: Any, _: np.ndarray) -> np.ndarray:
        theta = np.asarray(found, dtype=float).reshape(-1, 6)
        return rows(known.joints(theta))

    return Peer(OPW, lambda T: RigidTransform.from_matrix(before @ T @ after), model.inverse, joints)


def peers(arm: Arm, module: Any | None) -> Iterator[Peer]:
    """Yield the solvers that are installed and take the arm; module: ssik's solver of it, or None."""
    yield ours(arm, plain=False)
    yield ours(arm, plain=True)
    if module is not None:
        yield ssik(arm, module)
    for make in (eaik, opw):
        try:
            peer = make(arm)
        except ImportError as error:
            print(f"skipped: {make.__name__} ({error.name} is not installed)", file=sys.stderr)
            continue
        if peer is not None:
            yield peer


def build(arm: Arm, folder: Path) -> None:
    """Let ssik build its solver of an arm, with the tensor that its C++ part wants: minutes of symbolic algebra."""
    from ssik._kinbody import JointSpec, build_kinbody
    from ssik._native import bake_rr_tensor_npz
    from ssik.core.codegen import emit_artifact
    from ssik.core.dispatcher import dispatch

    offsets = arm.offsets()
    last = _shift(offsets[6])
    last[:3, :3] = arm.M[:3, :3]
    kinbody = build_kinbody(
        [
            JointSpec(
                parent_link_T=_shift(offset),
                axis=axis,
                joint_type="revolute",
                child_link_T=last if i == 5 else None,
            )
            for i, (offset, axis) in enumerate(zip(offsets, arm.axes, strict=False))
        ]
    )
    plan = dispatch(kinbody)
    folder.mkdir(parents=True, exist_ok=True)
    path = _built_file(arm, folder)
    if plan.solver_name == "ikgeo.general_6r":
        bake_rr_tensor_npz(kinbody, str(path.with_name(path.stem.removesuffix("_ik") + "_rr.npz")))
    emit_artifact(kb=kinbody, plan=plan, module_name=path.stem, output_path=str(path), arm_label=path.stem)


def built(arm: Arm, folder: Path) -> Any | None:
    """Return the module that `build` has left in a folder for exactly this arm, or None."""
    path = _built_file(arm, folder)
    if not path.exists():
        return None
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    q = np.linspace(-1.0, 1.0, 6)
    return module if np.abs(module.fk(q) - arm.pose(q)).max() < 1e-9 else None


def _built_file(arm: Arm, folder: Path) -> Path:
    return folder / f"{arm.name.replace(' ', '_')}_ik.py"


def _shift(offset: np.ndarray) -> np.ndarray:
    T = np.eye(4)
    T[:3, 3] = offset
    return T
