"""ori.mode, ori.fixed_axis_index, ori.tool_ax_in_plane: from the list to the chain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.compose import stack
from chainbuild.chain.elements import Chain
from chainbuild.chain.programmed.vectors import VectorProgramming, rotation_from_vector
from chainbuild.errors import ChainbuildError
from chainbuild.findings import Collector, Finding
from chainbuild.formats.text import is_twincat
from chainbuild.formats.twincat.lists.channel import read_channel
from chainbuild.formats.twincat.lists.config import Orientation
from tests.kit.twincat_files import codes, kin_45, machine, parameters

ARM = {7: 4000000, 8: 4550000, 9: 4000000, 10: 800000}


def orientation(text: str, collector: Collector | None = None) -> Orientation:
    collector = collector or Collector()
    return read_channel(parameters(f"trafo[0].id 45\n{text}", collector), collector).orientation


def arm(text: str, **conventions: str) -> Chain:
    return machine(kin_45(ARM, text)).chain(conventions=conventions)


def only(chain: Chain, code: str) -> Finding:
    (finding,) = (finding for finding in chain.findings if finding.code == code)
    return finding


def test_what_the_list_gives() -> None:
    found = orientation("ori.mode VECTOR_IJK (words\nori.fixed_axis_index 5 # C")
    assert (found.mode, found.fixed, found.plane) == ("vector_ijk", "C", 0)
    assert {name: span.line for name, span in found.spans.items()} == {"mode": 2, "fixed_axis_index": 3}
    assert orientation("ORI.Mode vector_abc\nori.tool_ax_in_plane 2").plane == 2
    assert orientation('ori.mode "ANGLE"').mode == "angle"


def test_nothing_given_is_the_same_as_zero() -> None:
    nothing, zero = orientation(""), orientation("ori.mode ANGLE\nori.fixed_axis_index 0\nori.tool_ax_in_plane 0")
    assert (nothing.mode, nothing.fixed, nothing.plane) == ("angle", None, 0)
    assert (zero.mode, zero.fixed, zero.plane) == ("angle", None, 0)


def test_an_index_and_a_plane_are_both_taken_as_0() -> None:
    chain = arm("ori.mode VECTOR_ABC\nori_rotation_angle 2\nori.fixed_axis_index 5\nori.tool_ax_in_plane 1")
    assert chain.vectors == VectorProgramming("vector_abc")
    finding = only(chain, "CB415")
    assert (finding.severity, finding.alarm) == ("warning", 22027)
    assert str(finding).startswith(
        "machine.lis:9: CB415 warning: ori.fixed_axis_index and ori.tool_ax_in_plane exclude"
    )
    assert finding.hint == "keep this line or line 8, not both"


@pytest.mark.parametrize("text", ["ori.fixed_axis_index 5\nori.tool_ax_in_plane 0", "ori.tool_ax_in_plane 1"])
def test_one_of_them_leaves_no_finding(text: str) -> None:
    assert codes(arm(f"ori_rotation_angle 2\n{text}")) == []


@pytest.mark.parametrize(
    ("line", "code", "text"),
    [
        ("ori.mode VECTOR", "CB204", "ori.mode is 'VECTOR'.*permitted: ANGLE, VECTOR_ABC, VECTOR_IJK"),
        ("ori.mode 1", "CB204", "ori.mode is '1'"),
        ("ori.mode", "CB209", "ori.mode has no value"),
        ("ori.fixed_axis_index 2", "CB204", "ori.fixed_axis_index is 2.*permitted: 0 .none., 3, 4 or 5"),
        ("ori.fixed_axis_index 6", "CB204", "is 6"),
        ("ori.fixed_axis_index -1", "CB204", "is -1"),
        ("ori.fixed_axis_index 3.5", "CB204", "is 3.5"),
        ("ori.fixed_axis_index C", "CB202", "not a number"),
        ("ori.fixed_axis_index nan", "CB202", "not finite"),
        ("ori.tool_ax_in_plane 3", "CB204", "ori.tool_ax_in_plane is 3.*permitted: 0 .none., 1 .ZX. or 2 .YZ."),
        ("ori.tool_ax_in_plane ZX", "CB202", "not a number"),
        ("ori.tool_ax_in_plane inf", "CB202", "not finite"),
    ],
)
def test_bad_values_are_errors_with_their_line(line: str, code: str, text: str) -> None:
    with pytest.raises(ChainbuildError, match=f"machine.lis:2: .*{text}"):
        orientation(line)
    lenient = Collector(strict=False)
    assert orientation(line, lenient) == Orientation(spans=orientation(line, Collector(strict=False)).spans)
    assert codes(lenient) == [code]


@pytest.mark.parametrize(
    ("line", "near"),
    [
        ("ori.fixed_ax_index 5", "fixed_axis_index"),
        ("ori.fixed_ax_idx 5", "fixed_axis_index"),
        ("ori.tool_axis_in_plane 1", "tool_ax_in_plane"),
        ("ori.modes VECTOR_ABC", "mode"),
        ("ori.mode.x 1", "mode"),
    ],
)
def test_a_misspelt_name_is_a_warning(line: str, near: str) -> None:
    collector = Collector()
    orientation(line, collector)
    (finding,) = collector.findings
    assert (finding.code, finding.hint) == ("CB227", f"did you mean ori.{near}?")


@pytest.mark.parametrize("line", ["ori.other 1", "ori", "ori 5", "orig 5"])
def test_other_names_do_no_harm(line: str) -> None:
    collector = Collector()
    assert orientation(line, collector).mode == "angle"
    assert set(codes(collector)) <= {"CB206"}


def test_a_text_is_no_parameter_list_for_a_line_that_begins_with_ori() -> None:
    assert not is_twincat("ori angle of the part\n")
    assert is_twincat("ori.mode ANGLE\ntrafo[0].id 45\n")


# ---------------------------------------------------------------- the chain


@pytest.mark.parametrize(
    ("mode", "index", "fits"),
    [(0, 3, True), (0, 5, False), (1, 5, True), (2, 5, True), (2, 3, False), (3, 5, True), (4, 3, True), (5, 3, True)],
)
def test_an_index_that_cannot_work_is_told_and_refused_at_use(mode: int, index: int, fits: bool) -> None:
    chain = arm(f"ori_rotation_angle {mode}\nori.mode VECTOR_IJK\nori.fixed_axis_index {index}")
    assert chain.vectors is not None
    if fits:
        assert codes(chain) == []
        R = rotation_from_vector(chain.vectors, chain.angle_mode, (1.0, 2.0, 3.0), np.eye(3))
        np.testing.assert_allclose(R[:, "xyz".index(chain.vectors.axis)], np.array([1, 2, 3]) / np.sqrt(14), atol=1e-15)
        return
    finding = only(chain, "CB414")
    assert finding.span is not None
    assert (finding.severity, finding.span.line, finding.span.text) == ("warning", 8, f"ori.fixed_axis_index {index}")
    assert finding.permitted == {0: "3 (angle A)", 2: "5 (angle C)"}[mode]
    with pytest.raises(ChainbuildError, match=f"FIXED_AX_IDX={index} keeps"):
        rotation_from_vector(chain.vectors, chain.angle_mode, (1.0, 2.0, 3.0), np.eye(3))


def test_euler_angles_go_by_their_convention() -> None:
    text = "ori_rotation_angle 1\nori.fixed_axis_index 3"
    assert codes(arm(text, euler_letters="a_first")) == []
    assert only(arm(text), "CB414").permitted == "5 (angle C)"


def test_the_convention_chooses_the_axis() -> None:
    assert arm("").vectors == VectorProgramming()
    chain = arm("ori.fixed_axis_index 5", ori_vector_axis="z")
    assert chain.vectors == VectorProgramming(fixed="C", axis="z")
    assert codes(chain) == []
    finding = only(arm("ori.tool_ax_in_plane 1", ori_vector_axis="z"), "CB414")
    assert (finding.permitted, finding.span.line if finding.span else None) == ("2", 6)


def test_only_the_six_axis_arm_has_it() -> None:
    text = "ori.mode VECTOR_IJK\nori.fixed_axis_index 4\ntrafo[0].id 9"
    chain = machine(text).chain()
    assert chain.vectors is None
    assert codes(chain) == []


def test_the_topmost_of_a_stack_says_it() -> None:
    lower, upper = machine("trafo[0].id 9").chain(), arm("ori.mode VECTOR_ABC")
    assert stack(lower, np.eye(4), upper).vectors == upper.vectors
    assert stack(upper, np.eye(4), lower).vectors is None


def test_a_program_may_choose_for_itself() -> None:
    """#ORI MODE [VECTOR_IJK TOOL_AX_IN_PLANE=2], whatever the list says."""
    chain = arm("ori.mode VECTOR_ABC")
    assert chain.vectors is not None
    how = replace(chain.vectors, plane=2)
    R = rotation_from_vector(how, chain.angle_mode, (0.0, 0.0, 2.0), chainbuild.Robot(chain).fk([0] * 6).rotation)
    np.testing.assert_allclose(R[:, 0], (0.0, 0.0, 1.0), atol=1e-15)
    assert R[0, 1] == pytest.approx(0.0, abs=1e-15)


def test_the_parameters_show_it() -> None:
    rows = {row.name: row for row in machine(kin_45(ARM, "ori.fixed_axis_index 5")).parameters()}
    fixed, mode = rows["ori.fixed_axis_index"], rows["ori.mode"]
    assert (fixed.value, fixed.given, fixed.source, fixed.span and fixed.span.line) == (5, True, "P-CHAN-00178", 6)
    assert (mode.value, mode.given, mode.span) == ("ANGLE", False, None)
    assert "ori.mode" not in {row.name for row in machine("trafo[0].id 9").parameters()}
