"""What is seen of bodies: areas by hand, and the same as the pixels, which know nothing of polygons."""

from __future__ import annotations

import math

import numpy as np
import pytest

from chainbuild import Robot
from chainbuild.frames import rot_x, rot_y, rot_z
from chainbuild.painting.raster.sight import render
from chainbuild.painting.stage import PlacedBody, Stage, coordinate, framed
from chainbuild.painting.vector.facets import CONTACT_EDGE, HIDDEN_EDGE, OUTLINE_EDGE, Facet, hull_of
from chainbuild.painting.vector.hiding import _half, seen_pieces
from chainbuild.painting.views import VIEWS, View
from tests.kit.placed import area, placed

TOP, ISO = VIEWS["top"], VIEWS["iso"]


def pieces_of(bodies: list[PlacedBody], view: View) -> list[list[Facet]]:
    return seen_pieces([hull_of(body, view) for body in bodies], view.toward)


def seen_areas(bodies: list[PlacedBody], view: View) -> list[float]:
    """Return of each body the area [m²] that is seen of it."""
    return [sum(area(flat(piece, view)) for piece in pieces) for pieces in pieces_of(bodies, view)]


def flat(piece: Facet, view: View) -> list[tuple[float, float]]:
    return [(coordinate(point, view.right), coordinate(point, view.up)) for point in piece.points]


def test_a_box_shows_its_faces() -> None:
    box = placed("box", (0.3, 0.4, 0.5), (1, 2, 3))
    assert seen_areas([box], TOP) == pytest.approx([0.12])
    assert seen_areas([box], VIEWS["front"]) == pytest.approx([0.15])
    assert seen_areas([box], VIEWS["right"]) == pytest.approx([0.20])
    x, y, z = (abs(part) for part in ISO.toward)
    assert seen_areas([box], ISO) == pytest.approx([0.20 * x + 0.15 * y + 0.12 * z])


def test_what_is_above_hides_what_is_below() -> None:
    low, high = placed("box", (0.4, 0.4, 0.1), (0, 0, 0)), placed("box", (0.2, 0.2, 0.1), (0.2, 0.05, 0.5))
    # The upper one covers 0.1 × 0.2 of the lower one, whichever comes first.
    assert seen_areas([low, high], TOP) == pytest.approx([0.14, 0.04])
    assert seen_areas([high, low], TOP) == pytest.approx([0.04, 0.14])
    edges = {edge for piece in pieces_of([low, high], TOP)[0] for edge in piece.edges}
    assert CONTACT_EDGE not in edges
    assert {OUTLINE_EDGE, HIDDEN_EDGE} <= edges


def test_boxes_that_enter_each_other_are_cut_where_they_meet() -> None:
    # A ridge turned by 45° rises by (√2 · 0.1 - 0.05) above a plate: it is seen as twice that wide.
    plate = placed("box", (1.0, 1.0, 0.1), (0, 0, 0))
    ridge = placed("box", (0.5, 0.2, 0.2), (0, 0, 0), rot_x(45.0))
    width = 2.0 * (0.1 * math.sqrt(2.0) - 0.05)
    assert seen_areas([plate, ridge], TOP) == pytest.approx([1.0 - 0.5 * width, 0.5 * width])
    edges = [edge for piece in pieces_of([plate, ridge], TOP)[1] for edge in piece.edges]
    assert edges.count(CONTACT_EDGE) == 2


@pytest.mark.parametrize("order", [1, -1])
def test_of_flush_faces_the_first_is_seen(order: int) -> None:
    bodies = [placed("box", (0.4, 0.4, 0.2), (0, 0, 0)), placed("box", (0.4, 0.4, 0.4), (0.2, 0, -0.1))][::order]
    assert seen_areas(bodies, TOP) == pytest.approx([0.16, 0.08])


def test_what_is_inside_is_not_seen() -> None:
    outer, inner = placed("cylinder", (0.3, 1.0), (0, 0, 0)), placed("sphere", (0.1,), (0, 0, 0.2))
    assert seen_areas([inner, outer], ISO)[0] == 0.0
    outer, inner = placed("box", (1, 1, 1), (0, 0, 0)), placed("box", (0.5, 0.5, 0.5), (0, 0, 0), rot_y(20.0))
    assert seen_areas([outer, inner], ISO)[1] == 0.0


