"""`chainbuild demo`: every shipped machine, from machine data to URDF."""

from __future__ import annotations

from pathlib import Path

from chainbuild.cli.show import console, table
from chainbuild.cli.urdf import Folder
from chainbuild.cli.usage import DEFAULT_OPTIONS, MachineOptions


def demo(
    file: str | None = None, /, *, folder: Folder = Path("urdf_out"), options: MachineOptions = DEFAULT_OPTIONS
) -> int:
    """Build the shipped machines, write their URDF and say how to look at them.

    Args:
        file: Build only this machine: a file, or the name of a shipped machine.
        folder: Folder to write to.
        options: Which kinematic.
    """
    from chainbuild.machines import shipped
    from chainbuild.out.urdf import write_urdf

    shown = table("Written", "Name", "Machine", "Kinematic", "Axes", "URDF")
    names = shipped() if file is None else (file,)
    for name in names:
        robot = options.robot(name)
        path = write_urdf(robot, folder)
        axes = " ".join(axis.name for axis in robot.axes)
        shown.add_row(name, robot.chain.title, robot.chain.kinematic, axes, str(path))
    out = console()
    out.print(shown)
    out.print("What to look at, here for the last one:")
    out.print(f"  chainbuild inspect {names[-1]} --export page.html   a page with the robot and a sweep of each axis")
    out.print(f"  chainbuild info {names[-1]}   what was read, and which conventions were used")
    return 0
