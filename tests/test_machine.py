"""Cores and memory: as Dask finds them here, and under the limits of a container."""

from pathlib import Path

import pytest
from dask.system import CPU_COUNT
from distributed.system import MEMORY_LIMIT

from hexapods import machine


def test_cores_and_memory_are_those_that_dask_counts() -> None:
    assert (machine.cores(), machine.memory_bytes()) == (CPU_COUNT, MEMORY_LIMIT)


@pytest.mark.parametrize(
    "files",
    [
        {"cpu.max": "50000 100000\n", "memory.max": "1000000\n"},
        {
            "cpu/cpu.cfs_quota_us": "50000\n",
            "cpu/cpu.cfs_period_us": "100000\n",
            "memory/memory.limit_in_bytes": "1000000\n",
        },
    ],
    ids=["version 2", "version 1"],
)
def test_a_container_may_use_less(
    files: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(machine, "_CGROUPS", tmp_path)
    assert (machine.cores(), machine.memory_bytes()) == (1, 1_000_000)


def test_a_container_may_have_no_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "cpu.max").write_text("max 100000\n")
    (tmp_path / "memory.max").write_text("max\n")
    monkeypatch.setattr(machine, "_CGROUPS", tmp_path)
    assert (machine.cores(), machine.memory_bytes()) == (CPU_COUNT, MEMORY_LIMIT)
