"""`chainbuild inspect`: an HTML page that shows a robot."""

from __future__ import annotations

from pathlib import Path

from chainbuild.cli.show import note_undrawn, say
from chainbuild.cli.usage import DEFAULT_OPTIONS, MachineOptions


def inspect(file: str, /, *, export: Path, options: MachineOptions = DEFAULT_OPTIONS) -> int:
    """Write an HTML page that shows the robot, its frames and a sweep of each axis.

    The page is a single self-contained HTML file for any browser.

    Example: `chainbuild inspect kr6r900 --export page.html`

    Args:
        file: A machine file, or the name of a shipped machine.
        export: HTML file to write.
        options: Which kinematic.
    """
    from chainbuild.inspect.export import export_page

    robot = options.robot(file)
    note_undrawn(robot.chain.geometry)
    say(export_page(robot, export))
    return 0
