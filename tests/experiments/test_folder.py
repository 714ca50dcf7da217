"""A results folder: no result is lost, run twice or mixed with another experiment's."""

import json
import resource
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest

from hexapods.domain.errors import DamagedFile, HexapodError, InvalidInput, OtherFormat
from hexapods.domain.robot import robot
from hexapods.experiments.config import ExperimentConfig, experiment_config
from hexapods.experiments.folder import TRIALS, ResultNotStored, open_results
from hexapods.experiments.trial import TrialResult, run_trial
from hexapods.experiments.worker import Outcome
from tests.experiments.clusters import small, trials_of

CONFIG = small(seeds=3)


@pytest.fixture(scope="module")
def outcomes() -> list[Outcome]:
    return [Outcome(t.key, run_trial(t.config), None, 0.5) for t in trials_of(CONFIG)]


@pytest.fixture
def folder(tmp_path: Path, outcomes: list[Outcome]) -> Path:
    """A folder with all results of an experiment."""
    path = tmp_path / "results"
    with open_results(path, CONFIG) as opened:
        opened.wall_s = 1.5
        for outcome in outcomes:
            opened.add(outcome)
    return path


def refusal(
    path: Path, config: ExperimentConfig = CONFIG, kind: type[HexapodError] = InvalidInput
) -> str:
    with pytest.raises(kind) as refused, open_results(path, config):
        pass
    return str(refused.value)


def change_head(path: Path, change: Callable[[dict[str, object]], object]) -> None:
    head, *lines = (path / TRIALS).read_text("utf-8").splitlines(keepends=True)
    read = json.loads(head)
    change(read)
    (path / TRIALS).write_text(json.dumps(read) + "\n" + "".join(lines), "utf-8")


