"""Promise 16: no bad request gives a 5xx: 10,000 cases, with NaN, Infinity and deep JSON.

The gate has the hand-written malformed ones, for each operation every third of those that fit all;
generated ones, from the API's OpenAPI schema, are among those of promise 34 there, and 10,000 by
`make soak`.
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
from tests.promises.length import at_length, only_whole

pytestmark = pytest.mark.test

CASES = 10_000
EVERY = at_length(3, 1)
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
    b'{"experiment":"sweep","settings":{"alpha":' + b"[" * DEEP + b"]" * DEEP + b"}}",
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
def unlimited_api(serve: Serve) -> Api:
    """The API of a server whose jobs never start, without a rate limit."""
    return serve(starts_per_minute=10**9)


def operations(api: Api) -> list[Any]:
    """Return all operations of the OpenAPI schema but the endless event stream."""
    contract = api.client.get("/openapi.json").json()
    schema: Any = schemathesis.openapi.from_dict(contract)
    parsed = [result.ok() for result in schema.get_all_operations()]
    return [operation for operation in parsed if operation.path != ENDLESS]


@only_whole
@pytest.mark.timeout(3600)
def test_generated_requests_give_no_5xx(unlimited_api: Api) -> None:
    all_operations = operations(unlimited_api)
    assert len(all_operations) > 25
    failed: list[tuple[int, str]] = []
    count = 0

    def try_one(case: Any) -> None:
        nonlocal count
        count += 1
        answer = unlimited_api.client.request(**sendable(case))
        if answer.status_code >= 500 and case.path != "/readyz":
            failed.append((answer.status_code, case.as_curl_command()))

    for operation in all_operations:
        for mode in modes_of(operation):
            run_cases(operation.as_strategy(generation_mode=mode), try_one, len(all_operations))
    assert failed == [], count
    assert count >= CASES


def modes_of(operation: Any) -> list[GenerationMode]:
    """Return the modes that have cases: of a path alone, no value is invalid."""
    inner_parameters = [
        parameter for parameter in operation.iter_parameters() if parameter.location != "path"
    ]
    may_be_invalid = bool(inner_parameters or operation.body)
    return [GenerationMode.POSITIVE, *[GenerationMode.NEGATIVE] * may_be_invalid]


def run_cases(strategy: Any, act: Callable[[Any], None], operations: int) -> None:
    # More than needed of each, since some operations have only a few distinct cases.
    most = max(2, 2 * CASES // operations)
    settings: Any = hypothesis.settings(
        max_examples=most,
        deadline=None,
        derandomize=True,
        database=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    decorate: Any = hypothesis.given(strategy)
    test: Callable[[], None] = settings(decorate(act))
    try:
        test()
    except hypothesis.errors.Unsatisfiable:
        # Operations without parameters have no negative cases.
        return


def sendable(case: Any) -> dict[str, Any]:
    """Return a case as arguments of the test client's `request`."""
    request = case.as_transport_kwargs(base_url=ADDRESS)
    data = request.pop("data", None)
    if data is not None:
        request["content"] = data if isinstance(data, bytes | str) else json.dumps(data)
    wanted = ("method", "url", "params", "headers", "cookies", "content", "json")
    sent = {name: request[name] for name in wanted if request.get(name) is not None}
    sent["headers"] = {
        name: value
        for name, value in (sent.get("headers") or {}).items()
        if str(value).isprintable() and str(value).isascii()
    }
    sent.pop("cookies", None)
    return sent


def odd_requests(api: Api) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Yield malformed requests for every operation: method, path and arguments."""
    as_json = {"Content-Type": "application/json"}
    paths = api.client.get("/openapi.json").json()["paths"]
    operations = [
        (method, path) for path, item in paths.items() for method in item if path != ENDLESS
    ]
    for number, (method, path) in enumerate(
        (m.upper(), p.replace("{run_id}", "none")) for m, p in operations
    ):
        # Each operation begins with another one, so that each of them meets many operations.
        some = slice(number % EVERY, None, EVERY)
        for query in ODD_QUERIES[some]:
            yield method, f"{path}?{query}", {}
        for headers in ODD_HEADERS[some]:
            yield method, path, {"headers": {k: v.encode("latin-1") for k, v in headers.items()}}
        if method in ("POST", "PUT", "PATCH"):
            for body in ODD_BODIES[some]:
                yield method, path, {"content": body, "headers": as_json}
    for path, content in odd_values():
        method = "PUT" if path.endswith("stage") else "POST"
        yield method, path, {"content": content, "headers": as_json}


def odd_values() -> Iterator[tuple[str, str]]:
    """Yield path and body with every odd number in each numeric field."""
    for field in ("steps", "seed", "alpha", "grid_side_m", "pace", "divisions", "name", "robot"):
        for number in NUMBERS:
            yield "/api/v1/trainings", json.dumps(WALK)[:-1] + f", {_field(field, number)}}}"
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
                sweep = f'"experiment": "sweep", "gaits": ["hop"], {_field(field, value)}'
                yield "/api/v1/experiments", f"{{{sweep}}}"
    for field in ("steps", "alpha", "divisions", "grid_side_m"):
        for number in NUMBERS:
            yield "/api/v1/what-if", f'{{"gait": "left-right-origin", {_field(field, number)}}}'
    for field in ("time_s", "speed", "playing"):
        for number in NUMBERS:
            yield "/api/v1/stage", f'{{"{field}": {number}}}'


def _field(name: str, value: str) -> str:
    return f'"settings": {{"{name}": {value}}}' if name == "alpha" else f'"{name}": {value}'


def test_malformed_requests_give_no_5xx(unlimited_api: Api) -> None:
    answers = [
        (
            unlimited_api.client.request(method, path, **more).status_code,
            method,
            path,
            str(more)[:200],
        )
        for method, path, more in odd_requests(unlimited_api)
    ]
    assert len(answers) > 500
    assert [
        answer for answer in answers if answer[0] >= 500 and not answer[2].startswith("/readyz")
    ] == []
