"""Point-vector programming without a robot: vector, kept angle or plane, and the nearer of two solutions."""

from __future__ import annotations

import math
import re
from itertools import pairwise, product
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from chainbuild.arrays import Matrix
from chainbuild.chain.programmed.vectors import (
    FIXED_AXIS_INDEX,
    VectorProgramming,
    check_condition,
    free_angle,
    kept_angle,
    rotation_from_vector,
)
from chainbuild.errors import ChainbuildError
from chainbuild.frames import ANGLE_MODES, angles_from_matrix, matrix_from_angles, rot_about, rot_x, rot_y, rot_z

MODES = ("ypr", "euler_c_first", "euler_a_first", "cba", "cab", "cba_std", "abc", "ab", "ba")
# By hand from P-CHAN-00112: the angle to keep where the vector is the tool's X, and where it is its Z.
FREE = {
    "ypr": "AC", "euler_c_first": "CA", "euler_a_first": "AC", "cba": "CA", "cab": "CC", "cba_std": "AC", "abc": "AC",
    "ab": "AC", "ba": "BC",
}  # fmt: skip
COUNT = 10_000
ODD = rot_about((1.0, -2.0, 3.0), 77.0)  # a rotation that nothing is special about


def product_of(mode: str, angles_deg: NDArray[np.float64]) -> Matrix:
    """Return rotations (n, 3, 3) of angles (n, 3) as the meaning of the mode is printed: "Rz(C)·Ry(-B)·Rx(A)"."""
    R = np.broadcast_to(np.eye(3), (len(angles_deg), 3, 3))
    for axis, sign, letter in re.findall(
        r"R([xyz])\((-?)([ABC])\)", ANGLE_MODES[mode].meaning.replace("C follows", "Rz(C)")
    ):
        angle = np.radians(angles_deg[:, "ABC".index(letter)]) * (-1.0 if sign else 1.0)
        i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
        turn = np.tile(np.eye(3), (len(angle), 1, 1))
        turn[:, i, i] = turn[:, j, j] = np.cos(angle)
        turn[:, i, j], turn[:, j, i] = -np.sin(angle), np.sin(angle)
        R = R @ turn
    return R


def drawn(mode: str, count: int, seed: int) -> tuple[NDArray[np.float64], Matrix]:
    """Return angles and their rotations, a tenth of a degree away from gimbal lock."""
    rng = np.random.default_rng(seed)
    angles = rng.uniform(-180.0, 180.0, (4 * count, 3))
    middle = ANGLE_MODES[mode].factors[1][1]
    locked = 0.0 if mode.startswith("euler") else 90.0
    off = (angles[:, "ABC".index(middle)] - locked) % 180.0
    angles = angles[(off > 0.1) & (off < 179.9)][:count]
    return angles, product_of(mode, angles)


def deviation(R: Matrix) -> float:
    return float(np.abs(np.swapaxes(R, -1, -2) @ R - np.eye(3)).max())


def turned_from(R: Matrix, before: Matrix) -> float:
    return math.degrees(math.acos(min(1.0, max(-1.0, (float(np.trace(before.T @ R)) - 1.0) / 2.0))))


# ---------------------------------------------------------------- a kept angle


@pytest.mark.parametrize(("mode", "axis"), list(product(MODES, "xz")))
def test_the_angle_that_leaves_the_vector_free(mode: str, axis: Any) -> None:
    assert free_angle(mode, axis) == FREE[mode]["xz".index(axis)]
    for letter in FIXED_AXIS_INDEX:
        reaches = reached(mode, letter, axis)
        assert reaches == (letter == free_angle(mode, axis)), letter


