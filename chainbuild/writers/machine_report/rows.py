"""The chapters of Denavit-Hartenberg rows and of the product of exponentials."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.chain.poses import path_to
from chainbuild.closest import and_joined
from chainbuild.units import mm_from_m
from chainbuild.writers.machine_report.dh import DhRow, NearlyParallel, dh_form
from chainbuild.writers.machine_report.document.blocks import (
    Chapter,
    Heading,
    Paragraph,
    ReportBlock,
    TableBlock,
    Verbatim,
)
from chainbuild.writers.machine_report.document.numbers import decimal, neat
from chainbuild.writers.machine_report.serial import JointRow, Tip, joint_row, named_by_joints

if TYPE_CHECKING:
    from chainbuild.arrays import Matrix
    from chainbuild.chain.elements import Chain
    from chainbuild.kinematics.mechanism import Mechanism

# What rows are written with reproduces poses to 1e-9 m, also 100 m from a foot of a normal.
_MM: Final = 9  # decimals of lengths
_DEG: Final = 11  # of angles
_SHARE: Final = 12  # of parts of directions
_TIPS: Final[tuple[Tip, ...]] = ("tool", "workpiece")
_DH_HEAD: Final = {
    False: ("Row", "θ [deg]", "d [mm]", "a [mm]", "α [deg]"),
    True: ("Row", "α [deg]", "a [mm]", "θ [deg]", "d [mm]"),
}


def rows_chapters(robot: Mechanism) -> tuple[Chapter, Chapter]:
    """Return the chapter of Denavit-Hartenberg rows and that of screws."""
    found = {tip: joint_row(robot, tip) for tip in _TIPS}
    head = [*_what_values_are(robot.chain), *_why_no_rows(robot.chain, found)]
    pose = Paragraph.of(
        "The programmed pose, tool seen from workpiece, is (T_base_workpiece)⁻¹ · T_base_tool."
        + ("" if _moved(found["workpiece"]) else f" {_workpiece_in_words(found['workpiece'])}")
    )
    rows = [row for row in found.values() if row is not None and row.joints]
    return (
        Chapter("Denavit-Hartenberg parameters", [*head, *([pose, *_dh_blocks(rows)] if rows else [])]),
        Chapter("Product of exponentials", [*head, *([pose, *_screw_blocks(rows)] if rows else [])]),
    )


def _what_values_are(chain: Chain) -> Iterator[ReportBlock]:
    if named_by_joints(chain) and not chain.loops:
        yield Paragraph.of(
            "A nonlinear map gives the joint values by the axis values: the rows below hold for the joint values, "
            "q[…], which robot.q(axes) returns in metres and radians; here they are in mm and degrees."
        )


def _why_no_rows(chain: Chain, found: dict[Tip, JointRow | None]) -> Iterator[ReportBlock]:
    for tip, row in found.items():
        if row is None:
            passive = [joint.name for joint in path_to(chain, chain.frame(tip).link)]
            yield Paragraph.of(
                f"The {tip} hangs in closed loops: what moves it, {and_joined(passive)}, follows from the loops and "
                "from no single axis: there is no row of joints to tabulate. ",
                Verbatim("chainbuild fk"),
                " computes its pose.",
            )


def _moved(row: JointRow | None) -> bool:
    return row is None or bool(row.joints)


def _workpiece_in_words(row: JointRow | None) -> str:
    if row is None or np.allclose(row.T, np.eye(4), atol=1e-12):
        return "Nothing moves the workpiece: its frame is the base."
    return "Nothing moves the workpiece; its frame in the base (4 × 4, mm): " + _matrix_in_words(row.T)


def _matrix_in_words(T: Matrix) -> str:
    return "; ".join(", ".join(cells) for cells in _matrix(T)) + "; 0, 0, 0, 1."


def _matrix(T: Matrix) -> list[list[str]]:
    return [
        [*(_neat(float(part), _SHARE) for part in T[n, :3]), _neat(mm_from_m(float(T[n, 3])), _MM)] for n in range(3)
    ]


def _dh_blocks(rows: Sequence[JointRow]) -> Iterator[ReportBlock]:
    yield Paragraph.of(
        "Standard: T = Π Rz(θ)·Tz(d)·Tx(a)·Rx(α). Modified (Craig): T = Π Rx(α)·Tx(a)·Rz(θ)·Tz(d). A table is "
        "multiplied out from its first row to its last; the rows of base and tip are what the joints leave over. A "
        "name stands for the value of that axis."
    )
    for row in rows:
        try:
            form = dh_form(row)
        except NearlyParallel as reason:
            yield Paragraph.of(_nearly_in_words(row, reason))
            continue
        for modified, numbers in ((False, form.standard), (True, form.modified)):
            yield Heading((f"Base to {row.tip}, {'modified' if modified else 'standard'}",))
            yield TableBlock(_DH_HEAD[modified], _dh_cells(row, numbers, modified), "rows")


def _nearly_in_words(row: JointRow, reason: NearlyParallel) -> str:
    names = ["the base's z", *(joint.name for joint in row.joints), f"the {row.tip}'s z"]
    first, second = names[reason.first : reason.first + 2]
    return (
        f"Base to {row.tip}: {first} and {second} are {decimal(reason.angle_deg, 6)}° from parallel. Their common "
        "normal lies far away, and rows of rounded numbers would not give the poses; the product of exponentials does."
    )


def _neat(value: float, places: int) -> str:
    return decimal(neat(value, places), places)


def _dh_cells(row: JointRow, numbers: Sequence[DhRow], modified: bool) -> list[list[str]]:
    cells = []
    for n, one in enumerate(numbers):
        joint = row.joints[n - 1] if 0 < n < len(numbers) - 1 else None
        theta, d = _neat(one.theta, _DEG), _neat(one.d, _MM)
        if joint is not None and joint.turns:
            theta = joint.text(neat(one.theta, _DEG), _DEG)
        elif joint is not None:
            d = joint.text(neat(one.d, _MM), _MM)
        across = [_neat(one.a, _MM), _neat(one.alpha, _DEG)]
        name = "base" if n == 0 else row.tip if joint is None else joint.name
        cells.append([name, *reversed(across), theta, d] if modified else [name, theta, d, *across])
    return [one for n, one in enumerate(cells) if 0 < n < len(cells) - 1 or set(one[1:]) != {"0"}]


def _screw_blocks(rows: Sequence[JointRow]) -> Iterator[ReportBlock]:
    yield Paragraph.of(
        "T_base_tip = e^[S₁]θ₁ · … · e^[Sₙ]θₙ · M, screws S = (ω, v) in the base, M the tip with every value at 0. "
        "A turn: ω its direction, v = −ω × p of a point p on its line [mm], θ turned into radians. A slide: ω = 0, v "
        "its direction, θ in mm."
    )
    for row in rows:
        yield Heading((f"Base to {row.tip}: screws",))
        head = ("Joint", "θ", "unit", "ωx", "ωy", "ωz", "vx", "vy", "vz")
        yield TableBlock(head, _screw_cells(row), "rows")
        yield Heading((f"Base to {row.tip}: M",))
        yield TableBlock(("x axis", "y axis", "z axis", "origin [mm]"), _matrix(row.T))


def _screw_cells(row: JointRow) -> list[list[str]]:
    cells = []
    for joint, direction, point in zip(row.joints, row.directions, row.points, strict=True):
        line = [_neat(float(part), _SHARE) for part in direction]
        moment = [_neat(mm_from_m(float(part)), _MM) for part in np.cross(point, direction)]
        parts = [*line, *moment] if joint.turns else ["0", "0", "0", *line]
        cells.append([joint.name, joint.text(), "deg" if joint.turns else "mm", *parts])
    return cells
