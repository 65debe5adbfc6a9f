"""Finding numbers of this dialect: every one used is registered, every one registered is used."""

from __future__ import annotations

import re
from pathlib import Path

import chainbuild.formats.sinumerik
from chainbuild.findings import finding_kinds


def test_numbers_in_code_and_register_agree():
    folder = Path(chainbuild.formats.sinumerik.__file__).parent
    used = {code for path in folder.rglob("*.py") for code in re.findall(r"\bCB\d{3}\b", path.read_text("utf-8"))}
    registered = {code for code in finding_kinds() if code.startswith(("CB1", "CB3"))}
    assert used == registered
