"""Named poses in `chainbuild info`."""

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
