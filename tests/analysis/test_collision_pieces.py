"""Lines of the tip cut into pieces along which the axes are nearly straight."""

from __future__ import annotations

import numpy as np
import pytest

from chainbuild import ChainbuildError, Robot, contacts
from chainbuild.analysis.collision import pieces
from chainbuild.analysis.collision.paths import collision_remarks
from chainbuild.analysis.collision.pieces import line_pieces


@pytest.fixture(scope="module")
def arm() -> Robot:
    return Robot.load("kr6r900")


LINE = np.array([[-40, -60, 80, 20, 50, 0], [35, -75, 95, -10, 65, 20], [35, -70, 90, -10, 60, 20]], dtype=float)


def test_the_pieces_are_on_the_line_and_their_middles_nearly(arm: Robot) -> None:
    parts = list(line_pieces(arm, LINE))
    assert [part.block for part in parts] == [0, 1]
    for part in parts:
        assert (part.shares[0], part.shares[-1]) == (0.0, 1.0)
        np.testing.assert_allclose(part.axes[[0, -1]], LINE[part.block : part.block + 2])
        begin, end = (arm.fk(row).translation for row in LINE[part.block : part.block + 2])
        for share, axes in zip(part.shares, part.axes, strict=True):
            np.testing.assert_allclose(arm.fk(axes).translation, begin + share * (end - begin), atol=1e-8)
        middles = (part.axes[1:] + part.axes[:-1]) / 2.0
        shares = (part.shares[1:] + part.shares[:-1]) / 2.0
        for share, axes in zip(shares, middles, strict=True):
            assert np.linalg.norm(arm.fk(axes).translation - begin - share * (end - begin)) < 2e-4
    assert len(parts[0].shares) > len(parts[1].shares)  # a long line bends its axes more


class Lost:
    """A motion that is not found in the middle of its block."""

    rows = LINE[:2]

    def __init__(self, robot: Robot) -> None:
        self.robot = robot

    def axes(self, blocks: np.ndarray, t: np.ndarray) -> np.ndarray:
        found = self.rows[0] + t[:, None] * (self.rows[1] - self.rows[0])
        found[(t > 0.4) & (t < 0.7)] = np.nan
        return found


def test_what_is_beyond_the_reach_is_left_out(arm: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pieces, "motion_of", lambda robot, rows, between: Lost(robot))
    first, second = line_pieces(arm, LINE[:2])
    assert (first.shares[0], second.shares[-1]) == (0.0, 1.0)
    assert 0.4 - 1.0 / 512.0 < first.shares[-1] <= 0.4  # its border is sought to the least piece
    assert 0.7 <= second.shares[0] < 0.7 + 1.0 / 512.0
    assert np.isfinite(first.axes).all()


def test_contacts_refuse_an_unknown_motion(arm: Robot) -> None:
    with pytest.raises(ChainbuildError, match="unknown motion"):
        next(contacts(arm, LINE, between="spline"), None)  # type: ignore[arg-type]


def test_what_is_sampled_is_said(arm: Robot) -> None:
    curved = Robot.load("rotated_head_kin70")
    assert collision_remarks(arm, "ptp") == ()
    assert [len(collision_remarks(arm, one)) for one in ("cp", "rows")] == [1, 1]
    assert [len(collision_remarks(curved, one)) for one in ("ptp", "cp", "rows")] == [1, 2, 1]
