"""The OpenAPI document is one that generators of clients and validators can read."""

import json
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from openapi_spec_validator import validate

from app.api.contract import operations
from app.api.shared_schemas import shared_schemas
from app.server import create_app
from app.settings import Settings
from tests.cli.running import EXAMPLES
from tests.storage.stores import temporary_store

MAX_BYTES = 700_000
PUBLISHED = {
    *("list_runs", "get_run", "repeat_run", "restore_run", "delete_runs", "annotate_run"),
    *("start_race", "list_races", "get_race", "stop_race", "pause_race", "resume_race"),
    *("start_training", "list_trainings", "get_training", "stop_training", "change_training"),
    *("delete_race", "delete_training", "disturb_training", "import_training", "get_q_table"),
    *("get_curve", "get_recording", "get_timeline", "get_replay", "get_stage", "put_stage"),
    *("get_events", "get_options", "start_experiment", "get_experiment_summary", "open_room"),
    *("join_room", "get_room", "start_room_run", "open_tournament", "enter_tournament"),
    *("store_robot", "list_robots", "get_robot", "delete_robot", "ask_what_if", "explain_step"),
}
"""Operation ids on which generated clients rely: none may change within `/api/v1`."""


@pytest.fixture(scope="module")
def document() -> dict[str, Any]:
    with temporary_store() as store:
        return create_app(Settings(data=Path("unused")), store).openapi()


def parts_of(document: Any) -> Iterator[dict[str, Any]]:
    """Yield all objects of a document."""
    if isinstance(document, dict):
        yield document
        document = list(document.values())
    if isinstance(document, list):
        for member in document:
            yield from parts_of(member)


def test_the_document_is_valid(document: dict[str, Any]) -> None:
    assert document["openapi"].startswith("3.1.")
    validate(document)


def test_all_references_lead_to_a_component(document: dict[str, Any]) -> None:
    references = {part["$ref"] for part in parts_of(document) if "$ref" in part}
    assert len(references) > 200
    for reference in references:
        component = document
        for key in reference.removeprefix("#/").split("/"):
            assert key in component, reference
            component = component[key]


def test_the_document_is_small(document: dict[str, Any]) -> None:
    text = json.dumps(document, ensure_ascii=False, separators=(",", ":"))
    assert len(text.encode()) < MAX_BYTES


def test_each_operation_id_is_a_verb_and_a_noun_and_that_of_no_other(
    document: dict[str, Any],
) -> None:
    ids = [operation["operationId"] for _, _, operation in operations(document)]
    assert len(ids) > 100
    assert [name for name in ids if not re.fullmatch("[a-z]+(_[a-z]+)+", name)] == []
    assert [name for name, count in Counter(ids).items() if count > 1] == []
    assert PUBLISHED - {*ids} == set()


def test_no_two_schemas_have_one_title(document: dict[str, Any]) -> None:
    titles = [schema["title"] for schema in document["components"]["schemas"].values()]
    bodies = [
        form["schema"]["title"]
        for _, _, operation in operations(document)
        for form in operation.get("requestBody", {}).get("content", {}).values()
        if "title" in form["schema"]
    ]
    assert {"StartRaceBody", "StartTrainingBody"} <= {*bodies}
    assert [title for title, count in Counter(titles + bodies).items() if count > 1] == []


def test_the_value_of_a_setting_is_of_listed_types(document: dict[str, Any]) -> None:
    # The generator that is used most fails where null is one of alternatives without a name.
    default = document["components"]["schemas"]["SettingOption"]["properties"]["default"]
    assert default["type"] == ["number", "string", "boolean", "null"]
    alternatives = [part.get("anyOf", ()) for part in parts_of(document)]
    kinds = [{str(choice.get("type")) for choice in choices} for choices in alternatives]
    assert [kind for kind in kinds if {"boolean", "null"} <= kind and len(kind) > 2] == []


def test_the_example_in_typescript_asks_for_what_there_is(document: dict[str, Any]) -> None:
    program = (EXAMPLES / "generated_client.ts").read_text("utf-8")
    calls = re.findall(r'api\.(GET|POST)\("([^"]+)"', program)
    assert {document["paths"][path][method.lower()]["operationId"] for method, path in calls} == {
        *("start_race", "get_race", "stop_race")
    }


def test_what_many_bodies_have_stands_there_once(document: dict[str, Any]) -> None:
    references = [part.get("$ref", "").rpartition("/")[2] for part in parts_of(document)]
    counts = Counter(references)
    for name, schema in shared_schemas().items():
        assert counts[name] > 0, name
        assert schema not in list(parts_of(document["paths"])), name
    assert counts["Disturbance"] > 20
    # Where null may be given too, it is one of two choices.
    entry = document["components"]["schemas"]["QLearningEntry"]["properties"]["robot"]
    assert entry["anyOf"] == [{"$ref": "#/components/schemas/AnyRobot"}, {"type": "null"}]


def test_defaults_are_as_requests_have_them(document: dict[str, Any]) -> None:
    body = document["components"]["schemas"]["RaceBody"]["properties"]
    assert body["robot"]["default"] == {"preset": "stiff"}
    assert body["robot"]["$ref"] == "#/components/schemas/AnyRobot"
