"""The state of a live page in Python: what is changed, refused, kept and restored."""

from __future__ import annotations

import base64
import json
from pathlib import Path

import numpy as np
import pytest

from chainbuild.analysis.workspace.maps import make_map
from chainbuild.analysis.workspace.mapspec import MapSpec
from chainbuild.comparison.convention_trials import Selection
from chainbuild.errors import ChainbuildError
from chainbuild.formats.load import load
from chainbuild.inspect.live.answers import answered
from chainbuild.inspect.live.datalist import DataList
from chainbuild.inspect.live.sections import _SIZES, section
from chainbuild.inspect.live.session import Session
from chainbuild.machines import shipped_path
from chainbuild.robot import Robot

HEIGHT = "TX3P3_POS[2]"  # 35 in the file
AXES = (10.0, -80.0, 95.0, 20.0, 40.0, 15.0)


@pytest.fixture(scope="module")
def kept() -> Session:
    """Return one session; a test leaves it as it found it."""
    return Session(load("kr6r900"), at=AXES)


@pytest.fixture
def arm(kept: Session) -> Session:
    """Return a session of an arm with the data of its file."""
    kept.reset()
    kept.move(AXES)
    return kept


def test_a_changed_datum_is_that_of_an_edited_file(arm: Session, tmp_path: Path) -> None:
    text = shipped_path("kr6r900").read_text("latin-1")
    (tmp_path / "edited.tea").write_text(text.replace("TX3P3_POS[2]=35.0", "TX3P3_POS[2]=120"), "latin-1")
    number = arm.number
    arm.change({HEIGHT: 120.0})
    edited = Robot.load(tmp_path / "edited.tea")
    np.testing.assert_allclose(arm.robot.fk(AXES).homogeneous, edited.fk(AXES).homogeneous, rtol=0, atol=1e-14)
    assert arm.number == number + 1
    assert arm.model()["live"]["values"] == {HEIGHT: 120.0}
    assert arm.model()["live"]["changed"] is True
    arm.change({HEIGHT: 35.0})
    assert arm.values == {}
    assert arm.model()["live"]["changed"] is False


@pytest.mark.parametrize(
    ("values", "choices", "said"),
    [
        ({"TX3P3_POS[7]": 1.0}, {}, "no datum 'TX3P3_POS"),
        ({HEIGHT: float("nan")}, {}, "nan"),
        ({HEIGHT: 1e9}, {}, "below 1e"),
        ({}, {"nn": "xxx"}, "no choice 'xxx'"),
        ({}, {"no_such": "plus"}, "unknown convention"),
        ({"DHPAR4_5A[0]": 5.0}, {}, "62914"),
    ],
)
def test_what_is_refused_changes_nothing(
    arm: Session, values: dict[str, float], choices: dict[str, str], said: str
) -> None:
    arm.change({HEIGHT: 40.0})
    before = arm.number, arm.robot, dict(arm.values)
    with pytest.raises(ChainbuildError, match=said.replace("[", r"\[")):
        arm.change(values, choices)
    assert (arm.number, arm.robot, arm.values) == before


def test_what_a_datum_moves_is_its_derivative(arm: Session) -> None:
    found = arm.moves(HEIGHT)
    assert found["links"] == ["A4_link", "A5_link", "A6_link"]
    machine = load("kr6r900")
    datum = next(one for one in machine.geometry() if one.name.endswith(HEIGHT))
    poses = [Robot(machine.with_values({datum: value}).chain()).fk(AXES).translation for value in (35.0, 36.0)]
    np.testing.assert_allclose(found["shift"], 1000 * (poses[1] - poses[0]), rtol=0, atol=1e-9)
    assert np.linalg.norm(found["shift"]) == pytest.approx(1.0)
    assert found["turn"] == pytest.approx(0.0, abs=1e-9)
    turned = arm.moves("TX3P3_RPY[0]")
    assert turned["turn"] == pytest.approx(1.0)


def test_rows_name_the_line_of_the_file() -> None:
    machine = load("kr6r900")
    rows = {row["key"]: row for row in DataList(machine, Selection()).rows()}
    row = rows[HEIGHT]
    assert (row["value"], row["unit"], row["place"]) == (35.0, "mm", "kr6r900.tea:27")
    lines = shipped_path("kr6r900").read_text("latin-1").splitlines()
    assert lines[26].strip() == row["line"].strip()
    assert row["meaning"]


