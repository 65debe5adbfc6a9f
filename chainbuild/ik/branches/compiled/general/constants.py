"""What the compiled elimination needs of an arm: where the loop is opened, and all numbers that no pose changes.

The loop of six joints E1·…·E6 = G is opened where the pose stands next to the two joints that are eliminated: then the
left side of the fourteen equations (see `elimination.loop`) is constant. Three openings allow that, read forwards or
backwards. The hidden joint is the outermost of the other three, because there the equations lose rank in a known way
where exp(i·h) is 0 or infinite: of the 24 eigenvalues of `elimination.eliminant` eight are ±i, and are left out.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Complex, Matrix, Vector
from chainbuild.frames import inverse, transform
from chainbuild.ik.branches.core.serial import Screw, Serial
from chainbuild.ik.branches.core.subproblems import cross
from chainbuild.ik.branches.elimination.conformal import ONE, SIZE, arrow, coefficients, motion

JOINTS: Final = 6  # what a pose determines
ARROW_ROWS: Final = 14  # equations: the numbers of an arrow without the one that is always 1
EQUATIONS: Final = 6  # without the eight products of the two joints that are eliminated
COMBINATIONS: Final = 9  # products of the cosine, the sine and 1 of two joints

# Where the parts of the packed constants begin.
CENTRE: Final = 1
SCALE: Final = 4
BACK: Final = 5
SCREWS: Final = BACK + 12
PER_SCREW: Final = 30
OPENINGS: Final = SCREWS + JOINTS * PER_SCREW

# The same in the part of one opening.
PAIRS: Final = 0
BEFORE: Final = 1
BEHIND: Final = 2
BACKWARDS: Final = 3
ROLES: Final = 4
LEFT: Final = ROLES + JOINTS
RANGE: Final = LEFT + 3 * ARROW_ROWS * COMBINATIONS  # behind the left side, by cosine, sine and 1 of the hidden joint
STEPS_BEFORE: Final = RANGE + 8 * ARROW_ROWS  # behind four complex columns
ARROWS_BEHIND: Final = STEPS_BEFORE + COMBINATIONS * ARROW_ROWS * SIZE
PER_OPENING: Final = ARROWS_BEHIND + COMBINATIONS * SIZE

VIEWS: Final = (0.3, 1.5, 2.7, -0.9, -2.1)  # angles from which the hidden joint is looked at; any that are apart

_FEW: Final = 2  # openings: the next ones make one pose in ten sure, and each takes as long
_KEPT: Final = np.array([n for n in range(SIZE) if n != ONE])
_TRIALS: Final = 4  # poses on which the openings are tried
_LARGER: Final = 0.7  # decades of digits that the larger eigenvalue problem must win: it takes twice as long
_HOPELESS: Final = 11.0  # decades of digits lost: no pose would be solved surely
_DEPENDENT: Final = 1e-9  # singular values below this share of the largest: joints that do not move the tool everywhere
_NEAR_REAL: Final = 1e-2  # eigenvalues so near to the real ones count in the score: they might be solutions


@dataclass(frozen=True, slots=True, eq=False)
class _Opening:
    """The loop opened before one of its joints.

    Attributes:
        backwards: Whether the loop is read from the tool to the workpiece.
        roles: The joints: two that are eliminated, the hidden one, two others, the one whose axis bears the arrow.
        left: (3, 14, 9) the left side: by the hidden joint and by the products of the two others.
        range: (14, 4) complex: the space of the part of exp(i·h).
        before: (k, 15, 15) motions of eliminated joints left of the pose, by their products.
        behind: (9/k, 15) arrows right of it, by theirs.
    """

    backwards: bool
    roles: tuple[int, ...]
    left: Matrix
    range: Complex
    before: Matrix
    behind: Matrix

    def packed(self, pairs: int) -> Vector:
        """Return the opening's part of the constants, for a number of pairs of rows that are of half the degree."""
        part = np.zeros(PER_OPENING)
        part[:ROLES] = pairs, len(self.before), len(self.behind), self.backwards
        part[ROLES:LEFT] = self.roles
        part[LEFT:RANGE] = self.left.transpose(1, 0, 2).ravel()
        part[RANGE:STEPS_BEFORE] = np.concatenate([self.range.real, self.range.imag], axis=1).ravel()
        steps = self.before[:, _KEPT].transpose(2, 1, 0)
        part[STEPS_BEFORE : STEPS_BEFORE + steps.size] = steps.ravel()
        part[ARROWS_BEHIND : ARROWS_BEHIND + self.behind.size] = self.behind.ravel()
        return part

    def rows(self, G: Matrix) -> tuple[Matrix, float]:
        """Return the six equations (6, 3, 9) at a pose, and how well the eliminated joints are told apart."""
        pose = motion(inverse(G) if self.backwards else G)
        right = np.einsum("lij,rj->irl", self.before[:, _KEPT], self.behind @ pose.T).reshape(ARROW_ROWS, COMBINATIONS)
        u, sizes, _ = np.linalg.svd(right[:, :-1])
        left = self.left.copy()
        left[2, :, -1] -= right[:, -1]
        return np.einsum("ni,aib->nab", u[:, COMBINATIONS - 1 :].T, left), float(sizes[-1] / sizes[0])


