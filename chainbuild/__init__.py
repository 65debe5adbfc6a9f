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
    from chainbuild.analysis.free_ik import collision_free_ik
    from chainbuild.analysis.maps import make_map
    from chainbuild.analysis.mapspec import MapSpec
    from chainbuild.analysis.measures import measure_batch
    from chainbuild.analysis.names import examine
    from chainbuild.analysis.nearest import nearest_singularity
    from chainbuild.analysis.parallelogram import swept_limits
    from chainbuild.analysis.paths import contacts
    from chainbuild.chain.compose import follow, stack
    from chainbuild.chain.elements import Axis, Chain
    from chainbuild.conventions import Convention, conventions
    from chainbuild.findings import Finding
    from chainbuild.inspect.export import export_page
    from chainbuild.loading import check, load
    from chainbuild.machine import Machine
    from chainbuild.machines import shipped
    from chainbuild.out.urdf import write_urdf
    from chainbuild.robot.collision import CollisionModel
    from chainbuild.robot.robot import Robot
    from chainbuild.solve.base.options import IkOptions
    from chainbuild.solve.base.result import IkResult
    from chainbuild.solve.check.crosscheck import crosscheck
    from chainbuild.solve.closed.batch import ik_all_batch
    from chainbuild.solve.damped.table import IkTable
    from chainbuild.twincat.as_universal import as_universal
    from chainbuild.twincat.catalogue import catalogue
    from chainbuild.urdf_in import from_urdf

__version__ = "0.1.0"

# Name → module, imported at first use, so that `import chainbuild` and `chainbuild --help` stay quick.
_LAZY = {
    "collision_free_ik": "chainbuild.analysis.free_ik",
    "make_map": "chainbuild.analysis.maps",
    "MapSpec": "chainbuild.analysis.mapspec",
    "measure_batch": "chainbuild.analysis.measures",
    "examine": "chainbuild.analysis.names",
    "nearest_singularity": "chainbuild.analysis.nearest",
    "swept_limits": "chainbuild.analysis.parallelogram",
    "contacts": "chainbuild.analysis.paths",
    "follow": "chainbuild.chain.compose",
    "stack": "chainbuild.chain.compose",
    "Axis": "chainbuild.chain.elements",
    "Chain": "chainbuild.chain.elements",
    "Convention": "chainbuild.conventions",
    "conventions": "chainbuild.conventions",
    "Finding": "chainbuild.findings",
    "export_page": "chainbuild.inspect.export",
    "check": "chainbuild.loading",
    "load": "chainbuild.loading",
    "Machine": "chainbuild.machine",
    "shipped": "chainbuild.machines",
    "write_urdf": "chainbuild.out.urdf",
    "CollisionModel": "chainbuild.robot.collision",
    "Robot": "chainbuild.robot.robot",
    "ik_all_batch": "chainbuild.solve.closed.batch",
    "crosscheck": "chainbuild.solve.check.crosscheck",
    "IkOptions": "chainbuild.solve.base.options",
    "IkResult": "chainbuild.solve.base.result",
    "IkTable": "chainbuild.solve.damped.table",
    "as_universal": "chainbuild.twincat.as_universal",
    "catalogue": "chainbuild.twincat.catalogue",
    "from_urdf": "chainbuild.urdf_in",
}

__all__ = [
    "Axis",
    "Chain",
    "ChainbuildError",
    "CollisionModel",
    "Convention",
    "Finding",
    "IkOptions",
    "IkResult",
    "IkTable",
    "Machine",
    "MapSpec",
    "Robot",
    "__version__",
    "as_universal",
    "catalogue",
    "check",
    "collision_free_ik",
    "contacts",
    "conventions",
    "crosscheck",
    "examine",
    "export_page",
    "follow",
    "from_urdf",
    "ik_all_batch",
    "load",
    "make_map",
    "measure_batch",
    "nearest_singularity",
    "shipped",
    "stack",
    "swept_limits",
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
