"""Fixtures: the real app with real jobs, and a client that calls it as a local browser does."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import cache, partial
from pathlib import Path
from typing import Any

import pytest
from anyio.from_thread import start_blocking_portal
from starlette.testclient import TestClient

from app.api.deps import Services
from app.server import create_app
from app.settings import Settings
from app.storage.database.opening import open_store
from app.storage.run import NOT_ENDED
from tests.api.calls import ADDRESS, ENDLESS, Api, WholeAnswers
from tests.storage.stores import temporary_store


@pytest.fixture(scope="package")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("data")


@pytest.fixture(scope="package")
def api(data: Path) -> Iterator[Api]:
    """Return an API client of a server that the tests of this folder share."""
    with running(Settings(data=data, job_niceness=0)) as api:
        yield api


@pytest.fixture(autouse=True)
def _endless_trainings_are_stopped(request: pytest.FixtureRequest) -> Iterator[None]:
    """Fail a test that leaves one to those that share its server: it has a core to the end."""
    if "api" not in request.fixturenames:
        yield
        return
    api: Api = request.getfixturevalue("api")
    yield
    unended = [run for state in NOT_ENDED for run in api.services.store.list(state=state).runs]
    assert [run.id for run in unended if run.total == ENDLESS] == []


@contextmanager
def running(settings: Settings) -> Iterator[Api]:
    """Yield an API client of a server with its jobs."""
    with open_store(settings) as store:
        app = create_app(settings, store)
        with TestClient(app, base_url=ADDRESS) as client:
            client._transport = WholeAnswers(client)
            yield Api(client)


@pytest.fixture(scope="package")
def trained(api: Api) -> dict[str, Any]:
    """Return a finished training."""
    return api.finished(api.train(name="trained once"))


@pytest.fixture
def serve(data: Path) -> Iterator[Callable[..., Api]]:
    """Return a factory of servers with own settings; without lifespan, so that no jobs run."""
    with serving(data) as make:
        yield make


@pytest.fixture(scope="module")
def made_once(data: Path) -> Iterator[Callable[..., Api]]:
    with serving(data) as make:
        yield cache(partial(make, starts_per_minute=1_000_000))


@pytest.fixture
def shared(made_once: Callable[..., Api]) -> Iterator[Callable[..., Api]]:
    """Return a factory like `serve`, of one server per settings for the tests of a module.

    For tests that change nothing on the server, but may open rooms. It refuses no request for its
    rate.
    """
    used = dict[int, Api]()

    def make(**settings: Any) -> Api:
        api = made_once(**settings)
        used[id(api)] = api
        return api

    yield make
    for api in used.values():
        _close_rooms(api.client)


@contextmanager
def serving(data: Path) -> Iterator[Callable[..., Api]]:
    """Yield a factory of servers without lifespan, which all end with the context."""
    with ExitStack() as stack:

        def make(**settings: Any) -> Api:
            store = stack.enter_context(temporary_store())
            app = create_app(Settings(**{"data": data, "job_niceness": 0, **settings}), store)
            client = TestClient(app, base_url=ADDRESS, follow_redirects=False)
            # One event loop for all requests; by default each has a new one in a new thread.
            client.portal = stack.enter_context(start_blocking_portal())
            client._transport = WholeAnswers(client)
            stack.callback(_close, client)
            return Api(client)

        yield make


def _close(client: TestClient) -> None:
    """End what requests have opened, as the lifespan does: stages that draw, and pools."""
    _close_rooms(client)
    services = _services_of(client)
    for feature in services.features:
        feature.close()
    client.close()


def _close_rooms(client: TestClient) -> None:
    assert client.portal is not None
    for feature in _services_of(client).features:
        # By its name: a feature may be left out.
        if (stages := getattr(feature, "stages", None)) is not None:
            client.portal.call(stages.close_all)


def _services_of(client: TestClient) -> Services:
    app: Any = client.app
    services: Services = app.state.services
    return services
