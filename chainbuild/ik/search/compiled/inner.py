"""How the functions behind the entry points are compiled: to what their callers take over, not to machine code.

numba optimizes every function by itself, makes machine code of it, and does both again with each caller that it becomes
a part of. Inner functions are called by compiled code only, which links their intermediate code: the entry point, with
all of them inside, is the only one that needs optimization and machine code.

numba asks for the flags of a compilation at every look-up of a function and takes their hash from some thirty
properties each time, a fifth of all its work: here what is asked for is kept.

numba lets a decorator name its own compiler; what these override in it is not documented. With a numba that they were
not tried with, functions are compiled as numba does it: the same answers, later.
"""

from __future__ import annotations

from typing import Any, Final

import numba

# The first and the last version of numba that this was tried with.
_TRIED: Final = ((0, 62), (0, 68))
# Without the wrappers that Python and C would call.
INNER: Final[dict[str, Any]] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
# The same without counting references to arrays: for functions that make none, return none and are returned none.
LEAF: Final = dict(INNER)
# Options of entry points.
ENTRY: Final[dict[str, Any]] = {}

if _TRIED[0] <= numba.version_info.short <= _TRIED[1]:
    from numba import _dynfunc  # type: ignore[attr-defined]
    from numba.core.codegen import JITCodeLibrary
    from numba.core.compiler import Compiler, DefaultPassBuilder, Flags
    from numba.core.compiler_machinery import register_pass
    from numba.core.typed_passes import NativeLowering

    class _Kept(Flags):
        """Flags that stay as they are, with their values and hash."""

        def __init__(self, flags: Flags) -> None:
            super().__init__(flags)
            self._all = Flags.values(self)
            self._hash = Flags.__hash__(self)

        def values(self) -> dict[str, Any]:
            """Return the values by name; nobody writes to them."""
            return self._all

        def __eq__(self, other: object) -> bool:
            return super().__eq__(other)

        def __hash__(self) -> int:
            return self._hash

    class _Flags(Flags):
        """Flags whose copy, which numba takes for the time of a compilation, stays as it is."""

        def copy(self) -> _Kept:
            """Return the copy."""
            return _Kept(self)

    class _EntryCompiler(Compiler):
        """numba's compiler with such flags."""

        def __init__(self, *given: Any) -> None:
            super().__init__(*given)
            self.state.flags = _Flags(self.state.flags)

    class _InnerLibrary(JITCodeLibrary):
        """The code of one function, ready to be linked into a caller's."""

        def _optimize_final_module(self) -> None:
            """Leave it to the library of the entry point."""

        def _finalize_final_module(self) -> None:
            """Make no machine code."""
            self._finalized = True

    @register_pass(mutates_CFG=True, analysis_only=False)
    class _InnerLowering(NativeLowering):
        """numba's lowering into such a library; functions with parallel loops would need more."""

        _name = "chainbuild_inner_lowering"

        def run_pass(self, state: Any) -> bool:
            """Lower the function and tell numba what callers link."""
            library = state.library = _InnerLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
            state.flags.no_compile = True  # no pointer to machine code is asked for
            super().run_pass(state)
            library.finalize()
            lowered = state["cr"]
            described = lowered.fndesc
            # numba knows an overload by an object that Python could call; this one has no code.
            key = _dynfunc.make_function(
                described.lookup_module(), described.qualname, "inner function", 0, lowered.env, (library,)
            )
            state.targetctx.insert_user_function(key, described, [library])
            state["cr"] = lowered._replace(cfunc=key)
            return True

    class _InnerCompiler(_EntryCompiler):
        """The same with that lowering."""

        def define_pipelines(self) -> list[Any]:
            """Return numba's passes with its lowering replaced."""
            manager = DefaultPassBuilder.define_nopython_pipeline(self.state, "chainbuild_inner")
            manager.passes = [
                (_InnerLowering if each is NativeLowering else each, text) for each, text in manager.passes
            ]
            manager.finalize()
            return [manager]

    INNER["pipeline_class"], ENTRY["pipeline_class"] = _InnerCompiler, _EntryCompiler
    LEAF.update(INNER, _nrt=False)
    INNER["_nrt"] = True  # else a function takes over from the first one that calls it whether it counts
