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

    shown = table("Written", "Machine", "Kinematic", "Axes", "URDF", "Look at it")
    for name in shipped() if file is None else (file,):
        robot = options.robot(name)
        path = write_urdf(robot, folder)
        axes = " ".join(axis.name for axis in robot.axes)
        look = f"chainbuild inspect {name} --export {robot.name}.html"
        shown.add_row(robot.chain.title, robot.chain.kinematic, axes, str(path), look)
    out = console()
    out.print(shown)
    out.print("chainbuild info MACHINE shows what was read; chainbuild fk and ik compute with it.")
    return 0
