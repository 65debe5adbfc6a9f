"""Run the notebooks and write their outputs: `make notebooks`, or `python notebooks/execute.py NAME …` for some.

A notebook is two files. NAME.py is what is written and reviewed: a script in cells (`# %%`), which `python`, ruff and
editors understand. NAME.ipynb is made from it, with outputs, to be read and run in Jupyter; jupytext keeps both in step
while one works there. Cells are run here in one process, without a kernel, and shown as IPython shows them.
"""

from __future__ import annotations

import ast
import contextlib
import io
import os
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import jupytext
import nbformat
from IPython.core.formatters import DisplayFormatter
from nbformat import NotebookNode
from nbformat.v4 import new_notebook, new_output

FOLDER: Final = Path(__file__).parent
TOOLS: Final = ("execute", "figures")  # what is no notebook
# What only a running kernel can show: without one, a note that it cannot would hide the picture beside it.
_LIVE: Final = "application/vnd.jupyter.widget-view+json"
# Said on a machine's first use, and no more.
_ONCE: Final = ("chainbuild: compiling", "Matplotlib is building the font cache")
_METADATA: Final = {
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
    "jupytext": {"formats": "ipynb,py:percent"},
}


def sources() -> list[Path]:
    """Return the scripts of all notebooks."""
    return sorted(path for path in FOLDER.glob("*.py") if path.stem not in TOOLS)


def cells_of(source: Path) -> NotebookNode:
    """Return a notebook without outputs from its script."""
    notebook = new_notebook(metadata=_METADATA, cells=jupytext.read(source, fmt="py:percent").cells)
    for number, cell in enumerate(notebook.cells):
        cell.id, cell.metadata = f"cell-{number:02}", NotebookNode()
    return notebook


@contextlib.contextmanager
def _at_home() -> Iterator[Path]:
    """Run in an empty folder, with what the notebooks import from beside them."""
    before, path = Path.cwd(), list(sys.path)
    with tempfile.TemporaryDirectory() as folder:
        sys.path.insert(0, str(FOLDER))
        os.chdir(folder)
        try:
            yield Path(folder)
        finally:
            os.chdir(before)
            sys.path[:] = path


def executed(source: Path) -> NotebookNode:
    """Return a notebook with its outputs.

    Raises:
        RuntimeError: a cell fails, warns, shows nothing, or leaves a file.
    """
    notebook = cells_of(source)
    names: dict[str, Any] = {"__name__": "__main__"}
    formatter = DisplayFormatter()
    with _at_home() as folder:
        for number, cell in enumerate((c for c in notebook.cells if c.cell_type == "code"), start=1):
            try:
                cell.outputs, cell.execution_count = _run(cell.source, names, formatter, number), number
            except Exception as error:
                raise RuntimeError(f"{source.name}, cell [{number}]:\n{cell.source}\n{error!r}") from error
            if not cell.outputs:
                raise RuntimeError(f"{source.name}, cell [{number}] shows nothing:\n{cell.source}")
        if left := [path.name for path in folder.iterdir()]:
            raise RuntimeError(f"{source.name} leaves {left} where it is run")
    return notebook


def _run(code: str, names: dict[str, Any], formatter: DisplayFormatter, number: int) -> list[NotebookNode]:
    """Run the code of a cell; return what it prints, and its last value."""
    tree = ast.parse(code)
    last = ast.Expression(tree.body.pop().value) if isinstance(tree.body[-1], ast.Expr) else None
    printed, warned = io.StringIO(), io.StringIO()
    name, value = f"<cell {number}>", None
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(warned):
        exec(compile(tree, name, "exec"), names)
        if last is not None:
            value = eval(compile(last, name, "eval"), names)
    if told := [line for line in warned.getvalue().splitlines() if line and not line.startswith(_ONCE)]:
        raise RuntimeError("it warns: " + "\n".join(told))
    outputs = [new_output("stream", name="stdout", text=printed.getvalue())] if printed.getvalue() else []
    if value is not None:
        data, _ = formatter.format(value)
        data.pop(_LIVE, None)
        outputs.append(new_output("execute_result", data=data, execution_count=number))
    return outputs


def main(names: list[str]) -> None:
    """Write the notebooks named, or all."""
    for source in sources():
        if not names or source.stem in names:
            nbformat.write(executed(source), source.with_suffix(".ipynb"))
            print(f"{source.stem}.ipynb")


if __name__ == "__main__":
    main(sys.argv[1:])
