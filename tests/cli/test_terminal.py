"""What reaches a terminal: escape sequences where they are wanted, bars while something takes long; else neither."""

from __future__ import annotations

import io
import sys
import time
from collections.abc import Callable

import pytest

from chainbuild import progress
from chainbuild.cli import entry, main
from chainbuild.cli.show import console, empty_table
from chainbuild.progress import above_bars, bars_shown, counting, without_bars, working

ESCAPE = "\x1b"
AT = "0,-90,90,0,30,0"
COMMANDS = sorted(name for name in entry.build_app() if not name.startswith("-"))
PRINTING = [
    [],
    ["nope"],
    ["info", "kr6r900"],
    ["info", "missing"],
    ["check", "kr6r900"],
    ["types"],
    ["types", "9"],
    ["fk", "kr6r900", "--at", AT],
    ["fk", "kr6r900"],
    ["couple", "robot_xy_unit_kin210", "--tcp", "X=700"],
    ["collide", "kr6r900", "--at", AT],
    ["singularity", "kr6r900", "--at", AT],
    ["limits", "kr6r900", "--axis", "A3", "--over", "A2", "--steps", "2"],
]


class Terminal(io.StringIO):
    """A stream that says that it is a terminal."""

    encoding = "utf-8"

    def isatty(self) -> bool:
        return True


