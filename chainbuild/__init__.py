"""chainbuild: from the machine data of a CNC to a kinematic model.

import chainbuild

machine = chainbuild.load("robot.tea")   # what the file says, typed, with findings
robot = chainbuild.Robot(machine.chain())  # a Pinocchio model
T = robot.fk([0, -90, 90, 0, 0, 0])      # tool in the workpiece frame, metres
result = robot.ik(T)                     # axis values, mm and degrees
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from chainbuild.errors import ChainbuildError

if TYPE_CHECKING:
    from chainbuild.analysis.collision.free_ik import collision_free_ik
    from chainbuild.analysis.collision.parallelogram import swept_limits
    from chainbuild.analysis.collision.paths import contacts
    from chainbuild.analysis.singularity.measures import measure_batch
    from chainbuild.analysis.singularity.names import examine
    from chainbuild.analysis.singularity.nearest import nearest_singularity
    from chainbuild.analysis.workspace.maps import make_map
    from chainbuild.analysis.workspace.mapspec import MapSpec
    from chainbuild.chain.compose import follow, stack
    from chainbuild.chain.elements import Axis, Chain
    from chainbuild.collision.model import CollisionModel
    from chainbuild.comparison.crosscheck import crosscheck
    from chainbuild.convention import Convention, conventions
    from chainbuild.findings import Finding
    from chainbuild.formats.load import check, load
    from chainbuild.formats.machine import Machine
    from chainbuild.formats.twincat.types.catalogue import catalogue
    from chainbuild.formats.twincat.universal.as_universal import as_universal
    from chainbuild.formats.urdf import from_urdf
    from chainbuild.ik.branches.opw.batch import ik_all_batch
    from chainbuild.ik.options import IkOptions
    from chainbuild.ik.result import IkResult
    from chainbuild.ik.search.table import IkTable
    from chainbuild.inspect.export import export_page
    from chainbuild.machines import shipped
    from chainbuild.robot import Robot
    from chainbuild.writers.urdf import write_urdf

__version__ = "0.1.0"

# Name → module, imported at first use, so that `import chainbuild` and `chainbuild --help` stay quick.
_LAZY = {
    "collision_free_ik": "chainbuild.analysis.collision.free_ik",
    "make_map": "chainbuild.analysis.workspace.maps",
    "MapSpec": "chainbuild.analysis.workspace.mapspec",
    "measure_batch": "chainbuild.analysis.singularity.measures",
    "examine": "chainbuild.analysis.singularity.names",
    "nearest_singularity": "chainbuild.analysis.singularity.nearest",
    "swept_limits": "chainbuild.analysis.collision.parallelogram",
    "contacts": "chainbuild.analysis.collision.paths",
    "follow": "chainbuild.chain.compose",
    "stack": "chainbuild.chain.compose",
    "Axis": "chainbuild.chain.elements",
    "Chain": "chainbuild.chain.elements",
    "Convention": "chainbuild.convention",
    "conventions": "chainbuild.convention",
    "Finding": "chainbuild.findings",
    "export_page": "chainbuild.inspect.export",
    "check": "chainbuild.formats.load",
    "load": "chainbuild.formats.load",
    "Machine": "chainbuild.formats.machine",
    "shipped": "chainbuild.machines",
    "write_urdf": "chainbuild.writers.urdf",
    "CollisionModel": "chainbuild.collision.model",
    "Robot": "chainbuild.robot",
    "ik_all_batch": "chainbuild.ik.branches.opw.batch",
    "crosscheck": "chainbuild.comparison.crosscheck",
    "IkOptions": "chainbuild.ik.options",
    "IkResult": "chainbuild.ik.result",
    "IkTable": "chainbuild.ik.search.table",
    "as_universal": "chainbuild.formats.twincat.universal.as_universal",
    "catalogue": "chainbuild.formats.twincat.types.catalogue",
    "from_urdf": "chainbuild.formats.urdf",
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
