"""Machine: what a file says, typed, whichever dialect it is written in."""

from __future__ import annotations

import math
import operator
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from numbers import Real
from pathlib import Path
from typing import Final

from chainbuild import tolerances
from chainbuild.chain.elements import Chain
from chainbuild.closest import listed
from chainbuild.errors import ConventionError, MachineDataError, Span
from chainbuild.findings import Collector, Finding
from chainbuild.formats.overlay import Overlay

_ID_DIGITS: Final = 9
_HUGE_NUMBER: Final = 10**_ID_DIGITS  # beyond any id or channel


@dataclass(frozen=True, slots=True)
class KinematicEntry:
    """A kinematic that the file configures.

    Attributes:
        id: Configured id; for ROBX the transformation number.
        name: Configured name, or an empty string.
        type: "KIN_TYP 45", "ROBX NR, 6 axes" … .
        title: English title.
        channel: Channel number (SINUMERIK) or index (TwinCAT).
        default: True where `chain()` without arguments takes it.
        span: Where the file configures it.
    """

    id: int
    name: str
    type: str
    title: str
    channel: int
    default: bool
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class ParameterRow:
    """One parameter of a kinematic as `info` shows it.

    Attributes:
        name: Name in the file: "$MC_ROBX_TX3P3_POS[0]", "trafo[0].param[6]".
        symbol: Short name: "MD62908", "HD7".
        value: Value in `unit`.
        unit: "mm", "deg" or an empty string.
        meaning: What it does.
        given: True where the file gives it, False for a default.
        source: Manual section.
        span: Where the file gives it.
        si: Value in `si_unit`, for dynamics that the file counts otherwise.
        si_unit: "m/s", "rad/s", "rad/s²", or an empty string.
    """

    name: str
    symbol: str
    value: float | int | str | None
    unit: str
    meaning: str
    given: bool
    source: str
    span: Span | None = None
    si: float | None = None
    si_unit: str = ""


class Machine(ABC):
    """A machine file, read and typed.

    Attributes:
        path: The machine file.
        dialect: "SINUMERIK ROBX" or "TwinCAT CNC".
        overlay: What the file beside it adds.
    """

    dialect: str

    def __init__(self, path: Path, overlay: Overlay, collector: Collector) -> None:
        self.path = path
        self.overlay = overlay
        self._collector = collector

    def __repr__(self) -> str:
        types = list(dict.fromkeys(entry.type for entry in self.kinematics()))
        more = ["…"] if len(types) > 3 else []
        return f"<Machine {self.path.name}: {', '.join([self.dialect, *types[:3], *more])}>"

    @property
    def name(self) -> str:
        """File-system-safe name: the file's stem, only letters, digits, `_` and `-`."""
        stem = "".join(c if c.isascii() and (c.isalnum() or c in "_-") else "_" for c in self.path.stem)
        return stem if stem and not stem[0].isdigit() else f"m_{stem}"

    @property
    def title(self) -> str:
        """Display name: the overlay's, else the file's stem."""
        return self.overlay.name or self.path.stem

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Everything found so far, in order."""
        return tuple(self._collector.findings)

    @abstractmethod
    def kinematics(self) -> tuple[KinematicEntry, ...]:
        """Return the kinematics that the file configures, in file order."""

    @abstractmethod
    def parameters(self, kinematic: int | str | None = None, channel: int | None = None) -> tuple[ParameterRow, ...]:
        """Return every parameter of a kinematic with value, meaning and source."""

    @abstractmethod
    def chain(
        self,
        kinematic: int | str | None = None,
        channel: int | None = None,
        tool_length_mm: float = 0.0,
        conventions: Mapping[str, str] | None = None,
    ) -> Chain:
        """Translate a kinematic into a chain.

        Args:
            kinematic: Configured id or name; for ROBX the transformation number. None: the file's default.
            channel: Channel; None with several: the first that has a transformation, and a finding.
            tool_length_mm: Added to the active tool's length, along minus the tool vector.
            conventions: Convention name → choice; wins over the overlay.

        Raises:
            MachineDataError: the data cannot be a machine, or the kinematic or channel does not exist.
            UnsupportedKinematicError: the kinematic is not built by this version.
            ConventionError: an unknown convention or choice.
        """

    def chosen_conventions(self, conventions: Mapping[str, str] | None) -> dict[str, str]:
        """Return the user's choices: the overlay's, overridden by the argument."""
        if conventions is not None and not isinstance(conventions, Mapping):
            raise ConventionError("conventions must be a mapping of name to choice")
        return {**self.overlay.conventions, **(conventions or {})}


def finite_length_mm(value: object) -> float:
    """Return a tool length as a float; any real number is one, also numpy's and arrays without dimension.

    Raises:
        MachineDataError: not a finite number of plausible size.
    """
    if getattr(value, "ndim", None) == 0 and hasattr(value, "item"):
        value = value.item()
    wrong, length, shown = "is not a number", 0.0, ""
    if isinstance(value, Real) and not isinstance(value, bool):
        try:
            length = float(value)
        except OverflowError:
            length = tolerances.HUGE_AXIS_VALUE
        shown = f" {length:g}"
        wrong = "" if math.isfinite(length) else "is not finite"
        if not wrong and abs(length) >= tolerances.HUGE_AXIS_VALUE:
            wrong = "is too large"
    if wrong:
        raise MachineDataError(
            f"the tool length{shown or f' {value!r:.40}'} {wrong}", parameter="tool_length_mm",
            permitted=f"a number in mm, below {tolerances.HUGE_AXIS_VALUE:g} in size",
        )  # fmt: skip
    return length


def checked_kinematic(value: object) -> int | str | None:
    """Return what names a kinematic: an id, a name, or None.

    Raises:
        MachineDataError: anything else, True and "" among it.
    """
    if value is None or (isinstance(value, str) and value):
        return value
    number = _as_int(value)
    if number is None or abs(number) >= _HUGE_NUMBER:
        shown = "a huge number" if number else f"{value!r:.40}"
        raise MachineDataError(f"{shown} names no kinematic", parameter="kinematic", permitted="an id, a name or None")
    return number


def checked_channel(value: object) -> int | None:
    """Return what names a channel: a whole number or None.

    Raises:
        MachineDataError: anything else.
    """
    number = _as_int(value)
    if (number is None and value is not None) or abs(number or 0) >= _HUGE_NUMBER:
        shown = "a huge number" if number else f"{value!r:.40}"
        raise MachineDataError(f"{shown} names no channel", parameter="channel", permitted="a whole number or None")
    return number


def _as_int(value: object) -> int | None:
    """Return a whole number of any kind, numpy's among them, as int; None where it is none."""
    if value is None or isinstance(value, bool):
        return None
    try:
        return operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        return None


