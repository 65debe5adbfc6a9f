"""A robot's page in the cell of a notebook, whose axis values Python reads and sets."""

from __future__ import annotations

import gzip
import tempfile
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from chainbuild.errors import ChainbuildError
from chainbuild.inspect.bundle import asset
from chainbuild.inspect.export import page_html
from chainbuild.inspect.scene import as_shown
from chainbuild.inspect.sweep import rest_pose
from chainbuild.painting.picture import picture
from chainbuild.shown import axes_shown, two_lines

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from numpy.typing import ArrayLike

    from chainbuild.arrays import Vector
    from chainbuild.kinematics.inputs import Pose
    from chainbuild.kinematics.mechanism import Mechanism
    from chainbuild.painting.overlay.measures import Dimension


class RobotView:
    """A robot's page in a notebook; `chainbuild.show` makes it, and it is a widget of ipywidgets at the same time.

    Several cells may show it: they stay in step. Python hears of the page between cells, not while one runs.

    Attributes:
        robot: The robot.
        axes: Axis values (n_axes,), mm and degrees, at which the page stands. Assigned, they move the page; the array
            itself cannot be written. An `AxisValueError` refuses a wrong count and what is not finite.
    """

    robot: Mechanism
    axes: Vector

    @property
    def pose(self) -> Pose:
        """The tool in the workpiece frame [m] at these axis values.

        Raises:
            ChainbuildError: the kinematic has no pose there.
        """
        return self.robot.fk(self.axes)

    def on_axes(self, callback: Callable[[Vector], object]) -> Callable[[], None]:
        """Call a function with the axis values (n_axes,), mm and degrees, whenever the page or Python changes them.

        Returns:
            What ends it.
        """

        def changed(change: Any) -> None:
            callback(change["new"])

        widget: Any = self
        widget.observe(changed, "axes")
        return lambda: widget.unobserve(changed, "axes")

    def __repr__(self) -> str:
        return two_lines(f"<RobotView {self.robot.chain.name}: {axes_shown(self.robot.labels, self.axes)}>")


def show(
    robot: Mechanism,
    *,
    at: ArrayLike | None = None,
    height: int = 560,
    dimensions: Iterable[Dimension] = (),
) -> RobotView:
    """Return a robot's page as a widget, which a notebook shows as the last value of a cell.

    Sliders, fields and arrows of the page move the robot; `axes` of what is returned follows, and moves the page when
    it is assigned. A notebook that is seen without its widgets, as on a site that hosts code, shows a picture.

    It needs the extra `notebook`; where Jupyter itself runs in another environment, anywidget is installed there, too.

    Args:
        robot: The robot.
        at: Axis values (n_axes,), mm and degrees, at which the page opens; None: a pose that shows the machine well.
        height: Height of the page in pixels.
        dimensions: Lengths of the machine data that the page can show; see `chainbuild.dimensions`.

    Raises:
        AxisValueError: `at` has the wrong count of values, or one that is not finite.
        ChainbuildError: the extra is not installed, the height is no number of pixels, or the kinematic has no pose to
            show.
    """
    if isinstance(height, bool) or not isinstance(height, int) or height <= 0:
        raise ChainbuildError(f"the height is {height!r:.40}", parameter="height", permitted="whole pixels from 1")
    widget = _widget_type()
    axes = rest_pose(as_shown(robot)) if at is None else robot.axis_values(at)
    page = page_html(robot, at=axes, dimensions=dimensions, more={"embedded": True})
    return widget(robot, axes, page, height)


@cache
def _widget_type() -> Callable[[Mechanism, Vector, str, int], RobotView]:
    """Return the class of the widget, which is made of a library that only notebooks need."""
    try:
        import anywidget
        import traitlets
    except ImportError:
        hint = "pip install 'chainbuild[notebook]'; `chainbuild inspect --export` and `export_page` do without"
        raise ChainbuildError("a page in a notebook needs anywidget, which is not installed", hint=hint) from None

    class AxisValues(traitlets.TraitType):
        """Axis values that the robot has checked; what is equal is no change."""

        def validate(self, view: RobotView, value: Any) -> Vector:
            axes = view.robot.axis_values(value)
            axes.flags.writeable = False  # a value written into it would reach no page
            return axes

        def set(self, view: Any, value: Any) -> None:
            old = view._trait_values.get(self.name)
            if old is None or not np.array_equal(old, self.validate(view, value)):
                super().set(view, value)

    class Widget(RobotView, anywidget.AnyWidget):
        _esm = asset("notebook/widget.js")
        _page = traitlets.Bytes().tag(sync=True)
        _title = traitlets.Unicode().tag(sync=True)
        _height = traitlets.Int().tag(sync=True)
        axes = AxisValues().tag(sync=True, to_json=lambda axes, _: axes.tolist(), from_json=lambda axes, _: axes)

        def __init__(self, robot: Mechanism, axes: Vector, page: str, height: int) -> None:
            self.robot = robot
            packed = gzip.compress(page.encode(), mtime=0)
            super().__init__(axes=axes, _page=packed, _title=robot.chain.title, _height=height)

        def _repr_mimebundle_(self, **kwargs: Any) -> tuple[dict[str, Any], dict[str, Any]]:
            data, metadata = super()._repr_mimebundle_(**kwargs)
            return {**data, **_fallback(self)}, metadata

    return Widget


def _fallback(view: RobotView) -> dict[str, str]:
    """Return what is seen where no widgets are: a picture, by its MIME type; nothing where there is no pose."""
    with tempfile.TemporaryDirectory() as folder, suppress(ChainbuildError):
        path = picture(view.robot, Path(folder) / "robot.svg", view.axes)
        return {"image/svg+xml": path.read_text("utf-8")}
    return {}
