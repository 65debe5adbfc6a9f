"""Conventions: what the manuals leave open, each with a default, its choices and how to verify it."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import resources
from typing import Literal

from chainbuild.closest import listed
from chainbuild.errors import ConventionError, Span
from chainbuild.shown import two_lines


@dataclass(frozen=True, slots=True)
class Convention:
    """One open point of a manual.

    Attributes:
        name: Key for ``--convention name=choice``.
        applies: Kinematics it concerns: "ROBX", "KIN 59", … .
        mark: "I" inferred from strong evidence, "?" open.
        default: The choice taken when none is named; empty: nothing speaks for one, and the user must choose.
        choices: Choice → exact geometric meaning.
        question: What is open.
        why: Why the default is the default, or why there is none.
        verify: What to look at on the controller to decide it.
        source: Manual section.
        poses: Whether a choice can change a pose, so that recorded poses can decide it.
    """

    name: str
    applies: tuple[str, ...]
    mark: Literal["I", "?"]
    default: str
    choices: Mapping[str, str]
    question: str
    why: str
    verify: str
    source: str
    poses: bool = True

    def __repr__(self) -> str:
        choices = " | ".join(f"{choice} (default)" if choice == self.default else choice for choice in self.choices)
        return two_lines(f"<Convention {self.name}: {choices}; {', '.join(self.applies)}>")


@dataclass(frozen=True, slots=True)
class UsedConvention:
    """A convention that shaped a chain, with the choice taken and who took it."""

    convention: Convention
    choice: str
    by_user: bool

    def __repr__(self) -> str:
        who = "chosen" if self.by_user else "default"
        return two_lines(f"<UsedConvention {self.convention.name}={self.choice} ({who})>")


@cache
def conventions() -> Mapping[str, Convention]:
    """Return the register of all conventions by name."""
    register: dict[str, Convention] = {}
    folder = resources.files("chainbuild").joinpath("data")
    for entry in sorted(folder.iterdir(), key=lambda item: item.name):
        if not (entry.name.startswith("conventions_") and entry.name.endswith(".toml")):
            continue
        for name, row in tomllib.loads(entry.read_text("utf-8")).items():
            if name in register:
                raise ConventionError(f"convention {name} is defined twice")
            row["applies"] = tuple(row["applies"])
            register[name] = Convention(name=name, **row)
    return register


def check_choice(name: str, choice: str, span: Span | None = None) -> None:
    """Refuse an unknown convention or choice, also one that is not a string.

    Raises:
        ConventionError: with the list of known names.
    """
    if not isinstance(name, str) or not isinstance(choice, str):
        text = f"convention {name!r} with choice {choice!r}: both must be strings"
        raise ConventionError(text, span=span, permitted="name: choice")
    known = conventions().get(name)
    if known is None:
        raise ConventionError(f"unknown convention '{name}'", span=span, permitted=listed(name, sorted(conventions())))
    if choice not in known.choices:
        raise ConventionError(
            f"convention {name} has no choice '{choice}'",
            span=span,
            parameter=name,
            permitted=listed(choice, list(known.choices)),
        )


@dataclass(slots=True)
class Choices:
    """The user's choices while a chain is built; remembers which conventions were used.

    Attributes:
        chosen: Convention name → choice named by the user; the others take their defaults.
    """

    chosen: Mapping[str, str] = field(default_factory=dict)
    _used: dict[str, UsedConvention] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name, choice in self.chosen.items():
            check_choice(name, choice)

    def __getitem__(self, name: str) -> str:
        """Return the choice in force and note that it shapes the chain.

        Raises:
            ConventionError: nothing is chosen, and there is no default.
        """
        convention = conventions()[name]
        choice = self.chosen.get(name, convention.default)
        if not choice:
            raise _unchosen(convention)
        self._used[name] = UsedConvention(convention, choice, name in self.chosen)
        return choice

    def sign(self, name: str) -> int:
        """Return +1 for the choice `plus`, -1 for `minus`."""
        return 1 if self[name] == "plus" else -1

    def used(self) -> tuple[UsedConvention, ...]:
        """Return the conventions used so far, in the order of their names."""
        return tuple(self._used[name] for name in sorted(self._used))

    def unused(self) -> tuple[str, ...]:
        """Return the names the user chose that the chain did not need."""
        return tuple(sorted(set(self.chosen) - set(self._used)))


def _unchosen(convention: Convention) -> ConventionError:
    name = convention.name
    meanings = "; ".join(f"{choice}: {meaning}" for choice, meaning in convention.choices.items())
    first = next(iter(convention.choices))
    return ConventionError(
        f"convention {name} must be chosen, it has no default. {convention.question} {meanings}",
        parameter=name,
        permitted=", ".join(convention.choices),
        hint=f'choose by --convention {name}={first}, or in the overlay: [conventions] {name} = "{first}"',
        code="CB438",
    )


def applying_to(kinematics: Iterable[str]) -> tuple[Convention, ...]:
    """Return the conventions that concern any of the named kinematics ("ROBX", "KIN 59", …)."""
    wanted = set(kinematics)
    return tuple(c for c in conventions().values() if wanted & set(c.applies))
