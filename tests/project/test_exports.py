"""The public names of the package: one table, its type-checking block, types that signatures speak of."""

from __future__ import annotations

import ast
import inspect
import pkgutil
import subprocess
import sys
from pathlib import Path

import pytest

import chainbuild
from chainbuild import errors
from chainbuild.kinematics.mechanism import Mechanism
from tests.kit.annotations import callables_of, named_types, public_things

SOURCE = Path(chainbuild.__file__)

# What may stand before the options: operands, and what the interface takes by position.
OPERANDS = {
    "collision",  # and visual: the other two of what a model of Pinocchio consists of
    "visual",
    "start", "held", "kinematic", "channel", "tool_length_mm", "conventions", "frame", "path", "folder", "tcp", "axes",
    "options", "spec", "carries",
}  # fmt: skip


def checked_block() -> dict[str, str]:
    """Return what the type-checking block imports: name → module."""
    tree = ast.parse(SOURCE.read_text("utf-8"))
    (block,) = (n for n in tree.body if isinstance(n, ast.If) and ast.unparse(n.test) == "TYPE_CHECKING")
    found = {}
    for node in block.body:
        assert isinstance(node, ast.ImportFrom)
        for alias in node.names:
            assert alias.asname == alias.name, f"{alias.name} is exported only as itself: `import X as X`"
            found[alias.name] = node.module
    return found


def test_the_type_checking_block_says_what_the_table_says() -> None:
    table = chainbuild._LAZY
    wanted = "\n".join(f"    from {table[n]} import {n} as {n}" for n in sorted(table, key=lambda n: (table[n], n)))
    assert checked_block() == table, f"the block should read\n{wanted}"


def test_every_public_name_is_there_once() -> None:
    assert len(set(chainbuild.__all__)) == len(chainbuild.__all__)
    assert set(chainbuild.__all__) == {"__version__", *chainbuild._LAZY}
    assert dir(chainbuild) == sorted(chainbuild.__all__)
    for name in chainbuild.__all__:
        assert getattr(chainbuild, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'robot_arm'"):
        chainbuild.robot_arm  # noqa: B018


def test_no_public_name_is_a_submodule() -> None:
    """Python binds an imported submodule to its name in the package, and would hide what the table means by it."""
    modules = {module.name for module in pkgutil.iter_modules(chainbuild.__path__)}
    assert modules & set(chainbuild.__all__) == set()


def test_every_type_that_signatures_speak_of_is_exported() -> None:
    missing = {name: sorted(where) for name, where in named_types().items() if name not in chainbuild.__all__}
    assert missing == {}


def test_every_error_is_exported() -> None:
    own = {name for name, thing in vars(errors).items() if isinstance(thing, type) and issubclass(thing, Exception)}
    assert own <= set(chainbuild.__all__)


PUBLIC = {where: function for _, thing in public_things() for where, function in callables_of(thing)}


@pytest.mark.parametrize("where", sorted(PUBLIC))
def test_options_are_given_by_name(where: str) -> None:
    for parameter in inspect.signature(PUBLIC[where]).parameters.values():
        by_place = parameter.kind is parameter.POSITIONAL_OR_KEYWORD and parameter.default is not parameter.empty
        assert not by_place or parameter.name in OPERANDS, f"{where}: {parameter.name} stands behind no `*`"


@pytest.mark.parametrize("where", sorted(PUBLIC))
def test_the_robot_comes_first(where: str) -> None:
    names = [name for name, text in PUBLIC[where].__annotations__.items() if text == "Mechanism" and name != "return"]
    parameters = [name for name in inspect.signature(PUBLIC[where]).parameters if name != "self"]
    assert names in ([], ["robot"])
    assert not names or parameters[0] == "robot"


def test_the_same_option_is_called_the_same() -> None:
    known = {name for function in PUBLIC.values() for name in inspect.signature(function).parameters}
    assert known & {"starts", "done", "model", "mechanism", "unit", "opts", "option"} == set()


def test_a_robot_is_a_mechanism_and_so_are_its_functions() -> None:
    assert issubclass(chainbuild.Robot, Mechanism)
    assert chainbuild.Mechanism is Mechanism


def test_importing_the_package_imports_nothing_heavy() -> None:
    code = "import chainbuild, sys; print(sorted({'numpy', 'pinocchio', 'coal', 'rich'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
