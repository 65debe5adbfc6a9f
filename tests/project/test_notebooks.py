"""Notebooks are pairs in step, run from top to bottom, and show what is committed of them."""

from __future__ import annotations

import importlib.util
import re
import shutil
import sys
import tempfile
from pathlib import Path
from types import ModuleType

import matplotlib
import nbformat
import pytest
from nbclient import NotebookClient
from nbformat import NotebookNode

from tests.kit.notebook_outputs import SVG, same, stale, texts
from tests.kit.paths import ROOT

FOLDER = ROOT / "notebooks"
LARGEST = 200_000  # bytes of an output
TIME = re.compile(r"20\d\d-\d\d-\d\d|\d\d:\d\d:\d\d")


def loaded(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"notebooks_{name}", FOLDER / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


EXECUTE = loaded("execute")
SOURCES = EXECUTE.sources()
BY_NAME = pytest.mark.parametrize("source", SOURCES, ids=lambda path: path.stem)


def committed(source: Path) -> NotebookNode:
    return nbformat.read(source.with_suffix(".ipynb"), as_version=4)


def test_every_notebook_is_a_pair() -> None:
    assert len(SOURCES) >= 2
    assert [path.stem for path in sorted(FOLDER.glob("*.ipynb"))] == [path.stem for path in SOURCES]


@BY_NAME
def test_the_pair_is_in_step(source: Path) -> None:
    written, read = EXECUTE.cells_of(source), committed(source)
    assert [(c.id, c.cell_type, c.source) for c in read.cells] == [
        (c.id, c.cell_type, c.source) for c in written.cells
    ], "run `make notebooks`"
    assert read.metadata == written.metadata


@BY_NAME
def test_what_is_committed_is_what_a_run_shows(source: Path, compiled_solver: None) -> None:
    before = list(sys.path), Path.cwd(), dict(matplotlib.rcParams)
    differences = stale(committed(source), EXECUTE.executed(source))
    assert (list(sys.path), Path.cwd(), dict(matplotlib.rcParams)) == before
    assert not differences, "run `make notebooks`, and look at it:\n" + "\n".join(differences)


@BY_NAME
def test_outputs_are_small_and_say_nothing_of_where_they_were_made(source: Path) -> None:
    for cell in committed(source).cells:
        for kind, text in texts(cell):
            assert len(text.encode()) <= LARGEST, f"{kind} after:\n{cell.source}"
            places = [str(ROOT), str(Path.home()), tempfile.gettempdir() + "/", "/home/", "/root/", "/Users/"]
            assert [place for place in places if place in text] == [], cell.source
            assert TIME.search(text) is None, cell.source
            assert kind in {"stdout", "text/plain", "text/html", SVG, "image/png"}


@BY_NAME
def test_a_notebook_opens_with_a_question_and_ends_with_a_picture(source: Path) -> None:
    cells = committed(source).cells
    assert cells[0].cell_type == "markdown"
    assert cells[0].source.startswith("# ")
    pictures = [cell for cell in cells if any(kind == SVG for kind, _ in texts(cell))]
    assert pictures, "no picture"
    if source.stem != "first_light":  # which ends with a move of the page
        assert "?" in cells[0].source
        assert pictures[-1] is cells[-1]
        assert sum("assert " in cell.source for cell in cells) >= 3, "claims without a proof"


@BY_NAME
@pytest.mark.parametrize("page", ["README.md", "docs/notebooks.md"])
def test_a_page_lists_it(source: Path, page: str) -> None:
    assert f"{source.stem}.ipynb)" in (ROOT / page).read_text("utf-8")


@pytest.mark.slow
@BY_NAME
def test_a_kernel_shows_the_same(source: Path, tmp_path: Path, compiled_solver: None) -> None:
    shutil.copy(FOLDER / "figures.py", tmp_path)
    notebook = EXECUTE.cells_of(source)
    resources = {"metadata": {"path": str(tmp_path)}}
    NotebookClient(notebook, timeout=300, kernel_name="python3", resources=resources).execute()
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            output.get("data", {}).pop("application/vnd.jupyter.widget-view+json", None)
    assert not stale(committed(source), notebook)
    assert {path.name for path in tmp_path.iterdir()} <= {"figures.py", "__pycache__"}


@pytest.mark.parametrize(
    ("kind", "before", "after", "agree"),
    [
        ("stdout", "A1 12.346 mm", "A1 12.347 mm", True),
        ("stdout", "A1 12.346 mm", "A1 12.348 mm", False),
        ("stdout", "A1 12.346 mm", "A2 12.346 mm", False),
        ("stdout", "[-0.  1.5]", "[ 0.  1.5]", True),
        ("stdout", "70.000", "-70.000", False),
        ("stdout", "rank 5", "rank 5, full", False),
        (SVG, '<path d="M 10.123456 5"/>', '<path d="M 10.123999 5"/>', True),
        (SVG, '<path d="M 10.1 5"/>', '<path d="M 10.2 5"/>', False),
    ],
)
def test_rounding_is_the_same_and_nothing_else(kind: str, before: str, after: str, agree: bool) -> None:
    assert same(kind, before, after) == agree


def test_a_cell_that_fails_or_warns_or_shows_nothing_is_told(tmp_path: Path) -> None:
    for code, told in (
        ("assert 1 > 2", "AssertionError"),
        ("import sys; print('careful', file=sys.stderr)", "careful"),
        ("x = 1", "shows nothing"),
        ("print(open('left.txt', 'w').name)", "left.txt"),
    ):
        source = tmp_path / "bad.py"
        source.write_text(f"# %%\n{code}\n")
        with pytest.raises(RuntimeError, match=told):
            EXECUTE.executed(source)
