"""Records as JSON: a dataclass is declared once, and what reads, writes and describes it follows.

Requests, answers, the OpenAPI document, the database, archives and files all use the dataclass, by
Pydantic. A type with another form in JSON, such as a robot, declares it by a `JsonForm`.
"""

import inspect
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache, partial
from typing import Any, ClassVar, TypeVar

from hexapods.domain.errors import InvalidInput
from hexapods.domain.json_lists import check_lists

T = TypeVar("T")
Schema = dict[str, Any]


def refusal_in(errors: Iterable[Mapping[str, Any]]) -> InvalidInput | None:
    """Return the first `InvalidInput` among Pydantic's errors, None if there is none.

    Pydantic keeps every `ValueError` that a function raises in its list of errors. The user gets an
    `InvalidInput` as it was raised.

    Args:
        errors: as Pydantic's `errors()` returns them, with their context.
    """
    causes = (error.get("ctx", {}).get("error") for error in errors)
    return next((cause for cause in causes if isinstance(cause, InvalidInput)), None)


class Record:
    """Base class of dataclasses that are sent and stored as JSON objects of exactly their fields.

    Their docstrings describe them and their fields in the OpenAPI document.

    Attributes:
        json_names: names in JSON of the fields that have another name there.
    """

    # Pydantic reads it; Pydantic is imported only where a record is read or written.
    __pydantic_config__: ClassVar[Mapping[str, Any]] = {
        "extra": "forbid",
        "json_schema_serialization_defaults_required": True,
    }
    json_names: ClassVar[Mapping[str, str]] = {}

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Any) -> Any:
        schema, attributes = handler(source), described_attributes(source)
        about = {"description": summary_of(source)}
        schema.setdefault("metadata", {})["pydantic_js_updates"] = about
        for field in schema["schema"]["fields"]:
            describe = partial(_described, attributes.get(field["name"], ""))
            metadata = field.setdefault("metadata", {})
            metadata.setdefault("pydantic_js_annotation_functions", []).append(describe)
            if field["name"] in cls.json_names:
                name = cls.json_names[field["name"]]
                field |= {"validation_alias": name, "serialization_alias": name}
        return schema


def _described(about: str, schema: Any, schema_of: Any) -> Schema:
    """Return the JSON schema of a field, described unless its type is."""
    shape = dict(schema_of(schema))
    if schema_of.mode == "serialization":
        shape.pop("default", None)  # all fields are written
    return {"description": about, **shape} if about and "$ref" not in shape else shape


def summary_of(record: type) -> str:
    """Return the beginning of a class's docstring, without its sections."""
    about = inspect.cleandoc(record.__doc__ or "")
    return re.split(r"\n\n(?:Attributes|Raises):\n", f"\n\n{about}", maxsplit=1)[0].strip()


def described_attributes(record: type) -> dict[str, str]:
    """Return the descriptions of attributes in the docstrings of a class and its bases, by name."""
    descriptions: dict[str, str] = {}
    for base in reversed(record.__mro__):
        about = inspect.cleandoc(vars(base).get("__doc__") or "")
        section = about.partition("Attributes:\n")[2].partition("\n\n")[0]
        for item in re.split(r"^    (?=\S)", section, flags=re.MULTILINE)[1:]:
            names, _, text = item.partition(":")
            # A field that is None in Python is null in JSON.
            text = re.sub(r"\bNone\b", "null", " ".join(text.split()))
            descriptions |= dict.fromkeys(names.split(", "), text)
    return descriptions


@dataclass(frozen=True, eq=False)
class JsonForm:
    """Annotation: how a type is read from JSON, written and described.

    Attributes:
        read: converts input; it raises `InvalidInput` for invalid input.
        write: converts to plain types.
        input_schema: JSON schema of valid input, or a function that returns it.
        output_schema: JSON schema of what is written; None if it is `input_schema`.
        takes_context: whether `read` and `write` take the context of `from_json` and `to_json` as
            their second argument; None where there is none.
    """

    read: Callable[..., Any]
    write: Callable[..., Any]
    input_schema: Schema | Callable[[], Schema]
    output_schema: Schema | None = None
    takes_context: bool = False

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        def describe(_: Any, schema_of: Any) -> Schema:
            if schema_of.mode == "serialization" and self.output_schema is not None:
                return dict(self.output_schema)
            schema = self.input_schema
            return dict(schema() if callable(schema) else schema)

        return plain_form(self.read, self.write, describe, takes_context=self.takes_context)


