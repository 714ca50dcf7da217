"""`hexapods sweep`: any grid of practice parameters over many seeds, with a report."""

import argparse
from collections.abc import Callable

from app.cli.experiment import agents_from
from app.cli.options import number, whole
from app.cli.trial_options import (
    add_machine_options,
    add_trial_options,
    split,
    trial_grid_from,
    where_from,
)
from app.cli.trials import run_experiment
from app.experiments.config import GRID, experiment_config
from app.runs.config import TrainingConfig

Read = Callable[[str], float]

_SUCH_AS = {
    "steps": "500,1000",
    "alpha": "0.1,0.3,0.6",
    "gamma": "0.5,0.9",
    "epsilon_start": "0.5,1",
    "epsilon_end": "0,0.1",
    "steps_per_episode": "25,50",
    "divisions": "2,3",
    "grid_side_m": "0.03,0.04",
}


def add_to(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describe the command."""
    parser = commands.add_parser("sweep", help="try a grid of parameters", description=__doc__)
    add_trial_options(parser, observations="measured", robots="stiff")
    parser.add_argument(
        "--agent",
        action="append",
        help="once for each, or with commas; my.module:Agent too (default q-learning)",
    )
    for name in GRID:
        default = getattr(TrainingConfig, name)
        read: Read = whole if isinstance(default, int) else number
        parser.add_argument(
            f"--{name.replace('_', '-')}",
            type=_list_of(read),
            metavar="LIST",
            help=f"such as {_SUCH_AS[name]} (default {default:g})",
        )
    add_machine_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run it, or go on with it.

    Raises:
        HexapodError: if the options cannot be followed.
    """
    given = {name: getattr(options, name) for name in GRID}
    agents = agents_from(options.agent)
    config = experiment_config("sweep", {**trial_grid_from(options), **given, "agents": agents})
    return run_experiment(config, where_from(options), options)


def _list_of(read: Read) -> Callable[[str], tuple[float, ...]]:
    return lambda text: tuple(read(part) for part in split(text))
