"""`chainbuild info`: what a machine file says and what was made of it."""

from __future__ import annotations

from dataclasses import asdict
from itertools import groupby
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter
from rich.console import Console

from chainbuild.cli.show import (
    console,
    error_data,
    finding_data,
    number,
    print_findings,
    print_json,
    refusal_as_json,
    table,
)
from chainbuild.cli.usage import DEFAULT_OPTIONS, Json, MachineOptions, all_findings
from chainbuild.errors import ChainbuildError, Span

if TYPE_CHECKING:
    from collections.abc import Sequence

    from chainbuild.chain.elements import Axis, Chain
    from chainbuild.conventions import UsedConvention
    from chainbuild.machine import KinematicEntry, Machine, ParameterRow


def info(
    file: str,
    /,
    *,
    defaults: Annotated[bool, Parameter(negative="")] = False,
    json: Json = False,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Show what was read from a machine file and what was made of it.

    Kinematics, axes with limits, parameters with meaning and source, the conventions that shaped the chain although
    the manuals leave them open, and findings.

    Args:
        file: A machine file, or the name of a shipped machine.
        defaults: Also show parameters that the file does not give.
        json: Print JSON, with all parameters.
        options: Which kinematic.
    """
    with refusal_as_json(file, json):
        machine = options.machine(file)
        chain, refusal = _chain(machine, options)
    if json:
        error = error_data(refusal) if refusal else None
        print_json({**_data(machine, chain, options), "refused": refusal is not None, "error": error})
    else:
        _print(machine, chain, options, defaults)
    if refusal:
        raise refusal
    return 0


def _chain(machine: Machine, options: MachineOptions) -> tuple[Chain | None, ChainbuildError | None]:
    """Return the chain, or why the file gives none: what was read is shown all the same."""
    try:
        return options.chain(machine), None
    except ChainbuildError as error:
        if options.selects:
            raise  # the fault may lie in the options; the file as such is not in question
        return None, error


def _parameters(machine: Machine, options: MachineOptions) -> tuple[ParameterRow, ...]:
    try:
        return machine.parameters(options.kinematic, options.channel)
    except ChainbuildError:
        return ()  # a kinematic without a table of parameters; the chain's refusal says why


def _print(machine: Machine, chain: Chain | None, options: MachineOptions, defaults: bool) -> None:
    out = console()
    out.print(f"{machine.title}", style="bold")
    out.print(f"{machine.path}: {machine.dialect}", soft_wrap=True)
    out.print(_kinematics_table(machine.kinematics()))
    if chain:
        out.print(f"Chosen: {chain.kinematic}; pose angles A, B, C: {_angle_meaning(chain)}\n")
        out.print(_axes_table(chain.axes))
    _print_parameters(out, _parameters(machine, options), defaults)
    if chain and chain.conventions:
        out.print(_conventions_table(chain.conventions))
    findings = all_findings(machine, chain)
    if findings:
        out.print("Findings", style="bold")
        print_findings(findings)


def _angle_meaning(chain: Chain) -> str:
    from chainbuild.frames import ANGLE_MODES

    return f"{chain.angle_mode}, R = {ANGLE_MODES[chain.angle_mode].meaning}"


def _kinematics_table(entries: Sequence[KinematicEntry]) -> Any:
    shown = table("Kinematics", "Id", "Name", "Type", "Title", "Channel", "Default", "Line")
    for entry in entries:
        default = "yes" if entry.default else ""
        line = _line(entry.span)
        shown.add_row(str(entry.id), entry.name, entry.type, entry.title, str(entry.channel), default, line)
    return shown


def _axes_table(axes: Sequence[Axis]) -> Any:
    shown = table("Axes", "Axis", "Kind", "Unit", "Lower", "Upper", "Speed", "Carries", "Remarks")
    for axis in axes:
        remarks = {"limits assumed": axis.assumed, "endless": axis.endless, "held by ik": axis.held}
        shown.add_row(
            axis.name,
            axis.kind,
            axis.unit,
            number(axis.lower),
            number(axis.upper),
            f"{number(axis.max_speed)} {axis.unit}/s" if axis.max_speed is not None else "–",
            axis.carries,
            ", ".join(text for text, on in remarks.items() if on),
        )
    return shown


def _print_parameters(out: Console, rows: Sequence[ParameterRow], defaults: bool) -> None:
    shown = table("Parameters", "Symbol", "Name", "Value", "Unit", "Meaning", "Source", "Line")
    chosen = [row for row in rows if row.given or defaults]
    for _, run in groupby(chosen, key=_kept_together):
        group = list(run)
        first, last = group[0], group[-1]
        name = first.name if first is last else f"{first.name.removesuffix(']')}…{last.name.rpartition('[')[2]}"
        values = ", ".join(number(row.value) for row in group)
        meaning = f"{first.meaning}{_in_si(group)}"
        shown.add_row(first.symbol, name, values, first.unit, meaning, first.source, _lines(group))
    out.print(shown)
    hidden = len(rows) - len(chosen)
    if hidden:
        out.print(f"{hidden} more parameters stand at their defaults: --defaults shows them.\n")


def _in_si(group: Sequence[ParameterRow]) -> str:
    """Return the values of an array in SI units where the file counts otherwise."""
    if not group[0].si_unit:
        return ""
    return f" In SI: {', '.join(f'{row.si:.6g}' for row in group)} {group[0].si_unit}."


def _kept_together(row: ParameterRow) -> tuple[object, ...]:
    """Return what the elements of one array have in common."""
    array = row.name.rpartition("[")[0] if row.name.startswith("$") and row.name.endswith("]") else row.name
    return (row.symbol, array, row.unit, row.meaning, row.source, row.given)


def _lines(group: Sequence[ParameterRow]) -> str:
    if not group[0].given:
        return "default"
    first, last = _line(group[0].span), _line(group[-1].span)
    return first if first == last else f"{first}–{last}"


def _conventions_table(used: Sequence[UsedConvention]) -> Any:
    title = "Conventions: open in the manuals ([I] inferred, [?] open); --convention NAME=CHOICE switches one"
    shown = table(title, "Name", "Choice", "Mark", "Meaning", "Alternatives", "How to verify")
    for one in used:
        convention = one.convention
        others = [f"{name}: {meaning}" for name, meaning in convention.choices.items() if name != one.choice]
        shown.add_row(
            convention.name,
            one.choice + (" (chosen)" if one.by_user else " (default)"),
            f"[{convention.mark}]",
            convention.choices[one.choice],
            "\n".join(others),
            convention.verify,
        )
    return shown


def _line(span: Span | None) -> str:
    return str(span.line) if span and span.line else ""


def _data(machine: Machine, chain: Chain | None, options: MachineOptions) -> dict[str, Any]:
    return {
        "file": str(machine.path),
        "name": machine.name,
        "title": machine.title,
        "dialect": machine.dialect,
        "kinematics": [_with_line(entry) for entry in machine.kinematics()],
        "kinematic": chain.kinematic if chain else None,
        "angle_mode": chain.angle_mode if chain else None,
        "axes": [asdict(axis) for axis in chain.axes] if chain else [],
        "parameters": [_with_line(row) for row in _parameters(machine, options)],
        "conventions": [_convention_data(used) for used in chain.conventions] if chain else [],
        "findings": [finding_data(finding) for finding in all_findings(machine, chain)],
    }


def _with_line(entry: KinematicEntry | ParameterRow) -> dict[str, Any]:
    data = asdict(entry)
    del data["span"]
    return {**data, "line": entry.span.line or None if entry.span else None}


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
