"""The application, and where every error ends: one message on stderr and an exit code.

Exit codes: 0 done, also with warnings; 1 input refused; 2 wrong usage; 3 rows failed, poses differ or
bodies collide; 130 interrupted; 141 the reader of the output has closed it. Other signals end the process as they do
without a handler.
"""

from __future__ import annotations

import io
import os
import re
import sys
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext, suppress
from dataclasses import dataclass
from functools import wraps
from inspect import signature
from typing import Any, Final

from cyclopts import App, CycloptsError

from chainbuild import __version__
from chainbuild.cli.as_universal import as_universal
from chainbuild.cli.check import check
from chainbuild.cli.collide import collide
from chainbuild.cli.completion import completion
from chainbuild.cli.couple import couple
from chainbuild.cli.crosscheck import crosscheck
from chainbuild.cli.demo import demo
from chainbuild.cli.export import export
from chainbuild.cli.fk import fk
from chainbuild.cli.ik import ik
from chainbuild.cli.info import info
from chainbuild.cli.inspect import inspect
from chainbuild.cli.limits import limits
from chainbuild.cli.mistakes import usage_text
from chainbuild.cli.picture import picture
from chainbuild.cli.process import INTERRUPTED, signals, standard_streams
from chainbuild.cli.show import help_console, print_json, refusal_data
from chainbuild.cli.singularity import singularity
from chainbuild.cli.types import types
from chainbuild.cli.urdf import urdf
from chainbuild.cli.usage import (
    ShownError,
    UsageError,
    input_files,
    refuse_overwriting,
    refuse_places,
    with_standard_input,
    with_standard_output,
)
from chainbuild.cli.warm import warm
from chainbuild.cli.workspace import workspace
from chainbuild.errors import ChainbuildError, OverwriteError
from chainbuild.files import printable, protected
from chainbuild.progress import above_bars, working

# Exit codes; those of signals are 128 and the number of the signal, as a shell reports them.
DONE: Final = 0
REFUSED: Final = 1
WRONG_USAGE: Final = 2
READER_GONE: Final = 141

_NO_TAB: Final = re.compile(r"[^\t]")

_COMMANDS = (
    info,
    check,
    fk,
    ik,
    couple,
    crosscheck,
    urdf,
    export,
    as_universal,
    inspect,
    picture,
    singularity,
    collide,
    limits,
    workspace,
    demo,
    types,
    warm,
)
_HELP = """Build kinematic models from CNC machine data.

Reads SINUMERIK ROBX machine data, TwinCAT CNC parameter lists, Denavit-Hartenberg tables (CSV) and URDF. FILE is a
path, or the name of a machine shipped with chainbuild. `chainbuild COMMAND --help` shows the options of a command and
an example.

Example: `chainbuild fk kr6r900 --at 0,-90,90,0,0,0`
"""
_EPILOGUE = "Exit codes: 0 done, 1 input refused, 2 wrong usage, 3 rows failed, poses differ or bodies collide."


@dataclass(slots=True)
class _Call:
    """What is known of a command line, for whoever reports its end.

    Attributes:
        command: The command, as far as it is known.
        file: Its machine file.
        json: Whether JSON is wanted.
    """

    command: str | None = None
    file: str | None = None
    json: bool = False


def build_app(call: _Call | None = None) -> App:
    """Return the command line with all its commands.

    Args:
        call: Takes what the parser finds.
    """
    app = App(
        name="chainbuild",
        help=_HELP,
        help_epilogue=_EPILOGUE,
        version=__version__,
        version_flags=["--version", "-V"],
        console=help_console(),
        result_action="return_value",
        exit_on_error=False,
        print_error=False,
        suppress_keyboard_interrupt=False,
    )
    for command in _COMMANDS:
        app.command(_guarded(command, call or _Call()))
    app.command(_completing(app))
    return app


def _completing(app: App) -> Callable[..., int]:
    """Return the command that completes an application."""

    @wraps(completion)
    def completing(*operands: Any, **options: Any) -> int:
        return completion(*operands, **options, app=app)

    return completing


