"""The command line: one file a command, entry point `chainbuild.cli:main`.

`entry` builds the application; the commands are `info`, `check`, `types`, `fk`, `ik`, `urdf`, `inspect`, `picture`,
`demo`, `singularity`, `collide`, `limits`, `workspace`, `crosscheck`, `couple`, `as_universal` and `warm`. What several
of them use: `usage`, `show`, `axisvalues`, `info_tables`, `open_points`, `progress`, `process`; of paths `pathinput`,
`pathreport`, `pathdata`, `pathnotes` and `verdicts`.
"""

from __future__ import annotations

from chainbuild.cli.process import loading

with loading():
    from chainbuild.cli.entry import main

__all__ = ["main"]