def test_round_bodies_have_round_outlines() -> None:
    lying = placed("cylinder", (0.2, 1.0), (0, 0, 0), rot_y(90.0))
    assert seen_areas([lying], TOP) == pytest.approx([0.4])
    ball = placed("sphere", (0.2,), (0.3, 0, 0))
    assert seen_areas([ball], ISO) == pytest.approx([math.pi * 0.04], rel=7e-3)
    standing = placed("cylinder", (0.2, 1.0), (0, 0, 0))
    assert seen_areas([standing], TOP) == pytest.approx([math.pi * 0.04], rel=7e-3)
    # Seen from the side: the outline is exact at any turn of the body about itself.
    for angle in (0.0, 3.0, 17.0):
        turned = placed("cylinder", (0.2, 1.0), (0, 0, 0), rot_z(angle))
        assert seen_areas([turned], VIEWS["front"]) == pytest.approx([0.4])


def test_bodies_stand_on_their_heads() -> None:
    for turn in (np.eye(3), rot_x(180.0)):
        standing = placed("cylinder", (0.2, 1.0), (0, 0, 0), turn)
        assert seen_areas([standing], TOP) == pytest.approx([math.pi * 0.04], rel=7e-3)
        assert {piece.face for piece in pieces_of([standing], VIEWS["front"])[0]} == {2}
        (cap,) = pieces_of([standing], TOP)[0]
        assert hull_of(standing, TOP).normal(cap.face) == pytest.approx((0.0, 0.0, 1.0))


def test_faces_know_their_normals() -> None:
    turn = rot_z(20.0) @ rot_x(35.0)
    for view in VIEWS.values():
        hull = hull_of(placed("box", (0.3, 0.4, 0.5), (1, 2, 3), turn), view)
        for facet in hull.facets:
            a, b, c = (np.array(point) for point in facet.points[:3])
            normal = np.cross(b - a, c - b)
            assert hull.normal(facet.face) == pytest.approx(normal / np.linalg.norm(normal))
            assert np.dot(normal, view.toward) > 0.0
    for face in range(6):
        sign, axis = (1.0 if face % 2 else -1.0), turn[:, face // 2]
        assert hull.normal(face) == pytest.approx(sign * axis)


def test_a_cut_through_a_corner_adds_none() -> None:
    square = Facet(0, ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)), (1, 2, 3, 4))
    distances = [0.0, 1.0, 0.0, -1.0]
    assert _half(square, distances, 1.0, 9) == Facet(0, ((0, 0, 0), (1, 0, 0), (1, 1, 0)), (1, 2, 9))
    assert _half(square, distances, -1.0, 9) == Facet(0, ((0, 0, 0), (1, 1, 0), (0, 1, 0)), (9, 3, 4))


def random_bodies(rng: np.random.Generator, count: int) -> list[PlacedBody]:
    kinds = [("box", 3), ("cylinder", 2), ("sphere", 1)]
    found = []
    for n in range(count):
        kind, sizes = kinds[int(rng.integers(2))] if n else kinds[2]
        turn = rot_x(float(rng.uniform(-90, 90))) @ rot_z(float(rng.uniform(-180, 180)))
        turn = np.eye(3) if rng.random() < 0.4 else turn
        found.append(placed(kind, tuple(rng.uniform(0.1, 0.45, sizes)), rng.uniform(-0.5, 0.5, 3), turn))  # type: ignore[arg-type]
    return found


def compared(bodies: list[PlacedBody], view: View) -> None:
    """Compare the areas of polygons with the pixels of a fine picture.

    A border half a pixel off is up to 500 of its 630,000 pixels; where facets stand for round faces, 2 % of them.
    """
    window = framed(bodies, view, 900, 700)
    shown = render(bodies, view, window).bodies
    counts = np.bincount(shown[shown >= 0], minlength=len(bodies))
    areas = np.array(seen_areas(bodies, view)) * window.scale**2
    assert areas == pytest.approx(counts, abs=500.0, rel=0.02)


@pytest.mark.parametrize("seed", range(4))
def test_random_heaps_are_seen_as_pixels_show_them(seed: int) -> None:
    bodies = random_bodies(np.random.default_rng(seed), 12)
    compared(bodies, ISO)


@pytest.mark.parametrize("name", ["ac_table_kin58", "irb2600_track"])
@pytest.mark.parametrize("view", ["iso", "top"])
def test_machines_are_seen_as_pixels_show_them(name: str, view: str) -> None:
    compared(list(Stage(Robot.load(name)).bodies), VIEWS[view])  # type: ignore[index]
