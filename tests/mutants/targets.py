"""Which files are mutated, and which tests should fail on the mutants of each."""

from __future__ import annotations

import ast
from pathlib import Path

from tests.mutants.mutations import Mutant

ROOT = Path(__file__).parent.parent.parent
TYPES_ONLY = "--mutant-types="  # among pytest's arguments: keep the tests of these KIN_TYPs

TWINCAT = "tests/formats/twincat"
# What is displayed has a list of its own and takes as long as all others.
GEOMETRY = "(hand or reference or arm45 or families or bounds or kin98 or domain) and not displayed"
TWINCAT_SHARED = (TWINCAT, "-k", GEOMETRY)
TRANSLATED = (TWINCAT, "-k", f"{GEOMETRY} or channel_names")
# The drives of 76 go by a map of heads.
HEAD_MAPS = (TWINCAT, "-k", f"{GEOMETRY} or 76_machine_axes")
# What moves no tool of closed loops: names of singularities, derivatives of passive joints, ranges of struts.
LOOP_MAPS = (TWINCAT, "tests/analysis/test_loop_names.py", "-k", f"{GEOMETRY} or loop_names")
ROD_TABLE = (f"{TWINCAT}/test_rod_table.py", "tests/kinematics/test_closure.py", "-k", "not option_chooses")
SINUMERIK = ("tests/formats/sinumerik", "tests/ik/policies/test_controller.py")
CHAIN = ("tests/chain",)


def _tests(folder: str, *names: str) -> tuple[str, ...]:
    return tuple(f"tests/{folder}/test_{name}.py" for name in names)


# Without those that compile solvers anew in each process.
COMPOSED = (*_tests("chain", "compose_numbers", "compose"), "tests/coupling", "-k", "not written_and_solved")
# Only a coupling reads a universal kinematic backwards.
UNIVERSAL = _tests("formats/twincat", "directions", "universal_display", "universal", "as_universal", "coupling")
COUPLED = _tests("formats/twincat", "two_steps", "coupling", "coupling_axes", "coupling_refused")
AXIS_MAPS = ("tests/chain", *_tests("kinematics", "by_hand", "robot"), "-k", "not written_and_solved")
KINEMATICS = ("tests/kinematics", "tests/ik/test_ik.py", "tests/ik/search/test_arm_reach.py", "-k", "not arrays_of")
DRIVES = (
    *_tests("chain", "drives"),
    *_tests("formats/twincat", "drives", "drive_ranges"),
    *_tests("ik", "drive_limits"),
)
LIMITS = (*_tests("kinematics", "by_hand", "limits_of_drives"), *DRIVES, *_tests("ik", "limits_agree"))
DISPLAYED = (
    *_tests("kinematics", "by_hand", "angles_shown"),
    *_tests("ik", "displayed"),
    *_tests("formats/twincat", "universal_display", "displayed_by_hand"),
)
URDF = (*_tests("formats", "urdf_in", "urdf_joints", "urdf_links", "urdf_overlay"), *_tests("chain", "compose_masses"))
STATUS = _tests("ik/branches", "status_filter", "status_turn")
# Compiled code does not see a mutant of what it was compiled from.
PLANAR = (*_tests("ik/branches", "planar"), "-k", "not compiled")
ORTHO_PARALLEL = (*_tests("ik/branches", "batch"), "-k", "not compiled")
SUBPROBLEMS = _tests("ik/branches", "subproblems", "three_parallel")
THREE_PARALLEL = _tests("ik/branches", "three_parallel")
PROGRAMMED = (*_tests("chain", "vectors_by_hand", "vectors"), *_tests("ik/policies", "programmed"), *STATUS)


