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
        choice: The choice in force; empty: there is no default.
        remark: Origin of the choice: "default" or "chosen".
    """
    head = f"{convention.name}={choice} [{convention.mark}] ({remark})"
    out.print(head if choice else f"{convention.name} [{convention.mark}] (no default: choose)", style="bold")
    texts = [f"or {name}: {meaning}" for name, meaning in convention.choices.items() if name != choice]
    texts[:0] = [convention.choices[choice]] if choice else [convention.question]
    for text in (*texts, f"To verify: {convention.verify}"):
        out.print(Padding(text, (0, 0, 0, 4)))
