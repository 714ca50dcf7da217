"""Field types and the base class of request bodies."""

import json
from collections.abc import Callable, Mapping
from typing import Annotated, Any, Literal

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    TypeAdapter,
    WithJsonSchema,
    model_validator,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import PydanticCustomError, core_schema

from app.api.descriptions import VALID
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.robot import AZIMUTH, MAX_LEGS, MIN_LEGS, MOUNT_RADIUS, PRESETS, RANGES
from hexapods.domain.settings import DeclaredSetting, declared_fields
from hexapods.domain.text import (
    MAX_NAME,
    MAX_NOTES,
    MAX_TAG,
    MAX_TAGS,
    NOTES_CONTROLS,
    TAG_SEPARATOR,
    check_name,
    check_notes,
    check_tags,
    invisible_ranges,
)
from hexapods.runs.config import TrainingConfig
from hexapods.runs.lane import LaneConfig
from hexapods.runs.race_config import MAX_ID, RaceConfig


def _checked_by(check: Callable[[Any], Any]) -> AfterValidator:
    """Return a validator by a function of the domain that returns the value as it is kept."""

    def validate(value: Any) -> Any:
        try:
            return check(value)
        except InvalidInput as error:
            raise ValueError(str(error)) from error

    return AfterValidator(validate)


def _add_pattern(schema: dict[str, Any]) -> None:
    """Add the pattern of visible text; deferred, as only the OpenAPI document needs it."""
    ranges = (f"{_escaped(first)}-{_escaped(last)}" for first, last in invisible_ranges())
    schema["pattern"] = f"^[^{''.join(ranges)}]*$"


def _add_tag_pattern(schema: dict[str, Any]) -> None:
    _add_pattern(schema)
    schema["pattern"] = schema["pattern"].replace("^[^", f"^[^{TAG_SEPARATOR}")


def _add_notes_pattern(schema: dict[str, Any]) -> None:
    _add_pattern(schema)
    allowed = "".join(_escaped(ord(one)) for one in NOTES_CONTROLS)
    schema["pattern"] = f"^({schema['pattern'][1:-2]}|[{allowed}])*$"


def _escaped(point: int) -> str:
    """Return a code point for a regular expression; above 16 bits no escape is portable."""
    return f"\\u{point:04x}" if point < 0x10000 else chr(point)


def number(**limits: Any) -> Any:
    """Return a field for a finite number within limits."""
    return Field(strict=True, allow_inf_nan=False, **limits)


class Declared:
    """Annotation: validate and describe a request's field by the declaration of a setting."""

    def __init__(self, setting: DeclaredSetting) -> None:
        self._setting = setting

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_plain_validator_function(self._validate)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        about = self._setting.about
        description = f"{about.help} It must be {self._setting.valid}.".lstrip()
        shape = TypeAdapter(self._setting.annotation).json_schema()
        return {**shape, "title": about.title, "description": description}

    def _validate(self, value: Any) -> Any:
        try:
            return self._setting.normalized(value)
        except InvalidInput as error:
            context = {"name": self._setting.name, "valid": self._setting.valid}
            raise PydanticCustomError("setting", "must be {valid}", context) from error


