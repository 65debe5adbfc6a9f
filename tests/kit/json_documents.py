"""JSON that commands print, against the schema that each document names."""

from __future__ import annotations

import json
from functools import cache
from typing import Any

from jsonschema import Draft202012Validator

from tests.kit.paths import PACKAGE

SCHEMAS = PACKAGE / "data" / "schemas"


@cache
def schemas() -> dict[str, dict[str, Any]]:
    """Return the schemas by their identifiers."""
    found = [json.loads(path.read_text("utf-8")) for path in sorted(SCHEMAS.glob("*.json"))]
    return {schema["$id"]: schema for schema in found}


@cache
def validator(name: str) -> Draft202012Validator:
    return Draft202012Validator(schemas()[name])


def documents(text: str) -> list[dict[str, Any]]:
    """Return the documents that a command printed, each as its schema has it."""
    data = json.loads(text)
    found: list[dict[str, Any]] = data if isinstance(data, list) else [data]
    for one in found:
        problems = sorted(validator(one["schema"]).iter_errors(one), key=str)
        assert not problems, "\n".join(f"{one['schema']} {error.json_path}: {error.message:.300}" for error in problems)
    return found
