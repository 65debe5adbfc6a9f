"""The mutants still find what they mutate and the tests that should notice."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.kit.paths import PACKAGE, ROOT
from tests.mutants.__main__ import targets, types_in

TARGETS = targets()


@pytest.mark.parametrize("path", TARGETS, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_file_and_tests_are_there(path: Path) -> None:
    assert path.is_file()
    folders = [word for word in TARGETS[path] if word.startswith("tests")]
    assert folders
    assert all((ROOT / word).exists() for word in folders)


def test_every_room_that_signs_pass_through_is_mutated() -> None:
    rooms = {str(path.parent.relative_to(PACKAGE)) for path in TARGETS}
    twincat = {f"formats/twincat/{room}" for room in ("families", "maps", "recipes", "coupling", "types", "universal")}
    robx = {"formats/sinumerik/geometry", "formats/sinumerik/rules"}
    chain = {"chain", "chain/bodies", "chain/programmed", "coupling", "kinematics", "ik"}
    assert rooms == {*twincat, *robx, *chain, "formats/twincat"}


def test_the_types_of_a_family_are_read_from_its_file() -> None:
    assert types_in(PACKAGE / "formats" / "twincat" / "families" / "scara.py") == (36,)
