"""`chainbuild urdf`: a robot as URDF."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from chainbuild.cli.show import print_json, say
from chainbuild.cli.usage import DEFAULT_OPTIONS, Json, MachineOptions

NoInertia = Annotated[bool, Parameter(negative="")]
Folder = Annotated[Path, Parameter(name=["--output", "-o"])]


def urdf(
    file: str,
    /,
    *,
    folder: Folder = Path("urdf_out"),
    no_inertia: NoInertia = False,
    json: Json = False,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Write a machine as URDF.

    The file is FOLDER/NAME/NAME.urdf. Its joint values are Pinocchio's; its header states how they follow from the
    controller's axis values, which conventions were used and what the file cannot express. NAME.loops.yaml beside it
    says how to drive loops and couplings.

    Example: `chainbuild urdf kr6r900 -o urdf_out`

    Args:
        file: A machine file, or the name of a shipped machine.
        folder: Folder to write to.
        no_inertia: Leave masses out of the URDF: they are estimates.
        json: Print JSON.
        options: Which kinematic.
    """
    from chainbuild.writers.models.notes import machine_data
    from chainbuild.writers.models.robotfiles import write_robot_files
    from chainbuild.writers.models.urdf import urdf_files, urdf_limitations

    machine, robot = options.built(file)
    files = urdf_files(robot, inertia=not no_inertia, data=machine_data(machine, options.selection(machine)))
    path, *others = write_robot_files(robot, folder, files).values()
    limitations = urdf_limitations(robot.chain)
    shaping = [used for used in robot.chain.conventions if used.convention.poses]
    if json:
        conventions = {used.convention.name: used.choice for used in shaping}
        beside = [str(other) for other in others]
        print_json(
            "urdf",
            {"path": str(path), "beside": beside, "not_expressed": list(limitations), "conventions": conventions},
        )
        return 0
    say(path)
    for other in others:
        say(f"  beside it {other.relative_to(path.parent)}")
    for used in shaping:
        say(f"  convention {used.convention.name}={used.choice}{'' if used.by_user else ' (default)'}")
    for limitation in limitations:
        say(f"  not expressed: {limitation}")
    return 0
