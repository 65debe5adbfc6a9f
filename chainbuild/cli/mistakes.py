"""Wrong command lines: what is wrong, and what would have been right."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Final

from cyclopts import App, CycloptsError, MissingArgumentError, UnknownOptionError, UnusedCliTokensError
from cyclopts.exceptions import UnknownCommandError

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
_TABLES: Final = frozenset({".csv", ".tsv", ".txt"})


def usage_text(error: CycloptsError, words: Sequence[str], app: App) -> str:
    """Return what is wrong with a command line and how to go on, on one line.

    Args:
        error: What the parser says.
        words: The command line.
        app: The application, for the names of its commands and options.
    """
    commands = [name for name in app if not name.startswith("-")]
    command = words[0] if words and words[0] in commands else ""
    if isinstance(error, UnknownCommandError):
        return _unknown_command(words, commands)
    if isinstance(error, UnusedCliTokensError) and error.unused_tokens:
        return f"unexpected argument {shlex.join(error.unused_tokens)}{_belongs(error.unused_tokens, command)}"
    text = str(error)
    if isinstance(error, MissingArgumentError):
        return text.removesuffix(".") + _what_is_expected(error, app, command)
    if isinstance(error, UnknownOptionError) and "Did you mean" not in text and command:
        return f"{text.removesuffix('.')}{_meant(words, command)}; permitted: {', '.join(_options(app, command))}"
    return text


def _unknown_command(words: Sequence[str], commands: Sequence[str]) -> str:
    word = next((one for one in words if not one.startswith("-")), words[0])
    head = f'Unknown command "{word}"'
    if word in shipped() or Path(word).exists():
        later = next((one for one in words if one in commands), None)
        rest = [one for one in words if one not in (word, later)] if later else []
        return f"{head}: the command comes before the machine: chainbuild {shlex.join([later or 'info', word, *rest])}"
    near = _CALLED_OTHERWISE.get(word.lower()) or closest(word, commands)
    meant = f'. Did you mean "chainbuild {near}"?' if near else "."
    return f"{head}{meant} Commands: {', '.join(commands)}"


def _belongs(tokens: Sequence[str], command: str) -> str:
    """Return where surplus words belong, as far as they tell."""
    if all(_is_number(word) for word in tokens):
        return "; write several values as one word with commas and no spaces: 0,-90,90"
    first = tokens[0]
    values, table, path = _OPERANDS.get(command, ("", "", ""))
    if values and all(map(_is_number, first.split(","))):
        return f"; did you mean {values} {shlex.quote(first)}?"
    if table and Path(first).suffix.lower() in _TABLES:
        return f"; did you mean {table} {shlex.quote(first)}?"
    if first in shipped():
        return "; expected one machine"
    return f"; did you mean {path} {shlex.quote(first)}?" if path else ""


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


def _meant(words: Sequence[str], command: str) -> str:
    """Return what is used instead of an option that other commands have."""
    if "--json" in words and command in ("fk", "ik", "as-universal"):
        return ": the output is text for programs already"
    path = _OPERANDS.get(command, ("", "", ""))[2]
    given = any(word.partition("=")[0] in ("-o", "--output", "--export", "--picture") for word in words)
    return f" (did you mean {path}?)" if path and given else ""


def _options(app: App, command: str) -> Iterable[str]:
    """Return the options of a command."""
    for argument in app[command].assemble_argument_collection():
        if argument.name.startswith("--"):
            yield argument.name