@pytest.fixture
def on_terminal(monkeypatch: pytest.MonkeyPatch) -> Callable[..., str]:
    """Return a function that runs a command on a terminal and returns all that is shown there."""
    for name in ("NO_COLOR", "FORCE_COLOR", "TTY_COMPATIBLE"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.setenv("COLUMNS", "100")

    def call(*words: str, stream: io.StringIO | None = None) -> str:
        shown = stream or Terminal()
        monkeypatch.setattr(sys, "stdout", shown)
        monkeypatch.setattr(sys, "stderr", shown)
        main(list(words))
        return shown.getvalue()

    return call


def test_no_color_is_heeded_by_every_command_help_and_error(
    on_terminal: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    for words in [*PRINTING, *([name, "--help"] for name in COMMANDS), ["--help"], ["--version"]]:
        assert ESCAPE not in on_terminal(*words), words


@pytest.mark.parametrize("variables", [{"NO_COLOR": "1", "FORCE_COLOR": "1"}, {"TERM": "dumb"}])
def test_no_color_wins_and_a_dumb_terminal_gets_none(
    on_terminal: Callable[..., str], variables: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    for words in (["info", "kr6r900"], ["fk", "--help"], ["nope"]):
        assert ESCAPE not in on_terminal(*words), words


def test_a_terminal_has_styles_and_a_file_has_none(on_terminal: Callable[..., str]) -> None:
    assert ESCAPE in on_terminal("info", "kr6r900")
    assert ESCAPE in on_terminal("info", "--help")
    for words in PRINTING:
        assert ESCAPE not in on_terminal(*words, stream=io.StringIO()), words


def test_force_color_is_for_people_and_not_for_programs(
    on_terminal: Callable[..., str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert ESCAPE in on_terminal("info", "kr6r900", stream=io.StringIO())
    assert ESCAPE in on_terminal("--help", stream=io.StringIO())
    for words in (["info", "kr6r900", "--json"], ["fk", "kr6r900", "--at", AT], ["urdf", "kr6r900"]):
        assert ESCAPE not in on_terminal(*words, stream=io.StringIO()), words
    for value in ("", "0", "false", "no"):
        monkeypatch.setenv("FORCE_COLOR", value)
        assert ESCAPE not in on_terminal("info", "kr6r900", stream=io.StringIO()), value


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> Callable[[], Terminal]:
    """Return a function that makes standard error a terminal on which bars are drawn without delay."""

    def call() -> Terminal:
        shown = Terminal()
        monkeypatch.setattr(sys, "stderr", shown)
        monkeypatch.setenv("TERM", "xterm")
        for name in ("_UNSEEN_S", "_WAIT_S", "_REDRAW_S"):
            monkeypatch.setattr(progress, name, 0.001)
        return shown

    return call


def drawn(shown: io.StringIO, text: str) -> bool:
    """Wait until a text is drawn."""
    return drawn_later(shown, text, 0)


def drawn_later(shown: io.StringIO, text: str, at: int) -> bool:
    """Wait until a text is drawn behind a place in what was drawn."""
    end = time.monotonic() + 10.0
    while text not in shown.getvalue()[at:] and time.monotonic() < end:
        time.sleep(0.001)
    return text in shown.getvalue()[at:]


def screen(text: str) -> str:
    """Return what stands on a terminal after a text."""
    lines = [""]
    for part in text.splitlines(keepends=True):
        for word in part.rstrip("\n").split("\r"):
            lines[-1] = word + lines[-1][len(word) :]
        if part.endswith("\n"):
            lines.append("")
    return "\n".join(line.rstrip() for line in lines)


def test_a_bar_counts_and_leaves_nothing(opened: Callable[[], Terminal]) -> None:
    terminal = opened()
    with counting(4, True, "rows") as advance:
        assert drawn(terminal, f"rows {'─' * 30}   0% 0:00")
        advance(1)
        assert drawn(terminal, f"rows {'━' * 7}{'─' * 23}  25% 0:00, 0:00 left")
        advance(3)
        assert drawn(terminal, f"rows {'━' * 30} 100% 0:00")
    assert screen(terminal.getvalue()) == ""
    assert ESCAPE not in terminal.getvalue()


def test_what_is_printed_meanwhile_stands_on_a_line_of_its_own(opened: Callable[[], Terminal]) -> None:
    terminal = opened()
    with working("export"):
        assert drawn(terminal, "export ━")
        with above_bars():
            print("a note", file=sys.stderr)
        at = len(terminal.getvalue())
        assert drawn_later(terminal, "export", at)
    assert screen(terminal.getvalue()) == "a note\n"


def test_the_innermost_bar_is_drawn_and_none_over_a_table(opened: Callable[[], Terminal]) -> None:
    terminal = opened()
    with working("outer"):
        assert drawn(terminal, "outer")
        with counting(2, True, "inner"):
            assert drawn(terminal, "inner")
            at = len(terminal.getvalue())
            time.sleep(0.01)
            assert "outer" not in terminal.getvalue()[at:]
        with without_bars():
            at = len(terminal.getvalue())
            time.sleep(0.01)
            assert terminal.getvalue()[at:] == ""
    assert screen(terminal.getvalue()) == ""


def test_a_bar_ends_with_an_interrupt(opened: Callable[[], Terminal]) -> None:
    terminal = opened()
    with pytest.raises(KeyboardInterrupt), counting(2, True, "rows"):
        assert drawn(terminal, "rows")
        raise KeyboardInterrupt
    assert screen(terminal.getvalue()) == ""


def test_a_bar_fits_any_terminal(opened: Callable[[], Terminal], monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = opened()
    monkeypatch.setattr(progress, "_columns", lambda: 12)
    monkeypatch.setattr(Terminal, "encoding", "latin-1")
    with counting(2, True, "positions"):
        assert drawn(terminal, "positions -")
    assert max(len(word) for word in terminal.getvalue().split("\r")) == 11


def test_long_times_are_hours(opened: Callable[[], Terminal]) -> None:
    opened()
    bar = progress._Bar("map", 4, 0, 0.0)
    bar.advance(1)
    assert bar.text(4000.0).endswith(" 25% 1:06:40, 3:20:00 left")


def test_no_bar_where_a_terminal_cannot_show_it(
    opened: Callable[[], Terminal], monkeypatch: pytest.MonkeyPatch
) -> None:
    opened()
    assert bars_shown()
    monkeypatch.setenv("NO_COLOR", "1")
    assert bars_shown()  # it is plain text
    monkeypatch.setenv("TERM", "dumb")
    assert not bars_shown()
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    monkeypatch.setenv("TERM", "xterm")
    assert not bars_shown()


def test_a_bar_that_was_asked_for_stays_out_of_files_and_comes_into_cells(
    opened: Callable[[], Terminal], monkeypatch: pytest.MonkeyPatch
) -> None:
    opened()
    log = io.StringIO()
    monkeypatch.setattr(sys, "stderr", log)
    with counting(2, True, "rows") as advance:
        time.sleep(0.02)
        advance(2)
    assert log.getvalue() == ""
    cell = type("OutStream", (io.StringIO,), {"__module__": "ipykernel.iostream"})()
    monkeypatch.setattr(sys, "stderr", cell)
    with counting(2, True, "rows"):
        assert drawn(cell, "rows")


def test_a_table_on_the_console_wipes_the_bar(opened: Callable[[], Terminal]) -> None:
    terminal = opened()
    with working("export"):
        assert drawn(terminal, "export")
        table = empty_table("Title", "A")
        console(terminal).print(table)
    assert "export" not in screen(terminal.getvalue()).replace(ESCAPE, "")
