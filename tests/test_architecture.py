"""Imports go downwards only, and pinocchio and coal stay behind one door."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parent.parent / "chainbuild"

# From the ground up. A room may import rooms below it and its own.
ORDER = [
    "errors",
    "tolerances",
    "closest",
    "units",
    "findings",
    "frames",
    "conventions",
    "text",
    "chain",
    "overlay",
    "selection",
    "machine",
    "sinumerik",
    "twincat",
    "machines",
    "loading",
    "urdf_in",
    "robot",
    "solve.base",
    "solve.damped",
    "solve.closed",
    "solve.check",
    "solve",
    "analysis",
    "tables",
    "out",
    "inspect",
    "cli",
]

# Where a lower room hands over to a higher one at run time, so that `machine.chain().build().ik()` reads well.
DOORS = {
    ("chain/elements.py", "robot"),
    ("robot/robot.py", "solve"),
}

FILES = sorted(PACKAGE.rglob("*.py"))


def room_of(path: Path) -> str:
    return room_named(path.relative_to(PACKAGE).with_suffix("").parts)


def room_named(parts: tuple[str, ...]) -> str:
    """Return the room of a module below the package; some rooms have rooms of their own."""
    inner = ".".join(parts[:2])
    return inner if inner in ORDER else parts[0]


def imported_rooms(tree: ast.AST) -> set[str]:
    rooms: set[str] = set()
    for node in ast.walk(tree):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute"
            names = [node.module or ""]
            if node.module == "chainbuild":
                names = [f"chainbuild.{alias.name}" for alias in node.names]
        for name in names:
            parts = name.split(".")
            if parts[0] == "chainbuild" and len(parts) > 1 and parts[1] != "__version__":
                rooms.add(room_named(tuple(parts[1:])))
    return rooms


@pytest.mark.parametrize("path", [f for f in FILES if f.name != "__init__.py" or f.parent != PACKAGE], ids=str)
def test_imports_go_downwards(path: Path) -> None:
    room = room_of(path)
    relative = path.relative_to(PACKAGE).as_posix()
    for other in imported_rooms(ast.parse(path.read_text("utf-8"))):
        if other == room or (relative, other.split(".")[0]) in DOORS:
            continue
        assert other in ORDER, f"{relative} imports the unknown room {other}"
        assert ORDER.index(other) < ORDER.index(room), f"{relative}: {room} must not import {other}"


@pytest.mark.parametrize("path", FILES, ids=str)
def test_pinocchio_and_coal_stay_in_robot(path: Path) -> None:
    if room_of(path) == "robot":
        return
    tree = ast.parse(path.read_text("utf-8"))
    type_only = {id(n) for node in ast.walk(tree) if is_type_checking(node) for n in ast.walk(node)}
    for node in ast.walk(tree):
        if id(node) in type_only:
            continue
        names = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names = [node.module or ""]
        for name in names:
            assert name.split(".")[0] not in {"pinocchio", "coal", "eigenpy"}, f"{path} imports {name}"


def is_type_checking(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"


@pytest.mark.parametrize("path", FILES, ids=str)
def test_files_stay_short(path: Path) -> None:
    assert len(path.read_text("utf-8").splitlines()) <= 320


def test_hand_formulas_import_numpy_and_math_only() -> None:
    folder = Path(__file__).parent / "hand"
    allowed = {"__future__", "numpy", "math", "collections", "typing", "functools", "dataclasses", "tests"}
    formulas = [p for p in folder.glob("*.py") if not (p.name.startswith("test_") or p.name.endswith("_cases.py"))]
    assert len(formulas) > 3
    for path in formulas:
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.level == 0:
                assert (node.module or "").split(".")[0] in allowed, f"{path.name} imports {node.module}"
            elif isinstance(node, ast.Import):
                for alias in node.names:
                    assert alias.name.split(".")[0] in allowed, f"{path.name} imports {alias.name}"
