"""Verdicts of a control on a path close to singularities, as lines and as data."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

from chainbuild.cli.show import say, shown_number

if TYPE_CHECKING:
    from chainbuild.analysis.path.places import PathPlace
    from chainbuild.analysis.verdicts.blockverdicts import BlockVerdict, SingularityVerdicts

_MOST_BLOCKS: Final = 20  # printed: more say nothing new, and JSON has all


def print_verdicts(verdicts: SingularityVerdicts) -> None:
    """Print what the control makes of the blocks of a path."""
    say(f"for the control: {verdicts.sentence}")
    for block in verdicts.blocks[:_MOST_BLOCKS]:
        say(_block_line(block))
    if len(verdicts.blocks) > _MOST_BLOCKS:
        say(f"… {len(verdicts.blocks) - _MOST_BLOCKS} more blocks")
    if not verdicts.blocks:
        say("no block is singular" + (" or watched" if verdicts.handled else ""))
    for one in verdicts.excessive:
        speed = one.speed
        unit = "°/s" if speed.axis.unit == "deg" else " mm/s"
        needed = "∞" if math.isinf(speed.needed) else f"{speed.needed:.4g}"
        say(
            f"row {one.place.label}: {speed.name} needs {needed}{unit} and can {shown_number(speed.limit)}: alarm 10910"
        )
    if not verdicts.proven:
        say("searched by samples: a block that comes close without a singularity may be missing")
    for remark in verdicts.remarks:
        say(remark)


def _block_line(block: BlockVerdict) -> str:
    parts = ", ".join(
        f"{part.begin.label} … {part.end.label} ({part.length_mm:.4g} mm, least {part.value:.2g} at {part.least.label})"
        for part in block.parts
    )
    alarm = f": alarm {block.alarm}" if block.alarm else ""
    return f"rows {block.row + 1} … {block.row + 2}, {block.length_mm:.4g} mm: {block.level} at {parts}{alarm}"


def verdicts_data(verdicts: SingularityVerdicts) -> dict[str, Any]:
    """Return the verdicts for JSON; rows are counted from 1."""
    return {
        "between": verdicts.between,
        "measure": verdicts.measure,
        "singular_block": verdicts.singular_block,
        "threshold": verdicts.threshold,
        "clearance": verdicts.clearance,
        "handled": verdicts.handled,
        "sentence": verdicts.sentence,
        "proven": verdicts.proven,
        "blocks": [
            {
                "row": block.row + 1,
                "level": block.level,
                "length_mm": block.length_mm,
                "alarm": block.alarm,
                "value": block.value,
                "parts": [
                    {
                        "begin": _place(part.begin),
                        "end": _place(part.end),
                        "least": _place(part.least),
                        "value": part.value,
                        "length_mm": part.length_mm,
                    }
                    for part in block.parts
                ],
            }
            for block in verdicts.blocks
        ],
        "excessive": [
            {
                "name": one.speed.name,
                "needed": one.speed.needed if math.isfinite(one.speed.needed) else None,
                "limit": one.speed.limit,
                "alarm": 10910,
                **_place(one.place),
            }
            for one in verdicts.excessive
        ],
        "remarks": list(verdicts.remarks),
    }


def _place(place: PathPlace) -> dict[str, float]:
    return {"row": place.row + 1, "share": place.share, "path_mm": place.path_mm}
