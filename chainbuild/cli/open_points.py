"""Conventions as paragraphs: open point, choice, alternatives, how to verify."""

from __future__ import annotations

from rich.console import Console
from rich.padding import Padding

from chainbuild.convention import Convention


def print_convention(out: Console, convention: Convention, choice: str, remark: str) -> None:
    """Print one convention.

    Args:
        out: The console.
        convention: The convention.
        choice: The choice in force.
        remark: Origin of the choice: "default" or "chosen".
    """
    out.print(f"{convention.name}={choice} [{convention.mark}] ({remark})", style="bold")
    others = [f"or {name}: {meaning}" for name, meaning in convention.choices.items() if name != choice]
    for text in (convention.choices[choice], *others, f"To verify: {convention.verify}"):
        out.print(Padding(text, (0, 0, 0, 4)))
