"""Machine: what a file says, typed, whichever dialect it is written in."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from chainbuild.chain.elements import Chain
from chainbuild.errors import ConventionError, MachineDataError, Span
from chainbuild.findings import Collector, Finding
from chainbuild.overlay import Overlay


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
    """Return a tool length as a float.

    Raises:
        MachineDataError: not a finite number of plausible size.
    """
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e9:
        raise MachineDataError(
            f"the tool length {value!r} is not a finite number", parameter="tool_length_mm", permitted="a number in mm"
        )
    return float(value)


def choose_kinematic(entries: Sequence[KinematicEntry], wanted: int | str | None, file: str) -> KinematicEntry:
    """Return the entry that `wanted` names by id or name; None: the one marked default.

    Raises:
        MachineDataError: nothing is configured, or `wanted` is not among it.
    """
    if not entries:
        raise MachineDataError("the file configures no kinematic", span=Span(file))
    if wanted is None:
        return next((entry for entry in entries if entry.default), entries[0])
    matches = [e for e in entries if wanted in (e.id, e.name)]
    if not matches and isinstance(wanted, str) and wanted.isdigit():
        matches = [e for e in entries if e.id == int(wanted)]
    if not matches:
        known = ", ".join(f"{e.id} ({e.name})" if e.name else str(e.id) for e in entries)
        raise MachineDataError(
            f"the file configures no kinematic {wanted!r}", span=Span(file), parameter="kinematic", permitted=known
        )
    return matches[0]
