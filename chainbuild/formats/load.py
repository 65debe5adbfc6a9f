"""Loading: from a path or a shipped machine's name to a Machine."""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path

from chainbuild.chain.elements import Chain
from chainbuild.closest import closest, listed
from chainbuild.errors import (
    ChainbuildError,
    ConventionError,
    FileAccessError,
    FileContentError,
    Span,
    UnsupportedKinematicError,
)
from chainbuild.files import as_path
from chainbuild.findings import Collector, Findings, once
from chainbuild.formats.machine import Machine
from chainbuild.formats.neighbours import no_machine_data, refuse_other_xml
from chainbuild.formats.overlay import Overlay, overlay_path, read_overlay
from chainbuild.formats.text import COUPLED, URDF, is_dh, is_sinumerik, is_twincat, is_urdf, is_xml, read_source
from chainbuild.machines import shipped, shipped_path


def load(
    path: str | os.PathLike[str], *, overlay: str | os.PathLike[str] | None = None, tool: str | None = None
) -> Machine:
    """Read a machine file: SINUMERIK or TwinCAT data, a Denavit-Hartenberg table or a URDF, told by its content.

    Args:
        path: A file, or the name of a shipped machine; an existing path wins.
        overlay: An overlay file in place of the one beside the machine file.
        tool: Of a URDF: name of the link whose frame is the tool; None: the overlay's `kinematic`, else the only link
            without children.

    Raises:
        ChainbuildError: the file cannot be read, or holds a syntax or range error; or a tool link is named for what is
            no URDF.
    """
    return _read(path, overlay, Collector(strict=True), tool)


def check(
    path: str | os.PathLike[str], *, overlay: str | os.PathLike[str] | None = None, tool: str | None = None
) -> Findings:
    """Return every finding of a machine file, errors included; never raises on content.

    The file is read to its end and every kinematic it configures is translated. A type that is not built, or whose
    convention must be chosen, is an error if it is the default kinematic, else a warning: the file does without it.
    Arguments are those of `load`.

    Raises:
        FileAccessError: the file is missing, a folder, or may not be read.
    """
    collector = Collector(strict=False)
    try:
        _check_kinematics(_read(path, overlay, collector, tool), collector)
    except FileContentError as error:
        collector.add_error(error)
    except FileAccessError:
        raise
    except ChainbuildError as error:
        collector.add_error(error)
    return once(collector.findings)


def from_urdf(
    path: str | os.PathLike[str], *, tool: str | None = None, overlay: str | os.PathLike[str] | None = None
) -> Chain:
    """Read a URDF file into a chain from its root link to a tool link.

    Args:
        path: The file (plain URDF, not xacro).
        tool: Name of the link whose frame is the tool; None: the one that the overlay names as `kinematic`, else the
            only link without children.
        overlay: An overlay file in place of the one beside the URDF.

    Raises:
        FileAccessError: the file or its overlay cannot be read.
        OverlayError: the overlay says what a URDF has no use for, or what does not fit the chain.
        ParseError: no URDF, a bad number, a link with two parents, limits that leave nothing, or a joint type other
            than revolute, continuous, prismatic, fixed.
        ChainbuildError: the tool link does not exist or is not the only candidate, or no joint on the way moves.
    """
    from chainbuild.formats.urdf.robot import named_tool, urdf_chain
    from chainbuild.formats.urdf.xml import parse

    file = Path(path)
    robot = parse(read_source(file).text, str(path))
    beside = find_overlay(file, None if overlay is None else Path(overlay))
    return urdf_chain(robot, file, named_tool(tool, beside), beside, Collector())


def _check_kinematics(machine: Machine, collector: Collector) -> None:
    """Translate every kinematic of a file, the default as `Machine.chain` without arguments takes it."""
    named = machine.overlay.kinematic is not None
    entries = machine.kinematics()
    if machine.dialect == URDF:  # ways to several links through the same joints
        _note_assumed(machine, _try_chain(machine, None, None, collector), collector)
        return
    if named and entries:
        _note_assumed(machine, _try_chain(machine, None, None, collector), collector)
    ids = Counter((entry.channel, entry.id) for entry in entries)
    names: set[tuple[int, str]] = set()
    for entry in entries:
        # Without a name it is the file's default, to which a second transformation step may belong.
        wanted: int | str | None = None
        if named or not entry.default:
            told_by_name = ids[entry.channel, entry.id] > 1 and (entry.channel, entry.name) not in names
            wanted = entry.name if told_by_name and entry.name else entry.id
        names.add((entry.channel, entry.name))
        first = wanted is None and entry.channel == entries[0].channel
        # Without a channel, too: of several, the finding that one is taken is part of the file's.
        chain = _try_chain(machine, wanted, None if first else entry.channel, collector)
        if first:
            _note_assumed(machine, chain, collector)


