"""What becomes of experiments where their feature is left out, and in a store that it knows not."""

from pathlib import Path

import pytest

from app.cli.commands import command_paths
from app.events.damage import damaged_runs
from app.settings import Settings
from app.storage.database.opening import open_store
from app.storage.errors import Damaged
from app.storage.run import DamagedRun
from app.storage.run_ids import RunIds
from app.storage.run_kind import kinds_without
from hexapods.agents.registry import registered
from hexapods.domain.errors import InvalidInput
from tests.api.conftest import running
from tests.features.experiments.ended_experiments import ended_experiment
from tests.features.needing import needs
from tests.storage.stores import opened

RUN_ID = "00000000000e1"
WITHOUT = ("experiments",)


def test_its_runs_stay_and_are_listed(tmp_path: Path) -> None:
    with opened(tmp_path, None) as store:
        ended_experiment(store, RUN_ID)
    with running(Settings(data=tmp_path, without=WITHOUT)) as api:
        (listed,) = api.get("/runs")["items"]
        assert (listed["id"], listed["kind"], listed["name"]) == (
            RUN_ID,
            "experiment",
            "It was tried",
        )
        assert "not left out any more" in listed["damaged"]
        assert api.get("/trainings")["items"] == api.get("/races")["items"] == []
        assert api.call("POST", "/experiments", json={"experiment": "table1"}).status_code == 404
        assert api.call("POST", f"/runs/{RUN_ID}/again").status_code != 202
        assert api.client.get(f"/api/v1/experiments/{RUN_ID}/export").status_code == 404
        options = api.get("/options")
        assert "experiments" not in options
        assert "seeds" not in options["limits"]
    with running(Settings(data=tmp_path)) as api:
        assert api.get(f"/experiments/{RUN_ID}")["result"]["trials"]["done"] == 4


@needs("archives")
def test_they_count_as_no_damage_and_cannot_be_imported(tmp_path: Path) -> None:
    from app.features.archives.transfer import export_chunks, import_runs

    with opened(tmp_path / "with", None) as store:
        ended_experiment(store, RUN_ID)
        data = b"".join(export_chunks(store, RUN_ID))
    with open_store(Settings(data=tmp_path / "with", without=WITHOUT)) as store:
        assert isinstance(store.find(RUN_ID), DamagedRun)
        assert damaged_runs(store) == []
        with pytest.raises(Damaged):
            store.get(RUN_ID)
    with open_store(Settings(data=tmp_path / "without", without=WITHOUT)) as store:
        with pytest.raises(InvalidInput, match=r"unknown kind of run 'experiment'"):
            import_runs(store, data, RunIds(), registered(), "the archive")
        assert store.list().items == []


def test_its_kind_and_its_commands_go_with_it() -> None:
    assert kinds_without(()) - kinds_without(WITHOUT) == {"experiment"}
    commands = command_paths(environ={"HEXAPODS_WITHOUT": "experiments"})
    assert not {"experiment", "sweep", "tune"} & commands.keys()
