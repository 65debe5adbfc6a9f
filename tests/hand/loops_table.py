"""Hand formulas of the table on three rods, KIN_TYP 19 (2.17): residuals of a pose, and the axes of a tilt.

HD values by printed number in mm, axes X, Y, Z1, Z2, Z3 in mm. Nothing here is solved for h, x, y: a tilt is a turn by
a rotation vector, the table's place follows from the guide's own words, the heights from the rods.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from .tables_algebra import Matrix, shift

Hd = Mapping[int, float]
Conv = Mapping[str, str]

# Name → choices, the default first; the guide has none.
TABLE_CHOICES: dict[str, tuple[str, ...]] = {
    "kin19_guide": ("radial_planes", "centre_on_axis"),
    "kin19_azimuth": ("deg_0", "deg_90", "deg_180", "deg_minus_90"),
    "kin19_numbering": ("ccw", "cw"),
    "kin19_carriages": ("below", "above"),
}
_AZIMUTH = {"deg_0": 0.0, "deg_90": 90.0, "deg_180": 180.0, "deg_minus_90": -90.0}


def _choice(conv: Conv, name: str) -> str:
    return conv[name] if name == "kin19_guide" else conv.get(name, TABLE_CHOICES[name][0])


def spokes(conv: Conv) -> Matrix:
    """Return the horizontal unit vectors (3, 3), in rows, towards the columns."""
    step = {"ccw": 120.0, "cw": -120.0}[_choice(conv, "kin19_numbering")]
    angles = np.radians(_AZIMUTH[_choice(conv, "kin19_azimuth")] + step * np.arange(3))
    return np.stack([np.cos(angles), np.sin(angles), np.zeros(3)], axis=1)


def turn(vector: Sequence[float]) -> Matrix:
    """Return the rotation (3, 3) by a rotation vector [rad]: Rodrigues."""
    angle = float(np.linalg.norm(vector))
    x, y, z = np.asarray(vector) / (angle or 1.0)
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + math.sin(angle) * K + (1.0 - math.cos(angle)) * (K @ K))


def placed(hd: Hd, R: Matrix, height: float, conv: Conv) -> Matrix:
    """Return the frame (4, 4) in the middle of the table's joints, of a torsion-free tilt, at a height."""
    M = np.eye(4)
    M[:3, :3], M[2, 3] = R, height
    if _choice(conv, "kin19_guide") == "radial_planes":
        # Joints 1 and 2 in their planes give the middle; the third then must be in its own.
        across = np.cross([0.0, 0.0, 1.0], spokes(conv))[:, :2]
        joints = hd[3] * spokes(conv) @ R.T
        offsets = np.einsum("ij,ij->i", across, joints[:, :2])
        M[:2, 3] = np.linalg.solve(across[:2], -offsets[:2])
    return M


def heights(hd: Hd, M: Matrix, conv: Conv) -> list[list[float]]:
    """Return the heights of each carriage, that of the side at home first; empty: the rod is too short."""
    side = {"below": -1.0, "above": 1.0}[_choice(conv, "kin19_carriages")]
    found = []
    for spoke in spokes(conv):
        joint = M[:3, :3] @ (hd[3] * spoke) + M[:3, 3]
        rise = hd[2] ** 2 - float(np.sum((joint - hd[4] * spoke)[:2] ** 2))
        ends = [float(joint[2]) + sign * side * math.sqrt(rise) for sign in (1.0, -1.0)] if rise >= 0.0 else []
        found.append(ends)
    return found


def tool_in_workpiece(hd: Hd, x: float, y: float, M: Matrix, length: float) -> Matrix:
    """Return the tip in the workpiece frame, which stands HD5 over the middle of the table's joints."""
    return np.asarray(np.linalg.inv(M @ shift(0.0, 0.0, hd.get(5, 0.0))) @ shift(x, y, -hd.get(1, 0.0) - length))


def table_of(hd: Hd, axes: Sequence[float], T: Matrix, length: float) -> Matrix:
    """Return the frame in the middle of the table's joints where the tip stands at T in the workpiece frame."""
    tip = shift(axes[0], axes[1], -hd.get(1, 0.0) - length)
    return np.asarray(tip @ np.linalg.inv(T) @ shift(0.0, 0.0, -hd.get(5, 0.0)))


