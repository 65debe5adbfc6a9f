"""TwinCAT machines and parameter lists from strings, and poses of their chains."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from chainbuild.chain.elements import Chain
from chainbuild.findings import Collector
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.text import SourceText
from chainbuild.formats.twincat.files import read_machine
from chainbuild.formats.twincat.lists.reader import Line, ParameterList, read_list
from chainbuild.formats.twincat.machine import TwinCatMachine
from chainbuild.robot import Robot

FILE = "machine.lis"


def machine(text: str, *, overlay: Overlay | None = None, strict: bool = True) -> TwinCatMachine:
    """Read a machine from a string."""
    source = SourceText(FILE, text, "utf-8")
    return read_machine(source, Path(FILE), overlay or Overlay(), Collector(strict=strict))


def parameters(text: str, collector: Collector | None = None) -> ParameterList:
    """Read a parameter list from a string."""
    lines = [Line(number, line) for number, line in enumerate(text.split("\n"), start=1)]
    return read_list(lines, FILE, collector or Collector())


def chain_of(lines: Sequence[str], **options: object) -> Chain:
    """Return the chain of a list; options as for `Machine.chain`."""
    return machine("\n".join(lines)).chain(**options)  # type: ignore[arg-type]


def codes(of: TwinCatMachine | Chain | Collector) -> list[str]:
    """Return the numbers of the findings."""
    return [finding.code for finding in of.findings]


def pose(chain: Chain, axes: Sequence[float]) -> np.ndarray:
    """Return tool in workpiece (4, 4), in mm."""
    placement = Robot(chain).fk(np.asarray(axes, dtype=float))
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = placement.rotation, placement.translation * 1000.0
    return T


def kin_45(hd: dict[int, float], extra: str = "") -> str:
    """Return a list with one kinematic 45: HD number → count."""
    lines = ["trafo[0].id 45", *(f"trafo[0].param[{n - 1}] {value:.10g}" for n, value in hd.items()), extra]
    return "\n".join(lines)
