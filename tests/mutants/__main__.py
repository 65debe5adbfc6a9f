"""Run the mutants: `python -m tests.mutants [--minutes N] [part of a path …]`.

Each mutant lives in a forked process in which one module of the translators is replaced; the tests that concern it
run until the first failure. A mutant that no test fails survives and is listed.
"""

from __future__ import annotations

import argparse
import ast
import importlib.abc
import importlib.util
import io
import os
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path

from tests.mutants.mutations import Mutant, mutants_of

ROOT = Path(__file__).parent.parent.parent
SECONDS_A_MUTANT = 90


@dataclass(frozen=True)
class Job:
    """A mutant with its file and the tests that should fail on it."""

    path: Path
    mutant: Mutant
    tests: tuple[str, ...]


TWINCAT = "tests/formats/twincat"
TWINCAT_SHARED = (TWINCAT, "-k", "hand or reference or arm45 or families or bounds or kin98 or domain")
SINUMERIK = ("tests/formats/sinumerik", "tests/ik/policies/test_controller.py")
CHAIN = ("tests/chain",)


def _tests(folder: str, *names: str) -> tuple[str, ...]:
    return tuple(f"tests/{folder}/test_{name}.py" for name in names)


# Without those that compile solvers anew in each process.
COMPOSED = (*_tests("chain", "compose_numbers", "compose"), "tests/coupling", "-k", "not written_and_solved")
UNIVERSAL = _tests("formats/twincat", "directions", "universal_display", "universal", "as_universal")
COUPLED = _tests("formats/twincat", "two_steps", "coupling", "coupling_axes", "coupling_refused")
AXIS_MAPS = ("tests/chain", "tests/kinematics/test_robot.py", "-k", "not written_and_solved")
KINEMATICS = ("tests/kinematics", "tests/ik/test_ik.py", "tests/ik/search/test_arm_reach.py", "-k", "not arrays_of")
DRIVES = (*_tests("chain", "drives"), *_tests("formats/twincat", "drives"), *_tests("ik", "drive_limits"))
LIMITS = (*DRIVES, *_tests("ik", "limits_agree"))
DISPLAYED = (*_tests("ik", "displayed"), *_tests("formats/twincat", "universal_display", "displayed_by_hand"))
PROGRAMMED = (*_tests("chain", "vectors"), *_tests("ik/policies", "programmed"), *_tests("ik/branches", "status_turn"))


def targets() -> dict[Path, tuple[str, ...]]:
    """Return the files of translators and of what they fold and add, and the tests of each."""
    package = ROOT / "chainbuild"
    twincat, sinumerik = package / "formats" / "twincat", package / "formats" / "sinumerik"
    shared = [*sorted((twincat / "families").glob("[a-z]*.py")), *sorted((twincat / "maps").glob("[a-z]*.py"))]
    shared += [twincat / "recipes" / f"{name}.py" for name in ("parts", "head_parts", "recipe")]
    files = dict.fromkeys([*shared, twincat / "translate.py"], TWINCAT_SHARED)
    robx = [sinumerik / "geometry" / f"{name}.py" for name in ("translate", "robot_axes", "tool")]
    files |= dict.fromkeys([*robx, sinumerik / "rules" / "chain_data.py"], SINUMERIK)
    chain = package / "chain"
    files |= dict.fromkeys([chain / "fold.py", chain / "bodies" / "rods.py"], CHAIN)
    return files | _beside_the_translators(package)


def _beside_the_translators(package: Path) -> dict[Path, tuple[str, ...]]:
    """Return the files that compose, distribute, move and display what was translated, and the tests of each."""
    chain, kinematics, twincat = package / "chain", package / "kinematics", package / "formats" / "twincat"
    files = {
        chain / "compose.py": COMPOSED,
        **dict.fromkeys(sorted((package / "coupling").glob("[a-z]*.py")), COMPOSED),
        **dict.fromkeys(sorted((twincat / "coupling").glob("[a-z]*.py")), COUPLED),
        **dict.fromkeys(sorted((twincat / "universal").glob("[a-z]*.py")), UNIVERSAL),
        chain / "axismap.py": AXIS_MAPS,
        **dict.fromkeys([chain / "drives.py", twincat / "maps" / "drives.py"], DRIVES),
        **dict.fromkeys(sorted((chain / "programmed").glob("[a-z]*.py")), PROGRAMMED),
        **dict.fromkeys(sorted(kinematics.glob("[a-z]*.py")), KINEMATICS),
        **dict.fromkeys([kinematics / "limits.py", kinematics / "ranges.py"], LIMITS),
    }
    displayed = [kinematics / "displayed.py", package / "ik" / "displayed.py", package / "ik" / "rtcp.py"]
    displayed += [chain / "programmed" / "display.py", twincat / "types" / "displays.py"]
    return files | dict.fromkeys(displayed, DISPLAYED)


