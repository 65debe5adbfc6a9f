"""The catalogue and the alarms against the ROBX manual; expected values were typed from the manual by hand."""

import dataclasses
import string
import tomllib
from collections import Counter
from importlib.resources import files

import pytest

from chainbuild.formats.sinumerik.reading.alarms import alarms
from chainbuild.formats.sinumerik.reading.catalogue import MachineDatum, by_number, catalogue, lookup, lookup_number

ROBX = {name: datum for name, datum in catalogue().items() if name.startswith("ROBX_")}
NO_DEFAULT = {"ROBX_TFLWP_RPY", "ROBX_SPINDLE_SIGN"}


def entries(file: str, key: str) -> list[dict[str, object]]:
    source = files("chainbuild.formats.sinumerik").joinpath("data", file)
    found: list[dict[str, object]] = tomllib.loads(source.read_text(encoding="utf-8"))[key]
    return found


def test_holds_the_70_robx_data_of_chapter_11_2() -> None:
    gap = {62933, *range(62955, 62964)}
    assert {datum.number for datum in ROBX.values()} == set(range(62900, 62980)) - gap
    assert len(ROBX) == 70


def test_no_name_or_number_stands_twice() -> None:
    names = [str(entry["name"]) for entry in entries("machine_data.toml", "datum")]
    assert [name for name, count in Counter(names).items() if count > 1] == []
    numbers = [datum.number for datum in catalogue().values() if datum.number is not None]
    assert [number for number, count in Counter(numbers).items() if count > 1] == []
    assert len(by_number()) == len(numbers)
    spellings = [s for datum in catalogue().values() for s in (datum.name, *datum.aliases, datum.te4_name) if s]
    assert [s for s, count in Counter(spellings).items() if count > 1] == []


def test_every_toml_key_reaches_the_datum() -> None:
    known = {field.name for field in dataclasses.fields(MachineDatum)} | {"family_numbers"}
    for entry in entries("machine_data.toml", "datum"):
        assert entry.keys() <= known, entry["name"]


@pytest.mark.parametrize("datum", ROBX.values(), ids=lambda datum: datum.name)
def test_robx_default_fits_dimension_and_limits(datum: MachineDatum) -> None:
    if datum.name in NO_DEFAULT:
        assert datum.default is None
        assert "default" in datum.lost
        return
    assert datum.default is not None
    assert datum.lost == ()
    assert len(datum.default) == datum.dimension
    for index, value in enumerate(datum.default):
        assert datum.permits(value, index), datum.permitted_text(index)
        if datum.minimum is not None and datum.maximum is not None:
            assert datum.minimum <= value <= datum.maximum
        assert isinstance(value, float) == (datum.type == "float")


@pytest.mark.parametrize("datum", catalogue().values(), ids=lambda datum: datum.name)
def test_fields_are_consistent(datum: MachineDatum) -> None:
    assert datum.prefix in {"MC", "MA", "MN", "ON", "SN", "SC", "TC"}
    assert datum.type in {"int", "float", "bool", "hex", "string"}
    groups = {"geometry", "axes", "tool", "additional_axes", "solver", "dynamics", "control", "standard"}
    assert datum.group in groups
    assert datum.indexed_by == {"MA": "axis", "TC": "tool"}.get(datum.prefix, "element")
    assert datum.meaning.endswith(".")
    assert datum.dimension >= 0
    assert len(datum.labels) in (0, len(datum.permitted))
    assert len(datum.element_ranges) in (0, datum.dimension)
    assert set(datum.permitted) == {value for value in datum.permitted if datum.permits(value)}
    for field in datum.lost:
        assert getattr(datum, field) is None, f"{field} is named as lost and yet given"


def test_lost_values_are_absent_and_named() -> None:
    assert {name: datum.lost for name, datum in catalogue().items() if datum.lost} == {
        "ROBX_TFLWP_RPY": ("default",),
        "ROBX_SPINDLE_SIGN": ("default", "minimum", "maximum"),
    }
    assert ROBX["ROBX_TFLWP_RPY"].default_known == (0.0, -90.0)


