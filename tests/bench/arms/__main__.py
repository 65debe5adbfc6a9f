"""Ask every solver for all branches of the six-axis arms of ssik: `python -m tests.bench.arms [--quick]`.

Writes tests/bench/arms.json, and docs/arms.md and a line of README.md from it.
"""

from __future__ import annotations

import argparse
import json
import platform
import runpy
import sys
import time
from collections.abc import Iterator
from datetime import UTC, datetime
from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, Final

from chainbuild.ik.search.compiled import packing
from tests.bench.arms.geometry import CLASSES, Arm, calibrated, prebuilt_arm
from tests.bench.arms.measure import KINDS, Findings, measure
from tests.bench.arms.peers import BUILT, SOLVERS, build, built, peers
from tests.kit.paths import ROOT

OUTPUT: Final = ROOT / "tests/bench/arms.json"
FOLDER: Final = ROOT / ".bench/ssik"  # what ssik has built, kept from run to run
POSES: Final = 40  # of each kind for each arm: some 17,000, with more than 100,000 isolated branches
QUICK: Final = ("irb120", "puma560", "ur5", "z1", "jaco2", "fanuc_crx10ia")  # two of each class
VERSIONS: Final = ("chainbuild", "ssik", "EAIK", "py-opw-kinematics", "numba", "numpy")


def main() -> int:
    """Measure and write."""
    options = parser().parse_args()
    found = [pair for pair in arms() if not options.arm or pair[0].name.split()[0] in options.arm]
    if not found:
        print(f"there is no arm {', '.join(options.arm)}", file=sys.stderr)
        return 2
    if options.build:
        build_missing(arms())
        return 0
    if not packing.available():
        print("numba is not installed: the compiled path is measured as the plain one", file=sys.stderr)
    if options.quick and not options.arm:
        found = [pair for pair in found if pair[0].name.split()[0] in QUICK]
    poses = options.poses or (5 if options.quick else POSES)
    findings, with_ssik, begin = Findings(), [], time.perf_counter()
    for number, (arm, module) in enumerate(found):
        solvers = list(peers(arm, module))
        measure(arm, solvers, poses, findings)
        if module is not None and arm.calibrated:
            with_ssik.append(arm.name)
        took = time.perf_counter() - begin
        print(f"{took:5.0f} s  {arm.name}: {', '.join(peer.name for peer in solvers)}", file=sys.stderr)
        report = summary(findings, len({one.name.split()[0] for one, _ in found[: number + 1]}), poses, with_ssik)
        report["minutes"] = round(took / 60.0, 1)
        options.output.write_text(json.dumps(report, indent=1) + "\n", "utf-8")  # what is known if the run is ended
    print(f"wrote {options.output}")
    if options.output == OUTPUT:
        write_pages()
    return 0


def parser() -> argparse.ArgumentParser:
    """Return the command line."""
    found = argparse.ArgumentParser(prog="python -m tests.bench.arms", description=__doc__)
    found.add_argument("--quick", action="store_true", help="few arms and poses")
    found.add_argument("--arm", action="append", help="only this arm, nominal and calibrated; several times")
    found.add_argument("--poses", type=int, help=f"of each kind for each arm; {POSES}")
    found.add_argument("--build", action="store_true", help="let ssik build what it needs for calibrated arms, and end")
    found.add_argument("-o", "--output", type=Path, default=OUTPUT)
    return found


def arms() -> Iterator[tuple[Arm, Any | None]]:
    """Yield ssik's six-axis arms, nominal and calibrated, with ssik's solver; None where it is not built."""
    import ssik

    for entry in ssik.list_arms():
        if entry.dof != 6:
            continue
        module = import_module(entry.import_path)
        arm = prebuilt_arm(entry.name, entry.kinematic_class, module)
        yield arm, module
        other = calibrated(arm)
        yield other, built(other, FOLDER)


def build_missing(found: Iterator[tuple[Arm, Any | None]]) -> None:
    """Let ssik build its solvers of the calibrated arms in `BUILT`, unless they are there."""
    for arm, module in found:
        if arm.name in BUILT and module is None:
            print(f"ssik builds its solver of {arm.name}: some minutes, once", file=sys.stderr)
            build(arm, FOLDER)


def summary(findings: Findings, number: int, poses: int, with_ssik: list[str]) -> dict[str, Any]:
    """Return what is written: one row for each class and solver, and what chainbuild missed."""
    rows = [
        {"family": family, "calibrated": off, "kind": kind, "solver": solver} | tally.summary()
        for (family, off, kind, solver), tally in sorted(findings.tallies.items(), key=lambda item: _order(*item[0]))
    ]
    return {
        "date": datetime.now(UTC).date().isoformat(),
        "computer": computer(),
        "versions": versions(),
        "arms": number,
        "poses_each": poses,
        "calibrated_by_ssik": with_ssik,
        "touching": findings.touching,
        "alone": findings.alone,
        "rows": rows,
        "misses": findings.misses,
    }


def _order(family: str, off: bool, kind: str, solver: str) -> tuple[bool, int, int, int]:
    return off, CLASSES.index(family), KINDS.index(kind), SOLVERS.index(solver)


def versions() -> dict[str, str]:
    """Return the versions of Python and of what took part."""
    found = {"Python": platform.python_version()}
    for name in VERSIONS:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found


def computer() -> str:
    """Return the name of the processor, as far as the system tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def write_pages() -> None:
    """Make the tables of docs/arms.md and README.md anew."""
    filled = runpy.run_path(str(ROOT / "docs/generate.py"))["filled"]
    for page in ("docs/arms.md", "README.md"):
        path = ROOT / page
        path.write_text(filled(path.read_text("utf-8")), "utf-8")


if __name__ == "__main__":
    sys.exit(main())
