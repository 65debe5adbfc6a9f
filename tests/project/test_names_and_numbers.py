"""A public name means one thing in the whole package, and every number says why it is what it is."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parent.parent.parent / "chainbuild"
FILES = sorted(PACKAGE.rglob("*.py"))

# The compiled search, closed forms and formulas have a plain counterpart that bears the same name.
COMPILED = re.compile(r"ik/search/compiled/|ik/branches/compiled/|ik/branches/\w+/compiled\.py")
# Both dialects have a translator, a tool, an assignment, …
DIALECT = re.compile(r"formats/(sinumerik|twincat)/")
# A command bears the name of the function it calls, in a file of that name.
COMMAND = "cli/{name}.py"
# Tables of the kinematics of a file, gathered by the catalogue of types.
TABLES = {"RECIPES"}

# Numbers of an alarm, of a kinematic type, of a column: they are names, not quantities.
IDENTIFIER = re.compile(r"ALARM|COLUMN|INDEX|_CODE|_MODE$|^_?(COUPLING|UNIVERSAL|ROBX_TYPE|TE4_TYPE|NO_JOINT)$")
CONSTANT = re.compile(r"_*[A-Z][A-Z0-9_]*")


def assigned(node: ast.stmt) -> list[str]:
    """Return the names that a statement gives a value to."""
    targets = node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
    inner = [leaf for target in targets for leaf in (target.elts if isinstance(target, ast.Tuple) else [target])]
    return [leaf.id for leaf in inner if isinstance(leaf, ast.Name)]


def public_names(source: str) -> Iterator[str]:
    """Yield the names without an underscore that a file defines."""
    for node in ast.parse(source).body:
        defines = isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef)
        yield from (name for name in ([node.name] if defines else assigned(node)) if not name.startswith("_"))


def repeated(sources: dict[str, str]) -> dict[str, list[str]]:
    """Return the public names that stand for several things, each with the files that define it."""
    places: dict[str, set[str]] = defaultdict(set)
    for file, source in sources.items():
        for name in public_names(source):
            if name not in TABLES and file != COMMAND.format(name=name):
                places[name].add(file)
    return {name: sorted(files) for name, files in places.items() if not one_thing(files)}


def one_thing(files: set[str]) -> bool:
    """Tell whether the files that define a name are one, twins, or the two dialects."""
    plain = {file for file in files if not COMPILED.search(file)}
    dialects = [found.group(1) for found in map(DIALECT.match, sorted(plain)) if found]
    if len(files) - len(plain) > 1:
        return False
    return len(plain) <= 1 or (sorted(dialects) == ["sinumerik", "twincat"] and len(plain) == 2)


def is_number(node: ast.expr | None) -> bool:
    """Tell whether an expression is made of numbers alone: 3, -1e-9, 2 * math.pi, 10**9, (0.5, 2.0)."""
    if isinstance(node, ast.Constant):
        return isinstance(node.value, int | float) and not isinstance(node.value, bool)
    if isinstance(node, ast.UnaryOp):
        return is_number(node.operand)
    if isinstance(node, ast.BinOp):
        sides = (node.left, node.right)
        return any(map(is_number, sides)) and all(is_number(side) or is_name(side) for side in sides)
    if isinstance(node, ast.Tuple):
        return bool(node.elts) and all(map(is_number, node.elts))
    return False


def is_name(node: ast.expr) -> bool:
    return isinstance(node, ast.Name | ast.Attribute)


def numbers(source: str) -> Iterator[tuple[int, str, ast.stmt]]:
    """Yield (index in the body, name, statement) of the constants of a file that are numbers."""
    for index, node in enumerate(ast.parse(source).body):
        value = node.value if isinstance(node, ast.Assign | ast.AnnAssign) else None
        for name in assigned(node):
            if CONSTANT.fullmatch(name) and is_number(value):
                yield index, name, node


def without_reason(source: str) -> list[str]:
    """Return the numbers that say neither on their line nor above it, or above their group, why they are so."""
    lines = source.splitlines()
    found = list(numbers(source))
    missing, explained = [], False
    for place, (index, name, node) in enumerate(found):
        first, last = node.lineno - 1, node.end_lineno
        below = place and index - found[place - 1][0] <= 1 and found[place - 1][2].end_lineno == first
        above = lines[first - 1].startswith("#")
        own = any("  # " in line for line in lines[first:last])
        # A comment holds for the numbers right below it, up to one that has a reason of its own.
        explained = above or (explained and bool(below) and not own)
        if not (own or explained or IDENTIFIER.search(name)):
            missing.append(name)
    return missing


def not_final(source: str) -> list[str]:
    """Return the numbers that are not declared as constants."""
    return [
        name
        for _, name, node in numbers(source)
        if not (isinstance(node, ast.AnnAssign) and ast.unparse(node.annotation).startswith("Final"))
    ]


def short(path: Path) -> str:
    return path.relative_to(PACKAGE).as_posix()


def test_a_public_name_occurs_once() -> None:
    assert repeated({short(path): path.read_text("utf-8") for path in FILES}) == {}


def test_a_repeated_name_would_be_found() -> None:
    sources = {
        "a.py": "class Query: ...\nlimit = 1\n_own = 1",
        "b.py": "class Query: ...\n_own = 1",
        "cli/check.py": "def check(): ...",
        "formats/load.py": "def check(): ...",
        "formats/sinumerik/tool.py": "class Tool: ...\nclass Row: ...",
        "formats/twincat/tool.py": "class Tool: ...\nclass Row: ...",
        "formats/twincat/rows.py": "class Row: ...",
        "ik/search/compiled/kernels.py": "def tilt(): ...",
        "kinematics/evaluation.py": "def tilt(): ...",
    }
    assert repeated(sources) == {
        "Query": ["a.py", "b.py"],
        "Row": ["formats/sinumerik/tool.py", "formats/twincat/rows.py", "formats/twincat/tool.py"],
    }


@pytest.mark.parametrize("path", FILES, ids=short)
def test_numbers_say_why(path: Path) -> None:
    source = path.read_text("utf-8")
    assert without_reason(source) == []
    assert not_final(source) == []


def test_a_number_without_reason_would_be_found() -> None:
    source = """
_STEPS: Final = 40
_FLOOR: Final = 1e-9  # rounding

# Measured.
_A: Final = 1
_B: Final = -2.0 * math.pi

_C: Final = (1, 2)
_D = 10**9
# A pattern.
_E: Final = re.compile("a")
_F: Final = 3
TEXT: Final = "40"
SINGULAR_ALARM: Final = 75327
"""
    assert without_reason(source) == ["_STEPS", "_C", "_D", "_F"]
    assert not_final(source) == ["_D"]