def brief_constants(constants: Vector) -> Vector:
    """Return what `general_constants` returns, with fewer openings."""
    few = constants.copy()
    few[0] = min(few[0], _FEW)
    return few


def general_constants(serial: Serial) -> Vector | None:
    """Return the packed constants of an arm, or None unless it has six rotary joints that its equations tell apart."""
    screws = serial.screws
    if len(screws) != JOINTS or any(screw.kind != "revolute" for screw in screws):
        return None
    points = np.array([screw.point for screw in screws])
    centre = points.mean(axis=0)
    size = float(max(np.linalg.norm(point - centre) for point in [*points, serial.M[:3, 3]]))
    if not size > 0.0:
        return None
    seen = [Screw(s.kind, s.direction, (s.point - centre) / size, s.joint) for s in screws]
    chosen = _chosen(seen)
    if not chosen:
        return None
    back = inverse(serial.M) @ transform(None, centre)
    head = np.concatenate([[len(chosen)], centre, [size], back[:3].ravel(), *(_screw_numbers(s) for s in seen)])
    return np.concatenate([head, *chosen])


def _screw_numbers(screw: Screw) -> Vector:
    """Return what a joint's motion is the sum of: of its sine (3, 4), of 1 − cosine (3, 4); direction and moment."""
    K = np.cross(screw.direction, np.eye(3)).T  # K·v is direction × v
    parts = [np.column_stack([part, -part @ screw.point]).ravel() for part in (K, K @ K)]
    return np.concatenate([*parts, screw.direction, cross(screw.point, screw.direction)])


