"""What objects show of themselves: two lines of text, tables in notebooks with everything escaped."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import chainbuild
from chainbuild import Finding, Findings, MapSpec, Robot, Span
from chainbuild.chain.sums import AxisSum
from chainbuild.html import html_table, html_text
from chainbuild.shown import fields_shown, two_lines
from tests.kit.annotations import public_things

AXES = [10.0, -80.0, 70.0, 20.0, 40.0, 30.0]
AT_WRIST = [0.0, -90.0, 90.0, 0.0, 0.3, 0.0]


@cache
def robot(name: str = "kr6r900") -> Robot:
    return Robot.load(name)


def pose(axes: list[float] = AXES) -> Any:
    return robot().fk(axes)


def far() -> Any:
    T = pose().homogeneous.copy()
    T[0, 3] = 9.0
    return T


@cache
def distribution() -> chainbuild.Distribution:
    composed = robot("gantry_robot_kin210")
    return composed.distribute()


@cache
def check() -> chainbuild.CrossCheck:
    return chainbuild.crosscheck(robot(), robot().fk, options=chainbuild.CheckOptions(count=12))


@cache
def datum() -> chainbuild.Datum:
    return chainbuild.load("ca_head_kin9").geometry()[4]


@cache
def wrong_check() -> chainbuild.CrossCheck:
    def shifted(axes: Any) -> Any:
        T = robot().fk(axes).homogeneous.copy()
        T[:3, 3] += 0.01
        return T

    return chainbuild.crosscheck(robot(), shifted, options=chainbuild.CheckOptions(count=40))


@cache
def limit_report() -> chainbuild.LimitReport:
    return chainbuild.swept_limits(robot("parallelogram_nr"), steps=3)


@cache
def kin45() -> chainbuild.KinType:
    return chainbuild.catalogue()[45]


@cache
def report() -> chainbuild.SingularityReport:
    return chainbuild.examine(robot(), AT_WRIST)


@cache
def path() -> chainbuild.PathReport:
    rows = [[*AXES[:4], -8.0, 0.0], [*AXES[:4], 8.0, 400.0]]
    return chainbuild.path_report(robot(), rows, options=chainbuild.PathOptions(feed_mm_min=6000.0))


@cache
def verdicts() -> chainbuild.SingularityVerdicts:
    return chainbuild.singularity_verdicts(robot(), [[*AXES[:4], -8.0, 0.0], [*AXES[:4], 8.0, 400.0]])


@cache
def workspace() -> chainbuild.Map:
    return chainbuild.make_map(robot(), MapSpec(cells=5, samples=50), workers=1)


@cache
def playback() -> chainbuild.Playback:
    return chainbuild.pose_playback(robot(), "folder/poses.csv", [robot().ik(far())])


LONG = "a text that goes on and on, " * 30
FINDING = Finding("CB501", "warning", LONG, Span("robot.lis", 12, 1, LONG), "do something about it")

OBJECTS: dict[str, Callable[[], Any]] = {
    "AffineDrives": lambda: robot("geared_head_kin28").chain.drives,
    "AffineMap": lambda: robot().chain.axis_map,
    "Axis": lambda: robot().axes[0],
    "AxisConstraint": lambda: robot("parallelogram_nr").chain.constraints[0],
    "AxisLabels": lambda: robot("gantry_robot_kin210").labels,
    "AxisRow": lambda: kin45().axes[0],
    "AxisSpeed": lambda: report().speed.axes[0],
    "AxisSum": lambda: AxisSum((1.0,) * 12, -1.2e-15),
    "Branch": lambda: robot("tx2_60").ik_all(robot("tx2_60").fk(AXES))[0],
    "Branches": lambda: robot("tx2_60").ik_all(robot("tx2_60").fk(AXES)),
    "Chain": lambda: robot().chain,
    "ChainbuildError": lambda: chainbuild.ChainbuildError("what", parameter="which"),
    "CheckOptions": chainbuild.CheckOptions,
    "CollisionModel": lambda: chainbuild.CollisionModel(robot()),
    "Contact": lambda: chainbuild.Contact(3, 0.125, np.array(AXES), ("A3_link", "base_link"), 0.00123456),
    "ControllerSolver": lambda: robot().chain.controller_solver,
    "Convention": lambda: next(iter(chainbuild.conventions().values())),
    "CrossCheck": wrong_check,
    "Dimension": lambda: chainbuild.dimensions(chainbuild.load("ca_head_kin9"))[0],
    "Display": lambda: robot().chain.display,
    "DriveLimit": lambda: chainbuild.DriveLimit(4, -100.0, 100.0),
    "Distance": lambda: chainbuild.CollisionModel(robot()).nearest(AXES),
    "Distribution": distribution,
    "Explanation": lambda: wrong_check().explanation,
    "Finding": lambda: FINDING,
    "Findings": lambda: Findings([FINDING] * 3),
    "Forward": lambda: check().forward,
    "Frame": lambda: robot().chain.frame("tool"),
    "FreeInterval": lambda: limit_report().intervals[0],
    "Geometry": lambda: robot("parallelogram_nr").chain.geometry,
    "Grid": lambda: workspace().grid,
    "HdRow": lambda: kin45().hd[0],
    "IkOptions": lambda: chainbuild.IkOptions(weights=(1.0, 2.0, 3.0, 1.0, 1.0, 1.0)),
    "IkResult": lambda: robot().ik(far()),
    "IkTable": lambda: robot().ik_batch([pose(), far()]),
    "Inverse": lambda: chainbuild.Inverse.__new__(chainbuild.Inverse),
    "Joint": lambda: robot().chain.joints[0],
    "KinType": kin45,
    "KinematicEntry": lambda: chainbuild.load("kr6r900").kinematics()[0],
    "LimitReport": limit_report,
    "Limits": lambda: robot("gantry_robot_kin210").limits,
    "Link": lambda: robot().chain.links[0],
    "Loop": lambda: chainbuild.Loop("rod", "ball", "a", "b"),
    "Machine": lambda: chainbuild.load("kr6r900"),
    "Map": workspace,
    "MapSpec": lambda: MapSpec("axes", ("A3", "A5"), tuple(AXES)),
    "MeasureTable": lambda: chainbuild.measure_batch(robot(), [AXES, AT_WRIST]),
    "Measures": lambda: report().measures,
    "Mechanism": lambda: chainbuild.Mechanism(robot().chain),
    "NamedPose": lambda: chainbuild.NamedPose("park", (0.123456789012345,) * 6),
    "Nearest": lambda: chainbuild.nearest_singularity(robot(), AXES),
    "ParameterRow": lambda: chainbuild.load("kr6r900").parameters()[0],
    "Partial": lambda: robot("gantry_robot_kin210").chain.partials[0],
    "BlockVerdict": lambda: verdicts().blocks[0],
    "SingularityVerdicts": verdicts,
    "VerdictPart": lambda: verdicts().blocks[0].parts[0],
    "PathMinimum": lambda: path().stretches[0].minima[0],
    "PathOptions": lambda: chainbuild.PathOptions(feed_mm_min=6000.0),
    "PathPlace": lambda: path().stretches[0].begin,
    "PathReport": path,
    "PathSpeed": lambda: path().speeds[0],
    "PathStretch": lambda: path().stretches[0],
    "PathViolation": lambda: path().violations[0],
    "Playback": playback,
    "PlaybackNote": lambda: playback().notes[0],
    "PartialPose": lambda: distribution().partials[0],
    "Recording": lambda: chainbuild.Recording(np.zeros((90, 6)), np.zeros((90, 4, 4))),
    "SingularityReport": report,
    "Robot": lambda: robot("gantry_robot_kin210"),
    "RobotView": lambda: chainbuild.show(robot("gantry_robot_kin210"), at=[0.1] * 9),
    "JointDynamics": lambda: chainbuild.JointDynamics(effort=100.0, damping=0.5),
    "Inertia": lambda: chainbuild.Inertia(2.0, np.zeros(3), np.eye(3)),
    "Stand": lambda: robot("ca_head_kin9").chain.geometry.stand,
    "RodData": lambda: robot("parallelogram_nr").chain.geometry.rod_data,
    "Samples": lambda: check().forward.samples,
    "Selection": lambda: chainbuild.Selection(2, 1, 120.0),
    "Shape": lambda: chainbuild.Shape("box", size=(0.1, 0.2, 0.3), place=(0.1,) * 6),
    "Singularity": lambda: report().names[0],
    "SingularityWatch": lambda: robot().chain.singularity_watch,
    "SolverPlan": lambda: robot().plan(["A4"]),
    "Span": lambda: Span("robot.lis", 12, 1, LONG),
    "SpeedReport": lambda: report().speed,
    "VectorProgramming": lambda: chainbuild.VectorProgramming("vector_ijk", fixed="C"),
    "StatusChange": lambda: chainbuild.StatusChange(16, 2, 6, True),
    "DataTrial": lambda: chainbuild.DataTrial({datum(): 40.0}, 1e-7, 0.0, True),
    "Datum": datum,
    "Trial": lambda: chainbuild.Trial({"kin45_length_frame": "tool"}, 1.0, 2.0, False),
    "TypeData": lambda: kin45().data,
    "UsedConvention": lambda: robot("ac_table_kin58").chain.conventions[0],
}  # fmt: skip


def test_every_public_class_is_looked_at() -> None:
    classes = {name for name, thing in public_things() if isinstance(thing, type)}
    left_out = {name for name in classes if name.endswith("Error")} | {"AxisMap", "DriveMap"}
    assert classes - left_out <= set(OBJECTS)


@pytest.mark.parametrize("name", sorted(set(OBJECTS) - {"Inverse"}))
def test_objects_show_themselves_on_two_lines(name: str) -> None:
    thing = OBJECTS[name]()
    if thing is None:
        pytest.fail(f"no example of {name}")
    assert any(cls.__name__ == name for cls in type(thing).__mro__)
    lines = repr(thing).splitlines()
    assert 1 <= len(lines) <= 2
    assert max(map(len, lines)) <= 120, repr(thing)
    assert " object at 0x" not in repr(thing)


def test_results_say_units_and_what_is_missing() -> None:
    met = robot().ik(pose(), AXES)
    assert repr(met).startswith("<IkResult ok: A1 10, A2 -80, A3 70, A4 20, A5 40, A6 30 [deg]; off by ")
    assert "[rad]" in repr(met.to("si"))
    assert "unreachable" in repr(robot().ik(far()))
    branch = robot("tx2_60").ik_all(robot("tx2_60").fk(AXES))[0]
    assert repr(branch).startswith("<Branch ok: ")
    assert "status " in repr(branch)
    assert "by spherical wrist" in " ".join(repr(branch).split())
    assert repr(robot().plan()).startswith("<SolverPlan spherical wrist (every branch): ")
    assert repr(robot().axes[0]) == "<Axis A1: rotary, -170 … 170 deg>"


def test_an_inverse_comparison_is_shown() -> None:
    def answers(T: Any) -> Any:
        return [branch.axes for branch in robot().ik_all(T)]

    found = chainbuild.crosscheck(robot(), answers, options=chainbuild.CheckOptions(count=9, kind="ik"))
    assert len(repr(found.inverse)) < 240
    assert "answers wrong" in repr(found)


def test_text_that_is_too_long_is_cut_at_the_second_line() -> None:
    shown = two_lines(f"<{LONG}>")
    assert [len(line) <= 120 for line in shown.splitlines()] == [True, True]
    assert shown.endswith(" …>")


@dataclass(frozen=True, slots=True)
class Example:
    name: str
    size: float = 1.0
    rows: Any = None
    more: tuple[float, ...] = ()

    __repr__ = fields_shown


def test_fields_at_their_defaults_are_left_out() -> None:
    assert repr(Example("a")) == "Example(name='a')"
    assert repr(Example("a", -1e-15, np.array([1.0, 1e-14]))) == "Example(name='a', size=0, rows=[1, 0])"
    assert repr(Example("a", rows=np.zeros((90, 6)))) == "Example(name='a', rows=array(90, 6))"
    shown = repr(Example("a", more=tuple(map(float, range(20)))))
    assert shown == "Example(name='a', more=(0, 1, 2, 3, 4, 5, 6, 7, … 20 in all))"


def test_findings_are_a_tuple() -> None:
    findings = chainbuild.load("kr6r900").findings
    assert isinstance(findings, Findings)
    assert findings == tuple(findings)
    two = Findings([FINDING, replace(FINDING, code="CB001", severity="error")])
    assert repr(two) == "<Findings: 1 error, 1 warning (CB501, CB001)>"
    assert repr(Findings()) == "<Findings: none>"
    assert isinstance(chainbuild.check("kr6r900"), Findings)
    assert isinstance(chainbuild.load("kr6r900").chain().findings, Findings)


HTML = ("Robot", "Mechanism", "Machine", "IkResult", "Branch", "IkTable", "Branches", "Distribution", "Findings")


@pytest.mark.parametrize("name", HTML)
def test_tables_in_notebooks(name: str) -> None:
    html = OBJECTS[name]()._repr_html_()
    assert html.count("<table>") == html.count("</table>") >= 1
    assert "style" not in html
    assert "<script" not in html


def test_what_comes_from_a_file_is_escaped(tmp_path: Path) -> None:
    evil = '<img src=x onerror=alert(1)>&"'
    escaped = "&lt;img src=x onerror=alert(1)&gt;&amp;&quot;"
    assert evil not in html_table([evil], [[evil]], evil) + html_text(evil)
    assert html_table([evil], [[evil]], evil).count(escaped) == 3
    findings = Findings([replace(FINDING, text=evil, hint=evil, span=Span(evil, 1))])
    assert "<img" not in findings._repr_html_()
    chain = robot().chain
    axes = (replace(chain.axes[0], name="<b>"), *chain.axes[1:])
    named = chainbuild.Mechanism(replace(chain, axes=axes, title=evil))
    assert "<b>" not in named._repr_html_()
    assert "<img" not in named._repr_html_()
    path = tmp_path / "one.lis"
    path.write_text(f"trafo[0].id 9\ntrafo[0].name {evil}\n", "utf-8")
    assert "<img" not in chainbuild.load(path)._repr_html_()
    labels = replace(robot().labels, names=(evil, *robot().labels.names[1:]))
    assert "<img" not in replace(robot().ik(far()), labels=labels, reason=evil)._repr_html_()


def test_long_tables_show_their_first_rows() -> None:
    table = robot().ik_batch([pose()] * 25)
    html = table._repr_html_()
    assert html.count("<tr>") == 12
    assert "… 15 more" in html
    assert "25 rows: 25 ok" in html
    assert "no findings" in Findings()._repr_html_()
