"""Valid values of each field in words, for validation errors and the OpenAPI document."""

import re
from collections.abc import Iterable, Mapping
from typing import Any

from app.storage.run import MAX_KEY_LENGTH, SORTS, STATES
from app.storage.run_kind import run_kinds
from hexapods.domain import disturbances
from hexapods.domain.gait import NAMED_GAITS
from hexapods.domain.observation import OBSERVATIONS
from hexapods.domain.records import refusal_in
from hexapods.domain.robot import PRESETS
from hexapods.domain.settings import declared_fields
from hexapods.domain.text import MAX_NAME, MAX_TAG, NAMES, NOTES, TAGS
from hexapods.domain.world import MAX_DISTURBANCES, WORLDS
from hexapods.runs.clocks import CLOCKS
from hexapods.runs.config import SIMULATORS, TrainingConfig
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import BRANCH_STEPS, MAX_LANES
from hexapods.shows import show
from hexapods.shows.replay import HIGHEST_LEVEL, LOWEST_LEVEL

MAX_PAGE = 100
MAX_RUN_IDS = 100
"""Runs that a request may name in its query."""
MAX_SEARCH = MAX_NAME
MAX_CURSOR = 2000
"""Maximum length of a cursor: a name, of which each character takes up to 12, and an id."""


def one_of(names: Iterable[str]) -> str:
    """Return the words `one of`, followed by the valid names."""
    return f"one of {', '.join(names)}"


VALID: dict[str, str] = {
    **{name: setting.valid for name, setting in declared_fields(TrainingConfig).items()},
    **{name: setting.valid for name, setting in declared_fields(LaneConfig).items()},
    "name": NAMES,
    "gait": f"{one_of(NAMED_GAITS)}, or {{right_leg, left_leg, and symmetry, pairs or groups}}",
    "right_leg": "a leg's number, from 1 on",
    "left_leg": "a leg's number, from 1 on",
    "symmetry": "origin or vertical",
    "pairs": "a list of [leader, partner], two legs' numbers each",
    "groups": "a list of groups, each a list of legs' numbers, or the name of a rule",
    "observation": one_of(OBSERVATIONS),
    "robot": f"{one_of(PRESETS)}, or an object that says what differs from a preset or, by its "
    "id, from a stored robot",
    "simulator": one_of(SIMULATORS),
    "agent": "the name of an agent; GET /api/v1/options lists them",
    "continue_from": "the id of a training that is finished or stopped",
    "training_id": "the id of a training that is finished or stopped",
    "training": "an object: a training's body without what the race says already",
    "robots": f"a list, each {one_of(PRESETS)}, or an object that says what differs from one, or "
    "the id of a stored robot",
    "lanes": (
        f"a list of 1 to {MAX_LANES} lanes, each {{agent, and training_id, training or settings}}"
    ),
    "branch_from": "an object: race_id, and step, how many steps of that race are repeated",
    "race_id": "the id of a race",
    "branch_from.step": BRANCH_STEPS,
    "step": "a whole number, the steps that the run has taken at most",
    "lane": "a whole number, the number of a lane of the race, from 0 on",
    "cells": "a cell of the foot grid for each group of legs, from 0 on, such as 0,3,1",
    "first": "a whole number, the index of a state, from 0 on",
    "count": "a whole number, 1 or more",
    "world": f"the name of a world: {one_of(WORLDS)}",
    "worlds": (
        f"a list, each the name of a world, {one_of(WORLDS)}, or what happens, such as "
        "limp:legs=1,4"
    ),
    "disturbances": (
        f"a list of at most {MAX_DISTURBANCES}, each {{kind, at_step, until_step}} and the fields "
        f"of its kind: {', '.join(disturbances.KINDS)}"
    ),
    "run_id": "the id of a run",
    "id": f"the id of a run; up to {MAX_RUN_IDS} of them as id=…&id=…",
    "picture": "true or false",
    "ghost": "the id of another run of the same kind that has ended",
    "time_s": "a number of seconds, 0 or more",
    "playing": "true or false",
    "speed": f"a number from {show.MIN_SPEED} to {show.MAX_SPEED}, or {show.TIME_LAPSE}",
    "clock": one_of(CLOCKS),
    "kind": one_of(run_kinds()),
    "state": one_of(STATES),
    "search": (
        f"a part of the name, id, tags or notes, of at most {MAX_SEARCH} characters; A to Z match "
        "a to z"
    ),
    "tag": f"a tag, of at most {MAX_TAG} characters; A to Z match a to z",
    "tags": TAGS,
    "notes": NOTES,
    "sort": f"{one_of(SORTS)}: by time of creation, A to Z, or the longest first",
    "limit": f"a whole number from 1 to {MAX_PAGE}",
    "cursor": "the next_cursor of the page before",
    "idempotency-key": f"1 to {MAX_KEY_LENGTH} printable ASCII characters without spaces",
    "level": f"a whole number from {LOWEST_LEVEL} to {HIGHEST_LEVEL}",
    "number": "a whole number, 0 or more",
    "version": "the version of the plan, which makes a whole segment immutable",
    "settings": "an object with the agent's settings, by name",
    "format": "a format of the route",
}


