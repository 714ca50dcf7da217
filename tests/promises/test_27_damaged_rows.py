"""Promise 27: no stored row can break a listing.

Promised: every field of every import, and every column of the database, with its worst value: all
GETs, the events and the page still answer, and name the damaged run. Here some of these, chosen at
random; all of them by `make soak`. A server reads several damaged runs at once, each damaged in
another way.
"""

import io
import json
import random
import shutil
import sqlite3
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import httpx2
import numpy as np
import pytest
from playwright.sync_api import Page, expect
from sqlalchemy import text

from app.events.run_view import run_view
from app.features.archives import archive
from app.features.archives.transfer import RUN
from app.features.experiments.archived_trials import TRIALS
from app.storage.database.engine import Database, postgresql_engine
from app.storage.database.opening import DATABASE_FILE
from app.storage.database.store import RunStore
from app.storage.errors import Damaged
from app.storage.run import STATES, TABLE, DamagedRun
from hexapods.runs import tables
from hexapods.runs.tables import from_bytes
from tests.browser.dashboard import Dashboard
from tests.browser.serving import serving
from tests.cli.running import in_process
from tests.features.archives.exported import export_run
from tests.features.experiments.ended_experiments import ended_experiment
from tests.postgresql import PostgresServer
from tests.promises.length import at_length
from tests.promises.worst_values import (
    BROKEN_TEXT,
    IMPORTED,
    OF_RUNS,
    STORED,
    paths_to_values,
    put_value,
)
from tests.served import Served
from tests.storage.ended_runs import ended_race, ended_training
from tests.storage.stores import opened, training

SOUND, TRAINING, RACE, EXPERIMENT = (
    "00000000000s1",
    "00000000000t1",
    "00000000000r1",
    "00000000000e1",
)
KINDS = {TRAINING: "trainings", RACE: "races", EXPERIMENT: "experiments"}
BELOW = {
    "trainings": ["", "/curve", "/curve?format=csv", "/q-table", "/q-table?format=npz", "/export"],
    "races": ["", "/recording", "/recording?format=npz", "/timeline", "/export"],
    "experiments": ["", "/summary", "/report", "/trials", "/trials?format=csv", "/export"],
}
FIELDS_A_FILE, COLUMNS = at_length(6, None), at_length(7, None)
"""Number of adverse values tried per file, and of columns of each kind of run; None for all."""
File = tuple[str, bytes]


