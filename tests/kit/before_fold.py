"""Chains whose signs and zeros are folded into the joints: the cases, and what is recorded of each.

`tests/data/before_fold.json` holds what the last version without the fold answered, and `test_fold` compares. It was
written by this file with that version's `chainbuild` in front: `PYTHONPATH=OLD python tests/kit/before_fold.py`.
Nothing here may read the joints themselves, which are what has changed. Since bodies of slides and beds no longer count
in collisions, what the file held of such machines' collisions is taken out.
"""

from __future__ import annotations

import json
import sys
import tempfile
import zlib
from collections.abc import Iterable, Iterator
from functools import reduce
from operator import add
from pathlib import Path
from typing import Any

import numpy as np

import chainbuild
from chainbuild.analysis.collision.paths import _ConservativeAdvancement
from chainbuild.analysis.singularity.measures import characteristic_length
from chainbuild.chain.assemble import assemble, mark, rotary, shift
from chainbuild.chain.bodies.geometry import RodData
from chainbuild.chain.bodies.rods import ROD_END, ROD_PIN, has_rods, with_rods
from chainbuild.chain.bodies.shapes import detail_bodies, link_bodies, machine_size, shown_limits
from chainbuild.chain.compose import follow, stack
from chainbuild.chain.elements import Axis, Chain
from chainbuild.collision.model import CollisionModel
from chainbuild.errors import ChainbuildError
from chainbuild.frames import f_frame
from chainbuild.ik.branches.status_turn import has_status, status_turn
from chainbuild.machines import shipped_path
from chainbuild.robot import Robot

FILE = Path(__file__).parents[1] / "data" / "before_fold.json"
# A general point of a body's own frame: where it lies says how the body is placed and turned.
GENERAL = np.array([0.31, -0.52, 0.83])
ROD = RodData(crank=0.31, angle_deg=-150.0, sideways=0.12)
COUPLED, UNIVERSAL = 210, 91
# Defaults of conventions have changed since; these are the ones of the record.
THEN = {
    **{key: {"machine_zero_sign": "plus"} for key in (61, 63, 80, 81, 82)},
    **{key: {"linear_unit_offset_sign": "plus"} for key in (206, 208)},
}


def shipped_chains() -> Iterator[tuple[str, Chain]]:
    for name in chainbuild.shipped():
        machine = chainbuild.load(name)
        for entry in machine.kinematics():
            kinematic = entry.name if entry.name == "gripper" else entry.id
            yield f"{name}/{entry.id}/{entry.name}", machine.chain(kinematic, entry.channel)


def catalogue_chains() -> Iterator[tuple[str, Chain]]:
    """Yield every type with lengths and angles that are not 0 and every direction reversed, and once straight."""
    for number in chainbuild.catalogue():
        if number in (COUPLED, UNIVERSAL):
            continue
        for reversed_axes in (True, False):
            try:
                yield f"type {number} {'reversed' if reversed_axes else 'straight'}", type_chain(number, reversed_axes)
            except ChainbuildError:
                continue


def type_chain(number: int, reversed_axes: bool, **conventions: str) -> Chain:
    chosen = THEN.get(number, {}) | conventions
    return of_text("\n".join([*type_lines(number, reversed_axes), "Ende", ""]), "machine.lis", **chosen)


def two_steps(first: int, second: int) -> Chain:
    """Return a chain of two steps: what bounds the joints of the second is how far the first one reaches."""
    lines = [f"kin_step[{n}].{line}" for n, number in enumerate((first, second)) for line in type_lines(number, True)]
    chosen = [f"default_id_of_kin_step[{n}] {number}" for n, number in enumerate((first, second))]
    return of_text(
        "\n".join([*lines, *chosen, "Ende", ""]), "machine.lis", **(THEN.get(first, {}) | THEN.get(second, {}))
    )


def type_lines(number: int, reversed_axes: bool) -> list[str]:
    lines = [f"trafo[0].id {number}"]
    fixed = {59: {7: 48e4, 19: 0, 20: 0}, 60: {7: 48e4}, 207: {4: 65e4}, 33: {3: 40e4}, 205: {16: 1, 17: 0}, 98: {
        2: 10e4, 3: 60e4, 4: 80e4}, 45: {33: 0}}  # fmt: skip
    for row in chainbuild.catalogue()[number].hd:
        value = {"length": 41e4 + 17e4 * row.n, "angle": 13e4 + 1.9e4 * row.n, "ratio": 1.0 + row.n}.get(row.kind, 0.0)
        if row.kind not in ("length", "angle", "ratio") and row.permitted:
            value = (min if min(row.permitted) < 0 else max)(row.permitted) if reversed_axes else 0.0
            value = value if value in row.permitted else row.permitted[0]
        if row.kind == "sign" and not row.permitted:
            value = -1.0 if reversed_axes else 1.0
        lines.append(f"trafo[0].param[{row.n - 1}] {fixed.get(number, {}).get(row.n, value):.0f}")
    return lines


