"""A class of clients with cookies of their own, on a server with real jobs."""

from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import httpx2
import pytest
from starlette.testclient import TestClient

from app.api.deps import Services
from app.server import create_app
from app.settings import Settings
from app.storage.database.opening import open_store
from tests.api.calls import ADDRESS, Api

TOKEN = "a-token-for-tests"
FORM = {"gait": "left-right-origin", "simulator": "kinematic", "steps": 60, "evaluate_every": 20}
LESSON: dict[str, Any] = {
    "title": "A short lesson",
    "aims": ["Learn to wait"],
    "cards": [
        {"title": "Look", "text": "Only look."},
        {
            "title": "Guess",
            "text": "How far?",
            "state": {"form": FORM},
            "ask": {"kind": "number", "text": "How far?", "minimum": -1, "maximum": 2, "unit": "m"},
            "go": "training",
            "may": {"alpha": {"minimum": 0.1, "maximum": 0.5}, "steps": {"maximum": 80}},
            "reveal": {"text": "So far."},
        },
        {
            "title": "Race",
            "text": "Who wins?",
            "state": {"form": {**FORM, "lanes": ["q-learning", "greedy"], "race_steps": 5}},
            "ask": {"kind": "choice", "text": "Who?", "choices": ["q-learning", "greedy"]},
            "go": "race",
        },
        {"text": "What if?", "state": {"form": {"steps": 20}}, "go": "what-if"},
        {"text": "Where?", "ask": {"kind": "point", "text": "Where on the chart?"}},
        {"text": "Draw", "ask": {"kind": "curve", "text": "Draw it."}},
    ],
}


class Class:
    """A server with a token, its teacher, and as many pupils as join.

    Attributes:
        teacher: an operator.
    """

    def __init__(self, client: TestClient, stack: ExitStack) -> None:
        self._client, self._stack = client, stack
        self.teacher = Api(client)
        client.headers["Authorization"] = f"Bearer {TOKEN}"

    @property
    def services(self) -> Services:
        """The services of the server."""
        services: Services = self._client.app.state.services  # type: ignore[attr-defined]
        return services

    def pupil(self) -> Api:
        """Return a client without any cookie."""
        client = TestClient(self._client.app, base_url=ADDRESS, follow_redirects=False)
        client.portal = self._client.portal
        client.headers["X-Requested-With"] = "tests"
        self._stack.callback(client.close)
        return Api(client)

    def room(self, lesson: Any = LESSON, *, is_further: bool = False, **options: Any) -> str:
        """Open a room, after the end of those before unless it is a further one."""
        for room in [] if is_further else self.teacher.get("/rooms")["items"]:
            self.teacher.call("POST", f"/rooms/{room['code']}/end")
        answer = self.teacher.call("POST", "/rooms", json={"lesson": lesson, **options})
        assert answer.status_code == 201, answer.text
        return str(answer.json()["code"])

    def joined(self, code: str) -> Api:
        api = self.pupil()
        answer = api.call("POST", f"/rooms/{code}/participants")
        assert answer.status_code == 201, answer.text
        return api

    def show(self, code: str, card: int) -> None:
        answer = self.teacher.call("PUT", f"/rooms/{code}/card", json={"card": card})
        assert answer.status_code == 200, answer.text

    def finished(self, run: dict[str, Any]) -> dict[str, Any]:
        return self.teacher.finished(run)


@pytest.fixture(scope="module")
def school(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Class]:
    settings = Settings(data=tmp_path_factory.mktemp("school"), job_niceness=0, token=TOKEN)
    with ExitStack() as stack:
        store = stack.enter_context(open_store(settings))
        client = TestClient(create_app(settings, store), base_url=ADDRESS, follow_redirects=False)
        yield Class(stack.enter_context(client), stack)


def started(answer: httpx2.Response) -> dict[str, Any]:
    assert answer.status_code == 202, answer.text
    run: dict[str, Any] = answer.json()
    return run
