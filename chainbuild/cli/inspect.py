"""`chainbuild inspect`: a page to look at a robot."""

from __future__ import annotations

from pathlib import Path

from chainbuild.cli.usage import DEFAULT_OPTIONS, MachineOptions


def inspect(file: str, /, *, export: Path, options: MachineOptions = DEFAULT_OPTIONS) -> int:
    """Write a page that shows the robot, its frames and a sweep of each axis.

    The page is one file without references to others: open it in any browser, or send it.

    Args:
        file: A machine file, or the name of a shipped machine.
        export: HTML file to write.
        options: Which kinematic.
    """
    from chainbuild.inspect.export import export_page

    print(export_page(options.robot(file), export))
    return 0
