"""A mutant in a module that is loaded already: its functions get the code of the mutated ones."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from types import CodeType, FunctionType, ModuleType


def transplanted(module: str, path: Path, source: str) -> bool:
    """Give the functions of a loaded module the code of mutated source; return whether all of them have it.

    Whoever holds one of its functions holds the mutated one from then on. What a module makes while it is loaded, such
    as constants, is not touched.
    """
    loaded = sys.modules.get(module)
    if loaded is None:
        return False
    fresh = ModuleType(module)
    fresh.__file__, fresh.__package__ = str(path), module.rpartition(".")[0]
    code = compile(source, str(path), "exec", dont_inherit=True)
    exec(code, fresh.__dict__)
    replaced = 0
    for old, new in _pairs(vars(loaded), vars(fresh), module, str(path)):
        if old.__code__.co_freevars != new.__code__.co_freevars:
            return False
        old.__code__ = new.__code__
        replaced += 1
    return replaced == _functions_in(code)


def _functions_in(code: CodeType) -> int:
    """Return how many functions a module defines, those of its classes included, those within functions not."""
    inner = [part for part in code.co_consts if isinstance(part, CodeType) and not part.co_name.startswith("<")]
    # The body of a class is the code that sets __qualname__; all others are functions.
    return sum(_functions_in(part) if "__qualname__" in part.co_names else 1 for part in inner)


def _pairs(
    old: dict[str, object], new: dict[str, object], module: str, file: str
) -> Iterator[tuple[FunctionType, FunctionType]]:
    """Yield the functions of a namespace, and of its classes, old and new; not those that dataclasses make."""
    for name, value in list(new.items()):
        known = old.get(name)
        if isinstance(value, type) and isinstance(known, type) and value.__module__ == known.__module__ == module:
            yield from _pairs(dict(vars(known)), dict(vars(value)), module, file)
            continue
        for one, other in zip(_functions_of(known), _functions_of(value), strict=False):
            if other.__code__.co_filename == file and other is not one:
                yield one, other


def _functions_of(value: object) -> list[FunctionType]:
    """Return the functions behind a method, a property or what caches."""
    if isinstance(value, property):
        return [f for part in (value.fget, value.fset) if part is not None for f in _functions_of(part)]
    if isinstance(value, cached_property):
        return _functions_of(value.func)
    if isinstance(value, staticmethod | classmethod):
        return _functions_of(value.__func__)
    if hasattr(value, "cache_clear"):
        value.cache_clear()
    if hasattr(value, "__wrapped__"):
        return _functions_of(value.__wrapped__)
    return [value] if isinstance(value, FunctionType) else []
