"""`chainbuild warm`: compile the solvers ahead."""

from __future__ import annotations

from chainbuild.cli.show import print_json
from chainbuild.cli.usage import Json
from chainbuild.progress import bars_shown


def warm(*, json: Json = False) -> int:
    """Compile the solvers ahead, so that no later call waits for it.

    With the extra `fast` numba compiles inverse kinematics at its first use, which takes up to a minute, and keeps the
    machine code beside the package or in the user's cache folder (NUMBA_CACHE_DIR names another). Run this once after
    an installation, such as while an image is built.

    Example: `chainbuild warm`

    Args:
        json: Print JSON.
    """
    from chainbuild.ik.warm import warm_up

    took = warm_up(progress=bars_shown())
    if json:
        print_json("warm", {"seconds": took})
        return 0
    for name, seconds in took.items():
        print(f"{seconds:6.1f} s  {name}")
    print(f"{sum(took.values()):6.1f} s  in all")
    return 0
