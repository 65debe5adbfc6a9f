"""`chainbuild info`: the contents of a machine file and the chain built from it."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from chainbuild.cli.info_tables import (
    axes_table,
    conventions_shown,
    drives_table,
    kinematics_table,
    parameters_table,
    poses_table,
)
from chainbuild.cli.show import console, error_data, finding_data, print_findings, print_json
from chainbuild.cli.usage import DEFAULT_OPTIONS, Json, MachineOptions, ShownError, all_findings
from chainbuild.errors import ChainbuildError
from chainbuild.findings import Findings
from chainbuild.formats.listing import limits_source, line_of
from chainbuild.kinematics.limits import drive_name

if TYPE_CHECKING:
    from chainbuild.chain.drives import DriveLimit
    from chainbuild.chain.elements import Chain
    from chainbuild.chain.programmed.vectors import VectorProgramming
    from chainbuild.convention import UsedConvention
    from chainbuild.formats.entries import KinematicEntry, ParameterRow
    from chainbuild.formats.machine import Machine


def info(
    file: str,
    /,
    *,
    defaults: Annotated[bool, Parameter(negative="")] = False,
    json: Json = False,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Show what was read from a machine file and the chain built from it.

    Prints kinematics, axes with limits, parameters with meaning and source, the conventions used where the manuals are
    open, and findings.

    Example: `chainbuild info kr6r900`

    Args:
        file: A machine file, or the name of a shipped machine.
        defaults: Also show parameters that the file does not set.
        json: Print JSON, with all parameters.
        options: Which kinematic.
    """
    machine = options.machine(file)
    chain, refusal = _chain(machine, options)
    findings = all_findings(machine, chain, refusal)
    if json:
        error = error_data(refusal) if refusal else None
        data = _data(machine, chain, options, findings)
        print_json("info", {**data, "refused": refusal is not None, "error": error})
    else:
        _print(machine, chain, options, defaults, findings)
    if refusal:
        raise ShownError(refusal)
    return 0


def _chain(machine: Machine, options: MachineOptions) -> tuple[Chain | None, ChainbuildError | None]:
    """Return the chain, or the error that prevents it; what was read is shown in either case."""
    try:
        return options.chain(machine), None
    except ChainbuildError as error:
        if options.selects:
            raise  # the options may be wrong, not the file
        return None, error


def _parameters(machine: Machine, options: MachineOptions) -> tuple[ParameterRow, ...]:
    try:
        return machine.parameters(options.chosen_kinematic(machine), options.channel)
    except ChainbuildError:
        return ()  # a kinematic without a table of parameters; the chain's refusal says why


def _print(machine: Machine, chain: Chain | None, options: MachineOptions, defaults: bool, findings: Findings) -> None:
    out = console()
    out.print(f"{machine.title}", style="bold")
    out.print(f"{machine.path}: {machine.dialect}", soft_wrap=True)
    out.print(kinematics_table(machine.kinematics()))
    if chain:
        out.print(f"Chosen: {chain.kinematic}; {_pose_meaning(chain)}")
        if chain.vectors:
            out.print(f"Vectors (#ORI MODE): {_vector_meaning(chain, chain.vectors)}")
        out.print()
        out.print(axes_table(machine, chain))
        drives = drives_table(chain)
        if drives is not None:
            out.print(drives)
        if chain.named_poses:
            out.print(poses_table(chain))
    rows = _parameters(machine, options)
    chosen = [row for row in rows if row.given or defaults]
    if rows:
        out.print(parameters_table(chosen, out.width))
    if len(chosen) < len(rows):
        out.print(f"{len(rows) - len(chosen)} more parameters have their default values: --defaults shows them.")
        out.print()
    if chain and chain.conventions:
        conventions_shown(out, chain.conventions)
    if findings:
        out.print("Findings", style="bold")
        print_findings(findings)


def _pose_meaning(chain: Chain) -> str:
    """Return what the controller shows and takes as a pose."""
    from chainbuild.chain.programmed.display import POSITION_COLUMNS
    from chainbuild.frames import ANGLE_MODES

    display = chain.display
    columns = f"poses: {', '.join((*POSITION_COLUMNS, *chain.display_columns))}"
    if display.rtcp:
        linear = ", the linear axes are solved for" if chain.solves_linear_axes or chain.loops else ""
        return f"{columns} (RTCP{linear})"
    if display.kind != "angles":
        return columns
    return f"{columns}; {chain.angle_mode}, R = {ANGLE_MODES[chain.angle_mode].meaning}"


def _vector_meaning(chain: Chain, how: VectorProgramming) -> str:
    """Return what is programmed, what the vector is and what settles the turn about it."""
    from chainbuild.chain.programmed.vectors import FIXED_AXIS_INDEX, TOOL_PLANES, free_angle

    if how.plane:
        normal, inside = TOOL_PLANES[how.plane]
        condition = f"tool {inside.upper()} perpendicular to {normal.upper()} (TOOL_AX_IN_PLANE={how.plane})"
    else:
        letter = how.fixed or free_angle(chain.angle_mode, how.axis)
        condition = f"angle {letter} kept (FIXED_AX_IDX={FIXED_AXIS_INDEX[letter]})"
    return f"{how.mode.upper()}; a vector is the tool's {how.axis.upper()}, {condition}"


def _data(machine: Machine, chain: Chain | None, options: MachineOptions, findings: Findings) -> dict[str, Any]:
    from chainbuild.chain.programmed.display import POSITION_COLUMNS

    return {
        "file": str(machine.path),
        "name": machine.name,
        "title": machine.title,
        "dialect": machine.dialect,
        "kinematics": [_with_line(entry) for entry in machine.kinematics()],
        "kinematic": chain.kinematic if chain else None,
        "angle_mode": chain.angle_mode if chain else None,
        "pose_columns": [*POSITION_COLUMNS, *chain.display_columns] if chain else [],
        "vectors": asdict(chain.vectors) if chain and chain.vectors else None,
        "axes": [_axis_data(machine, chain, n) for n in range(len(chain.axes))] if chain else [],
        "drives": [_drive_data(chain, limit) for limit in chain.drive_limits] if chain else [],
        "poses": {pose.name: list(pose.axes) for pose in chain.named_poses} if chain else {},
        "parameters": [_with_line(row) for row in _parameters(machine, options)],
        "conventions": [_convention_data(used) for used in chain.conventions] if chain else [],
        "findings": [finding_data(finding) for finding in findings],
    }


def _axis_data(machine: Machine, chain: Chain, n: int) -> dict[str, Any]:
    return {**asdict(chain.axes[n]), "limits_from": limits_source(machine, chain, n)}


def _drive_data(chain: Chain, limit: DriveLimit) -> dict[str, Any]:
    ends = {"lower": limit.lower, "upper": limit.upper}
    known = {key: value if math.isfinite(value) else None for key, value in ends.items()}
    return {"name": drive_name(chain.axes[limit.axis]), **known, "max_speed": limit.max_speed}


def _with_line(entry: KinematicEntry | ParameterRow) -> dict[str, Any]:
    data = asdict(entry)
    del data["span"]
    return {**data, "line": line_of(entry.span)}


def _convention_data(used: UsedConvention) -> dict[str, Any]:
    convention = used.convention
    return {
        "name": convention.name,
        "choice": used.choice,
        "by_user": used.by_user,
        "mark": convention.mark,
        "choices": dict(convention.choices),
        "question": convention.question,
        "why": convention.why,
        "verify": convention.verify,
        "source": convention.source,
    }
