"""The pictures of the pages: every shipped machine, every KIN_TYP, and the one that opens the README.

They are SVG files in docs/pictures/, the same bytes on every computer; a test draws them anew.
"""

from __future__ import annotations

import html
import re
import tempfile
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import chainbuild
from chainbuild.painting.stage import Stage, framed
from chainbuild.painting.views import VIEWS

FOLDER = Path(__file__).parent / "pictures"
README = "readme.svg"
EXAMPLES = tomllib.loads((Path(__file__).parent / "type_examples.toml").read_text("utf-8"))
_COMMON = {"X": [-500, 500], "Y": [-400, 400], "Z": [-400, 0]}  # limits in mm
_README_MACHINE = "kr6r900"
_SMALL = 3.5  # times as large from near: then a picture of all of it does not show how the tool turns
_README_AXES = (0.0, -75.0, 100.0, 0.0, 40.0, 0.0)  # a bent arm: every length is seen
_LEFT = 290  # pixels by which the machine is moved aside, its own margin holds the rest of the machine data
_ARROW = 440  # pixels from the left
_LINE = 32  # pixels of a line


def of_machine(name: str) -> tuple[str, ...]:
    """Return the pictures of a shipped machine, as paths from docs/: all of it, and the head of a machine tool."""
    files = [f"pictures/{name}.svg"]
    if has_detail(name):
        files.append(f"pictures/{name}_detail.svg")
    return tuple(files)


@cache
def has_detail(name: str) -> bool:
    """Return whether a machine is drawn a second time from near: where its head or wrist is small beside the rest."""
    stage = Stage(chainbuild.Robot.load(name))
    whole, near = (framed(bodies, VIEWS["iso"], 960, 720) for bodies in (stage.bodies, stage.tool_end))
    return near.scale > _SMALL * whole.scale


@cache
def _machines_of_types() -> dict[str, str]:
    found: dict[str, str] = {}
    for name in chainbuild.shipped():
        found.setdefault(chainbuild.load(name).chain().kinematic, name)
    return found


def of_type(number: int) -> str | None:
    """Return the picture of a KIN_TYP, as a path from docs/; None: it has no shape of its own (91, 210)."""
    name = _machines_of_types().get(f"KIN_TYP {number}")
    if name is not None:
        return f"pictures/{name}.svg"
    return f"pictures/kin{number}.svg" if str(number) in EXAMPLES else None


def example(number: str) -> chainbuild.Robot:
    """Return a machine of a KIN_TYP of which none is shipped."""
    given = EXAMPLES[number]
    entry = chainbuild.catalogue()[int(number)]
    rows = {f"HD{row.n}": row for row in entry.hd}
    lines = [f"trafo[0].id {number}"]
    for name, value in given["hd"].items():
        counts = value * 10_000 if rows[name].unit else value
        lines.append(f"trafo[0].param[{rows[name].n - 1}] {counts:.0f}")
    limits = {axis.name: _COMMON.get(axis.name, [-100, 100]) for axis in entry.axes} | given.get("limits", {})
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"kin{number}.lis"
        path.write_text("\n".join([*lines, "Ende", ""]), "utf-8")
        overlay = Path(folder) / f"kin{number}.chainbuild.toml"
        overlay.write_text("[limits]\n" + "".join(f"{axis} = {ends}\n" for axis, ends in limits.items()), "utf-8")
        return chainbuild.Robot.load(path, tool_length_mm=given.get("tool", 0.0))


def drawings() -> Iterator[tuple[str, str, str]]:
    """Yield file, machine and view of every picture: of shipped machines by name, of other types by number."""
    for name in chainbuild.shipped():
        yield f"{name}.svg", name, "iso"
        if has_detail(name):
            yield f"{name}_detail.svg", name, "detail"
    for number in EXAMPLES:
        yield f"kin{number}.svg", number, "iso"


def drawn(name: str, view: str) -> str:
    """Return a picture as SVG: of a shipped machine by its name, of another type by its number."""
    robot = example(name) if name in EXAMPLES else chainbuild.Robot.load(name)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.svg"
        chainbuild.picture(robot, path, view=view)
        return path.read_text("utf-8")


def write_all() -> None:
    """Write all pictures, and remove those of machines that are no more."""
    FOLDER.mkdir(exist_ok=True)
    wanted = {file: drawn(name, view) for file, name, view in drawings()} | {README: readme_picture()}
    for path in FOLDER.glob("*.svg"):
        if path.name not in wanted:
            path.unlink()
    for file, text in wanted.items():
        (FOLDER / file).write_text(text, "utf-8")


def readme_picture() -> str:
    """Return machine data on the left and the machine that they describe, with its lengths, on the right."""
    machine = chainbuild.load(_README_MACHINE)
    lengths = chainbuild.dimensions(machine)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.svg"
        chainbuild.picture(chainbuild.Robot(machine.chain()), path, _README_AXES, dimensions=lengths)
        right = path.read_text("utf-8")
    file = machine.path.read_text("utf-8").splitlines()
    lines = [file[number - 1] for number in sorted({length.datum.span.line for length in lengths})]
    lines += [line for line in file if "ROBX_AXES_DIR" in line]
    width, height = (int(number) for number in re.search(r'width="(\d+)" height="(\d+)"', right).groups())
    top = (height - _LINE * len(lines)) // 2
    texts = "".join(
        f'<text x="24" y="{top + _LINE * n}">{html.escape(line.split(maxsplit=1)[1])}</text>\n'
        for n, line in enumerate(lines)
    )
    arrow = f"M{_ARROW} {height // 2}h44m-14 -12l14 12l-14 12"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_LEFT + width} {height}" '
        f'width="{_LEFT + width}" height="{height}">\n'
        f'<rect width="{_LEFT + width}" height="{height}" fill="#f9fafb"/>\n'
        + right.replace("<svg ", f'<svg x="{_LEFT}" ', 1)
        + f'<g font-family="ui-monospace, Consolas, monospace" font-size="19" fill="#1f2937">\n{texts}</g>\n'
        f'<path d="{arrow}" fill="none" stroke="#1f4e9c" stroke-width="3"/>\n</svg>\n'
    )
