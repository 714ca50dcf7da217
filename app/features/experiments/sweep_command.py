"""`hexapods sweep`: try a grid of practice parameters over many seeds, and write a report."""

import argparse

from app.cli.options import CommandParser, add_list, add_settings, settings_from
from app.features.experiments.command_trials import run_experiment
from app.features.experiments.experiment_command import agents_from
from app.features.experiments.trial_options import (
    add_machine_options,
    add_trial_options,
    cluster_from,
    trial_grid_from,
)
from hexapods.domain.settings import declared_fields
from hexapods.experiments.config import experiment_config
from hexapods.experiments.presets import GRID
from hexapods.runs.config import TrainingConfig


def add_to(commands: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the command's parser."""
    parser = commands.add_parser("sweep", help="try a grid of parameters", description=__doc__)
    parser.offers_settings = parser.takes_lists = True
    add_trial_options(parser, observations="measured", robots="stiff")
    parser.add_argument(
        "--agent",
        action="append",
        help="agents, or my.module:Agent; repeat, or separate by commas (default q-learning)",
    )
    settings = declared_fields(TrainingConfig)
    for name in GRID:
        add_list(parser, settings[name])
    add_settings(parser, settings, ("reward",))
    add_machine_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the sweep, or resume it from its results folder.

    Raises:
        HexapodError: if the options are not valid.
    """
    names = (*GRID, "reward")
    given = {name: getattr(options, name) for name in names} | settings_from(options)
    agents = agents_from(options.agent)
    config = experiment_config("sweep", {**trial_grid_from(options), **given, "agents": agents})
    return run_experiment(config, cluster_from(options), options)
