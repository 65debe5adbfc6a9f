"""The overlay's named poses put on a chain, with findings on those that the machine cannot take."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from chainbuild.chain.axismap import refusal_of
from chainbuild.chain.elements import Axis, Chain
from chainbuild.chain.programmed.named import NamedPose
from chainbuild.closest import and_joined
from chainbuild.findings import Collector
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.text import POSES
from chainbuild.kinematics.limits import Limits


def with_named_poses(chain: Chain, overlay: Overlay, collector: Collector) -> Chain:
    """Return a chain, whole and with its limits, with the poses that the overlay names.

    Args:
        chain: The chain.
        overlay: What has the poses.
        collector: Takes a finding for each pose outside the limits, and where loops do not close.

    Raises:
        OverlayError: a pose has not exactly one value for each axis.
    """
    limits = Limits.of(chain)
    poses = tuple(_pose(overlay, chain.axes, name, given) for name, given in overlay.poses.items())
    for pose in poses:
        axes = np.array(pose.axes)
        span, parameter = overlay.span(POSES, pose.name), f"{POSES}.{pose.name}"
        if not np.isfinite(chain.axis_map.q(axes)).all():
            refusal = refusal_of(chain.axis_map, axes)
            why = f": {refusal.message}" if refusal is not None else ""
            text = f"the kinematic cannot take pose '{pose.name}'{why}"
            collector.add("CB503", text, span=span, parameter=parameter)
        elif limits.violated(axes):
            text = f"pose '{pose.name}' is outside the limits: {limits.words(axes)}"
            collector.add("CB502", text, span=span, parameter=parameter)
    return replace(chain, named_poses=poses)


def _pose(
    overlay: Overlay, axes: Sequence[Axis], name: str, given: Mapping[str, float] | tuple[float, ...]
) -> NamedPose:
    """Return a pose given as a list or by the axes' names."""
    keys, known = (POSES, name), ", ".join(axis.name for axis in axes)
    if isinstance(given, tuple):
        if len(given) != len(axes):
            text = f"pose '{name}' has {len(given)} values, the kinematic has {len(axes)} axes"
            raise overlay.error(text, keys, f"{len(axes)} values, in mm and degrees: {known}")
        return NamedPose(name, given)
    by_axis = overlay.by_axis(axes, keys, given)
    missing = [axis.name for n, axis in enumerate(axes) if n not in by_axis]
    if missing:
        text = f"pose '{name}' leaves out {and_joined(missing)}"
        raise overlay.error(text, keys, f"a value for each of {known}")
    return NamedPose(name, tuple(by_axis[n] for n in range(len(axes))))
