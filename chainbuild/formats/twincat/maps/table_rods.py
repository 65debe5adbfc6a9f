"""Three rods that carry a table (19), and where the table stands: the way from home.

The table's joints J_i lie on a circle of radius r, at e_i = (cos φ_i, sin φ_i, 0), the carriages' at R·e_i + Z_i·z. A
guide leaves the table three freedoms: the height h, and a tilt without torsion, the turn about a horizontal axis. As a
quaternion (w, x, y, 0) it has two numbers, and w = √(1 - x² - y²). Whatever the guide, with c the table's centre:

    J_i = c + h·z + r·R(x, y)·e_i,        |J_i - R·e_i - Z_i·z| = l,        i = 1, 2, 3
    c_x + i·c_y = g·(x - i·y)²            radial planes: g = r·exp(3i·φ_1); on the axis: g = 0

Planes J_i·t_i = 0, t_i across e_i, have that centre as their solution, and R12 = R21 follows from them: g is exact.

Three equations for h, x, y have up to 16 real solutions, which nothing tells apart by a sign. The one in force is that
which continues from home, the level table at equal heights: the heights move from there on a straight line, in steps
bounded by the tilt and by what Newton's method still corrects. Where the line meets a singular position the way ends,
and the axis values beyond have no pose. So a state depends on the heights alone, and changes steadily with them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from chainbuild.frames import rot_z
from chainbuild.units import rad_from_deg

Triple = tuple[float, float, float]
Rod = tuple[Triple, Triple, Triple]  # from carriage to table [m], and its derivatives by x and y; that by h is upwards
Equation = tuple[float, float, float, float]  # half the square that a rod misses its own by [m²]; its slope by h, x, y

RODS: Final = 3  # one a column

_STEP: Final = 0.06  # change of (x, y) in one step: 7 deg of tilt
_CORRECTED: Final = 0.25  # share of a step that may be left to Newton's method: with less it stays at its own solution
_SLIGHT: Final = 1e-6  # change of (x, y) that is never too much
_SHORTEST: Final = 1e-7  # step, as a share of the way, which ends there: within 1e-3 of (x, y) of a singular position
_ROUGH: Final = 1e-5  # last change by Newton's method on the way: its square is left, and the next step starts there
_FINE: Final = 1e-10  # the same at the end of the way: what is left is rounding
_NEWTONS: Final = 8  # steps: two or three do
_UPRIGHT: Final = 0.5  # x² + y² of a table that stands upright: the tool does not reach its face beyond


@dataclass(frozen=True, slots=True)
class TableRods:
    """The rods of one machine.

    Attributes:
        directions: (cos φ_i, sin φ_i) of the columns.
        table: r [m].
        columns: R [m].
        length: l [m].
        hanging: +1 where the table hangs below the carriages, -1 where it stands on them.
        offset: g [m].
    """

    directions: tuple[tuple[float, float], ...]
    table: float
    columns: float
    length: float
    hanging: float
    offset: complex

    @classmethod
    def of(
        cls, angles_deg: Sequence[float], table: float, columns: float, length: float, hanging: float, radial: bool
    ) -> TableRods:
        """Build the rods of columns at azimuths 120 degrees apart; radial: planes guide the table, else its axis."""
        directions = tuple((float(x), float(y)) for x, y in (rot_z(angle)[:2, 0] for angle in angles_deg))
        angle = 3.0 * rad_from_deg(angles_deg[0])
        offset = table * complex(math.cos(angle), math.sin(angle)) if radial else 0j
        return cls(directions, table, columns, length, hanging, offset)

    @property
    def home(self) -> float:
        """Height [m] of the level table over carriages at 0."""
        return -self.hanging * math.sqrt(self.length**2 - (self.columns - self.table) ** 2)

    @property
    def may_lie_flat(self) -> bool:
        """Whether a rod may come to lie flat before the table stands upright, and its carriage pass the table."""
        # The joints of the table are -r/2 to 3r/2 out from the axis there, along their column.
        return self.length <= max(self.columns + self.table / 2.0, 1.5 * self.table - self.columns)

    def centre(self, x: float, y: float) -> complex:
        """Return the place of the table's centre [m]."""
        return self.offset * complex(x, -y) ** 2

    def rods(self, state: Triple, heights: Sequence[float]) -> list[Rod]:
        """Return the rods at (h, x, y), whatever their length there, and heights of the carriages [m]."""
        h, x, y = state
        w, big, double = math.sqrt(1.0 - x * x - y * y), self.columns, 2.0 * self.table
        centre, slope = self.centre(x, y), 2.0 * self.offset * complex(x, -y)
        cx, cy, along, aside = centre.real, centre.imag, slope.real, slope.imag  # (aside, -along) by y
        rods = []
        for (ex, ey), z in zip(self.directions, heights, strict=True):
            arm = x * ey - y * ex  # of the joint about the axis of the tilt: it rises by 2·w·r of it
            level = self.table - big
            way = (
                cx + level * ex + double * y * arm,
                cy + level * ey - double * x * arm,
                h + double * w * arm - z,
            )
            by_x = (along + double * y * ey, aside - double * (arm + x * ey), double * (w * ey - x * arm / w))
            by_y = (aside + double * (arm - y * ex), -along + double * x * ex, -double * (w * ex + y * arm / w))
            rods.append((way, by_x, by_y))
        return rods

    def equations(self, state: Triple, heights: Sequence[float]) -> list[Equation]:
        """Return what the rods miss their length by at (h, x, y), and how that changes."""
        square = self.length * self.length
        return [
            (
                (ax * ax + ay * ay + az * az - square) / 2.0,
                az,
                ax * bx + ay * by + az * bz,
                ax * cx + ay * cy + az * cz,
            )
            for (ax, ay, az), (bx, by, bz), (cx, cy, cz) in self.rods(state, heights)
        ]

    def reached(self, heights: Sequence[float]) -> tuple[Triple, float]:
        """Return (h, x, y) where the way from home to heights [m] ends, and the share of it that is gone, up to 1."""
        # A shift of all three carriages is one of the table: the way is that of their differences.
        middle = sum(heights) / RODS
        apart = [z - middle for z in heights]
        state: Triple = (self.home, 0.0, 0.0)
        gone, step = 0.0, 1.0
        while gone < 1.0:
            # The table's rates on the way: each carriage pushes by its slope upwards.
            rows = self.equations(state, [gone * z for z in apart])
            rates = solved(rows, [row[1] * z for row, z in zip(rows, apart, strict=True)])
            pace = max(math.hypot(rates[1], rates[2]), _SLIGHT)
            step = min(step, _STEP / pace)
            found: Triple | None = None
            halved = False
            while found is None:
                if step < _SHORTEST:
                    return (state[0] + middle, state[1], state[2]), gone
                step = min(step, 1.0 - gone)
                share = 1.0 if step == 1.0 - gone else gone + step
                most = _CORRECTED * pace * step + _SLIGHT
                ahead = _moved(state, rates, step)
                enough = _FINE if share == 1.0 else _ROUGH
                found = self._corrected(ahead, [share * z for z in apart], most, enough)
                halved = halved or found is None
                step = step / 2.0 if found is None else step
            state, gone = found, share
            step *= 0.5 if halved else 2.0  # close to a singular position the next one must be shorter, too
        return (state[0] + middle, state[1], state[2]), gone

    def _corrected(self, state: Triple, heights: Sequence[float], most: float, enough: float) -> Triple | None:
        """Return the solution near a state by Newton's method, or None: too far, or beyond upright.

        Args:
            state: (h, x, y) at the end of a step.
            heights: Of the carriages there [m].
            most: How far (x, y) may be from the solution.
            enough: Change below which it is found.
        """
        for n in range(_NEWTONS):
            if state[1] ** 2 + state[2] ** 2 >= _UPRIGHT:
                return None
            rows = self.equations(state, heights)
            change = solved(rows, [-row[0] for row in rows])
            size = math.hypot(change[1], change[2])
            if n == 0 and size > most:
                return None
            state = _moved(state, change, 1.0)
            if max(size, abs(change[0])) < enough:
                return state
        return None


def solved(rows: Sequence[Equation], wanted: Sequence[float]) -> Triple:
    """Return the change of (h, x, y) that changes three equations by wanted values; infinite where it is singular."""
    (_, a0, b0, c0), (_, a1, b1, c1), (_, a2, b2, c2) = rows
    k0, k1, k2 = b1 * c2 - b2 * c1, b2 * c0 - b0 * c2, b0 * c1 - b1 * c0
    det = a0 * k0 + a1 * k1 + a2 * k2
    if det == 0.0:
        return math.inf, math.inf, math.inf
    f0, f1, f2 = wanted
    h = f0 * k0 + f1 * k1 + f2 * k2
    x = f0 * (a2 * c1 - a1 * c2) + f1 * (a0 * c2 - a2 * c0) + f2 * (a1 * c0 - a0 * c1)
    y = f0 * (a1 * b2 - a2 * b1) + f1 * (a2 * b0 - a0 * b2) + f2 * (a0 * b1 - a1 * b0)
    return h / det, x / det, y / det


def _moved(state: Triple, change: Triple, share: float) -> Triple:
    return state[0] + share * change[0], state[1] + share * change[1], state[2] + share * change[2]
