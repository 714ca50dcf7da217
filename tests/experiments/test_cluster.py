"""Workers of trials: processes of this machine, and an existing Dask cluster."""

import os
import signal
import socket
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import psutil
import pytest
from tornado.iostream import IOStream

from hexapods.domain.errors import InvalidInput
from hexapods.experiments import cluster
from hexapods.experiments.cluster import ClusterSpec, connect
from hexapods.experiments.engine import run_trials
from hexapods.experiments.local_workers import local_workers
from hexapods.experiments.worker import ClusterLost, WorkerDied
from hexapods.machine import cores
from tests.experiments.clusters import one_by_one, results, small, trials_of, workers_of
from tests.experiments.existing_cluster import scheduler
from tests.promises.length import only_whole
from tests.timeouts import LONG_S

pytestmark = pytest.mark.promises


@pytest.mark.parametrize(
    ("fields", "names"),
    [
        ({"workers": 0}, "workers must be from 1 to 512"),
        ({"workers": 1.5}, "a whole number"),
        ({"workers": 2, "scheduler": "tcp://10.0.0.7:8786"}, "either workers on this machine or"),
        ({"scheduler": "10.0.0.7"}, "tcp://HOST:PORT or tls://HOST:PORT, not '10.0.0.7'"),
        ({"scheduler": "http://10.0.0.7:8786"}, "tcp://HOST:PORT"),
        ({"tls_ca": "ca.pem"}, "for a scheduler at tls://HOST:PORT"),
        ({"scheduler": "tls://10.0.0.7:8786"}, "needs a CA, a certificate and its key"),
        ({"scheduler": "tcp://10.0.0.7:8786", "tls_ca": "ca.pem"}, "one at tcp:// none"),
        (
            {"scheduler": "tls://h:1", "tls_ca": "a.pem", "tls_cert": "b.pem", "tls_key": "c.pem"},
            "there is no file a.pem",
        ),
    ],
)
def test_an_invalid_cluster_spec_is_refused(fields: dict[str, Any], names: str) -> None:
    with pytest.raises(InvalidInput) as refused:
        ClusterSpec(**fields)
    assert names in str(refused.value)


def ports_of(process: psutil.Process) -> set[Any]:
    """Addresses at which a process and its children, those of earlier tests too, listen."""
    everyone = (process, *process.children(recursive=True))
    return {
        connection.laddr
        for process_or_child in everyone
        for connection in process_or_child.net_connections()
        if connection.status == psutil.CONN_LISTEN
    }


def test_workers_of_this_machine_open_no_port_and_leave_no_files_or_processes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    me = psutil.Process()
    before = ports_of(me)
    with connect(ClusterSpec()) as workers:
        assert workers.count() == len(workers_of(me)) == cores()
        assert ports_of(me) <= before
    assert not workers_of(me)
    assert list(tmp_path.iterdir()) == []


def test_a_worker_that_takes_too_much_memory_is_killed() -> None:
    endless = trials_of(small(seeds=1, steps=9_000_000))[-1]
    with local_workers(1, most_bytes=1 << 20) as workers:
        task = workers.submit([endless])
        with pytest.raises(WorkerDied):
            workers.result(task)
    assert not workers_of(psutil.Process())


def test_a_program_that_its_workers_cannot_import_gets_an_error_with_the_guard(
    tmp_path: Path,
) -> None:
    script = tmp_path / "unguarded.py"
    script.write_text(
        "from hexapods.experiments.cluster import ClusterSpec\n"
        "from hexapods.experiments.engine import run_trials\n"
        "from hexapods.agents.q_learning import QLearning\n"
        "from tests.experiments.clusters import small, trials_of\n"
        "class Mine(QLearning):\n"
        "    pass\n"
        "list(run_trials(trials_of(small(seeds=1)), ClusterSpec(workers=1)))\n",
        "utf-8",
    )
    ended = subprocess.run(
        [sys.executable, str(script)],
        env={**os.environ, "PYTHONPATH": str(Path.cwd())},
        check=False,
        capture_output=True,
        text=True,
        timeout=LONG_S,
    )
    assert ended.returncode == 1
    assert "the workers import the program for its agents" in ended.stderr.splitlines()[-1]
    assert 'if __name__ == "__main__":' in ended.stderr.splitlines()[-1]