def plain_form(
    read: Callable[..., Any],
    write: Callable[..., Any],
    describe: Callable[[Any, Any], Schema],
    takes_context: bool = False,
) -> Any:
    """Return Pydantic's schema of a type that is read and written by functions.

    Args:
        read: converts input.
        write: converts to plain types.
        describe: returns the JSON schema, as Pydantic's `pydantic_js_functions` do.
        takes_context: whether `read` and `write` take Pydantic's context as second argument.
    """
    from pydantic_core import core_schema  # noqa: PLC0415 - as in `_adapter`

    about = {"pydantic_js_functions": [describe]}
    if not takes_context:
        writer = core_schema.plain_serializer_function_ser_schema(write)
        return core_schema.no_info_plain_validator_function(
            read, serialization=writer, metadata=about
        )
    return core_schema.with_info_plain_validator_function(
        lambda value, info: read(value, info.context),
        serialization=core_schema.plain_serializer_function_ser_schema(
            lambda value, info: write(value, info.context), info_arg=True
        ),
        metadata=about,
    )


def to_json(record: Any, context: Any = None) -> dict[str, Any]:
    """Convert a record to plain types, as in requests, answers, the database and files.

    Args:
        record: the record.
        context: argument of the forms of its fields that take a context; see `JsonForm`.
    """
    adapter = _adapter(type(record))  # type: ignore[arg-type]  # mypy: no hash
    plain: dict[str, Any] = adapter.dump_python(record, mode="json", by_alias=True, context=context)
    return plain


def to_json_bytes(record: Any) -> bytes:
    """Write a record as JSON; NaN and infinities, which JSON lacks, as null."""
    adapter = _adapter(type(record))  # type: ignore[arg-type]  # mypy: no hash
    written: bytes = adapter.dump_json(record, by_alias=True)
    return written


def from_json(kind: type[T], data: Any, **how: Any) -> T:
    """Parse the output of `to_json`; fields with defaults may be left out.

    Args:
        kind: class of the record.
        data: plain types, or bytes of JSON.
        how: arguments for Pydantic, such as `strict=True`, or the `context` of fields' forms.

    Raises:
        InvalidInput: if a value is invalid.
        ValueError: if the structure is not that of the output of `to_json`, or bytes have too many
            lists and objects.
    """
    if isinstance(data, bytes):
        check_lists(data)
    from pydantic import ValidationError  # noqa: PLC0415 - as in `_adapter`

    adapter = _adapter(kind)  # type: ignore[arg-type]  # mypy: no hash
    read = adapter.validate_json if isinstance(data, bytes) else adapter.validate_python
    try:
        record: T = read(data, **how)
    except ValidationError as error:
        errors = error.errors(include_url=False, include_input=False)
        if (refusal := refusal_in(errors)) is not None:
            raise refusal from refusal.__cause__
        first = errors[0]
        raise ValueError(f"{'.'.join(map(str, first['loc']))}: {first['msg']}") from None
    return record


def check_kept(record: T, context: Any = None) -> T:
    """Return a record unless it cannot be saved and read again; to be called before it is used.

    Args:
        record: the record.
        context: for `to_json` and then for `from_json`.

    Raises:
        InvalidInput: if it cannot, before results are computed that could not be saved with it.
    """
    try:
        read = from_json(type(record), to_json(record, context), context=context)
    except InvalidInput:
        raise
    except Exception as error:  # of functions that convert values of agents and robots
        raise InvalidInput(f"it could not be saved: {error}") from error
    if read != record:
        raise InvalidInput("it could not be saved: a file of it would be read as something else")
    return record


@cache
def _adapter(kind: Any) -> Any:
    # Its import takes 0.2 s, which most uses of the library need not wait for.
    from pydantic import TypeAdapter  # noqa: PLC0415

    return TypeAdapter(kind)
