"""Bodies that files give stay where they are when chains are composed, also on links whose joints are turned around."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

import chainbuild
from chainbuild.arrays import Matrix
from chainbuild.chain.axismap import joint_values
from chainbuild.chain.bodies.geometry import Geometry, Shape
from chainbuild.chain.bodies.placed import moved_shape, shape_place
from chainbuild.chain.compose import stack
from chainbuild.chain.elements import Chain
from chainbuild.chain.poses import frame_placement, link_placements
from chainbuild.frames import f_frame, inverse
from tests.kit.draws import random_axes

NAMES = ("kr6r900", "ac_table_kin58", "cac_table_kin64")
T_OFFSET = f_frame((0.3, -0.2, 0.5), (30.0, -40.0, 110.0))


def with_bodies(name: str, rng: np.random.Generator) -> Chain:
    """Return a machine whose every link has a ball, a bar and a block, and the ball alone to look at."""
    chain = chainbuild.load(name).chain()
    shapes = {}
    for link in chain.links:
        place = (*rng.normal(size=3).tolist(), *rng.uniform(-170, 170, 3).tolist())
        shapes[link.name] = (
            Shape("sphere", points=tuple(rng.normal(size=3).tolist()), radius=0.1),
            Shape("capsule", points=tuple(rng.normal(size=6).tolist()), radius=0.1),
            Shape("box", size=(0.1, 0.2, 0.3), place=place),
        )
    visuals = {link: own[:1] for link, own in shapes.items()}
    return replace(chain, geometry=Geometry(shapes=shapes, visuals=visuals))


def places(shape: Shape) -> Matrix:
    """Return points (n, 4) that tell where a shape is."""
    if shape.points:
        points = np.reshape(shape.points, (-1, 3))
    else:
        T = f_frame(shape.place[:3], shape.place[3:])
        points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]) @ T[:3, :3].T + T[:3, 3]
    return np.column_stack([points, np.ones(len(points))])


def seen(chain: Chain, axes: np.ndarray, table: str) -> list[Matrix]:
    """Return where the shapes of a chain are in its base."""
    links = link_placements(chain, joint_values(chain.axis_map, axes))
    found = getattr(chain.geometry, table)
    return [places(shape) @ links[link].T for link, own in found.items() for shape in own]


@pytest.mark.parametrize(("a", "b"), list(itertools.product(NAMES, NAMES)))
@pytest.mark.parametrize("table", ["shapes", "visuals"])
def test_every_body_stays_where_it_is(a: str, b: str, table: str) -> None:
    rng = np.random.default_rng(4)
    lower, upper = with_bodies(a, rng), with_bodies(b, rng)
    whole, n = stack(lower, T_OFFSET, upper), len(lower.axes)
    axes = random_axes(whole, rng)
    T = frame_placement(lower, "tool", axes[:n]) @ T_OFFSET @ inverse(frame_placement(upper, "workpiece", axes[n:]))
    expected = seen(lower, axes[:n], table) + [points @ T.T for points in seen(upper, axes[n:], table)]
    found = seen(whole, axes, table)
    assert len(found) == len(expected)
    for one in expected:
        assert min(np.abs(one - other).max() for other in found if other.shape == one.shape) < 1e-9


def test_a_link_that_is_drawn_keeps_its_drawn_body_alone() -> None:
    rng = np.random.default_rng(5)
    upper = with_bodies("kr6r900", rng)
    whole = stack(chainbuild.load("ac_table_kin58").chain(), T_OFFSET, upper)
    assert len(whole.geometry.shapes) == len(whole.geometry.visuals) == len(upper.links) - 1


def test_places_come_back() -> None:
    T = f_frame((1.0, 2.0, 3.0), (10.0, 90.0, -60.0))
    place = shape_place(T)
    np.testing.assert_allclose(f_frame(place[:3], place[3:]), T, atol=1e-12)
    block = Shape("box", size=(1.0, 1.0, 1.0), place=place)
    np.testing.assert_allclose(moved_shape(block, inverse(T)).place, np.zeros(6), atol=1e-9)
