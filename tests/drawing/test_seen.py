"""A picture shows what a machine does: every link, the tool and the part."""

from __future__ import annotations

from collections import Counter

import pytest

import chainbuild
from chainbuild.painting.picture import seen_from
from chainbuild.painting.stage import Stage
from chainbuild.painting.views import VIEWS
from tests.kit.drawings import body_pixels

LEAST = 20  # pixels of a picture 480 × 360
TIP = 8  # likewise of a tool, which is slim
# What stands inside another body: the crank of the level linkage in the elbow, the crosses in the balls of rods.
_CROSSES = {f"Z{n}_swing_link" for n in (1, 2, 3)}
INSIDE = {
    "palletiser_kin96": {"level_crank_link"},
    "tripod_kin12": _CROSSES,
    "tripod_table_kin209": _CROSSES,
}


@pytest.mark.parametrize("name", chainbuild.shipped())
def test_every_link_the_tool_and_the_part_are_seen(name: str) -> None:
    stage = Stage(chainbuild.Robot.load(name))
    near = seen_from(stage.pointing)
    pictures = [body_pixels(stage, view) for view in VIEWS.values()] + [body_pixels(stage, near, near=True)]
    iso, detail = pictures[0], pictures[-1]
    best: Counter[str] = Counter()
    for pixels in pictures:
        links: Counter[str] = Counter()
        for placed, count in zip(stage.bodies, pixels, strict=True):
            links[placed.body.link] += count
        best |= links
    hidden = {placed.body.link for placed in stage.bodies if best[placed.body.link] < LEAST}
    assert hidden <= INSIDE.get(name, set())
    for part, least in (("tool", TIP), ("workpiece", LEAST)):
        seen = [
            max(counts) for placed, *counts in zip(stage.bodies, iso, detail, strict=True) if placed.body.part == part
        ]
        assert not seen or max(seen) >= least, part
