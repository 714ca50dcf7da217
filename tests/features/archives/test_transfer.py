"""Export and import of trainings and races: round trip, and rejection of invalid archives."""

import io
import json
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.features.archives import archive
from app.features.archives.transfer import RUN, export_many, import_runs
from app.storage.database.store import RunStore
from app.storage.errors import Conflict, NotFound, StorageFull
from app.storage.recordings import Recordings
from app.storage.run import CHECKPOINT, TABLE, Run, State
from app.storage.run_ids import RunIds
from app.storage.stored_races import RACE
from app.storage.stored_trainings import PRACTICE, evaluations_file, transitions_file
from hexapods.agents.registry import BUILT_IN
from hexapods.domain.disturbances import SensorNoise
from hexapods.domain.errors import InvalidInput
from hexapods.domain.settings import SettingValues
from hexapods.domain.world import World
from hexapods.runs.config import training_config
from hexapods.runs.lane import PlanningModel, lane_config
from hexapods.runs.race_config import Branch, RaceConfig
from hexapods.runs.race_file import race_arrays
from tests.features.archives.exported import export_run, import_run
from tests.storage.ended_runs import ended_race, ended_training, result_of_race
from tests.storage.stores import ODD, opened, temporary_store, training

TRAINING, RACED = "00000000000t1", "00000000000r1"
ONE, OTHER = "00000000000a1", "00000000000b1"
TRAINING_ZIP, RACE_ZIP = f"training-{TRAINING}.zip", f"race-{RACED}.zip"
Change = Callable[[Any], object]


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunStore]:
    with opened(tmp_path_factory.mktemp("source"), None) as store:
        ended_training(store, TRAINING, "ü 🕷 <b>it</b> [red]learned")
        ended_race(store, RACED, TRAINING)
        yield store


def imported(data: bytes, store: RunStore | None = None) -> Run:
    with temporary_store() if store is None else nullcontext(store) as target:
        return import_run(target, data, RunIds(), "run.zip")


def imported_runs(data: bytes, store: RunStore) -> list[Run]:
    return import_runs(store, data, RunIds(), tuple(BUILT_IN), "runs.zip")


def refusal(data: bytes) -> str:
    with temporary_store() as store:
        with pytest.raises(InvalidInput) as error:
            imported(data, store)
        assert store.list().items == []
    assert "\n" not in str(error.value)
    return str(error.value)


def repacked(data: bytes, **members: bytes | None) -> bytes:
    """Replace members of an archive (None removes one), with a manifest that matches."""
    original = archive.unpack(data, "run.zip", lambda name: True)
    changed = {**original, **{name.replace("_", "."): data for name, data in members.items()}}
    return archive.pack({name: data for name, data in changed.items() if data is not None})


def rewritten(data: bytes, change: Change) -> bytes:
    """Change the `run.json` of an archive."""
    content = json.loads(archive.unpack(data, "run.zip", lambda name: True)[RUN])
    change(content)
    return repacked(data, run_json=json.dumps(content).encode())


@pytest.mark.parametrize(
    ("old", "new", "complaint"),
    [
        ('"format":', '"format": 1, "format":', "'format' twice"),
        ('"name":', '"name": "another", "name":', "'name' twice"),
        ('"gait":', '"gait": "left-right-vertical", "gait":', "'gait' twice"),
        ('"curve":', '"curve": [], "curve":', "'curve' twice"),
        ('"distance_m":', '"step": 3, "distance_m":', "twice"),
        ('"step":', " " * 10_000 + '"step":', "blanks"),
        ('"name":', " " * 10_000 + '"name":', "blanks"),
        ('"name":', " " * 10_000_000 + '"name":', "too long"),
    ],
    ids=str,
)
def test_repeated_keys_and_blanks_are_refused(
    old: str, new: str, complaint: str, source: RunStore
) -> None:
    data = export_run(source, TRAINING)
    text = archive.unpack(data, "run.zip", lambda name: True)[RUN].decode()
    # The first is in the run, except for those of the curve, which is at the end.
    parts = text.rpartition(old) if old in ('"step":', '"distance_m":') else text.partition(old)
    assert parts[1]
    changed = parts[0] + new + parts[2]
    assert complaint in refusal(repacked(data, run_json=changed.encode()))