@pytest.fixture(scope="module")
def template(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data folder with a run of each kind to corrupt, and an undamaged one; only to be read."""
    folder = tmp_path_factory.mktemp("template")
    with opened(folder, None) as store:
        ended_training(store, SOUND, "sound", steps=20)
        ended_training(store, TRAINING, steps=20)
        ended_race(store, RACE, TRAINING)
        ended_experiment(store, EXPERIMENT)
    return folder


@pytest.fixture
def data_folder(template: Path, tmp_path: Path) -> Path:
    """This test's copy of the data folder."""
    shutil.copytree(template, tmp_path, dirs_exist_ok=True)
    return tmp_path


def sample(cases: list[Any], count: int | None) -> list[Any]:
    return cases if count is None else random.Random(27).sample(cases, min(count, len(cases)))


def first_event(server: Served, query: str = "") -> dict[str, Any]:
    event, data, _ = next(server.events(query))
    assert event == "snapshot"
    shown: dict[str, Any] = data
    return shown


def listed(server: Served, kind: str) -> dict[str, dict[str, Any]]:
    answer = server.client.get(f"/api/v1/{kind}")
    assert answer.status_code == 200, answer.text
    return {run["id"]: run for run in answer.json()["items"]}


def check_all_reads(server: Served, ids: dict[str, str]) -> dict[str, str]:
    """Check that every read of every run is answered; return the damaged runs' messages by id."""
    damaged: dict[str, str] = {}
    for kind in ("trainings", "races", "experiments"):
        runs = listed(server, kind)
        damaged |= {i: run["damaged"] for i, run in runs.items() if "damaged" in run}
        for state in STATES:
            assert server.client.get(f"/api/v1/{kind}?state={state}").status_code == 200
    assert SOUND in listed(server, "trainings")
    assert "damaged" not in listed(server, "trainings")[SOUND]
    damaged_runs = {(run_id, kind) for run_id in damaged.keys() - ids for kind in KINDS.values()}
    for run_id, kind in {*ids.items(), *damaged_runs}:
        for below in BELOW[kind]:
            answer = server.client.get(f"/api/v1/{kind}/{run_id}{below}")
            assert answer.status_code < 500, (run_id, below, answer.text)
    snapshot = first_event(server)
    assert {run["id"] for run in snapshot["runs"]} >= {SOUND, *damaged}
    assert server.client.get("/readyz").status_code == 200
    assert server.client.get("/api/v1/stage").status_code == 200
    return damaged


# ---- imports


@pytest.fixture(scope="module")
def files(template: Path) -> list[File]:
    """The path of each import and a file for it; the first is a table."""
    with opened(template, None) as store:
        table = store.artifact(TRAINING, TABLE) or b""
        archives = [("/import", export_run(store, run_id)) for run_id in KINDS]
        return [("/trainings/import", table), *archives]


def mutations(path: str, data: bytes) -> Iterator[Callable[[], bytes]]:
    """Yield functions that build the file with one adverse field and correct digests."""
    if path == "/trainings/import":
        checkpoint = from_bytes(data, "the table")
        for place in paths_to_values(dict(checkpoint.meta)):
            for value in IMPORTED:
                yield partial(_table, checkpoint, place, value)
        return
    members = archive.unpack(data, "run.zip", lambda name: True)
    for name in {RUN, TRIALS} & set(members):
        shown = json.loads(members[name])
        for place in paths_to_values(shown):
            for value in IMPORTED:
                yield partial(_archive, members, name, place, value)


def _table(checkpoint: tables.Checkpoint, place: tuple[Any, ...], value: Any) -> bytes:
    meta = json.loads(json.dumps(dict(checkpoint.meta)))
    put_value(meta, place, value)
    return tables.to_bytes(tables.Checkpoint(meta, checkpoint.arrays))


def _archive(members: dict[str, bytes], name: str, place: tuple[Any, ...], value: Any) -> bytes:
    shown = json.loads(members[name])
    put_value(shown, place, value)
    return archive.pack({**members, name: json.dumps(shown).encode()})


@pytest.mark.timeout(at_length(300, 7200))
@pytest.mark.usefixtures("data_folder")
def test_no_import_can_break_a_listing(files: list[File], launch: Callable[..., Served]) -> None:
    server = launch(HEXAPODS_STARTS_PER_MINUTE="1000000")
    refused = 0
    for path, data in files:
        for make in sample(list(mutations(path, data)), FIELDS_A_FILE):
            answer = server.client.post(f"/api/v1{path}", content=make())
            assert answer.status_code in (201, 422), answer.text
            if answer.status_code == 422:
                refused += 1
                continue
            run = answer.json()
            kind = f"{run['kind']}s"
            assert listed(server, kind)[run["id"]] == run
            assert run in first_event(server)["runs"]
            for below in BELOW[kind]:
                look = server.client.get(f"/api/v1/{kind}/{run['id']}{below}")
                assert look.status_code < 500, (below, look.text)
            assert server.client.delete(f"/api/v1/{kind}/{run['id']}").status_code == 204
    assert refused > 10
    assert check_all_reads(server, KINDS) == {}


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("greedy_distance_m", float("nan")),
        ("greedy_distance_m", 1e300),
        ("greedy_distance_m", "far"),
        ("step", 10**30),
        ("step", -5),
        ("step", True),
        ("step", 10**9),
        ("rng", "{}"),
        ("agent", "x" * 1000),
        ("changes", [{"step": 3, "pace": float("inf")}]),
    ],
)
def test_a_table_with_an_invalid_field_is_refused(
    name: str, value: Any, files: list[File], quiet_import: Callable[[bytes], Any]
) -> None:
    [(_, data), *_] = files
    answer = quiet_import(_table(from_bytes(data, "the table"), (name,), value))
    assert answer.status_code == 422
    assert any(word in answer.json()["detail"] for word in (name, "The file", "Pace"))


@pytest.fixture
def quiet_import(quiet_server: Any) -> Iterator[Callable[[bytes], Any]]:
    with httpx2.Client(base_url=quiet_server.address, trust_env=False) as client:
        before = client.get("api/v1/trainings").json()["items"]
        yield lambda data: client.post("api/v1/trainings/import", content=data)
        assert client.get("api/v1/trainings").json()["items"] == before