# number, name, unit, default, minimum, maximum as printed in the ROBX manual 11.2.1
PRINTED = [
    (62900, "ROBX_KINCLASS", "none", (1,), 1, 2),
    (62901, "ROBX_AXES_TYPE", "none", (1, 1, 1, 3, 3, 3), 1, 4),
    (62902, "ROBX_SPECIAL_KIN", "none", (1,), None, None),
    (62903, "ROBX_MAIN_AXES", "none", (1,), 1, 7),
    (62904, "ROBX_WRIST_AXES", "none", (1,), 1, 6),
    (62905, "ROBX_NUM_AXES", "none", (4,), 4, 6),
    (62907, "ROBX_MAIN_LENGTH_AB", "mm", (0.0, 500.0), None, None),
    (62916, "ROBX_DHPAR4_5ALPHA", "deg", (-90.0, 90.0), None, None),
    (62917, "ROBX_MAMES", "mm_or_deg", (0.0,) * 6, None, None),
    (62918, "ROBX_AXES_DIR", "none", (1,) * 6, -1, 1),
    (62919, "ROBX_DIS_WRP", "mm", (10.0,), 0.00001, 999999.9999),
    (62920, "ROBX_AXIS_SEQ", "none", (1, 2, 3, 4, 5, 6), 1, 6),
    (62928, "ROBX_TRP_SPIND_LEN", "mm", (0.0,) * 4, None, None),
    (62929, "ROBX_VELCP", "mm/min", (600000.0,) * 3, None, None),
    (62930, "ROBX_ACCCP", "m/s^2", (0.5,) * 3, 0.001, 100000),
    (62931, "ROBX_VELORI", "rpm", (1.6666,) * 3, None, None),
    (62932, "ROBX_ACCORI", "rev/s^2", (0.00277,) * 3, 0.001, 100000),
    (62935, "ROBX_VEL_FILTER_TIME", "s", (0.024,), 0, 100),
    (62936, "ROBX_CC_TOA_START_NUM", "none", (0,), -1, 8),
    (62938, "ROBX_EXT_AXIS_VECTOR_2", "none", (0.0, 1.0, 0.0), -1, 1),
    (62942, "ROBX_EXT_ROT_AX_VECTOR_3", "none", (1.0, 0.0, 0.0), -1, 1),
    (62952, "ROBX_A_DBD_START_INDEX", "none", (-1,), -1, 4088),
    (62964, "ROBX_SW_LIMITS_PARALLEL", "deg", (-1000.0, 1000.0), None, None),
    (62967, "ROBX_ITERMAXCOUNT", "none", (8,), 3, 18),
    (62968, "ROBX_ITERPRECISION", "none", (1e-6,), 1e-16, 100),
    (62969, "ROBX_ITERLIMIT", "deg", (3.0,), 0, 10),
    (62975, "ROBX_EXT_FL_ROT_AX_VECTOR_3", "none", (0.0, 0.0, 1.0), -1, 1),
]


@pytest.mark.parametrize(("number", "name", "unit", "default", "minimum", "maximum"), PRINTED)
def test_entry_is_as_printed(
    number: int, name: str, unit: str, default: tuple[float, ...], minimum: float | None, maximum: float | None
) -> None:
    datum = by_number()[number]
    assert (datum.name, datum.unit, datum.default) == (name, unit, default)
    assert (datum.minimum, datum.maximum) == (minimum, maximum)
    assert datum.dimension == len(default)
    assert datum.identifier == f"$MC_{name}"


def test_discrete_values_are_the_named_ones() -> None:
    wrist = catalogue()["ROBX_WRIST_AXES"]
    assert wrist.permitted == (1, 2, 3, 5, 6)
    assert not wrist.permits(4), "4 is inside the limits and yet undefined (5.3.10)"
    assert not catalogue()["ROBX_AXES_DIR"].permits(0)
    assert catalogue()["ROBX_MAIN_AXES"].labels == ("SS", "CC", "NR", "SC", "RR", "CS", "NN")
    index = catalogue()["ROBX_A_DBD_START_INDEX"]
    assert [value for value in (-1, 0, 2, 4, 4088, 4092) if index.permits(value)] == [-1, 0, 4, 4088]


def test_rpy_angles_have_their_own_limits() -> None:
    rpy = [datum for datum in ROBX.values() if datum.name.endswith("_RPY")]
    assert len(rpy) == 6
    for datum in rpy:
        assert [datum.limits(i) for i in range(3)] == [(-180.0, 180.0), (-90.0, 90.0), (-180.0, 180.0)]
        assert datum.permits(180.0, 0)
        assert not datum.permits(90.5, 1)


def test_integers_refuse_fractions() -> None:
    assert not catalogue()["ROBX_NUM_AXES"].permits(4.5)
    assert not catalogue()["ROBX_SPECIAL_FEATURE_MASK"].permits(0.5)
    assert catalogue()["ROBX_TX3P3_POS"].permits(0.5)


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_nothing_permits_what_is_not_finite(value: float) -> None:
    assert not catalogue()["ROBX_TX3P3_POS"].permits(value)
    assert not catalogue()["ROBX_NUM_AXES"].permits(value)


def test_permitted_text() -> None:
    assert catalogue()["ROBX_NUM_AXES"].permitted_text() == "4, 5 or 6"
    assert catalogue()["ROBX_DIS_WRP"].permitted_text() == "1e-05 to 999999.9999"
    assert catalogue()["ROBX_TFLWP_RPY"].permitted_text(1) == "-90 to 90"
    assert catalogue()["ROBX_TX3P3_POS"].permitted_text() == "any number"
    assert catalogue()["TRAFO_AXES_IN_1"].permitted_text() == "0 or more"


