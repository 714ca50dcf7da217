"""`hexapods experiment`: the paper's Table 1 or Figure 4 over many seeds, with a report."""

import argparse

from app.cli.options import CommandParser, split
from app.cli.trial_options import (
    add_machine_options,
    add_trial_options,
    cluster_from,
    trial_grid_from,
)
from app.cli.trials import run_experiment
from app.domain.errors import InvalidInput
from app.experiments.config import experiment_config

_NAMES = ("table1", "figure4")


def add_to(commands: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the command's parser."""
    parser = commands.add_parser(
        "experiment", help="repeat the paper's experiments", description=__doc__
    )
    parser.add_argument("experiment", choices=_NAMES, help="table1 or figure4")
    add_trial_options(
        parser, observations="both", robots="stiff,compliant for table1, stiff for figure4"
    )
    parser.add_argument(
        "--agent", action="append", help="who learns in figure4; once for each, or with commas"
    )
    add_machine_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the experiment, or resume it from its results folder.

    Raises:
        HexapodError: if the options are not valid.
    """
    agents = agents_from(options.agent)
    if agents is not None and options.experiment == "table1":
        raise InvalidInput("table1 has the paper's agents; --agent is for figure4 and sweep")
    config = experiment_config(options.experiment, {**trial_grid_from(options), "agents": agents})
    return run_experiment(config, cluster_from(options), options)


def agents_from(texts: list[str] | None) -> tuple[str, ...] | None:
    """Parse the agents named by `--agent`; None without the option."""
    return None if texts is None else tuple(agent for text in texts for agent in split(text))
