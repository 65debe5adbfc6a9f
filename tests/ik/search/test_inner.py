"""Functions behind entry points: no machine code of their own where numba allows it, the same answers where not."""

from __future__ import annotations

import runpy
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("numba")

import numba
from numba.core.compiler import Flags

from chainbuild.ik.search.compiled import inner, kernels


def tripled(x):  # type: ignore[no-untyped-def]
    return 3.0 * x


def called_by_compiled_code(options: Mapping[str, Any]):  # type: ignore[no-untyped-def]
    function = numba.njit(**options)(tripled)

    @numba.njit
    def entry(x):  # type: ignore[no-untyped-def]
        return function(x) + 1.0

    return entry(2.0), function


def has_machine_code(function: Any) -> bool:
    (overload,) = function.overloads.values()
    return bool(overload.library.get_pointer_to_function(overload.fndesc.llvm_func_name))


def test_the_installed_numba_was_tried() -> None:
    assert inner._TRIED[0] <= numba.version_info.short <= inner._TRIED[1]  # else try it, then write it there
    assert "pipeline_class" in inner.INNER


def test_an_inner_function_has_no_machine_code() -> None:
    value, function = called_by_compiled_code(inner.INNER)
    assert value == 7.0
    assert not has_machine_code(function)


@pytest.mark.parametrize("version", [(0, 61), (1, 0)])
def test_with_a_numba_not_tried_it_is_compiled_as_ever(
    monkeypatch: pytest.MonkeyPatch, version: tuple[int, int]
) -> None:
    monkeypatch.setattr(numba, "version_info", SimpleNamespace(short=version))
    options = runpy.run_path(str(inner.__file__))["INNER"]
    assert "pipeline_class" not in options
    value, function = called_by_compiled_code(options)
    assert value == 7.0
    assert has_machine_code(function)


def hashes_taken(options: Mapping[str, Any]) -> int:
    """Return how often numba takes the hash of flags while a function is compiled."""
    taken, usual = [], Flags.__hash__
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(Flags, "__hash__", lambda flags: (taken.append(flags), usual(flags))[1])
        assert numba.njit(**options)(lambda x: max(x, 1.0) + min(x, 1.0))(2.0) == 3.0
    return len(taken)


def test_the_hash_of_flags_is_taken_once() -> None:
    hashes_taken({})  # numba's own functions are compiled, too
    assert hashes_taken(inner.ENTRY) == 1
    assert hashes_taken({}) > 4


def test_kept_flags_are_those_that_they_were_taken_from() -> None:
    flags = Flags()
    flags.fastmath = True
    kept = inner._Flags(flags).copy()
    assert kept == flags
    assert flags == kept
    assert hash(kept) == hash(flags)
    assert kept.fastmath
    assert kept != Flags()


def test_a_function_first_called_by_one_that_is_put_into_its_callers_is_not_put_there_too() -> None:
    called = kernels.jit(tripled)
    between = kernels.inlined(lambda x: called(x) + 1.0)
    assert numba.njit(lambda x: 2.0 * between(x))(2.0) == 14.0
    for function, inline in ((called, False), (between, True)):
        (overload,) = function.overloads.values()
        assert overload.fndesc.inline is inline
