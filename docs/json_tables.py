"""Tables of the JSON that commands print, from the schemas in the package."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from importlib import resources
from typing import Any

FOLDER = "data/schemas"


def schemas() -> dict[str, dict[str, Any]]:
    """Return the schemas by their names."""
    files = sorted(resources.files("chainbuild").joinpath(FOLDER).iterdir(), key=lambda file: file.name)
    return {file.name.removesuffix(".json"): json.loads(file.read_text("utf-8")) for file in files}


def json_documents(table: Callable[[Sequence[str], Iterable[Sequence[object]]], str]) -> str:
    """Return one section for each schema: what it is of, and its keys.

    Args:
        table: Makes a Markdown table of a head and rows.
    """
    parts = []
    for name, schema in schemas().items():
        link = f"[schema](../chainbuild/{FOLDER}/{name}.json)"
        parts.append(f"### {schema['title']}\n\n`{schema['$id']}` ({link}): {schema['description']}\n")
        rows = [(f"`{key}`", kind, text) for key, kind, text in _keys(schema, schema, "")]
        parts.append(table(("key", "value", "meaning"), rows))
    return "\n".join(parts)


def _keys(schema: Mapping[str, Any], root: Mapping[str, Any], before: str) -> Iterator[tuple[str, str, str]]:
    """Yield the keys of an object and, below each, those of what it holds."""
    required = schema.get("required", ())
    for key, raw in schema.get("properties", {}).items():
        if before == "" and key == "schema":
            continue
        value = _resolved(raw, root)
        left_out = "" if key in required else " (may be left out)"
        text = raw.get("description") or value.get("description", "")
        yield f"{before}{key}", f"{_kind(value, root)}{left_out}", text
        inner, suffix = _inner(value, root)
        if "properties" in inner:
            yield from _keys(inner, root, f"{before}{key}{suffix}.")


def _resolved(schema: Mapping[str, Any], root: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return what a schema refers to, or is where it is not null."""
    if "$ref" in schema:
        return _resolved(root["$defs"][schema["$ref"].rpartition("/")[2]], root)
    if "anyOf" in schema:
        return {**_resolved(schema["anyOf"][0], root), "nullable": True, **_described(schema)}
    return schema


def _described(schema: Mapping[str, Any]) -> Mapping[str, Any]:
    return {"description": schema["description"]} if "description" in schema else {}


def _inner(schema: Mapping[str, Any], root: Mapping[str, Any]) -> tuple[Mapping[str, Any], str]:
    """Return the object that a value is or holds, and how its keys are written behind the value's."""
    if schema.get("type") in ("array", ["array", "null"]):
        inner, suffix = _inner(_resolved(schema["items"], root), root)
        return inner, f"[]{suffix}"
    more = schema.get("additionalProperties")
    if isinstance(more, Mapping):
        inner, suffix = _inner(_resolved(more, root), root)
        return inner, f".NAME{suffix}"
    return schema, ""


def _kind(schema: Mapping[str, Any], root: Mapping[str, Any]) -> str:
    """Return what a value is, in words."""
    null = " or null" if schema.get("nullable") else ""
    if "const" in schema:
        return f"`{json.dumps(schema['const'])}`"
    if "enum" in schema:
        return f"{', '.join(f'`{json.dumps(one)}`' for one in schema['enum'])}{null}"
    types = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
    words = " or ".join(types)
    if types[0] == "array":
        return words.replace("array", f"array of {_kind(_resolved(schema['items'], root), root)}") + null
    more = schema.get("additionalProperties")
    if isinstance(more, Mapping):
        return f"object of {_kind(_resolved(more, root), root)}{null}"
    return f"{words}{null}"