def _note_assumed(machine: Machine, chain: Chain | None, collector: Collector) -> None:
    """Note which axes of the default kinematic have no limits of their own."""
    names = [axis.name for axis in chain.axes if axis.assumed and not axis.endless] if chain is not None else []
    if names:
        text = f"limits assumed for {', '.join(names)}: the file does not give both limits"
        hint = "give them in the overlay: [limits] " + f"{names[0]} = [lower, upper]"
        collector.add("CB501", text, span=Span(str(machine.path)), hint=hint)


def _try_chain(
    machine: Machine, kinematic: int | str | None, channel: int | None, collector: Collector
) -> Chain | None:
    """Translate a kinematic; an error becomes a finding, and None is returned."""
    from chainbuild.kinematics.closure import check_closure  # reading alone needs no Pinocchio
    from chainbuild.kinematics.mechanism import Mechanism

    try:
        mechanism = Mechanism(machine.translated(kinematic=kinematic, channel=channel))
        check_closure(mechanism)
        chain = mechanism.chain
        collector.findings.extend(chain.findings)
        return chain
    except UnsupportedKinematicError as error:
        if kinematic is None:
            collector.add_error(error)
        else:
            collector.add("CB223", error.message, span=error.span)
    except ConventionError as error:
        if kinematic is None:
            collector.add_error(error)
        else:
            collector.add("CB223", error.message, span=error.span, hint=error.hint, parameter=error.parameter)
    except ChainbuildError as error:
        collector.add_error(error)
    return None


def _read(
    path: str | os.PathLike[str], overlay: str | os.PathLike[str] | None, collector: Collector, tool: str | None
) -> Machine:
    file = find_machine(path)
    source = read_source(file)
    beside = find_overlay(file, as_path(overlay) if overlay is not None else None)
    urdf = is_urdf(source.text)
    if tool is not None and not urdf:
        text = f"tool link '{tool}': {file} is no URDF, its tool is part of its data"
        hint = "a tool length is added by --tool-length, in Python tool_length_mm"
        raise ChainbuildError(text, span=Span(str(file)), parameter="tool", permitted="no tool link", hint=hint)
    # A dialect is imported when it is needed: most users have one.
    if urdf:
        from chainbuild.formats.urdf.machine import read_urdf

        return read_urdf(source, file, beside, collector, tool)
    if is_dh(source.text):
        from chainbuild.formats.dh.machine import read_dh

        return read_dh(file, beside, collector)
    if is_xml(source.text):
        refuse_other_xml(source.text, file)
    if beside.coupling:
        text = "the table is for a URDF and for DH parameters: machine data say how axes are coupled"
        raise beside.error(text, (COUPLED,), "limits of axes, sums and drives")
    # TwinCAT comes first: its container is XML, whose text could hold anything.
    if is_twincat(source.text):
        from chainbuild.formats.twincat.files import read_machine as read_twincat

        return read_twincat(source, file, beside, collector)
    if is_sinumerik(source.text):
        from chainbuild.formats.sinumerik.machine import read_machine as read_sinumerik

        return read_sinumerik(source, file, beside, collector)
    raise no_machine_data(source, file)


def find_machine(path: str | os.PathLike[str]) -> Path:
    """Return the file that a path or a shipped machine's name means; an existing path wins.

    Raises:
        FileAccessError: there is neither.
    """
    file = as_path(path)
    try:
        exists = file.exists() and bool(str(path).strip())
    except (ValueError, OSError) as error:
        raise FileAccessError(f"not a path: {error}") from None
    if exists:
        return file
    found = shipped_path(str(path))
    if found is None:
        raise _no_machine(file, str(path))
    return found


def _no_machine(file: Path, given: str) -> FileAccessError:
    """Return the error for an unknown name; where it looks like a path, shipped machines are not listed."""
    if not given.strip():
        return FileAccessError("the name of the machine file is empty", permitted="a path, or a shipped machine's name")
    if not (file.suffix or file.parent != Path()):
        known, near = listed(file.stem, shipped()), closest(file.stem, shipped())
        text, hint = "no such file, and no shipped machine of that name", f"did you mean {near}?" if near else None
        return FileAccessError(text, span=Span(given), permitted=known, hint=hint)
    if file.stem in shipped():
        return FileAccessError("no such file", span=Span(given), hint=f"the shipped machine is called {file.stem}")
    try:
        entries = sorted(entry for entry in file.parent.iterdir() if entry.is_file())
    except OSError:
        text = "no such file" if file.parent.exists() else "no such file: the folder does not exist"
        return FileAccessError(text, span=Span(given))
    near = closest(file.name, [one.name for one in entries if one.suffix == file.suffix or one.stem == file.stem])
    hint = f"did you mean {file.parent / near}?" if near else None
    return FileAccessError("no such file", span=Span(given), hint=hint)


def find_overlay(machine_file: Path, named: Path | None = None) -> Overlay:
    """Return the overlay named, else the one beside the machine file, else an empty one."""
    if named is not None:
        return read_overlay(named)
    beside = overlay_path(machine_file)
    try:
        present = beside.is_file()
    except OSError as error:
        raise FileAccessError(f"cannot look for the overlay: {error}", span=Span(str(beside))) from None
    return read_overlay(beside) if present else Overlay()
