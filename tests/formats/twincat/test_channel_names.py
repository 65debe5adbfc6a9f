"""Axes by the channel's own names: gruppe[0].achse[i].bezeichnung (P-CHAN-00006)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild import ChainbuildError, Robot
from chainbuild.chain.names import axis_index
from chainbuild.errors import MachineDataError, OverlayError
from chainbuild.formats.overlay import Overlay
from chainbuild.tables import AxisTable
from tests.kit.couplings import AT_TABLE, XY
from tests.kit.named_axes import bezeichnungen, german, named_machine
from tests.kit.twincat_files import codes, kin_45, machine

# One of every family of types.
FAMILIES = [
    "bed_mill_kin1", "cross_head_kin5", "underfloor_head_kin6", "drill_head_kin7", "ca_head_kin9", "saw_head_kin10",
    "oblique_head_kin11", "c_face_kin14", "ba_head_kin16", "plasma_head_kin25", "geared_head_kin28", "scara_kin36",
    "kr6r900_2", "ac_table_kin58", "cardan_head_kin59", "b_head_a_table_kin61", "cac_table_kin64", "rotated_head_kin70",
    "bevel_head_kin76", "ba_head_c_table_kin82", "lever_kin85", "palletiser_kin96", "cyl_2rot_kin202",
    "eccentric_disc_kin205", "linear_robot_kin206", "inclined_saw_kin207", "palletiser_kin213",
]  # fmt: skip
SIMULATED = ["X_TCP", "Y_TCP", "Z_TCP", "A_TCP", "B_TCP", "C_TCP"]
UNIT = ["X_LIN", "Y_LIN"]
ARM = ["X_ROB", "Y_ROB", "Z_ROB", "A_ROB", "B_ROB", "C_ROB"]
XY_NAMES = dict(enumerate([*SIMULATED, *UNIT, *ARM]))


def positions(robot: Robot, count: int = 3) -> np.ndarray:
    """Return axis values at which the robot has a pose, each axis at another share of its limits."""
    rng = np.random.default_rng(4)
    lower, upper = (np.array([getattr(axis, end) for axis in robot.axes]) for end in ("lower", "upper"))
    found: list[np.ndarray] = []
    while len(found) < count:
        values = lower + (upper - lower) * (0.5 + 0.3 * (rng.random(len(lower)) - 0.5))
        try:
            robot.fk(values)
        except ChainbuildError:
            continue
        found.append(values.round(6))
    return np.array(found)


@pytest.mark.parametrize("name", FAMILIES)
def test_every_family_by_german_names(name: str, tmp_path: Path) -> None:
    plain = Robot.load(name)
    generic = [axis.name for axis in plain.axes]
    names = german(generic)
    robot = Robot.load(named_machine(tmp_path, name, dict(enumerate(names))))
    assert [axis.name for axis in robot.axes] == names
    assert [axis.generic for axis in robot.axes] == generic
    # Overlay, kinds and limits are those of the same axis: shifted by one, they would be another's.
    same = ("kind", "lower", "upper", "max_speed", "endless", "held", "carries")
    assert [[getattr(a, key) for key in same] for a in robot.axes] == [
        [getattr(a, key) for key in same] for a in plain.axes
    ]
    rows = positions(plain)
    for row in rows:
        assert np.array_equal(robot.fk(row).homogeneous, plain.fk(row).homogeneous)
    # A table by either name, in another order, reads as the same values.
    order = list(range(len(names)))[::-1]
    for columns in (
        names,
        generic,
        [one.lower() for one in names],
        [f"{axis.name} [{axis.unit}]" for axis in robot.axes],
        [f"{axis.generic}[ {axis.unit.upper()} ]" for axis in robot.axes],
        [*names[:2], *generic[2:]],
    ):
        path = tmp_path / "axes.csv"
        lines = [",".join(columns[k] for k in order), *(",".join(f"{row[k]:.6f}" for k in order) for row in rows)]
        path.write_text("\n".join(lines))
        with AxisTable(path, robot.axes) as table:
            assert np.array([values for _, values in table.rows()]) == pytest.approx(rows, abs=1e-9)


@pytest.mark.parametrize("name", ["kr6r900_2", "ac_table_kin58", "linear_robot_kin206"])
def test_joints_of_a_urdf_have_the_names(name: str, tmp_path: Path) -> None:
    plain = Robot.load(name)
    names = german([axis.name for axis in plain.axes])
    robot = Robot.load(named_machine(tmp_path, name, dict(enumerate(names))))
    path = chainbuild.write_urdf(robot, tmp_path)
    text = path.read_text("utf-8")
    for joint in robot.chain.joints:
        assert joint.name in names
        assert f'<joint name="{joint.name}" ' in text
        assert f'<child link="{joint.name}_link"' in text
    back = Robot.from_urdf(path, tool="tool")
    assert [axis.name for axis in back.axes] == [
        j.name for j in robot.chain.joints if axis_index(back.axes, j.name) is not None
    ]
    values = dict(zip(names, positions(plain, 1)[0], strict=True))
    if all(axis.carries == "tool" for axis in robot.axes):
        T = back.fk([values[axis.name] for axis in back.axes]).homogeneous
        base = robot.frame_placements(list(values.values()))
        assert pytest.approx((base["base"].inverse() * base["tool"]).homogeneous, abs=1e-9) == T


def test_a_channel_may_call_another_axis_by_the_letter_of_the_type() -> None:
    # The type calls its axes C1, B1, B2, A1, B3, A2.
    names = {0: "A1", 1: "A2", 2: "A3", 3: "A4", 4: "A5", 5: "A6"}
    limits = {"A1": (-10.0, 11.0), "a2": (-20.0, 21.0), "B2": (-30.0, 31.0)}
    text = kin_45({8: 4_000_000, 9: 5_000_000, 10: 4_000_000}, bezeichnungen(names))
    axes = machine(text, overlay=Overlay(limits=limits)).chain().axes
    assert [(axis.name, axis.generic) for axis in axes][3] == ("A4", "A1")
    assert [axis.upper for axis in axes] == [11, 21, 31, 360, 360, 360]
    assert [axis_index(axes, name) for name in ("A1", "A2", "C1", "B1", "B3")] == [0, 1, 0, 1, 4]


def test_some_names_only() -> None:
    text = "trafo[0].id 9\n"
    found = machine(text + bezeichnungen({1: "Y_BETT", 4: "A_KOPF"})).chain()
    assert [axis.name for axis in found.axes] == ["X", "Y_BETT", "Z", "C", "A_KOPF"]
    assert "CB413" not in codes(found)
    found = machine(text + bezeichnungen({0: "Y", 3: "A"})).chain()
    assert [axis.name for axis in found.axes] == ["Y", "Y_2", "Z", "A", "A_2"]
    told = [finding for finding in found.findings if finding.code == "CB413"]
    assert [finding.span.line for finding in told if finding.span] == [2, 3]
    assert "another axis than Y of the kinematic, which is called Y_2" in told[0].text
    assert "gruppe[0].achse[1].bezeichnung is missing" in str(told[0].hint)


@pytest.mark.parametrize(
    ("name", "text", "permitted"),
    [
        ("IS", "the axis is called 'IS' like a column of the tables", "another name than is"),
        ("x_mm", "like a column of the tables", "another name than x_mm"),
        ("C_DEG", "like a column of the tables", "another name than c_deg"),
        ("Y_Drive", "like the column of a drive", "a name that does not end with _drive"),
        ("tool", "like a frame of the model", "another name than tool"),
        ("universe", "like a frame of the model", "universe"),
        ("X,Y", "the axis is called 'X,Y'", "a letter, then letters, digits, _ and -"),
        ('"X 1"', "the axis is called 'X 1'", "a letter, then letters, digits, _ and -"),
        ("X<b>", "the axis is called", "a letter"),
        ("X\x07", "the axis is called", "a letter"),
        ("A", "two axes are called 'A', also in line 2", "a name of its own"),
    ],
)
def test_names_that_are_refused(name: str, text: str, permitted: str) -> None:
    lines = f"trafo[0].id 9\n{bezeichnungen({4: 'A'})}{bezeichnungen({2: name})}"
    with pytest.raises(MachineDataError) as caught:
        machine(lines)
    error = caught.value
    assert error.code == "CB416"
    assert text in error.message
    assert permitted in str(error.permitted)
    assert error.span is not None
    assert error.span.line == 3
    assert error.parameter == "gruppe[0].achse[2].bezeichnung"
    lenient = machine(lines, strict=False)
    assert [finding.code for finding in lenient.findings if finding.severity == "error"] == ["CB416"]
    with pytest.raises(ChainbuildError):
        lenient.chain()


@pytest.mark.parametrize("name", ['""', "R1", "Y_ABCDEFGHIJKLMNO", "C-ACHSE"])
def test_names_in_doubt(name: str) -> None:
    found = machine(f"trafo[0].id 9\n{bezeichnungen({2: name})}")
    assert codes(found) == ["CB413"]
    assert found.chain().axes[2].name == (name if name != '""' else "Z")


def test_names_that_are_just_permitted() -> None:
    assert codes(machine(f"trafo[0].id 9\n{bezeichnungen({0: 'X_ABCDEFGHIJKLMN', 1: 'x1', 2: 'Q1'})}")) == []


def test_overlay_by_both_names() -> None:
    text = "trafo[0].id 9\n" + bezeichnungen({0: "X_BETT", 4: "A_KOPF", 3: "C_KOPF"})
    overlay = Overlay(limits={"X_BETT": (-1.0, 2.0), "A": (-3.0, 4.0)}, speeds={"x": 5.0}, endless=("c_kopf",))
    axes = machine(text, overlay=overlay).chain().axes
    assert (axes[0].lower, axes[4].upper, axes[0].max_speed, axes[3].endless) == (-1, 4, 5, True)
    with pytest.raises(OverlayError, match="'X' and 'X_BETT' are the same axis X_BETT"):
        machine(text, overlay=Overlay(limits={"X": (-1.0, 2.0), "X_BETT": (-1.0, 2.0)})).chain()
    with pytest.raises(OverlayError, match="axis 'X' is linear"):
        machine(text, overlay=Overlay(endless=("X",))).chain()
    with pytest.raises(OverlayError, match="no axis 'Q'") as caught:
        machine(text, overlay=Overlay(speeds={"Q": 1.0})).chain()
    assert caught.value.permitted == "X_BETT, Y, Z, C_KOPF, A_KOPF"


def test_links_of_the_overlay_by_both_names(tmp_path: Path) -> None:
    path = tmp_path / "head.lis"
    path.write_text("trafo[0].id 9\n" + bezeichnungen({0: "X_BETT", 3: "C_KOPF"}))
    (tmp_path / "head.chainbuild.toml").write_text("[geometry.radii_mm]\nX_link = 50\nC_KOPF_link = 40\nA_link = 30\n")
    links = {link.name: link.radius for link in chainbuild.load(path).chain().links}
    assert (links["X_BETT_link"], links["C_KOPF_link"], links["A_link"]) == (0.05, 0.04, 0.03)
    (tmp_path / "head.chainbuild.toml").write_text("[geometry.radii_mm]\nX_link = 50\nX_BETT_link = 40\n")
    with pytest.raises(OverlayError, match="'X_link' and 'X_BETT_link' are the same link X_BETT_link"):
        chainbuild.load(path).chain()


def test_held_by_both_names(tmp_path: Path) -> None:
    robot = Robot.load(named_machine(tmp_path, "ca_head_kin9", {3: "C_KOPF", 4: "A_KOPF"}))
    T = robot.fk([100, 50, -20, 30, 40])
    for held in ({"C_KOPF": 30.0}, {"C": 30.0}, {"c_kopf": 30.0}, {"c": 30.0}):
        found = robot.ik(T, held=held)
        assert found.axes == pytest.approx([100, 50, -20, 30, 40], abs=1e-6)
        si = robot.ik(T, held={name: np.radians(value) for name, value in held.items()}, units="si")
        assert si.axes[3] == pytest.approx(np.radians(30.0))
    with pytest.raises(ChainbuildError, match="'C' and 'C_KOPF' are the same axis C_KOPF"):
        robot.ik(T, held={"C": 30.0, "C_KOPF": 30.0})
    with pytest.raises(ChainbuildError, match="no axis 'Q' to hold") as caught:
        robot.ik(T, held={"Q": 30.0})
    assert caught.value.permitted == "X, Y, Z, C_KOPF, A_KOPF"


def test_the_axes_of_a_coupling_come_behind_the_simulated_ones() -> None:
    found = machine("\n".join(XY) + "\n" + bezeichnungen(XY_NAMES))
    chain = found.chain()
    assert [axis.name for axis in chain.axes] == [*UNIT, *ARM]
    assert [axis.generic for axis in chain.axes] == ["X", "Y", "C1", "B1", "B2", "A1", "B3", "A2"]
    assert [joint.name for joint in chain.joints] == [*UNIT, *ARM]
    assert [[axis.name for axis in partial.chain.axes] for partial in chain.partials] == [UNIT, ARM]
    # A partial alone has the names that its axes have in the coupling.
    assert [axis.name for axis in found.chain("ROBOT").axes] == ARM
    assert [axis.name for axis in found.chain("LINEAR").axes] == UNIT


def test_limits_of_a_partial_alone_are_those_of_its_axes(tmp_path: Path) -> None:
    names = [*SIMULATED, *UNIT, *ARM]
    for n, name in enumerate(names):
        text = f"kopf.log_achs_name {name}\nkenngr.swe_neg -{n + 1}0000\nkenngr.swe_pos {n + 1}5000\n"
        (tmp_path / f"{name}.lis").write_text(text)
    for order in (names, names[::-1]):
        overlay = Overlay(path=tmp_path / "o.toml", axis_lists=tuple(tmp_path / f"{name}.lis" for name in order))
        found = machine("\n".join(XY) + "\n" + bezeichnungen(XY_NAMES), overlay=overlay)
        whole = {axis.name: axis.upper for axis in found.chain().axes}
        assert whole == {name: n + 1.5 for n, name in enumerate(names) if n >= 6}
        for partial in ("LINEAR", "ROBOT"):
            assert {axis.name: axis.upper for axis in found.chain(partial).axes}.items() <= whole.items()


def test_a_coupling_with_a_table() -> None:
    names = dict(enumerate([*SIMULATED, *UNIT, *ARM, "A_TISCH", "C_TISCH"]))
    chain = machine("\n".join(AT_TABLE) + "\n" + bezeichnungen(names)).chain()
    assert [axis.name for axis in chain.axes[-2:]] == ["A_TISCH", "C_TISCH"]
    assert [axis.name for axis in chain.partials[2].chain.axes] == ["A_TISCH", "C_TISCH"]
    robot = Robot(chain)
    found = robot.distribute({"X": 300, "Y": 40}, axes={"A_TISCH": 20.0, "C_TISCH": 50.0})
    same = robot.distribute({"X": 300, "Y": 40}, axes={"TABLE.A": 20.0, "TABLE.C": 50.0})
    for one, other in zip(found.partials, same.partials, strict=True):
        assert np.array_equal(one.values, other.values)


def test_coordinates_of_partials_by_the_axes_that_stand_for_them() -> None:
    robot = Robot(machine("\n".join([*XY, "ori_rotation_angle 4"]) + "\n" + bezeichnungen(XY_NAMES)).chain())
    tcp = {"X": 1000, "Y": 500, "Z": 50}
    by_letter = robot.distribute(tcp, axes={"LINEAR.X": 800}, locked=["LINEAR.Y"], current={"LINEAR": {"Y": 30}})
    by_name = robot.distribute(tcp, axes={"X_LIN": 800}, locked=["y_lin"], current={"LINEAR": {"Y_LIN": 30}})
    mixed = robot.distribute(tcp, axes={"LINEAR.X_LIN": 800}, locked=["LINEAR.Y_LIN"], current={"LINEAR": {"Y": 30}})
    for one, other, third in zip(by_letter.partials, by_name.partials, mixed.partials, strict=True):
        assert np.array_equal(one.values, other.values)
        assert np.array_equal(one.values, third.values)
    assert by_name.partials[0].values[:2].tolist() == [800, 30]
    # While coupled, the robot's first axis stands for X of its tool: Y_ROB is Y, not the turn of axis 2.
    found = robot.distribute(tcp, axes={"Y_ROB": 123.0})
    assert found.partials[1].values[1] == 123.0
    with pytest.raises(ChainbuildError, match="X is not a coordinate of a partial") as caught:
        robot.distribute(tcp, locked=["X"])
    assert "Y_LIN" in str(caught.value.permitted)
    with pytest.raises(ChainbuildError, match="Y_TCP is not a coordinate of a partial"):
        robot.distribute(tcp, locked=["Y_TCP"])


def test_locks_of_the_list_stay_with_their_axis() -> None:
    lines = [*XY, "trafo[2].lock_dof[7] 1", "trafo[2].lock_dof[11] 1"]
    chain = machine("\n".join(lines) + "\n" + bezeichnungen(XY_NAMES)).chain()
    assert [partial.locked for partial in chain.partials] == [("Y",), ("A",)]


def test_two_steps_have_the_names_of_the_first() -> None:
    text = "trafo[0].id 9\nkin_step[1].trafo[0].id 58\ndefault_id_of_kin_step[0] 9\ndefault_id_of_kin_step[1] 58\n"
    plain, named = machine(text).chain(), machine(text + bezeichnungen({0: "X_BETT", 3: "C_KOPF", 4: "A_KOPF"})).chain()
    assert [axis.name for axis in named.axes] == ["X_BETT", "Y", "Z", "C_KOPF", "A_KOPF"]
    values = [100, 20, 30, 10, 20]
    assert np.array_equal(Robot(named).fk(values).homogeneous, Robot(plain).fk(values).homogeneous)


def test_the_names_of_the_type_in_another_order_are_told() -> None:
    found = machine("trafo[0].id 9\n" + bezeichnungen({0: "X", 1: "Y", 2: "Z", 3: "A", 4: "C"}))
    told = next(finding for finding in found.chain().findings if finding.code == "CB413")
    assert "called X, Y, Z, A, C, in another order than those of the type: X, Y, Z, C, A" in told.text
    assert told.span is not None
    assert told.span.line == 5
    assert [axis.name for axis in found.chain().axes] == ["X", "Y", "Z", "A", "C"]
    same = machine("trafo[0].id 9\n" + bezeichnungen({0: "x", 1: "Y", 2: "Z", 3: "C", 4: "A"}))
    assert "CB413" not in codes(same.chain())
