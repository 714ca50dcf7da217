"""Each error class is mapped to its HTTP status and headers, with its message as the detail."""

import asyncio
import json

import pytest
from starlette.requests import Request

from app.api.problems import hexapod_error
from app.storage.errors import Busy, Conflict, NotFound, StorageFailed, StorageFull
from hexapods.domain.errors import DamagedFile, HexapodError, InvalidInput


@pytest.mark.parametrize(
    ("error", "status", "headers"),
    [
        (InvalidInput("choose another"), 422, {}),
        (DamagedFile("it is damaged"), 422, {}),
        (NotFound("there is none"), 404, {}),
        (Conflict("it runs", "running"), 409, {}),
        (Busy("wait", 7), 429, {"retry-after": "7"}),
        (StorageFull("the disk is full; make room"), 507, {}),
        (StorageFailed("the database is held"), 503, {"retry-after": "10"}),
        (HexapodError("killed"), 500, {}),
    ],
    ids=lambda value: type(value).__name__,
)
def test_error_is_mapped_to_its_status(
    error: HexapodError, status: int, headers: dict[str, str]
) -> None:
    request = Request({"type": "http", "method": "GET", "path": "/", "headers": []})
    response = asyncio.run(hexapod_error(request, error))
    assert response.status_code == status
    assert response.headers["content-type"] == "application/problem+json"
    assert headers.items() <= dict(response.headers).items()
    if status != 500:
        detail = json.loads(bytes(response.body))["detail"]
        assert detail == f"{str(error)[:1].upper()}{str(error)[1:]}."
