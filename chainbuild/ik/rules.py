"""The names of the solvers, and the numbers of the damped search, the same for the plain and the compiled path.

Each number was measured on six- and seven-axis arms with targets drawn over the whole range of the axes.
"""

from __future__ import annotations

import math
from typing import Final, Literal, get_args

from chainbuild import tolerances

# What a caller may ask for by name.
Solver = Literal["auto", "damped", "analytic", "controller"]
SOLVERS: Final[tuple[str, ...]] = get_args(Solver)

# Outcomes.
OK: Final = 0
LIMITS: Final = 1
STALLED: Final = 2
UNREACHABLE: Final = 3
NOT_RIGID: Final = 4

# Damping as a share of the squared error: 0.01 … 0.1 works; a constant loses targets.
DAMPING: Final = 3e-2
# Keeps the factorisation alive at singular points.
DAMPING_FLOOR: Final = 1e-12
# A descent ends after so many steps,
MAX_STEPS: Final = 40
# or after so many in a row that leave more than this share of the squared error.
STALL_STEPS: Final = 4
STALL_SHARE: Final = 0.9
# A step out of what a nonlinear axis map has joint values for is halved so often.
MOST_HALVINGS: Final = 8
# One descent in so many ignores the limits: it separates unreachable poses from those that limits exclude.
FREE_EVERY: Final = 4
# An answer is improved once more if the axes could still move by more than this (rad or m): near a singularity a small
# error of the pose means a larger one of the axes. Judged by the previous step.
SHARP: Final = 1e-8
# So many starts are the nearest of the table; then every other one is any of it, in case the nearest all fail.
NEAREST_FIRST: Final = 4
# So many turned starts outside the limits are skipped at a time; then the plain table is used.
TURN_TRIES: Final = 8
# A pose that so many descents, free ones among them, did not reach is given up as unreachable.
MAX_FAILED_DESCENTS: Final = 30
# The nearest pose, once none meets the target: a descent whose damping follows success (Marquardt), for the error does
# not vanish there and full steps overshoot. Steps at most, first damping, its factors, and the gain that ends it.
NEAREST_STEPS: Final = 40
NEAREST_DAMPING: Final = 1e-2
NEAREST_GROWTH: Final = 6.0
NEAREST_SHRINK: Final = 0.2
NEAREST_GAIN: Final = 1e-9
# A remaining error below this is called "stalled", not "unreachable".
STALLED_BELOW: Final = 1e-3
# A descent's end this far beyond its region [m and rad together] counts as inside, by the slack that
# `kinematics.limits` grants, and is put on the limit before it is verified.
INSIDE_SLACK: Final = math.radians(tolerances.LIMIT_SLACK)
# Distance by which rounding may move a step along a path beyond its region [m and rad together].
ROUNDING: Final = 1e-12
# Whole turns bring an axis near to its start. Where two places are half a turn to either side, rounding would choose:
# the start counts as this much nearer [rad] to a place beside 0, so that 180 degrees stand for -180 and a way back
# takes the same turns.
HALF_TURN_NUDGE: Final = 1e-9
HALF_TURN_TOWARDS: Final = 1e-3
