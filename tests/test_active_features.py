"""Questions of the core to all features: owner and visibility of runs; features that fail."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel
from sqlalchemy import Column, Integer, MetaData, Table

from app import server
from app.feature import Feature
from app.installed_features import Catalogue, load
from app.settings import Settings
from app.storage.database.opening import open_store
from app.storage.database.schema import RUNS
from app.storage.database.store import RunStore
from hexapods.domain.errors import InvalidInput
from hexapods.domain.records import Record
from tests.api.calls import WALK, Api
from tests.api.conftest import running
from tests.features.needing import needs
from tests.jobs.waiting import wait_until
from tests.storage.stores import training

TOKEN = "a-token-for-tests"


def store_of(api: Api) -> RunStore:
    app: Any = api.client.app
    store: RunStore = app.state.services.store
    return store


Add = Callable[[type[Feature]], None]


@pytest.fixture
def add(monkeypatch: pytest.MonkeyPatch) -> Add:
    """Returns a function that adds a feature to those that are installed."""

    def add(feature: type[Feature]) -> None:
        monkeypatch.setattr(
            server, "load", lambda without: Catalogue((*load(without).classes, feature))
        )

    return add


def failing(member: str) -> type[Feature]:
    """Return a feature of which a member raises an unexpected error."""

    def fail(*args: Any, **more: Any) -> Any:
        raise RuntimeError("out of order")

    is_of_class = isinstance(vars(Feature).get(member), classmethod)
    return type(
        "Failing",
        (Feature,),
        {"name": "failing", member: classmethod(fail) if is_of_class else fail},
    )


@pytest.mark.parametrize(
    "member", ["__init__", "open", "routers", "pages", "provider", "visible_runs"]
)
def test_a_feature_that_fails_at_the_start_is_named(member: str, tmp_path: Path, add: Add) -> None:
    add(failing(member))
    with (
        pytest.raises(InvalidInput, match=r"feature failing fails .*HEXAPODS_WITHOUT=failing"),
        running(Settings(data=tmp_path)),
    ):
        pass


@needs("classroom", "experiments", "presenter")
@pytest.mark.parametrize(
    ("members", "message"),
    [
        ({"event_bodies": {"room": BaseModel}}, "classroom and other both have the event room"),
        ({"option_types": {"experiments": list}}, "both have the option experiments"),
        ({"stage_members": {"presentation": Record}}, "both have the member of the stage"),
        ({"tables": MetaData()}, "both have the table rooms"),
    ],
    ids=["event", "option", "stage", "table"],
)
def test_a_feature_that_replaces_something_of_another_one_is_refused(
    members: dict[str, Any], message: str, tmp_path: Path, add: Add
) -> None:
    if "tables" in members:
        Table("rooms", members["tables"], Column("code", Integer))
    add(type("Other", (Feature,), {"name": "other", **members}))
    with pytest.raises(InvalidInput, match=message), running(Settings(data=tmp_path)):
        pass


def test_a_feature_that_is_left_out_and_cannot_say_what_it_hides_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    left_out = Catalogue((), (failing("visible_when_left_out"),))
    monkeypatch.setattr(server, "load", lambda without: left_out)
    with (
        pytest.raises(InvalidInput, match=r"failing is left out, and cannot say.*uninstall"),
        running(Settings(data=tmp_path)),
    ):
        pass


def test_a_run_is_refused_if_a_feature_cannot_say_whether_it_is_hidden(
    tmp_path: Path, add: Add
) -> None:
    add(failing("why_hidden"))
    bearer = {"authorization": f"Bearer {TOKEN}"}
    with running(Settings(data=tmp_path, token=TOKEN)) as api:
        store_of(api).create(training("shown", state="finished"))
        refused = api.call("GET", "/runs/shown")
        assert (refused.status_code, "failing fails in `why_hidden`" in refused.text) == (422, True)
        assert api.call("GET", "/runs/shown", headers=bearer).status_code == 200


def test_a_feature_that_fails_later_stops_nothing_else(
    tmp_path: Path, add: Add, caplog: pytest.LogCaptureFixture
) -> None:
    names = ("owner_of", "metrics", "unfinished", "on_resumed", "options")
    members = {name: vars(failing(name))[name] for name in names}
    add(type("Failing", (Feature,), {"name": "failing", **members}))
    with running(Settings(data=tmp_path, job_niceness=0)) as api:
        assert "hexapods_runs" in api.client.get("/metrics").text
        assert api.get("/options")["gaits"]
        started = api.call("POST", "/trainings", json={**WALK, "steps": 20})
        assert api.finished(started.json())["state"] == "finished"
    messages = {record.message for record in caplog.records if "failing" in record.message}
    assert {message.split(" cannot")[0].split(" has")[0] for message in messages} == {
        "the feature failing"
    }


def test_jobs_are_stopped_with_a_checkpoint_where_a_feature_fails_to_close(
    tmp_path: Path, add: Add, caplog: pytest.LogCaptureFixture
) -> None:
    add(failing("close"))
    settings = Settings(data=tmp_path, job_niceness=0)
    with running(settings) as api:
        started = api.call("POST", "/trainings", json={**WALK, "steps": 20_000}).json()
        wait_until(lambda: api.get(f"/runs/{started['id']}")["state"] == "running")
    assert "the feature failing fails in `close`" in caplog.messages
    with open_store(settings) as store:
        assert store.get(started["id"]).error == "The server was stopped while it ran."


def test_one_condition_hides_a_run_from_lists_and_alone(tmp_path: Path, add: Add) -> None:
    class Hiding(Feature):
        name = "hiding"

        def visible_runs(self, identity: Any) -> Any:
            return RUNS.c.id != "hidden"

    add(Hiding)
    with running(Settings(data=tmp_path, token=TOKEN)) as api:
        store_of(api).create(training("hidden", state="finished"))
        assert api.get("/runs")["items"] == []
        refused = api.call("GET", "/runs/hidden")
        assert (refused.status_code, "feature hiding" in refused.text) == (403, True)
