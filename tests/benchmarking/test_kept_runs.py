"""Runs that are kept beside a score file until all are done."""

from pathlib import Path

import pytest

from hexapods.benchmarking.kept_runs import kept_runs
from hexapods.benchmarking.runs import BenchmarkResult, BenchmarkRun
from hexapods.benchmarking.score_file import encode
from hexapods.domain.errors import DamagedFile, InvalidInput
from tests.benchmarking.sample_benchmarks import small, small_benchmark

pytestmark = pytest.mark.test

RUN = BenchmarkRun("tripod", 3, 0)
RESULT = BenchmarkResult(0.1234567890123456)


def test_what_was_kept_is_there_again_also_with_more_seeds(tmp_path: Path) -> None:
    with kept_runs(tmp_path / "s.json", small()) as progress:
        progress.add(RUN, RESULT)
        progress.add(BenchmarkRun("tripod", 6, 0), BenchmarkResult(0.0, "it broke"))
    with kept_runs(tmp_path / "s.json", small(seeds=9)) as progress:
        assert progress.results == {
            RUN: RESULT,
            BenchmarkRun("tripod", 6, 0): BenchmarkResult(0.0, "it broke"),
        }
        progress.delete()
    assert not list(tmp_path.iterdir())


def test_a_line_that_was_not_written_whole_is_run_again(tmp_path: Path) -> None:
    with kept_runs(tmp_path / "s.json", small()) as progress:
        progress.add(RUN, RESULT)
    file = tmp_path / "s.json.runs"
    file.write_bytes(file.read_bytes() + b'["tripod", 6')
    with kept_runs(tmp_path / "s.json", small()) as progress:
        assert progress.results == {RUN: RESULT}
        progress.add(BenchmarkRun("tripod", 6, 1), RESULT)
    with kept_runs(tmp_path / "s.json", small()) as progress:
        assert len(progress.results) == 2


def test_runs_of_a_score_file_count(tmp_path: Path) -> None:
    done = small_benchmark()
    (tmp_path / "s.json").write_bytes(encode(done.content))
    with kept_runs(tmp_path / "s.json", small(seeds=9)) as progress:
        assert len(progress.results) == 6
        first = done.content["tasks"][0]["budgets"][0]["distances_m"][0]
        assert progress.results[RUN] == BenchmarkResult(first)


def test_runs_of_another_benchmark_are_refused(tmp_path: Path) -> None:
    with kept_runs(tmp_path / "s.json", small()):
        pass
    with (
        pytest.raises(InvalidInput, match="runs of another benchmark; choose another --out"),
        kept_runs(tmp_path / "s.json", small(settings={"alpha": 0.5})),
    ):
        pass
    (tmp_path / "t.json").write_bytes(encode(small_benchmark().content))
    with (
        pytest.raises(InvalidInput, match="scores of another benchmark; choose another --out"),
        kept_runs(tmp_path / "t.json", small(seed=1)),
    ):
        pass
    (tmp_path / "u.json.runs").write_bytes(b"nothing\n")
    with (
        pytest.raises(DamagedFile, match="cannot be read"),
        kept_runs(tmp_path / "u.json", small()),
    ):
        pass


def test_two_processes_do_not_add_to_one_file(tmp_path: Path) -> None:
    with (
        kept_runs(tmp_path / "s.json", small()),
        pytest.raises(InvalidInput, match="another process is adding runs"),
        kept_runs(tmp_path / "s.json", small()),
    ):
        pass