@pytest.mark.parametrize(
    ("spelling", "name"),
    [
        ("ROBX_TX3P3_POS", "ROBX_TX3P3_POS"),
        ("$MC_ROBX_TX3P3_POS", "ROBX_TX3P3_POS"),
        ("$mc_robx_tx3p3_pos", "ROBX_TX3P3_POS"),
        ("TRAFO6_AXIS_SEQ", "ROBX_AXIS_SEQ"),
        ("$MC_TRAFO6_MAIN_AXES", "ROBX_MAIN_AXES"),
        ("TRAFO_TYPE_7", "TRAFO_TYPE_7"),
        ("TRAFO_GEO_AX_ASSIGN_TAB_2", "TRAFO_GEOAX_ASSIGN_TAB_2"),
        ("$MA_POS_LIMIT_MINUS", "POS_LIMIT_MINUS"),
        ("$TC_DPC10", "DPC10"),
        ("$TC_DPVN5", "DPVN5"),
        ("$SN_SINGULARITY_THRESHOLD", "SINGULARITY_THRESHOLD"),
        ("$MN_TECHNO_EXTENSION_MASK", "TECHNO_EXTENSION_MASK"),
        ("$ON_TECHNO_EXTENSION_MASK", "TECHNO_EXTENSION_MASK"),
    ],
)
def test_lookup_finds_every_spelling(spelling: str, name: str) -> None:
    datum = lookup(spelling)
    assert datum is not None
    assert datum.name == name


@pytest.mark.parametrize(
    "name", ["ROBX_MAIN_AXIS", "TRAFO_TYPE_21", "TRAFO_TYPE_{n}", "$MA_ROBX_MAIN_AXES", "DPC11", "$", ""]
)
def test_lookup_refuses_what_it_does_not_know(name: str) -> None:
    assert lookup(name) is None


def test_data_sets_have_the_controllers_numbers() -> None:
    types = {datum.member: datum.number for datum in catalogue().values() if datum.family == "TRAFO_TYPE_{n}"}
    assert list(types) == list(range(1, 21))
    assert [types[n] for n in range(1, 6)] == [24100, 24200, 24300, 24400, 24430]
    assert catalogue()["TRAFO_AXES_IN_1"].number == 24110
    assert catalogue()["TRAFO_AXES_IN_5"].number == 24432
    assert catalogue()["TRAFO_GEOAX_ASSIGN_TAB_1"].number == 24120
    assert catalogue()["TRAFO_INCLUDES_TOOL_1"].number == 24130


def test_te4_data_are_the_same_300_lower() -> None:
    sequence = lookup_number(62620)
    assert sequence is not None
    assert (sequence.name, sequence.te4_name, sequence.te4_number) == ("ROBX_AXIS_SEQ", "TRAFO6_AXIS_SEQ", 62620)
    assert lookup_number(62633) is None
    assert lookup_number(24100 - 300) is None
    assert catalogue()["TRAFO_TYPE_1"].te4_name is None
    assert all(datum.te4_number is None for datum in catalogue().values() if datum.name not in ROBX)


# number: (class, parameters of the text, clear criterion) as printed in the ROBX manual 11.5
ALARMS = {
    75310: ("data", 2, "power_on"),
    75311: ("data", 1, "reset"),
    75312: ("data", 1, "reset"),
    75313: ("path", 4, "reset"),
    75321: ("data", 1, "reset"),
    75324: ("path", 4, "reset"),
    75327: ("path", 2, "cancel"),
    75328: ("path", 3, "reset"),
    75334: ("runtime", 3, "reset"),
    75335: ("runtime", 1, "reset"),
    75370: ("path", 1, "reset"),
    75373: ("data", 1, "reset"),
}


def test_holds_the_26_alarms_of_chapter_11_5() -> None:
    assert list(alarms()) == [*range(75310, 75330), 75334, 75335, *range(75370, 75374)]
    assert len(entries("alarms.toml", "alarm")) == 26


@pytest.mark.parametrize("number", ALARMS)
def test_alarm_is_as_printed(number: int) -> None:
    alarm = alarms()[number]
    assert (alarm.alarm_class, len(alarm.parameters), alarm.clear) == ALARMS[number]


def test_alarm_fields_are_consistent() -> None:
    for number, alarm in alarms().items():
        placeholders = [name for _, name, _, _ in string.Formatter().parse(alarm.text) if name]
        assert placeholders == list(alarm.parameters), number
        assert alarm.parameters[0] == "channel"
        assert alarm.alarm_class in {"data", "path", "runtime"}
        assert alarm.reaction in {"interpreter_stop", "no_ready", "stop", "block_end", "show"}
        assert alarm.clear in {"power_on", "reset", "cancel"}
        assert alarm.remedy.endswith(".")
        assert alarm.manual.startswith("11.5")


def test_alarm_message_fills_its_parameters() -> None:
    text = alarms()[75310].message(channel=1, datum="ROBX_TFLWP")
    assert text == "channel 1: ROBX machine data are wrong, see ROBX_TFLWP"
    assert alarms()[75316].message() == "channel ?: position out of reach, found while interpreting"
    with pytest.raises(ValueError, match="75316 has no parameter block"):
        alarms()[75316].message(block=10)
