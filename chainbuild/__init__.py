"""chainbuild: from the machine data of a CNC to a kinematic model.

import chainbuild

machine = chainbuild.load("robot.tea")   # what the file says, typed, with findings
robot = chainbuild.Robot(machine.chain())  # a Pinocchio model
T = robot.fk([0, -90, 90, 0, 0, 0])      # tool in the workpiece frame, metres
result = robot.ik(T)                     # axis values, mm and degrees
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # what the table below says, for type checkers; a test holds the two together
    from chainbuild.analysis.collision.free_ik import collision_free_ik as collision_free_ik
    from chainbuild.analysis.collision.parallelogram import LimitReport as LimitReport
    from chainbuild.analysis.collision.parallelogram import swept_limits as swept_limits
    from chainbuild.analysis.collision.paths import Contact as Contact
    from chainbuild.analysis.collision.paths import contacts as contacts
    from chainbuild.analysis.collision.sweep import FreeInterval as FreeInterval
    from chainbuild.analysis.path.along import PathOptions as PathOptions
    from chainbuild.analysis.path.along import path_report as path_report
    from chainbuild.analysis.path.places import PathMinimum as PathMinimum
    from chainbuild.analysis.path.places import PathPlace as PathPlace
    from chainbuild.analysis.path.places import PathReport as PathReport
    from chainbuild.analysis.path.places import PathSpeed as PathSpeed
    from chainbuild.analysis.path.places import PathStretch as PathStretch
    from chainbuild.analysis.path.places import PathViolation as PathViolation
    from chainbuild.analysis.singularity.measures import Measures as Measures
    from chainbuild.analysis.singularity.measures import MeasureTable as MeasureTable
    from chainbuild.analysis.singularity.measures import measure_batch as measure_batch
    from chainbuild.analysis.singularity.names import SingularityReport as SingularityReport
    from chainbuild.analysis.singularity.names import examine as examine
    from chainbuild.analysis.singularity.nearest import Nearest as Nearest
    from chainbuild.analysis.singularity.nearest import nearest_singularity as nearest_singularity
    from chainbuild.analysis.singularity.singularity import Singularity as Singularity
    from chainbuild.analysis.singularity.speeds import AxisSpeed as AxisSpeed
    from chainbuild.analysis.singularity.speeds import SpeedReport as SpeedReport
    from chainbuild.analysis.verdicts.blockverdicts import BlockVerdict as BlockVerdict
    from chainbuild.analysis.verdicts.blockverdicts import SingularityVerdicts as SingularityVerdicts
    from chainbuild.analysis.verdicts.blockverdicts import VerdictPart as VerdictPart
    from chainbuild.analysis.verdicts.judging import singularity_verdicts as singularity_verdicts
    from chainbuild.analysis.workspace.maps import Map as Map
    from chainbuild.analysis.workspace.maps import make_map as make_map
    from chainbuild.analysis.workspace.mapspec import Grid as Grid
    from chainbuild.analysis.workspace.mapspec import MapKind as MapKind
    from chainbuild.analysis.workspace.mapspec import MapSpec as MapSpec
    from chainbuild.chain.axismap import AffineMap as AffineMap
    from chainbuild.chain.axismap import AxisMap as AxisMap
    from chainbuild.chain.bodies.geometry import Geometry as Geometry
    from chainbuild.chain.bodies.geometry import RodData as RodData
    from chainbuild.chain.bodies.geometry import Shape as Shape
    from chainbuild.chain.bodies.geometry import Stand as Stand
    from chainbuild.chain.bodies.inertia import Inertia as Inertia
    from chainbuild.chain.bodies.inertia import JointDynamics as JointDynamics
    from chainbuild.chain.compose import follow as follow
    from chainbuild.chain.compose import stack as stack
    from chainbuild.chain.drives import AffineDrives as AffineDrives
    from chainbuild.chain.drives import DriveLimit as DriveLimit
    from chainbuild.chain.drives import DriveMap as DriveMap
    from chainbuild.chain.elements import Axis as Axis
    from chainbuild.chain.elements import Chain as Chain
    from chainbuild.chain.elements import ControllerSolver as ControllerSolver
    from chainbuild.chain.elements import Frame as Frame
    from chainbuild.chain.elements import Joint as Joint
    from chainbuild.chain.elements import JointKind as JointKind
    from chainbuild.chain.elements import Link as Link
    from chainbuild.chain.elements import Loop as Loop
    from chainbuild.chain.elements import Partial as Partial
    from chainbuild.chain.elements import SingularityWatch as SingularityWatch
    from chainbuild.chain.elements import Task as Task
    from chainbuild.chain.programmed.display import Display as Display
    from chainbuild.chain.programmed.display import DisplayKind as DisplayKind
    from chainbuild.chain.programmed.named import NamedPose as NamedPose
    from chainbuild.chain.programmed.vectors import AngleLetter as AngleLetter
    from chainbuild.chain.programmed.vectors import OriMode as OriMode
    from chainbuild.chain.programmed.vectors import ToolPlane as ToolPlane
    from chainbuild.chain.programmed.vectors import VectorProgramming as VectorProgramming
    from chainbuild.chain.sums import AxisConstraint as AxisConstraint
    from chainbuild.chain.sums import AxisSum as AxisSum
    from chainbuild.collision.model import CollisionModel as CollisionModel
    from chainbuild.collision.model import Distance as Distance
    from chainbuild.comparison.comparison import Forward as Forward
    from chainbuild.comparison.comparison import Inverse as Inverse
    from chainbuild.comparison.convention_trials import Selection as Selection
    from chainbuild.comparison.convention_trials import Trial as Trial
    from chainbuild.comparison.crosscheck import CheckOptions as CheckOptions
    from chainbuild.comparison.crosscheck import CrossCheck as CrossCheck
    from chainbuild.comparison.crosscheck import crosscheck as crosscheck
    from chainbuild.comparison.data_trials import DataTrial as DataTrial
    from chainbuild.comparison.diagnosis import Explanation as Explanation
    from chainbuild.comparison.samples import Samples as Samples
    from chainbuild.convention import Convention as Convention
    from chainbuild.convention import UsedConvention as UsedConvention
    from chainbuild.convention import conventions as conventions
    from chainbuild.coupling.distribution import Distribution as Distribution
    from chainbuild.coupling.distribution import PartialPose as PartialPose
    from chainbuild.errors import AxisValueError as AxisValueError
    from chainbuild.errors import ChainbuildError as ChainbuildError
    from chainbuild.errors import ChainError as ChainError
    from chainbuild.errors import ConventionError as ConventionError
    from chainbuild.errors import FileAccessError as FileAccessError
    from chainbuild.errors import FileContentError as FileContentError
    from chainbuild.errors import MachineDataError as MachineDataError
    from chainbuild.errors import OverlayError as OverlayError
    from chainbuild.errors import OverwriteError as OverwriteError
    from chainbuild.errors import ParseError as ParseError
    from chainbuild.errors import Span as Span
    from chainbuild.errors import TableError as TableError
    from chainbuild.errors import UnsupportedKinematicError as UnsupportedKinematicError
    from chainbuild.findings import Finding as Finding
    from chainbuild.findings import Findings as Findings
    from chainbuild.findings import Severity as Severity
    from chainbuild.formats.entries import Datum as Datum
    from chainbuild.formats.entries import KinematicEntry as KinematicEntry
    from chainbuild.formats.entries import ParameterRow as ParameterRow
    from chainbuild.formats.load import check as check
    from chainbuild.formats.load import from_urdf as from_urdf
    from chainbuild.formats.load import load as load
    from chainbuild.formats.machine import Machine as Machine
    from chainbuild.formats.twincat.lists.hdtable import AxisRow as AxisRow
    from chainbuild.formats.twincat.lists.hdtable import HdRow as HdRow
    from chainbuild.formats.twincat.lists.hdtable import TypeData as TypeData
    from chainbuild.formats.twincat.types.catalogue import KinType as KinType
    from chainbuild.formats.twincat.types.catalogue import catalogue as catalogue
    from chainbuild.formats.twincat.universal.as_universal import as_universal as as_universal
    from chainbuild.ik.branches.core.branches import Branch as Branch
    from chainbuild.ik.branches.core.branches import Branches as Branches
    from chainbuild.ik.branches.many import ik_all_batch as ik_all_batch
    from chainbuild.ik.branches.status_turn import status_turn as status_turn
    from chainbuild.ik.branches.status_turn import status_turn_rows as status_turn_rows
    from chainbuild.ik.plan import SolverPlan as SolverPlan
    from chainbuild.ik.policies.redundancy import Preference as Preference
    from chainbuild.ik.policies.status_path import status_changes as status_changes
    from chainbuild.ik.request import IkOptions as IkOptions
    from chainbuild.ik.result import IkResult as IkResult
    from chainbuild.ik.result import Status as Status
    from chainbuild.ik.search.table import IkTable as IkTable
    from chainbuild.ik.search.table import StatusChange as StatusChange
    from chainbuild.ik.warm import warm_up as warm_up
    from chainbuild.inspect.export import export_page as export_page
    from chainbuild.inspect.notebook import RobotView as RobotView
    from chainbuild.inspect.notebook import show as show
    from chainbuild.inspect.playback import Playback as Playback
    from chainbuild.inspect.playback import axes_playback as axes_playback
    from chainbuild.inspect.playback import pose_playback as pose_playback
    from chainbuild.inspect.playback import recording_playback as recording_playback
    from chainbuild.inspect.playnotes import PlaybackNote as PlaybackNote
    from chainbuild.kinematics.limits import Limits as Limits
    from chainbuild.kinematics.mechanism import Mechanism as Mechanism
    from chainbuild.kinematics.model_urdf import model_to_urdf as model_to_urdf
    from chainbuild.machines import shipped as shipped
    from chainbuild.painting.overlay.measures import Dimension as Dimension
    from chainbuild.painting.overlay.measures import dimensions as dimensions
    from chainbuild.painting.picture import picture as picture
    from chainbuild.progress import Progress as Progress
    from chainbuild.robot import Robot as Robot
    from chainbuild.tables.recording import Recording as Recording
    from chainbuild.tables.recording import read_recording as read_recording
    from chainbuild.units import AxisKind as AxisKind
    from chainbuild.units import AxisLabels as AxisLabels
    from chainbuild.units import AxisUnit as AxisUnit
    from chainbuild.units import Units as Units
    from chainbuild.writers.machine_report.report import write_report as write_report
    from chainbuild.writers.models.export import export as export
    from chainbuild.writers.models.mjcf import write_mjcf as write_mjcf
    from chainbuild.writers.models.srdf import write_srdf as write_srdf
    from chainbuild.writers.models.urdf import write_urdf as write_urdf

__version__ = "0.1.0"

# Module → the public names that live there, imported at first use, so that `import chainbuild` and `chainbuild --help`
# stay quick.
_HOMES = {
    "chainbuild.analysis.collision.free_ik": "collision_free_ik",
    "chainbuild.analysis.collision.parallelogram": "LimitReport swept_limits",
    "chainbuild.analysis.collision.paths": "Contact contacts",
    "chainbuild.analysis.collision.sweep": "FreeInterval",
    "chainbuild.analysis.singularity.measures": "MeasureTable Measures measure_batch",
    "chainbuild.analysis.path.along": "PathOptions path_report",
    "chainbuild.analysis.path.places": "PathMinimum PathPlace PathReport PathSpeed PathStretch PathViolation",
    "chainbuild.analysis.singularity.names": "SingularityReport examine",
    "chainbuild.analysis.singularity.nearest": "Nearest nearest_singularity",
    "chainbuild.analysis.singularity.singularity": "Singularity",
    "chainbuild.analysis.singularity.speeds": "AxisSpeed SpeedReport",
    "chainbuild.analysis.verdicts.blockverdicts": "BlockVerdict SingularityVerdicts VerdictPart",
    "chainbuild.analysis.verdicts.judging": "singularity_verdicts",
    "chainbuild.analysis.workspace.maps": "Map make_map",
    "chainbuild.analysis.workspace.mapspec": "Grid MapKind MapSpec",
    "chainbuild.chain.axismap": "AffineMap AxisMap",
    "chainbuild.chain.compose": "follow stack",
    "chainbuild.chain.programmed.display": "Display DisplayKind",
    "chainbuild.chain.elements": (
        "Axis Chain ControllerSolver Frame Joint JointKind Link Loop Partial SingularityWatch Task"
    ),
    "chainbuild.chain.bodies.geometry": "Geometry RodData Shape Stand",
    "chainbuild.chain.bodies.inertia": "Inertia JointDynamics",
    "chainbuild.chain.drives": "AffineDrives DriveLimit DriveMap",
    "chainbuild.chain.sums": "AxisConstraint AxisSum",
    "chainbuild.chain.programmed.named": "NamedPose",
    "chainbuild.chain.programmed.vectors": "AngleLetter OriMode ToolPlane VectorProgramming",
    "chainbuild.collision.model": "CollisionModel Distance",
    "chainbuild.comparison.comparison": "Forward Inverse",
    "chainbuild.comparison.convention_trials": "Selection Trial",
    "chainbuild.comparison.data_trials": "DataTrial",
    "chainbuild.comparison.crosscheck": "CheckOptions CrossCheck crosscheck",
    "chainbuild.comparison.diagnosis": "Explanation",
    "chainbuild.comparison.samples": "Samples",
    "chainbuild.convention": "Convention UsedConvention conventions",
    "chainbuild.coupling.distribution": "Distribution PartialPose",
    "chainbuild.errors": (
        "AxisValueError ChainError ChainbuildError ConventionError FileAccessError FileContentError MachineDataError"
        " OverlayError OverwriteError ParseError Span TableError UnsupportedKinematicError"
    ),
    "chainbuild.findings": "Finding Findings Severity",
    "chainbuild.formats.load": "check from_urdf load",
    "chainbuild.formats.machine": "Machine",
    "chainbuild.formats.entries": "Datum KinematicEntry ParameterRow",
    "chainbuild.formats.twincat.lists.hdtable": "AxisRow HdRow TypeData",
    "chainbuild.formats.twincat.types.catalogue": "KinType catalogue",
    "chainbuild.formats.twincat.universal.as_universal": "as_universal",
    "chainbuild.ik.branches.core.branches": "Branch Branches",
    "chainbuild.ik.branches.many": "ik_all_batch",
    "chainbuild.ik.request": "IkOptions",
    "chainbuild.ik.branches.status_turn": "status_turn status_turn_rows",
    "chainbuild.ik.plan": "SolverPlan",
    "chainbuild.ik.policies.redundancy": "Preference",
    "chainbuild.ik.policies.status_path": "status_changes",
    "chainbuild.ik.result": "IkResult Status",
    "chainbuild.ik.search.table": "IkTable StatusChange",
    "chainbuild.ik.warm": "warm_up",
    "chainbuild.inspect.export": "export_page",
    "chainbuild.inspect.notebook": "RobotView show",
    "chainbuild.inspect.playback": "Playback axes_playback pose_playback recording_playback",
    "chainbuild.inspect.playnotes": "PlaybackNote",
    "chainbuild.kinematics.limits": "Limits",
    "chainbuild.kinematics.mechanism": "Mechanism",
    "chainbuild.kinematics.model_urdf": "model_to_urdf",
    "chainbuild.machines": "shipped",
    "chainbuild.painting.overlay.measures": "Dimension dimensions",
    "chainbuild.painting.picture": "picture",
    "chainbuild.progress": "Progress",
    "chainbuild.robot": "Robot",
    "chainbuild.tables.recording": "Recording read_recording",
    "chainbuild.units": "AxisKind AxisLabels AxisUnit Units",
    "chainbuild.writers.machine_report.report": "write_report",
    "chainbuild.writers.models.export": "export",
    "chainbuild.writers.models.mjcf": "write_mjcf",
    "chainbuild.writers.models.srdf": "write_srdf",
    "chainbuild.writers.models.urdf": "write_urdf",
}
_LAZY = {name: module for module, names in _HOMES.items() for name in names.split()}

__all__ = ["__version__", *_LAZY]  # noqa: PLE0604


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        raise AttributeError(f"module 'chainbuild' has no attribute '{name}'")
    from importlib import import_module

    module = import_module(_LAZY[name])
    value = globals()[name] = getattr(module, name)
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