def types_in(path: Path) -> tuple[int, ...]:
    """Return the KIN_TYPs that a family file registers."""
    numbers = {
        key.value
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.Dict)
        for key in node.keys
        if isinstance(key, ast.Constant) and isinstance(key.value, int)
    }
    return tuple(sorted(numbers))


def tests_for(path: Path, mutant: Mutant, default: tuple[str, ...]) -> tuple[str, ...]:
    """Return the pytest arguments for a mutant: its own type where it lies in one recipe."""
    if path.parent.name != "families":
        return default
    number = mutant.function.removeprefix("kin_")
    types = (int(number),) if number.isdigit() else types_in(path)
    if not types:
        return default
    return (TWINCAT, f"--mutant-types={','.join(map(str, types))}")


class MutatedLoader(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Loads one module from mutated source, everything else as usual."""

    def __init__(self, module: str, path: Path, source: str) -> None:
        self.module, self.path, self.source = module, path, source

    def find_spec(self, fullname, path=None, target=None):
        if fullname == self.module:
            return importlib.util.spec_from_file_location(fullname, self.path, loader=self)
        return None

    def create_module(self, spec):
        return None

    def exec_module(self, module) -> None:
        exec(compile(self.source, str(self.path), "exec"), module.__dict__)


class TypeFilter:
    """Pytest plugin: keep the tests of some KIN_TYPs only."""

    def __init__(self, types: set[int]) -> None:
        self.types = types

    def pytest_collection_modifyitems(self, items) -> None:
        def concerned(item) -> bool:
            spec = getattr(item, "callspec", None)
            number = spec.params.get("kin") if spec else None
            return number in self.types or (number is None and "bad" not in item.nodeid)

        items[:] = sorted((i for i in items if concerned(i)), key=lambda i: "hand_formulas" not in i.nodeid)


def survives(job: Job) -> bool:
    """Run a mutant's tests in a fork; True where none fails."""
    child = os.fork()
    if child == 0:
        os._exit(_run_tests(job))
    deadline = time.monotonic() + SECONDS_A_MUTANT
    while True:
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            return os.waitstatus_to_exitcode(status) == 0
        if time.monotonic() > deadline:
            os.kill(child, 9)
            os.waitpid(child, 0)
            return False  # a mutant that hangs is noticed
        time.sleep(0.02)


def _run_tests(job: Job) -> int:
    import pytest

    module = ".".join(job.path.relative_to(ROOT).with_suffix("").parts)
    sys.meta_path.insert(0, MutatedLoader(module, job.path, job.mutant.source))
    plugins: list[object] = []
    arguments = []
    for argument in job.tests:
        if argument.startswith("--mutant-types="):
            plugins.append(TypeFilter({int(n) for n in argument.partition("=")[2].split(",")}))
        else:
            arguments.append(argument)
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
        try:
            return int(pytest.main([*arguments, "-x", "-q", "-p", "no:cacheprovider", "--rootdir", str(ROOT)], plugins))
        except BaseException:
            return 1


def main() -> int:
    """Run all mutants within the time and list the survivors."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=20.0)
    parser.add_argument("only", nargs="*", help="parts of paths")
    options = parser.parse_args()
    os.chdir(ROOT)
    import pinocchio  # noqa: F401 - shared by all forks

    jobs = [
        Job(path, mutant, tests_for(path, mutant, tests))
        for path, tests in targets().items()
        if not options.only or any(part in str(path) for part in options.only)
        for mutant in mutants_of(path.read_text("utf-8"))
    ]
    start, survivors, done = time.monotonic(), [], 0
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:

        def judge(job: Job) -> None:
            nonlocal done
            if time.monotonic() - start > options.minutes * 60.0:
                return
            if survives(job):
                survivors.append(job)
            done += 1
            if sys.stderr.isatty():
                print(f"\r{done}/{len(jobs)} mutants, {len(survivors)} survive", end="", file=sys.stderr, flush=True)

        list(pool.map(judge, jobs))
    print(
        f"\n{done} of {len(jobs)} mutants run in {(time.monotonic() - start) / 60.0:.1f} min, {len(survivors)} survive"
    )
    for job in sorted(survivors, key=lambda j: (str(j.path), j.mutant.line)):
        print(f"  {job.path.relative_to(ROOT)}:{job.mutant.line} {job.mutant.function}: {job.mutant.what}")
    return 0 if done == len(jobs) else 1


if __name__ == "__main__":
    sys.exit(main())
