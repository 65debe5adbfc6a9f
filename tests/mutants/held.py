"""Tests collected once and held: each mutant is put into the loaded functions in a fork and meets them there.

That takes a tenth of the time of a fork that loads and collects anew. What a test failed is killed; what none failed,
or cannot be put into loaded functions, is judged anew from the start (`tests.mutants.forked`): what was computed while
the tests were collected is from before the mutant.
"""

from __future__ import annotations

import io
import json
import os
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import NoReturn

from tests.mutants.forked import Job, Outcome, TypeFilter, in_fork, module_of, quiet_pytest, split_types
from tests.mutants.transplant import transplanted

ENOUGH_SECONDS = 60.0  # of tests that call the function: what none of them failed is judged anew at any rate
_WORD = 2  # bytes of a job's number in the pipe that workers read them from, which holds 65,536 bytes
Callers = dict[tuple[str, str], dict[str, float]]  # (file, function) → test → seconds
Told = Callable[[Job, Outcome], None]


def groups_of(jobs: Iterable[Job]) -> dict[tuple[str, ...], list[Job]]:
    """Return the jobs by the tests that are collected for them."""
    groups: dict[tuple[str, ...], list[Job]] = {}
    for job in jobs:
        groups.setdefault(split_types(job.tests)[0], []).append(job)
    return groups


def judge_held(words: tuple[str, ...], jobs: Sequence[Job], told: Told, until: float) -> None:
    """Judge the jobs that share the tests of pytest's words, and tell of each that a test killed.

    Args:
        words: Pytest's arguments.
        jobs: The mutants.
        told: Called with job and outcome.
        until: Time by `time.monotonic` at which no further mutant begins.
    """
    reading, writing = os.pipe()
    child = os.fork()  # the package stays unknown to this process: what is judged anew must load it mutated
    if child == 0:
        try:
            os.close(reading)
            quiet_pytest(list(words), [_Loop(jobs, writing, until)], "--capture=sys")
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as lines:
        for line in lines:
            number, killer = json.loads(line)
            told(jobs[number], Outcome("killed", killer))
    os.waitpid(child, 0)


@dataclass(eq=False)
class _Loop:
    """Pytest plugin: in place of the tests, the mutants, each in a fork that runs tests until one fails.

    Attributes:
        jobs: The mutants.
        writing: Pipe for what was killed: number and test in a line of JSON.
        until: Time at which no further mutant begins.
        callers: Which tests call which functions.
    """

    jobs: Sequence[Job]
    writing: int
    until: float
    callers: Callers = field(default_factory=dict)

    def pytest_runtestloop(self, session) -> bool:
        self.callers = _callers_of(session, {str(job.path) for job in self.jobs})
        asked, asking = os.pipe()
        os.write(asking, b"".join(number.to_bytes(_WORD) for number in range(len(self.jobs))))
        os.close(asking)
        children = []
        for _ in range(os.cpu_count() or 1):
            child = os.fork()  # a process and no thread: what forks beside threads may wait for ever
            if child == 0:
                self._work(session, iter(lambda: os.read(asked, _WORD), b""))
            children.append(child)
        for child in children:
            os.waitpid(child, 0)
        return True

    def _work(self, session, numbers: Iterable[bytes]) -> NoReturn:
        """Judge some of the jobs and end this process."""
        try:
            killers: defaultdict[Path, list[str]] = defaultdict(list)
            for word in numbers:
                number = int.from_bytes(word)
                job = self.jobs[number]
                known = killers[job.path]
                killer = (
                    in_fork(partial(_first_failing, session, job, known, self.callers))
                    if time.monotonic() < self.until
                    else ""
                )
                if killer:
                    if killer in known:
                        known.remove(killer)
                    known.append(killer)
                    os.write(self.writing, f"{json.dumps([number, killer])}\n".encode())
        finally:
            os._exit(0)


def _callers_of(session, files: set[str]) -> Callers:
    """Return which tests call the functions of files, and what each takes [s], by running all of them once."""
    workers = os.cpu_count() or 1
    with tempfile.TemporaryDirectory() as folder:
        children = []
        for first in range(workers):
            child = os.fork()
            if child == 0:
                try:
                    _note_callers(session.items[first::workers], files, Path(folder) / str(first))
                finally:
                    os._exit(0)
            children.append(child)
        for child in children:
            os.waitpid(child, 0)
        callers: defaultdict[tuple[str, str], dict[str, float]] = defaultdict(dict)
        for path in Path(folder).iterdir():
            for file, function, found in json.loads(path.read_text("utf-8")):
                callers[file, function] |= found
        return callers


def _note_callers(items, files: set[str], path: Path) -> None:
    from _pytest.runner import runtestprotocol

    sys.stdout = sys.stderr = io.StringIO()
    found: defaultdict[tuple[str, str], dict[str, float]] = defaultdict(dict)
    called: set[tuple[str, str]] = set()

    def note(frame, event, argument) -> None:
        code = frame.f_code
        if code.co_filename in files:
            called.add((code.co_filename, code.co_name))

    for item in items:
        called.clear()
        start = time.monotonic()
        sys.settrace(note)
        runtestprotocol(item, log=False, nextitem=None)  # fixtures of a module are made anew for each of its tests
        sys.settrace(None)
        for one in called:
            found[one][item.nodeid] = time.monotonic() - start
    path.write_text(json.dumps([(*one, tests) for one, tests in found.items()]), "utf-8")


def _first_failing(session, job: Job, killers: list[str], callers: Callers) -> str:
    """Return the first test that fails with a mutant, in this process; empty: none, or the mutant has no place.

    Where tests are known to call the function, those alone are run: what others notice is judged anew.
    """
    from _pytest.runner import runtestprotocol

    if not job.mutant.function or not transplanted(module_of(job.path), job.path, job.mutant.source):
        return ""
    items = list(session.items)
    for types in split_types(job.tests)[1]:
        TypeFilter(types).pytest_collection_modifyitems(items)
    # First what killed others, the newest first, then what calls the function, the quickest first, then the others.
    ranks = {name: (0, float(-n)) for n, name in enumerate(killers)}
    calling = callers.get((str(job.path), job.mutant.function), {})
    taken = 0.0
    for name, seconds in sorted(calling.items(), key=lambda item: item[1]):
        taken += seconds
        if taken < ENOUGH_SECONDS:
            ranks.setdefault(name, (1, seconds))
    if calling:
        items = [item for item in items if item.nodeid in ranks]
    items.sort(key=lambda item: ranks.get(item.nodeid, (2, 0.0)))
    sys.stdout = sys.stderr = io.StringIO()
    for item, following in zip(items, [*items[1:], None], strict=True):
        if any(report.failed for report in runtestprotocol(item, log=False, nextitem=following)):
            return item.nodeid
    return ""
