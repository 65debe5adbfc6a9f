"""Which types of the package the annotations and docstrings of its public names speak of."""

from __future__ import annotations

import ast
import inspect
import re
import sys
from collections.abc import Iterator
from functools import cache
from importlib import import_module
from types import FunctionType
from typing import Any, get_origin

import chainbuild
from chainbuild import errors

WORD = re.compile(r"\b[A-Za-z_]\w*\b")


def public_things() -> Iterator[tuple[str, Any]]:
    """Yield every public function and class by name."""
    for name in sorted(chainbuild.__all__):
        thing = getattr(chainbuild, name)
        if callable(thing) and get_origin(thing) is None:
            yield name, thing


def callables_of(thing: Any) -> Iterator[tuple[str, FunctionType]]:
    """Yield the functions that belong to a public name: itself, or the public methods and properties of a class."""
    if not isinstance(thing, type):
        yield thing.__name__, inspect.unwrap(thing)
        return
    for cls in thing.__mro__:
        if not cls.__module__.startswith("chainbuild"):
            continue
        for name, member in vars(cls).items():
            inner = getattr(member, "fget", None) or getattr(member, "__func__", member)
            inner = inspect.unwrap(inner) if callable(inner) else inner
            if isinstance(inner, FunctionType) and (not name.startswith("_") or name in {"__getitem__", "__iter__"}):
                yield f"{thing.__name__}.{name}", inner


def annotations_of(thing: Any) -> Iterator[tuple[str, str, str]]:
    """Yield (where, module, annotation) of the functions of a public name, and of the fields of a class."""
    for name, function in callables_of(thing):
        for parameter, text in function.__annotations__.items():
            yield f"{name}({parameter})", function.__module__, str(text)
    for cls in thing.__mro__ if isinstance(thing, type) else ():
        if cls.__module__.startswith("chainbuild"):
            for field, text in vars(cls).get("__annotations__", {}).items():
                if not field.startswith("_"):
                    yield f"{thing.__name__}.{field}", cls.__module__, str(text)


@cache
def imported(module: str) -> dict[str, tuple[str, str]]:
    """Return what a module imports from the package, for type checking, too: name → (module, name there)."""
    found: dict[str, tuple[str, str]] = {}
    for node in ast.walk(ast.parse(inspect.getsource(sys.modules[module]))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("chainbuild"):
            for alias in node.names:
                found[alias.asname or alias.name] = (node.module or "", alias.name)
    return found


def resolve(word: str, module: str) -> Any:
    """Return the class of the package that a word of an annotation means, or None."""
    source, name = imported(module).get(word, (module, word))
    try:
        thing = getattr(import_module(source), name, None)
    except ImportError:
        return None
    return thing if isinstance(thing, type) and thing.__module__.startswith("chainbuild") else None


def named_types() -> dict[str, set[str]]:
    """Return every class that public annotations name, and the errors that docstrings say are raised: name → where."""
    found: dict[str, set[str]] = {}
    for _, thing in public_things():
        for where, module, text in annotations_of(thing):
            for word in WORD.findall(re.sub(r"(['\"]).*?\1", "", text)):
                if resolve(word, module) is not None:
                    found.setdefault(word, set()).add(where)
        for name, function in callables_of(thing):
            for word in re.findall(r"^\s+(\w+Error): ", function.__doc__ or "", re.MULTILINE):
                if hasattr(errors, word):
                    found.setdefault(word, set()).add(f"{name} raises")
    return found
