"""The mutants still find what they mutate and the tests that should notice."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.kit.paths import PACKAGE, ROOT
from tests.mutants.__main__ import Run, jobs_of
from tests.mutants.equivalent import EQUIVALENT, Equivalent
from tests.mutants.forked import Outcome
from tests.mutants.mutations import mutants_of
from tests.mutants.targets import targets, types_in

TARGETS = targets()


@pytest.mark.parametrize("path", TARGETS, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_file_and_tests_are_there(path: Path) -> None:
    assert path.is_file()
    folders = [word for word in TARGETS[path] if word.startswith("tests")]
    assert folders
    assert all((ROOT / word).exists() for word in folders)


def test_every_room_that_signs_pass_through_is_mutated() -> None:
    rooms = {str(path.parent.relative_to(PACKAGE)) for path in TARGETS}
    twincat = {f"formats/twincat/{room}" for room in ("families", "maps", "recipes", "coupling", "types", "universal")}
    robx = {"formats/sinumerik/geometry", "formats/sinumerik/rules"}
    chain = {"chain", "chain/bodies", "chain/programmed", "coupling", "kinematics", "ik", "ik/branches"}
    closed = {f"ik/branches/{room}" for room in ("planar", "opw", "core", "arms")}
    assert rooms == {*twincat, *robx, *chain, *closed, "formats/twincat", "formats/urdf", "formats"}


def test_the_types_of_a_family_are_read_from_its_file() -> None:
    assert types_in(PACKAGE / "formats" / "twincat" / "families" / "scara.py") == (36,)


JUDGED = """
import math
from tests.mutants.forked import Job, failing_unmutated, judged
from tests.mutants.held import judge_held
from tests.mutants.__main__ import Run, jobs_of
from tests.mutants.equivalent import EQUIVALENT, Equivalent
from tests.mutants.mutations import Mutant
from tests.mutants.targets import ROOT

path = ROOT / "chainbuild" / "chain" / "axismap.py"
test = "tests/kinematics/test_by_hand.py::test_an_affine_map_there_and_back"
source = path.read_text("utf-8")
wrong, broken = source.replace("(q - self.b)", "(q + self.b)"), "import no_such_module"
jobs = [Job(path, Mutant(0, function, "", text), (test,)) for text, function in
        ((source, "q"), (wrong, "axes"), (wrong, ""), (wrong.replace("class AffineMap", "class Another"), "axes"))]
found = []
judge_held((test,), jobs, lambda job, outcome: found.append((jobs.index(job), outcome.kind)), math.inf)
print(found)
for text, killers in ((source, [test]), (wrong, []), (wrong, [test]), (broken, [])):
    found = judged(Job(path, Mutant(0, "", "", text), (test,)), killers)
    print(found.kind, found.killer.partition("::")[2])
print(failing_unmutated([test]))
"""


def test_mutants_are_killed_by_the_test_that_fails_and_the_rest_survives() -> None:
    """In a process of its own, as in `make mutants`: the package must not be imported before."""
    done = subprocess.run([sys.executable, "-c", JUDGED], cwd=ROOT, capture_output=True, text=True, check=True)
    name = "test_an_affine_map_there_and_back"
    words = ["[(1, 'killed')]", "survived ", f"killed {name}", f"killed {name}", "killed ", "[]"]
    assert done.stdout.splitlines() == words


def test_a_later_run_goes_on_where_time_ended(tmp_path: Path) -> None:
    jobs = jobs_of(["axismap"])[:4]
    state = tmp_path / "state"
    first = Run(jobs, state)
    first.go_on()
    first.note(jobs[1], Outcome("killed", "test_a"))
    first.note(jobs[3], Outcome("survived"))
    again = Run(jobs, state)
    again.go_on()
    assert again.outcomes == {jobs[1]: Outcome("killed", "test_a"), jobs[3]: Outcome("survived")}
    assert [again.kind(job) for job in jobs[::2]] == ["left", "left"]
    other = Run(jobs[:3], state)
    other.go_on()
    assert other.outcomes == {}
    assert len(state.read_text("utf-8").splitlines()) == 1


@pytest.mark.parametrize("known", EQUIVALENT, ids=lambda known: f"{known.file} {known.what}")
def test_what_is_said_to_compute_the_same_is_still_a_mutant(known: Equivalent) -> None:
    path = PACKAGE / known.file
    assert [mutant for mutant in mutants_of(path.read_text("utf-8")) if known.is_of(path, mutant)]


def test_nothing_in_annotations_is_mutated() -> None:
    text = "class A:\n    letter: Literal['x', 'y'] = 'x'\n\n\ndef f(a: Literal['z'] = 'z') -> Literal['-x']:\n    ..."
    assert [(mutant.line, mutant.what) for mutant in mutants_of(text)] == [(2, "axis x → y"), (5, "axis z → x")]


def test_a_sum_that_only_takes_the_sign_off_a_zero_is_not_mutated() -> None:
    assert [mutant.what for mutant in mutants_of("a = b + 0.0\nc = b + 0.5")] == ["Sub for b + 0.5"]
