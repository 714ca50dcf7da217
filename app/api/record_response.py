"""Responses that are records: what an endpoint returns is what its response model describes."""

from collections.abc import Callable, Mapping
from inspect import signature
from typing import Any, Generic, TypeVar, get_args, get_origin

from starlette.responses import Response

from hexapods.domain.records import to_json_bytes

R = TypeVar("R")


class RecordResponse(Response, Generic[R]):
    """JSON of a record. An endpoint that returns `RecordResponse[X]` has the response model `X`.

    The record is written in the thread of the endpoint. FastAPI, given the record itself, would
    validate it once more, in another thread, and write it on the event loop.
    """

    media_type = "application/json"

    def __init__(
        self, record: R, status_code: int = 200, headers: Mapping[str, str] | None = None
    ) -> None:
        """Write a record: a dataclass or a model of Pydantic."""
        super().__init__(to_json_bytes(record), status_code, headers)


def response_model(endpoint: Callable[..., Any]) -> Any:
    """Return `X` of an endpoint whose return type is, or has as an option, `RecordResponse[X]`."""
    returned = signature(endpoint).return_annotation
    for option in (returned, *get_args(returned)):
        if get_origin(option) is RecordResponse:
            return get_args(option)[0]
    return None
