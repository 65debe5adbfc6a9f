"""The command line: one file a command, entry point `chainbuild.cli:main`.

`entry` builds the application; the commands are `info`, `check`, `types`, `fk`, `ik`, `urdf`, `export`, `inspect`,
`picture`, `demo`, `singularity`, `collide`, `limits`, `workspace`, `crosscheck`, `couple`, `as_universal`, `warm` and
`completion`. Wrong command lines are answered by `mistakes`.
What several of them use: `usage`, `show`, `axisvalues`, `info_tables`, `open_points`, `process`; of paths
`pathinput`, `pathreport`, `pathdata`, `pathnotes` and `verdicts`.
"""

from __future__ import annotations

import signal

# What takes care of interrupts has to be imported first: until then one ends the process without a word.
_before = signal.getsignal(signal.SIGINT)
_ours = _before is signal.default_int_handler
try:
    if _ours:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
except ValueError:  # a thread may not say what becomes of signals
    _ours = False
from chainbuild.cli.process import loading  # noqa: E402

if _ours:
    signal.signal(signal.SIGINT, _before)

with loading():
    from chainbuild.cli.entry import main

__all__ = ["main"]
