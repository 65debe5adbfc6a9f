"""`chainbuild crosscheck`: the model against another solver, or against poses recorded on the controller."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, get_args

from cyclopts import Parameter

from chainbuild.cli.show import note, print_json, say
from chainbuild.cli.usage import DEFAULT_OPTIONS, REJECTED, Json, MachineOptions, UsageError, Whole
from chainbuild.progress import bars_shown
from chainbuild.units import m_from_mm, rad_from_deg

if TYPE_CHECKING:
    from chainbuild.comparison.crosscheck import CheckOptions, CrossCheck

CallableOption = Literal["auto", "fk", "ik"]
SampleName = Literal["random", "grid", "singular"]


@Parameter(name="*", group="Poses")
@dataclass(frozen=True, slots=True)
class PoseOptions:
    """Which poses are compared, and when they agree.

    Attributes:
        count: Number of poses to compare.
        samples: Kind of poses: random, grid, singular; may be repeated. Default: all three.
        seed: Seed of the poses.
        position_tolerance: Largest permitted distance in mm. Default: 0.001, for recordings 0.01.
        rotation_tolerance: Largest permitted angle in degrees. Default: 6e-5, for recordings 0.006.
    """

    count: Whole = 300
    samples: Annotated[tuple[SampleName, ...], Parameter(negative="", show_default=False)] = ()
    seed: Whole = 0
    position_tolerance: float | None = None
    rotation_tolerance: float | None = None

    def check_options(self, kind: CallableOption) -> CheckOptions:
        """Return the options of the comparison."""
        from chainbuild.comparison.crosscheck import CheckOptions

        distance, angle = self.position_tolerance, self.rotation_tolerance
        return CheckOptions(
            count=self.count,
            samples=self.samples or get_args(SampleName),
            seed=self.seed,
            position_tolerance=None if distance is None else m_from_mm(distance),
            rotation_tolerance=None if angle is None else rad_from_deg(angle),
            kind=kind,
        )


DEFAULT_POSES = PoseOptions()


def crosscheck(
    file: str,
    /,
    *,
    solver: str | None = None,
    recording: Path | None = None,
    kind: CallableOption = "auto",
    html: Path | None = None,
    json: Json = False,
    poses: PoseOptions = DEFAULT_POSES,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Compare the model with another solver, or with poses recorded on the controller, and name what differs.

    A recording has one column per axis and x_mm, y_mm, z_mm; on complete kinematics also the pose angles, or qx, qy,
    qz, qw, or tool_x, tool_y, tool_z. On RTCP kinematics the rotary axes are there already, and a full orientation may
    be added. If poses differ, the command looks for a systematic cause (a constant offset, a reversed axis, two swapped
    axes, a wrong zero, another angle convention), tries another sign and the best value of each number of the machine
    data and of the tool, and every choice of the machine's conventions, and ends with exit code 3.

    Example: `chainbuild crosscheck kr6r900 --recording poses.csv --html crosscheck.html`

    Args:
        file: A machine file, or the name of a shipped machine.
        solver: eaik, opw, roboticstoolbox, or MODULE:FUNCTION: axis values in mm and degrees to a 4×4 pose in metres,
            or such a pose to rows of axis values.
        recording: CSV table of axis values and poses.
        kind: What the function computes; auto: decided by what it returns.
        html: HTML page with plots to write.
        json: Print JSON.
        poses: Which poses.
        options: Which kinematic.
    """
    if (solver is None) == (recording is None):
        raise UsageError("expected either --solver or --recording")
    check = _compare(file, recording or solver or "", poses.check_options(kind), options)
    if html:
        from chainbuild.writers.report_html import write_crosscheck_page

        note(f"wrote {write_crosscheck_page(check, html)}")
    _print(check, json)
    return 0 if check.agrees else REJECTED


def _compare(file: str, other: Path | str, check_options: CheckOptions, options: MachineOptions) -> CrossCheck:
    """Compare the machine with a recording (a path) or another solver (its name)."""
    from chainbuild.comparison.crosscheck import crosscheck as compare
    from chainbuild.tables.recording import read_recording

    machine, robot = options.built(file)
    return compare(
        robot,
        read_recording(other, robot.chain) if isinstance(other, Path) else other,
        options=check_options,
        machine=machine,
        selection=options.selection(machine),
        conventions=options.choices(),
        progress=bars_shown(),
    )


def _print(check: CrossCheck, as_json: bool) -> None:
    from chainbuild.writers.report import crosscheck_data, crosscheck_text

    if as_json:
        print_json("crosscheck", crosscheck_data(check))
    else:
        say(crosscheck_text(check), end="", lines=True)
