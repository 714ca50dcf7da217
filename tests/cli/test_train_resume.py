"""Ctrl-C in `hexapods train`, and `--resume`: the table is that of the unbroken training."""

import os
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import hexapods as hx
from hexapods.runs.tables import digest_of
from tests.cli.running import ROOT, in_process, output, refusal

LONG = ("--gait", "left-right-origin", "--simulator", "kinematic", "--steps", "2000")
AGENT = ("--agent", "slow:Slow", "--seed", "4", "--alpha", "0.2", "--evaluate-every", "0")
MODULE = """
import time
import hexapods as hx


class Slow(hx.Sarsa):
    def act(self, observation, legal):
        time.sleep(0.05)
        print("acts", flush=True)
        return super().act(observation, legal)
"""
"""All its steps take 100 s: on a busy machine SIGINT came after the end of those that took 4 s."""
FAST = MODULE.replace("time.sleep(0.05)", "pass").replace('print("acts", flush=True)', "pass")


def interrupted(*arguments: str, folder: Path, times: int = 1) -> subprocess.CompletedProcess[str]:
    """Run a command, and send it SIGINT once it practises, as a terminal does."""
    process = subprocess.Popen(
        [sys.executable, "-m", "app.cli", *arguments],
        cwd=folder,
        env={"PATH": "/usr/bin:/bin", "PYTHONPATH": str(ROOT), "HEXAPODS_DATA": str(folder / "d")},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "acts\n"
    for _ in range(times):
        os.kill(process.pid, signal.SIGINT)
        time.sleep(0.5 * (times > 1))  # two at once may be received as one
    out, err = process.communicate(timeout=60)
    return subprocess.CompletedProcess(arguments, process.returncode, out, err)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with an agent that tells when it acts."""
    (tmp_path / "slow.py").write_text(MODULE)
    return tmp_path


def test_ctrl_c_keeps_a_checkpoint_and_the_command_it_prints_ends_as_the_unbroken_one(
    folder: Path,
) -> None:
    train = ("train", *LONG, *AGENT)
    done = interrupted(*train, "--out", "my q.npz", folder=folder)
    assert done.returncode == 130, done.stderr
    assert not (folder / "my q.npz").exists(), "it would pass for a finished table"
    said, command = done.stderr.strip().splitlines()
    assert "of 2,000 steps, which are kept in my q.checkpoint.npz. To go on:" in said
    program, *arguments = shlex.split(command)
    assert program == "hexapods"

    again = interrupted(*arguments, folder=folder)
    assert (again.returncode, again.stderr.splitlines()[1]) == (130, command)
    (folder / "slow.py").write_text(FAST)
    resumed = in_process(*arguments, folder=folder)
    assert resumed.returncode == 0, resumed.stderr
    assert "After 2,000 steps of practice" in resumed.stdout
    assert not (folder / "my q.checkpoint.npz").exists()
    whole = in_process(*train, "--out", "whole.npz", folder=folder)
    assert whole.returncode == 0, whole.stderr
    tables = [hx.Training.load(folder / name) for name in ("my q.npz", "whole.npz")]
    assert tables[0].result == tables[1].result
    assert tables[0].table.meta == tables[1].table.meta
    assert digest_of(tables[0].table.arrays) == digest_of(tables[1].table.arrays)


def test_a_second_ctrl_c_ends_at_once(folder: Path) -> None:
    (folder / "slow.py").write_text(
        MODULE.replace("        return super()", "        time.sleep(600)\n        return super()")
    )
    done = interrupted("train", *LONG, *AGENT, "--out", "q.npz", folder=folder, times=2)
    assert (done.returncode, done.stderr) == (130, "interrupted\n")


def test_without_out_nothing_is_kept(folder: Path) -> None:
    assert interrupted("train", *LONG, *AGENT, folder=folder).returncode == 130
    assert not list(folder.glob("*.npz"))


def test_resume_takes_a_file_of_python_and_writes_where_it_is_told(tmp_path: Path) -> None:
    practice = hx.iter_train(simulator="kinematic", steps=40)
    for record in practice:
        if isinstance(record, hx.StepTaken) and record.step == 10:
            break
    practice.training.save(tmp_path / "half.npz")
    resume = ("train", "--resume", "half.npz")
    printed = output(*resume, "--out", "q.npz", folder=tmp_path, run=in_process)
    whole = hx.train(simulator="kinematic", steps=40)
    assert printed["result"]["q_table_sha256"] == whole.q_table_sha256
    assert (tmp_path / "half.npz").is_file(), "a file that the command has not written is kept"
    assert hx.Training.load(tmp_path / "q.npz").curve == whole.curve


def test_other_options_do_not_go_with_resume(tmp_path: Path) -> None:
    for option in (("--gait", "tripod"), ("--steps", "9"), ("--alpha", "0.2")):
        refusal_text = refusal(
            "train", "--resume", "q.npz", *option, folder=tmp_path, run=in_process
        )
        assert f"leave {option[0]} out" in refusal_text
    refusal_text = refusal("train", "--resume", "nothing.npz", folder=tmp_path, run=in_process)
    assert "cannot read the table nothing.npz" in refusal_text
