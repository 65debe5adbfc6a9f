"""Imports go downwards only and in no circle, and pinocchio and coal stay in the rooms that are built on them."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from tests.kit.paths import PACKAGE, TESTS

FILES = sorted(PACKAGE.rglob("*.py"))

# From the ground up. A room may import rooms below it and its own. The longest name that fits a file is its room.
ORDER = [
    "arrays", "errors", "tolerances", "closest", "units", "shown", "html", "findings", "frames", "convention", "files",
    "filekinds", "progress", "meshes",
    "chain",
    "drawing",
    "kinematics",
    "collision",
    "machines",
    "tables",
    "formats.text", "formats.overlay", "formats.overlay_poses", "formats.overlay_sums", "formats.entries",
    "formats.machine", "formats.overlay_useless",
    "formats.sinumerik.reading", "formats.sinumerik.geometry", "formats.sinumerik.rules", "formats.sinumerik",
    "formats.twincat.lists", "formats.twincat.maps", "formats.twincat.recipes", "formats.twincat.families",
    "formats.twincat.types", "formats.twincat.universal", "formats.twincat.coupling", "formats.twincat",
    "formats",
    "ik.rules", "ik.result", "ik.region", "ik.request", "ik.verify",
    "ik.search.starts", "ik.search.found", "ik.search.problem", "ik.search.compiled", "ik.search",
    "ik.branches.core", "ik.branches.arms", "ik.branches.elimination", "ik.branches.vectors", "ik.branches.opw",
    "ik.branches.direct", "ik.branches.closed",
    "ik.plan", "ik.branches.planar", "ik.branches",
    "ik.policies",
    "ik",
    "coupling",
    "robot",
    "comparison",
    "analysis.singularity", "analysis.vanishing", "analysis.path", "analysis.verdicts",
    "analysis.collision", "analysis.workspace",
    "analysis",
    "painting",
    "writers",
    "inspect",
    "cli",
    "__main__",
]  # fmt: skip

# What may import pinocchio and coal: `meshes` reads files with coal's reader. The page that `inspect` serves draws
# with meshcat, not with pinocchio.
BUILT_ON_PINOCCHIO = {"meshes", "kinematics", "collision"}


def module_of(path: Path) -> str:
    """Return the dotted name of a file below the package; a folder's own file bears the folder's name."""
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {module_of(path): path for path in FILES}


def room_of(module: str) -> str:
    fitting = [room for room in ORDER if module == room or module.startswith(f"{room}.")]
    assert fitting, f"{module} stands in no known room"
    return max(fitting, key=len)


@cache
def imports(path: Path) -> frozenset[str]:
    """Return the modules of the package that a file imports, for type checking and inside functions, too."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            assert all(alias.name != "chainbuild" for alias in node.names), "a file imports what it uses, by its module"
            found |= {alias.name.removeprefix("chainbuild.") for alias in node.names if "chainbuild." in alias.name}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute"
            if (node.module or "").split(".")[0] != "chainbuild":
                continue
            package = (node.module or "").removeprefix("chainbuild").lstrip(".")
            for alias in node.names:
                inner = f"{package}.{alias.name}".lstrip(".")
                assert package or inner in {*MODULES, "__version__"}, f"{alias.name}: import it from its module"
                found.add(inner if inner in MODULES else package)
    return frozenset(found - {""})


@pytest.mark.parametrize(
    "line", ["from chainbuild import Robot", "import chainbuild", "from ..robot import Robot", "from . import model"]
)
def test_imports_that_hide_their_room_are_refused(line: str, tmp_path: Path) -> None:
    path = tmp_path / "planted.py"
    path.write_text(f"def f():\n    {line}\n", "utf-8")
    with pytest.raises(AssertionError):
        imports(path)


INNER = [path for path in FILES if path.parent != PACKAGE or path.name != "__init__.py"]


@pytest.mark.parametrize("path", INNER, ids=module_of)
def test_imports_go_downwards(path: Path) -> None:
    room = room_of(module_of(path))
    for other in imports(path):
        there = room_of(other)
        assert there == room or ORDER.index(there) < ORDER.index(room), f"{module_of(path)} must not import {other}"


def circles(graph: dict[str, set[str]]) -> Iterator[list[str]]:
    """Yield the strongly connected components of more than one module (Tarjan)."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []

    def visit(module: str) -> Iterator[list[str]]:
        index[module] = low[module] = len(index)
        stack.append(module)
        for other in sorted(graph[module]):
            if other not in index:
                yield from visit(other)
                low[module] = min(low[module], low[other])
            elif other in stack:
                low[module] = min(low[module], index[other])
        if low[module] == index[module]:
            component = stack[stack.index(module) :]
            del stack[stack.index(module) :]
            if len(component) > 1:
                yield component

    for module in sorted(graph):
        if module not in index:
            yield from visit(module)


def test_no_files_import_each_other_in_a_circle() -> None:
    graph = {module_of(path): set(imports(path)) & MODULES.keys() for path in INNER}
    assert list(circles(graph)) == []


def test_a_circle_would_be_found() -> None:
    assert list(circles({"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": {"a"}})) == [["a", "b", "c"]]


@pytest.mark.parametrize("path", FILES, ids=module_of)
def test_pinocchio_and_coal_stay_in_their_rooms(path: Path) -> None:
    if module_of(path).split(".")[0] in BUILT_ON_PINOCCHIO:
        return
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names = [node.module or ""]
        for name in names:
            assert name.split(".")[0] not in {"pinocchio", "coal", "eigenpy"}, f"{path} imports {name}"


@pytest.mark.parametrize("path", FILES, ids=module_of)
def test_files_stay_short(path: Path) -> None:
    assert len(path.read_text("utf-8").splitlines()) <= 350


def test_hand_formulas_import_numpy_and_math_only() -> None:
    folder = TESTS / "hand"
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


FOLDERS = sorted({path.parent for path in FILES} - {PACKAGE})
MAY_BE_LONG = {"formats/twincat/families", "cli"}  # one file a kind


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.relative_to(PACKAGE).as_posix())
def test_folders_are_small_and_name_their_files(folder: Path) -> None:
    name = folder.relative_to(PACKAGE).as_posix()
    files = [path.stem for path in folder.glob("*.py") if not path.stem.startswith("__")]
    assert len(files) <= 12 or name in MAY_BE_LONG
    said = ast.get_docstring(ast.parse((folder / "__init__.py").read_text("utf-8"))) or ""
    if name != "formats/twincat/families":  # found by themselves
        assert [stem for stem in files if f"`{stem}`" not in said] == []
    rooms = [path.name for path in folder.iterdir() if (path / "__init__.py").exists()]
    assert [room for room in rooms if f"`{room}`" not in said] == []
