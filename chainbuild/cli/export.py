"""`chainbuild export`: a robot as files for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from chainbuild.cli.show import print_json, say
from chainbuild.cli.urdf import Folder
from chainbuild.cli.usage import DEFAULT_OPTIONS, Json, MachineOptions, UsageError

Formats = Annotated[str, Parameter(name=["--format", "-f"])]


def export(
    file: str,
    /,
    *,
    formats: Formats = "urdf,mjcf,srdf",
    folder: Folder = Path("urdf_out"),
    samples: int = 10_000,
    json: Json = False,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Write a machine as URDF, MJCF for MuJoCo and SRDF.

    The files are FOLDER/NAME/NAME.urdf, NAME.xml and NAME.srdf; all of them are made before the first is written. The
    head of each says what it cannot express.

    Example: `chainbuild export tripod_kin12 --format urdf,mjcf`

    Args:
        file: A machine file, or the name of a shipped machine.
        formats: Formats, separated by commas: urdf, mjcf, srdf.
        folder: Folder to write to.
        samples: Number of random positions by which the SRDF tells pairs that never collide.
        json: Print JSON.
        options: Which kinematic.
    """
    from chainbuild.writers.models.export import FORMATS, ExportFormat
    from chainbuild.writers.models.export import export as exported

    wanted: list[ExportFormat] = []
    for word in formats.split(","):
        match = [one for one in FORMATS if one == word.strip().lower()]
        if not match:
            raise UsageError(f"--format {formats}: expected a list of {', '.join(FORMATS)}")
        wanted += match
    if samples < 1:
        raise UsageError(f"--samples {samples}: expected at least 1")
    paths = exported(options.robot(file), folder, formats=wanted, samples=samples)
    if json:
        print_json({"paths": {name: str(path) for name, path in paths.items()}})
    for path in paths.values() if not json else ():
        say(path)
    return 0
