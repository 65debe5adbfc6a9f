"""Named poses on the command line: in `chainbuild info`, and wherever axis values are given."""

from __future__ import annotations

import json
from pathlib import Path

from tests.kit.command_line import Run


def test_info_lists_named_poses(run: Run, tmp_path: Path) -> None:
    overlay = tmp_path / "o.toml"
    overlay.write_text("[poses]\npark = [0, -90.5, 90, 0, 0, 0]\n'tool change' = [1, -90, 90, 0, 30, 0]\n", "utf-8")
    shown = run("info", "kr6r900", "--overlay", str(overlay)).out
    assert "Named poses" in shown
    assert "0,-90.5,90,0,0,0" in shown
    data = json.loads(run("info", "kr6r900", "--overlay", str(overlay), "--json").out)
    assert data["poses"] == {"park": [0, -90.5, 90, 0, 0, 0], "tool change": [1, -90, 90, 0, 30, 0]}
    assert "Named poses" not in run("info", "kr6r900").out


def test_a_name_stands_for_axis_values(run: Run, tmp_path: Path) -> None:
    overlay = tmp_path / "o.toml"
    overlay.write_text("[poses]\npark = [0, -90.5, 90, 0, 20, 0]\n", "utf-8")
    given = "--overlay", str(overlay)
    by_name = run("fk", "kr6r900", "--at", "park", *given)
    assert by_name.code == 0
    assert by_name.out == run("fk", "kr6r900", "--at", "0,-90.5,90,0,20,0", *given).out
    page = tmp_path / "page.html"
    assert run("inspect", "kr6r900", "--export", str(page), "--at", "PARK", *given).code == 0
    assert '"rest":[0.0,-90.5,90.0,0.0,20.0,0.0]' in page.read_text("utf-8")
    refused = run("fk", "kr6r900", "--at", "home", *given)
    assert "or a named pose: park" in refused.err
