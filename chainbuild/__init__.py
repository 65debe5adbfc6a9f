"""chainbuild: from the machine data of a CNC to a kinematic model.

import chainbuild

machine = chainbuild.load("robot.tea")   # what the file says, typed, with findings
robot = machine.chain().build()          # a Pinocchio model
T = robot.fk([0, -90, 90, 0, 0, 0])      # tool in the workpiece frame, metres
result = robot.ik(T)                     # axis values, mm and degrees
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from chainbuild.errors import ChainbuildError

if TYPE_CHECKING:
    from chainbuild.chain.elements import Axis, Chain
    from chainbuild.conventions import Convention, conventions
    from chainbuild.findings import Finding
    from chainbuild.loading import check, load
    from chainbuild.machine import Machine
    from chainbuild.machines import shipped
    from chainbuild.out.urdf import write_urdf
    from chainbuild.robot.robot import Robot
    from chainbuild.solve.options import IkOptions
    from chainbuild.solve.result import IkResult
    from chainbuild.solve.table import IkTable
    from chainbuild.twincat.catalogue import catalogue
    from chainbuild.urdf_in import from_urdf

__version__ = "0.1.0"

# Name → module, imported at first use, so that `import chainbuild` and `chainbuild --help` stay quick.
_LAZY = {
    "Axis": "chainbuild.chain.elements",
    "Chain": "chainbuild.chain.elements",
    "Convention": "chainbuild.conventions",
    "conventions": "chainbuild.conventions",
    "Finding": "chainbuild.findings",
    "check": "chainbuild.loading",
    "load": "chainbuild.loading",
    "Machine": "chainbuild.machine",
    "shipped": "chainbuild.machines",
    "write_urdf": "chainbuild.out.urdf",
    "Robot": "chainbuild.robot.robot",
    "IkOptions": "chainbuild.solve.options",
    "IkResult": "chainbuild.solve.result",
    "IkTable": "chainbuild.solve.table",
    "from_urdf": "chainbuild.urdf_in",
    "catalogue": "chainbuild.twincat.catalogue",
}

__all__ = [
    "Axis",
    "Chain",
    "ChainbuildError",
    "Convention",
    "Finding",
    "IkOptions",
    "IkResult",
    "IkTable",
    "Machine",
    "Robot",
    "__version__",
    "catalogue",
    "check",
    "conventions",
    "from_urdf",
    "load",
    "shipped",
    "write_urdf",
]


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        raise AttributeError(f"module 'chainbuild' has no attribute '{name}'")
    from importlib import import_module

    module = import_module(_LAZY[name])
    value = globals()[name] = getattr(module, name)
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
