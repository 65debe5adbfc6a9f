"""Generated tables have not drifted, and what the README shows works."""

from __future__ import annotations

import importlib.util
import re
import shlex
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import chainbuild
from tests.kit.paths import ROOT


def generator():
    spec = importlib.util.spec_from_file_location("docs_generate", ROOT / "docs/generate.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


GENERATE = generator()
PICTURES = GENERATE.machine_pictures


@pytest.mark.parametrize("page", GENERATE.PAGES)
def test_tables_are_up_to_date(page: str) -> None:
    text = (ROOT / page).read_text("utf-8")
    assert GENERATE.filled(text) == text, f"{page} has drifted: run `make docs`"


@pytest.mark.parametrize(("file", "name", "view"), list(PICTURES.drawings()))
def test_pictures_are_up_to_date(file: str, name: str, view: str) -> None:
    assert PICTURES.drawn(name, view) == (PICTURES.FOLDER / file).read_text("utf-8"), "run `make docs`"


def test_the_picture_of_the_readme_is_up_to_date() -> None:
    assert PICTURES.readme_picture() == (PICTURES.FOLDER / PICTURES.README).read_text("utf-8"), "run `make docs`"


def test_no_picture_is_left_over() -> None:
    wanted = {file for file, _, _ in PICTURES.drawings()} | {PICTURES.README}
    assert {path.name for path in PICTURES.FOLDER.iterdir()} == wanted


def test_the_readme_counts_the_machines() -> None:
    assert f"{len(chainbuild.shipped())} machine files" in (ROOT / "README.md").read_text("utf-8")


@pytest.mark.parametrize(
    "page", ["README.md", "docs/python.md", "docs/branches.md", "docs/export.md", "docs/report.md", "docs/json.md"]
)
def test_the_python_of_the_pages_runs(page: str, tmp_path: Path) -> None:
    code = "\n".join(re.findall(r"```python\n(.*?)```", (ROOT / page).read_text("utf-8"), re.DOTALL))
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def commands_of(page: str) -> list[str]:
    blocks = re.findall(r"```console\n(.*?)```", (ROOT / page).read_text("utf-8"), re.DOTALL)
    lines = [line[2:] for block in blocks for line in block.splitlines() if line.startswith("$ ")]
    return [line for line in lines if line.startswith("chainbuild ")]


def serves_until_interrupted(arguments: list[str]) -> None:
    """Check that a live page is served, and that Ctrl-C ends it as done."""
    command = [sys.executable, "-m", "chainbuild.cli", *arguments]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        address = server.stdout.readline()
        server.send_signal(signal.SIGINT)
        _, told = server.communicate(timeout=60)
        assert address.startswith("http://127.0.0.1:"), told
        assert server.returncode == 0, told


@pytest.mark.parametrize(
    ("page", "least"),
    [
        ("README.md", 4),
        ("docs/tables.md", 3),
        ("docs/paths.md", 4),
        ("docs/export.md", 1),
        ("docs/report.md", 1),
        ("docs/dh.md", 3),
    ],
)
def test_the_commands_of_the_pages_run(page: str, least: int, tmp_path: Path) -> None:
    commands = commands_of(page)
    assert len(commands) >= least
    # A table that a page shows stands behind its name.
    for name, table in re.findall(r"`(\w+\.csv)`[^`]*```csv\n(.*?)```", (ROOT / page).read_text("utf-8"), re.DOTALL):
        (tmp_path / name).write_text(table, "utf-8")
    for command in commands:
        arguments = shlex.split(command, comments=True)[1:]
        if arguments[0] == "inspect" and "--export" not in arguments:
            serves_until_interrupted([*arguments, "--no-open", "--port", "0"])
            continue
        done = subprocess.run(
            [sys.executable, "-m", "chainbuild.cli", *arguments],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, f"{command}: {done.stderr}"


def test_every_command_the_pages_name_exists() -> None:
    from chainbuild.cli.entry import build_app

    known = {name for name in build_app() if not name.startswith("-")}
    for page in (ROOT / "README.md", *(ROOT / "docs").glob("*.md")):
        named = set(re.findall(r"`chainbuild ([a-z][a-z-]*)\b", page.read_text("utf-8")))
        assert named <= known, f"{page.name}: {named - known}"
    readme = (ROOT / "README.md").read_text("utf-8")
    assert all(f"chainbuild {name}" in readme for name in known - {"demo"})


def test_links_between_the_pages_lead_somewhere() -> None:
    for page in (ROOT / "README.md", *(ROOT / "docs").glob("*.md")):
        for target in re.findall(r"\]\(([^)#:\s]+)(?:#[^)]*)?\)", page.read_text("utf-8")):
            assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_the_python_page_names_what_there_is() -> None:
    text = (ROOT / "docs/python.md").read_text("utf-8")
    missing = [name for name in chainbuild.__all__ if name[0].islower() and not re.search(rf"\b{name}\(", text)]
    assert missing == []
