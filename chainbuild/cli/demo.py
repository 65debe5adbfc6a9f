"""`chainbuild demo`: every shipped machine, from machine data to URDF."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Final

from chainbuild.cli.show import console, counted_findings, empty_table
from chainbuild.cli.urdf import Folder
from chainbuild.cli.usage import DEFAULT_OPTIONS, MachineOptions, all_findings
from chainbuild.findings import finding_kinds
from chainbuild.progress import bars_shown, counted

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Mechanism
    from chainbuild.writers.models.export import ExportFormat

_EXAMPLE: Final = "kr6r900"
_SLOW: Final = ("srdf", "report")
_LOOK: Final = (
    (
        "inspect {} --export page.html",
        "writes a page on which the robot is moved axis by axis: open it in a browser",
    ),
    ("picture {} -o picture.svg --dimensions", "draws it with the lengths of its machine data"),
    ("info {}", "shows what was read: axes, parameters, conventions, findings"),
)


def demo(
    file: str | None = None, /, *, folder: Folder = Path("urdf_out"), options: MachineOptions = DEFAULT_OPTIONS
) -> int:
    """Build the shipped machines, write them as URDF and MJCF and print commands to view them.

    One machine alone, and the example, get every file that `chainbuild export` writes.

    Example: `chainbuild demo kr6r900`

    Args:
        file: Build only this machine: a file, or the name of a shipped machine.
        folder: Folder to write to.
        options: Which kinematic.
    """
    from chainbuild.machines import shipped
    from chainbuild.robot import Robot
    from chainbuild.writers.models.export import export

    shown = empty_table("Written", "Name", "Kinematic", "Machine")
    shown.columns[0].no_wrap = shown.columns[1].no_wrap = True
    names = shipped() if file is None else (file,)
    warnings: dict[str, int] = {}
    for name in counted(names, len(names), bars_shown(), "machines"):
        machine = options.machine(name)
        chain = options.chain(machine)
        robot = Robot(chain)
        formats = _formats(robot, everything=name == _EXAMPLE or file is not None)
        export(robot, folder, formats=formats, machine=machine, selection=options.selection(machine))
        count = sum(finding_kinds()[one.code].told != "listed" for one in all_findings(machine, robot.chain))
        warnings.update({name: count} if count else {})
        shown.add_row(name, chain.kinematic, chain.title)
    out = console()
    out.print(shown)
    example, command = _EXAMPLE if _EXAMPLE in names else names[-1], command_name()
    out.print(
        f"{len(names)} robot{'s' * (len(names) != 1)} written: {folder}/NAME/NAME.urdf, NAME.xml, …", soft_wrap=True
    )
    if warnings:
        total, where = counted_findings(sum(warnings.values())), ", ".join(warnings)
        out.print(f"{total} in {where}; {command} check NAME lists them", soft_wrap=True)
    out.print(f"To view {example}:", highlight=False)
    report = folder / example / f"{example}.html"
    out.print(f"  {report}", "    is its report: open it in a browser", sep="\n", soft_wrap=True, highlight=False)
    for arguments, what in _LOOK:
        out.print(f"  {command} {arguments.format(example)}", f"    {what}", sep="\n", soft_wrap=True, highlight=False)
    return 0


def _formats(robot: Mechanism, *, everything: bool) -> list[ExportFormat]:
    """Return the formats to write: all, or those that do not take seconds."""
    from chainbuild.writers.models.export import formats_of

    return [one for one in formats_of(robot) if everything or one not in _SLOW]


def command_name() -> str:
    """Return how to call this command: by its name if the shell finds it, else by its path."""
    called = Path(sys.argv[0])
    if called.name != "chainbuild" or shutil.which("chainbuild") == str(called.resolve()):
        return "chainbuild"
    try:
        return str(called.resolve().relative_to(Path.cwd()))
    except ValueError:
        return str(called)
