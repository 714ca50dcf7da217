"""Test client of the API, which can wait for a run's state."""

import time
from dataclasses import dataclass
from typing import Any

import httpx2
from httpx2 import ByteStream
from starlette.testclient import TestClient

from tests.timeouts import ProgressTimeout

ADDRESS = "http://127.0.0.1:8000"
WALK = {"gait": "left-right-origin", "simulator": "kinematic"}
ENDLESS = 10_000_000
"""Steps of a training that runs until it is stopped."""
ENDED = ("finished", "stopped", "failed", "interrupted")


class WholeAnswers(httpx2.BaseTransport):
    """Gets each answer of an app to its end in one call into the thread of its event loop.

    A `TestClient` makes eight, to have the beginning of an answer while the app still sends the
    rest.
    """

    def __init__(self, client: TestClient) -> None:
        """Wrap the transport of a client, which has a portal to its app's event loop."""
        assert client.portal is not None
        self._portal = client.portal
        self._app = httpx2.ASGITransport(client.app, client=("testclient", 50000))

    def handle_request(self, request: httpx2.Request) -> httpx2.Response:
        """Return the answer, with its body as it was sent."""
        request.read()
        return self._portal.call(self._answer, request)

    async def _answer(self, request: httpx2.Request) -> httpx2.Response:
        answer = await self._app.handle_async_request(request)
        assert isinstance(answer.stream, httpx2.AsyncByteStream)
        body = b"".join([chunk async for chunk in answer.stream])
        return httpx2.Response(answer.status_code, headers=answer.headers, stream=ByteStream(body))


@dataclass
class Api:
    """Calls under /api/v1."""

    client: TestClient

    @property
    def services(self) -> Any:
        """Services of the server."""
        app: Any = self.client.app
        return app.state.services

    def call(self, method: str, path: str, **options: Any) -> httpx2.Response:
        return self.client.request(method, f"/api/v1{path}", **options)

    def get(self, path: str, **options: Any) -> Any:
        response = self.call("GET", path, **options)
        assert response.status_code == 200, response.text
        return response.json()

    def start(self, path: str, body: Any) -> dict[str, Any]:
        response = self.call("POST", path, json=body)
        assert response.status_code == 202, response.text
        run: dict[str, Any] = response.json()
        assert response.headers["location"] == f"/api/v1{path}/{run['id']}"
        return run

    def train(self, **options: Any) -> dict[str, Any]:
        return self.start("/trainings", {**WALK, "steps": 100, **options})

    def race(self, **options: Any) -> dict[str, Any]:
        return self.start("/races", {**WALK, **options})

    def slow_training(self, **options: Any) -> dict[str, Any]:
        """Start a training that runs until it is stopped."""
        run = self.train(steps=ENDLESS, pace=20, evaluate_every=0, **options)
        return self.until(run, lambda now: now["progress"]["done"] > 0)

    def look(self, run: dict[str, Any]) -> dict[str, Any]:
        shown: dict[str, Any] = self.get(f"/{run['kind']}s/{run['id']}")
        return shown

    def until(self, run: dict[str, Any], condition: Any) -> dict[str, Any]:
        stall_check = ProgressTimeout()
        while not condition(now := self.look(run)):
            assert now["state"] not in ENDED, now
            stall_check.check(now)
            time.sleep(0.03)
        return now

    def ended(self, run: dict[str, Any]) -> dict[str, Any]:
        return self.until(run, lambda now: now["state"] in ENDED)

    def finished(self, run: dict[str, Any]) -> dict[str, Any]:
        now = self.ended(run)
        assert now["state"] == "finished", now
        return now

    def tell(self, run: dict[str, Any], verb: str) -> httpx2.Response:
        return self.call("POST", f"/{run['kind']}s/{run['id']}/{verb}")

    def stop(self, *runs: dict[str, Any]) -> None:
        """Stop runs, with the trainings that they wait for, and wait until all have ended."""
        for run in runs:
            self.tell(run, "stop")
        waiting_for = [
            self.get(f"/trainings/{i}") for run in runs for i in run.get("waiting_for", [])
        ]
        for run in (*runs, *waiting_for):
            self.ended(run)


def refused(response: httpx2.Response, status: int, *words: str) -> dict[str, Any]:
    """Check that a response is a problem document whose detail has these words."""
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == "application/problem+json"
    problem: dict[str, Any] = response.json()
    assert {"type", "title", "status", "detail"} <= set(problem)
    assert problem["status"] == status
    assert "Traceback" not in response.text
    for word in words:
        assert word in problem["detail"]
    return problem
