"""Which axis a name means, and the channel's own names put on a chain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.assemble import rotary, shift
from chainbuild.chain.check import check_chain
from chainbuild.chain.compose import beside, displaced, follow, stack
from chainbuild.chain.elements import Axis, Chain
from chainbuild.chain.names import (
    RESERVED_COLUMNS,
    axis_index,
    channel_names,
    link_names,
    name_fault,
    renamed,
)
from chainbuild.frames import translation
from chainbuild.tables import PoseForm
from chainbuild.tables.axes import RESULT_COLUMNS, VIOLATIONS_COLUMN
from tests.kit.sample_chains import chain_of


def axes_of(*names: str) -> list[Axis]:
    """Return axes from "NAME" or "NAME=GENERIC"."""
    pairs = [name.partition("=") for name in names]
    return [replace(Axis.unlimited(name, "rotary"), generic=generic) for name, _, generic in pairs]


@pytest.mark.parametrize(
    ("axes", "name", "found"),
    [
        (("RA1=A1", "RA2=A2"), "RA2", 1),
        (("RA1=A1", "RA2=A2"), "A2", 1),
        (("RA1=A1", "RA2=A2"), "a1", 0),
        (("RA1=A1", "RA2=A2"), "rA2", 1),
        (("RA1=A1", "RA2=A2"), "A3", None),
        (("RA1=A1", "RA2=A2"), "", None),
        (("X", "Y"), "", None),
        (("X", "Y"), "y", 1),
        # The channel calls the second axis A1: then A1 is the second, whatever the transformation calls the first.
        (("A2=A1", "A1=A2"), "A1", 1),
        (("A2=A1", "A1=A2"), "a2", 0),
        (("B=A1", "a1=A2"), "A1", 1),
        # Where case would have to decide, only the exact name does.
        (("x", "X"), "X", 1),
        (("xY", "Xy"), "XY", None),
        (("P=q", "R=Q"), "Q", 1),
        (("P=qQ", "R=Qq"), "QQ", None),
        # The same generic name of two axes means neither.
        (("P=X", "R=X"), "X", None),
        (("STRASSE=A", "B"), "straße", 0),
    ],
)
def test_which_axis_a_name_means(axes: tuple[str, ...], name: str, found: int | None) -> None:
    assert axis_index(axes_of(*axes), name) == found


@pytest.mark.parametrize(
    ("given", "names", "lost"),
    [
        (("", "", ""), ("X", "Y", "C"), ()),
        (("XB", "", "CD"), ("XB", "Y", "CD"), ()),
        (("Y", "", ""), ("Y", "Y_2", "C"), (1,)),
        (("c", "Y", ""), ("c", "Y", "C_2"), (2,)),
        (("Y", "X", ""), ("Y", "X", "C"), ()),
        (("Y", "", "Y_2"), ("Y", "Y_3", "Y_2"), (1,)),
    ],
)
def test_a_channel_that_names_some(given: tuple[str, ...], names: tuple[str, ...], lost: tuple[int, ...]) -> None:
    assert channel_names(axes_of("X", "Y", "C"), given) == (names, lost)


@pytest.mark.parametrize("name", [*RESERVED_COLUMNS, "X_drive", "STATUS", "Is", "QW", "X_MM"])
def test_names_of_columns_are_reserved(name: str) -> None:
    fault = name_fault(name)
    assert fault is not None
    assert name in fault[0]


@pytest.mark.parametrize(
    "name", ["", "A B", "A,B", "A;B", 'A"B', "A'B", "A<B", "A&B", "A[1]", "A.B", "A=1", "1", "\x07A", "A\n"]
)
def test_names_that_files_could_not_hold(name: str) -> None:
    assert name_fault(name) is not None


@pytest.mark.parametrize("name", ["X", "X_LIN", "Q1", "Achse_Ä", "C-1", "_X", "DRIVE", "ROWS", "ISO"])
def test_names_that_are_permitted(name: str) -> None:
    assert name_fault(name) is None


def test_every_column_of_the_tables_is_reserved() -> None:
    assert {*PoseForm("ypr", "direction").permitted(), *RESULT_COLUMNS, VIOLATIONS_COLUMN} <= set(RESERVED_COLUMNS)


def chain(machine: str) -> Chain:
    return chainbuild.load(machine).chain()


@pytest.mark.parametrize("machine", ["ac_table_kin58", "cardan_head_kin59", "plasma_head_kin25", "irb2600_track"])
def test_joints_and_links_follow_and_poses_stay(machine: str) -> None:
    old = chain(machine)
    new = renamed(old, [f"Q{n}" for n in range(len(old.axes))])
    check_chain(new)
    place = {axis.name: n for n, axis in enumerate(old.axes)}
    for before, after in zip(old.joints, new.joints, strict=True):
        wanted = f"Q{place[before.name]}" if before.name in place else before.name
        assert (after.name, after.child) == (wanted, f"{wanted}_link")
    assert [axis.generic for axis in new.axes] == [axis.name for axis in old.axes]
    rng = np.random.default_rng(1)
    for _ in range(5):
        values = [axis.lower + rng.random() * (axis.upper - axis.lower) for axis in old.axes]
        try:
            T = chainbuild.Robot(old).fk(values).homogeneous
        except chainbuild.ChainbuildError:
            continue
        assert np.array_equal(chainbuild.Robot(new).fk(values).homogeneous, T)
    back = renamed(new, [axis.name for axis in old.axes])
    assert [joint.name for joint in back.joints] == [joint.name for joint in old.joints]
    assert back.axes == old.axes


def test_swapped_names_leave_no_trace_of_the_old() -> None:
    old = chain("kr6r900")
    names = ["A2", "A1", "A3", "A4", "A5", "A6"]
    new = renamed(old, names)
    assert [joint.name for joint in new.joints] == names
    assert [joint.child for joint in new.joints] == [f"{name}_link" for name in names]
    assert link_names(new)["A1_link"] == "A1_link"
    assert new.frame("tool").link == "A6_link"


def test_joints_without_an_axis_make_way() -> None:
    old = chain("plasma_head_kin25")
    new = renamed(old, ["X", "Y", "Z", "C", "nozzle"])
    check_chain(new)
    assert [joint.name for joint in new.joints] == ["X", "Y", "Z", "C", "nozzle", "nozzle_2"]


def test_whole_turns_stay_whole_turns() -> None:
    from chainbuild.ik.region import periodic_axes

    for machine in ("cardan_head_kin59", "rotated_head_kin70", "plasma_head_kin25"):
        old = chain(machine)
        new = renamed(old, [f"Q{n}" for n in range(len(old.axes))])
        assert periodic_axes(new).tolist() == periodic_axes(old).tolist()
        assert periodic_axes(old).any()


def test_refusals_name_the_channel_s_axis() -> None:
    old = chain("cardan_head_kin59")
    robot = chainbuild.Robot(renamed(old, ["X", "Y", "Z", "C_DREH", "A_SCHWENK"]))
    with pytest.raises(chainbuild.ChainbuildError, match="A_SCHWENK = 95") as caught:
        robot.fk([0, 0, 0, 0, 95])
    assert caught.value.parameter == "A_SCHWENK"
    nozzle = chainbuild.Robot(renamed(chain("plasma_head_kin25"), ["X", "Y", "Z", "C", "A_DUESE"]))
    with pytest.raises(chainbuild.ChainbuildError, match="nozzle is horizontal") as caught:
        nozzle.fk([0, 0, 0, 0, 90])
    assert caught.value.parameter == "A_DUESE"


def named(machine: str, prefix: str) -> Chain:
    plain = chain(machine)
    return renamed(plain, [f"{prefix}{n}" for n in range(1, len(plain.axes) + 1)])


def test_a_composed_chain_keeps_both_names_unique() -> None:
    lower, upper = named("gantry_ss", "P"), named("kr6r900", "Q")
    both = stack(lower, translation(), upper)
    assert [axis.name for axis in both.axes][-1] == "Q6"
    # gantry and arm both have a generic A1: the arm's is prefixed, as names are.
    assert axis_index(both.axes, "A1") == 0
    assert axis_index(both.axes, "kr6r900_A1") == len(lower.axes)
    assert axis_index(both.axes, "Q1") == len(lower.axes)
    assert [axis.generic for axis in both.partials[1].chain.axes] == [f"A{n}" for n in range(1, 7)]


@pytest.mark.parametrize("how", ["stack", "follow", "beside"])
def test_two_of_one_name(how: str) -> None:
    one = named("kr6r900", "Q")
    made = {
        "stack": lambda: stack(one, translation(), displaced(one, translation())),
        "follow": lambda: follow(one, workpiece_of=one),
        "beside": lambda: beside(one, one),
    }
    both = made[how]()
    check_chain(both)
    assert [axis.name for axis in both.axes[6:]] == [f"kr6r900_Q{n}" for n in range(1, 7)]
    assert [axis.generic for axis in both.axes[6:]] == [f"kr6r900_A{n}" for n in range(1, 7)]
    assert axis_index(both.axes, "A3") == 2
    assert axis_index(both.axes, "kr6r900_A3") == 8


def test_a_composed_chain_can_be_renamed() -> None:
    both = stack(chain("gantry_ss"), translation(), chain("kr6r900"))
    count = len(both.axes)
    new = renamed(both, [f"Q{n}" for n in range(count)])
    check_chain(new)
    for partial in new.partials:
        check_chain(partial.chain)
        first = partial.first_axis
        assert [axis.name for axis in partial.chain.axes] == [f"Q{first + n}" for n in range(len(partial.chain.axes))]
    assert [axis.generic for axis in new.partials[1].chain.axes] == [f"A{n}" for n in range(1, 7)]


def test_one_axis_alone() -> None:
    new = renamed(chain_of("one", axes_of("A"), [rotary("A", "z"), shift(x=100.0)]), ["C_DREH"])
    assert [joint.name for joint in new.joints] == ["C_DREH"]
    assert axis_index(new.axes, "c_dreh") == 0
    both = stack(new, translation(), new)
    assert both.axes[0].name == "C_DREH"
    assert axis_index(both.axes, new.axes[0].generic) == 0