def targets() -> dict[Path, tuple[str, ...]]:
    """Return the files of translators and of what they fold and add, and the tests of each."""
    package = ROOT / "chainbuild"
    twincat, sinumerik = package / "formats" / "twincat", package / "formats" / "sinumerik"
    shared = [*sorted((twincat / "families").glob("[a-z]*.py")), *sorted((twincat / "maps").glob("[a-z]*.py"))]
    shared += [twincat / "recipes" / f"{name}.py" for name in ("parts", "head_parts", "recipe")]
    files = {**dict.fromkeys(shared, TWINCAT_SHARED), twincat / "translate.py": TRANSLATED}
    files[twincat / "maps" / "heads.py"] = HEAD_MAPS
    files |= {twincat / "maps" / f"{name}.py": LOOP_MAPS for name in ("losing", "scissors", "struts")}
    files |= {twincat / "maps" / f"{name}.py": ROD_TABLE for name in ("table", "table_rods")}
    robx = [sinumerik / "geometry" / f"{name}.py" for name in ("translate", "robot_axes", "tool")]
    files |= dict.fromkeys([*robx, sinumerik / "rules" / "chain_data.py"], SINUMERIK)
    chain = package / "chain"
    files |= dict.fromkeys([chain / "fold.py", chain / "bodies" / "rods.py"], CHAIN)
    return files | _beside_the_translators(package)


def _beside_the_translators(package: Path) -> dict[Path, tuple[str, ...]]:
    """Return the files that compose, distribute, move and display what was translated, and the tests of each."""
    chain, kinematics, twincat = package / "chain", package / "kinematics", package / "formats" / "twincat"
    files = {
        chain / "compose.py": COMPOSED,
        **dict.fromkeys(sorted((package / "coupling").glob("[a-z]*.py")), COMPOSED),
        **dict.fromkeys(sorted((twincat / "coupling").glob("[a-z]*.py")), COUPLED),
        **dict.fromkeys(sorted((twincat / "universal").glob("[a-z]*.py")), UNIVERSAL),
        chain / "axismap.py": AXIS_MAPS,
        **dict.fromkeys([chain / "drives.py", twincat / "maps" / "drives.py"], DRIVES),
        **dict.fromkeys(sorted((chain / "programmed").glob("[a-z]*.py")), PROGRAMMED),
        **dict.fromkeys(sorted(kinematics.glob("[a-z]*.py")), KINEMATICS),
        **dict.fromkeys([kinematics / "limits.py", kinematics / "ranges.py"], LIMITS),
    }
    formats = [
        package / "formats" / f"{name}.py" for name in ("urdf/robot", "urdf/joints", "urdf/tree", "overlay_sums")
    ]
    files |= dict.fromkeys([*formats, chain / "bodies" / "inertia.py"], URDF)
    branches = package / "ik" / "branches"
    files[branches / "status_turn.py"] = STATUS
    files |= dict.fromkeys([branches / "planar" / f"{name}.py" for name in ("formulas", "constants")], PLANAR)
    files[branches / "opw" / "formulas.py"] = ORTHO_PARALLEL
    files |= dict.fromkeys([branches / "core" / f"{name}.py" for name in ("plain", "subproblems")], SUBPROBLEMS)
    files[branches / "arms" / "three_parallel.py"] = THREE_PARALLEL
    displayed = [kinematics / "displayed.py", package / "ik" / "displayed.py", package / "ik" / "rtcp.py"]
    displayed += [chain / "programmed" / "display.py", twincat / "types" / "displays.py"]
    return files | dict.fromkeys(displayed, DISPLAYED)


def types_in(path: Path) -> tuple[int, ...]:
    """Return the KIN_TYPs that a family file registers."""
    numbers = {
        key.value
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.Dict)
        for key in node.keys
        if isinstance(key, ast.Constant) and isinstance(key.value, int)
    }
    return tuple(sorted(numbers))


def tests_for(path: Path, mutant: Mutant, default: tuple[str, ...]) -> tuple[str, ...]:
    """Return the pytest arguments for a mutant: its own type where it lies in one recipe."""
    if path.parent.name != "families":
        return default
    number = mutant.function.removeprefix("kin_")
    types = (int(number),) if number.isdigit() else types_in(path)
    if not types:
        return default
    return (TWINCAT, f"{TYPES_ONLY}{','.join(map(str, types))}")
