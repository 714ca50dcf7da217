"""Promise 16: no bad request gives a 5xx: 10,000 cases, with NaN, Infinity and deep JSON.

In full by `make soak`; the gate's shorter form has more than 200 cases that schemathesis makes out
of the API's own description, and all of those that no description leads to.
"""

import json
from collections.abc import Callable, Iterator
from typing import Any

import hypothesis
import pytest
import schemathesis
from hypothesis import HealthCheck, Phase
from schemathesis.generation import GenerationMode

from tests.api.calls import ADDRESS, WALK, Api
from tests.promises.length import at_length

CASES = at_length(200, 10_000)
ENDLESS = "/api/v1/events"
Serve = Callable[..., Api]

NUMBERS = ["NaN", "Infinity", "-Infinity", "1e999", "-0.0", "9" * 400, "9" * 5000, "1e-400", "0x10"]
DEEP = 100_000
ODD_BODIES = [
    b"",
    b"null",
    b"[]",
    b"0",
    b'"gait"',
    b"{",
    b'{"gait"',
    b"\xff\xfe{}",
    b"\xef\xbb\xbf{}",
    b"\x00",
    b"{}" * 1000,
    b"[" * DEEP,
    b"[" * DEEP + b"]" * DEEP,
    b'{"robot":' * DEEP + b"1" + b"}" * DEEP,
    b'{"lanes":[' * 1000 + b"]}" * 1000,
    b'{"gait":"\\ud800"}',
    b'{"name":"\\ud800\\u0000"}',
    b'{"gait":"left-right-origin","gait":{}}',
    b'{"\\ud800":1}',
    b'{"gait":{"right_leg":1,"left_leg":2,"pairs":' + b"[" * 500 + b"]" * 500 + b"}}",
    b'{"experiment":"sweep","alpha":' + b"[" * DEEP + b"]" * DEEP + b"}",
    b'{"experiment":"sweep","robots":[{"\\ud800":1}]}',
]
ODD_QUERIES = ["limit=NaN", "cursor=%00", "state=%ff", "limit=" + "9" * 5000, "format=%F0%9F%A4%96"]
ODD_HEADERS = [
    {"Accept": ",;q=,*/*;q=NaN"},
    {"Content-Type": "application/json; charset=none"},
    {"Content-Type": "multipart/form-data"},
    {"Last-Event-ID": "9" * 400},
    {"Idempotency-Key": "\x7f"},
    {"Cookie": "hexapods_operator=\xff"},
    {"Authorization": "Bearer"},
    {"If-None-Match": "W/" * 100},
    {"Range": "bytes=9-1,-"},
]


@pytest.fixture
def calm(serve: Serve) -> Api:
    """A server whose jobs never start, and that is never too much."""
    return serve(starts_per_minute=10**9)


def operations(api: Api) -> list[Any]:
    """All that the description has, but for the stream without an end."""
    schema: Any = schemathesis.openapi.from_dict(api.client.get("/openapi.json").json())
    found = [result.ok() for result in schema.get_all_operations()]
    return [operation for operation in found if operation.path != ENDLESS]


@pytest.mark.timeout(3600)
def test_of_what_the_description_leads_to(calm: Api) -> None:
    found = operations(calm)
    assert len(found) > 25
    failed: list[tuple[int, str]] = []
    count = 0

    def try_one(case: Any) -> None:
        nonlocal count
        count += 1
        answer = calm.client.request(**sendable(case))
        if answer.status_code >= 500 and case.path != "/readyz":
            failed.append((answer.status_code, case.as_curl_command()))

    for operation in found:
        for mode in (GenerationMode.POSITIVE, GenerationMode.NEGATIVE):
            run_cases(operation.as_strategy(generation_mode=mode), try_one, len(found))
    assert failed == [], count
    assert count >= CASES


def run_cases(strategy: Any, act: Callable[[Any], None], operations: int) -> None:
    # More than are wanted of each, since some operations have but a few that differ.
    most = max(2, at_length(1, 2) * CASES // operations)
    settings: Any = hypothesis.settings(
        max_examples=most,
        deadline=None,
        derandomize=True,
        database=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    given: Any = hypothesis.given(strategy)
    test: Callable[[], None] = settings(given(act))
    try:
        test()
    except hypothesis.errors.Unsatisfiable:
        # Some operations take nothing that could be wrong.
        return


def sendable(case: Any) -> dict[str, Any]:
    """The case as the test's client sends it."""
    request = case.as_transport_kwargs(base_url=ADDRESS)
    data = request.pop("data", None)
    if data is not None:
        request["content"] = data if isinstance(data, bytes | str) else json.dumps(data)
    wanted = ("method", "url", "params", "headers", "cookies", "content", "json")
    kept = {name: request[name] for name in wanted if request.get(name) is not None}
    kept["headers"] = {
        name: value
        for name, value in (kept.get("headers") or {}).items()
        if str(value).isprintable() and str(value).isascii()
    }
    kept.pop("cookies", None)
    return kept


def odd_requests(api: Api) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Bodies, numbers, queries and headers for every operation."""
    as_json = {"Content-Type": "application/json"}
    for operation in operations(api):
        method, path = operation.method.upper(), operation.path.replace("{run_id}", "none")
        for query in ODD_QUERIES:
            yield method, f"{path}?{query}", {}
        for headers in ODD_HEADERS:
            yield method, path, {"headers": {k: v.encode("latin-1") for k, v in headers.items()}}
        if method in ("POST", "PUT", "PATCH"):
            for body in ODD_BODIES:
                yield method, path, {"content": body, "headers": as_json}
    for path, said in odd_values():
        method = "PUT" if path.endswith("stage") else "POST"
        yield method, path, {"content": said, "headers": as_json}


def odd_values() -> Iterator[tuple[str, str]]:
    """Every odd number in the fields that take one."""
    for field in ("steps", "seed", "alpha", "grid_side_m", "pace", "divisions", "name", "robot"):
        for number in NUMBERS:
            yield "/api/v1/trainings", json.dumps(WALK)[:-1] + f', "{field}": {number}}}'
            leg = f'{{"gait": "left-right-origin", "robot": {{"{field}": {number}}}}}'
            yield "/api/v1/trainings", leg
    for field in (
        "seeds",
        "seed",
        "steps",
        "alpha",
        "divisions",
        "grid_side_m",
        "workers",
        "robots",
    ):
        for number in NUMBERS:
            for value in (number, f"[{number}]"):
                sweep = f'"experiment": "sweep", "gaits": ["hop"], "{field}": {value}'
                yield "/api/v1/experiments", f"{{{sweep}}}"
    for field in ("steps", "alpha", "divisions", "grid_side_m"):
        for number in NUMBERS:
            yield "/api/v1/what-if", f'{{"gait": "left-right-origin", "{field}": {number}}}'
    for field in ("time_s", "speed", "playing"):
        for number in NUMBERS:
            yield "/api/v1/stage", f'{{"{field}": {number}}}'


def test_of_what_nobody_would_describe(calm: Api) -> None:
    answers = [
        (calm.client.request(method, path, **more).status_code, method, path, str(more)[:200])
        for method, path, more in odd_requests(calm)
    ]
    assert len(answers) > 500
    assert [
        answer for answer in answers if answer[0] >= 500 and not answer[2].startswith("/readyz")
    ] == []
