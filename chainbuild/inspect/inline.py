"""A robot's page inside a notebook."""

from __future__ import annotations

from dataclasses import dataclass, field
from html import escape
from typing import TYPE_CHECKING

from chainbuild.inspect.export import page_html

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Mechanism


@dataclass(frozen=True, slots=True)
class InlinePage:
    """A self-contained page that notebooks show in place.

    Attributes:
        html: The whole page.
        height: Height of the frame in pixels.
    """

    html: str = field(repr=False)
    height: int

    def _repr_html_(self) -> str:
        style = f"width: 100%; height: {self.height}px; border: 0"
        return f'<iframe srcdoc="{escape(self.html)}" style="{style}"></iframe>'


def inline_page(robot: Mechanism, height: int = 560) -> InlinePage:
    """Return a robot's page for display as the last value of a notebook cell.

    Args:
        robot: The robot.
        height: Height of the frame in pixels.

    Raises:
        ChainbuildError: the kinematic has no pose to show.
    """
    return InlinePage(page_html(robot), height)
