"""Public URDF files with a tool link each, and small ones that are written for a test."""

from __future__ import annotations

import importlib.metadata
import xml.etree.ElementTree as ET
from pathlib import Path

from tests.kit.paths import TESTS

# Files without joints, with limits that leave no value, or with a mimic of a joint that is not there.
REFUSED = {
    "alex_psyonic_hands", "double_pendulum", "double_pendulum_simple", "iris_simple", "quadrotor_base", "ur3",
}  # fmt: skip
# Arms, a gripper that follows, another branch, many moved links beside the way, links of reserved names.
FEW = ("panda", "ur5_robot", "so101", "tiago_pro", "talos_full_v2", "anymal-kinova")


def example_files() -> dict[str, Path]:
    """Return the files of example-robot-data by their place, as far as they are robots with moving joints."""
    found = [file for file in importlib.metadata.files("example-robot-data") or [] if file.suffix == ".urdf"]
    paths = sorted(Path(str(file.locate())).resolve() for file in found)
    return {f"{path.parts[-3]}/{path.stem}": path for path in paths if path.stem not in REFUSED}


def few_files() -> list[Path]:
    """Return some of them that differ, and one from elsewhere."""
    return [*(path for path in example_files().values() if path.stem in FEW), TESTS / "bench/kr6r700.urdf"]


def deepest_link(path: Path) -> str:
    """Return the link with the most moving joints below it, of several the last by name."""
    above = {}
    for joint in ET.parse(path).getroot().iter("joint"):
        parent, child = joint.find("parent"), joint.find("child")
        if parent is not None and child is not None:
            above[child.attrib["link"]] = parent.attrib["link"], joint.get("type") != "fixed"

    def depth(link: str) -> int:
        count = 0
        while link in above:
            link, moves = above[link]
            count += moves
        return count

    return max(above, key=lambda link: (depth(link), link))


def link(name: str, mass: float, centre: str = "0 0 0", moments: str = "0 0 0 0 0 0", rpy: str = "0 0 0") -> str:
    """Return a link with an inertial; moments are ixx ixy ixz iyy iyz izz."""
    names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    given = " ".join(f'{key}="{value}"' for key, value in zip(names, moments.split(), strict=True))
    inside = f'<origin xyz="{centre}" rpy="{rpy}"/><mass value="{mass}"/><inertia {given}/>'
    return f'<link name="{name}"><inertial>{inside}</inertial></link>'


def joint(
    name: str, kind: str, parent: str, child: str, xyz: str = "0 0 0", inside: str = "", rpy: str = "0 0 0"
) -> str:
    """Return a joint; one that moves needs its axis inside."""
    ends = f'<parent link="{parent}"/><child link="{child}"/>'
    return f'<joint name="{name}" type="{kind}">{ends}<origin xyz="{xyz}" rpy="{rpy}"/>{inside}</joint>'


def written(folder: Path, *elements: str, name: str = "robot") -> Path:
    """Write a file, one element a line after the first."""
    path = folder / f"{name}.urdf"
    path.write_text("\n".join((f'<robot name="{name}">', *elements, "</robot>")))
    return path