def _guarded(command: Callable[..., int], call: _Call) -> Callable[..., int]:
    """Return a command that first refuses to write over what it reads, and shows that it works."""

    @wraps(command)
    def guarded(*operands: Any, **options: Any) -> int:
        arguments = signature(command).bind(*operands, **options).arguments
        call.file, call.json = arguments.get("file"), bool(arguments.get("json"))
        refuse_overwriting(arguments)
        refuse_places(arguments)
        with protected(input_files(arguments)), _waiting(command):
            return command(*operands, **options)

    return guarded


def _waiting(command: Callable[..., int]) -> AbstractContextManager[None]:
    """Return what shows on a terminal that a command works."""
    return working(f"chainbuild {_name_of(command)}") if sys.stderr.isatty() else nullcontext()


def _name_of(command: Callable[..., int]) -> str:
    """Return what a command is called on the command line."""
    return command.__name__.strip("_").replace("_", "-")


def main(tokens: Sequence[str] | None = None) -> int:
    """Run a command and return its exit code.

    Args:
        tokens: Words of the command line; None: those of the process.
    """
    words = list(sys.argv[1:] if tokens is None else tokens)
    with standard_streams(), signals():
        try:
            return _run(words)
        except KeyboardInterrupt:
            return _fail("chainbuild: interrupted", INTERRUPTED)


def _run(words: list[str]) -> int:
    _accept_any_text()
    call = _Call(_command_of(words), json="--json" in words)
    app = build_app(call)
    try:
        code = app(with_standard_output(with_standard_input(words)))
        sys.stdout.flush()
    except (CycloptsError, UsageError) as error:
        return _wrong_usage(error, words, app, call)
    except ShownError as error:
        return _fail(message_of(error.error), REFUSED)
    except ChainbuildError as error:
        return _refused(error, call, WRONG_USAGE if isinstance(error, OverwriteError) else REFUSED)
    except BrokenPipeError:
        _silence_stdout()
        return READER_GONE
    except OSError as error:
        _silence_stdout()
        return _fail(f"chainbuild: the output cannot be written: {error.strerror or error}", REFUSED)
    return code if isinstance(code, int) else DONE


def _wrong_usage(error: CycloptsError | UsageError, words: list[str], app: App, call: _Call) -> int:
    text = usage_text(error, words, app) if isinstance(error, CycloptsError) else str(error)
    text = printable(text, lines=False)
    usage = f"chainbuild {f'{call.command} ' if call.command else ''}--help shows the usage"
    told = _refused(ChainbuildError(text, hint=usage), call, WRONG_USAGE, shown=False)
    return _fail(f"chainbuild: {text}\n{usage}", told)


def _refused(error: ChainbuildError, call: _Call, code: int, *, shown: bool = True) -> int:
    """Return the exit code of an error, which is printed as JSON where that is wanted."""
    if call.json:
        with suppress(OSError):
            print_json("error", {"command": call.command, "file": call.file, **refusal_data(error, code)})
    return _fail(message_of(error), code) if shown else code


def message_of(error: ChainbuildError) -> str:
    """Return the message of an error: ``file:line: what is wrong``, with the line and a mark under the spot."""
    head = printable(str(error) if error.span else f"chainbuild: {error}", lines=False)
    line, _, mark = error.marked_line().partition("\n")
    if not mark:
        return head
    before, behind = printable(line[: len(mark) - 1]), printable(line[len(mark) - 1 :])
    return f"{head}\n{before}{behind}\n{_NO_TAB.sub(' ', before)}^"


def _command_of(words: Sequence[str]) -> str | None:
    names = {"completion", *(_name_of(command) for command in _COMMANDS)}
    return words[0] if words and words[0] in names else None


def _accept_any_text() -> None:
    """Escape characters that the locale's encoding lacks instead of failing."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _fail(message: str, code: int) -> int:
    with suppress(OSError), above_bars():
        print(printable(message), file=sys.stderr)
    return code


def _silence_stdout() -> None:
    """Redirect stdout to the null device, so that the interpreter does not fail again at exit."""
    with suppress(OSError, ValueError):
        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, sys.stdout.fileno())
        os.close(nothing)
