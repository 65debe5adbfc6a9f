"""Options that commands share, and the machine, chain and robot they select."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, Literal

from cyclopts import Parameter, Token

from chainbuild.cli.show import STDOUT
from chainbuild.errors import ChainbuildError, FileAccessError, Span
from chainbuild.files import place_of
from chainbuild.findings import Findings, once, still_true

if TYPE_CHECKING:
    from chainbuild.chain.elements import Chain
    from chainbuild.comparison.convention_trials import Selection
    from chainbuild.formats.machine import Machine
    from chainbuild.painting.overlay.measures import Dimension
    from chainbuild.robot import Robot

# Exit code of a verdict against the user: rows failed, poses differ or bodies collide.
REJECTED: Final = 3

# Parameters that name a file to write, and those that name a folder to write to, of any command.
_OUTPUTS: Final = frozenset({"output_file", "export", "html", "picture"})
_FOLDERS: Final = frozenset({"folder", "srdf"})
_STDIN: Final = "-"  # of a table to read
_TABLES: Final = frozenset({"--axes", "--poses", "--start", "--recording"})

# Parameters that name a table to read, and what such a file is called.
_READ_TABLES: Final = frozenset({"axes", "poses", "start", "recording"})
TABLES: Final = frozenset({".csv", ".tsv", ".txt"})


def _whole(_hint: object, tokens: Sequence[Token]) -> int:
    """Return a whole number, also where it is written as 1e5 or 9.0; the parser alone would cut off 9.7."""
    text = tokens[0].value
    with suppress(ValueError):
        return int(text)  # of any size, where a float would round
    with suppress(ValueError):
        if (value := float(text)).is_integer():
            return int(value)
    raise ValueError  # without words: the parser then says which value it is


# Whole numbers on the command line.
Whole = Annotated[int, Parameter(converter=_whole)]
Json = Annotated[bool, Parameter(negative="")]
BetweenRows = Literal["ptp", "cp", "rows"]
Output = Annotated[Path | None, Parameter(name=["--output", "-o"])]


class UsageError(Exception):
    """A wrong command line that the parser accepts."""


class ShownError(Exception):
    """An error that ends a command whose JSON tells it already.

    Args:
        error: The error.
    """

    def __init__(self, error: ChainbuildError) -> None:
        super().__init__(str(error))
        self.error = error


@Parameter(name="*", group="Machine")
@dataclass(frozen=True, slots=True)
class MachineOptions:
    """Which kinematic of a machine file to build, with which tool and conventions.

    Attributes:
        kinematic: Configured id or name of the kinematic; for ROBX the number of the transformation; 9,58 chooses two
            transformation steps, the first next to the machine. Default: the file's default.
        channel: Channel of the kinematic. Default: the first that has one.
        tool_length: Length in mm that is added to the active tool's length.
        convention: NAME=CHOICE: decides a point that the manuals leave open; may be repeated. `chainbuild info` lists
            those of a machine.
        overlay: Overlay file (TOML), instead of NAME.chainbuild.toml next to the machine file.
        tool: URDF: link whose frame is the tool. Default: the only link without children.
    """

    kinematic: str | None = None
    channel: Whole | None = None
    tool_length: float = 0.0
    convention: Annotated[tuple[str, ...], Parameter(negative="", show_default=False)] = ()
    overlay: Path | None = None
    tool: str | None = None

    @property
    def selects(self) -> bool:
        """Whether any option is given that is not for reading the file: except overlay and tool link."""
        return self != MachineOptions(overlay=self.overlay, tool=self.tool)

    def choices(self) -> dict[str, str]:
        """Return the conventions chosen.

        Raises:
            UsageError: an option that is not NAME=CHOICE.
        """
        chosen = {}
        for text in self.convention:
            name, equals, choice = text.partition("=")
            if not (name and equals and choice):
                raise UsageError(f"--convention {text}: expected NAME=CHOICE")
            chosen[name.strip()] = choice.strip()
        return chosen

    def chosen_kinematic(self, machine: Machine) -> str | tuple[str, str] | None:
        """Return the kinematic chosen; two names with a comma between them are a pair, unless one name is spelt so.

        Raises:
            UsageError: more than two, an empty one, or another tool link than that of `tool`.
        """
        text = self.kinematic
        if self.tool is not None and text not in (None, self.tool):
            raise UsageError(
                f"--kinematic {text} and --tool {self.tool}: both name the tool link; expected one of them"
            )
        if text is None or "," not in text or text in {entry.name for entry in machine.kinematics()}:
            return text
        parts = [part.strip() for part in text.split(",")]
        if len(parts) != 2 or not all(parts):
            raise UsageError(f"--kinematic {text}: expected an id, a name, or a pair of them like 9,58")
        return parts[0], parts[1]

    def dimensions(self, machine: Machine) -> tuple[Dimension, ...]:
        """Return the lengths of the kinematic chosen, as lines in its links."""
        from chainbuild.painting.overlay.measures import dimensions

        return dimensions(machine, self.chosen_kinematic(machine), self.channel, self.tool_length, self.choices())

    def selection(self, machine: Machine) -> Selection:
        """Return which kinematic of a machine the options select."""
        from chainbuild.comparison.convention_trials import Selection

        return Selection(self.chosen_kinematic(machine), self.channel, self.tool_length)

    def machine(self, file: str) -> Machine:
        """Read a machine file or a shipped machine."""
        from chainbuild.formats.load import load

        self.choices()
        return load(file, overlay=self.overlay, tool=self.tool)

    def chain(self, machine: Machine) -> Chain:
        """Translate the kinematic that the options select."""
        return machine.chain(self.chosen_kinematic(machine), self.channel, self.tool_length, self.choices())

    def robot(self, file: str) -> Robot:
        """Read a machine file and build the robot; warnings are announced on stderr."""
        return self.built(file)[1]

    def built(self, file: str) -> tuple[Machine, Robot]:
        """Read a machine file and build the robot, as `robot` does, and return both."""
        from chainbuild.robot import Robot

        machine = self.machine(file)
        robot = Robot(self.chain(machine))
        self.announce(file, machine, robot.chain)
        return machine, robot

    def announce(self, file: str, machine: Machine, chain: Chain) -> None:
        """Print on stderr what was chosen among several, which options have no effect, and the number of warnings."""
        from chainbuild.cli.show import announce, note

        used = [one.convention.name for one in chain.conventions]
        for name in self.choices():
            if name not in used:
                note(f"--convention {name} has no effect: {chain.kinematic} uses {', '.join(used) or 'none'}")
        announce(all_findings(machine, chain), f"chainbuild check {shlex.join([file, *self.words()])}")

    def words(self) -> list[str]:
        """Return the options as words of a command line."""
        words = [] if self.kinematic is None else ["--kinematic", self.kinematic]
        words += [] if self.channel is None else ["--channel", str(self.channel)]
        words += ["--tool-length", f"{self.tool_length:g}"] if self.tool_length else []
        words += [word for choice in self.convention for word in ("--convention", choice)]
        words += [] if self.tool is None else ["--tool", self.tool]
        return words + ([] if self.overlay is None else ["--overlay", str(self.overlay)])


DEFAULT_OPTIONS = MachineOptions()


def held_axes(robot: Robot) -> dict[str, int]:
    """Return the axes that inverse kinematics does not move: name → index of the axis."""
    return {axis.name: n for n, axis in enumerate(robot.axes) if axis.held}


def all_findings(machine: Machine, chain: Chain | None, refusal: ChainbuildError | None = None) -> Findings:
    """Return the findings of reading and of translation, each once, in order, without what the refusal says, too."""
    if chain is None:
        return once(machine.findings, refusal)
    chosen = [used.convention.name for used in chain.conventions if used.by_user]
    return once((*still_true(machine.findings, chosen), *chain.findings), refusal)


def with_standard_output(words: Sequence[str]) -> list[str]:
    """Return the words of a command line with `--output=-` for `-o -`, which the parser takes for an option.

    >>> with_standard_output(["fk", "arm.lis", "--at", "0,0", "-o", "-"])
    ['fk', 'arm.lis', '--at', '0,0', '--output=-']
    """
    found: list[str] = []
    for word in words:
        if word == "-" and found and found[-1] in ("-o", "--output"):
            found[-1] = "--output=-"
        else:
            found.append(word)
    return found


def with_standard_input(words: Sequence[str]) -> list[str]:
    """Return the words of a command line with `--axes=-` for `--axes -`, which the parser takes for an option.

    >>> with_standard_input(["fk", "arm.lis", "--axes", "-"])
    ['fk', 'arm.lis', '--axes=-']
    """
    found: list[str] = []
    for word in words:
        if word == _STDIN and found and found[-1] in _TABLES:
            found[-1] = f"{found[-1]}={word}"
        else:
            found.append(word)
    return found


def refuse_overwriting(arguments: Mapping[str, object]) -> None:
    """Refuse a command line that would write over a file it reads, or write two results to one file.

    Args:
        arguments: The values of a command's parameters by name; options in dataclasses are found there.

    Raises:
        UsageError: an output is also the machine file, its overlay or a table to read, or another output; or several
            tables come from standard input.
    """
    if sum(name not in _OUTPUTS | _FOLDERS and str(path) == _STDIN for name, path in _named_files(arguments)) > 1:
        raise UsageError("- is standard input, which holds one table: give the others as files")
    used = {place_of(path): f"{path} is also the input" for path in input_files(arguments)}
    for name, path in _named_files(arguments):
        if name not in _OUTPUTS or (path.exists() and not path.is_file()):
            continue
        place = place_of(path)
        if place in used:
            option = "output" if name == "output_file" else name
            raise UsageError(f"--{option} {path}: {used[place]}; expected another file, nothing was written")
        used[place] = f"{path} is also another output"


def refuse_places(arguments: Mapping[str, object]) -> None:
    """Refuse outputs that could not be written, before anything is computed, and values in place of a table.

    Args:
        arguments: The values of a command's parameters by name.

    Raises:
        UsageError: a picture that is no SVG, or numbers where a table is expected.
        FileAccessError: a file that is a folder or has none, or a folder that is a file.
    """
    for name, path in _named_files(arguments):
        if name in _FOLDERS:
            found = next((one for one in (path, *path.parents) if one.exists()), None)
            if found is not None and not found.is_dir():
                hint = "expected a folder, or a name that is free"
                raise FileAccessError("the folder cannot be created: this is a file", span=Span(str(found)), hint=hint)
        elif name in _OUTPUTS and path != STDOUT:
            if path.is_dir():
                hint = f"expected a file, such as {path / 'NAME'}"
                raise FileAccessError("the file cannot be written: this is a folder", span=Span(str(path)), hint=hint)
            if not path.parent.is_dir():
                text = f"the file cannot be written: there is no folder {path.parent}"
                raise FileAccessError(text, span=Span(str(path)), hint="make it first")
            if name == "picture" and path.suffix.lower() not in ("", ".svg"):
                raise UsageError(f"--picture {path}: expected NAME.svg: the picture is written as SVG")
        elif name in _READ_TABLES and _numbers_alone(str(path)) and not path.exists():
            instead = f"; axis values are given with --at {path}" if name == "axes" else ""
            raise UsageError(f"--{name} {path}: expected a CSV table{instead}")


def _numbers_alone(text: str) -> bool:
    try:
        return len([float(word) for word in text.split(",")]) > 1
    except ValueError:
        return False


def input_files(arguments: Mapping[str, object]) -> tuple[Path, ...]:
    """Return the files that a command reads: those of its options, and those that an overlay names."""
    named = _named_files(arguments)
    return tuple(path for name, path in named if name not in _OUTPUTS | _FOLDERS and str(path) != _STDIN)


def _named_files(arguments: Mapping[str, object]) -> Iterator[tuple[str, Path]]:
    """Yield parameter names and files; those that a file names in turn have its parameter's name."""
    for name, value in arguments.items():
        if isinstance(value, Path):
            files: Iterable[Path] = _with_named(value) if name == "overlay" else (value,)
            yield from ((name, path) for path in files)
        elif name == "file" and isinstance(value, str):
            yield from ((name, path) for path in _machine_files(value))
        elif name == "solver" and isinstance(value, str) and ":" in value:
            yield name, Path(value.partition(":")[0].replace(".", "/") + ".py")
        elif is_dataclass(value) and not isinstance(value, type):
            yield from _named_files({field.name: getattr(value, field.name) for field in fields(value)})


def _machine_files(file: str) -> Iterator[Path]:
    """Yield a machine file and what is read with it; whether it exists is told when it is read."""
    from chainbuild.formats.load import find_machine
    from chainbuild.formats.overlay import overlay_path

    with suppress(ChainbuildError):
        path = find_machine(file)
        yield path
        if path.is_file():
            yield from _with_named(overlay_path(path))


def _with_named(overlay: Path) -> Iterator[Path]:
    """Yield an overlay and the files it names; what is wrong with it is told when it is read."""
    from chainbuild.formats.overlay import read_overlay

    yield overlay
    with suppress(ChainbuildError):
        found = read_overlay(overlay)
        yield from found.axis_lists
        yield from (shape.file for shapes in found.geometry.shapes.values() for shape in shapes if shape.file)