def of_text(text: str, file: str, **conventions: str) -> Chain:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / file
        path.write_text(text, "utf-8")
        return chainbuild.load(path).chain(tool_length_mm=70.0, conventions=conventions)


def robx(name: str, data: dict[str, float], **conventions: str) -> Chain:
    """Return a shipped ROBX machine with other data."""
    path = shipped_path(name)
    assert path is not None
    kept = [line for line in path.read_text("utf-8").splitlines() if not any(f"_{key}=" in line for key in data)]
    new = [f"$MC_ROBX_{key}={value}" for key, value in data.items()]
    return of_text("\n".join([*kept[:-1], *new, "M17", ""]), "arm.tea", **conventions)


TURNED = {
    "MAMES[0]": 10.0, "MAMES[1]": 90.0, "MAMES[2]": -70.0, "MAMES[3]": 33.0, "MAMES[4]": -20.0, "MAMES[5]": 180.0,
    "AXES_DIR[0]": -1, "AXES_DIR[1]": -1, "AXES_DIR[2]": -1, "AXES_DIR[4]": -1,
}  # fmt: skip
PERMUTED = {
    "AXIS_SEQ[0]": 3, "AXIS_SEQ[1]": 1, "AXIS_SEQ[2]": 2, "AXES_DIR[0]": -1, "AXES_DIR[1]": 1, "AXES_DIR[2]": -1,
    "MAMES[0]": 250.0, "MAMES[1]": -120.0, "MAMES[2]": 40.0,
}  # fmt: skip
TABLE = {
    "EXT_AXIS_VECTOR_1[0]": 0.6, "EXT_AXIS_VECTOR_1[1]": 0.8, "EXT_AXIS_VECTOR_1[2]": 0.0, "EXT_AX_OFFSET[0]": -1300.0,
    "EXT_ROT_AX_OFFSET[0]": 25.0, "EXT_ROT_AX_OFFSET[1]": -90.0,
}  # fmt: skip


def variants() -> Iterator[tuple[str, Chain]]:
    """Yield what no shipped machine has: reversed axes with offsets under rods, tables that ride, chains of chains."""
    turned = robx("irb2600", TURNED)
    yield "robx turned", turned
    yield "robx turned, rods", with_rods(turned, ROD)
    yield "robx elbow reversed, rods", with_rods(robx("irb2600", {"AXES_DIR[2]": -1}), ROD)
    yield "robx permuted", robx("gantry_ss", PERMUTED, axes_dir_index="input")
    for choice in ("absolute_pitch", "relative_at_zero"):
        coupled = robx("parallelogram_nr", TURNED, special_kin_2=choice)
        yield f"robx parallelogram {choice}, rods", with_rods(coupled, ROD)
    for choice in ("absolute", "relative"):
        yield f"type 96 {choice}, rods", with_rods(type_chain(96, False, kin96_arm2_angle=choice), ROD)
    yield "level flange turned, rods", with_rods(level_arm(), ROD)
    for number in (45, 213):
        for reversed_axes in (False, True):
            chain = type_chain(number, reversed_axes)
            yield f"type {number} {'reversed' if reversed_axes else 'straight'}, rods", with_rods(chain, ROD)
    table = robx_riding()
    yield "robx riding table", table
    yield "two steps, the first off zero", two_steps(206, 9)
    yield "robx track far off", robx("irb2600_track", TURNED | {"EXT_AX_OFFSET[0]": -2500.0})
    T = f_frame((0.4, -0.3, 0.2), (20.0, -30.0, 90.0))
    tables = type_chain(58, True), type_chain(205, True), table
    for lower in (tables[0], turned):
        for upper in tables:
            yield f"{lower.kinematic} below {upper.kinematic}", stack(lower, T, upper, upper_name="UP")
    yield "follow", follow(turned, workpiece_of=tables[1], other_name="OTHER")
    yield "follow a table", follow(tables[1], workpiece_of=table, other_name="OTHER")
    yield "twice", stack(stack(turned, T, table, upper_name="UP"), T, tables[0], upper_name="TOP")


def level_arm() -> Chain:
    """Return an arm with a level flange whose elbow is drawn against its shoulder, both reversed and off zero."""
    axes = tuple(Axis.unlimited(f"G{n}", "rotary") for n in range(1, 5))
    tool = [
        rotary("G1", "z"), shift(x=200.0, z=500.0), rotary("G2", "y", sign=-1.0, offset_deg=20.0), shift(z=700.0),
        rotary("G3", "-y", sign=-1.0, offset_deg=15.0), shift(x=900.0, z=50.0),
        rotary("level", "y", drive={"G3": -1.0, "G2": 1.0}, offset_deg=-5.0), shift(x=200.0), rotary("G4", "z"),
        mark("flange"), shift(z=-100.0),
    ]  # fmt: skip
    body = assemble(axes, tool)
    return Chain("level", "Level", "test", "test", body.links, body.joints, body.frames, axes, body.axis_map, "ypr")