def test_a_table_with_invalid_values_is_refused(
    files: list[File], quiet_import: Callable[[bytes], Any]
) -> None:
    [(_, data), *_] = files
    checkpoint = from_bytes(data, "the table")
    changes: dict[str, Any] = {
        "agent.q": np.nan,
        "agent.rates": np.nan,
        "agent.learned": -(10**9),
        "agent.where": -(10**9),
    }
    for name, value in changes.items():
        arrays = {**checkpoint.arrays, name: checkpoint.arrays[name] + value}
        data = tables.to_bytes(tables.Checkpoint(checkpoint.meta, arrays))
        assert quiet_import(data).status_code == 422, name
    buffer = io.BytesIO()
    np.savez(buffer, meta=np.array("{}"))
    assert quiet_import(buffer.getvalue()).status_code == 422


# ---- rows


@contextmanager
def corrupted_column(
    folder: Path, table: str, column: str, value: Any, run_id: str
) -> Iterator[None]:
    """Set a column of a run's row to an adverse value, until the context ends."""
    key = "id" if table == "runs" else "run_id"
    with closing(sqlite3.connect(folder / DATABASE_FILE, isolation_level=None)) as file:
        where = f"{table} WHERE {key} = ?"
        former = file.execute(f"SELECT rowid, {column} FROM {where} LIMIT 1", (run_id,)).fetchone()
        if former is None:
            yield
            return
        is_text = value == BROKEN_TEXT
        new = "CAST(? AS TEXT)" if is_text else "?"
        update = f"UPDATE {table} SET {column} = {new} WHERE rowid = ?"
        file.execute(update, (value, former[0]))
        try:
            yield
        finally:
            file.execute(f"UPDATE {table} SET {column} = ? WHERE rowid = ?", former[::-1])


Damage = tuple[str, str, Any, str]
"""Table, column, value, and the run's id."""


def damage_of_each_kind() -> list[tuple[Damage, ...]]:
    """Every adverse value of every column; each time a run of each kind, each in another column."""
    values = [*STORED, BROKEN_TEXT]
    names = [(table.name, column.name) for table in OF_RUNS for column in table.columns]
    return [
        tuple((*names[number - shift], value, run_id) for shift, run_id in enumerate(KINDS))
        for number in range(len(names))
        for value in values
    ]


@pytest.mark.timeout(at_length(300, 14_400))
def test_no_row_can_break_a_listing(data_folder: Path, launch: Callable[..., Served]) -> None:
    server = launch()
    damaged_ids = set()
    for together in sample(damage_of_each_kind(), COLUMNS):
        with ExitStack() as stack:
            for damage in together:
                stack.enter_context(corrupted_column(data_folder, *damage))
            damaged = check_all_reads(server, KINDS)
        assert len(damaged) <= len(together), (together, damaged)
        damaged_ids |= set(damaged)
    assert damaged_ids, "some of these values are damage"
    assert check_all_reads(server, KINDS) == {}


DAMAGE: list[tuple[str, Any]] = [
    ("kind", "regatta"),
    ("result", '{"distance_m": []}'),
    ("id", BROKEN_TEXT),
    ("config", "milk"),
    ("state", "lost"),
    ("result", '{"distance_m": "far"}'),
    ("changes", '[{"step": 1, "settings": {"alpha": NaN}}]'),
    ("greedy_distance_m", float("inf")),
    ("created_at", "yesterday"),
    ("done", "many"),
    ("name", b"\x00\xff"),
    ("id", "../x/y"),
    ("id", b"\x00\xff"),
]


@pytest.fixture
def command(data_folder: Path) -> Callable[..., Any]:
    """A function that runs a command of `hexapods` in this process, and returns its JSON."""

    def run(*arguments: str, code: int = 0) -> Any:
        options = (*arguments, "--data", str(data_folder), "--json")
        done = in_process(*options, folder=data_folder, HEXAPODS_PORT="0")
        assert (done.returncode, done.stderr) == (code, "")
        return json.loads(done.stdout)

    return run


