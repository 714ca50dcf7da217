"""The resource `runs`: runs of every kind, listed, filtered, searched and found by id."""

from typing import Any

from tests.api.calls import Api, refused


def names(page: dict[str, Any]) -> list[str]:
    return [run["name"] for run in page["items"]]


def test_runs_of_every_kind_are_listed_and_searched(api: Api) -> None:
    training = api.finished(api.train(name="Zebra tripod", steps=10, evaluate_every=0))
    race = api.finished(api.race(name="A zebra race", lanes=[{"agent": "greedy"}], steps=2))
    assert names(api.get("/runs"))[:2] == ["A zebra race", "Zebra tripod"]
    assert names(api.get("/runs?search=ZEBRA")) == ["A zebra race", "Zebra tripod"]
    assert names(api.get("/runs?search=zebra&kind=training")) == ["Zebra tripod"]
    assert names(api.get("/runs?search=zebra&kind=race&state=finished")) == ["A zebra race"]
    assert names(api.get(f"/runs?search={race['id']}")) == ["A zebra race"]
    assert names(api.get("/trainings?search=zebra%20race")) == []

    first = api.get("/runs?search=zebra&limit=1")
    assert names(first) == ["A zebra race"]
    second = api.get(f"/runs?search=zebra&limit=1&cursor={first['next_cursor']}")
    assert names(second) == ["Zebra tripod"]
    assert second["next_cursor"] is None
    for run in (training, race):
        assert api.get(f"/runs/{run['id']}") == run


def test_an_unknown_filter_value_is_refused_with_the_valid_ones(api: Api) -> None:
    refused(api.call("GET", "/runs?kind=walk"), 422, "kind", "training, race, experiment")
    refused(api.call("GET", "/runs?state=tired"), 422, "state", "running")
    refused(api.call("GET", f"/runs?search={'x' * 101}"), 422, "search", "at most 100 characters")
    refused(api.call("GET", "/runs/nothing"), 404, "nothing")
