"""Reading a channel list: kinematics, defaults, angles, vectors and axes, from assignments to typed configuration."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, TypeVar, get_args

from chainbuild.chain.programmed.vectors import BOTH_SET_ALARM, FIXED_AXIS_INDEX, AngleLetter, OriMode, ToolPlane
from chainbuild.closest import closest
from chainbuild.errors import MachineDataError, Span
from chainbuild.findings import Collector
from chainbuild.formats.twincat.lists.config import (
    MAX_KINEMATIC_STEPS,
    MAX_PARAM,
    MAX_TRAFOS,
    UNKNOWN_ID_ALARM,
    UNS16,
    Channel,
    ChannelAxis,
    Default,
    Orientation,
    RawValue,
    Trafo,
    bad_name,
    checked_axis_name,
    checked_index,
    errors_collected_by,
    short_name,
)
from chainbuild.formats.twincat.lists.counts import check_counts
from chainbuild.formats.twincat.lists.named_parameters import is_general, named_parameter, nearest_name
from chainbuild.formats.twincat.lists.reader import Assignment, Key, ParameterList, canonical

_Meaning = TypeVar("_Meaning")

# P-CHAN-00112; 11 is described as not supported by the controller.
_ANGLE_MODES: Final = frozenset({*range(-1, 6), *range(10, 22)})
_ORI_MODES: Final[Mapping[str, OriMode]] = {mode.upper(): mode for mode in get_args(OriMode)}
_FIXED_AXES: Final[Mapping[float, AngleLetter | None]] = {0: None, **{n: a for a, n in FIXED_AXIS_INDEX.items()}}
_TOOL_PLANES: Final[Mapping[float, ToolPlane]] = {plane: plane for plane in get_args(ToolPlane)}
_ORI_NAMES: Final = ("mode", "fixed_axis_index", "tool_ax_in_plane")
_DEFAULT_ID: Final = "kinematik_id"
_ENGLISH_DEFAULT_ID: Final = "kinematic_id"  # a page of the vendor spells it so
_CHECK_OWN_NAMES: Final = (91, 210)  # universal and coupling kinematic, configured by names


def read_channel(parameters: ParameterList, collector: Collector, index: int = 0, name: str = "") -> Channel:
    """Type a channel list.

    Raises:
        MachineDataError: an index, id or value out of range, a kinematic without id, a repeated id.
        ParseError: a value that is not a number or string.
    """
    found = [*_grouped(parameters, collector, "kin_step"), *_grouped(parameters, collector, "kinematik")]
    trafos = sorted((t for t in found if t), key=lambda t: (t.step, t.span.line))
    _refuse_repeated(trafos, collector)
    for trafo in trafos:
        _warn_unknown(trafo, collector)
        check_counts(trafo, collector)
    pcs = tuple(t for t in _grouped(parameters, collector, "trafo_pcs") if t)
    if pcs:
        text = f"{len(pcs)} PCS transformation(s) are read; they act on the program's coordinates, not on the machine"
        collector.add("CB226", text, span=pcs[0].span)
    if parameters.ignored:
        first = f"; the first: {', '.join(parameters.ignored_names)}"
        text = f"unrelated entries ignored: {parameters.ignored}{first}"
        collector.add("CB206", text, span=parameters.span)
    defaults = _defaults(parameters, collector)
    channel = Channel(
        index, name, tuple(trafos), pcs, defaults, _angle_mode(parameters, collector), _axes(parameters, collector),
        parameters.span, _orientation(parameters, collector),
    )  # fmt: skip
    for step, default in defaults.items():
        if channel.default_trafo(step) is None and any(t.step == step for t in trafos):
            text, span, ids = default.fault(trafos, step)
            collector.add("CB222", text, span=span, permitted=ids, alarm=UNKNOWN_ID_ALARM)
    return channel


@dataclass(slots=True)
class _Builder:
    """A kinematic while its assignments are gathered."""

    step: int
    index: int
    prefix: str
    span: Span
    id: int | None = None
    type: int = 0
    name: str = ""
    params: dict[int, RawValue] = field(default_factory=dict)
    extras: dict[str, Assignment] = field(default_factory=dict)

    def take(self, entry: Assignment, rest: tuple[Key, ...], collector: Collector) -> None:
        match rest:
            case (("id", None),):
                self.id, self.span = entry.integer(0, UNS16), entry.span
            case (("type", None),):
                self.type = entry.integer(0, UNS16)
            case (("name", None),):
                self.name = short_name(entry, collector)
            case (("param" | "wz_kopf_versatz", k),):
                self.params[checked_index(entry, k, MAX_PARAM)] = RawValue(
                    entry.number(), entry.name, entry.span, entry.raw
                )
            case _:
                self.extras[canonical(rest)] = entry

    def build(self, collector: Collector) -> Trafo | None:
        if not self.id:
            collector.add(
                "CB220", f"{self.prefix} has no id", span=self.span, parameter=f"{self.prefix}.id",
                permitted=f"1 to {UNS16}", alarm=UNKNOWN_ID_ALARM,
            )  # fmt: skip
            return None
        return Trafo(
            self.step, self.index, self.id, self.type or self.id, self.name, self.params, self.extras, self.span,
            self.prefix,
        )  # fmt: skip


def _grouped(parameters: ParameterList, collector: Collector, root: str) -> list[Trafo | None]:
    builders: dict[tuple[int, int], _Builder] = {}
    for entry in parameters.under(root):
        with errors_collected_by(collector):
            step, index, rest = _place(entry, root)
            if (step, index) not in builders:
                prefix = entry.name[: len(entry.name) - len(canonical(rest)) - 1]
                builders[step, index] = _Builder(step, index, prefix, entry.span)
                if root == "kinematik":
                    # kinematik[ID]: id and type are the index.
                    builders[step, index].id = index
                    collector.add(
                        "CB224", "kinematik[ID] is the form of versions before 3.0; it is read", span=entry.span
                    )
            builders[step, index].take(entry, rest, collector)
    return [builder.build(collector) for builder in builders.values()]


def _place(entry: Assignment, root: str) -> tuple[int, int, tuple[Key, ...]]:
    """Return step, index and the rest of a name."""
    keys = entry.keys
    if root == "kin_step":
        step = checked_index(entry, keys[0][1], MAX_KINEMATIC_STEPS - 1)
        if len(keys) < 3 or keys[1][0] != "trafo":
            raise bad_name(entry, "kin_step[i].trafo[j].NAME")
        return step, checked_index(entry, keys[1][1], MAX_TRAFOS - 1), keys[2:]
    if len(keys) < 2:
        raise bad_name(entry, f"{root}[j].NAME")
    return 0, checked_index(entry, keys[0][1], UNS16 if root == "kinematik" else MAX_TRAFOS - 1), keys[1:]


def _warn_unknown(trafo: Trafo, collector: Collector) -> None:
    """Warn of parameters that nothing reads: misspelt, with a wrong index, or of a type configured by names."""
    if trafo.type in _CHECK_OWN_NAMES:
        return
    for name, entry in trafo.extras.items():
        if is_general(name):
            continue
        known = named_parameter(name) is not None
        what = f"has no effect on KIN_TYP {trafo.type}" if known else "is not a parameter of a kinematic"
        near = None if known else nearest_name(name)
        hint = f"did you mean {trafo.prefix}.{near}?" if near else None
        text = f"{entry.name[:80]} {what}; it is ignored"
        collector.add("CB227", text, span=entry.span, parameter=entry.name[:80], hint=hint)


def _refuse_repeated(trafos: list[Trafo], collector: Collector) -> None:
    seen: dict[tuple[int, int, str], Trafo] = {}
    for trafo in trafos:
        key = (trafo.step, trafo.id, trafo.name)
        earlier = seen.setdefault(key, trafo)
        if earlier is not trafo:
            collector.add(
                "CB221", f"the id {trafo.id} is configured twice under the same name, also in line {earlier.span.line}",
                span=trafo.span, parameter=f"{trafo.prefix}.id", permitted="different ids, or different names",
            )  # fmt: skip


def _defaults(parameters: ParameterList, collector: Collector) -> dict[int, Default]:
    defaults: dict[int, Default] = {}
    for id_name, name_name, step in (
        (_DEFAULT_ID, "kinematik_name", 0),
        *((f"default_id_of_kin_step[{i}]", f"default_name_of_kin_step[{i}]", i) for i in range(MAX_KINEMATIC_STEPS)),
    ):
        with errors_collected_by(collector):
            id_entry, name_entry = parameters.get(id_name), parameters.get(name_name)
            if id_name == _DEFAULT_ID:
                id_entry = _default_id(id_entry, parameters.get(_ENGLISH_DEFAULT_ID), collector)
            number = id_entry.integer(0, UNS16) if id_entry else 0
            name = name_entry.text() if name_entry else ""
            if number or name:
                spans = (entry.span if entry else None for entry in (id_entry, name_entry))
                defaults[step] = Default(number or None, name or None, *spans)
    return defaults


def _default_id(entry: Assignment | None, english: Assignment | None, collector: Collector) -> Assignment | None:
    """Return the default id of the list; one spelt in English is taken where there is no other."""
    if english is None:
        return entry
    effect = f"{_DEFAULT_ID} of line {entry.span.line} is used" if entry else f"it is taken as {_DEFAULT_ID}"
    text = f"{english.name} is not spelt as the controller documents it; {effect}"
    collector.add("CB417", text, span=english.span, parameter=english.name, hint=f"write {_DEFAULT_ID}")
    return entry or english


def _angle_mode(parameters: ParameterList, collector: Collector) -> RawValue | None:
    entry = parameters.get("ori_rotation_angle")
    if entry is None:
        return None
    with errors_collected_by(collector):
        mode = entry.integer(-1, 21)
        if mode in _ANGLE_MODES:
            return RawValue(mode, entry.name, entry.span)
        collector.add(
            "CB204", f"ori_rotation_angle is {mode}", span=entry.span, parameter=entry.name,
            permitted="-1 to 5, 10 to 21 (P-CHAN-00112)",
        )  # fmt: skip
    return None


def _orientation(parameters: ParameterList, collector: Collector) -> Orientation:
    """Return how orientations are programmed; of an index and a plane that are both given, neither counts."""
    _warn_unknown_ori(parameters, collector)
    found = {name: entry for name in _ORI_NAMES if (entry := parameters.get(f"ori.{name}"))}
    spans = {name: entry.span for name, entry in found.items()}
    mode: OriMode = "angle"
    fixed: AngleLetter | None = None
    plane: ToolPlane = 0
    with errors_collected_by(collector):
        mode = _ori_mode(found["mode"]) if "mode" in found else mode
    with errors_collected_by(collector):
        fixed = _one_of(found.get("fixed_axis_index"), _FIXED_AXES, "0 (none), 3, 4 or 5: A, B or C")
    with errors_collected_by(collector):
        plane = _one_of(found.get("tool_ax_in_plane"), _TOOL_PLANES, "0 (none), 1 (ZX) or 2 (YZ)")
    if fixed and plane:
        here, there = found["tool_ax_in_plane"], found["fixed_axis_index"]
        text = f"{there.name} and {here.name} exclude each other; the controller takes both as 0"
        hint = f"keep this line or line {there.span.line}, not both"
        collector.add("CB415", text, span=here.span, parameter=here.name, alarm=BOTH_SET_ALARM, hint=hint)
        return Orientation(mode, spans=spans)
    return Orientation(mode, fixed, plane, spans)


def _ori_mode(entry: Assignment) -> OriMode:
    given = entry.text()
    mode = _ORI_MODES.get(given.upper())
    if mode:
        return mode
    raise MachineDataError(
        f"{entry.name} is {given[:40]!r}", span=entry.span, parameter=entry.name,
        permitted=f"{', '.join(_ORI_MODES)} (P-CHAN-00177)", code="CB204",
    )  # fmt: skip


def _one_of(entry: Assignment | None, meanings: Mapping[float, _Meaning], permitted: str) -> _Meaning:
    """Return what a number that is one of a few means; that of 0 where it is not given."""
    value = entry.number() if entry else 0.0
    if entry and value not in meanings:
        raise MachineDataError(
            f"{entry.name} is {value:g}", span=entry.span, parameter=entry.name, permitted=permitted, code="CB204"
        )
    return meanings[value]


def _warn_unknown_ori(parameters: ParameterList, collector: Collector) -> None:
    """Warn of names under `ori` that nothing reads and that resemble one that is read."""
    for entry in parameters.under("ori"):
        rest = canonical(entry.keys[1:])
        near = closest(rest, _ORI_NAMES) if rest else None
        if rest not in _ORI_NAMES and near:
            text = f"{entry.name[:80]} is not a parameter of orientations; it is ignored"
            hint = f"did you mean ori.{near}?"
            collector.add("CB227", text, span=entry.span, parameter=entry.name[:80], hint=hint)


def _axes(parameters: ParameterList, collector: Collector) -> dict[int, ChannelAxis]:
    """Return the axes of the first axis group: names (bezeichnung) and logical numbers (log_achs_nr)."""
    names: dict[int, str] = {}
    named: dict[int, Assignment] = {}
    numbers: dict[int, int] = {}
    for entry in parameters.under("gruppe"):
        match entry.keys:
            case (("gruppe", 0), ("achse", int(i)), ("bezeichnung", None)):
                with errors_collected_by(collector):
                    names[i] = checked_axis_name(entry, named, collector)
                    named[i] = entry
            case (("gruppe", 0), ("achse", int(i)), ("log_achs_nr", None)):
                with errors_collected_by(collector):
                    numbers[i] = entry.integer(0, UNS16)
            case _:
                pass
    spans = {i: entry.span for i, entry in named.items()}
    return {i: ChannelAxis(i, names.get(i, ""), numbers.get(i), spans.get(i)) for i in sorted({*names, *numbers})}
