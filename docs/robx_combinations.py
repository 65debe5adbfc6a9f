"""The table of ROBX combinations: machine data of each are written, loaded and judged by what the loader says."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

import chainbuild
from chainbuild.formats.sinumerik.reading.robx import MAIN_AXES
from chainbuild.ik.plan import plan_of

WRISTS = (1, 2, 3, 4, 5, 6)
KINDS = {"SS": (1, 1, 1), "CC": (1, 3, 3), "NR": (3, 3, 3), "SC": (1, 1, 3), "RR": (3, 3, 1), "CS": (3, 1, 1)}
# TX3P3_RPY that puts axis 4 along X, Y or Z of P3, and the direction of the last rotary basic axis.
ALONG = {"x": (0, 90, 0), "y": (0, 0, -90), "z": (0, 0, 0)}
LAST_ROTARY = {"CC": "y", "NR": "y", "SC": "y", "RR": "y", "CS": "z", "NN": "z"}


def rows() -> Iterator[tuple[str, str, str, str, str]]:
    """Yield arrangement, place of axis 4, and what becomes of 4, 5 and 6 axes with each wrist."""
    for number, letters in MAIN_AXES.items():
        for parallel in (True, False) if letters in LAST_ROTARY else (False,):
            place = "–" if letters not in LAST_ROTARY else "parallel (A4PAR 1)" if parallel else "across (A4PAR 0)"
            cells = [cell(number, letters, parallel, count) for count in (4, 5, 6)]
            yield f"{number} {letters}", place, *cells


def method_rows() -> Iterator[tuple[str, str, str, str, str]]:
    """Yield arrangement, place of axis 4, and the solvers of 4, 5 and 6 axes with each wrist that is built."""
    for number, letters in MAIN_AXES.items():
        for parallel in (True, False) if letters in LAST_ROTARY else (False,):
            place = "–" if letters not in LAST_ROTARY else "parallel (A4PAR 1)" if parallel else "across (A4PAR 0)"
            cells = []
            for count in (4, 5, 6):
                found = {wrist: method(machine_data(number, letters, parallel, count, wrist)) for wrist in WRISTS}
                cells.append(together({wrist: name for wrist, name in found.items() if name is not None}))
            yield f"{number} {letters}", place, *cells


def method(data: str) -> str | None:
    """Return how all branches of machine data are found, or None where they are refused."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "machine.tea"
        path.write_text(data, "utf-8")
        if any(finding.severity == "error" for finding in chainbuild.check(path)):
            return None
        return plan_of(chainbuild.Robot.load(path)).name


def cell(number: int, letters: str, parallel: bool, count: int) -> str:
    """Return the outcomes of all wrists, those that are alike together."""
    return together({wrist: outcome(machine_data(number, letters, parallel, count, wrist)) for wrist in WRISTS})


def together(outcomes: dict[int, str]) -> str:
    """Return outcomes by wrist as text, those that are alike together."""
    order = list(dict.fromkeys(outcomes.values()))
    ranked = sorted(outcomes.items(), key=lambda item: order.index(item[1]))
    parts = []
    for result, group in groupby(ranked, key=lambda item: item[1]):
        parts.append(f"{', '.join(str(wrist) for wrist, _ in group)}: {result}")
    return "; ".join(parts)


def outcome(data: str) -> str:
    """Return what loading machine data says: legal, built with findings, or refused."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "machine.tea"
        path.write_text(data, "utf-8")
        findings = chainbuild.check(path)
        errors = [finding for finding in findings if finding.severity == "error"]
        if not errors:
            chainbuild.load(path).chain()
    if errors:
        alarm = f", alarm {errors[0].alarm}" if errors[0].alarm else ""
        return f"refused ({errors[0].code}{alarm})"
    warned = sorted({finding.code for finding in findings if finding.severity == "warning"})
    return f"built ({', '.join(warned)})" if warned else "legal"


def machine_data(number: int, letters: str, parallel: bool, count: int, wrist: int) -> str:
    """Return machine data that keep to the manual wherever it leaves a choice."""
    last = LAST_ROTARY.get(letters, "x")
    across = "y" if letters == "CS" else "x"
    data: dict[str, int | tuple[float, ...]] = {
        "AXES_TYPE": (*KINDS.get(letters, (3, 3, 3)), *(3,) * (count - 3)),
        "MAIN_AXES": number,
        "WRIST_AXES": wrist,
        "NUM_AXES": count,
        "A4PAR": int(parallel),
        "MAIN_LENGTH_AB": (200, 500),
        "TX3P3_POS": (400, 0, 0),
        "TX3P3_RPY": ALONG[last if parallel else across],
        "TFLWP_POS": (0, 0, 80),
        "TFLWP_RPY": (0, 0, 0),
        **_wrist(letters, wrist),
    }
    lines = ["CHANDATA(1)", "$MC_TRAFO_TYPE_1=4100"]
    lines += [f"$MC_TRAFO_AXES_IN_1[{n}]={n + 1}" for n in range(count)]
    for name, value in data.items():
        if isinstance(value, tuple):
            lines += [f"$MC_ROBX_{name}[{n}]={element}" for n, element in enumerate(value)]
        else:
            lines.append(f"$MC_ROBX_{name}={value}")
    return "\n".join([*lines, "M17", ""])


def _wrist(letters: str, wrist: int) -> dict[str, tuple[float, ...]]:
    """Return Denavit-Hartenberg data of a wrist, as the manual's chapter 7 wants them where it says so."""
    if wrist == 3:
        return {"DHPAR4_5ALPHA": (70, -35)}
    if wrist == 5:
        return {"DHPAR4_5ALPHA": (-90, 90), "DHPAR4_5A": (30, 70)}
    if wrist == 6:
        offset = {"DHPAR4_5A": (30.0, 70.0)} if letters == "SC" else {"DHPAR4_5D": (0.0, 70.0)}
        return {"DHPAR4_5ALPHA": (-90, 90), **offset}
    return {"DHPAR4_5ALPHA": (-90, 90)}