def residuals(hd: Hd, axes: Sequence[float], M: Matrix, conv: Conv) -> Matrix:
    """Return what a table misses: three rods [mm], its guide [mm], and the torsion R12 - R21, in mm at HD3."""
    out = spokes(conv)
    joints = hd[3] * out @ M[:3, :3].T + M[:3, 3]
    feet = hd[4] * out + np.outer(axes[2:], [0.0, 0.0, 1.0])
    rods = np.linalg.norm(joints - feet, axis=1) - hd[2]
    torsion = hd[3] * (M[0, 1] - M[1, 0])
    if _choice(conv, "kin19_guide") == "radial_planes":
        return np.array([*rods, *np.einsum("ij,ij->i", np.cross([0.0, 0.0, 1.0], out), joints), torsion])
    return np.array([*rods, M[0, 3], M[1, 3], torsion])


def continued(hd: Hd, axes: Sequence[float], conv: Conv, steps: int = 25) -> Matrix:
    """Return the table at axes, followed from the level one at equal heights by six equations."""
    side = {"below": 1.0, "above": -1.0}[_choice(conv, "kin19_carriages")]
    middle = float(np.mean(axes[2:]))
    apart = np.asarray(axes[2:]) - middle
    state = np.array([0.0, 0.0, middle + side * math.sqrt(hd[2] ** 2 - (hd[4] - hd[3]) ** 2), 0.0, 0.0, 0.0])

    def missed(at: Matrix, share: float) -> Matrix:
        M = np.eye(4)
        M[:3, :3], M[:3, 3] = turn(at[3:]), at[:3]
        return residuals(hd, [0.0, 0.0, *(middle + share * apart)], M, conv)[:6]

    for share in np.linspace(0.0, 1.0, steps + 1)[1:]:
        for _ in range(3):
            wrong = missed(state, share)
            scale = np.array([1.0, 1.0, 1.0, 1e-3, 1e-3, 1e-3]) * 1e-3
            slopes = np.array([(missed(state + d, share) - missed(state - d, share)) for d in np.diag(scale)]).T
            state = state - np.linalg.solve(slopes / (2.0 * scale), wrong)
    M = np.eye(4)
    M[:3, :3], M[:3, 3] = turn(state[3:]), state[:3]
    return M


def is_regular(hd: Hd, vector: Sequence[float], conv: Conv, least: float = 0.15) -> bool:
    """Tell whether no position from level to a tilt is singular: heights by tilts, against those at level, as areas."""

    def apart(at: Matrix) -> Matrix | None:
        found = heights(hd, placed(hd, turn([at[0], at[1], 0.0]), 0.0, conv), conv)
        if not all(found):
            return None
        z = np.array([one[0] for one in found])
        return z[:2] - z[2]

    def area(at: Matrix) -> float | None:
        ends = [(apart(at + d), apart(at - d)) for d in np.eye(2) * 1e-5]
        if any(one is None for pair in ends for one in pair):
            return None
        return float(np.linalg.det([a - b for a, b in ends if a is not None and b is not None]))

    level = area(np.zeros(2))
    shares = (area(np.asarray(vector)[:2] * share) for share in np.linspace(0.2, 1.0, 5))
    return level is not None and all(one is not None and one / level > least for one in shares)


def random_hd(rng: np.random.Generator) -> dict[int, float]:
    """Draw HD values [mm] of a table whose rods reach with room to spare; columns inside the table, too."""
    table, columns = round(float(rng.uniform(80.0, 250.0)), 3), round(float(rng.uniform(80.0, 450.0)), 3)
    rod = round((abs(columns - table) + table) * float(rng.uniform(1.1, 2.0)), 3)
    return {
        1: round(float(rng.uniform(-50.0, 150.0)), 3),
        2: rod,
        3: table,
        4: columns,
        5: round(float(rng.uniform(0.0, 90.0)), 3),
    }


def random_state(
    hd: Hd, conv: Conv, rng: np.random.Generator, steepest_deg: float = 50.0
) -> tuple[list[float], Matrix]:
    """Draw axes, and the frame in the middle of the table's joints there, with no singular position on the way."""
    for _ in range(1000):
        angle, where = math.radians(rng.uniform(0.0, steepest_deg)), rng.uniform(0.0, 2.0 * math.pi)
        vector = [angle * math.cos(where), angle * math.sin(where), 0.0]
        if is_regular(hd, vector, conv):
            M = placed(hd, turn(vector), float(rng.uniform(-800.0, 800.0)), conv)
            x, y = rng.uniform(-300.0, 300.0, 2).tolist()
            return [x, y, *(ends[0] for ends in heights(hd, M, conv))], M
    raise AssertionError(f"singular everywhere: {hd}")


def channel_list(hd: Hd) -> str:
    """Return the list of a channel with this one type."""
    values = [f"trafo[0].param[{n - 1}] {value * 1e4:.0f}" for n, value in hd.items()]
    return "\n".join(["trafo[0].id 19", *values, "Ende", ""])