def reached(mode: str, letter: str, axis: str) -> bool:
    """Tell by trying whether the other two angles point the vector everywhere, the kept one being 50 degrees."""
    n = 60
    grid = np.stack(np.meshgrid(np.linspace(-180, 180, n), np.linspace(-180, 180, n)), axis=-1).reshape(-1, 2)
    angles = np.insert(grid, "ABC".index(letter), 50.0, axis=1)
    vectors = product_of(mode, angles)[:, :, "xyz".index(axis)]
    wanted = np.random.default_rng(5).normal(size=(200, 3))
    wanted /= np.linalg.norm(wanted, axis=1)[:, None]
    return bool((wanted @ vectors.T).max(axis=1).min() > math.cos(math.radians(8.0)))


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("axis", "xz")
def test_a_rotation_comes_back_from_its_vector_and_its_kept_angle(mode: str, axis: Any) -> None:
    """The angles are drawn, their product is formed as printed; vector, kept angle and a nearby rotation suffice."""
    count = COUNT if axis == "x" and mode != "ab" else COUNT // 10  # ab has the factors of abc
    how = VectorProgramming("vector_ijk", fixed=free_angle(mode, axis), axis=axis)
    angles, expected = drawn(mode, count, seed=1)
    kept = angles[:, "ABC".index(FREE[mode]["xz".index(axis)])]
    vectors = expected[:, :, "xyz".index(axis)]
    before = expected @ rot_about((1.0, 1.0, -1.0), 60.0)
    rows = zip(vectors.tolist(), before, kept.tolist(), strict=True)
    found = np.array([rotation_from_vector(how, mode, v, near, kept_deg=value) for v, near, value in rows])
    assert deviation(found) < 1e-12
    assert np.abs(found[:, :, "xyz".index(axis)] - vectors).max() < 1e-12
    np.testing.assert_allclose(found, expected, atol=1e-12)


@pytest.mark.parametrize("mode", MODES)
def test_the_kept_angle_is_that_of_the_rotation_before(mode: str) -> None:
    how = VectorProgramming()
    _, before = drawn(mode, 50, seed=2)
    _, after = drawn(mode, 50, seed=3)
    for near, R in zip(before, after, strict=True):
        kept = kept_angle(how, mode, near)
        assert kept == angles_from_matrix(mode, near)["ABC".index(FREE[mode][0])]
        found = rotation_from_vector(how, mode, R[:, 0], near)
        np.testing.assert_array_equal(found, rotation_from_vector(how, mode, R[:, 0], near, kept_deg=kept))
        # Half a turn more of the kept angle is the same.
        same = rotation_from_vector(how, mode, R[:, 0], near, kept_deg=kept + 180.0)
        np.testing.assert_allclose(same, found, atol=1e-12)
        assert (kept_angle(how, mode, found) - kept + 90.0) % 180.0 - 90.0 == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("mode", MODES)
def test_a_flipped_sign_would_be_seen(mode: str) -> None:
    how = VectorProgramming()
    angles, expected = drawn(mode, 20, seed=4)
    for values, R in zip(angles, expected, strict=True):
        kept = values["ABC".index(FREE[mode][0])]
        assert np.abs(rotation_from_vector(how, mode, -R[:, 0], R, kept_deg=kept) - R).max() > 0.1
        if min(abs(math.sin(math.radians(kept))), abs(math.cos(math.radians(kept)))) > 0.1:
            assert np.abs(rotation_from_vector(how, mode, R[:, 0], R, kept_deg=-kept) - R).max() > 0.01


@pytest.mark.parametrize("how", [VectorProgramming(), VectorProgramming(plane=1), VectorProgramming(plane=2)])
def test_the_nearer_of_two_solutions_half_a_turn_apart(how: VectorProgramming) -> None:
    rng = np.random.default_rng(6)
    for _ in range(200):
        v, before = rng.normal(size=3), rot_about(rng.normal(size=3), rng.uniform(0.0, 180.0))
        R = rotation_from_vector(how, "cba", v, before, kept_deg=33.0)
        other = rot_about(v, 180.0) @ R
        assert turned_from(R, before) <= turned_from(other, before) + 1e-9
        np.testing.assert_allclose(rotation_from_vector(how, "cba", v, other, kept_deg=33.0), other, atol=1e-12)


# ---------------------------------------------------------------- a tool axis in a plane


