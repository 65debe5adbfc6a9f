"""A universal kinematic of one axis, alone or as partial of a coupling: every command takes it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import chainbuild
from tests.kit.command_line import Run, rows_of
from tests.kit.couplings import AT_TABLE
from tests.kit.twincat_files import chain_of, codes, machine
from tests.kit.universal import AxisOf91, Universal, robot_lines

ROTARY = Universal([AxisOf91(2, (0, 0, 1))], [0], zero_position=(100, 0, 0))
LINEAR = Universal([AxisOf91(1, (0, 0, 1))], [0], zero_position=(100, 0, 0))
ONE = {"rotary": (ROTARY, "C", (86.60254037844387, 50.0, 0.0)), "linear": (LINEAR, "Z", (100.0, 0.0, 30.0))}
COMMANDS = (
    "info m.lis", "info m.lis --json", "check m.lis", "fk m.lis --at 30",
    "crosscheck m.lis --recording poses.csv", "ik m.lis --poses poses.csv",
    "singularity m.lis --at 30", "collide m.lis --at 30", "workspace m.lis", "urdf m.lis -o out",
    "inspect m.lis --export page.html", "picture m.lis -o m.svg --frames --dimensions",
)  # fmt: skip


@pytest.mark.parametrize("kind", ONE)
@pytest.mark.parametrize("command", COMMANDS)
def test_every_command(run: Run, kind: str, command: str) -> None:
    universal, name, tip = ONE[kind]
    Path("m.lis").write_text("\n".join(universal.lines()), "utf-8")
    x, y, z = tip
    Path("poses.csv").write_text(f"{name},x_mm,y_mm,z_mm,tool_x,tool_y,tool_z\n30,{x},{y},{z},0,0,1\n", "utf-8")
    if command.startswith("ik"):
        Path("poses.csv").write_text(f"x_mm,y_mm,z_mm,tool_x,tool_y,tool_z\n{x},{y},{z},0,0,1\n", "utf-8")
    outcome = run(*command.split())
    assert outcome.code == 0, outcome.err
    if command.startswith("fk"):
        (row,) = rows_of(outcome.out)
        assert [float(row[f"{letter}_mm"]) for letter in "xyz"] == pytest.approx(tip, abs=1e-9)
    if command == "ik m.lis --poses poses.csv":
        assert float(rows_of(outcome.out)[0][name]) == pytest.approx(30.0, abs=1e-6)


@pytest.mark.parametrize("kind", ONE)
@pytest.mark.parametrize("command", ["limits m.lis", "couple m.lis --tcp X=7000", "as-universal m.lis"])
def test_what_it_is_not_is_refused_in_words(run: Run, kind: str, command: str) -> None:
    Path("m.lis").write_text("\n".join(ONE[kind][0].lines()), "utf-8")
    outcome = run(*command.split())
    assert outcome.code in (1, 3)
    assert "Traceback" not in outcome.err
    assert "chainbuild: " in outcome.err


@pytest.mark.parametrize("kind", ONE)
def test_jacobian_and_chain(kind: str) -> None:
    universal, name, tip = ONE[kind]
    chain = chain_of(universal.lines())
    robot = chainbuild.Robot(chain)
    assert [axis.name for axis in chain.axes] == [name]
    assert robot.jacobian([30.0]).shape == (6, 1)
    assert robot.fk([30.0]).translation * 1000 == pytest.approx(tip)
    assert robot.ik_all(robot.fk([30.0])).axes[0] == pytest.approx([30.0])
    assert np.asarray(robot.ik_batch([robot.fk([30.0])]).axes) == pytest.approx(np.array([[30.0]]))


def test_few_axes_alone_leave_a_warning() -> None:
    assert codes(chain_of(ROTARY.lines())) == ["CB466"]
    text = chain_of(ROTARY.lines()).findings[0].text
    assert text == "a universal kinematic of one axis is described as a partial of a coupling only"
    coupled = [
        *robot_lines(0), *LINEAR.lines(1, name="LIFT"), "trafo[2].id 210", "trafo[2].group[0].name G",
        "trafo[2].group[0].chain[0] LIFT", "trafo[2].group[0].chain[1] ROBOT",
    ]  # fmt: skip
    assert codes(chain_of(coupled)) == []
    assert codes(machine("\n".join(coupled)).chain("LIFT")) == []
    assert len(chain_of(AT_TABLE).axes) == 10
