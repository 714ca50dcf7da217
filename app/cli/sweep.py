"""`hexapods sweep`: any grid of practice parameters over many seeds, with a report."""

import argparse
from collections.abc import Callable

from app.cli.experiment import agents_from
from app.cli.options import flag, parser_of
from app.cli.trial_options import (
    add_machine_options,
    add_trial_options,
    split,
    trial_grid_from,
    where_from,
)
from app.cli.trials import run_experiment
from app.domain.settings import Value, declared_fields
from app.experiments.config import GRID, experiment_config
from app.runs.config import TrainingConfig


def add_to(commands: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    """Describe the command."""
    parser = commands.add_parser("sweep", help="try a grid of parameters", description=__doc__)
    add_trial_options(parser, observations="measured", robots="stiff")
    parser.add_argument(
        "--agent",
        action="append",
        help="once for each, or with commas; my.module:Agent too (default q-learning)",
    )
    settings = declared_fields(TrainingConfig)
    for name in GRID:
        setting = settings[name]
        examples = ",".join(f"{value:g}" for value in setting.about.examples)
        parser.add_argument(
            flag(name),
            type=_list_of(parser_of(setting)),
            metavar="LIST",
            help=f"such as {examples}; each {setting.valid} (default {setting.default:g})",
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


def _list_of(read: Callable[[str], Value]) -> Callable[[str], tuple[Value, ...]]:
    return lambda text: tuple(read(part) for part in split(text))
