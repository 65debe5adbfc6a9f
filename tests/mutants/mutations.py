"""What is mutated: signs, swapped axes, zeroed offsets, sine for cosine."""

from __future__ import annotations

import ast
import pickle
from collections.abc import Callable, Iterator
from dataclasses import dataclass

_LETTERS = {"x": "y", "y": "z", "z": "x", "-x": "x", "-y": "y", "-z": "z"}
_NAMES = {
    "cos": "sin",
    "sin": "cos",
    "rot_x": "rot_y",
    "rot_y": "rot_z",
    "rot_z": "rot_x",
    "inside": "outside",
}
_OPERATORS: dict[type[ast.operator], type[ast.operator]] = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Div: ast.Mult}


@dataclass(frozen=True)
class Mutant:
    """One change of one file.

    Attributes:
        line: Where.
        function: The function or class it lies in, or an empty string.
        what: The change in words.
        source: The whole mutated file.
    """

    line: int
    function: str
    what: str
    source: str


def mutants_of(source: str) -> Iterator[Mutant]:
    """Yield every mutant of a file's text."""
    tree = ast.parse(source)
    _drop_annotations(tree)
    spots, kept = list(_walk(tree, "")), pickle.dumps(tree)
    for number, (node, function) in enumerate(spots):
        for what, change in _changes(node):
            changed = pickle.loads(kept)  # a tenth of the time of copy.deepcopy
            change(list(_walk(changed, ""))[number][0])
            yield Mutant(getattr(node, "lineno", 0), function, what, ast.unparse(changed))


def _drop_annotations(tree: ast.AST) -> None:
    """Take annotations and docstrings away: nothing in them can be wrong geometry."""
    for node in ast.walk(tree):
        if isinstance(node, ast.AnnAssign) and "ClassVar" not in ast.unparse(node.annotation):
            node.annotation = ast.Name("object", ast.Load())
        if isinstance(node, ast.FunctionDef):
            node.returns = None
            for argument in (*node.args.args, *node.args.kwonlyargs):
                argument.annotation = None
        body = getattr(node, "body", None)
        if (
            isinstance(body, list)
            and body
            and isinstance(body[0], ast.Expr)
            and isinstance(body[0].value, ast.Constant)
        ):
            body[0].value.value = "."


def _walk(node: ast.AST, function: str) -> Iterator[tuple[ast.AST, str]]:
    if isinstance(node, ast.FunctionDef):
        function = node.name
    yield node, function
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.Raise):
            continue  # messages
        yield from _walk(child, function)


def _changes(node: ast.AST) -> Iterator[tuple[str, Callable[[ast.AST], None]]]:
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield f"sign dropped: {ast.unparse(node)}", lambda n: setattr(n, "op", ast.UAdd())
    elif isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS and not _unsigns_zero(node):
        other = _OPERATORS[type(node.op)]
        yield f"{other.__name__} for {ast.unparse(node)}", lambda n: setattr(n, "op", other())
    elif isinstance(node, ast.Constant) and node.value in _LETTERS and isinstance(node.value, str):
        letter = _LETTERS[node.value]
        yield f"axis {node.value} → {letter}", lambda n: setattr(n, "value", letter)
    elif isinstance(node, ast.Constant) and isinstance(node.value, float) and abs(node.value) in (1.0, 90.0, 180.0):
        value = -node.value
        yield f"{node.value} → {value}", lambda n: setattr(n, "value", value)
    elif isinstance(node, ast.Name) and node.id in _NAMES:
        name = _NAMES[node.id]
        yield f"{node.id} → {name}", lambda n: setattr(n, "id", name)
    elif isinstance(node, ast.Attribute) and node.attr in _NAMES:
        name = _NAMES[node.attr]
        yield f"{node.attr} → {name}", lambda n: setattr(n, "attr", name)
    elif isinstance(node, ast.Call):
        yield from _zeroed(node)


def _unsigns_zero(node: ast.BinOp) -> bool:
    """Return whether a sum only makes 0.0 of -0.0: the difference is the same number, which no comparison tells."""
    return isinstance(node.right, ast.Constant) and isinstance(node.right.value, float) and node.right.value == 0.0


def _zeroed(node: ast.Call) -> Iterator[tuple[str, Callable[[ast.AST], None]]]:
    """Zero each argument of a `shift`; flip the sign of each of its keywords, and of keywords `sign`, `offset_…`."""
    called = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
    for index, argument in enumerate(node.args):
        if called == "shift" and not isinstance(argument, ast.Constant | ast.Starred):

            def zero(n: ast.AST, index: int = index) -> None:
                assert isinstance(n, ast.Call)
                n.args[index] = ast.Constant(0.0)

            yield f"zeroed: {ast.unparse(argument)}", zero
    for index, keyword in enumerate(node.keywords):
        if keyword.arg in {"sign", "offset_deg", "offset_mm", "zero_deg"} or called == "shift":

            def flip(n: ast.AST, index: int = index) -> None:
                assert isinstance(n, ast.Call)
                n.keywords[index].value = ast.UnaryOp(ast.USub(), n.keywords[index].value)

            yield f"flipped {keyword.arg}={ast.unparse(keyword.value)}", flip
