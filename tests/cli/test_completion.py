"""Completion in the shell: commands, options, choices, files and the names of shipped machines."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from chainbuild.cli import entry
from chainbuild.cli.completion import completion_script
from chainbuild.machines import shipped
from tests.kit.command_line import Run, write

WITHOUT_FILE = {"types", "warm", "completion"}
COMMANDS = [name for name in entry.build_app() if not name.startswith("-")]


def completed(*lines: str) -> list[set[str]]:
    """Return what bash offers at the end of each line, in this folder."""
    script = completion_script(entry.build_app(), "bash")
    ask = 'try() { COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=(); _chainbuild; echo "${COMPREPLY[*]}"; }'
    text = "\n".join([script, ask, *(f"try {line}" for line in lines)])
    done = subprocess.run(["bash", "-c", text], capture_output=True, text=True, check=True)
    return [set(line.split()) for line in done.stdout.splitlines()]


def test_bash_completes_what_can_be_typed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("arm.tea", "kr6_cell.tea", "axes.csv"):
        write(name, "")
    found = completed(
        "chainbuild in",
        "chainbuild info kr6",
        "chainbuild fk kr6r900 --a",
        "chainbuild fk kr6r900 --axes ax",
        "chainbuild workspace kr6r900 --section x",
        "chainbuild types kr6",
        "chainbuild completion ''",
        "chainbuild check ar",
    )
    assert found == [
        {"info", "inspect"},
        {"kr6r900", "kr6r900_2", "kr6_cell.tea"},
        {"--axes", "--at", "--angles"},
        {"axes.csv"},
        {"xz", "xy"},
        set(),
        {"bash", "zsh", "fish"},
        {"arm.tea", "arm_nn", "arm_nr5", "arm_rr"},
    ]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_every_command_that_reads_a_machine_completes_it(run: Run, shell: str) -> None:
    script = run("completion", shell).out
    reading = [name for name in COMMANDS if name not in WITHOUT_FILE]
    count = {
        "bash": script.count(f'compgen -W "{" ".join(shipped())}" -f'),
        "zsh": script.count("'1:machine:_chainbuild_machines'"),
        "fish": sum(
            f"'__fish_chainbuild_using_command {name}' -a '{' '.join(shipped())}'" in script for name in reading
        ),
    }
    assert count[shell] == len(reading)
    assert all(name in script for name in COMMANDS)
    if shell == "zsh":
        assert script.startswith("#compdef chainbuild\n")
        assert f"({' '.join(shipped())})' 'files:machine file:_files'" in script


def test_the_script_is_installed_where_the_shell_looks(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    for name in ("ZSH", "ZSH_CUSTOM"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("SHELL", "/usr/bin/fish")
    fish = tmp_path / ".config/fish/completions/chainbuild.fish"
    installed = run("completion", "--install")
    assert (installed.code, installed.out, installed.err) == (0, f"{fish}\n", "new shells complete chainbuild\n")
    assert fish.read_text("utf-8") == run("completion", "fish").out
    for _ in range(2):
        assert run("completion", "bash", "--install").code == 0
    assert (tmp_path / ".bashrc").read_text("utf-8").count(".local/share/bash-completion/completions/chainbuild") == 2


def test_a_script_that_cannot_be_installed_is_printed_instead(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write("home", "")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    outcome = run("completion", "fish", "--install")
    assert (outcome.code, outcome.out) == (1, "")
    assert outcome.err.endswith("; print it instead: chainbuild completion fish\n")
    assert len(outcome.err.splitlines()) == 1


@pytest.mark.parametrize(("shell", "told"), [("/bin/tcsh", "$SHELL is tcsh"), ("", "$SHELL is not set")])
def test_an_unknown_shell_is_told_with_those_known(
    run: Run, shell: str, told: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SHELL", shell)
    outcome = run("completion")
    assert outcome.code == 2
    assert f"{told}: expected the name of the shell: bash, zsh, fish" in outcome.err
