"""The data files of the KIN_TYPs as they are, and the words that may stand in them."""

from __future__ import annotations

import tomllib
from typing import Any

from tests.kit.paths import PACKAGE

CARRIES = {"t": "tool", "w": "workpiece"}
FAMILIES = {
    "head", "table", "mixed", "saw", "fixed_head", "cardan", "face", "arm", "scara", "palletiser", "lever",
    "linear_robot", "parallel",
}  # fmt: skip
EFFECTS = {"pose", "limit", "none", "control"}


def load(kin_typ: int) -> dict[str, Any]:
    """Parse the data file of one type."""
    with (PACKAGE / "formats" / "twincat" / "data" / f"kin{kin_typ:03d}.toml").open("rb") as file:
        return tomllib.load(file)
