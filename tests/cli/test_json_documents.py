"""JSON of every command: it has a schema that leaves nothing open, and so has what it says when it is refused."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from chainbuild.cli import entry
from chainbuild.cli.show import schema_id
from tests.kit.command_line import ARM, Run, write
from tests.kit.json_documents import SCHEMAS, documents, schemas

PATH = "A1,A2,A3,A4,A5,A6\n0,-90,90,0,30,0\n0,-80,90,0,-30,0\n"
AT = "0,-90,90,0,30,0"
# A command line for every document; the parts of a schema that may be left out occur in one of them.
COMMANDS = [
    ("info", "kr6r900"),
    ("info", "cardan_head_kin59", "--defaults"),
    ("info", ARM),
    ("check", "robot_xy_unit_kin210"),
    ("check", "bad.lis"),
    ("types", "9"),
    ("types",),
    ("urdf", "tripod_kin12"),
    ("export", "kr6r900", "--format", "urdf,srdf,opw", "--samples", "5"),
    ("collide", "kr6r900", "--pairs", "--samples", "5"),
    ("collide", "kr6r900", "--axes", "path.csv", "--clearance", "9000"),
    ("couple", "robot_xy_unit_kin210", "--tcp", "X=700", "--axes"),
    ("crosscheck", "kr6r900", "--solver", "opw", "--count", "6"),
    ("crosscheck", "kr6r900", "--recording", "recorded.csv"),
    ("limits", "kr6r900", "--axis", "A3", "--over", "A2", "--steps", "2"),
    ("limits", "parallelogram_nr", "--steps", "2"),
    ("workspace", "kr6r900", "--samples", "200", "--cells", "5", "--workers", "1"),
    ("singularity", "kr6r900", "--at", "0,-90,90,0,0.3,0", "--nearest"),
    ("singularity", "kr6r900", "--axes", "path.csv", "--between", "rows"),
    ("singularity", "kr6r900", "--axes", "path.csv", "--feed", "6000"),
]


def files() -> None:
    write("bad.lis", "trafo[0].id 45\ntrafo[0].param[6] 1,5\n")
    write("path.csv", PATH)
    write("recorded.csv", "A1,A2,A3,A4,A5,A6,x_mm,y_mm,z_mm\n0,-90,90,0,30,0,500,1,890\n10,-80,90,0,30,0,500,0,800\n")


def parts(schema: Any, where: str = "$") -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield every schema within a schema, with its place."""
    if isinstance(schema, dict):
        yield where, schema
        for key, inner in schema.items():
            yield from parts(inner, f"{where}.{key}")
    elif isinstance(schema, list):
        for inner in schema:
            yield from parts(inner, where)


@pytest.mark.parametrize("name", [path.stem for path in sorted(SCHEMAS.glob("*.json"))])
def test_a_schema_is_valid_and_leaves_nothing_open(name: str) -> None:
    schema = schemas()[f"chainbuild:{name}:1"]
    Draft202012Validator.check_schema(schema)
    assert schema_id(name) == schema["$id"] == schema["properties"]["schema"]["const"]
    for where, part in parts(schema):
        if part.get("type") == "object":
            assert "additionalProperties" in part and part["additionalProperties"] is not True, where
            assert set(part.get("required", ())) <= set(part.get("properties", {})), where
        if part.get("type") == "array":
            assert "items" in part, where


def test_what_several_schemas_define_is_the_same_in_all() -> None:
    seen: dict[str, Any] = {}
    for schema in schemas().values():
        for name, part in schema.get("$defs", {}).items():
            assert seen.setdefault(name, part) == part, name


