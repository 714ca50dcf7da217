"""`hexapods experiment`: the paper's experiments and others, over many seeds."""

import argparse

from app.cli.options import CommandParser, parser_of, split
from app.features.experiments.command_trials import run_experiment
from app.features.experiments.trial_options import (
    add_machine_options,
    add_trial_options,
    cluster_from,
    trial_grid_from,
)
from hexapods.domain.errors import InvalidInput
from hexapods.domain.settings import declared_fields
from hexapods.domain.world import WORLDS
from hexapods.experiments.config import ExperimentConfig, experiment_config
from hexapods.experiments.formatting import listed
from hexapods.experiments.presets import PRESETS
from hexapods.runs.config import TrainingConfig


def _names() -> list[str]:
    """Return the presets that this command starts; others have a command of their own."""
    return [name for name, preset in PRESETS.items() if preset.command == f"experiment {name}"]


def add_to(commands: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the command's parser."""
    parser = commands.add_parser(
        "experiment", help="repeat experiments over many seeds", description=__doc__
    )
    parser.add_argument("experiment", choices=_names(), help=listed(_names(), "or"))
    add_trial_options(
        parser, observations="both", robots="stiff,compliant for table1, stiff for figure4"
    )
    parser.add_argument(
        "--agent",
        action="append",
        help="agents to compare (learners; in a league also searches); repeat, or separate by "
        "commas",
    )
    parser.add_argument(
        "--world",
        action="append",
        metavar="WORLD",
        help=f"one or more of {', '.join(WORLDS)}, or a disturbance such as limp:legs=1,4",
    )
    settings = declared_fields(TrainingConfig)
    parser.add_argument(
        "--tolerance",
        type=parser_of(settings["tolerance"]),
        help="build tolerance of the robots (league, recovery), as a fraction (default 0.03)",
    )
    parser.add_argument(
        "--reward",
        type=parser_of(settings["reward"]),
        help=f"{settings['reward'].about.help} Of all but the paper's.",
    )
    parser.add_argument(
        "--steps",
        type=lambda text: tuple(parser_of(settings["steps"])(part) for part in split(text)),
        metavar="LIST",
        help="steps of practice: in a league in all (default 250), in a recovery before the "
        "disturbance (default 100)",
    )
    add_machine_options(parser)
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Run the experiment, or resume it from its results folder.

    Raises:
        HexapodError: if the options are not valid.
    """
    return run_experiment(config_from(options), cluster_from(options), options)


def config_from(options: argparse.Namespace) -> ExperimentConfig:
    """Return the experiment that the options ask for.

    Raises:
        HexapodError: if the options are not valid.
    """
    given = {
        "agents": agents_from(options.agent),
        "worlds": _worlds_from(options.world),
        "tolerance": options.tolerance,
        "steps": options.steps,
        "reward": options.reward,
    }
    for field, value in given.items():
        takers = [name for name in _names() if field in PRESETS[name].fields]
        if value is not None and options.experiment not in takers:
            option = ExperimentConfig.option_of(field)
            raise InvalidInput(f"{option} is for {listed(takers)}, not {options.experiment}")
    return experiment_config(options.experiment, {**trial_grid_from(options), **given})


def _worlds_from(texts: list[str] | None) -> tuple[str, ...] | None:
    """Return the worlds of `--world`, separated by commas; what happens may have commas too."""
    if texts is None:
        return None
    worlds: list[str] = []
    for part in (part for text in texts for part in split(text)):
        # Names of worlds and kinds begin with a letter, so a number belongs to a list of legs.
        if worlds and ":" in worlds[-1] and part[:1].isdecimal():
            worlds[-1] += f",{part}"
        else:
            worlds.append(part)
    return tuple(worlds)


def agents_from(texts: list[str] | None) -> tuple[str, ...] | None:
    """Parse the agents named by `--agent`; None without the option."""
    return None if texts is None else tuple(agent for text in texts for agent in split(text))
