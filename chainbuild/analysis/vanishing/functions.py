"""What vanishes at a singularity, as sums of cosines of joint values.

Every factor of `chainbuild.analysis.singularity.factors` is, between joints that turn, a trigonometric polynomial of
degree 1 in each joint it depends on: 3 values of each determine it. It is believed only where it equals the factor at
further positions, and the factors of a robot count as all its singularities only where their product is the
determinant of the Jacobian, up to a constant.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.analysis.singularity.factors import coplanar, factors
from chainbuild.analysis.singularity.measures import scaling_of
from chainbuild.analysis.singularity.structure import (
    CartesianForm,
    Lines,
    SingularityKind,
    lines_at_q,
    singular_structure,
)
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import AffineMap
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.shown import fields_shown

_MOST_JOINTS: Final = 3  # that one factor depends on: 27 values determine it
_SAME: Final = 1e-9  # of values of about 1, whose rounding is some 1e-15
_PROBES: Final = 6  # positions at which a form is compared with its factor: two forms agree at none by chance
_FAR: Final = 1e-2  # smallest product of factors by which a determinant is divided
_TRIES: Final = 200  # positions drawn for such products
_STRETCH: Final = 170.0  # degrees of endless axes
_ORDER: Final = ("shoulder", "elbow", "wrist", "pole")  # from the base to the tool


@dataclass(frozen=True, slots=True, eq=False)
class SingularFunction:
    """A function of the joint values that is 0 exactly at one kind of singularity: Σ a·cos(n·q + φ).

    Attributes:
        kind: "wrist", "elbow", "shoulder" or "pole".
        multiples: (m, n_q) n, whole numbers of -1, 0, 1; no row is another's negative.
        amplitudes: (m,) a.
        phases: (m,) φ [rad].
        size: Length [m] by which the function was divided: the shoulder's distance; else 1.
    """

    __repr__ = fields_shown

    kind: SingularityKind
    multiples: Matrix
    amplitudes: Vector
    phases: Vector
    size: float = 1.0

    def value(self, q: Vector) -> float:
        """Return the function at joint values (n_q,)."""
        return float(self.amplitudes @ np.cos(self.multiples @ q + self.phases))


@dataclass(frozen=True, slots=True)
class SingularFunctions:
    """The functions of a robot.

    Attributes:
        functions: One for each kind.
        complete: Whether the robot is singular only where one of them is 0.
        constant: Product of the scaled singular values over that of the functions; 0 where they are not complete.
    """

    __repr__ = fields_shown

    functions: tuple[SingularFunction, ...]
    complete: bool
    constant: float = 0.0

    def of_kind(self, kind: SingularityKind) -> SingularFunction | None:
        """Return the function of a kind, or None."""
        return next((function for function in self.functions if function.kind == kind), None)

    def determinant(self) -> SingularFunction:
        """Return the product of the scaled singular values, signed, of complete functions."""
        multiples, parts = np.zeros((1, self.functions[0].multiples.shape[1])), np.array([self.constant + 0.0j])
        for function in self.functions:
            # cos α · cos β = (cos(α + β) + cos(α − β)) / 2
            waves = function.amplitudes * np.exp(1j * function.phases) / 2.0
            multiples = np.concatenate([m + sign * function.multiples for sign in (1.0, -1.0) for m in multiples])
            parts = np.concatenate([one * side for side in (waves, waves.conj()) for one in parts])
        return SingularFunction("other", multiples, np.abs(parts), np.angle(parts))


def singular_functions(robot: Mechanism) -> SingularFunctions:
    """Return the functions of a robot, found at first use; none where its axis map is not affine."""
    return robot.prepared("singular functions", lambda: _found(robot))


def signed_factors(robot: Mechanism, lines: Lines) -> dict[SingularityKind, float]:
    """Return the signed factors at joint lines in the tool frame, by kind; pole and end of the tilt are one."""
    structure = singular_structure(robot)
    direction = np.eye(3)[robot.chain.tool_column]
    form = structure.form
    if isinstance(form, CartesianForm) and robot.task == "direction":
        if len(form.rotary) != 2:
            return {}
        first, last = (lines.directions[n] for n in form.rotary)
        return {"pole": coplanar(first, last, direction)}
    return {factor.kind: factor.signed for factor in factors(structure, lines, robot.task, direction)}


def _found(robot: Mechanism) -> SingularFunctions:
    if not isinstance(robot.chain.axis_map, AffineMap):
        return SingularFunctions((), complete=False)
    rng = np.random.default_rng(11)
    count = len(robot.chain.joints)
    base = rng.uniform(-np.pi, np.pi, count)
    kinds = signed_factors(robot, lines_at_q(robot, base))
    size = singular_structure(robot).length
    found = []
    for kind in kinds:
        function = _fitted(robot, kind, base, rng, size if kind == "shoulder" else 1.0)
        if function is None:
            return SingularFunctions((), complete=False)
        found.append(function)
    found.sort(key=lambda function: _ORDER.index(function.kind))
    constant = _over_determinant(robot, tuple(found), rng) if found else 0.0
    return SingularFunctions(tuple(found), constant > 0.0, constant)


def _fitted(
    robot: Mechanism, kind: SingularityKind, base: Vector, rng: np.random.Generator, size: float
) -> SingularFunction | None:
    """Return the form of a factor, or None where it has none of this kind."""

    def value(q: Vector) -> float:
        return signed_factors(robot, lines_at_q(robot, q)).get(kind, 0.0)

    count = len(base)
    moved = [base + step * np.eye(count)[n] for n in range(count) for step in (0.7, 2.1)]
    changes = np.array([abs(value(q) - value(base)) for q in moved]).reshape(count, -1).max(axis=1)
    joints = np.flatnonzero(changes > _SAME).tolist()
    turning = all(robot.chain.joints[n].kind == "revolute" for n in joints)
    if not joints or len(joints) > _MOST_JOINTS or not turning:
        return None
    grid = np.empty((3,) * len(joints))
    for index in itertools.product(range(3), repeat=len(joints)):
        q = base.copy()
        q[joints] = np.array(index) * 2.0 * np.pi / 3.0
        grid[index] = value(q)
    form = _wave(kind, np.fft.fftn(grid) / grid.size, joints, count, size)
    probes = rng.uniform(-np.pi, np.pi, (_PROBES, count))
    return form if all(abs(form.value(q) - value(q)) < _SAME for q in probes) else None


def _wave(
    kind: SingularityKind, spectrum: np.ndarray[tuple[int, ...], np.dtype[np.complex128]], joints: list[int],
    count: int, size: float,
) -> SingularFunction:  # fmt: skip
    """Return the sum of cosines of a spectrum whose indices 0, 1, 2 are the multiples 0, 1, -1."""
    rows, amplitudes, phases = [], [], []
    for index in itertools.product(range(3), repeat=len(joints)):
        multiples = np.array([(0, 1, -1)[n] for n in index])
        leading = next((n for n in multiples.tolist() if n), 0)
        part = complex(spectrum[index])
        if leading < 0 or abs(part) < _SAME:
            continue  # the conjugate of one that is kept, or nothing
        row = np.zeros(count)
        row[joints] = multiples
        rows.append(row)
        amplitudes.append(abs(part) * (2.0 if leading else 1.0))
        phases.append(float(np.angle(part)))
    return SingularFunction(kind, np.array(rows), np.array(amplitudes), np.array(phases), size)


def _over_determinant(robot: Mechanism, found: tuple[SingularFunction, ...], rng: np.random.Generator) -> float:
    """Return the determinant of the scaled Jacobian over the product of the functions; 0 if that is not constant.

    With fewer axes than rows it is the root of the determinant of JᵀJ: the product of the singular values, too.
    """
    scaling = scaling_of(robot)
    if len(scaling.rows) < len(scaling.columns):
        return 0.0
    lower = np.array([max(axis.lower, -_STRETCH) for axis in robot.axes])
    upper = np.array([min(axis.upper, _STRETCH) for axis in robot.axes])
    ratios: list[float] = []
    for _ in range(_TRIES):
        axes = lower + (upper - lower) * rng.uniform(0.0, 1.0, len(lower))
        product = float(np.prod([function.value(robot.q(axes)) for function in found]))
        if abs(product) > _FAR:
            volume = float(np.linalg.svd(scaling.apply(robot.jacobian(axes)), compute_uv=False).prod())
            ratios.append(volume / abs(product))
        if len(ratios) == _PROBES:
            break
    mean = float(np.mean(ratios)) if ratios else 0.0
    steady = len(ratios) == _PROBES and mean != 0.0 and all(abs(ratio / mean - 1.0) < _SAME * 1e3 for ratio in ratios)
    return mean if steady else 0.0
