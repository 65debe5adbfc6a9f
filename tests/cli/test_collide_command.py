"""`collide` on the command line: what it says of bodies that meet where castings would pass one another."""

from __future__ import annotations

import json

from tests.kit.command_line import Run

HOME = "0,0,0,0,0,0"


def test_a_pair_that_touches_at_home_already_is_told(run: Run) -> None:
    told = run("collide", "cac_table_kin64", "--at", HOME)
    assert told.code == 3
    assert "C1_link and C2_link touch at home already" in told.out
    remarks = json.loads(run("collide", "cac_table_kin64", "--at", HOME, "--json").out)["remarks"]
    assert [remark.split(" touch")[0] for remark in remarks] == ["C1_link and C2_link"]


def test_a_pair_that_is_clear_at_home_is_not(run: Run) -> None:
    folded = run("collide", "kr6r900_2", "--at", "0,0,156,0,0,0")
    assert folded.code == 3
    assert "at home" not in folded.out
