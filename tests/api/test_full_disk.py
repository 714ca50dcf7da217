"""A full disk is noticed before a file is read that would not be stored anyway."""

from collections.abc import Iterator

import pytest

from app.settings import Settings
from tests.api.calls import Api, refused
from tests.api.conftest import running

BROKEN = b"PK\5\6 broken"
"""Neither an archive, nor a table, a robot or a lesson: one that is read is refused as such."""
QUOTA_MB = 10


@pytest.fixture(scope="module")
def full(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Api]:
    """Return an API client of a server whose quota is used up."""
    data = tmp_path_factory.mktemp("full")
    with running(Settings(data=data, quota_mb=QUOTA_MB)) as api:
        (data / "filler").write_bytes(bytes(QUOTA_MB * 1_000_000))
        yield api


def uploads(api: Api) -> list[tuple[str, str]]:
    """Return the operations that store a file, with a media type of it, from the API's document."""
    return [
        (path, media_type)
        for path, operations in api.client.get("/openapi.json").json()["paths"].items()
        for media_type in operations.get("post", {}).get("requestBody", {}).get("content", ())
        # A robot that is looked at is stored by another request.
        if media_type != "application/json" and path != "/api/v1/robots/readings"
    ]


@pytest.mark.promises
def test_uploads_are_refused_before_they_are_read(full: Api) -> None:
    paths = uploads(full)
    assert {"/api/v1/trainings/import"} <= {path for path, _ in paths}
    for path, media_type in [*paths, ("/api/v1/lessons", "application/json")]:
        answer = full.client.post(path, content=BROKEN, headers={"Content-Type": media_type})
        refused(answer, 507, "data folder")
