"""The real app with its real jobs; a client that calls it as a browser on this machine would."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from app.server import create_app
from app.settings import Settings
from app.storage.database.opening import open_store
from tests.api.calls import ADDRESS, Api
from tests.storage.stores import temporary_store


@pytest.fixture(scope="package")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("data")


@pytest.fixture(scope="package")
def api(data: Path) -> Iterator[Api]:
    """One server for all tests of this folder that do not mind each other's runs."""
    settings = Settings(data=data, job_niceness=0)
    with open_store(settings) as store:
        app = create_app(settings, store)
        with TestClient(app, base_url=ADDRESS) as client:
            yield Api(client)


@pytest.fixture(scope="package")
def trained(api: Api) -> dict[str, Any]:
    """A training that is finished."""
    return api.finished(api.train(name="trained once"))


@pytest.fixture
def serve(data: Path) -> Iterator[Callable[..., Api]]:
    """A server of a test's own, with settings of its own; without its lifespan, so no jobs run."""
    with ExitStack() as stack:

        def make(**settings: Any) -> Api:
            store = stack.enter_context(temporary_store())
            app = create_app(Settings(**{"data": data, "job_niceness": 0, **settings}), store)
            client = TestClient(app, base_url=ADDRESS, follow_redirects=False)
            stack.callback(client.close)
            return Api(client)

        yield make
