"""Machine: what a file says, typed, whichever dialect it is written in."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from chainbuild.chain.check import check_chain
from chainbuild.chain.elements import Chain
from chainbuild.convention import Choices
from chainbuild.errors import ChainbuildError, ConventionError, MachineDataError
from chainbuild.findings import Collector, Finding, Findings, once, refuse_errors, still_true
from chainbuild.formats.entries import (
    Datum,
    KinematicEntry,
    ParameterRow,
    Selected,
    Wanted,
    added_lengths,
    checked_channel,
    checked_kinematic,
    choose_kinematic,
    choose_pair,
    finite_length_mm,
    name_right_channel,
)
from chainbuild.formats.overlay import Overlay
from chainbuild.html import html_table
from chainbuild.shown import two_lines


@dataclass(frozen=True, slots=True)
class _Outcome:
    """Result of a translation: a chain or an error, and its findings."""

    findings: tuple[Finding, ...]
    chain: Chain | None = None
    error: ChainbuildError | None = None


class Machine(ABC):
    """A machine file, read and typed.

    A machine that `load` has read is strict: reading and translation raise the first error they find. One that is
    read leniently, as `check` does it, continues past errors where it can and keeps them in `findings`. Neither
    returns a chain if an error was found in it or in its file.

    Attributes:
        file: Name of the machine file for messages.
        path: The machine file.
        dialect: "SINUMERIK ROBX", "TwinCAT CNC", "URDF" or "Denavit-Hartenberg".
        overlay: What the file beside it adds.
    """

    dialect: str

    def __init__(self, file: str, path: Path, overlay: Overlay, collector: Collector) -> None:
        """Store what was read; the collector holds the findings of reading, which every chain starts with."""
        self.file = file
        self.path = path
        self.overlay = overlay
        self._collector = collector
        self._reading = tuple(collector.findings)
        self._refused = tuple(finding for finding in self._reading if finding.severity == "error")
        self._noted: set[Finding] = set()
        self._seen = 0  # of the collector's findings, how many are among the noted ones
        self._kept: dict[Selected, _Outcome] = {}

    def __repr__(self) -> str:
        types = list(dict.fromkeys(entry.type for entry in self.kinematics()))
        more = ["…"] if len(types) > 3 else []
        return two_lines(f"<Machine {self.path.name}: {', '.join([self.dialect, *types[:3], *more])}>")

    def _repr_html_(self) -> str:
        head = ("Kinematic", "Name", "Type", "Title", "Channel", "Default")
        rows = [(e.id, e.name, e.type, e.title, e.channel, "yes" if e.default else "") for e in self.kinematics()]
        return html_table(head, rows, f"{self.title} ({self.dialect})") + self.findings._repr_html_()

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
    def findings(self) -> Findings:
        """Everything found so far, in order."""
        return Findings(self._collector.findings)

    @abstractmethod
    def kinematics(self) -> tuple[KinematicEntry, ...]:
        """Return the kinematics that the file configures, in file order."""

    @abstractmethod
    def parameters(
        self, kinematic: int | str | tuple[int | str, int | str] | None = None, channel: int | None = None
    ) -> tuple[ParameterRow, ...]:
        """Return every parameter of a kinematic with value, meaning and source; of a pair, both steps in turn."""

    @abstractmethod
    def geometry(
        self, kinematic: int | str | tuple[int | str, int | str] | None = None, channel: int | None = None
    ) -> tuple[Datum, ...]:
        """Return the numbers that place and direct a kinematic, given or default; `tool_data` returns the tool's.

        Raises:
            MachineDataError: the kinematic or channel does not exist.
        """

    def tool_data(
        self,
        kinematic: int | str | tuple[int | str, int | str] | None = None,
        channel: int | None = None,
        *,
        tool_length_mm: float = 0.0,
    ) -> tuple[Datum, ...]:
        """Return the numbers of the active tool: those of the file and the overlay, and the length added to it.

        Without any of them the added length is there all the same: it is 0.

        Raises:
            MachineDataError: the kinematic or channel does not exist.
        """
        selected = self._select(checked_kinematic(kinematic), checked_channel(channel), Collector(strict=False))
        own = tuple(self._tool_data(selected))
        return (*own, *added_lengths(self.overlay, finite_length_mm(tool_length_mm), bool(own)))

    @abstractmethod
    def _tool_data(self, selected: Selected) -> Iterable[Datum]:
        """Return the numbers of the active tool that the file gives, and the overlay in its table `tool`."""

    @abstractmethod
    def with_values(self, values: Mapping[Datum, float]) -> Machine:
        """Return the machine with other values of some data, which keep their places in the file.

        Rules on a single value are those of reading and not asked again; rules of the geometry are, by `chain`.

        Args:
            values: Data of `geometry` and `tool_data` → new values in their units. A name for a datum is refused.
        """

    def trial_chain(
        self,
        kinematic: int | str | tuple[int | str, int | str] | None = None,
        channel: int | None = None,
        tool_length_mm: float = 0.0,
        conventions: Mapping[str, str] | None = None,
    ) -> Chain:
        """Translate a kinematic as `chain` does, but past the rules on its geometry and without bodies.

        Raises:
            ChainbuildError: nothing can be built.
        """
        collector = Collector(strict=False)
        selected = self._select(checked_kinematic(kinematic), checked_channel(channel), collector)
        choose = Choices(self.chosen_conventions(conventions))
        length_mm = finite_length_mm(tool_length_mm) + self.overlay.tool_length_mm
        return self._translate(selected, length_mm, choose, collector)

    def chain(
        self,
        kinematic: int | str | tuple[int | str, int | str] | None = None,
        channel: int | None = None,
        tool_length_mm: float = 0.0,
        conventions: Mapping[str, str] | None = None,
    ) -> Chain:
        """Translate a kinematic into a chain.

        A chain translated with the overlay's conventions and without another tool length is kept with the machine and
        returned again.

        Args:
            kinematic: Configured id or name; for ROBX the transformation number, or "gripper" for gripper-referred
                motion; of a URDF the tool link. A pair of ids or names: the transformation steps 0 (next to the
                machine) and 1, as #KIN ID[9,58] chooses them. None: the file's default.
            channel: Channel; None with several: the first that has a transformation, and a finding.
            tool_length_mm: Added to the active tool's length, along minus the tool vector.
            conventions: Convention name → choice; wins over the overlay.

        Raises:
            MachineDataError: the data describe no machine, or the kinematic or channel does not exist.
            UnsupportedKinematicError: the kinematic is not built by this version.
            ConventionError: an unknown convention or choice.
            ChainError: the chain contradicts itself.
        """
        chain = self.translated(kinematic, channel, tool_length_mm, conventions)
        # What was found without these conventions, and is true with them, was found again.
        reading = still_true(self._reading, self.chosen_conventions(conventions))
        return replace(chain, findings=once((*reading, *chain.findings)))

    def translated(
        self,
        kinematic: int | str | tuple[int | str, int | str] | None = None,
        channel: int | None = None,
        tool_length_mm: float = 0.0,
        conventions: Mapping[str, str] | None = None,
    ) -> Chain:
        """Translate a kinematic as `chain` does; the chain's findings are without those of reading the file.

        A file of thousands of kinematics may have as many findings of reading.
        """
        kinematic, channel = checked_kinematic(kinematic), checked_channel(channel)
        tool_length_mm = finite_length_mm(tool_length_mm)
        chosen = self.chosen_conventions(conventions)
        collector = Collector(self._collector.strict)
        try:
            selected = self._select(kinematic, channel, collector)
            chain = self._translated(selected, tool_length_mm, chosen, collector)
        except ChainbuildError:
            if not collector.strict:
                self._note(collector.findings)
            raise
        used = {one.convention.name for one in chain.conventions}
        self._tell_unused([name for name in sorted(chosen) if name not in used], conventions or {}, collector)
        return replace(chain, findings=Findings(dict.fromkeys(collector.findings)))

    def chosen_conventions(self, conventions: Mapping[str, str] | None) -> dict[str, str]:
        """Return the user's choices: the overlay's, overridden by the argument."""
        if conventions is not None and not isinstance(conventions, Mapping):
            raise ConventionError("conventions must be a mapping of name to choice")
        return {**self.overlay.conventions, **(conventions or {})}

    @abstractmethod
    def _channel(self, wanted: int | None, collector: Collector) -> int:
        """Return the requested channel; None: the first with a kinematic, and a finding where there are several.

        Raises:
            MachineDataError: there is no such channel, or none at all.
        """

    @abstractmethod
    def _translate(self, selected: Selected, tool_length_mm: float, choose: Choices, collector: Collector) -> Chain:
        """Return the chain of a kinematic: named, its axes with limits, without the bodies of the overlay.

        Args:
            selected: The kinematic.
            tool_length_mm: Added to the active tool's length; includes the overlay's share.
            choose: Conventions; remembers which were used.
            collector: Takes the findings of the translation.
        """

    @abstractmethod
    def _tell_unused(self, names: Sequence[str], asked: Mapping[str, str], collector: Collector) -> None:
        """Note the chosen conventions that a kinematic does not use.

        Args:
            names: Their names.
            asked: Those chosen for this chain; the others are the overlay's.
            collector: Takes the finding.
        """

    def _entries_of(self, channel: int) -> Sequence[KinematicEntry]:
        """Return the kinematics of a channel; looked up, since a file may have thousands of channels."""
        return self._by_channel.get(channel, ())

    @cached_property
    def _by_channel(self) -> Mapping[int, Sequence[KinematicEntry]]:
        found: dict[int, list[KinematicEntry]] = {}
        for entry in self.kinematics():
            found.setdefault(entry.channel, []).append(entry)
        return found

    def _named(self, wanted: int | str | None, entries: Sequence[KinematicEntry]) -> KinematicEntry:
        """Return the requested one of a channel's kinematics; None: the default."""
        return choose_kinematic(entries, wanted, self.file)

    def _pair(
        self, wanted: tuple[int | str, int | str], entries: Sequence[KinematicEntry], collector: Collector
    ) -> Selected:
        """Return the requested pair of a channel's kinematics: steps 0 and 1."""
        return Selected(*choose_pair(entries, wanted, self.file))

    def _second(self, entry: KinematicEntry, wanted: int | str | None, collector: Collector) -> KinematicEntry | None:
        """Return the kinematic of a second transformation step on another, which not every dialect has."""
        return None

    def _is_main(self, selected: Selected) -> bool:
        """Tell whether the overlay's bodies apply to a kinematic."""
        return True

    def _select(self, kinematic: Wanted | None, channel: int | None, collector: Collector) -> Selected:
        """Return the kinematic that an id or name means in a channel; None: the overlay's, else the file's default."""
        if not self.kinematics():
            refuse_errors(self._reading)  # a refused line may have configured the only kinematic
        number = self._channel(channel, collector)
        wanted = self.overlay.kinematic if kinematic is None else kinematic
        entries = self._entries_of(number)
        try:
            if isinstance(wanted, tuple):
                return self._pair(wanted, entries, collector)
            entry = self._named(wanted, entries)
        except MachineDataError as error:
            name_right_channel(error, self.kinematics(), wanted, number)
            raise error if kinematic is not None else self.overlay.at_key(error, "kinematic") from None
        return Selected(entry, self._second(entry, wanted, collector))

    def _translated(
        self, selected: Selected, tool_length_mm: float, chosen: Mapping[str, str], collector: Collector
    ) -> Chain:
        """Return the chain of a kinematic, from the cache where it was translated before.

        Only chains with the overlay's own choices are cached: there is one for each kinematic.
        """
        usual = tool_length_mm == 0.0 and chosen == self.overlay.conventions
        outcome = self._kept.get(selected) if usual else None
        if outcome is None:
            outcome = self._outcome(selected, tool_length_mm, chosen)
            if usual:
                self._kept[selected] = outcome
        collector.findings.extend(outcome.findings)
        if outcome.chain is None:
            assert outcome.error is not None
            raise outcome.error
        return outcome.chain

    def _outcome(self, selected: Selected, tool_length_mm: float, chosen: Mapping[str, str]) -> _Outcome:
        """Translate a kinematic; a strict machine raises the error that a lenient one keeps."""
        collector = Collector(self._collector.strict)
        choose = Choices(chosen)
        try:
            chain = self._translate(selected, tool_length_mm + self.overlay.tool_length_mm, choose, collector)
            refuse_errors(self._refused)
            refuse_errors(collector.findings)
            if self._is_main(selected):
                chain = self.overlay.apply_geometry(chain)
            check_chain(chain)
        except ChainbuildError as error:
            if collector.strict:
                raise
            return _Outcome(tuple(collector.findings), error=error)
        return _Outcome(tuple(collector.findings), replace(chain, conventions=choose.used()))

    def _note(self, findings: Iterable[Finding]) -> None:
        """Add the findings that are new to the machine's."""
        kept = self._collector.findings  # whoever owns the collector may add to it, too
        self._noted.update(kept[self._seen :])
        new = [one for one in dict.fromkeys(findings) if one not in self._noted]
        kept.extend(new)
        self._noted.update(new)
        self._seen = len(kept)
