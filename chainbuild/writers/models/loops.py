"""What a URDF leaves out of loops and couplings: NAME.loops.yaml, by which a reader drives the file with axis values.

The keys at the top are those of the Extended URDF: pairs of frames that stay together, how, and the joints that are
driven. The block `chainbuild` says how joint values follow from the controller's axis values, and in which of its ways
a loop is assembled.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

from chainbuild.chain.axismap import AffineMap, AxisMap, BlockMap, FormulaMap, Formulas
from chainbuild.chain.elements import Chain
from chainbuild.files import angle_text, number_text, printable
from chainbuild.formats.twincat.axis_offsets import ShiftedMap
from chainbuild.units import rad_from_deg, si_factor
from chainbuild.writers.models.home import home, leading_joints
from chainbuild.writers.models.robotfiles import RobotFiles, yaml_number

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Mechanism

_VERSION: Final = 1  # of the block; readers refuse others
# Extended URDF: balls are constraints of three equations.
_TYPES: Final = {"ball": "3D", "hinge": "5D", "weld": "6D"}


def loop_files(robot: Mechanism) -> RobotFiles:
    """Return NAME.loops.yaml of a robot, or nothing where every joint value is the axis value of its name."""
    chain = robot.chain
    plain = isinstance(chain.axis_map, AffineMap) and not chain.loops
    if plain and all(_is_plain(chain, n) for n in range(len(chain.joints))):
        return {}
    return {f"{robot.name}.loops.yaml": loops_text(robot)}


def loops_text(robot: Mechanism) -> str:
    """Return loops and couplings of a robot as YAML."""
    chain = robot.chain
    found = formulas_of(chain.axis_map, [f"x{n}" for n in range(1, len(chain.axes) + 1)])
    driven, passive = driven_joints(chain)
    lines = [
        f"# {printable(chain.title, lines=False)}: {chain.kinematic} ({chain.dialect}), written by chainbuild.",
        f"# Loops and couplings that {robot.name}.urdf leaves open: keys of the Extended URDF, then how joint values",
        "# follow from the values that the controller shows.",
        f"closed_loop: {_flow([[loop.frame_a, loop.frame_b] for loop in chain.loops])}",
        f"type: {_flow([_TYPES[loop.kind] for loop in chain.loops])}",
        f"name_mot: {_flow(driven)}",
        "joint_name: []",
        "joint_type: []",
        "chainbuild:",
        f"  version: {_VERSION}",
        f"  urdf: {_flow(robot.name + '.urdf')}",
        "  units: {length: m, angle: rad}  # of all numbers here",
        "  axes:  # the controller's, in its order; symbol: the value it shows times factor",
    ]
    for n, axis in enumerate(chain.axes, 1):
        known = {"name": axis.name, "symbol": f"x{n}", "unit": axis.unit, "factor": si_factor(axis.kind)}
        lines.append(f"    - {_flow(known)}")
    lines += _map_lines(chain, found)
    if chain.loops:
        lines += _assembly_lines(robot, passive)
    return "\n".join(lines) + "\n"


def _is_plain(chain: Chain, n: int) -> bool:
    """Return whether a joint of an affine map stands at the axis value of its name."""
    assert isinstance(chain.axis_map, AffineMap)
    factors = [1.0 if axis.name == chain.joints[n].name else 0.0 for axis in chain.axes]
    return chain.axis_map.A[n].tolist() == factors and any(factors) and float(chain.axis_map.b[n]) == 0.0


def driven_joints(chain: Chain) -> tuple[list[str], list[str]]:
    """Return the joints that axes drive, and those that follow from closing the loops."""
    names = [joint.name for joint in chain.joints]
    if isinstance(chain.axis_map, AffineMap):
        return [names[n] for n in sorted(leading_joints(chain, chain.axis_map))], []
    axes = [axis.name for axis in chain.axes]
    found = formulas_of(chain.axis_map, axes) if chain.loops else None
    told = found.joints if found else [name if name in axes else "" for name in names]
    driven = [name for name, text in zip(names, told, strict=True) if text]
    return driven, [name for name in names if name not in driven] if chain.loops else []


def _map_lines(chain: Chain, found: Formulas | None) -> list[str]:
    """Return how joint values follow from axis values, those aside that closing the loops gives."""
    if found is None:
        return ["  joints: null  # the map from axis values has cases and is not written here"]
    lines = ["  steps:  # expressions, in this order"] if found.steps else []
    lines += [f"    - {_flow([name, text])}" for name, text in found.steps]
    lines.append("  joints:  # joint values as expressions of the symbols")
    joints = zip(chain.joints, found.joints, strict=True)
    return lines + [f"    {_flow(joint.name)}: {_flow(text)}" for joint, text in joints if text]


def formulas_of(axis_map: AxisMap, symbols: Sequence[str], prefix: str = "") -> Formulas | None:
    """Return an axis map written down, or None where one of its parts cannot be.

    A joint without an expression follows from closing the loops.

    Args:
        axis_map: The map.
        symbols: What its axes (SI) are called.
        prefix: Of the names of steps: maps side by side have some of the same name.
    """
    if isinstance(axis_map, AffineMap):
        return Formulas((), axis_map.sums(symbols))
    if isinstance(axis_map, ShiftedMap):
        shifts = [rad_from_deg(shift) for shift in axis_map.shift.tolist()]  # of rotary axes alone
        stands = [f"({name} + {shift:.15g})" if shift else name for name, shift in zip(symbols, shifts, strict=True)]
        return formulas_of(axis_map.inner, stands, prefix)
    if isinstance(axis_map, BlockMap):
        joints = [""] * axis_map.shape[0]
        steps: list[tuple[str, str]] = []
        for n, block in enumerate(axis_map.blocks):
            part = formulas_of(block.axis_map, symbols[block.axes], f"{prefix}m{n + 1}_")
            if part is None:
                return None
            steps += part.steps
            for place, text in zip(block.joints.tolist(), part.joints, strict=True):
                joints[place] = text
        return Formulas(tuple(steps), tuple(joints))
    found = axis_map.formulas(symbols) if isinstance(axis_map, FormulaMap) else None
    return found if found is None or not prefix else _prefixed(found, prefix)


def _prefixed(found: Formulas, prefix: str) -> Formulas:
    """Return formulas whose steps have other names."""
    names = {name for name, _ in found.steps}

    def renamed(text: str) -> str:
        return re.sub(r"[a-z_]\w*", lambda word: prefix + word[0] if word[0] in names else word[0], text)

    steps = tuple((prefix + name, renamed(text)) for name, text in found.steps)
    return Formulas(steps, tuple(renamed(text) for text in found.joints))


def _assembly_lines(robot: Mechanism, passive: Sequence[str]) -> list[str]:
    """Return a state in which the loops are closed: it says in which of their ways."""
    axes = home(robot)
    q = robot.q(axes)
    values = {
        joint.name: (angle_text if joint.kind == "revolute" else number_text)(float(value))
        for joint, value in zip(robot.chain.joints, q, strict=True)
    }
    shown = ", ".join(yaml_number(json.dumps(float(number_text(float(value))))) for value in axes)
    return [
        f"  passive: {_flow(list(passive))}  # they follow from closing the loops",
        "  assembly:  # a closed state: others of the same way of assembly are reached from it without a singularity",
        f"    axes: [{shown}]  # as the controller shows them",
        "    joints:",
        *(f"      {_flow(name)}: {yaml_number(text)}" for name, text in values.items()),
    ]


def _flow(value: Any) -> str:
    """Return a value in YAML's flow style, which JSON is part of."""
    return json.dumps(value, ensure_ascii=False)
