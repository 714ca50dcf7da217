"""The example of a deep network learns on the Gymnasium environment, and races like any agent."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.running import EXAMPLES, ROOT, output

HERE = ("--gait", "front-back-origin", "--simulator", "kinematic")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The example, and what it has learned in a thousand steps."""
    folder = tmp_path_factory.mktemp("dqn")
    shutil.copy(EXAMPLES / "dqn_agent.py", folder)
    practice = [sys.executable, "-W", "error", "dqn_agent.py", *HERE, "--steps", "1000"]
    variables = {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        practice, cwd=folder, env=variables, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("After 1,000 steps it walks 0.4")
    return folder


def test_it_wins_on_time_and_walks_about_as_far_as_greedy(folder: Path) -> None:
    lanes = ("--lane", "dqn_agent:Agent=dqn.npz", "--lane", "greedy")
    network, greedy = output("race", *HERE, *lanes, folder=folder)["result"]["lanes"]

    assert network["failure"] is None
    assert network["total_distance_m"] > 0.8 * greedy["total_distance_m"]
    assert network["simulated_transitions"] == 0
    assert network["clocks"]["paper"]["rank"] == 1


def test_in_the_race_it_needs_nothing_that_its_practice_needed(folder: Path) -> None:
    code = """
import sys
sys.modules |= dict.fromkeys(["gymnasium", "stable_baselines3", "torch"])
from app.cli import main
sys.argv = "hexapods race --gait front-back-origin --steps 1 --lane dqn_agent:Agent=dqn.npz".split()
sys.exit(main())
"""
    subprocess.run([sys.executable, "-c", code], cwd=folder, check=True, timeout=60)