@pytest.mark.parametrize(("plane", "inside", "normal"), [(1, 2, 1), (2, 1, 0)])
def test_a_tool_axis_lies_in_the_plane(plane: Any, inside: int, normal: int) -> None:
    vectors = np.random.default_rng(7).normal(size=(COUNT, 3)) * 250.0
    how = VectorProgramming(plane=plane)
    found = np.array([rotation_from_vector(how, "ypr", v, ODD) for v in vectors])
    lengths = np.linalg.norm(vectors, axis=1)[:, None]
    assert deviation(found) < 1e-12
    assert np.linalg.det(found) == pytest.approx(1.0)
    assert np.abs(found[:, :, 0] - vectors / lengths).max() < 1e-12
    assert np.abs(found[:, normal, inside]).max() < 1e-12
    # The other plane would not do.
    assert np.abs(found[:, 1 - normal, 3 - inside]).max() > 0.5


def test_plane_2_with_the_vector_along_z() -> None:
    R = rotation_from_vector(VectorProgramming(plane=2, axis="z"), "ypr", (0.0, 3.0, 4.0), np.eye(3))
    np.testing.assert_allclose(R, [[1, 0, 0], [0, 0.8, 0.6], [0, -0.6, 0.8]], atol=1e-15)


@pytest.mark.parametrize(("plane", "pole"), [(1, (0, 1, 0)), (1, (0, -7, 0)), (2, (1, 0, 0)), (2, (-0.1, 0, 0))])
def test_along_the_pole_the_spin_before_stays(plane: Any, pole: tuple[float, ...]) -> None:
    R = rotation_from_vector(VectorProgramming(plane=plane), "ypr", pole, ODD)
    v = np.array(pole) / np.linalg.norm(pole)
    between = np.cross(ODD[:, 0], v)
    swing = rot_about(between, math.degrees(math.atan2(float(np.linalg.norm(between)), float(ODD[:, 0] @ v))))
    np.testing.assert_allclose(R, swing @ ODD, atol=1e-12)
    np.testing.assert_allclose(rotation_from_vector(VectorProgramming(plane=plane), "ypr", v, R), R, atol=1e-15)


@pytest.mark.parametrize("before", [rot_z(90.0), rot_z(90.0) @ rot_x(33.0), rot_z(-90.0) @ rot_x(200.0)])
def test_from_one_pole_to_the_other_the_tools_y_stays(before: Matrix) -> None:
    R = rotation_from_vector(VectorProgramming(plane=1), "ypr", -before[:, 0], before)
    np.testing.assert_allclose(R, before @ rot_y(180.0), atol=1e-15)


@pytest.mark.parametrize("off", [1e-3, 1e-6, 1e-8, 1.1e-9, 0.9e-9, 1e-12, 1e-16, 1e-300])
@pytest.mark.parametrize("how", [VectorProgramming(), VectorProgramming(plane=1), VectorProgramming(plane=2)])
def test_close_to_the_pole_it_is_a_rotation_that_meets_the_vector(how: VectorProgramming, off: float) -> None:
    pole = {0: (off, 0.0, 1.0), 1: (off, -1.0, 0.0), 2: (1.0, off, 0.0)}[how.plane]
    R = rotation_from_vector(how, "cba", pole, ODD, kept_deg=20.0)
    assert deviation(R) < 1e-14
    np.testing.assert_allclose(R[:, 0], np.array(pole) / np.linalg.norm(pole), atol=1e-15)


@pytest.mark.parametrize("tilt", [30.0, 89.0, 89.9999999, 90.0])
def test_at_gimbal_lock_the_first_angle_stays(tilt: float) -> None:
    """Mode 2, C kept at 20, A at 50: the tool is raised to the vertical in the plane of A."""
    before = matrix_from_angles("cba", (50.0, -tilt, 20.0))
    R = rotation_from_vector(VectorProgramming(), "cba", (0.0, 0.0, 1.0), before, kept_deg=20.0)
    np.testing.assert_allclose(R, matrix_from_angles("cba", (50.0, -90.0, 20.0)), atol=1e-15)


# ---------------------------------------------------------------- the manual's two programs

