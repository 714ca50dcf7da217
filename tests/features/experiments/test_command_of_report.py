"""The command that a report shows repeats its experiment."""

import shlex
from typing import Any

import pytest

from app.cli.program import program_of
from app.features.experiments import experiment_command, sweep_command
from app.features.experiments.trial_options import TrialOptions
from hexapods.domain.gait import GaitSpec
from hexapods.domain.records import to_json
from hexapods.domain.robot import robot
from hexapods.experiments.config import ExperimentConfig, experiment_config
from hexapods.experiments.report.command import command
from tests.experiments.sample_experiments import ROBOTS

LRO = "left-right-origin"


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("table1", {}),
        ("figure4", {"seeds": 7, "seed": 3, "observations": ("commanded",)}),
        ("figure4", {"agents": ("q-learning", "tests.own_agents:Restless")}),
        ("sweep", {"alpha": (0.1, 0.3), "steps": (100, 200), "robots": ROBOTS}),
        ("sweep", {"robots": (robot("stiff"), robot({"friction": 0.3, "preset": "compliant"}))}),
        ("sweep", {"gaits": (LRO, GaitSpec(1, 2, pairs=((1, 2), (3, 4), (5, 6))))}),
        ("league", {}),
        ("league", {"agents": ("linear-model",), "steps": (50, 100), "tolerance": 0.1}),
        ("league", {"simulator": "kinematic", "worlds": ("noise",)}),
        ("recovery", {"worlds": ("limp:legs=1,4", "ice", "slope:degrees=4+payload:kg=1")}),
    ],
)
def test_the_command_on_the_page_reproduces_the_experiment(
    name: str, values: dict[str, Any]
) -> None:
    tried = experiment_config(name, values)
    typed = shlex.split(command(to_json(tried)))
    assert _understood(typed) == tried


def _understood(typed: list[str]) -> ExperimentConfig:
    """Parse a command line as `hexapods` does."""
    words = typed[1:]
    _, bound, _ = program_of(words).parse_args(words, print_error=False, exit_on_error=False)
    arguments = bound.arguments
    trials = arguments.pop("trials", TrialOptions())
    if words[0] == "sweep":
        return sweep_command.config_of(trials, arguments)
    worlds = arguments.get("worlds", experiment_command.WorldOptions())
    return experiment_command.config_of(arguments["experiment"], trials, worlds)