@contextmanager
def no_file_over(size: int) -> Iterator[None]:
    """Simulate a full disk by RLIMIT_FSIZE: files can be read, but not grow beyond `size`."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_results_are_read_back_on_reopening(folder: Path, outcomes: list[Outcome]) -> None:
    with open_results(folder, CONFIG) as opened:
        assert opened.results == {outcome.key: outcome.result for outcome in outcomes}
        assert opened.set_aside == {}
        assert opened.compute_s == 0.5 * len(outcomes)
        assert opened.wall_s == 1.5


def test_times_of_the_wall_clock_are_stored_exactly(tmp_path: Path) -> None:
    config = experiment_config(
        "table1", {"seeds": 1, "simulator": "kinematic", "gaits": ("front-back-origin",)}
    )
    timed = trials_of(config)[-1]
    result = run_trial(timed.config)
    assert result.wall is not None
    with open_results(tmp_path, config) as opened:
        opened.add(Outcome(timed.key, result, None, 1.0))
    with open_results(tmp_path, config) as opened:
        assert opened.results[timed.key] == result


def test_a_trial_stays_set_aside_until_it_has_a_result(tmp_path: Path) -> None:
    result = TrialResult(distances_m=(0.5,))
    with open_results(tmp_path, CONFIG) as opened:
        opened.add(Outcome("a#0", None, "it broke", 0.1))
        opened.add(Outcome("b#0", None, "it broke too", 0.1))
    with open_results(tmp_path, CONFIG) as opened:
        assert opened.set_aside == {"a#0": "it broke", "b#0": "it broke too"}
        opened.add(Outcome("a#0", result, None, 0.1))
    with open_results(tmp_path, CONFIG) as opened:
        assert (opened.results, opened.set_aside) == ({"a#0": result}, {"b#0": "it broke too"})


def test_results_of_fewer_seeds_are_reused_for_more_seeds(
    folder: Path, outcomes: list[Outcome]
) -> None:
    more = replace(CONFIG, seeds=5)
    with open_results(folder, more) as opened:
        assert set(opened.results) < {trial.key for trial in trials_of(more)}
        assert len(opened.results) == len(outcomes)


@pytest.mark.parametrize("cut", [1, 40])
def test_a_partial_last_line_is_dropped(cut: int, folder: Path, outcomes: list[Outcome]) -> None:
    file = folder / TRIALS
    file.write_bytes(file.read_bytes()[:-cut])
    with open_results(folder, CONFIG) as opened:
        assert len(opened.results) == len(outcomes) - 1
        opened.add(outcomes[-1])
    with open_results(folder, CONFIG) as opened:
        assert len(opened.results) == len(outcomes)


def test_a_partial_header_is_written_again(folder: Path) -> None:
    (folder / TRIALS).write_bytes(b'{"format": 1, "ver')
    with open_results(folder, CONFIG) as opened:
        assert opened.results == {}
    assert refusal(folder, small(steps=31)).endswith("differs in --steps; choose another folder")


@pytest.mark.parametrize(
    "damaged",
    [
        b"milk\n",
        b"[]\n",
        b'{"key": "a#0"}\n',
        b'{"key": "a#0", "result": {"distances_m": "far"}, "set_aside": null, "compute_s": 1}\n',
    ],
)
def test_a_damaged_line_is_named(damaged: bytes, folder: Path) -> None:
    file = folder / TRIALS
    head, first, *lines = file.read_bytes().splitlines(keepends=True)
    file.write_bytes(b"".join([head, damaged, *lines, first]))
    assert "damaged in line 2; delete that line" in refusal(folder, kind=DamagedFile)
    assert first in file.read_bytes(), "nothing is lost"


@pytest.mark.parametrize(
    "head",
    [
        b"milk\n",
        b"[]\n",
        b"{}\n",
        b'{"format": 2, "versions": {}, "config": []}\n',
        b'{"format": 2, "versions": 1, "config": {}}\n',
    ],
)
def test_a_file_of_something_else_is_refused(head: bytes, folder: Path) -> None:
    (folder / TRIALS).write_bytes(head)
    assert "does not begin as results of an experiment do" in refusal(folder)
    assert (folder / TRIALS).read_bytes() == head


def test_results_of_another_version_are_refused(folder: Path) -> None:
    change_head(folder, lambda head: head["versions"].update(mujoco="3.3.7"))  # type: ignore[attr-defined]
    assert "has results of mujoco 3.3.7 instead of 4.0.0" in refusal(folder)


@pytest.mark.parametrize("version", [1, 3, "2", None])
def test_results_of_another_format_are_refused_and_left_as_they_are(
    version: object, folder: Path
) -> None:
    """Also the end of a line that a killed process has not written to its end."""
    change_head(folder, lambda head: head.update(format=version))
    with (folder / TRIALS).open("ab") as file:
        file.write(b'{"key": "left')
    before = (folder / TRIALS).read_bytes()
    sentence = refusal(folder, kind=OtherFormat)
    assert f"{TRIALS} has format {version!r}; this version reads 2 alone" in sentence
    assert (folder / TRIALS).read_bytes() == before


def test_results_of_another_kind_are_refused(folder: Path) -> None:
    head = json.loads((folder / TRIALS).read_text("utf-8").splitlines()[0])
    assert head["kind"] == "experiment"
    change_head(folder, lambda head: head.update(kind="tuning"))
    assert refusal(folder).endswith("has results of another experiment; choose another folder")


@pytest.mark.parametrize(
    ("other", "name"),
    [
        (replace(CONFIG, seed=1), "which differs in --seed;"),
        (replace(CONFIG, simulator="mujoco"), "which differs in --simulator;"),
        (replace(CONFIG, robots=(robot("compliant"),)), "which differs in --robot;"),
        (replace(CONFIG, steps_per_episode=(5,)), "which differs in --steps-per-episode;"),
        (replace(CONFIG, settings=CONFIG.settings | {"gamma": (0.5, 0.9)}), "differs in --gamma;"),
        (experiment_config("figure4", {"simulator": "kinematic"}), "another experiment, sweep;"),
    ],
)
def test_results_of_another_experiment_are_refused(
    other: ExperimentConfig, name: str, folder: Path
) -> None:
    sentence = refusal(folder, other)
    assert "results of another experiment" in sentence
    assert name in sentence


def test_a_folder_with_other_files_is_refused_and_left_unchanged(tmp_path: Path) -> None:
    (tmp_path / "report.html").write_text("mine")
    assert "is not empty, and has no results in it" in refusal(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]


def test_a_folder_that_cannot_be_created_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    assert "cannot keep results in" in refusal(tmp_path / "file")
    assert "cannot keep results in" in refusal(tmp_path / "file" / "results")


def test_a_folder_is_locked_by_one_process_at_a_time(folder: Path) -> None:
    with open_results(folder, CONFIG):
        assert "another process is adding results" in refusal(folder)
    with open_results(folder, CONFIG):
        pass


def test_a_full_disk_loses_nothing(tmp_path: Path, outcomes: list[Outcome]) -> None:
    first, second, *_ = outcomes
    with open_results(tmp_path, CONFIG) as opened:
        opened.add(first)
        size = (tmp_path / TRIALS).stat().st_size
        with no_file_over(size + 20), pytest.raises(ResultNotStored) as refused:
            opened.add(second)
        assert (tmp_path / TRIALS).stat().st_size == size
        assert list(opened.results) == [first.key]
        opened.add(second)
    assert "the disk is full; what was done is kept" in str(refused.value)
    with open_results(tmp_path, CONFIG) as opened:
        assert list(opened.results) == [first.key, second.key]


def test_a_disk_that_is_full_from_the_start_is_reported(tmp_path: Path) -> None:
    with no_file_over(10):
        assert "the disk is full" in refusal(tmp_path, kind=ResultNotStored)
    with open_results(tmp_path, CONFIG) as opened:
        assert opened.results == {}


def test_a_number_that_json_cannot_represent_is_not_stored(tmp_path: Path) -> None:
    with open_results(tmp_path, CONFIG) as opened, pytest.raises(ValueError, match="JSON"):
        opened.add(Outcome("a#0", TrialResult(distances_m=(float("nan"),)), None, 0.1))
    with pytest.raises(InvalidInput), open_results(tmp_path, small(steps=7)):
        pass
