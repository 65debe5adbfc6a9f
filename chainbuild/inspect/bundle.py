"""The page's scripts as one import map: modules of a single file, which loads nothing."""

from __future__ import annotations

import json
from importlib import resources
from typing import TYPE_CHECKING, Final
from urllib.parse import quote

if TYPE_CHECKING:
    from importlib.resources.abc import Traversable

# A module's name is that of its file; those of others keep the names by which they import one another.
_OWN: Final = "cb/"
_FOLDERS: Final = ("model", "view", "panel", "live")
_READABLE: Final = " !$&'()*+,-./:;=?@[]_~{}|^`"  # what a data: URL in a script element may hold as it is
# The viewer is a script that leaves three.js in the global MeshCat; what imports it by its name finds it there.
_THREE: Final = """
const THREE = globalThis.MeshCat.THREE;
export const {{ {names} }} = THREE;
"""


def import_map() -> str:
    """Return the JSON that names every module of the page and holds its text as a data: URL."""
    modules = {f"{_OWN}{path.name.removesuffix('.js')}": _text(path) for path in _scripts()}
    vendored = asset("vendor/TransformControls.js")
    modules["transform-controls"] = vendored
    head = vendored.partition("import {")[2].partition("}")[0]
    modules["three"] = _THREE.format(names=", ".join(name.strip() for name in head.split(",")))
    urls = {name: f"data:text/javascript,{quote(text, safe=_READABLE)}" for name, text in modules.items()}
    return json.dumps({"imports": urls}, separators=(",", ":"))


def asset(name: str) -> str:
    """Return the text of a file that belongs to the page."""
    return _text(_static().joinpath(*name.split("/")))


def viewer_file(name: str) -> str:
    """Return the text of a file of the viewer that meshcat ships."""
    return resources.files("meshcat").joinpath("viewer", "dist", name).read_text("utf-8")


def _static() -> Traversable:
    return resources.files("chainbuild.inspect").joinpath("static")


def _scripts() -> list[Traversable]:
    found = [path for folder in _FOLDERS for path in _static().joinpath(folder).iterdir()]
    return sorted((path for path in found if path.name.endswith(".js")), key=lambda path: path.name)


def _text(path: Traversable) -> str:
    return path.read_text("utf-8")