def test_every_document_is_printed_and_every_key_of_it(run: Run) -> None:
    files()
    printed: dict[str, set[str]] = {}
    for words in COMMANDS:
        outcome = run(*words, "--json")
        for document in documents(outcome.out):
            printed.setdefault(document["schema"], set()).update(document)
    # Printed below; compiling takes minutes where it was not done before, and is tried in test_warm.
    kept = {
        name: schema for name, schema in schemas().items() if name not in ("chainbuild:error:1", "chainbuild:warm:1")
    }
    assert set(printed) == set(kept)
    for name, keys in printed.items():
        assert keys == set(kept[name]["properties"]), name


def test_a_key_without_a_schema_would_be_found() -> None:
    document = {"schema": "chainbuild:urdf:1", "path": "a", "beside": [], "not_expressed": [], "conventions": {}}
    assert documents(json.dumps(document)) == [document]
    with pytest.raises(AssertionError, match="'new' was unexpected"):
        documents(json.dumps({**document, "new": 1}))


def commands_with_json() -> list[str]:
    app = entry.build_app()
    names = [name for name in app if not name.startswith("-")]
    return [name for name in names if any(one.name == "--json" for one in app[name].assemble_argument_collection())]


def test_every_command_with_json_is_tried() -> None:
    assert {*commands_with_json()} == {words[0] for words in COMMANDS} | {"warm"}


@pytest.mark.parametrize("name", sorted(set(commands_with_json()) - {"warm", "types"}))
def test_a_refused_file_is_json_with_the_same_message(run: Run, name: str) -> None:
    more = {"limits": ["--axis", "A3", "--over", "A2"], "crosscheck": ["--solver", "opw"], "singularity": ["--at", AT]}
    outcome = run(name, "missing.lis", *more.get(name, []), "--json")
    (document,) = documents(outcome.out)
    assert (outcome.code, document["exit_code"], document["refused"]) == (1, 1, True)
    assert (document["schema"], document["command"], document["file"]) == ("chainbuild:error:1", name, "missing.lis")
    assert outcome.err == f"missing.lis: {document['error']['text']}\n"


@pytest.mark.parametrize("name", commands_with_json())
def test_wrong_usage_is_json_with_the_same_message(run: Run, name: str) -> None:
    outcome = run(name, "--json", "--nope")
    (document,) = documents(outcome.out)
    assert (outcome.code, document["exit_code"], document["command"]) == (2, 2, name)
    assert document["error"]["code"] is None
    assert outcome.err == f"chainbuild: {document['error']['text']}\n{document['error']['hint']}\n"


def test_the_end_of_other_mistakes_is_json_too(run: Run) -> None:
    (document,) = documents(run("types", "44", "--json").out)
    assert (document["exit_code"], document["error"]["code"], document["file"]) == (1, "CB410", None)
    (document,) = documents(run("nope", "--json").out)
    assert (document["exit_code"], document["command"]) == (2, None)
    Path("a.lis").write_text("trafo[0].id 9\n", "utf-8")
    outcome = run("collide", "a.lis", "--at", "0,0,0,0,0", "--picture", "a.lis", "--json")
    (document,) = documents(outcome.out)
    assert (outcome.code, document["file"]) == (2, "a.lis")
    assert "also the input" in document["error"]["text"]


def test_a_verdict_is_the_document_of_the_command(run: Run) -> None:
    outcome = run("collide", "kr6r900", "--at", AT, "--clearance", "9000", "--json")
    (document,) = documents(outcome.out)
    assert (outcome.code, document["schema"], document["collides"]) == (3, "chainbuild:collide:1", True)


def test_info_of_a_refused_file_is_one_document(run: Run) -> None:
    write("k87.lis", "trafo[0].id 87\ntrafo[0].type 87\n")
    outcome = run("info", "k87.lis", "--json")
    (document,) = documents(outcome.out)
    assert (outcome.code, document["schema"], document["refused"]) == (1, "chainbuild:info:1", True)
    assert document["error"]["text"] in outcome.err


def test_without_json_nothing_is_printed_on_stdout(run: Run) -> None:
    for words in (["info", "missing.lis"], ["fk", "kr6r900"], ["types", "44"]):
        assert run(*words).out == "", words