def test_workers_end_when_the_process_that_started_them_is_killed(tmp_path: Path) -> None:
    script = tmp_path / "endless.py"
    script.write_text(
        "import sys\n"
        "from hexapods.experiments.cluster import ClusterSpec\n"
        "from hexapods.experiments.engine import run_trials\n"
        "from tests.experiments.clusters import small, trials_of\n"
        "if __name__ == '__main__':\n"
        "    trials = trials_of(small(seeds=1)) + trials_of(small(seeds=9, steps=9_000_000))\n"
        "    for outcome in run_trials(trials, ClusterSpec(workers=2)):\n"
        "        assert not {'dask', 'distributed'} & set(sys.modules)\n"
        "        print(outcome.key, flush=True)\n",
        "utf-8",
    )
    # A short path: it is part of the names of sockets, which have at most 107 bytes.
    temporary = Path(tempfile.mkdtemp(prefix="trials-"))
    process = subprocess.Popen(
        [sys.executable, str(script)],
        env={**os.environ, "PYTHONPATH": str(Path.cwd()), "TMPDIR": str(temporary)},
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert "greedy" in process.stdout.readline()
    children = psutil.Process(process.pid).children(recursive=True)
    assert len(workers_of(psutil.Process(process.pid))) == 2
    process.send_signal(signal.SIGKILL)
    process.communicate()
    _, left = psutil.wait_procs(children, timeout=LONG_S)
    assert not left
    assert list(temporary.iterdir()) == []
    temporary.rmdir()


def test_an_existing_cluster_gives_the_same_results_until_its_scheduler_dies(
    tmp_path: Path,
) -> None:
    trials = trials_of(small(seeds=20))
    with scheduler(tmp_path, tls=True) as cluster:
        cluster.worker()
        assert results(run_trials(trials, cluster.where)) == one_by_one(trials)
        running = run_trials(trials, cluster.where)
        next(running)
        assert cluster.process.poll() is None, "a shared cluster must not be shut down"
        cluster.process.kill()
        with pytest.raises(ClusterLost, match="what was done is kept"):
            list(running)


@pytest.mark.parametrize("workers_are_counted_every_s", [pytest.param(60.0, marks=only_whole), 0.0])
def test_a_scheduler_that_dies_as_the_client_reconnects_is_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, workers_are_counted_every_s: float
) -> None:
    monkeypatch.setattr("hexapods.experiments.engine._WORKER_COUNT_S", workers_are_counted_every_s)

    def connection_that_closed_meanwhile(stream: IOStream, *_: object, **__: object) -> None:
        stream.close()
        raise ValueError("IOStream is not idle; cannot convert to SSL")

    with scheduler(tmp_path, tls=True) as cluster:
        cluster.worker()
        running = run_trials(trials_of(small(seeds=20)), cluster.where)
        next(running)
        # Tornado raises this if the connection is closed between connecting and the handshake.
        monkeypatch.setattr(
            "tornado.tcpclient.IOStream.start_tls", connection_that_closed_meanwhile
        )
        cluster.process.kill()
        cluster.process.wait()
        port = int(str(cluster.where.scheduler).rpartition(":")[2])
        with (
            socket.create_server(("127.0.0.1", port)),
            pytest.raises(ClusterLost, match="what was done is kept"),
        ):
            list(running)


def test_a_worker_with_other_versions_is_refused_by_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Another engine cannot be had without its package: this one says that it is another.
    (tmp_path / "sitecustomize.py").write_text(
        "import mujoco\nmujoco.mj_versionString = lambda: '3.3.7'\nmujoco.__version__ = '3.3.7'\n"
    )
    with scheduler(tmp_path) as started:
        monkeypatch.setattr(cluster, "ANSWER_S", 1.0)
        with pytest.raises(InvalidInput, match=r"has no workers; start some with `dask worker tcp"):
            list(run_trials(trials_of(small(seeds=1)), started.where))
        monkeypatch.undo()
        started.worker(PYTHONPATH=f"{tmp_path}:{Path.cwd()}")
        with pytest.raises(InvalidInput, match=r"it has mujoco 3\.3\.7 instead of 4\.0\.0"):
            list(run_trials(trials_of(small(seeds=1)), started.where))


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "tcp://127.0.0.1:99999", "tcp://[::1:9"])
def test_a_scheduler_that_does_not_answer_is_refused_with_its_address(address: str) -> None:
    with pytest.raises(InvalidInput) as refused:
        list(run_trials(trials_of(small(seeds=1)), ClusterSpec(scheduler=address)))
    for words in (address, "dask scheduler", "leave --scheduler out"):
        assert words in str(refused.value)


def test_a_server_that_is_not_a_scheduler_is_refused_within_the_timeout(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert cluster.ANSWER_S < 10
    monkeypatch.setattr(cluster, "ANSWER_S", 1.0)
    with socket.create_server(("127.0.0.1", 0)) as listening:
        address = f"tcp://127.0.0.1:{listening.getsockname()[1]}"
        with pytest.raises(InvalidInput, match=f"no scheduler answers at {address}"):
            list(run_trials(trials_of(small(seeds=1)), ClusterSpec(scheduler=address)))