def _integral(value: Any) -> Any:
    """Convert an integral float to int, as JSON does not distinguish 2.0 from 2."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


INTEGRAL = BeforeValidator(_integral)
"""Accepts whole numbers written as floats; to be listed after the limits of a strict int."""
Name = Annotated[
    str,
    Field(
        max_length=MAX_NAME,
        description=VALID["name"],
        json_schema_extra=_add_pattern,
    ),
    _checked_by(check_name),
]
Tags = Annotated[
    list[Annotated[str, Field(max_length=MAX_TAG, json_schema_extra=_add_tag_pattern)]],
    Field(max_length=MAX_TAGS, description=VALID["tags"]),
    _checked_by(lambda tags: list(check_tags(tags))),
]
Notes = Annotated[
    str,
    Field(max_length=MAX_NOTES, description=VALID["notes"], json_schema_extra=_add_notes_pattern),
    _checked_by(check_notes),
]
RunId = Annotated[str, Field(min_length=1, max_length=MAX_ID)]

_TRAINING, _RACE = declared_fields(TrainingConfig), declared_fields(RaceConfig)
_LANE = declared_fields(LaneConfig)
Steps = Annotated[int, Declared(_TRAINING["steps"])]
RaceSteps = Annotated[int, Declared(_RACE["steps"])]
StepsPerEpisode = Annotated[int, Declared(_TRAINING["steps_per_episode"])]
EvaluateEvery = Annotated[int, Declared(_TRAINING["evaluate_every"])]
Seed = Annotated[int, Declared(_TRAINING["seed"])]
Divisions = Annotated[int, Declared(_TRAINING["divisions"])]
GridSide = Annotated[float, Declared(_TRAINING["grid_side_m"])]
Tolerance = Annotated[float, Declared(_TRAINING["tolerance"])]
KeepLearning = Annotated[bool, Declared(_LANE["keep_learning"])]
LaneObservation = Annotated[Any, Declared(_LANE["observation"])]
PlansWith = Annotated[Any, Declared(_LANE["plans_with"])]
Pace = Annotated[Literal["max"] | float, Declared(_TRAINING["pace"])]


def _numbers(ranges: dict[str, tuple[float, float]]) -> dict[str, Any]:
    return {
        name: {"type": "number", "minimum": low, "maximum": high}
        for name, (low, high) in ranges.items()
    }


_ROBOT_PARTS = {
    "preset": {"enum": list(PRESETS)},
    "n_legs": {"type": "integer", "minimum": MIN_LEGS, "maximum": MAX_LEGS, "multipleOf": 2},
    "legs": {
        "type": "array",
        "minItems": MIN_LEGS,
        "maxItems": MAX_LEGS,
        "items": {
            "type": "object",
            "properties": _numbers({"azimuth_deg": AZIMUTH, "radius_m": MOUNT_RADIUS}),
            "required": ["azimuth_deg"],
            "additionalProperties": False,
        },
    },
    **_numbers({"mount_radius_m": MOUNT_RADIUS, **RANGES}),
}
RobotBody = Annotated[
    str | dict[str, Any],
    # The domain validates the parts; the schema repeats its limits.
    WithJsonSchema(
        {
            "anyOf": [
                {"type": "string", "enum": list(PRESETS)},
                {
                    "type": "object",
                    "properties": _ROBOT_PARTS,
                    "additionalProperties": False,
                    "not": {
                        "required": ["legs"],
                        "anyOf": [{"required": ["n_legs"]}, {"required": ["mount_radius_m"]}],
                    },
                },
            ],
            "description": VALID["robot"],
            "examples": ["stiff"],
        }
    ),
]


class Body(BaseModel):
    """Base class of request bodies; rejects unknown fields and names the valid ones."""

    model_config = ConfigDict(extra="forbid")

    @model_validator(mode="before")
    @classmethod
    def _reject_unknown_fields(cls, value: Any) -> Any:
        unknown = [n for n in value if n not in cls.model_fields] if isinstance(value, dict) else []
        if unknown:
            message = _nested_form(cls, {name: value[name] for name in unknown}) or str(
                UnknownName("field", unknown[0][:MAX_NAME], cls.model_fields)
            )
            # Passed as a value, as a name with braces is no valid template.
            raise PydanticCustomError("unknown_field", "{message}", {"message": message})
        return value


class SettingsBody(Body):
    """Settings of an agent, by name; omitted ones take its defaults."""


def given_settings(body: SettingsBody) -> dict[str, Any]:
    """Return the settings that were given."""
    return {name: getattr(body, name) for name in body.model_fields_set}


def _nested_form(body: type[Body], unknown: Mapping[str, Any]) -> str | None:
    """Return where settings belong that were given as fields, as before 0.2; None if none were."""
    settings = body.model_fields.get("settings")
    kind = None if settings is None else settings.annotation
    if not (isinstance(kind, type) and issubclass(kind, SettingsBody)):
        return None
    flat = {name: value for name, value in unknown.items() if name in kind.model_fields}
    nested = json.dumps({"settings": flat})[1:-1][:500]
    return f"settings are a member of their own since 0.2: {nested}" if flat else None


class TaggedUnion:
    """Annotation: a union of body models, discriminated by a field of text.

    A body whose field names no model raises `UnknownName`.
    """

    def __init__(
        self, models: Mapping[str, type[Any]], field: str, noun: str, default: str | None = None
    ) -> None:
        """Create the union.

        Args:
            models: body model by value of the field.
            field: name of the field.
            noun: what it names, for the error.
            default: value of a body without the field; by default the first.
        """
        self._models, self._field, self._noun = models, field, noun
        self._default = default or next(iter(models))

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        choices = {name: handler.generate_schema(model) for name, model in self._models.items()}
        # The default model rejects a body that is no object or lacks a required field.
        return core_schema.tagged_union_schema(choices, discriminator=self._tag_of)

    def _tag_of(self, value: Any) -> str:
        is_object = isinstance(value, dict)
        tag = value.get(self._field) if is_object else getattr(value, self._field, None)
        if not isinstance(tag, str):
            return self._default
        if tag not in self._models:
            raise UnknownName(self._noun, tag[:MAX_NAME], self._models)
        return tag
