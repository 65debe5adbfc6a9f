"""Channel configuration: ids, types, names, defaults, steps, tools."""

from __future__ import annotations

import pytest

from chainbuild.errors import MachineDataError
from chainbuild.findings import Collector
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.twincat.lists.channel import read_channel
from chainbuild.formats.twincat.lists.config import Channel, Trafo
from tests.kit.twincat_files import codes, machine, parameters


def channel(text: str, collector: Collector | None = None) -> Channel:
    collector = collector or Collector()
    return read_channel(parameters(text, collector), collector)


def only(text: str) -> Trafo:
    (trafo,) = channel(text).trafos
    return trafo


def test_the_type_is_the_id_where_none_is_given() -> None:
    assert only("trafo[1].id 60").type == 60
    assert only("trafo[1].id 60\ntrafo[1].type 0").type == 60
    trafo = only("trafo[0].id 9000\ntrafo[0].type 9\ntrafo[0].param[0] 5000000")
    assert (trafo.id, trafo.type, trafo.index, trafo.step) == (9000, 9, 0, 0)
    assert trafo.params[0].value == 5000000


def test_the_order_of_lines_does_not_matter() -> None:
    trafo = only("trafo[0].param[0] 5\ntrafo[0].type 45\ntrafo[0].name R\ntrafo[0].id 7")
    assert (trafo.id, trafo.type, trafo.name) == (7, 45, "R")
    assert trafo.span.line == 4


def test_steps() -> None:
    found = channel("kin_step[1].trafo[0].id 1\nkin_step[1].trafo[0].type 20\nkin_step[0].trafo[0].id 9")
    assert [(t.step, t.id, t.prefix) for t in found.trafos] == [
        (0, 9, "kin_step[0].trafo[0]"),
        (1, 1, "kin_step[1].trafo[0]"),
    ]


def test_the_old_form() -> None:
    collector = Collector()
    found = channel("kinematik[9].param[0] 500000\nkinematik[60].param[0] 200000\nkinematik_id 60", collector)
    assert [(t.id, t.type, t.params[0].value) for t in found.trafos] == [(9, 9, 500000), (60, 60, 200000)]
    assert codes(collector) == ["CB224", "CB224"]
    assert found.default_trafo() is found.trafos[1]


def test_the_older_spelling_of_the_old_form() -> None:
    assert only("kinematik[9].wz_kopf_versatz[0] 500000").params[0].value == 500000


def test_a_repeated_id_is_legal_under_different_names() -> None:
    # Printed configuration 3.8.2 of the coupling manual: LINEAR and TABLE both have id 91.
    found = channel("trafo[0].id 91\ntrafo[0].name LINEAR\ntrafo[1].id 91\ntrafo[1].name TABLE\nkinematik_name TABLE")
    assert [t.name for t in found.trafos] == ["LINEAR", "TABLE"]
    assert found.default_trafo() is found.trafos[1]


def test_the_same_id_in_two_steps_is_legal() -> None:
    assert len(channel("trafo[0].id 9\nkin_step[1].trafo[0].id 9").trafos) == 2


def test_pcs_transformations_are_kept_apart() -> None:
    collector = Collector()
    found = channel("trafo[0].id 45\ntrafo_pcs[0].id 28\ntrafo_pcs[0].type 212\ntrafo_pcs[0].param[1] 2", collector)
    assert [t.type for t in found.pcs] == [212]
    assert len(found.trafos) == 1
    assert codes(collector) == ["CB226"]


def test_what_belongs_to_91_and_210_is_kept_with_its_place() -> None:
    found = channel(
        "trafo[0].id 91\ntrafo[0].zero_orientation[2] 1.0\ntrafo[0].axis[1].orientation[0] 1.0\n"
        "trafo[0].base[2] -1000000\n"
        "trafo[0].chain[1] 3\ntrafo[0].chain[0] 0\ntrafo[1].id 210\ntrafo[1].group[0].chain[1] ROBOT\n"
        "trafo[1].group[0].chain[0] LINEAR (first\ntrafo[1].lock_dof[7] 1\ntrafo[1].group[0].workpiece_cs 100"
    )
    universal, coupling = found.trafos
    assert universal.numbers("zero_orientation", 3) == (0, 0, 1)
    assert universal.numbers("axis[1].orientation", 3) == (1, 0, 0)
    assert universal.numbers("base", 6) == (0, 0, -1000000, 0, 0, 0)
    assert {k: entry.integer(0, 9) for k, entry in universal.indexed("chain").items()} == {0: 0, 1: 3}
    assert [entry.text() for entry in coupling.indexed("group[0].chain").values()] == ["LINEAR", "ROBOT"]
    assert coupling.extras["group[0].workpiece_cs"].span.line == 11
    assert coupling.extras["lock_dof[7]"].number() == 1


