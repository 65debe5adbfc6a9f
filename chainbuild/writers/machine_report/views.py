"""The chapter of pictures: from the front, the right, above and at an angle, with frames and lengths."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from chainbuild.errors import ChainbuildError
from chainbuild.painting.picture import drawing_svg
from chainbuild.painting.stage import Stage
from chainbuild.painting.views import ViewName
from chainbuild.writers.machine_report.checkform import bodies_in_words
from chainbuild.writers.machine_report.document.blocks import Chapter, Drawing, Drawings, Paragraph, ReportBlock
from chainbuild.writers.machine_report.document.numbers import named_values

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Mechanism
    from chainbuild.painting.overlay.measures import Dimension

_SIZE: Final = (640, 480)  # pixels: letters that can be read with two pictures beside each other
_VIEWS: Final[tuple[tuple[ViewName, str], ...]] = (
    ("front", "From the front"),
    ("right", "From the right"),
    ("top", "From above"),
    ("iso", "At an angle, from the front, the right and above"),
)
# What the manuals call the frames.
_CALLED: Final = {
    "SINUMERIK ROBX": {"base": "base (WO)", "flange": "flange (FL)", "tool": "tool (TCP)"},
    "TwinCAT CNC": {"base": "base (MCS)", "tool": "tool (TCP)"},
}


def _bodies(robot: Mechanism) -> str:
    said = f"Bodies are {bodies_in_words(robot.chain)}."
    if robot.chain.dialect == "URDF":
        return said
    data = "DH parameters" if robot.chain.dialect == "Denavit-Hartenberg" else "Machine data"
    return f"{said} {data} say nothing of castings."


def pictures_chapter(robot: Mechanism, lengths: Sequence[Dimension]) -> Chapter:
    """Return the chapter of pictures, the machine at home."""
    try:
        stage = Stage(robot)
    except ChainbuildError as reason:
        return Chapter("Pictures", [Paragraph.of(f"The machine has no pose at home: {reason.message}.")])
    called = _CALLED.get(robot.chain.dialect, {})
    drawn = tuple(Drawing(view, title, drawing_svg(stage, view, _SIZE, lengths, called)) for view, title in _VIEWS)
    home = named_values(robot.axes, stage.axes.tolist())
    told = "Frames are drawn red, green, blue for x, y, z."
    if lengths:
        told += (
            " Blue lines are lengths of the machine data that are not 0, from where what they place would be without."
        )
    blocks: list[ReportBlock] = [
        Paragraph.of(f"At home: {home}. {told} {_bodies(robot)}"),
        Drawings(drawn),
    ]
    return Chapter("Pictures", blocks)
