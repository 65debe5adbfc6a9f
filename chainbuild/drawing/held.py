"""Robots that carry the workpiece to a tool that stands still: drawn like others, in other colours."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from chainbuild.chain.bodies.body import BASE_COLOUR, TOOL_COLOUR, TOOL_SIDE, WORKPIECE_SIDE, Body, rounded_body
from chainbuild.chain.bodies.shapes import machine_size
from chainbuild.chain.elements import BASE_LINK, Chain, Frame
from chainbuild.chain.poses import path_to
from chainbuild.frames import translation

_TURNS: Final = 4  # rotary axes that carry the workpiece: a table of a machine tool has three at most
# Of the machine's size: the tool that stands still, and its post.
_LENGTH: Final = 0.07
_SLIM: Final = 0.008
_STOUT: Final = 0.02


def holds_workpiece(chain: Chain) -> bool:
    """Return whether a robot carries the workpiece, and nothing carries the tool."""
    turns = sum(joint.kind == "revolute" for joint in path_to(chain, chain.frame("workpiece").link))
    return chain.frame("tool").link == BASE_LINK and (turns >= _TURNS or chain.dialect == "SINUMERIK ROBX")


def as_tool_carrier(chain: Chain) -> Chain:
    """Return the same robot with the workpiece for its tool, which the rules for robots draw."""
    swapped = {
        "tool": replace(chain.frame("workpiece"), name="tool"),
        "workpiece": Frame("workpiece", BASE_LINK, np.eye(4)),
    }
    return replace(chain, frames=tuple(swapped.get(frame.name, frame) for frame in chain.frames))


def recoloured(chain: Chain, bodies: Sequence[Body]) -> list[Body]:
    """Return the bodies in the colours of what carries the workpiece, and the tool that stands still on its post."""
    colours = dict(zip(TOOL_SIDE, WORKPIECE_SIDE, strict=True))
    found = [replace(body, colour=colours.get(body.colour, body.colour)) for body in bodies]
    size, (x, y, z) = machine_size(chain), chain.frame("tool").T_link_frame[:3, 3].tolist()
    length = _LENGTH * size
    place, tool = translation(x, y, z - length / 2), (_SLIM * size, length)
    found.append(rounded_body(BASE_LINK, "tool", place, "cylinder", tool, TOOL_COLOUR, "data"))
    height = z - length
    if height > 0.0:
        post, shape = translation(x, y, height / 2), (_STOUT * size, height)
        found.append(rounded_body(BASE_LINK, "post", post, "cylinder", shape, BASE_COLOUR))
    return found
