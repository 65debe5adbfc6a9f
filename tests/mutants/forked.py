"""A mutant in a forked process: one module is replaced there, and tests run until the first that fails."""

from __future__ import annotations

import importlib.abc
import importlib.util
import io
import os
import resource
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path

from tests.mutants.mutations import Mutant
from tests.mutants.targets import ROOT, TYPES_ONLY

CPU_SECONDS = 300  # of a mutant: the longest list of tests takes 60 s, whatever else the machine does
WALL_SECONDS = 1800  # for one that waits for ever
ALL_PASSED, NOT_STARTED = 0, 4  # exit codes of pytest; the latter where the package cannot be imported


@dataclass(frozen=True)
class Job:
    """A mutant with its file and the tests that should fail on it."""

    path: Path
    mutant: Mutant
    tests: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.path.relative_to(ROOT)}:{self.mutant.line} {self.mutant.function}: {self.mutant.what}"


@dataclass(frozen=True)
class Outcome:
    """What became of a mutant: `killed` by a test, `survived`, `hung`, met by no test (`untested`), or `equivalent`."""

    kind: str
    killer: str = ""


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


@dataclass(eq=False)
class Only:
    """Pytest plugin: keep some tests only."""

    names: set[str]

    def pytest_collection_modifyitems(self, items) -> None:
        items[:] = [item for item in items if item.nodeid in self.names]


@dataclass(eq=False)
class Failed:
    """Pytest plugin: notes which tests, or files that could not be imported, fail."""

    names: list[str] = field(default_factory=list)

    def pytest_runtest_logreport(self, report) -> None:
        if report.failed:
            self.names.append(report.nodeid)

    def pytest_collectreport(self, report) -> None:
        if report.failed:
            self.names.append(report.nodeid)


def judged(job: Job, killers: list[str]) -> Outcome:
    """Run a mutant's tests in a fork: first those that killed others of its kind, then all."""
    said = in_fork(lambda: "\n".join(_run_tests(job, killers)))
    if said is None:
        return Outcome("hung")
    return Outcome(*said.split("\n", 1)) if said else Outcome("killed")  # by a crash


def failing_unmutated(killers: Iterable[str]) -> list[str]:
    """Return the tests that fail without any mutant, too: those killed nothing."""
    names = set(killers)
    said = in_fork(lambda: "\n".join(quiet_pytest(_files_of(names), [Only(names)])[1]))
    return ["what runs them hangs"] if said is None else said.splitlines()


def _run_tests(job: Job, killers: list[str]) -> tuple[str, str]:
    sys.meta_path.insert(0, MutatedLoader(module_of(job.path), job.path, job.mutant.source))
    if killers:
        _, failed = quiet_pytest(_files_of(killers), [Only(set(killers))], "-x")
        if failed:
            return "killed", failed[0]
    words, types = split_types(job.tests)
    code, failed = quiet_pytest(list(words), [TypeFilter(numbers) for numbers in types], "-x")
    if failed or code == NOT_STARTED:
        return "killed", "".join(failed[:1])
    return "survived" if code == ALL_PASSED else "untested", ""


def module_of(path: Path) -> str:
    """Return the name of the module in a file."""
    return ".".join(path.relative_to(ROOT).with_suffix("").parts)


def split_types(tests: tuple[str, ...]) -> tuple[tuple[str, ...], list[set[int]]]:
    """Return pytest's own words, and the KIN_TYPs of each of the others."""
    words = tuple(word for word in tests if not word.startswith(TYPES_ONLY))
    types = [word.partition("=")[2].split(",") for word in tests if word.startswith(TYPES_ONLY)]
    return words, [{int(number) for number in numbers} for numbers in types]


def _files_of(names: Iterable[str]) -> list[str]:
    return sorted({name.partition("::")[0] for name in names})


def quiet_pytest(words: list[str], plugins: Sequence[object], *options: str) -> tuple[int, list[str]]:
    """Run pytest without a word; return its exit code and the tests that fail."""
    import pytest

    failed = Failed()
    with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
        code = pytest.main(
            [*words, *options, "-q", "-p", "no:cacheprovider", "--rootdir", str(ROOT)], [*plugins, failed]
        )
    return int(code), failed.names


def in_fork(work: Callable[[], str]) -> str | None:
    """Return what `work` returns in a fork, an empty text where it breaks; None where it takes too long."""
    with tempfile.TemporaryFile() as said:
        child = os.fork()
        if child == 0:
            try:
                resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS))
                os.write(said.fileno(), work().encode())
            finally:
                os._exit(0)
        deadline = time.monotonic() + WALL_SECONDS
        while not (ended := os.waitpid(child, os.WNOHANG))[0]:
            if time.monotonic() > deadline:
                os.kill(child, signal.SIGKILL)
            time.sleep(0.02)
        if os.WIFSIGNALED(ended[1]) and os.WTERMSIG(ended[1]) in {signal.SIGXCPU, signal.SIGKILL}:
            return None
        said.seek(0)
        return said.read().decode()
