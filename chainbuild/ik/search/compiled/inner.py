"""How the functions behind the entry points are compiled: to what their callers take over, not to machine code.

numba optimizes every function by itself, makes machine code of it, and does both again with each caller that it becomes
a part of. Inner functions are called by compiled code only, which links their intermediate code: the entry point, with
all of them inside, is the only one that needs optimization and machine code.

numba lets a decorator name its own compiler; what this one overrides in it is not documented. With a numba that this
was not tried with, inner functions are compiled as numba does it: the same answers, later.
"""

from __future__ import annotations

from typing import Any, Final

import numba

# The first and the last version of numba that this was tried with.
_TRIED: Final = ((0, 62), (0, 68))
# Without the wrappers that Python and C would call.
INNER: Final[dict[str, Any]] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}

if _TRIED[0] <= numba.version_info.short <= _TRIED[1]:
    from numba import _dynfunc  # type: ignore[attr-defined]
    from numba.core.codegen import JITCodeLibrary
    from numba.core.compiler import CompilerBase, DefaultPassBuilder
    from numba.core.compiler_machinery import register_pass
    from numba.core.typed_passes import NativeLowering

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

    class _InnerCompiler(CompilerBase):
        """numba's compiler with that lowering."""

        def define_pipelines(self) -> list[Any]:
            """Return numba's passes with its lowering replaced."""
            manager = DefaultPassBuilder.define_nopython_pipeline(self.state, "chainbuild_inner")
            manager.passes = [
                (_InnerLowering if each is NativeLowering else each, text) for each, text in manager.passes
            ]
            manager.finalize()
            return [manager]

    INNER["pipeline_class"] = _InnerCompiler
