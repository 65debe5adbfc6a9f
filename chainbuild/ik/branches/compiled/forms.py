"""A machine as a compiled form takes it (extra `fast`), prepared once for each set of held axes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, Final

import numpy as np

from chainbuild import tolerances
from chainbuild.arrays import Indices, Integers, Matrices, Matrix, Vector
from chainbuild.chain.axismap import AffineMap
from chainbuild.frames import transform
from chainbuild.ik.branches.arms.parallel_axes import three_parallel_constants
from chainbuild.ik.branches.arms.virtual_joints import common_rotary_axis, with_spin_joint
from chainbuild.ik.branches.compiled.constants import (
    ALONG,
    COLUMNS,
    ROWS,
    direct_constants,
    spherical_constants,
)
from chainbuild.ik.branches.compiled.general.constants import brief_constants, general_constants
from chainbuild.ik.branches.core.axis_values import block_of
from chainbuild.ik.branches.core.branches import isolated
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.core.serial import Screw, Serial
from chainbuild.ik.branches.core.subproblems import rotation
from chainbuild.ik.branches.direct import query_is_direct
from chainbuild.ik.branches.status_turn import status_constants
from chainbuild.ik.plan import TASK_ROWS, plan_for
from chainbuild.ik.request import Held, IkRequest, start_point
from chainbuild.ik.search.compiled import packing
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.product import product_of

_MAX_PREPARED: Final = 64  # every value of a held axis makes another chain
# Distances of poses beside a doubtful one [arm lengths, rad]: where one loses digits, another does not.
_DISTANCES: Final = (1e-3, 1e-2, 1e-4, 1e-3, 3e-3, 1e-1, 1e-3, 3e-2, 3e-3, 1e-3)
_SHARE: Final = 0.2  # of the sum of a machine's lengths: what moves the tool about as far as a turn of 1 rad
_NOWHERE: Final = np.empty(0)


@dataclass(frozen=True, slots=True, eq=False)
class QuickForm:
    """A machine as a compiled form takes it.

    Attributes:
        method: Name of the `SolverPlan` that the form stands for.
        form: Name of the form, see `entries.FORMS`.
        constants: Constants of the form.
        brief: The same for poses of which to be sure is worth less.
        axes: The axes in one array, and their sizes; see `axes.axes_of`.
        x0: (n_axes,) where branches are counted from without a start [SI].
        status: What names status and turn where the controller numbers the branches (KIN_TYP 45), or None.
        by_axes: (6, n_axes) joint values in the order of the screws by SI axis values,
        at_zero: (6,) and where these are 0.
        keep: (6,) joint values of x0.
        isolated: Free directions of branches that have none.
        free_names: Free axis as `finish.finished` tells it → its name, or no name.
        beside: (2·k, 4, 4) what leads from a pose to poses beside it, in pairs on either side: turn, and shift [m].
    """

    method: str
    form: str
    constants: Vector
    brief: Vector
    axes: tuple[Vector, Integers]
    x0: Vector
    status: Vector | None
    by_axes: Matrix
    at_zero: Vector
    keep: Vector
    isolated: tuple[Matrix, ...]
    free_names: Mapping[float, tuple[str, ...]]
    beside: Matrices

    def write(
        self, targets: Matrix, x0: Vector, found: Matrix, left: Matrix, along: Matrix, counts: Integers
    ) -> tuple[int, bool, Matrices]:
        """Write the branches of poses (N, 4, 4), as `entries.finish_poses` does.

        Returns:
            What `entries.finish_poses` returns, and the joint values (N, ROWS, COLUMNS) that the form wrote.
        """
        entries, values = compiled_entries(), np.empty((len(targets), ROWS, COLUMNS))
        self.write_values(targets, x0, values, counts)
        last: tuple[int, bool] = entries.finish_poses(*self.axes, targets, x0, values, counts, found, left, along)
        return (*last, values)

    def write_values(
        self, targets: Matrix, x0: Vector, values: Matrix, counts: Integers, *, briefly: bool = False
    ) -> None:
        """Write what the form says of poses (N, 4, 4), see `entries`; briefly: with less effort to be sure."""
        keep = self.keep if x0 is self.x0 else self.by_axes @ x0 + self.at_zero
        form = compiled_entries().FORMS[self.form]
        constants = self.brief if briefly else self.constants
        form(constants, targets, tolerances.ROTATION_MATRIX, keep, values, counts)


@cache
def compiled_entries() -> Any:
    """Return the module of compiled entry points; numba is imported here, at first use."""
    from chainbuild.ik.branches.compiled import entries

    return entries


def quick_form(mechanism: Mechanism, start: Vector | None, held: Held | None) -> tuple[QuickForm | None, Vector]:
    """Return the compiled form of a mechanism with some axes held, prepared at first use, and its start [SI]."""
    if held is None and not mechanism.kinematics.has_input_axes:
        form = mechanism.prepared("quick form", lambda: _quick_form(mechanism, None, None))
        if form is None or start is None:
            return form, _NOWHERE if form is None else form.x0
        return form, start * mechanism.kinematics.si_factors
    x0, fixed = start_point(mechanism, start, held)
    key = fixed.tobytes() + x0[fixed].tobytes()
    form = mechanism.prepared("quick form", lambda: _quick_form(mechanism, start, held), key, _MAX_PREPARED)
    return form, x0


def _quick_form(mechanism: Mechanism, start: Vector | None, held: Held | None) -> QuickForm | None:
    chain, limits = mechanism.chain, mechanism.limits
    product = product_of(chain)
    if not packing.available() or product is None or chain.loops or limits.curved:
        return None
    query = BranchQuery.of(IkRequest(mechanism, np.eye(4), start, held))
    if len(query.structure.free) > TASK_ROWS[mechanism.task]:
        return None  # every branch is on a curve, whose direction the plain path tells
    method, form, constants = _chosen(query)
    joints = np.array([screw.joint for screw in _screws(query, form)], dtype=np.intp)
    packed = None if constants is None else _packed(query, form, joints)
    if constants is None or packed is None or not isinstance(chain.axis_map, AffineMap):
        return None
    by_axes, at_zero = np.zeros((6, len(query.x0))), np.zeros(6)
    by_axes[: len(joints)], at_zero[: len(joints)] = chain.axis_map.A[joints], chain.axis_map.b[joints]
    keep = by_axes @ query.x0 + at_zero
    alone = (isolated(mechanism.labels),) * ROWS
    beside = _moves_beside(_SHARE * float(np.linalg.norm(product.fixed[:, :3, 3], axis=1).sum()))
    brief = brief_constants(constants) if form == "general" else constants
    status = status_constants(mechanism)
    named: dict[float, tuple[str, ...]] = {-1.0: (), float(ALONG): ()}
    named |= {float(n): (name,) for n, name in enumerate(mechanism.labels.names)}
    return QuickForm(
        method, form, constants, brief, packed, query.x0, status, by_axes, at_zero, keep, alone, named, beside
    )  # fmt: skip


def _moves_beside(length: float) -> Matrices:
    """Return what leads to poses beside another, in generic directions and both ways; see `QuickForm.beside`.

    Where two branches meet, the poses on one side have both, those on the other none.
    """
    rng = np.random.default_rng(20240229)
    moves = []
    for distance in _DISTANCES:
        axis, shift = rng.normal(size=3), rng.normal(size=3)
        for way in (distance, -distance):
            R = rotation(axis / float(np.linalg.norm(axis)), way)
            moves.append(transform(R, way * length / float(np.linalg.norm(shift)) * shift))
    return np.array(moves)


def _chosen(query: BranchQuery) -> tuple[str, str, Vector | None]:
    """Return the plan of a query, the compiled form that stands for it, and its constants."""
    if query_is_direct(query):
        return "direct", "direct", direct_constants(query)
    plan, serial = plan_for(query), _six_joints(query)
    if plan.name == "spherical wrist" and serial is not None:
        constants = spherical_constants(serial)
        if constants is not None:
            return plan.name, "spherical", constants
    if plan.name == "three parallel axes" and serial is not None:
        return plan.name, "three parallel axes", three_parallel_constants(serial)
    if plan.name in {"spherical wrist", "elimination"} and serial is not None:
        return plan.name, "general", general_constants(serial)
    return plan.name, "", None


def _six_joints(query: BranchQuery) -> Serial | None:
    """Return the six joints that a form solves for, a turn about the tool vector among them, or None."""
    serial, task = query.serial(), query.mechanism.task
    if task == "pose":
        return serial
    if task != "direction" or len(serial.screws) != 5 or common_rotary_axis(serial) is not None:
        return None
    return with_spin_joint(serial, query.mechanism.chain.tool_column)


def _screws(query: BranchQuery, form: str) -> list[Screw]:
    """Return the joints whose values a form tells."""
    return [screw for screw in query.serial().screws if form != "direct" or screw.kind == "revolute"]


def _packed(query: BranchQuery, form: str, joints: Indices) -> tuple[Vector, Integers] | None:
    """Return the axes of a query in one array, and their sizes, or None where joint values do not give them alone."""
    mechanism, structure = query.mechanism, query.structure
    product, axis_map = product_of(mechanism.chain), mechanism.chain.axis_map
    if product is None or not isinstance(axis_map, AffineMap):
        return None
    linear = structure.linear if form == "direct" else structure.linear[:0]
    columns = structure.rotary[: len(structure.revolute)] if form == "direct" else structure.free
    block = block_of(mechanism, axis_map, joints, columns)
    if block is None or not block.turns_per_axis or len(joints) != len(columns):
        return None
    others = np.zeros((len(columns), len(mechanism.axes)))
    others[:, block.others] = block.inverse @ block.from_others
    sums, together = _sums(mechanism)
    parts = (
        product.fixed[:, :3], product.prismatic, product.A, product.b,
        np.column_stack([block.inverse, others, block.inverse @ block.b]),
        (query.lower, query.upper, query.periodic, query.slack, mechanism.kinematics.si_factors, together), sums,
    )  # fmt: skip
    flat = [np.asarray(part, dtype=float).ravel() for part in parts]
    axis = mechanism.chain.tool_column if mechanism.task == "direction" else -1
    ends = np.cumsum([len(part) for part in flat])
    movers = query.undetermined_axes(joints, [True] * len(joints), structure.free)
    indices: tuple[Indices | list[int], ...] = (block.rows, columns, movers, linear, structure.free)
    sizes = (*product.A.shape, len(columns), len(linear), len(structure.free), axis, len(sums), *ends)
    return np.concatenate(flat), np.concatenate([sizes, *indices]).astype(np.int64)


def _sums(mechanism: Mechanism) -> tuple[Matrix, Vector]:
    """Return the limits on sums of SI axis values, rows with the lower and the upper one, and which axes take part."""
    limits, factors = mechanism.limits, mechanism.kinematics.si_factors
    rows: Matrix = np.array([one.sum.coefficients for one in limits.sums]).reshape(-1, len(factors)) / factors
    ends = np.array([(one.lower - one.sum.offset, one.upper - one.sum.offset) for one in limits.sums]).reshape(-1, 2)
    return np.column_stack([rows, ends]), np.array([float(n in limits.together) for n in range(len(factors))])