def _chosen(screws: Sequence[Screw]) -> list[Vector]:
    """Return the packed openings that may tell something, that which loses the fewest digits leading."""
    poses = _trial_poses(screws)
    ranked: list[tuple[float, int, Vector]] = []
    for opening in _openings(screws) if poses else ():
        trials = [opening.rows(G) for G in poses]
        if min(apart for _, apart in trials) < _DEPENDENT:
            continue
        for pairs in (2, 1):
            lost = float(np.median([_digits_lost(rows, pairs) for rows, _ in trials]))
            ranked.append((lost + _LARGER * (2 - pairs), len(ranked) // 2, opening.packed(pairs)))
    ranked.sort(key=lambda item: item[:2])
    chosen: dict[int, Vector] = {}
    for lost, place, packed in ranked:
        if lost < _HOPELESS:
            chosen.setdefault(place, packed)
    return list(chosen.values())


def _trial_poses(screws: Sequence[Screw]) -> list[Matrix]:
    """Return poses at which the joints move the tool in all six freedoms; none if there are none."""
    rng = np.random.default_rng(20240229)
    poses = []
    for _ in range(_TRIALS):
        T, columns = np.eye(4), []
        for screw, value in zip(screws, rng.uniform(-2.5, 2.5, JOINTS), strict=True):
            moved = screw.transformed(T)
            columns.append(np.concatenate([cross(moved.point, moved.direction), moved.direction]))
            T = T @ screw.T(float(value))
        sizes = np.linalg.svd(np.array(columns), compute_uv=False)
        if sizes[-1] < _DEPENDENT * sizes[0]:
            return []
        poses.append(T)
    return poses


def _openings(screws: Sequence[Screw]) -> Iterator[_Opening]:
    """Yield the openings with the pose beside or between the joints that are eliminated."""
    for backwards in (False, True):
        row = [screw.reversed() for screw in reversed(screws)] if backwards else list(screws)
        steps = [_by_angle(screw) for screw in row]
        back = [step * np.array([1.0, -1.0, 1.0])[:, None, None] for step in steps]
        for first in (0, 4, 5):
            one, two, hidden, x, y, last = ((first + n) % JOINTS for n in range(JOINTS))
            end = arrow(row[last].point, row[last].direction)
            left = np.einsum("xjk,yk->jxy", steps[x], steps[y] @ end)
            left = np.einsum("hij,jxy->hixy", steps[hidden][:, _KEPT], left)
            u, _, _ = np.linalg.svd((steps[hidden][0] - 1j * steps[hidden][1])[_KEPT])
            before, behind = np.eye(SIZE)[None], end[None]
            if first == 0:
                before = np.einsum("bij,ajk->abik", back[two], back[one]).reshape(-1, SIZE, SIZE)
            elif first == 4:
                behind = np.einsum("bij,aj->abi", back[two], back[one] @ end).reshape(-1, SIZE)
            else:
                before, behind = back[two], back[one] @ end
            roles = tuple(JOINTS - 1 - n if backwards else n for n in (one, two, hidden, x, y, last))
            yield _Opening(backwards, roles, left.reshape(3, ARROW_ROWS, COMBINATIONS), u[:, :4], before, behind)


def _by_angle(screw: Screw) -> Matrix:
    """Return the coefficients (3, 15, 15) of a rotary joint's motion: of its cosine, its sine and 1."""
    minus, one, plus = coefficients(screw)
    return np.stack([(plus + minus).real, (1j * (plus - minus)).real, one.real])


def _digits_lost(rows: Matrix, pairs: int) -> float:
    """Return how many decades the eigenvalues that may be solutions lose, seen from where they lose the fewest."""
    seen = [_companion(_of_low_degree(rows, pairs), angle) for angle in VIEWS]
    sizes = [float(np.abs(one).max()) for one in seen]
    best = int(np.argmin(sizes))
    if not math.isfinite(sizes[best]):
        return math.inf
    w = np.linalg.eigvals(seen[best])
    length = 1.0 + np.abs(w) ** 2
    apart = np.abs(w[:, None] - w) / np.sqrt(length[:, None] * length)
    np.fill_diagonal(apart, 1.0)
    near = np.abs(w.imag) < _NEAR_REAL * length
    separation = np.minimum(1.0, 4.0 * apart).prod(axis=1)[near].min(initial=1.0)
    return math.log10(sizes[best] / max(float(separation), 1e-300))


def _of_low_degree(rows: Matrix, pairs: int) -> tuple[Matrix, Matrix, Matrix]:
    """Return equations of half the degree, of cos(h/2) and of sin(h/2) (2·pairs, 9), and the others (3, …, 9).

    A row n of complex numbers without a part of exp(i·h), n·rows = a + b·exp(−i·h), times exp(i·h/2) is of half the
    degree: its real and its imaginary part are two equations.
    """
    u, _, _ = np.linalg.svd(rows[:, 0] - 1j * rows[:, 1])
    null = u[:, 4:].conj().T
    if pairs == 1:
        null = _least_real(null)
    real, imaginary = null.real, null.imag
    _, _, vt = np.linalg.svd(np.concatenate([real, imaginary]))
    c, s, one = (np.tensordot(real, rows[:, n], 1) for n in range(3))
    turned = np.tensordot(imaginary, rows[:, 2], 1)
    others = np.tensordot(vt[2 * pairs :], rows, 1).transpose(1, 0, 2)
    return np.concatenate([one + c, turned + s]), np.concatenate([s - turned, one - c]), others


def _least_real(null: Complex) -> Complex:
    """Return the combination of two complex rows (2, 6), of a few, whose parts are most nearly at right angles."""
    one, other = null
    rows = np.array([one, other, (one + other) / math.sqrt(2.0), (one + 1j * other) / math.sqrt(2.0)])
    return np.asarray(rows[int(np.argmin(np.abs((rows * rows).sum(axis=1))))][None], dtype=complex)


def _companion(parts: tuple[Matrix, Matrix, Matrix], angle: float) -> Matrix:
    """Return the matrix (16, 16) or (20, 20) of the eigenvalues w = tan((h − angle)/2); infinite if it has none."""
    cos_half, sin_half, others = parts
    c, s = math.cos(angle / 2.0), math.sin(angle / 2.0)
    low, high = _times_x(c * cos_half + s * sin_half), _times_x(c * sin_half - s * cos_half)
    cosine, sine, one = (_times_x(part) for part in others)
    c, s = math.cos(angle), math.sin(angle)
    lowest, highest = one + c * cosine + s * sine, one - c * cosine - s * sine
    middle = 2.0 * (c * sine - s * cosine)
    linear, square = len(low), len(middle)
    solved: NDArray[np.float64]
    try:
        stacked = np.concatenate([low, middle, lowest])
        solved = np.linalg.solve(np.concatenate([high, highest]).T, stacked.T).T
    except np.linalg.LinAlgError:
        return np.full((linear + 2 * square, linear + 2 * square), np.inf)
    companion = np.zeros((linear + 2 * square, linear + 2 * square))
    companion[:, : linear + square] = -solved
    companion[linear : linear + square, linear + square :] = np.eye(square)
    return companion


def _times_x(rows: Matrix) -> Matrix:
    """Return equations (k, 9) times cos(x/2) and sin(x/2): (2·k, 12), by cos, sin of 3·x/2 and of x/2."""
    cosine, sine, one = rows.reshape(-1, 3, 3).transpose(1, 0, 2) / 2.0
    by_cosine = np.stack([cosine, sine, cosine + 2.0 * one, sine], axis=1)
    by_sine = np.stack([-sine, cosine, sine, 2.0 * one - cosine], axis=1)
    return np.concatenate([by_cosine, by_sine]).reshape(-1, 12)