@pytest.mark.parametrize("run_id", [TRAINING, RACED])
def test_export_and_import_preserve_everything(
    source: RunStore, run_id: str, tmp_path: Path
) -> None:
    data = export_run(source, run_id)
    with opened(tmp_path, None) as target:
        assert imported(data, target) == source.get(run_id)
        assert target.curves.get(run_id) == source.curves.get(run_id)
        for name in (TABLE, RACE, PRACTICE, transitions_file(0)):
            assert target.artifact(run_id, name) == source.artifact(run_id, name)
        assert export_run(target, run_id) == data
        imported_recordings, source_recordings = Recordings(target), Recordings(source)
        if run_id == RACED:
            lanes, were = imported_recordings.race(run_id), source_recordings.race(run_id)
            assert lanes is not None
            assert were is not None
            same = zip(race_arrays(lanes).values(), race_arrays(were).values(), strict=True)
            assert all(array.tobytes() == other.tobytes() for array, other in same)
        else:
            practised, was = (
                imported_recordings.training(run_id),
                source_recordings.training(run_id),
            )
            assert practised is not None
            assert was is not None
            assert [s.step for s in practised.steps] == [s.step for s in was.steps]
            assert len(practised.evaluations) == len(was.evaluations) == 24


def test_tags_and_notes_are_archived_and_checked(source: RunStore, store: RunStore) -> None:
    data = export_run(source, TRAINING)
    run = imported(data, store)
    assert (run.tags, run.notes) == ((), "")
    store.update(run.id, tags=("ice",), notes="one\ntwo")
    again = imported(export_run(store, run.id))
    assert (again.tags, again.notes) == (("ice",), "one\ntwo")
    invalid: list[dict[str, Any]] = [{"tags": ["a", "A"]}, {"tags": ["x" * 31]}, {"notes": "\x1b"}]
    for fields in invalid:
        refusal(rewritten(data, partial(_set_in_run, fields)))


def _set_in_run(fields: dict[str, Any], content: Any) -> None:
    content["run"].update(fields)


def test_several_runs_are_one_archive_that_is_taken_in_whole(
    source: RunStore, store: RunStore
) -> None:
    data = b"".join(export_many(source, [TRAINING, RACED, TRAINING]))
    members = archive.unpack(data, "runs.zip", lambda name: True)
    assert list(members) == [TRAINING_ZIP, RACE_ZIP]
    assert members[TRAINING_ZIP] == export_run(source, TRAINING), "each is an archive by itself"
    assert imported_runs(data, store) == [source.get(TRAINING), source.get(RACED)]
    assert store.artifact(RACED, RACE) == source.artifact(RACED, RACE)
    [imported_run] = imported_runs(export_run(source, RACED), store)
    assert imported_run.id not in (TRAINING, RACED), "one run by itself is taken in too"