EXAMPLE_1 = [
    (50, 0, 0), (0, 0, 1), (-0.0457, 0, 0.999), (-0.0457, 0, 0.999), (-0.0457, 0, 0.999), (0.0349, 0, 0.9994),
    (0.1013, 0, 0.9949), (0.1454, 0, 0.9894), (0.2111, 0, 0.9775), (0.2758, 0, 0.9612), (0.3393, 0, 0.9407),
    (0.4012, 0, 0.916), (0.6111, 0.0014, 0.7916), (0.0631, 0.0001, 0.998), (0, 0, 1),
]  # fmt: skip
EXAMPLE_2 = [
    (0, 0, 1), (-0.099, 0, 0.995), (-0.099, -0.006, 0.995), (-0.097, -0.018, 0.995), (-0.095, -0.025, 0.995),
    (-0.093, -0.031, 0.995), (-0.091, -0.037, 0.995), (-0.088, -0.043, 0.995), (-0.085, -0.049, 0.995),
    (-0.077, -0.06, 0.995), (-0.07, -0.068, 0.995), (-0.063, -0.075, 0.995), (-0.058, -0.079, 0.995),
    (-0.053, -0.082, 0.995), (-0.047, -0.086, 0.995), (-0.035, -0.091, 0.995), (-0.023, -0.095, 0.995),
    (-0.01, -0.097, 0.995), (-0.004, -0.098, 0.995), (0.002, -0.098, 0.995), (0.009, -0.097, 0.995),
    (0.015, -0.096, 0.995), (0.028, -0.093, 0.995), (0.041, -0.088, 0.995), (0.05, -0.083, 0.995),
    (0.055, -0.08, 0.995), (0.061, -0.076, 0.995), (0.07, -0.067, 0.995), (0.078, -0.057, 0.995),
]  # fmt: skip


def path(how: VectorProgramming, mode: str, vectors: list[tuple[float, float, float]], start: Matrix) -> list[Matrix]:
    kept = kept_angle(how, mode, start)
    rows = [start]
    for vector in vectors:
        rows.append(rotation_from_vector(how, mode, vector, rows[-1], kept_deg=kept))
    return rows[1:]


def steps_beyond(vectors: list[tuple[float, float, float]], rows: list[Matrix]) -> list[float]:
    """Return by how many degrees more than its vector the tool turns from row to row."""
    return [turned_from(b, a) - math.degrees(math.acos(min(1.0, float(a[:, 0] @ b[:, 0])))) for a, b in pairwise(rows)]


@pytest.mark.parametrize("mode", ["cba", "cab", "euler_c_first"])
@pytest.mark.parametrize("start", [(0.0, 0.0, 0.0), (0.0, 0.0, 45.0)])
def test_example_1_turns_no_further_than_its_vector(mode: str, start: tuple[float, float, float]) -> None:
    """FIXED_AX_IDX=5 goes with the angle modes 1, 2 and 3; the path passes through the vertical, the lock of mode 2."""
    how = VectorProgramming("vector_abc", fixed="C")
    # In the modes that turn about C first, a kept C of 45 would point the tool out of the plane of the program.
    first = matrix_from_angles(mode, start if mode == "cba" else (0.0, 0.0, 0.0))
    rows = path(how, mode, EXAMPLE_1, first)
    assert max(steps_beyond(EXAMPLE_1, rows)) < 0.2
    if mode == "cba":
        np.testing.assert_allclose(
            rows[5], matrix_from_angles("cba", (0.0, -math.degrees(math.atan2(0.9994, 0.0349)), start[2])), atol=1e-12
        )


def test_example_1_crosses_the_vertical_without_a_half_turn() -> None:
    """Rows 5 and 6 lie on either side of the vertical: A could as well jump by 180 degrees there."""
    rows = path(VectorProgramming(fixed="C"), "cba", EXAMPLE_1, np.eye(3))
    assert rows[4][0, 0] < 0.0 < rows[5][0, 0]
    assert turned_from(rows[5], rows[4]) == pytest.approx(2.6191 + 2.0, abs=1e-3)


@pytest.mark.parametrize("start", [rot_y(-90.0), rot_z(20.0) @ rot_y(-80.0)])
def test_example_2_turns_no_further_than_its_vector(start: Matrix) -> None:
    rows = path(VectorProgramming("vector_ijk", plane=1), "ypr", EXAMPLE_2, start)
    assert max(steps_beyond(EXAMPLE_2, rows)) < 0.2
    assert max(abs(row[1, 2]) for row in rows) < 1e-15


