"""Laws of every drawing: nothing stands inside something else, nothing hangs in the air, nothing is missing."""

from __future__ import annotations

import numpy as np
import pytest

import chainbuild
from tests.kit.drawings import check_laws
from tests.kit.random_tools import random_tool

RANDOM = 200


@pytest.mark.parametrize("name", chainbuild.shipped())
def test_shipped_machines(name: str) -> None:
    check_laws(chainbuild.Robot.load(name).chain)


@pytest.mark.parametrize("seed", range(RANDOM))
def test_random_machine_tools(seed: int) -> None:
    check_laws(random_tool(np.random.default_rng(seed)))
