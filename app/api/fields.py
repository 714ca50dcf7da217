"""Field types and the base class of request bodies."""

import json
from collections.abc import Callable, Collection, Mapping
from dataclasses import MISSING, fields, is_dataclass
from typing import (
    Annotated,
    Any,
    Optional,
    Self,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ModelWrapValidatorHandler,
    Tag,
    TypeAdapter,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_validator,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError, core_schema
from pydantic_core.core_schema import ErrorType

from app.api.descriptions import VALID
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.settings import DeclaredSetting, declare
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
from hexapods.runs.race_config import MAX_ID


def _checked_by(check: Callable[[Any], Any]) -> AfterValidator:
    """Return a validator by a function of the domain that returns the value as it is kept."""

    def validate(value: Any) -> Any:
        try:
            return check(value)
        except InvalidInput as error:
            raise ValueError(str(error)) from error

    return AfterValidator(validate)


def taken_by(check: Callable[[Any], object]) -> AfterValidator:
    """Return a validator of values that a function of the domain takes, with its error."""

    def validate(value: Any) -> Any:
        check(value)
        return value

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
    allowed = "".join(_escaped(ord(character)) for character in NOTES_CONTROLS)
    schema["pattern"] = f"^({schema['pattern'][1:-2]}|[{allowed}])*$"


def _escaped(point: int) -> str:
    """Return a code point for a regular expression; above 16 bits no escape is portable."""
    return f"\\u{point:04x}" if point < 0x10000 else chr(point)


def number(**limits: Any) -> Any:
    """Return a field for a finite number within limits."""
    return Field(strict=True, allow_inf_nan=False, **limits)


class Declared:
    """Annotation: validate and describe a request's field by the declaration of a setting.

    With `is_text` its value is text, as in the query of an address.
    """

    def __init__(self, setting: DeclaredSetting, is_text: bool = False) -> None:
        self._setting, self._is_text = setting, is_text

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
            if self._is_text and isinstance(value, str):
                return self._setting.parse(value)
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

T = TypeVar("T")
MAX_VALUES = 100


def _as_list(value: Any) -> Any:
    return value if isinstance(value, list) or value is None else [value]


class _ItemOrList:
    """Adds to the JSON schema that a single item is accepted in place of a list."""

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        kinds = handler(schema)["anyOf"]
        return {"anyOf": [kinds[0]["items"], *kinds]}


OneOrMore = Annotated[
    Annotated[
        list[T], Field(min_length=1, max_length=MAX_VALUES, json_schema_extra={"uniqueItems": True})
    ]
    | None,
    BeforeValidator(_as_list),
    _ItemOrList(),
]
"""A list of 1 to `MAX_VALUES` values; a single value is converted to a list."""


def record_fields(
    record: type, without: Collection[str] = (), optional: Collection[str] = ()
) -> dict[str, Any]:
    """Return fields of a record as those of a request's body, for `create_model`.

    Args:
        record: the dataclass; where it has a tuple, a body may have one value or a list.
        without: names of fields that are left out.
        optional: names of fields whose default is None, whatever it is in the record.
    """
    hints = get_type_hints(record, include_extras=True)
    types: dict[str, Any] = {}
    for field in fields(record):
        if field.name in without:
            continue
        hint, default = hints[field.name], ... if field.default is MISSING else field.default
        if field.default_factory is not MISSING:
            default = field.default_factory()
        if get_origin(hint) is tuple:
            shape, default = OneOrMore[_shape(field.name, get_args(hint)[0])], None  # type: ignore[misc]
        else:
            shape = _shape(field.name, hint)
        if field.name in optional:
            default = None
            if type(None) not in get_args(hint):
                shape = Optional[shape]  # noqa: UP045  # of a type made here
        about = Field(
            description=VALID.get(field.name), json_schema_extra=_default_in_json(hint, default)
        )
        types[field.name] = (Annotated[shape, about], default)
    return types


def _default_in_json(hint: Any, default: Any) -> dict[str, Any] | None:
    """Return a default as requests have it, for one that is a record; None for plain values."""
    if not is_dataclass(default):
        return None
    return {"default": TypeAdapter(hint).dump_python(default, mode="json")}


def _shape(name: str, annotation: Any) -> Any:
    """Return the type of a field: of a declared setting with its limits and its error."""
    try:
        return Annotated[Any, Declared(declare(name, annotation))]
    except TypeError:  # it is none
        return annotation


class Body(BaseModel):
    """Base class of request bodies; rejects unknown fields and names the valid ones."""

    model_config = ConfigDict(extra="forbid")

    @model_validator(mode="wrap")
    @classmethod
    def _reject_unknown_fields(cls, value: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        # Looked up once: a body may have a hundred thousand names, and Pydantic's lookup is slow.
        valid = cls.model_fields
        unknown = [name for name in value if name not in valid] if isinstance(value, dict) else []
        if not unknown:
            return handler(value)
        message = _nested_form(cls, {name: value[name] for name in unknown}) or str(
            UnknownName("field", unknown[0][:MAX_NAME], valid)
        )
        known = {name: value[name] for name in value if name in valid}
        raise _all_errors(_unknown_field(message), lambda: handler(known))


def known_members(record: Any) -> WrapValidator:
    """Return a validator of members of a body that are records: names the first unknown member.

    Pydantic alone would tell of each, of which a body may have a hundred thousand.
    """
    valid = [field.name for field in fields(record)]

    def check(value: Any, handler: ValidatorFunctionWrapHandler) -> Any:
        unknown = [name for name in value if name not in valid] if isinstance(value, dict) else []
        if not unknown:
            return handler(value)
        message = str(UnknownName("field", unknown[0][:MAX_NAME], valid))
        known = {name: value[name] for name in value if name in valid}
        raise _all_errors(_unknown_field(message), lambda: handler(known))

    return WrapValidator(check)


def _unknown_field(message: str) -> InitErrorDetails:
    # Passed as a value, as a name with braces is no valid template.
    error = PydanticCustomError("unknown_field", "{message}", {"message": message})
    return InitErrorDetails(type=error, loc=(), input=None)


def _all_errors(
    error: InitErrorDetails, validate: Callable[[], Any], without: str | None = None
) -> ValidationError:
    """Return an error of an object together with those of its other fields.

    Args:
        error: the error.
        validate: validates the other fields.
        without: name of a field whose errors are left out, with those of its members.
    """
    title, errors = "", [error]
    try:
        validate()
    except ValidationError as others:
        title = others.title
        errors += [_again(other) for other in others.errors() if without not in other["loc"]]
    return ValidationError.from_exception_data(title, errors)


def _again(error: ErrorDetails) -> InitErrorDetails:
    """Return an error as it is given to Pydantic, from how it tells of it."""
    context = error.get("ctx")
    kind: PydanticCustomError | str = error["type"]
    if error["type"] not in get_args(ErrorType):
        message = {**(context or {}), "message": error["msg"]}
        kind, context = PydanticCustomError(error["type"], "{message}", message), None
    again = InitErrorDetails(type=kind, loc=error["loc"], input=None)
    return again if context is None else {**again, "ctx": context}


class SettingsBody(Body):
    """Settings of an agent, by name; omitted ones take its defaults."""


def given_settings(body: SettingsBody) -> dict[str, Any]:
    """Return the settings that were given."""
    return {name: getattr(body, name) for name in body.model_fields_set}


def _nested_form(body: type[Body], unknown: Mapping[str, Any]) -> str | None:
    """Return the error of settings that are given as fields, with their place; None if none are."""
    settings = body.model_fields.get("settings")
    kind = None if settings is None else settings.annotation
    if not (isinstance(kind, type) and issubclass(kind, SettingsBody)):
        return None
    valid = kind.model_fields
    flat = {name: value for name, value in unknown.items() if name in valid}
    nested = json.dumps({"settings": flat})[1:-1][:500]
    return f"the settings of an agent are a member of their own: {nested}" if flat else None


def one_of(models: Mapping[str, type[Any]], tag_of: Callable[[Any], str]) -> Any:
    """Return the type of a body of one of several models, which `tag_of` names."""
    tagged = tuple(Annotated[model, Tag(name)] for name, model in models.items())
    return Annotated[Union[tagged], Discriminator(tag_of)]  # noqa: UP007 - of types made here


def named_in(
    models: Mapping[str, type[BaseModel]], field: str, noun: str, default: str | None = None
) -> Any:
    """Return the type of a body of one of several models, which a field of text names.

    Args:
        models: body model by value of the field; another value is an `UnknownName`, which is
            answered with the errors of the other fields but `settings`.
        field: name of the field.
        noun: what it names, for the error.
        default: value of a body without the field; by default the first.
    """
    most_fields = max(models, key=lambda name: len(models[name].model_fields))

    def tag_of(value: Any) -> str:
        tag = value.get(field) if isinstance(value, dict) else getattr(value, field, None)
        # The default's model rejects a body that is no object, or lacks a required field.
        return tag if isinstance(tag, str) else default or next(iter(models))

    def check_name(value: Any, handler: ValidatorFunctionWrapHandler) -> Any:
        name = value.get(field) if isinstance(value, dict) else None
        if isinstance(name, str):
            if name in models:
                return handler(value)
            error = InitErrorDetails(
                type="value_error",
                loc=(field,),
                input=None,
                ctx={"error": UnknownName(noun, name[:MAX_NAME], models)},
            )
        elif isinstance(value, dict) and field in value:
            error = InitErrorDetails(
                type="literal_error", loc=(field,), input=None, ctx={"expected": ", ".join(models)}
            )
        else:
            return handler(value)
        # What settings there are depends on the name; the other fields are those of most models.
        others = {**value, field: most_fields}
        raise _all_errors(error, lambda: handler(others), without="settings")

    return Annotated[one_of(models, tag_of), WrapValidator(check_name)]