@pytest.mark.parametrize("damage", [DAMAGE[:7], DAMAGE[7:]], ids=["some", "more"])
def test_damaged_runs_are_named_everywhere_and_can_be_deleted(
    damage: list[tuple[str, Any]],
    data_folder: Path,
    launch: Callable[..., Served],
    command: Callable[..., Any],
) -> None:
    ids = [TRAINING, *(f"00000000000d{number}" for number in range(1, len(damage)))]
    deletable = {run_id for run_id, (column, _) in zip(ids, damage, strict=True) if column != "id"}
    with opened(data_folder, None) as store:
        for run_id in ids[1:]:
            ended_training(store, run_id, steps=20)
    with ExitStack() as stack:
        for run_id, (column, value) in zip(ids, damage, strict=True):
            stack.enter_context(corrupted_column(data_folder, "runs", column, value, run_id))
        server = launch()
        damaged = check_all_reads(server, {**KINDS, **dict.fromkeys(ids, "trainings")})
        assert len(damaged) == len(damage), damaged
        assert damaged.keys() >= deletable
        assert f"hexapods_runs_damaged {len(damage)}.0" in server.client.get("/metrics").text
        rows = {run["id"]: run.get("damaged") for run in command("runs", "list")["items"]}
        assert rows == {**dict.fromkeys((SOUND, RACE, EXPERIMENT)), **damaged}
        checks = {check["name"]: check for check in command("doctor", code=1)["checks"]}
        assert not checks["data"]["ok"]
        for run_id, message in damaged.items():
            assert len(message) > 10
            look = server.client.get(f"/api/v1/trainings/{run_id}").json()
            assert look["damaged"] == message
            assert look["id"] == run_id
            snapshot = first_event(server, f"?run_id={run_id}")
            assert [run["damaged"] for run in snapshot["runs"]] == [message]
            assert command("runs", "show", run_id)["damaged"] == message
            assert run_id in checks["data"]["said"]
            resumed = server.client.post(f"/api/v1/trainings/{run_id}/resume")
            assert resumed.status_code in (404, 409)
        for run_id in damaged:
            deleted = server.client.delete(f"/api/v1/trainings/{run_id}")
            assert deleted.status_code == 204, deleted.text
        assert check_all_reads(server, {RACE: "races"}) == {}
        left = {run["id"] for run in command("runs", "list")["items"]}
        assert left == {SOUND, RACE, EXPERIMENT}


@pytest.mark.parametrize(
    ("column", "value"),
    [
        ("config", "'{}'"),
        ("config", "'{\"steps\": -1}'"),
        ("kind", "'regatta'"),
        ("state", "'lost'"),
        ("result", "'[]'"),
        ("greedy_distance_m", "'NaN'"),
        ("total", "-1"),
        ("created_at", "'infinity'"),
        ("ended_at", "'-infinity'"),
        ("created_at", "'4713-01-01 BC'"),
        ("changes", "'{\"a\": 1}'"),
        ("done", "-9223372036854775808"),
        ("id", "'../x'"),
        ("id", "''"),
    ],
)
def test_no_row_can_break_a_listing_in_postgresql(
    column: str, value: str, postgresql: PostgresServer, tmp_path: Path
) -> None:
    with postgresql.database() as url, opened(tmp_path, url) as store:
        store.create(training("a", state="finished"), training("b", state="finished"))
        database = Database(postgresql_engine(url))
        change = text(f"UPDATE runs SET {column} = {value} WHERE id = 'a'")
        database.write(lambda connection: connection.execute(change))
        database.close()
        shown = {run["id"]: run for run in map(run_view, store.list(kind="training").items)}
        assert len(shown) == 2
        assert "damaged" not in shown.pop("b")
        [(run_id, damaged)] = shown.items()
        assert damaged["damaged"]
        check_refusal(store, run_id)
        store.delete(run_id)
        assert [run.id for run in store.list().items] == ["b"]


def check_refusal(store: RunStore, run_id: str) -> None:
    run = store.find(run_id)
    if isinstance(run, DamagedRun):
        with pytest.raises(Damaged, match="delete it"):
            store.get(run_id)


def test_the_page_shows_the_others_and_deletes_the_damaged_one(
    data_folder: Path, page: Page, dashboard: Dashboard
) -> None:
    with (
        corrupted_column(data_folder, "runs", "config", "milk", RACE),
        serving(data_folder) as server,
    ):
        dashboard.open(server.address)
        page.goto(f"{server.address}#runs")
        expect(page.locator("li.run")).to_have_count(4)
        row = page.locator("li.run", has_text=RACE)
        expect(row).to_contain_text("damaged")
        expect(row).to_contain_text("cannot read")
        row.get_by_label("More for this").click()
        row.get_by_role("button", name="Delete").click()
        expect(page.locator("li.run")).to_have_count(3)
        page.reload()
        expect(page.locator("li.run")).to_have_count(3)
