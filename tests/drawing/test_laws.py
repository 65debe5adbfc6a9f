"""Laws of every drawing: nothing stands inside something else, nothing hangs in the air, nothing is missing."""

from __future__ import annotations

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.bodies.body import Body
from chainbuild.chain.elements import Chain
from chainbuild.drawing.machine import drawn_bodies
from tests.kit.drawings import bare_links, home_and_middle, islands, overlaps
from tests.kit.random_tools import random_tool

ALLOWED = 5e-4  # m: bodies that touch, rounded to micrometres and measured by an iteration
REACH = 1e-3  # m: what is nearer hangs together
RANDOM = 200


def check(chain: Chain) -> None:
    """Check the laws that hold for every machine."""
    bodies = drawn_bodies(chain)
    home, middle = home_and_middle(chain)
    for axes in (home, middle):
        assert overlaps(chain, bodies, axes, ALLOWED) == []
    assert len(islands(chain, bodies, home, REACH)) == 1
    assert bare_links(chain, bodies) == []
    assert all(is_sound(body) for body in bodies)


def is_sound(body: Body) -> bool:
    """Return whether a body has a size and a place, and says where both come from."""
    finite = np.isfinite(body.T_link_body).all() and np.isfinite(body.dimensions).all()
    return bool(finite and min(body.dimensions) > 0.0 and body.origin in ("data", "drawn"))


@pytest.mark.parametrize("name", chainbuild.shipped())
def test_shipped_machines(name: str) -> None:
    check(chainbuild.Robot.load(name).chain)


@pytest.mark.parametrize("seed", range(RANDOM))
def test_random_machine_tools(seed: int) -> None:
    check(random_tool(np.random.default_rng(seed)))
