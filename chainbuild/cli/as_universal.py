"""`chainbuild as-universal`: a machine as the universal kinematic KIN_TYP 91."""

from __future__ import annotations

from chainbuild.cli.show import note, output
from chainbuild.cli.usage import DEFAULT_OPTIONS, MachineOptions, Output, UsageError


def as_universal(file: str, /, *, output_file: Output = None, options: MachineOptions = DEFAULT_OPTIONS) -> int:
    """Write a machine as a parameter list of KIN_TYP 91, the universal kinematic.

    The list gives the same poses, up to a constant shift that its header states. In it every axis has its own
    direction and point, which can be corrected where the machine deviates from its drawing. Machines with three linear
    axes and up to three rotary axes can be written.

    Example: `chainbuild as-universal bed_mill_kin1 -o universal.lis`

    Args:
        file: A machine file, or the name of a shipped machine.
        output_file: Parameter list to write. Default: stdout.
        options: Which kinematic.
    """
    from chainbuild.formats.twincat.universal.as_universal import as_universal as universal_list

    if options.tool_length:
        raise UsageError("--tool-length: the tool is no part of the list; it acts on both kinematics alike")
    machine = options.machine(file)
    chosen = options.chosen_kinematic(machine)
    text = universal_list(machine, chosen, options.channel, conventions=options.choices())
    with output(output_file) as stream:
        stream.write(text)
    if output_file:
        note(str(output_file))
    return 0
