"""Wrong command lines: what is wrong, and what would have been right."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Final, get_args

from cyclopts import (
    App,
    CoercionError,
    CycloptsError,
    MissingArgumentError,
    RepeatArgumentError,
    UnknownOptionError,
    UnusedCliTokensError,
)
from cyclopts.exceptions import UnknownCommandError

from chainbuild.cli.usage import TABLES
from chainbuild.closest import closest
from chainbuild.machines import shipped

# Commands as other tools call them.
_CALLED_OTHERWISE: Final[Mapping[str, str]] = {
    "help": "--help",
    "version": "--version",
    "validate": "check",
    "lint": "check",
    "forward": "fk",
    "inverse": "ik",
    "solve": "ik",
    "convert": "export",
    "mjcf": "export FILE --format mjcf",
    "srdf": "export FILE --format srdf",
    "report": "export FILE --format report",
    "view": "inspect",
    "show": "inspect",
    "plot": "picture",
    "draw": "picture",
    "compare": "crosscheck",
    "collision": "collide",
}
# Where the words behind the machine belong, by command; "" is any other: a value, a table, another path.
_OPERANDS: Final[Mapping[str, tuple[str, str, str]]] = {
    "fk": ("--at", "--axes", "-o"),
    "ik": ("", "--poses", "-o"),
    "inspect": ("--at", "--axes", "--export"),
    "picture": ("--at", "--axes", "-o"),
    "singularity": ("--at", "--axes", "--picture"),
    "collide": ("--at", "--axes", "--picture"),
    "crosscheck": ("", "--recording", ""),
    "workspace": ("--at", "", "-o"),
    "limits": ("--at", "", "--picture"),
    "urdf": ("", "", "-o"),
    "export": ("", "", "-o"),
    "demo": ("", "", "-o"),
    "as-universal": ("", "", "-o"),
}
_PICTURES: Final = frozenset({".svg", ".png"})
_TRUTH: Final = frozenset({"true", "false", "yes", "no", "on", "off", "1", "0"})  # what people write behind a switch
_FORMATS: Final = frozenset({"urdf", "mjcf", "srdf", "opw", "report", "all"})


def usage_text(error: CycloptsError, words: Sequence[str], app: App) -> str:
    """Return what is wrong with a command line and how to go on, on one line.

    Args:
        error: What the parser says.
        words: The command line.
        app: The application, for the names of its commands and options.
    """
    commands = [name for name in app if not name.startswith("-")]
    command = words[0] if words and words[0] in commands else ""
    text, meant = str(error), "Did you mean" in str(error)
    if isinstance(error, UnknownCommandError):
        text = _unknown_command(words, commands)
    elif isinstance(error, UnusedCliTokensError) and error.unused_tokens:
        where = next(_belongs(words, error.unused_tokens, command), "")
        text = f"unexpected argument {shlex.join(error.unused_tokens)}{where}"
    elif isinstance(error, MissingArgumentError | UnknownOptionError) and (pose := _one_pose(words, command)):
        text = text.partition(" Did you mean")[0].removesuffix(".") + pose
    elif isinstance(error, MissingArgumentError) and not meant:
        text = text.removesuffix(".") + (_file_among(words, command) or _what_is_expected(error, app, command))
    elif isinstance(error, UnknownOptionError) and command and ("-" in words or not meant):
        text = _unknown_option(text, words, app, command)
    elif isinstance(error, CoercionError) and (kind := _number_kind(error)):
        text = f"{_given(error)}: expected {kind}, without a unit"
    elif isinstance(error, RepeatArgumentError) and command == "export":
        text += " Write several as one: --format urdf,mjcf"
    return text


def _unknown_command(words: Sequence[str], commands: Sequence[str]) -> str:
    word = next((one for one in words if not one.startswith("-")), words[0])
    head = f'Unknown command "{word}"'
    if word in commands:
        rest = [one for one in words if one != word]
        return f"{head}: options stand behind the command: chainbuild {shlex.join([word, *rest])}"
    if word == "help" and len(words) > 1 and words[1] in commands:
        return f'{head}. Did you mean "chainbuild {words[1]} --help"?'
    if word in shipped() or Path(word).exists():
        later = next((one for one in words if one in commands), None)
        rest = [one for one in words if one not in (word, later)] if later else []
        return f"{head}: the command comes before the machine: chainbuild {shlex.join([later or 'info', word, *rest])}"
    near = _CALLED_OTHERWISE.get(word.lower()) or closest(word, commands)
    meant = f'. Did you mean "chainbuild {near}"?' if near else "."
    return f"{head}{meant} Commands: {', '.join(commands)}"


def _belongs(words: Sequence[str], tokens: Sequence[str], command: str) -> Iterator[str]:
    """Yield where surplus words belong, as far as they tell, the likeliest first."""
    first = tokens[0]
    before = words[words.index(first) - 1] if first in words[1:] else ""
    values, table, path = _OPERANDS.get(command, ("", "", ""))
    if first.lower() in _TRUTH and before.startswith("--"):
        yield f"; {before} takes no value"
    if values and all(map(_is_number, tokens)):
        yield "; write several values as one word with commas and no spaces: 0,-90,90"
    if values and all(map(_is_number, first.split(","))):
        yield f"; did you mean {values} {shlex.quote(first)}?"
    if table and Path(first).suffix.lower() in TABLES:
        yield f"; did you mean {table} {shlex.quote(first)}?"
    if command == "export" and first.lower() in _FORMATS:
        formats = [word for word in words if word.lower() in _FORMATS]
        yield f"; did you mean --format {','.join(dict.fromkeys(formats))}?"
    if command == "couple" and "=" in first:
        yield f"; did you mean --tcp {shlex.quote(first)}?"
    if command == "limits" and len(tokens) == 2:
        yield f"; did you mean --axis {shlex.quote(first)} --over {shlex.quote(tokens[1])}?"
    if first in shipped() and command != "warm":
        yield "; expected one machine"
    if path and (Path(first).suffix or path == "-o"):
        yield f"; did you mean {path} {shlex.quote(first)}?"


def _file_among(words: Sequence[str], command: str) -> str:
    """Return which option a table or picture belongs to that stands alone; empty: there is none."""
    _, option, path = _OPERANDS.get(command, ("", "", ""))
    suffixes = TABLES
    if command == "picture":
        option, suffixes = path, _PICTURES
    alone = [word for before, word in pairwise(words) if not before.startswith("-")]
    found = next((word for word in alone if Path(word).suffix.lower() in suffixes), None)
    return f"; did you mean {option} {shlex.quote(found)}?" if option and found and option not in words else ""


def _one_pose(words: Sequence[str], command: str) -> str:
    """Return how one pose is given where axis values are, which ik does not take; empty: they are not."""
    if command != "ik" or "--poses" in words or not any(word.partition("=")[0] == "--at" for word in words):
        return ""
    row = "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\\n500,0,800,180,60,180\\n"
    return f"; a pose is a row of a table, on an arm: printf '{row}' | chainbuild ik FILE --poses -"


def _is_number(word: str) -> bool:
    try:
        float(word.rstrip(","))
    except ValueError:
        return False
    return True


def _what_is_expected(error: MissingArgumentError, app: App, command: str) -> str:
    """Return what the parameter that has no value is for."""
    if error.argument is None or not command:
        return ""
    for known in app[command].assemble_argument_collection(parse_docstring=True):
        if known.name == error.argument.name and known.parameter.help:
            return f": {' '.join(str(known.parameter.help).split()).removesuffix('.')}"
    return ""


def _unknown_option(text: str, words: Sequence[str], app: App, command: str) -> str:
    """Return what an unknown option could mean, and all options that there are."""
    head, options = text.partition(" Did you mean")[0].removesuffix("."), list(_options(app, command))
    given = head.rpartition(": ")[2]
    path = _OPERANDS.get(command, ("", "", ""))[2]
    if given == "-":
        meant = ": standard input and output are for tables alone; a machine file is named"
    elif given == "--json" and command in ("fk", "ik", "as-universal"):
        meant = ": the output is text for programs already"
    elif path and given in ("-o", "--output", "--export", "--picture"):
        meant = f" (did you mean {path}?)"
    else:
        near = closest(given, options)
        meant = f" (did you mean {near}?)" if near else ""
    return f"{head}{meant}; permitted: {', '.join(options)}"


def _number_kind(error: CoercionError) -> str:
    """Return what kind of number was expected; empty: something else."""
    hints = {error.target_type, *get_args(error.target_type)}
    return "a whole number" if int in hints else "a number with a decimal point" if float in hints else ""


def _given(error: CoercionError) -> str:
    """Return the option or operand of a value that cannot be converted, and the value."""
    token = error.token
    if token is None:
        return str(error).removesuffix(".")
    name = token.keyword or (error.argument.name if error.argument is not None else "")
    return f"{name} {token.value}".strip()


def _options(app: App, command: str) -> Iterable[str]:
    """Return the options of a command."""
    for argument in app[command].assemble_argument_collection():
        if argument.name.startswith("--"):
            yield argument.name