def blame_channel(
    error: MachineDataError, entries: Sequence[KinematicEntry], wanted: int | str | None, channel: int
) -> None:
    """Let an error on a kinematic that a channel lacks say which other channel has it."""
    matches = [e for e in entries if e.channel != channel and (wanted == e.name or matching_id([e], wanted))]
    if wanted is not None and matches:
        channels = " and ".join(dict.fromkeys(str(entry.channel) for entry in matches))
        error.message = f"channel {channel} configures no kinematic {wanted!r}"
        error.hint = f"channel {channels} has it: choose the channel, too"


def choose_kinematic(entries: Sequence[KinematicEntry], wanted: int | str | None, file: str) -> KinematicEntry:
    """Return the entry that `wanted` names by id or name; None: the one marked default.

    An id that stands for several means the one without a name, which no name could tell, else the first.

    Raises:
        MachineDataError: nothing is configured, or `wanted` is not among it.
    """
    if not entries:
        raise MachineDataError("the file configures no kinematic", span=Span(file))
    if wanted is None:
        return next((entry for entry in entries if entry.default), entries[0])
    matches = [e for e in entries if wanted == e.name] or matching_id(entries, wanted)
    if not matches:
        shown = [f"{e.id} ({e.name})" if e.name else str(e.id) for e in entries]
        known = listed(str(wanted), shown, called=[e.name or str(e.id) for e in entries])
        raise MachineDataError(
            f"the file configures no kinematic {wanted!r:.60}", span=Span(file), parameter="kinematic", permitted=known
        )
    return next((e for e in matches if not e.name), matches[0])


def matching_id(entries: Sequence[KinematicEntry], wanted: int | str | None) -> list[KinematicEntry]:
    """Return the entries with an id, given as a number or as its digits."""
    if isinstance(wanted, str):
        if not (wanted.isascii() and wanted.isdigit() and len(wanted) <= _ID_DIGITS):
            return []
        wanted = int(wanted)
    return [entry for entry in entries if entry.id == wanted]
