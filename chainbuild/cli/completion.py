"""`chainbuild completion`: what a shell needs to complete commands, options and shipped machines."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Final, Literal

from cyclopts import App, Parameter

from chainbuild.cli.show import note, say
from chainbuild.cli.usage import UsageError
from chainbuild.errors import FileAccessError, Span
from chainbuild.files import open_atomic
from chainbuild.machines import shipped

ShellName = Literal["bash", "zsh", "fish"]
_SHELLS: Final[tuple[ShellName, ...]] = ("bash", "zsh", "fish")
_FILE: Final = "FILE"
_MACHINES: Final = "_chainbuild_machines"  # the function of the zsh script that completes FILE


def completion(
    shell: ShellName | None = None,
    /,
    *,
    install: Annotated[bool, Parameter(negative="")] = False,
    app: Annotated[App | None, Parameter(parse=False)] = None,
) -> int:
    """Print the script by which a shell completes commands, options, choices, files and shipped machines.

    Example: `chainbuild completion bash`

    Example: `chainbuild completion zsh --install`

    Args:
        shell: bash, zsh or fish. Default: the one of $SHELL.
        install: Write the script where the shell looks for it, and name it in ~/.bashrc or ~/.zshrc where that is
            needed, instead of printing it.
        app: The application that is completed; not an option.
    """
    assert app is not None
    chosen = shell or _own_shell()
    script = completion_script(app, chosen)
    if install:
        _install(script, chosen)
    else:
        say(script, end="", lines=True)
    return 0


def _own_shell() -> ShellName:
    """Return the shell that the user has.

    Raises:
        UsageError: it is none that is known.
    """
    name = Path(os.environ.get("SHELL", "")).name
    for known in _SHELLS:
        if name == known:
            return known
    told = f"$SHELL is {name}" if name else "$SHELL is not set"
    raise UsageError(f"{told}: expected the name of the shell: {', '.join(_SHELLS)}")


def completion_script(app: App, shell: ShellName) -> str:
    """Return the script by which a shell completes an application; FILE is completed by paths and shipped machines."""
    script, names = app.generate_completion(shell=shell), shipped()
    reading = [name for name in app if not name.startswith("-") and _reads_machine(app[name])]
    if shell == "bash":
        return _bash(script, reading, names)
    if shell == "zsh":
        return _zsh(script, names)
    lines = [
        f"complete -c chainbuild -n '__fish_chainbuild_using_command {name}' -a '{' '.join(names)}' -d machine"
        for name in reading
    ]
    return "\n".join([script.rstrip("\n"), *lines, ""])


def _reads_machine(command: App) -> bool:
    return any(argument.name == _FILE for argument in command.assemble_argument_collection())


def _bash(script: str, reading: Sequence[str], names: Sequence[str]) -> str:
    """Return the script with paths and machines where a command has nothing else to complete."""
    nothing = re.compile(r"^( +)\*\)\n +COMPREPLY=\(\)$", re.MULTILINE)
    words = f'COMPREPLY=( $(compgen -W "{" ".join(names)}" -f -- "${{cur}}") )'
    parts = re.split(r'^(?= {8}"[\w-]+"\)$)', script, flags=re.MULTILINE)
    for n, part in enumerate(parts):
        head = re.match(r' {8}"([\w-]+)"\)', part)
        if head and head.group(1) in reading:
            parts[n] = nothing.sub(rf"\1*)\n\1  {words}", part)
    # A folder is completed with a slash, and goes on.
    return "".join(parts).replace("COMPREPLY=( $(compgen", "compopt -o filenames 2>/dev/null; COMPREPLY=( $(compgen")


def _zsh(script: str, names: Sequence[str]) -> str:
    function = (
        f"{_MACHINES}() {{\n"
        f"  _alternative 'machines:shipped machine:({' '.join(names)})' 'files:machine file:_files'\n}}\n"
    )
    script = re.sub(r"'1:(A machine file[^':]*|Build only this[^'\n]*)'", rf"'1:machine:{_MACHINES}'", script)
    head, mark, rest = script.partition("\n\n")
    return f"{head}{mark}{function}\n{rest}"


def _install(script: str, shell: ShellName) -> None:
    """Write the script where the shell looks for it.

    Raises:
        FileAccessError: it cannot be written.
    """
    from cyclopts.completion.install import add_to_rc_file, get_default_completion_path

    try:
        path = get_default_completion_path(shell, "chainbuild")
        with open_atomic(path) as stream:
            stream.write(script)
        changed = shell != "fish" and add_to_rc_file(path, "chainbuild", shell)
    except OSError as error:
        hint = f"print it instead: chainbuild completion {shell}"
        raise FileAccessError(
            f"the completion cannot be installed: {error.strerror or error}",
            span=Span(error.filename) if isinstance(error.filename, str) else None,
            hint=hint,
        ) from None
    say(path)
    if changed:
        note(f"~/.{shell}rc loads it from now on")
    note("new shells complete chainbuild")