# ---------------------------------------------------------------- what is refused


@pytest.mark.parametrize(
    ("fixed", "mode", "text"),
    [
        ("C", "ypr", "FIXED_AX_IDX=5 keeps angle C.*permitted: 3 .angle A."),
        ("B", "cba", "FIXED_AX_IDX=4 keeps angle B.*permitted: 5 .angle C."),
        ("A", "cab", "FIXED_AX_IDX=3 keeps angle A.*permitted: 5 .angle C."),
        ("C", "abc", "permitted: 3 .angle A."),
    ],
)
def test_a_kept_angle_that_binds_the_vector_is_refused(fixed: Any, mode: str, text: str) -> None:
    how = VectorProgramming(fixed=fixed)
    with pytest.raises(ChainbuildError, match=text):
        check_condition(how, mode)
    with pytest.raises(ChainbuildError, match=text):
        rotation_from_vector(how, mode, (0.0, 0.0, 1.0), np.eye(3))


def test_a_plane_that_is_about_the_vector_itself_is_refused() -> None:
    with pytest.raises(ChainbuildError, match=r"is about the tool's Z, which is the vector itself.*permitted: 2"):
        rotation_from_vector(VectorProgramming(plane=1, axis="z"), "ypr", (0.0, 0.0, 1.0), np.eye(3))


@pytest.mark.parametrize(
    "fields",
    [
        {"fixed": "D"},
        {"fixed": 5},
        {"plane": 3},
        {"plane": "ZX"},
        {"mode": "VECTOR_IJK"},
        {"axis": "y"},
        {"axis": None},
    ],
)
def test_unknown_values_are_refused(fields: dict[str, Any]) -> None:
    with pytest.raises(ChainbuildError, match=f"{next(iter(fields))} is .*permitted"):
        VectorProgramming(**fields)


def test_an_angle_and_a_plane_exclude_each_other() -> None:
    with pytest.raises(ChainbuildError, match="22027"):
        VectorProgramming(fixed="C", plane=1)


@pytest.mark.parametrize(
    "vector",
    [
        (0, 0, 0),
        (0, 0),
        (0, 0, 1, 0),
        (math.nan, 0, 1),
        (0, math.inf, 0),
        "IJK",
        ("a", "b", "c"),
        None,
        [[0, 0, 1]],
        [(1,), 2],
    ],
)
def test_a_bad_vector_is_refused(vector: Any) -> None:
    with pytest.raises(ChainbuildError, match=r"vector is .*permitted: three finite numbers"):
        rotation_from_vector(VectorProgramming(), "ypr", vector, np.eye(3))


@pytest.mark.parametrize(
    "before", [np.eye(4), np.zeros((3, 3)), -np.eye(3), 2.0 * np.eye(3), np.full((3, 3), math.nan), None, "R"]
)
def test_a_bad_rotation_before_is_refused(before: Any) -> None:
    with pytest.raises(ChainbuildError, match=r"before.*permitted: a rotation"):
        rotation_from_vector(VectorProgramming(), "ypr", (0.0, 0.0, 1.0), before)


@pytest.mark.parametrize("kept", [math.nan, math.inf])
def test_a_bad_kept_angle_is_refused(kept: float) -> None:
    with pytest.raises(ChainbuildError, match="kept angle is"):
        rotation_from_vector(VectorProgramming(), "ypr", (0.0, 0.0, 1.0), np.eye(3), kept_deg=kept)


def test_an_unknown_angle_mode_is_refused() -> None:
    with pytest.raises(ChainbuildError, match="unknown angle mode 'zyx'"):
        rotation_from_vector(VectorProgramming(), "zyx", (0.0, 0.0, 1.0), np.eye(3))


@pytest.mark.parametrize("length", [1e-300, 1e-13, 1.0, 50.0, 1e300])
def test_any_length_but_zero(length: float) -> None:
    R = rotation_from_vector(VectorProgramming(), "cba", (0.6 * length, 0.0, 0.8 * length), np.eye(3))
    np.testing.assert_allclose(R[:, 0], (0.6, 0.0, 0.8), atol=1e-15)
