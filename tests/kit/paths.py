"""Where the tests find the repository's folders, recorded machines and the benchmark's files."""

from __future__ import annotations

from pathlib import Path

TESTS = Path(__file__).parents[1]
ROOT = TESTS.parent
PACKAGE = ROOT / "chainbuild"
# Machine files with poses that controllers or other programs computed for them.
REFERENCE = TESTS / "data" / "reference"
