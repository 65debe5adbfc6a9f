"""Run the mutants: `python -m tests.mutants [--each N] [--minutes N] [--state FILE] [part of a path …]`.

Each mutant lives in a forked process: first put into functions that are loaded already, where the tests that call them
run first (`tests.mutants.held`); what no test fails there is judged anew in a process that loads the mutated module
(`tests.mutants.forked`). The tests run until the first failure. A mutant that no test fails survives and is listed. The
mutants of all files take turns, in an order that is random and always the same: where time ends, each file has had
its share. With `--state` the outcomes are kept in a file, and a later run goes on where time ended, as long as neither
package nor tests have changed.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import random
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from itertools import zip_longest
from pathlib import Path

from tests.mutants.equivalent import is_equivalent
from tests.mutants.forked import Job, Outcome, failing_unmutated, judged
from tests.mutants.held import groups_of, judge_held
from tests.mutants.mutations import mutants_of
from tests.mutants.targets import ROOT, targets, tests_for

KILLERS_TRIED = 12  # first, of those that killed others: more are slower than all tests of most files
UNNOTICED = {"hung", "survived", "untested"}  # to be looked at: what hangs has failed no test
KINDS = ("killed", "hung", "survived", "equivalent", "untested", "left")


@dataclass
class Run:
    """The mutants, what became of them, and the tests that killed some, newest last.

    Attributes:
        jobs: The mutants.
        state: File in which outcomes are kept; None: none.
        outcomes: What became of them.
        killers: Tests that killed others of a file, newest last.
    """

    jobs: list[Job]
    state: Path | None = None
    outcomes: dict[Job, Outcome] = field(default_factory=dict)
    killers: defaultdict[tuple[Path, tuple[str, ...]], list[str]] = field(default_factory=lambda: defaultdict(list))

    def judge(self, job: Job) -> None:
        """Judge one mutant and note the test that killed it."""
        self.note(job, judged(job, self.killers[job.path, job.tests][-KILLERS_TRIED:]))

    def note(self, job: Job, outcome: Outcome) -> None:
        """Note what became of a mutant."""
        known = self.killers[job.path, job.tests]
        if self.state is not None and self.outcomes.get(job) != outcome:
            with self.state.open("a", encoding="utf-8") as lines:
                lines.write(f"{json.dumps([self.jobs.index(job), outcome.kind, outcome.killer])}\n")
        self.outcomes[job] = outcome
        if outcome.killer in known:
            known.remove(outcome.killer)
        if outcome.killer:
            known.append(outcome.killer)

    def go_on(self) -> None:
        """Take the outcomes that the state file holds of the same sources, or begin a new one."""
        if self.state is None:
            return
        sources = fingerprint(self.jobs)
        lines = self.state.read_text("utf-8").splitlines() if self.state.exists() else []
        if lines[:1] != [sources]:
            self.state.write_text(f"{sources}\n", "utf-8")
            return
        for line in lines[1:]:
            number, kind, killer = json.loads(line)
            self.outcomes[self.jobs[number]] = Outcome(kind, killer)

    def kind(self, job: Job) -> str:
        """Return what became of a mutant."""
        return self.outcomes[job].kind if job in self.outcomes else "left"

    def set_aside(self) -> None:
        """Note the mutants that are known to compute the same: no test need be run on them."""
        for job in self.jobs:
            if is_equivalent(job.path, job.mutant):
                self.outcomes[job] = Outcome("equivalent")


def fingerprint(jobs: Sequence[Job]) -> str:
    """Return what names mutants: which they are, and the sources of package and tests as they are."""
    digest = hashlib.sha256("\n".join(map(str, jobs)).encode())
    for folder in ("chainbuild", "tests"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            digest.update(path.as_posix().encode() + path.read_bytes())
    return digest.hexdigest()


def jobs_of(only: list[str], each: int | None = None) -> list[Job]:
    """Return the mutants of all files, or of those whose path holds one of these words, taking turns.

    Args:
        only: Parts of paths; none: all.
        each: Mutants of a file at most, drawn at random and always the same; None: all.
    """
    files = []
    for path, tests in targets().items():
        if only and not any(part in str(path) for part in only):
            continue
        jobs = [Job(path, mutant, tests_for(path, mutant, tests)) for mutant in mutants_of(path.read_text("utf-8"))]
        random.Random(0).shuffle(jobs)
        files.append(jobs[:each])
    return [job for turn in zip_longest(*files) for job in turn if job is not None]


def summary(run: Run) -> str:
    """Return a table of the files and the list of all that no test noticed."""
    counts: dict[str, Counter[str]] = defaultdict(Counter)
    for job in run.jobs:
        for row in (str(job.path.relative_to(ROOT / "chainbuild")), "all"):
            counts[row][run.kind(job)] += 1
    total = counts.pop("all", Counter())
    width = max(map(len, counts), default=0)
    lines = [f"{'file':{width}}" + "".join(f"{kind:>11}" for kind in ("run", *KINDS))]
    for row, count in [*sorted(counts.items()), ("all", total)]:
        numbers = (count.total() - count["left"], *(count[kind] for kind in KINDS))
        lines.append(f"{row:{width}}" + "".join(f"{number:11}" for number in numbers))
    unnoticed = [f"  {run.kind(job)}: {job}" for job in run.jobs if run.kind(job) in UNNOTICED]
    return "\n".join([*lines, *sorted(unnoticed)])


def main() -> int:
    """Run all mutants within the time; list the survivors and what was left."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--state", type=Path, help="file that keeps the outcomes for a later run")
    parser.add_argument("--each", type=int, help="mutants of a file at most, drawn at random; all take many hours")
    parser.add_argument("only", nargs="*", help="parts of paths")
    options = parser.parse_args()
    os.chdir(ROOT)
    os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"), "1")
    import pinocchio  # noqa: F401 - shared by all forks
    import pytest  # noqa: F401 - the same

    run = Run(jobs_of(options.only, options.each), options.state and options.state.resolve())
    run.go_on()
    run.set_aside()
    start = time.monotonic()

    def told() -> None:
        if sys.__stderr__.isatty():
            print(f"\r{len(run.outcomes)}/{len(run.jobs)} mutants", end="", file=sys.__stderr__, flush=True)

    def judge(job: Job) -> None:
        if time.monotonic() - start < options.minutes * 60.0:
            run.judge(job)
            if run.kind(job) in UNNOTICED:
                print(f"{run.kind(job)}: {job}", flush=True)
            told()

    def killed(job: Job, outcome: Outcome) -> None:
        run.note(job, outcome)
        told()

    for words, jobs in groups_of([job for job in run.jobs if job not in run.outcomes]).items():
        judge_held(words, jobs, killed, start + options.minutes * 60.0)
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        list(pool.map(judge, [job for job in run.jobs if job not in run.outcomes]))
    broken = failing_unmutated(outcome.killer for outcome in run.outcomes.values() if outcome.killer)
    print(f"\n{summary(run)}\n{(time.monotonic() - start) / 60.0:.1f} min")
    for name in broken:
        print(f"fails without a mutant, too: {name}")
    return 1 if broken or any(run.kind(job) in {*UNNOTICED, "left"} for job in run.jobs) else 0


if __name__ == "__main__":
    sys.exit(main())
