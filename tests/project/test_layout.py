"""How the tests are laid out: no test module imports another, and what several share is in tests/kit."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.kit.paths import PACKAGE, ROOT, TESTS

FILES = sorted(TESTS.rglob("*.py"))
# Folders of their own: hand formulas with their own checks, the benchmark, the mutants, tests of the repository.
BESIDE_THE_ROOMS = {"bench", "hand", "kit", "mutants", "project"}
BROWSER = "inspect/conftest.py"  # the browser ends with the tests of the page: later ones need the event loop


def name_of(path: Path) -> str:
    return str(path.relative_to(TESTS))


def imported(path: Path, source: str) -> Iterator[str]:
    """Yield the dotted names of what a file imports, inside functions, too; `from a import b` is a and a.b."""
    package = path.relative_to(ROOT).parts[:-1]
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else ()
            module = ".".join([*above, *([node.module] if node.module else [])])
            yield module
            yield from (f"{module}.{alias.name}" for alias in node.names)


def forbidden(path: Path, source: str) -> list[str]:
    """Return the test modules and conftests among what a file imports."""
    names = [part for name in imported(path, source) if name.split(".")[0] == "tests" for part in name.split(".")]
    return sorted({name for name in names if name.startswith("test_") or name == "conftest"})


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_no_file_imports_a_test_module(path: Path) -> None:
    assert forbidden(path, path.read_text("utf-8")) == []


@pytest.mark.parametrize(
    "line",
    [
        "import tests.chain.test_fold",
        "import tests.chain.test_fold as fold",
        "from tests.chain.test_fold import chains",
        "from tests.chain import test_fold",
        "from .test_fold import chains",
        "from . import test_fold",
        "from ..chain.test_fold import chains",
        "def late():\n    from tests.chain.test_fold import chains",
    ],
)
def test_such_an_import_would_be_found(line: str) -> None:
    assert forbidden(TESTS / "chain" / "test_compose.py", line) == ["test_fold"]


def test_fixtures_are_requested_and_not_imported() -> None:
    assert forbidden(TESTS / "chain" / "test_compose.py", "from tests.conftest import run") == ["conftest"]
    assert [name_of(path) for path in FILES if path.name == "conftest.py"] == ["conftest.py", BROWSER]


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_every_file_stands_in_a_room(path: Path) -> None:
    """Tests stand in the folder of the room they test, nothing but tests stands there, and none lies flat."""
    folder = path.parent.relative_to(TESTS)
    if folder == Path():
        assert path.name in ("__init__.py", "conftest.py")
    elif folder.parts[0] not in BESIDE_THE_ROOMS:
        assert (PACKAGE / folder).is_dir()
        assert path.name == "__init__.py" or path.name.startswith("test_") or name_of(path) == BROWSER
    else:
        assert folder.name != "kit" or not path.name.startswith("test_")