def test_a_choice_as_the_file_has_it_is_no_change() -> None:
    session = Session(load("ba_head_c_table_kin82"))
    session.change({}, {"table_rotary_sense": "left_handed"})
    assert session.choices == {"table_rotary_sense": "left_handed"}
    session.change({}, {"table_rotary_sense": "right_handed"})
    assert session.choices == {}
    chosen = Session(load("ba_head_c_table_kin82"), conventions={"table_rotary_sense": "left_handed"})
    assert not chosen.model()["live"]["changed"]
    chosen.change({}, {"table_rotary_sense": "right_handed"})
    assert chosen.model()["live"]["changed"]
    chosen.reset()
    assert chosen.choices == {"table_rotary_sense": "left_handed"}


def test_a_changed_structure_is_told_from_another_length() -> None:
    session = Session(load("scara_kin36"))
    before = session.model()["live"]["structure"]
    session.change({"HD1": 333.0})
    assert session.model()["live"]["structure"] == before
    session.change({}, {"kin36_c": "absolute"})
    assert session.model()["live"]["structure"] != before


def test_a_page_restores_what_it_kept(arm: Session) -> None:
    arm.restore({HEIGHT: 77.0}, {}, [1, -91, 92, 3, 34, 5])
    assert arm.axes.tolist() == [1, -91, 92, 3, 34, 5]
    assert arm.values == {HEIGHT: 77.0}
    with pytest.raises(ChainbuildError):
        arm.restore({HEIGHT: 78.0}, {}, [1, 2])
    assert arm.values == {HEIGHT: 77.0}
    with pytest.raises(ChainbuildError):
        arm.restore({"none": 78.0}, {}, [0, -90, 90, 0, 30, 0])
    assert arm.axes.tolist() == [1, -91, 92, 3, 34, 5]


def test_another_kinematic_of_the_file_is_shown() -> None:
    session = Session(load("gantry_robot_kin210"))
    name = session.name
    texts = session._kinematics()
    assert [one["text"].split(":")[0] for one in texts if one["shown"]] == ["210"]
    arm = next(one["n"] for one in texts if "KIN_TYP 45" in one["text"])
    session.choose_kinematic(arm)
    assert session.name != name
    assert [axis.name for axis in session.robot.axes] == [
        axis.name for axis in Robot.load("gantry_robot_kin210", kinematic=45).axes
    ]
    assert [one["n"] for one in session._kinematics() if one["shown"]] == [arm]
    with pytest.raises(ChainbuildError, match="no kinematic number 9"):
        session.choose_kinematic(9)


def test_questions_are_answered_by_the_robot(arm: Session) -> None:
    robot = Robot.load("kr6r900")
    T = robot.fk(AXES)
    flat = T.homogeneous.ravel().tolist()
    assert answered(robot, {"id": 3, "fk": list(AXES)}) == {"id": 3, "fk": flat}
    solved = answered(robot, {"id": 4, "ik": flat, "start": [0, -90, 90, 0, 30, 0]})["ik"]
    assert solved["status"] == "ok"
    np.testing.assert_allclose(robot.fk(solved["axes"]).homogeneous, T.homogeneous, rtol=0, atol=1e-8)
    every = answered(robot, {"id": 5, "ik_all": flat, "start": list(AXES)})["ik_all"]
    np.testing.assert_allclose(every, [one.axes for one in robot.ik_all(T, AXES)], rtol=0, atol=1e-12)
    assert "expected" in answered(robot, {"id": 6, "fk": [1.0]})["refused"]
    assert "16 numbers" in answered(robot, {"id": 6, "ik": [1.0], "start": list(AXES)})["refused"]


def test_a_section_is_the_map_of_the_workspace(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(_SIZES, "xz", (30, 20_000))
    robot = Robot.load("kr6r900")
    found = section(robot, "xz")
    across, up = found["cells"]
    values = np.frombuffer(base64.b64decode(found["values"]), dtype="<f4").reshape(up, across)
    expected = make_map(robot, MapSpec("xz", cells=across, samples=found["positions"]), workers=1)
    np.testing.assert_array_equal(values, expected.smallest.astype("<f4").T)
    with pytest.raises(ChainbuildError, match="rz, xz, xy, yz"):
        section(robot, "volume")


@pytest.mark.parametrize("name", ["kr6r900", "ac_table_kin58", "delta_kin37", "parallelogram_nr"])
def test_models_and_pages_hold_no_foreign_numbers(name: str) -> None:
    session = Session(load(name))
    key = next(key for key, datum in session._list.data.items() if datum.unit == "mm" and datum.value != 0)
    session.change({key: session._list.data[key].value + 1.0})
    for said in (session.model(), session.hello(), session.contacts(), session.presets(), session.moves(key)):
        json.dumps(said, allow_nan=False)
    page = session.page("http://127.0.0.1:1")
    assert "connect-src http://127.0.0.1:1;" in page