def test_axes_of_the_channel() -> None:
    found = channel(
        "trafo[0].id 45\ngruppe[0].bezeichnung G\ngruppe[0].achse[1].bezeichnung Y (second\n"
        'gruppe[0].achse[0].bezeichnung "X"\ngruppe[0].achse[0].log_achs_nr 4\ngruppe[1].achse[0].bezeichnung Q'
    )
    assert {i: (a.name, a.number) for i, a in found.axes.items()} == {0: ("X", 4), 1: ("Y", None)}


def test_names_longer_than_the_controller_keeps() -> None:
    collector = Collector()
    channel("trafo[0].id 45\ntrafo[0].name ABCDEFGHIJKLMNOPQ", collector)
    assert codes(collector) == ["CB225"]


def test_the_default_of_a_step() -> None:
    text = "trafo[0].id 33\ntrafo[1].id 87\nkin_step[1].trafo[0].id 5\nkin_step[1].trafo[1].id 9\n"
    found = channel(text + "default_id_of_kin_step[0] 87\ndefault_id_of_kin_step[1] 5")
    assert [found.default_trafo(step).id for step in (0, 1)] == [87, 5]  # type: ignore[union-attr]
    assert channel(text).default_trafo() is None


@pytest.mark.parametrize(
    ("text", "wanted", "height"),
    [
        ("", None, 0.1),
        ("kinematik_id 2", None, 0.2),
        ("kinematik_name THREE", None, 0.3),
        ("kinematik_id 0", None, 0.1),
        ("default_id_of_kin_step[0] 2", None, 0.2),
        ("default_name_of_kin_step[0] THREE", None, 0.3),
        ("kinematik_id 2", 1, 0.1),
        ("kinematik_id 2", "THREE", 0.3),
        ("", "3", 0.3),
    ],
)
def test_which_kinematic_is_taken(text: str, wanted: int | str | None, height: float) -> None:
    lists = "\n".join(f"trafo[{i}].id {i + 1}\ntrafo[{i}].type 45\ntrafo[{i}].param[6] {i + 1}000000" for i in range(3))
    found = machine(f"{lists}\ntrafo[2].name THREE\n{text}")
    assert found.chain(wanted).joints[1].T_parent_joint[2, 3] == height
    assert sum(entry.default for entry in found.kinematics()) == 1


def test_the_overlay_names_the_default() -> None:
    text = "trafo[0].id 45\ntrafo[1].id 2\ntrafo[1].type 45\ntrafo[1].param[6] 20000"
    assert machine(text, overlay=Overlay(kinematic=2)).chain().joints[1].T_parent_joint[2, 3] == 0.002


def test_the_only_coupling_is_the_default() -> None:
    found = machine("trafo[0].id 45\ntrafo[1].id 91\ntrafo[2].id 210")
    assert [entry.default for entry in found.kinematics()] == [False, False, True]
    assert codes(found) == []
    assert found.chain(45).kinematic == "KIN_TYP 45"
    with pytest.raises(MachineDataError, match="no group is configured"):
        found.chain()


def test_the_default_id_in_english() -> None:
    lists = "trafo[0].id 9\ntrafo[1].id 58\n"
    found = machine(f"{lists}kinematic_id 58 (default")
    assert found.chain().kinematic == "KIN_TYP 58"
    told = [f for f in found.findings if f.code == "CB417"]
    assert [(f.severity, f.text, f.span.line if f.span else 0, f.hint) for f in told] == [
        ("warning", "kinematic_id is not spelt as the controller documents it; it is taken as kinematik_id", 3,
         "write kinematik_id")
    ]  # fmt: skip
    both = machine(f"{lists}kinematic_id 58\nkinematik_id 9")
    assert both.chain().kinematic == "KIN_TYP 9"
    assert "kinematik_id of line 4 is used" in next(f.text for f in both.findings if f.code == "CB417")
    assert codes(machine(f"{lists}kinematik_id 58")) == []
    wrong = machine(f"{lists}kinematic_id 7", strict=False)
    assert codes(wrong) == ["CB417", "CB222"]


def test_an_id_that_is_not_configured() -> None:
    with pytest.raises(MachineDataError, match="configures no kinematic 9") as caught:
        machine("trafo[0].id 45\ntrafo[0].name ROBOT").chain(9)
    assert caught.value.permitted == "45 (ROBOT)"
    assert caught.value.alarm == 21630


def test_a_second_step_without_default_is_left_out() -> None:
    chain = machine("trafo[0].id 45\nkin_step[1].trafo[0].id 9").chain()
    assert "CB412" in codes(chain)


def test_entries_tell_type_title_and_place() -> None:
    (entry,) = machine("\ntrafo[0].id 7\ntrafo[0].type 45\ntrafo[0].name R").kinematics()
    assert (entry.id, entry.name, entry.type, entry.title) == (7, "R", "KIN_TYP 45", "Six-axis articulated robot")
    assert entry.span is not None
    assert entry.span.line == 2
