"""What is traced along lines, each with a bound of its rate; V = |v| + |ω|·|w| bounds the speed of the wrist point.

    shoulder   ρ changes by at most V
    elbow      D by at most V·(1 + |h|/r): axis 1 turns by V/r, and carries W sideways by h
    wrist      the angle between a4 and a6 by |ω forearm| + |ω tool|. The forearm turns about axis 1 by at most V/r and
               about axis 2 by at most V·(1 + |h|/r)/(l3·sin elbow): the shift of W across axis 2 seen along the upper
               arm, which only the forearm's turn can make
    pole       the angle between the two directions by |ω tool|

r and the elbow change over a step, too. No step lets r fall below half; the sine of the elbow is taken at the end of
the range of D where it is smaller, for it has a single maximum.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from chainbuild.analysis.vanishing.line import ArmGeometry, ArmPosition, Bend, LineBlocks, angles_between, arm_at
from chainbuild.analysis.vanishing.tracing import Blocks
from chainbuild.arrays import Matrix, Vector


@dataclass(frozen=True, slots=True, eq=False)
class ArmOnLines:
    """An arm along lines.

    Attributes:
        arm: Its geometry.
        lines: The blocks.
        branch: (N, 2) signs of the shoulder's and the elbow's factor at the begin of each block.
        near: Threshold of the factors.
    """

    arm: ArmGeometry
    lines: LineBlocks
    branch: Matrix
    near: float

    def at(self, blocks: Blocks, t: Vector) -> ArmPosition:
        """Return where the arm is at shares of blocks."""
        return arm_at(self.arm, *self.lines.poses(blocks, t), self.branch[blocks])

    def speed(self, blocks: Blocks) -> Vector:
        """Return V (n,) [m per block]."""
        turning = np.linalg.norm(self.lines.turns[blocks], axis=1)
        beside = float(np.linalg.norm(self.arm.wrist_point))
        return np.asarray(np.linalg.norm(self.lines.ways[blocks], axis=1) + turning * beside)

    def elbow_range(self, near: float) -> tuple[float, float]:
        """Return the distances D [m] below and above which the sine of the elbow is at most `near`."""
        a, b = self.arm.upper, self.arm.fore
        mixed = 2.0 * a * b * float(np.sqrt(1.0 - near * near))
        return float(np.sqrt(max(a * a + b * b - mixed, 0.0))), float(np.sqrt(a * a + b * b + mixed))

    def kept_shoulder(self, at: ArmPosition, speed: Vector) -> tuple[Vector, Vector]:
        """Return shares (n,) over which r stays above half, and 1 + |h|/r there."""
        if abs(self.arm.offset) < 1e-12 * self.arm.size:
            return np.full(len(speed), np.inf), np.ones(len(speed))
        half = np.abs(at.across) / 2.0
        with np.errstate(divide="ignore", invalid="ignore"):
            carried = 1.0 + abs(self.arm.offset) / half
            kept = np.where(speed > 0.0, half / (speed * carried), np.inf)
        return np.where(half > 0.0, kept, 0.0), carried


def _shares(margins: Vector, rates: Vector) -> Vector:
    shares: Vector = np.divide(margins, rates, out=np.full(len(margins), np.inf), where=rates > 0.0)
    return shares


@dataclass(frozen=True, slots=True, eq=False)
class ShoulderTraced:
    """The distance of the wrist point from axis 1."""

    on: ArmOnLines

    def margins(self, blocks: Blocks, t: Vector) -> Vector:
        """Return the distance above that at which the factor is at its threshold."""
        threshold = float(np.hypot(self.on.arm.offset, self.on.near * self.on.arm.size))
        return self.on.at(blocks, t).distance - threshold

    def sizes(self, blocks: Blocks, t: Vector) -> Vector:
        """Return the factors."""
        return np.abs(self.on.at(blocks, t).across) / self.on.arm.size

    def steps(self, blocks: Blocks, t: Vector, margins: Vector) -> Vector:
        """Return margin / V."""
        return _shares(margins, self.on.speed(blocks))


@dataclass(frozen=True, slots=True, eq=False)
class ElbowTraced:
    """The distance of the wrist point from axis 2, against its ends."""

    on: ArmOnLines

    def margins(self, blocks: Blocks, t: Vector) -> Vector:
        """Return the distance from the nearer end at which the factor is at its threshold."""
        least, most = self.on.elbow_range(self.on.near)
        reach = self.on.at(blocks, t).reach
        return np.minimum(reach - least, most - reach)

    def sizes(self, blocks: Blocks, t: Vector) -> Vector:
        """Return the factors; 0 beyond the reach."""
        cosine = self.on.at(blocks, t).elbow_cosine
        return np.asarray(np.sqrt(np.maximum((1.0 - cosine) * (1.0 + cosine), 0.0)))

    def steps(self, blocks: Blocks, t: Vector, margins: Vector) -> Vector:
        """Return margin / rate, no longer than r stays above half."""
        speed = self.on.speed(blocks)
        kept, carried = self.on.kept_shoulder(self.on.at(blocks, t), speed)
        return np.minimum(kept, _shares(margins, speed * carried))

    def beyond(self, block: int, t: float) -> bool:
        """Return whether the wrist point cannot be reached at a share of a block."""
        at = self.on.at(np.array([block]), np.array([t]))
        return bool(abs(at.elbow_cosine[0]) > 1.0 or at.distance[0] < abs(self.on.arm.offset))


@dataclass(frozen=True, slots=True, eq=False)
class WristTraced:
    """The angle between the first and the last axis of the wrist, against its ends."""

    on: ArmOnLines
    bend: Bend

    def margins(self, blocks: Blocks, t: Vector) -> Vector:
        """Return the angle from the nearer end at which the factor is at its threshold; inf beyond the reach."""
        angle, at = self._angle(blocks, t)
        low, high = self.bend.thresholds(self.on.near)
        return np.where(np.abs(at.elbow_cosine) > 1.0, np.inf, np.minimum(angle - low, high - angle))

    def sizes(self, blocks: Blocks, t: Vector) -> Vector:
        """Return the factors; inf beyond the reach."""
        angle, at = self._angle(blocks, t)
        return np.where(np.abs(at.elbow_cosine) > 1.0, np.inf, self.bend.sine(angle))

    def steps(self, blocks: Blocks, t: Vector, margins: Vector) -> Vector:
        """Return a share over which forearm and tool together turn by less than the margin."""
        on = self.on
        at, speed = on.at(blocks, t), on.speed(blocks)
        turning = np.linalg.norm(on.lines.turns[blocks], axis=1)
        half = np.abs(at.across) / 2.0
        _, carried = on.kept_shoulder(at, speed)
        with np.errstate(divide="ignore", invalid="ignore"):
            kept = np.where(speed > 0.0, half / (speed * carried), np.inf)
            # With the rate at the begin of the step, then with that of the worst place within it.
            share = np.minimum(
                kept, _shares(margins, turning + speed * self._turns(half * 2.0, carried, at.reach, 0.0))
            )
            moved = speed * carried * np.minimum(share, 1.0)
            worst = turning + speed * self._turns(half, carried, at.reach, moved)
            share = np.minimum(share, _shares(margins, worst))
        return np.where(np.isfinite(margins) & (half > 0.0), share, 0.0)

    def _turns(self, r: Vector, carried: Vector, reach: Vector, moved: Vector | float) -> Vector:
        """Return a bound of the forearm's turn [rad] for each metre of the wrist point, D within `moved` of `reach`."""
        arm = self.on.arm
        sines = []
        for distance in (reach - moved, reach + moved):
            cosine = (distance**2 - arm.upper**2 - arm.fore**2) / (2.0 * arm.upper * arm.fore)
            sines.append(np.sqrt(np.maximum(1.0 - cosine**2, 0.0)))
        return np.asarray(np.hypot(1.0 / r, carried / (arm.fore * np.minimum(*sines))))

    def _angle(self, blocks: Blocks, t: Vector) -> tuple[Vector, ArmPosition]:
        positions, rotations = self.on.lines.poses(blocks, t)
        at = arm_at(self.on.arm, positions, rotations, self.on.branch[blocks])
        return angles_between(at.fore, rotations @ self.bend.last), at


@dataclass(frozen=True, slots=True, eq=False)
class PoleTraced:
    """The angle between a direction fixed in the workpiece and one fixed in the tool, against its ends."""

    lines: LineBlocks
    bend: Bend
    near: float

    def margins(self, blocks: Blocks, t: Vector) -> Vector:
        """Return the angle from the nearer end at which the factor is at its threshold."""
        angle = self._angle(blocks, t)
        low, high = self.bend.thresholds(self.near)
        return np.minimum(angle - low, high - angle)

    def sizes(self, blocks: Blocks, t: Vector) -> Vector:
        """Return the factors."""
        return self.bend.sine(self._angle(blocks, t))

    def steps(self, blocks: Blocks, t: Vector, margins: Vector) -> Vector:
        """Return margin / |ω|."""
        return _shares(margins, np.linalg.norm(self.lines.turns[blocks], axis=1))

    def _angle(self, blocks: Blocks, t: Vector) -> Vector:
        _, rotations = self.lines.poses(blocks, t)
        directions = rotations @ self.bend.last
        return angles_between(np.broadcast_to(self.bend.first, directions.shape), directions)
