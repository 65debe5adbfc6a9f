"""The tip on a straight line, the tool turning about one axis: what of the arm follows from the pose alone.

On a line with the branch kept no function of the joints changes its sign: axis 5 stays on its side, and looking for a
change of sign finds nothing. What is looked at are distances and angles that follow from the pose, W the wrist point:

    shoulder   distance ρ of W from axis 1
    elbow      distance D of W from axis 2, across it
    wrist      angle between axes 4 and 6
    pole       angle between the first rotary axis and the tool or the last rotary axis

h is the offset of W along axis 2, r = √(ρ² - h²) the shoulder's function. The forms are compared with the factors of
the joints before they are believed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.analysis.singularity.structure import (
    ArmForm,
    CartesianForm,
    Lines,
    lines_at,
    nearest_point_to_lines,
    singular_structure,
)
from chainbuild.analysis.vanishing.functions import signed_factors
from chainbuild.analysis.vanishing.tracing import Blocks
from chainbuild.arrays import Matrices, Matrix, Vector
from chainbuild.kinematics.mechanism import Mechanism

_PROBES: Final = 6  # positions at which the forms are compared with the factors
_SAME: Final = 1e-8  # of factors of about 1: the root of rounding, which a sine next to 0 shows
_SIZABLE: Final = 0.2  # factors compared: above the root of rounding
_STRETCH: Final = 170.0  # degrees of endless axes
_QUATERNION: Final = 1e-15  # sine of half an angle below which there is no turn


@dataclass(frozen=True, slots=True, eq=False)
class LineBlocks:
    """Blocks on which the tip moves along a line.

    Attributes:
        origins: (N, 3) position at the begin [m].
        ways: (N, 3) shift over the block [m].
        rotations: (N, 3, 3) orientation at the begin.
        turns: (N, 3) rotation vector over the block, in the tool frame [rad].
    """

    origins: Matrix
    ways: Matrix
    rotations: Matrices
    turns: Matrix

    @classmethod
    def between(cls, poses: Matrices) -> LineBlocks:
        """Return the blocks between poses (N + 1, 4, 4)."""
        R = poses[:, :3, :3]
        turns = rotation_vectors(np.swapaxes(R[:-1], 1, 2) @ R[1:])
        return cls(poses[:-1, :3, 3], np.diff(poses[:, :3, 3], axis=0), R[:-1], turns)

    def poses(self, blocks: Blocks, t: Vector) -> tuple[Matrix, Matrices]:
        """Return positions (n, 3) and orientations (n, 3, 3) at shares of blocks."""
        positions = self.origins[blocks] + t[:, None] * self.ways[blocks]
        return positions, self.rotations[blocks] @ rotations_of(t[:, None] * self.turns[blocks])

    def pose(self, block: int, t: float) -> Matrix:
        """Return the pose (4, 4) at a share of a block."""
        positions, rotations = self.poses(np.array([block]), np.array([t]))
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = rotations[0], positions[0]
        return T


def rotation_vectors(R: Matrices) -> Matrix:
    """Return the rotation vectors (N, 3) [rad] of matrices (N, 3, 3), at most half a turn long."""
    # The quaternion by its largest part, from the symmetric matrix whose eigenvector it is.
    d = np.einsum("nii->ni", R)
    parts = np.stack([1.0 + d.sum(axis=1), *(1.0 + 2.0 * d.T - d.sum(axis=1))], axis=1) / 4.0
    x, y, z = R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]
    xy, xz, yz = R[:, 0, 1] + R[:, 1, 0], R[:, 0, 2] + R[:, 2, 0], R[:, 1, 2] + R[:, 2, 1]
    K = np.stack(
        [
            np.stack([4.0 * parts[:, 0], x, y, z], axis=1),
            np.stack([x, 4.0 * parts[:, 1], xy, xz], axis=1),
            np.stack([y, xy, 4.0 * parts[:, 2], yz], axis=1),
            np.stack([z, xz, yz, 4.0 * parts[:, 3]], axis=1),
        ],
        axis=1,
    )
    q = K[np.arange(len(R)), parts.argmax(axis=1)]
    q = q / np.linalg.norm(q, axis=1, keepdims=True)
    q = np.where(q[:, :1] < 0.0, -q, q)
    sine = np.linalg.norm(q[:, 1:], axis=1)
    angle = 2.0 * np.arctan2(sine, q[:, 0])
    factor = np.divide(angle, sine, out=np.full(len(R), 2.0), where=sine > _QUATERNION)
    return np.asarray(q[:, 1:] * factor[:, None], dtype=float)


def rotations_of(vectors: Matrix) -> Matrices:
    """Return the matrices (n, 3, 3) of rotation vectors (n, 3) [rad]."""
    angle = np.linalg.norm(vectors, axis=1)
    unit = np.divide(vectors, angle[:, None], out=np.zeros_like(vectors), where=angle[:, None] > 0.0)
    K = np.zeros((len(vectors), 3, 3))
    for n, (i, j) in enumerate(((2, 1), (0, 2), (1, 0))):
        K[:, i, j], K[:, j, i] = unit[:, n], -unit[:, n]
    s, c = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    R: Matrices = np.eye(3) + s * K + (1.0 - c) * (K @ K)
    return R


@dataclass(frozen=True, slots=True, eq=False)
class Bend:
    """Two directions whose angle tells how a middle axis across both has turned.

    Attributes:
        first: (3,) in the frame it is fixed in: forearm, or workpiece.
        last: (3,) in the tool frame.
        cosines: Product of the cosines of the angles of first and last with the middle axis.
        sines: Product of their sines.
        ends: Least and largest angle [rad] between first and last: there all three lie in a plane.
    """

    first: Vector
    last: Vector
    cosines: float
    sines: float
    ends: tuple[float, float]

    @classmethod
    def of(cls, lines: tuple[Vector, Vector, Vector], first: Vector, last: Vector) -> Bend:
        """Return the bend of three directions (3,) of one frame, the outer ones given in their own, too."""
        a, b, c = lines
        sines = float(np.linalg.norm(np.cross(a, b)) * np.linalg.norm(np.cross(b, c)))
        # By the angles, not by their cosines, which know nothing of an angle of 1e-8 rad.
        before, behind = (float(angles_between(one[None], b[None])[0]) for one in (a, c))
        ends = abs(before - behind), float(np.pi - abs(np.pi - before - behind))
        return cls(first, last, float(a @ b) * float(b @ c), sines, ends)

    def thresholds(self, near: float) -> tuple[float, float]:
        """Return the angles [rad] below and above which the sine of the middle turn is at most `near`."""
        cosine = self.sines * float(np.sqrt(1.0 - near * near))
        low, high = np.clip([self.cosines + cosine, self.cosines - cosine], -1.0, 1.0)
        return float(np.arccos(low)), float(np.arccos(high))

    def sine(self, angle: Vector) -> Vector:
        """Return the absolute sine of the middle turn at angles (n,) between the directions."""
        # 1 - c² as a product, each factor a product of sines again: no digits are lost next to 0.
        first, last = self.ends
        below = 2.0 * np.sin((angle + first) / 2.0) * np.sin((angle - first) / 2.0)
        above = 2.0 * np.sin((last + angle) / 2.0) * np.sin((last - angle) / 2.0)
        return np.asarray(np.sqrt(np.maximum(below * above, 0.0)) / self.sines)


def angles_between(a: Matrix, b: Matrix) -> Vector:
    """Return the angles (n,) [rad] between unit directions (n, 3), exact next to 0 and to half a turn."""
    return np.asarray(2.0 * np.arctan2(np.linalg.norm(a - b, axis=1), np.linalg.norm(a + b, axis=1)))


@dataclass(frozen=True, slots=True, eq=False)
class ArmGeometry:
    """Shoulder, elbow and forearm of an arm over a fixed base, all in the workpiece frame.

    Attributes:
        axis: (3,) direction of axis 1.
        point: (3,) a point of it [m].
        wrist_point: (3,) W in the tool frame [m].
        offset: h, of W along axis 2 [m].
        shoulder: (2,) axis 2 in the plane of r and height over `point` [m].
        upper: Length of the upper arm across axis 2 [m].
        fore: Length of the forearm across axis 2, to W [m].
        wrist: The bend of the wrist; its first direction by the forearm, across it in the plane, and axis 2. None: no
            wrist whose lines meet.
        size: Length [m] that scales the shoulder's factor.
    """

    axis: Vector
    point: Vector
    wrist_point: Vector
    offset: float
    shoulder: Vector
    upper: float
    fore: float
    wrist: Bend | None
    size: float


@dataclass(frozen=True, slots=True, eq=False)
class LineGeometry:
    """What of a robot follows from the pose, for given held axes.

    Attributes:
        arm: Of an arm.
        bend: Of a machine with linear axes whose first rotary axis is fixed in the workpiece frame.
    """

    arm: ArmGeometry | None = None
    bend: Bend | None = None


def line_geometry(robot: Mechanism, held: Vector) -> LineGeometry | None:
    """Return the geometry of a robot, or None where its pose alone does not tell what is singular.

    Args:
        robot: The robot.
        held: Values of its held axes, in order, mm and degrees.
    """
    key = tuple(held.tolist())
    return robot.prepared("line geometry", lambda: _geometry(robot, held), key, 4)


def _geometry(robot: Mechanism, held: Vector) -> LineGeometry | None:
    form = singular_structure(robot).form
    rng = np.random.default_rng(5)
    probes = [_probe(robot, held, rng) for _ in range(_PROBES)]
    made = None
    if isinstance(form, ArmForm) and form.turn is not None and len(form.head) == 3 and form.tip == form.head:
        made = LineGeometry(arm=_arm(robot, form, probes[0]))
    elif isinstance(form, CartesianForm) and len(form.rotary) == (2 if robot.task == "direction" else 3):
        made = LineGeometry(bend=_bend(robot, form, probes[0]))
    return made if made is not None and all(_agrees(robot, made, axes) for axes in probes) else None


def _probe(robot: Mechanism, held: Vector, rng: np.random.Generator) -> Vector:
    lower = np.array([max(axis.lower, -_STRETCH) for axis in robot.axes])
    upper = np.array([max(min(axis.upper, _STRETCH), low) for axis, low in zip(robot.axes, lower, strict=True)])
    axes: Vector = lower + (upper - lower) * rng.uniform(0.05, 0.95, len(lower))
    axes[[axis.held for axis in robot.axes]] = held
    return axes


def _in_workpiece(robot: Mechanism, axes: Vector) -> tuple[Lines, Lines, Matrix]:
    """Return the joint lines in the tool frame, in the workpiece frame, and the pose (4, 4)."""
    T, lines = robot.fk(axes).homogeneous, lines_at(robot, axes)
    R, p = T[:3, :3], T[:3, 3]
    return lines, Lines(lines.directions @ R.T, lines.points @ R.T + p), T


def _arm(robot: Mechanism, form: ArmForm, axes: Vector) -> ArmGeometry:
    assert form.turn is not None
    at_tool, lines, T = _in_workpiece(robot, axes)
    a1, a2 = lines.directions[form.turn], lines.directions[form.upper]
    u = np.cross(a2, a1)
    plane = np.stack([u, a1])
    point = lines.points[form.turn]
    own = nearest_point_to_lines(at_tool, form.head)
    W = T[:3, :3] @ own + T[:3, 3]
    P2, P3 = lines.points[form.upper], lines.points[form.elbow]
    fore = plane @ (W - P3)
    length = float(np.linalg.norm(fore))
    wrist = None
    if form.wrist is not None and form.wrist == form.head:
        along = fore / length
        frame = np.stack([along @ plane, np.array([-along[1], along[0]]) @ plane, a2])
        directions = (lines.directions[form.wrist[0]], lines.directions[form.wrist[1]], lines.directions[form.wrist[2]])
        wrist = Bend.of(directions, frame @ directions[0], at_tool.directions[form.wrist[2]])
    upper = float(np.linalg.norm(plane @ (P3 - P2)))
    size = singular_structure(robot).length
    return ArmGeometry(a1, point, own, float(a2 @ (W - point)), plane @ (P2 - point), upper, length, wrist, size)


def _bend(robot: Mechanism, form: CartesianForm, axes: Vector) -> Bend:
    at_tool, lines, T = _in_workpiece(robot, axes)
    first, middle = lines.directions[form.rotary[0]], lines.directions[form.rotary[1]]
    last = np.eye(3)[robot.chain.tool_column] if len(form.rotary) == 2 else at_tool.directions[form.rotary[2]]
    return Bend.of((first, middle, T[:3, :3] @ last), first, last)


@dataclass(frozen=True, slots=True, eq=False)
class ArmPosition:
    """Where the arm is at poses.

    Attributes:
        distance: (n,) ρ [m].
        across: (n,) r [m], signed by the branch; 0 within h of axis 1.
        reach: (n,) D [m].
        elbow_cosine: (n,) cosine of the elbow's bend; beyond ±1 where W cannot be reached.
        fore: (n, 3) first direction of the wrist's bend in the workpiece frame.
    """

    distance: Vector
    across: Vector
    reach: Vector
    elbow_cosine: Vector
    fore: Matrix


def arm_at(arm: ArmGeometry, positions: Matrix, rotations: Matrices, branch: Matrix) -> ArmPosition:
    """Return where an arm is at poses.

    Args:
        arm: Its geometry.
        positions: (n, 3) [m].
        rotations: (n, 3, 3).
        branch: (n, 2) signs of the shoulder's and the elbow's factor.
    """
    d = positions + rotations @ arm.wrist_point - arm.point
    z = d @ arm.axis
    level = d - z[:, None] * arm.axis
    rho = np.linalg.norm(level, axis=1)
    r = branch[:, 0] * np.sqrt(np.maximum(rho**2 - arm.offset**2, 0.0))
    x, y = r - arm.shoulder[0], z - arm.shoulder[1]
    reach = np.hypot(x, y)
    cosine = (reach**2 - arm.upper**2 - arm.fore**2) / (2.0 * arm.upper * arm.fore)
    inside = np.clip(cosine, -1.0, 1.0)
    # The plane's height turns against axis 2: a positive factor of the elbow is a negative angle in it.
    sine = -branch[:, 1] * np.sqrt(1.0 - inside**2)
    angle = np.arctan2(y, x) - np.arctan2(arm.fore * sine, arm.upper + arm.fore * inside) + np.arctan2(sine, inside)
    square = (r**2 + arm.offset**2)[:, None]
    u = np.divide(r[:, None] * level - arm.offset * np.cross(arm.axis, level), square, where=square > 0.0,
                  out=np.zeros_like(level))  # fmt: skip
    if arm.wrist is None:
        return ArmPosition(rho, r, reach, cosine, u)
    a, b, c = arm.wrist.first
    cos, sin = np.cos(angle)[:, None], np.sin(angle)[:, None]
    fore = (a * cos - b * sin) * u + (a * sin + b * cos) * arm.axis + c * np.cross(arm.axis, u)
    return ArmPosition(rho, r, reach, cosine, fore)


def _agrees(robot: Mechanism, made: LineGeometry, axes: Vector) -> bool:
    """Return whether the geometry tells the factors of a position."""
    lines, _, T = _in_workpiece(robot, axes)
    known = signed_factors(robot, lines)
    R = T[None, :3, :3]
    told: dict[str, float] = {}
    if made.bend is not None:
        angle = angles_between(made.bend.first[None], R @ made.bend.last)
        kind = "pole" if robot.task == "direction" else "wrist"
        told[kind] = float(made.bend.sine(angle)[0])
    if made.arm is not None:
        if not {"shoulder", "elbow"} <= known.keys():
            return False
        branch = np.sign([[known["shoulder"], known["elbow"]]])
        at = arm_at(made.arm, T[None, :3, 3], R, branch)
        told = {"shoulder": abs(float(at.across[0])) / made.arm.size}
        told["elbow"] = float(np.sqrt(max(1.0 - at.elbow_cosine[0] ** 2, 0.0)))
        if made.arm.wrist is not None:
            told["wrist"] = float(made.arm.wrist.sine(angles_between(at.fore, R @ made.arm.wrist.last))[0])
    return known.keys() == told.keys() and all(_close(abs(known[kind]), told[kind]) for kind in known)


def _close(known: float, told: float) -> bool:
    return abs(known - told) < (_SAME if known > _SIZABLE else np.sqrt(_SAME))
