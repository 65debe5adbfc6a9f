"""Mutants that no test can fail on, each with the reason: they compute the same."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from tests.mutants.mutations import Mutant
from tests.mutants.targets import ROOT


@dataclass(frozen=True)
class Equivalent:
    """A change that changes nothing.

    Attributes:
        file: Below the package.
        line: Text of the line, or the part of it that tells it from others.
        what: The change in words, as the mutant gives it.
        why: Why nothing comes of it.
    """

    file: str
    line: str
    what: str
    why: str

    def is_of(self, path: Path, mutant: Mutant) -> bool:
        """Return whether a mutant of a file is this one."""
        if path != ROOT / "chainbuild" / self.file or mutant.what != self.what:
            return False
        return self.line in path.read_text("utf-8").splitlines()[mutant.line - 1]


EQUIVALENT = (
    Equivalent(
        "coupling/partial_state.py", "a.lower + s * (a.upper - a.lower)", "Sub for a.lower + s * (a.upper - a.lower)",
        "any generic position shows the freedoms, beyond the limits as well",
    ),
    Equivalent(
        "coupling/partial_state.py", "np.remainder(wanted[others]", "Sub for wanted[others] - now[others] + 180.0",
        "half a turn more or less is the same modulo a whole one",
    ),
    Equivalent(
        "coupling/partial_state.py", "np.remainder(wanted[others]", "180.0 → -180.0",
        "half a turn more or less is the same modulo a whole one",
    ),
    Equivalent(
        "formats/twincat/coupling/two_steps.py", "np.remainder(error[rotary] + np.pi", "Sub for error[rotary] + np.pi",
        "half a turn more or less is the same modulo a whole one",
    ),
    Equivalent(
        "formats/twincat/types/displays.py", "zero_deg=180.0 if aside", "180.0 → -180.0",
        "half a turn this way or that: the angle shown is within (-180, 180] either way",
    ),
    Equivalent(
        "formats/twincat/types/displays.py", "zero_deg=180.0 if aside", "flipped zero_deg=180.0 if aside else 0.0",
        "half a turn this way or that: the angle shown is within (-180, 180] either way",
    ),
    Equivalent(
        "formats/twincat/families/ca_heads.py", "        ratio = 1.0", "1.0 → -1.0",
        "the list is refused by then: any ratio but 0 lets the check go on",
    ),
    Equivalent(
        "formats/twincat/families/levers.py", '_DISC_AXES.get(flags, "z")', "axis z → x",
        "the list is refused by then: any axis lets the check go on",
    ),
    Equivalent(
        "formats/twincat/families/parallel.py", '"deg_180": 180.0', "180.0 → -180.0",
        "half a turn this way or that is the same",
    ),
    Equivalent(
        "formats/twincat/universal/universal.py", "return rot_about((1.0, 0.0, 0.0), 180.0)", "1.0 → -1.0",
        "half a turn about x or about -x is the same",
    ),
    Equivalent(
        "formats/twincat/universal/universal.py", "return rot_about((1.0, 0.0, 0.0), 180.0)", "180.0 → -180.0",
        "half a turn this way or that is the same",
    ),
    Equivalent(
        "formats/twincat/universal/directions.py", "seconds = [angle, 180.0 - angle]", "180.0 → -180.0",
        "a whole turn more or less: the angle returned is within (-180, 180] either way",
    ),
    Equivalent(
        "formats/sinumerik/geometry/tool.py", "frames.rot_y(180.0)", "180.0 → -180.0",
        "half a turn this way or that is the same",
    ),
    Equivalent(
        "kinematics/task_error.py", "self._even = bool((self._weights == 1.0).all())", "1.0 → -1.0",
        "weights of 1 are multiplied by as well: a shortcut is lost, no weight is negative",
    ),
    Equivalent(
        "ik/branches/opw/formulas.py", "share = 1.0 / where(straight, 1.0, radius)",
        "Mult for 1.0 / where(straight, 1.0, radius)", "only angles are taken of what it scales",
    ),
    *(
        Equivalent(
            "ik/branches/opw/formulas.py", "return first, second, third, fourth + math.pi",
            f"Sub for {angle} + math.pi", "a whole turn more or less, which the limits decide about",
        )
        for angle in ("fourth", "sixth")
    ),
    *(
        Equivalent(
            "ik/branches/opw/formulas.py", "(np.abs(x[0]) + 1.0) * np.inf", what,
            "infinite either way, but for one value of axis 1",
        )
        for what in ("Sub for np.abs(x[0]) + 1.0", "1.0 → -1.0")
    ),
    Equivalent(
        "ik/branches/planar/constants.py", "uniform(-170.0, 170.0, (_SAMPLES, 6))", "sign dropped: -170.0",
        "one set of axis values at which nothing is singular shows any wrong number, too",
    ),
)  # fmt: skip


def is_equivalent(path: Path, mutant: Mutant) -> bool:
    """Return whether a mutant of a file is known to compute the same."""
    return any(one.is_of(path, mutant) for one in EQUIVALENT)
