"""What people see of names: unknown ones are answered by the most alike, objects say what they are."""

from __future__ import annotations

import pytest

import chainbuild
from chainbuild.errors import ChainbuildError


def permitted(call) -> str:
    with pytest.raises(ChainbuildError) as caught:
        call()
    return caught.value.permitted


@pytest.mark.parametrize(
    ("name", "first"), [("kr6r901", "kr6r900"), ("IRB2600_trak", "irb2600_track"), ("scara", "scara_")]
)
def test_unknown_machines_are_answered_by_the_most_alike(name: str, first: str) -> None:
    shown = permitted(lambda: chainbuild.load(name))
    assert shown.startswith(first)
    assert shown.endswith(f", … ({len(chainbuild.shipped())} in all)")
    assert len(shown.split(", ")) == 13


def test_unknown_conventions_are_answered_by_the_most_alike() -> None:
    machine = chainbuild.load("tx2_60")
    shown = permitted(lambda: machine.chain(conventions={"kin45_lenght_frame": "tool"}))
    assert shown.startswith("kin45_length_frame, ")
    assert " in all)" in shown
    assert permitted(lambda: machine.chain(conventions={"kin45_length_frame": "flang"})).startswith("flange")


def test_unknown_kinematics_are_answered_by_the_most_alike() -> None:
    assert permitted(lambda: chainbuild.load("kr6r900").chain("griper")) == "1 (gripper), 1 (ROBX)"


def test_objects_say_what_they_are() -> None:
    machine = chainbuild.load("kr6r900")
    chain = machine.chain()
    assert repr(machine) == "<Machine kr6r900.tea: SINUMERIK ROBX, ROBX NR, 6 axes>"
    assert repr(chain) == "<Chain kr6r900: ROBX NR, axes A1 … A6>"
    assert repr(chainbuild.Robot(chain)) == "<Robot kr6r900: ROBX NR, axes A1 … A6>"
    assert repr(chainbuild.load("c_face_kin14").chain()) == "<Chain c_face_kin14: KIN_TYP 14, axes X, C, Z>"