def test_an_archive_of_several_runs_is_refused_as_a_whole(
    source: RunStore, store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    good = export_run(source, TRAINING)
    walk = rewritten(export_run(source, RACED), lambda content: content["run"].update(kind="walk"))
    for broken in (good[:-9], walk, archive.pack({RACE_ZIP: good})):
        data = archive.pack({TRAINING_ZIP: good, RACE_ZIP: broken})
        with pytest.raises(InvalidInput, match=f"{RACE_ZIP} of runs.zip"):
            imported_runs(data, store)
    mixed: list[dict[str, bytes]] = [
        {},
        {RACE_ZIP: good, RUN: b"{}"},
        {RACE_ZIP: good, TABLE: good},
    ]
    for members in mixed:
        with pytest.raises(InvalidInput):
            imported_runs(archive.pack(members), store)
    with pytest.raises(InvalidInput, match="which no run has"):
        imported(b"".join(export_many(source, [TRAINING])), store)
    recording = source.artifact(RACED, RACE)
    write = store.files.write

    def write_no_race(data: bytes) -> Any:
        if data == recording:
            raise StorageFull("no space")
        return write(data)

    monkeypatch.setattr(store.files, "write", write_no_race)
    with pytest.raises(StorageFull):
        imported_runs(b"".join(export_many(source, [TRAINING, RACED])), store)
    assert store.list().items == []
    assert store.delete_orphans() == 0


def test_what_cannot_be_exported_together_is_refused_before_the_first_byte(
    source: RunStore, store: RunStore
) -> None:
    store.create(training("a"), training("b", state="stopped"))
    with pytest.raises(Conflict, match="stop it first"):
        export_many(store, ["b", "a"])
    with pytest.raises(NotFound):
        export_many(store, ["b", "c"])
    too_many: list[list[str]] = [[], [f"{n}" for n in range(101)]]
    for ids in too_many:
        with pytest.raises(InvalidInput, match="from 1 to 100 runs"):
            export_many(source, ids)


def test_import_does_not_replace_an_existing_run(source: RunStore, store: RunStore) -> None:
    data = export_run(source, TRAINING)
    first = imported(data, store)
    store.update(first.id, name="Mine")
    second = imported(data, store)
    assert first.id == TRAINING != second.id
    assert store.get(TRAINING).name == "Mine"
    assert second == replace(source.get(TRAINING), id=second.id)
    assert store.artifact(second.id, TABLE) == source.artifact(TRAINING, TABLE)


def test_runs_can_be_exported_in_every_ended_state_only(source: RunStore) -> None:
    for state in ("stopped", "failed", "interrupted"):
        with temporary_store() as store:
            store.create(training(ONE, state=state, error="It broke.", greedy_distance_m=0.5))
            assert imported(export_run(store, ONE)) == store.get(ONE)
    for state in ("queued", "running", "paused"):
        with temporary_store() as store:
            store.create(training("a", state=state))
            with pytest.raises(Conflict, match="stop it first"):
                export_run(store, "a")
    with pytest.raises(NotFound):
        export_run(source, "none")


def test_checkpoint_is_exported_with_an_interrupted_run_only(
    source: RunStore, store: RunStore, tmp_path: Path
) -> None:
    config, saved = source.get(TRAINING).config, source.artifact(TRAINING, TABLE) or b""
    states: dict[str, State] = {ONE: "interrupted", OTHER: "finished"}
    for run_id, state in states.items():
        store.create(training(run_id, state=state, config=config, done=120, total=120))
        store.put_artifact(run_id, CHECKPOINT, saved)
    with opened(tmp_path, None) as target:
        for run_id in states:
            imported(export_run(store, run_id), target)
        assert target.artifact(ONE, CHECKPOINT) == saved
        # A finished training is not resumed, so that its checkpoint is not exported.
        assert target.artifact(OTHER, CHECKPOINT) is None
    data = export_run(store, ONE)
    assert "another step" in refusal(rewritten(data, _shorter))
    assert "is not a Q-table" in refusal(repacked(data, checkpoint_npz=b"milk"))


def test_unusual_configs_are_imported_but_unregistered_agents_refused(store: RunStore) -> None:
    odd = replace(ODD, agent="q-learning", settings=SettingValues({"alpha": 0.5}))
    store.create(training(ONE, state="finished", config=odd))
    store.create(training(OTHER, state="finished", config=ODD))
    assert imported(export_run(store, ONE)) == store.get(ONE)
    assert ", ".join(BUILT_IN) in refusal(export_run(store, OTHER))


def test_lanes_with_settings_are_imported(store: RunStore) -> None:
    lanes = (lane_config("beam", width=2), lane_config("q-learning", keep_learning=True, alpha=0.5))
    config = RaceConfig(gait="left-right-origin", steps=8, lanes=lanes)
    race = Run(
        id=ONE,
        kind="race",
        name="It was stopped",
        state="stopped",
        config=config,
        lane_training_ids=(None, None),
        total=16,
    )
    store.create(race)
    assert imported(export_run(store, ONE)).config == config
    too_deep = replace(
        config, lanes=(replace(lanes[0], settings=SettingValues({"depth": 99})),) * 2
    )
    store.create(replace(race, id=OTHER, config=too_deep))
    assert "depth must be a whole number from 1 to 50" in refusal(export_run(store, OTHER))


def test_branch_of_a_race_is_exported_and_imported(source: RunStore, store: RunStore) -> None:
    original = source.get(RACED)
    assert isinstance(original.config, RaceConfig)
    branched = replace(
        original.config,
        world=World((SensorNoise(sd_m=0.004, at_step=3),)),
        branch_from=Branch(RACED, 3),
    )
    raced = result_of_race(original)
    models: tuple[PlanningModel | None, ...] = (None, "nominal")
    lanes = [
        replace(lane, plans_with=model, fell_at_step=None, heading_deg=1.5)
        for lane, model in zip(raced.lanes, models, strict=True)
    ]
    result = replace(raced, lanes=tuple(lanes))
    branch = replace(
        original, id=ONE, config=branched, result=result, lane_training_ids=(None, None)
    )
    learns = replace(branched.lanes[0], keep_learning=True)
    branch = replace(branch, config=replace(branched, lanes=(learns, branched.lanes[1])))
    store.create(branch)
    data = export_run(store, ONE)

    assert imported(data) == branch
    for name, value, path, names in (
        ("step", 8, ("branch_from",), "branch_from.step must be from 0 to 7, not 8"),
        ("race_id", "../x", ("branch_from",), "branch_from.race_id must be the id of a race"),
        ("plans_with", "hope", ("lanes", 1), "plans_with must be world, or start, or nominal"),
    ):
        assert names in refusal(rewritten(data, _set(name, value, "run", "config", *path)))


def test_training_that_was_disturbed_while_it_ran_is_exported_and_imported(
    source: RunStore, store: RunStore
) -> None:
    noise = {"kind": "sensor-noise", "at_step": 51, "until_step": 90, "sd_m": 0.004}
    changes = ({"step": 50, "disturbance": noise}, {"step": 60, "settings": {"alpha": 0.1}})
    run = replace(source.get(TRAINING), id=ONE, changes=changes)
    store.create(run)
    data = export_run(store, ONE)

    assert imported(data) == run
    for name, value, names in (
        ("sd_m", -1, "sd_m must be a number from 0 to 0.05 m"),
        ("at_step", 90, "until_step must be over at_step, 90"),
        ("kind", "fire", "choose one of: limp"),
    ):
        change = _set(name, value, "run", "changes", 0, "disturbance")
        assert names in refusal(rewritten(data, change))
    late_end = _set("until_step", 121, "run", "changes", 0, "disturbance")
    assert imported(rewritten(data, late_end)).changes[0]["disturbance"]["until_step"] == 121


def test_training_that_people_taught_is_exported_and_imported(
    source: RunStore, store: RunStore
) -> None:
    config = training_config("tamer", trainer="people", simulator="kinematic", gait="tripod")
    changes = ({"step": 50, "presses": [[48.25, 1.0], [49.5, -0.125]]},)
    store.create(training(ONE, config=config, state="interrupted", done=60, changes=changes))
    data = export_run(store, ONE)

    assert imported(data).changes == changes
    for presses in ([[48.25, 2.0]], [[48.25]], [["+", 1.0]], []):
        change = _set("presses", presses, "run", "changes", 0)
        assert refusal(rewritten(data, change))


def _set(name: str, value: Any, *path: str | int) -> Change:
    def change(content: Any) -> None:
        for key in path:
            content = content[key]
        content[name] = value

    return change


def _shorter(content: Any) -> None:
    content["run"] |= {"done": 119, "total": 119}


@pytest.mark.parametrize(
    ("change", "names"),
    [
        (_set("format", 1), "run.json of run.zip has format 1; this version reads 2 alone"),
        (_set("format", 3), "run.json of run.zip has format 3; this version reads 2 alone"),
        (_set("format", "1"), "run.json"),
        (_set("more", 1), "unknown field `more`"),
        (_set("more", 1, "run"), "unknown field `more`"),
        (_set("more", 1, "run", "result"), "more: Unexpected"),
        (_set("more", 1, "run", "config"), "more"),
        (_set("wings", 2, "run", "config", "robot"), "femur_m"),
        (_set("n_legs", 10**9, "run", "config", "robot"), "3 to 12 legs"),
        (_set("grid_side_m", 0.5, "run", "config"), "cannot reach"),
        (_set("steps", 10**9, "run", "config"), "10,000,000"),
        (_set("divisions", 3, "run", "config"), "divisions 2"),
        (_set("config", None, "run"), "run.json"),
        (_set("config", {"gait": ["left"]}, "run"), "run.json"),
        (_set("id", "../x", "run"), "run.json"),
        (_set("kind", "race", "run"), "lanes: Field required"),
        (_set("state", "running", "run"), "running"),
        (_set("name", "x" * 101, "run"), "name"),
        (_set("name", "a\x1b[2J", "run"), "control characters"),
        (_set("name", 3, "run"), "name"),
        (_set("name", "a\u202eb", "run"), "U+202E"),
        (_set("error", "x" * 10_001, "run"), "error"),
        (_set("created_at", "9999-12-31T23:59:59-12:00", "run"), "created_at must be from 1970"),
        (_set("created_at", "1969-12-31T23:59:59Z", "run"), "created_at must be from 1970"),
        (_set("started_at", "2999-01-01T00:00:00Z", "run"), "started_at"),
        (_set("ended_at", "0001-01-01T00:00:00+14:00", "run"), "ended_at"),
        (_set("greedy_distance_m", float("nan"), "run"), "run.json"),
        (_set("greedy_distance_m", 1e300, "run"), "greedy_distance_m"),
        (_set("distance_m", 1e300, "run", "result"), "distance_m"),
        (_set("changes", [{"step": 5, "settings": {"alpha": 7.0}}], "run"), "alpha"),
        (_set("changes", [{"step": 5, "pace": -1.0}], "run"), "pace"),
        (_set("curve", [{"step": 5, "distance_m": 1, "epsilon": 1.5}]), "epsilon"),
        (_set("curve", [{"step": 10**30, "distance_m": 1, "epsilon": 0}]), "step"),
        (_set("done", -1, "run"), "done"),
        (_set("done", 121, "run"), "progress"),
        (_set("created_at", "2026-01-01T00:00:00", "run"), "created_at"),
        (_set("created_at", "yesterday", "run"), "created_at"),
        (_set("distance_m", "far", "run", "result"), "distance_m"),
        (_set("q_table_sha256", "0" * 64, "run", "result"), "not those of the run's result"),
        (_set("curve", [{"step": 5, "distance_m": 1, "epsilon": 0}] * 2), "curve"),
        (_set("curve", [{"step": 5}]), "distance_m"),
        (_set("curve", [{"step": 5, "distance_m": None, "epsilon": 0}]), "distance_m"),
        (_set("lane_training_ids", [None], "run"), "has lanes"),
        (lambda content: content.pop("run"), "run"),
    ],
)
def test_invalid_run_json_of_a_training_is_refused(
    source: RunStore, change: Change, names: str
) -> None:
    assert names in refusal(rewritten(export_run(source, TRAINING), change))


@pytest.mark.parametrize(
    "change",
    [
        _set("lane_training_ids", [None], "run"),
        _set("lanes", [], "run", "result"),
        _set("curve", [{"step": 5, "distance_m": 1, "epsilon": 0}]),
        lambda content: content["run"]["result"]["lanes"].reverse(),
        lambda content: content["run"]["result"]["lanes"][0].update(decision_s=None),
        lambda content: content["run"]["result"]["lanes"][0]["clocks"].pop("wall"),
        lambda content: content["run"]["config"]["lanes"].pop(),
        lambda content: content["run"]["config"]["lanes"].reverse(),
        _set("steps", 3, "run", "config"),
        _set("divisions", 3, "run", "config"),
        lambda content: content["run"]["config"]["lanes"][0]["settings"].update(alpha=0.5),
        lambda content: content["run"]["config"]["lanes"][0].update(keep_learning="yes"),
        lambda content: content["run"]["config"]["lanes"][1].update(depth=2),
        lambda content: content["run"]["config"]["lanes"][1].update(keep_learning=True),
    ],
)
def test_invalid_run_json_of_a_race_is_refused(source: RunStore, change: Change) -> None:
    refusal(rewritten(export_run(source, RACED), change))


def test_malformed_json_is_refused(source: RunStore) -> None:
    data = export_run(source, RACED)
    for text in (b"", b"{", b"[]", b"null", b"[" * 100_000, b"\xff", b'{"format": 1e999}'):
        assert "run.json" in refusal(repacked(data, run_json=text))
    assert "run.json" in refusal(repacked(data, run_json=None))


def test_files_of_another_run_are_refused(source: RunStore) -> None:
    race, practice = export_run(source, RACED), export_run(source, TRAINING)
    table = source.artifact(TRAINING, TABLE)
    raced = source.artifact(RACED, RACE)
    assert "which no race has" in refusal(repacked(race, **{"q-table_npz": table}))
    assert "which no training has" in refusal(repacked(practice, race_npz=raced))
    assert "is not a Q-table" in refusal(repacked(practice, **{"q-table_npz": raced}))
    assert "cannot be shown" in refusal(repacked(practice, practice_npz=raced))
    assert "cannot be shown" in refusal(repacked(practice, **{"evaluations-0000_npz": None}))
    for junk in (b"", b"milk", b"PK\5\6" + bytes(18)):
        assert "cannot be shown" in refusal(repacked(race, race_npz=junk))


def _race_with(source: RunStore, change: Change) -> bytes:
    with np.load(io.BytesIO(source.artifact(RACED, RACE) or b"")) as file:
        arrays = {name: file[name] for name in file.files}
    change(arrays)
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    return repacked(export_run(source, RACED), race_npz=buffer.getvalue())


@pytest.mark.promises
def test_invalid_recordings_are_refused(source: RunStore) -> None:
    assert imported(_race_with(source, lambda arrays: None)).id == RACED

    def effort(
        shape: tuple[int, int] = (128, 18),
        dtype: str = "f2",
        torque: float = 1.0,
        work: Any = (1.0,) * 128,
    ) -> Change:
        recorded = {"torque_nm": np.full(shape, torque).astype(dtype), "work_j": np.array(work)}
        return lambda arrays: arrays.update({f"lane0.{k}": v for k, v in recorded.items()})

    assert imported(_race_with(source, effort())).id == RACED

    def put(name: str, value: Callable[[Any], Any]) -> Change:
        return lambda arrays: arrays.update({name: value(arrays[name])})

    for change in (
        put("lane0.qpos", lambda a: a[:, :-3]),
        put("lane0.qpos", lambda a: a * np.nan),
        put("lane0.qpos", lambda a: a.astype(str)),
        put("lane0.qpos", lambda a: a * 1e30),
        put("lane0.qpos", lambda a: a * 0),
        put("lane0.rest_qpos", lambda a: a[:-1]),
        put("lane0.time_s", lambda a: a[::-1]),
        put("lane0.time_s", lambda a: a * 0),
        effort((128, 17)),
        effort(torque=np.inf),
        effort(dtype="U3"),
        effort(dtype="f8"),
        effort(work=[[1.0]] * 128),
        effort(work=[-1.0] * 128),
        effort(work=[np.nan] * 128),
        put("lane0.frames", lambda a: a * 1000),
        put("lane0.frames", lambda a: -a),
        put("lane0.observation", lambda a: a + 100),
        put("lane0.observation", lambda a: a[:, :-1]),
        put("lane0.action", lambda a: a - 100),
        put("lane0.action", lambda a: a * 0.5),
        put("lane0.scalars", lambda a: a * np.nan),
        put("lane0.scalars", lambda a: a * [1, 1, 1, 0] + [0, 0, 0, 9e8]),
        put("lane0.values", lambda a: a[:, :1]),
        put("lane1.futures", lambda a: a + 1),
        put("lane1.future_actions", lambda a: a + 100),
        put("lane1.future_values", lambda a: a * np.nan),
        put("lane1.future_values", lambda a: a[:, :1]),
        put("lane1.future_counts", lambda a: a[1:]),
        put("meta", lambda a: np.array("[]")),
        put("meta", lambda a: np.array("[" * 100_000)),
    ):
        assert "cannot be shown" in refusal(_race_with(source, change))
    buffer = io.BytesIO()
    np.savez_compressed(buffer, meta=np.zeros(10_000_000))
    bomb = repacked(export_run(source, RACED), race_npz=buffer.getvalue())
    assert "compressed" in refusal(bomb)


def test_recordings_of_another_length_than_their_runs_are_refused(source: RunStore) -> None:
    """Replays would go on for years, or begin before their runs."""

    def scalars(column: int, change: Change) -> Change:
        def apply(table: Any) -> Any:
            table[:, column] = change(table[:, column])
            return table

        return apply

    def changed(name: str, array_name: str, change: Change) -> bytes:
        with np.load(io.BytesIO(source.artifact(TRAINING, name) or b"")) as file:
            arrays = {key: file[key] for key in file.files}
        arrays[array_name] = change(arrays[array_name])
        buffer = io.BytesIO()
        np.savez(buffer, **arrays)
        return repacked(export_run(source, TRAINING), **{name.replace(".", "_"): buffer.getvalue()})

    for name, array_name, change in (
        (PRACTICE, "scalars", scalars(0, lambda steps: steps * 1000)),
        (PRACTICE, "scalars", scalars(0, lambda steps: steps - 1)),
        (PRACTICE, "scalars", scalars(0, lambda steps: steps[::-1])),
        (evaluations_file(0), "scalars", scalars(0, lambda steps: steps * 1000)),
        (evaluations_file(0), "scalars", scalars(0, lambda steps: steps[::-1])),
    ):
        assert "cannot be shown" in refusal(changed(name, array_name, change)), (name, array_name)
    lane = "lane0.time_s"
    slow = _race_with(source, lambda arrays: arrays.update({lane: arrays[lane] * 2}))
    assert "take longer" in refusal(slow)


def test_invalid_logs_of_steps_are_refused(source: RunStore) -> None:
    name = transitions_file(0)
    with np.load(io.BytesIO(source.artifact(TRAINING, name) or b"")) as file:
        arrays = {key: file[key] for key in file.files}
    for change in (
        {"first": np.array(7)},
        {"observed": arrays["observed"] + 100},
        {"observed": arrays["observed"][1:]},
        {"actions": arrays["actions"] * 0},
        {"rewards_m": arrays["rewards_m"] * np.nan},
        {"rewards_m": arrays["rewards_m"].astype(str)},
        {"measured": np.array("x")},
    ):
        buffer = io.BytesIO()
        np.savez(buffer, **{**arrays, **change})
        changed = repacked(
            export_run(source, TRAINING), **{"transitions-0000_npz": buffer.getvalue()}
        )
        assert "cannot be shown" in refusal(changed)


def test_future_and_malformed_ids_are_replaced(source: RunStore, store: RunStore) -> None:
    for run_id in ("zzzzzzzzz0000", "0", "training", "1zzzzzzzzzzzz"):
        data, ids = rewritten(export_run(source, TRAINING), _set("id", run_id, "run")), RunIds()
        run = import_run(store, data, ids, "run.zip")
        assert run.id != run_id
        assert store.get(run.id) == replace(source.get(TRAINING), id=run.id)
        assert ids() > run.id


def test_new_ids_ignore_existing_ids_in_the_far_future(store: RunStore) -> None:
    believed = "1m7zzzzzz0000"  # of November 2026
    store.create(training("zzzzzzzzz0000", state="finished"), training(believed, state="finished"))
    first = RunIds.of(store)()
    assert believed < first < "zzzzzzzzz0000"