def as_sentence(message: str) -> str:
    """Return the message of an error as a sentence."""
    return message[:1].upper() + message[1:] + ("" if message.endswith((".", "!")) else ".")


_NO_OBJECT = frozenset({"model_type", "model_attributes_type", "dict_type", "dataclass_type"})
"""Types of Pydantic's errors about a body that is no JSON object."""
_OF_OBJECTS = frozenset({"unknown_field", "says_all"})
"""Types of errors about an object, rather than about one of its fields."""


def field_errors(errors: Iterable[Mapping[str, Any]]) -> list[dict[str, str]]:
    """Convert Pydantic's errors to `field` and `detail`, one for each field.

    The invalid value is not quoted: it may be large, or not even JSON.
    """
    details: dict[str, str] = {}
    for error in errors:
        # `loc` also has the tags of unions, which are agents' names: keep only fields.
        fields = {*VALID, error.get("ctx", {}).get("name")}
        if error["type"] == "missing" or error["type"] in _OF_LENGTH:
            fields.add(error["loc"][-1])
        path = [key for key in error["loc"] if key in fields or isinstance(key, int)]
        if error["type"] == "json_invalid":
            path = []
        elif not any(isinstance(key, str) for key in path) and error["type"] not in _NO_OBJECT:
            # Of a record whose fields say by themselves what is valid, such as `choices`.
            path = [key for key in error["loc"][1:] if isinstance(key, str | int)]
            if error["type"] in _OF_OBJECTS and not any(isinstance(key, int) for key in path):
                path = []  # of the body, whose type has a tag
        field = ".".join(str(key) for key in path)
        refusal = refusal_in([error])
        detail = _sentence(field, error, path) if refusal is None else as_sentence(str(refusal))
        details.setdefault(field, detail)
    return [{"field": field, "detail": detail} for field, detail in details.items()]


def _sentence(field: str, error: Mapping[str, Any], path: list[Any]) -> str:
    names = [key for key in path if isinstance(key, str)]
    if error["type"] in _OF_OBJECTS:
        where = f"{field}: " if field else ""
        return f"{where}{error['msg']}."
    if error["type"] == "setting":
        return f"{field} {error['msg']}."
    if error["type"] == "json_invalid":
        return "The request's body is not valid JSON."
    if not names or (error["type"] in _NO_OBJECT and isinstance(path[-1], int)):
        where, how = (field, "") if names else ("The request's body", ", sent as application/json")
        return f"{where} must be a JSON object{how}."
    is_missing = error["type"] == "missing"
    valid = VALID.get(field) or VALID.get(names[-1])
    valid = _choices(error, valid) or valid or _length(error)
    if valid is None and not is_missing:
        is_unknown = error["type"] == "unexpected_keyword_argument"
        return f"{field}: {'there is no such field' if is_unknown else error['msg'].lower()}."
    valid = valid or "given"
    return f"{field} {'is missing; it ' if is_missing else ''}must be {valid}."


def _choices(error: Mapping[str, Any], valid: str | None) -> str | None:
    """Return the choices of a field in words, unless what is valid by its name has them all.

    Fields of the same name have other choices on other routes, such as `kind` and `format`.
    """
    if error["type"] != "literal_error":
        return None
    choices: str = error["ctx"]["expected"].replace("'", "")
    has_all = all(choice in (valid or "") for choice in re.split(r", | or ", choices))
    return None if has_all else choices


_OF_LENGTH = {"too_short": ("at least", "min_length"), "too_long": ("at most", "max_length")}


def _length(error: Mapping[str, Any]) -> str | None:
    """Return the valid length of a list, in words; None if the error is not about a length."""
    if error["type"] not in _OF_LENGTH:
        return None
    words, limit = _OF_LENGTH[error["type"]]
    length = error["ctx"][limit]
    return f"a list of {words} {length} value{'' if length == 1 else 's'}"
