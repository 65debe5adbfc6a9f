"""Other solvers to compare with: a Python callable, EAIK, py-opw-kinematics, the Robotics Toolbox."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.comparison.eaik_model import eaik_answers, eaik_robot
from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.core.axis_values import axes_for
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.opw.parameters import opw_arm
from chainbuild.ik.request import IkRequest
from chainbuild.kinematics.closure import closing_axes

if TYPE_CHECKING:
    from chainbuild.ik.branches.core.serial import Serial
    from chainbuild.kinematics.mechanism import Mechanism

FkFunction = Callable[[Vector], Matrix]
IkFunction = Callable[[Matrix], list[Vector]]
CallableKind = Literal["auto", "fk", "ik"]


@dataclass(frozen=True, slots=True)
class OtherSolver:
    """A solver to compare with; axis values in mm and degrees, poses (4, 4) in metres.

    Attributes:
        name: Display name.
        fk: Axis values → pose, or None.
        ik: Pose → answers, or None.
        complete: Whether `ik` claims to return every branch.
        note: Its source.
    """

    name: str
    fk: FkFunction | None = None
    ik: IkFunction | None = None
    complete: bool = True
    note: str = ""

    def pose(self, axes: Vector) -> Matrix:
        """Return the pose of axis values; a copy on both ways, whatever the solver writes into or returns again.

        Raises:
            ChainbuildError: the solver fails.
        """
        assert self.fk is not None  # the caller looks first
        with _failures_named(self.name):
            return np.array(self.fk(axes.copy()))

    def answers(self, T: Matrix) -> list[Vector]:
        """Return the answers to a pose; copies on both ways.

        Raises:
            ChainbuildError: the solver fails.
        """
        assert self.ik is not None  # the caller looks first
        with _failures_named(self.name):
            return [np.array(answer) for answer in self.ik(T.copy())]


@contextmanager
def _failures_named(name: str) -> Iterator[None]:
    """Raise what a solver raises as an error that names it."""
    try:
        yield
    except ChainbuildError:
        raise
    except (Exception, SystemExit) as error:  # the function is the user's: it may raise anything, and end the process
        raise ChainbuildError(f"{name} fails: {type(error).__name__}: {error}", parameter="solver") from error


def other_solver_by_name(robot: Mechanism, solver: str, kind: CallableKind = "auto") -> OtherSolver:
    """Return the solver of a name: "eaik", "opw", "roboticstoolbox" or "module:function".

    Raises:
        ChainbuildError: the solver is unknown, not installed, or does not support this kinematic.
    """
    if ":" in solver:
        return other_solver_from_function(robot, _import(solver), solver, kind)
    maker = _BY_NAME.get(solver.lower())
    if maker is None:
        permitted = f"{', '.join(_BY_NAME)}, module:function, or a CSV recording"
        raise ChainbuildError(f"unknown solver '{solver}'", parameter="solver", permitted=permitted)
    return maker(robot)


def _import(spec: str) -> Callable[..., Any]:
    """Return the callable of "module:function"; modules in the working folder are found, too."""
    name, _, attribute = spec.partition(":")
    here = str(Path.cwd())
    if here not in sys.path:
        sys.path.insert(0, here)
    try:
        found: Any = import_module(name)
        for part in attribute.split("."):
            found = getattr(found, part)
    except (Exception, SystemExit) as error:  # the module is the user's: it may raise anything, and end the process
        raise ChainbuildError(f"'{spec}' cannot be imported: {_words(error)}", parameter="solver") from None
    if not callable(found):
        raise ChainbuildError(f"'{spec}' is not a function", parameter="solver", permitted="module:function")
    result: Callable[..., Any] = found
    return result


def _words(error: BaseException) -> str:
    """Return what an error of foreign code says, with its kind where the text alone says little."""
    if isinstance(error, ImportError | AttributeError | ValueError):
        return str(error)
    return "it ends the process (sys.exit)" if isinstance(error, SystemExit) else f"{type(error).__name__}: {error}"


def other_solver_from_function(
    robot: Mechanism, function: Callable[..., Any], name: str = "", kind: CallableKind = "auto"
) -> OtherSolver:
    """Return a callable as a solver.

    Args:
        robot: The robot; its number of axes distinguishes the two kinds.
        function: Axis values (n,) in mm and degrees → pose (4, 4) in metres, or pose → sequence of axis values.
        name: Display name.
        kind: "auto": decided by its return value for the middle of the limits.

    Raises:
        ChainbuildError: the function returns neither a pose nor axis values.
    """
    name = name or getattr(function, "__name__", "callable")
    middle = np.array([0.0 if axis.lower <= 0.0 <= axis.upper else axis.lower for axis in robot.axes])
    if robot.chain.loops:  # they need not close there
        middle = next(iter(closing_axes(robot, np.random.default_rng(0), 1)), middle)
    if kind in ("auto", "fk") and _returns_pose(function, middle, name, strict=kind == "fk"):
        return OtherSolver(name, fk=lambda axes: _pose(function(axes), name), note="forward kinematics")
    pose = robot.fk(middle).homogeneous
    with _failures_named(name):
        answers = function(pose.copy())
    if answers is not None and not _is_rows(answers, len(robot.axes)):
        raise ChainbuildError(
            f"{name} returns neither a pose nor a list of axis values",
            parameter="solver",
            permitted=f"axis values → (4, 4) in metres, or pose (4, 4) → rows of {len(robot.axes)} axis values",
        )
    return OtherSolver(name, ik=lambda T: _rows(function(T), len(robot.axes)), note="inverse kinematics")


def _returns_pose(function: Callable[..., Any], axes: Vector, name: str, *, strict: bool) -> bool:
    try:
        with _failures_named(name):
            shape: tuple[int, ...] = np.shape(_as_matrix(function(axes.copy())))
    except ChainbuildError:
        if strict:
            raise
        return False  # it expects poses: axis values of another shape raise
    return shape == (4, 4)


def _as_matrix(value: Any) -> Any:
    """Return a pose as an array: `pin.SE3` and the like carry theirs in an attribute."""
    for attribute in ("homogeneous", "A"):
        if hasattr(value, attribute):
            return getattr(value, attribute)
    return value


def _pose(value: Any, name: str) -> Matrix:
    if value is None:
        return np.full((4, 4), np.nan)
    T = np.asarray(_as_matrix(value), dtype=float)
    if T.shape != (4, 4):
        raise ChainbuildError(f"{name} returns an array of shape {T.shape}", permitted="a pose (4, 4) in metres")
    return T


def _is_rows(value: Any, count: int) -> bool:
    try:
        rows = np.atleast_2d([np.array(row, dtype=float) for row in value])
    except (TypeError, ValueError):
        return False
    return rows.size == 0 or (rows.ndim == 2 and rows.shape[1] == count)


def _rows(value: Iterable[Any] | None, count: int) -> list[Vector]:
    if value is None:
        return []
    # Row by row and copied: a generator may yield the same buffer each time.
    rows = np.atleast_2d([np.array(row, dtype=float) for row in value])
    if rows.size == 0:
        return []
    return [row for row in rows if row.shape == (count,) and np.isfinite(row).all()]


def _serial(robot: Mechanism) -> tuple[BranchQuery, Serial]:
    query = BranchQuery.of(IkRequest(robot, np.eye(4)))
    return query, query.serial()


def _axes_from_joints(query: BranchQuery, serial: Serial, values: Vector) -> Vector | None:
    joints = np.array([screw.joint for screw in serial.screws], dtype=np.intp)
    found = axes_for(query, joints, values, query.structure.free)
    return found[0] / query.mechanism.kinematics.si_factors if found else None


def _joint_values(robot: Mechanism, serial: Serial, axes: Vector) -> Vector:
    q = robot.q(axes)
    return np.array([q[screw.joint] for screw in serial.screws])


def _eaik(robot: Mechanism) -> OtherSolver:
    _installed("eaik", "EAIK")
    query, serial = _serial(robot)
    model = eaik_robot(serial)
    if model is None:
        raise ChainbuildError("EAIK does not support this kinematic", parameter="solver", permitted="six rotary axes")
    R_zero = serial.M[:3, :3]

    def fk(axes: Vector) -> Matrix:
        T: Matrix = np.array(model.fwdKin(_joint_values(robot, serial, axes)), dtype=float)
        T[:3, :3] = T[:3, :3] @ R_zero
        return T

    def ik(T: Matrix) -> list[Vector]:
        rows = eaik_answers(model, serial, T)
        answers = (_axes_from_joints(query, serial, row) for row, approximate in rows if not approximate)
        return [answer for answer in answers if answer is not None]

    return OtherSolver("EAIK", fk, ik, note="model built from the chain's axes")


def _opw(robot: Mechanism) -> OtherSolver:
    opw = _installed("py_opw_kinematics", "py-opw-kinematics")
    query, serial = _serial(robot)
    arm = opw_arm(serial)
    if arm is None:
        raise ChainbuildError(
            "py-opw-kinematics does not support this kinematic",
            parameter="solver",
            permitted="an ortho-parallel arm with a spherical wrist at right angles",
        )
    model = opw.Robot(opw.KinematicModel(**arm.parameters), degrees=False)
    transform = import_module("scipy.spatial.transform").RigidTransform

    def fk(axes: Vector) -> Matrix:
        theta = arm.theta(_joint_values(robot, serial, axes))
        return arm.outward(np.array(model.forward(tuple(theta)).as_matrix()))

    def ik(T: Matrix) -> list[Vector]:
        rows = model.inverse(transform.from_matrix(arm.inward(T)))
        answers = (_axes_from_joints(query, serial, arm.joints(np.array(row))) for row in rows)
        return [answer for answer in answers if answer is not None and np.isfinite(answer).all()]

    return OtherSolver(
        "py-opw-kinematics", fk, ik, note="parameters measured on the chain; flange and base from one pose"
    )


def _toolbox(robot: Mechanism) -> OtherSolver:
    toolbox = _installed("roboticstoolbox", "roboticstoolbox-python")
    _, serial = _serial(robot)
    elements = None
    placed = np.eye(4)
    for screw in serial.screws:
        frame = _frame_along(screw.direction, screw.point)
        step = toolbox.ET.SE3(np.linalg.inv(placed) @ frame)
        joint = toolbox.ET.Rz() if screw.kind == "revolute" else toolbox.ET.tz()
        elements = step * joint if elements is None else elements * step * joint
        placed = frame
    if elements is None:
        raise ChainbuildError("the Robotics Toolbox needs at least one axis", parameter="solver")
    model = elements * toolbox.ET.SE3(np.linalg.inv(placed) @ serial.M)

    def fk(axes: Vector) -> Matrix:
        return np.array(model.fkine(_joint_values(robot, serial, axes)).A, dtype=float)

    return OtherSolver("roboticstoolbox", fk, note="elementary transforms built from the chain's axes")


def _frame_along(direction: Vector, point: Vector) -> Matrix:
    """Return a frame at a point whose z is the direction."""
    helper = np.eye(3)[int(np.argmin(np.abs(direction)))]
    x = np.cross(helper, direction)
    x /= np.linalg.norm(x)
    T = np.eye(4)
    T[:3, 0], T[:3, 1], T[:3, 2], T[:3, 3] = x, np.cross(direction, x), direction, point
    return T


def _installed(module: str, name: str) -> Any:
    try:
        return import_module(module)
    except ImportError:
        raise ChainbuildError(f"{name} is not installed", parameter="solver", hint=f"pip install {name}") from None


_BY_NAME: Final[dict[str, Callable[[Mechanism], OtherSolver]]] = {
    "eaik": _eaik,
    "opw": _opw,
    "roboticstoolbox": _toolbox,
}
