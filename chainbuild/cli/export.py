"""`chainbuild export`: a robot as files for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from chainbuild.cli.show import print_json, say
from chainbuild.cli.urdf import Folder, NoInertia
from chainbuild.cli.usage import DEFAULT_OPTIONS, Json, MachineOptions, UsageError, Whole
from chainbuild.progress import bars_shown

Formats = Annotated[str, Parameter(name=["--format", "-f"])]


def export(
    file: str,
    /,
    *,
    formats: Formats = "all",
    folder: Folder = Path("urdf_out"),
    samples: Whole = 10_000,
    no_inertia: NoInertia = False,
    json: Json = False,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Write a machine as URDF, MJCF for MuJoCo, SRDF, parameters of ortho-parallel arms, and a report.

    The files are FOLDER/NAME/NAME.urdf (with NAME.loops.yaml where loops or couplings have to be told, and meshes),
    NAME.xml, NAME.srdf, NAME.opw.yaml, and NAME.html and NAME.md with pictures; all of them are made before the first
    is written. The head of each says what it cannot express.

    Example: `chainbuild export tripod_kin12 --format urdf,mjcf`

    Args:
        file: A machine file, or the name of a shipped machine.
        formats: Formats, separated by commas: urdf, mjcf, srdf, opw, report; or all that the machine has.
        folder: Folder to write to.
        samples: Number of random positions by which the SRDF tells pairs that never collide.
        no_inertia: Leave masses out of the URDF: they are estimates.
        json: Print JSON.
        options: Which kinematic.
    """
    from chainbuild.writers.models.export import FORMATS, ExportFormat, export_files
    from chainbuild.writers.models.robotfiles import write_robot_files

    wanted: list[ExportFormat] = []
    everything = formats.strip().lower() == "all"
    for word in formats.split(",") if not everything else ():
        match = [one for one in FORMATS if one == word.strip().lower()]
        if not match:
            raise UsageError(f"--format {formats}: expected all, or a list of {', '.join(FORMATS)}")
        wanted += match
    if samples < 1:
        raise UsageError(f"--samples {samples}: expected at least 1")
    machine, robot = options.built(file)
    source = machine, options.selection(machine)
    files = export_files(robot, None if everything else wanted, samples, not no_inertia, source, bars_shown())
    paths = write_robot_files(robot, folder, {name: text for own in files.values() for name, text in own.items()})
    if json:
        print_json("export", {"paths": {one: [str(paths[name]) for name in own] for one, own in files.items()}})
    for path in paths.values() if not json else ():
        say(path)
    return 0