def robx_riding() -> Chain:
    """Return an arm on a track whose table rides with it: one axis drives two slides, both with an offset."""
    path = shipped_path("irb2600_table")
    assert path is not None
    text = path.read_text("utf-8").replace("AXES_IN_1[6]=0", "AXES_IN_1[6]=9")
    new = [f"$MC_ROBX_{key}={value}" for key, value in (TURNED | TABLE).items()]
    kept = [line for line in text.splitlines()[:-1] if not any(f"_{key}=" in line for key in TURNED | TABLE)]
    return of_text("\n".join([*kept, *new, "M17", ""]), "arm.tea", table_origin="riding")


def cases() -> Iterator[tuple[str, Chain]]:
    yield from shipped_chains()
    yield from catalogue_chains()
    yield from variants()


def axis_values(name: str, chain: Chain, count: int) -> list[np.ndarray]:
    """Return axis values within the limits shown at which the chain has joint values; repeatable."""
    rng = np.random.default_rng(zlib.crc32(name.encode()))
    lower, upper = (np.maximum(np.minimum(bound, 2000.0), -2000.0) for bound in shown_limits(chain))
    found: list[np.ndarray] = []
    while len(found) < count:
        values = (lower + (upper - lower) * rng.uniform(0.05, 0.95, len(lower))).round(3)
        if np.isfinite(chain.axis_map.q(values)).all():
            found.append(values)
    return found


def record(name: str, chain: Chain, bodies: bool) -> dict[str, Any]:
    """Return what is to stay as it is: poses, derivatives, sizes, bodies, rods, status, collisions."""
    robot = Robot(chain)
    values = axis_values(name, chain, 6)
    found: dict[str, Any] = {
        "fk": [exact(robot.fk(axes).homogeneous[:3]) for axes in values[:2]],
        "J": exact(robot.jacobian(values[0])),
        "size": round(machine_size(chain), 9),
        "reach": round(robot.kinematics.reach, 9),
        "length": round(characteristic_length(chain), 9),
    }
    places = robot.frame_placements(values[0])
    drawn = (*link_bodies(chain), *detail_bodies(chain))
    if bodies:
        found["bodies"] = [[b.link, b.part, *b.dimensions, *micro(general_point(places, b))] for b in drawn]
        model = CollisionModel(robot)
        if model.pairs:
            found["weights"] = [
                round(float(sum(row)), 6)
                for row in _ConservativeAdvancement(model, np.array(values[:2]), 0.0).weights.T
            ]
        found["pairs"] = len(model.pairs)
        found["touching"] = [[*pair] for pair in model.colliding_pairs(values[0])]
        found["colliding"] = [model.collides(axes) for axes in axis_values(name, chain, 30)]
        found["nearest"] = [round(float(model.distances(axes).min(initial=9.0)), 7) for axes in values]
    else:
        found["drawn"] = micro(sum(general_point(places, body) for body in drawn))
        found["thick"] = round(added(added(body.dimensions) for body in drawn), 5)
    if has_rods(chain):
        found["rods"] = [micro(places[frame].translation) for frame in (ROD_PIN, ROD_END)]
    if has_status(robot):
        found["status"] = [[*status_turn(robot, axes)] for axes in axis_values(name, chain, 40)]
    return found


def added(values: Iterable[float]) -> float:
    """Return a sum, one value after the other: `sum` rounds less from Python 3.12 on, which the last digit tells."""
    return reduce(add, values, 0.0)


def general_point(places: dict[str, Any], body: Any) -> np.ndarray:
    T = places[body.link].homogeneous @ body.T_link_body
    return T[:3, :3] @ GENERAL + T[:3, 3]


def exact(values: np.ndarray) -> list[float]:
    return [float(f"{value:.13f}") + 0.0 for value in np.ravel(values)]


def micro(values: np.ndarray) -> list[float]:
    return [round(float(value), 6) + 0.0 for value in values]


def recorded() -> dict[str, Any]:
    return {name: record(name, chain, not name.startswith("type ") or "rods" in name) for name, chain in cases()}


if __name__ == "__main__":
    lines = (f'"{name}":{json.dumps(found, separators=(",", ":"))}' for name, found in recorded().items())
    FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n", "utf-8")
    print(f"{FILE}: {FILE.stat().st_size} bytes, by {chainbuild.__file__}", file=sys.stderr)
