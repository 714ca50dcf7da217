"""`hexapods train`: train an agent to walk, and save its table."""

import argparse
import json
from typing import Any

from app.assembly import build_learner, finish_training
from app.cli.files import check_writable, read_table, write_whole
from app.cli.options import (
    CommandParser,
    add_observation,
    add_settings,
    add_walk_options,
    settings_from,
    walk_from,
)
from app.cli.terminal import progress
from app.domain.errors import InvalidInput
from app.domain.settings import declared_fields
from app.domain.world import check_ends
from app.runs.config import TrainingConfig, WalkingProblem, training_config
from app.runs.config_json import as_json
from app.runs.records import Evaluated, StepTaken
from app.runs.tables import Checkpoint, snapshot, to_bytes
from app.runs.training import Learner, train

_SETTINGS = tuple(
    name
    for name in declared_fields(TrainingConfig)
    # The command has no pace; `add_walk_options` adds the walking problem's options.
    if name not in (*declared_fields(WalkingProblem), "pace")
)


def add_to(commands: "argparse._SubParsersAction[CommandParser]") -> None:
    """Add the command's parser."""
    parser = commands.add_parser("train", help="train an agent", description=__doc__)
    parser.offers_settings = True
    add_walk_options(parser)
    add_observation(parser, "how the agent reads the state")
    add_settings(parser, declared_fields(TrainingConfig), _SETTINGS)
    # None if not given: with --from, the table's generator state is used instead.
    parser.set_defaults(seed=None)
    parser.add_argument(
        "--agent", default=TrainingConfig.agent, help="registered name, or my.module:Agent"
    )
    parser.add_argument("--from", dest="table", metavar="Q.NPZ", help="continue from this table")
    parser.add_argument("--out", metavar="Q.NPZ", help="file to save the table to")
    parser.add_argument("--json", action="store_true", help="print the result as JSON")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Train an agent, print the result, and write the table.

    Raises:
        HexapodError: if the options are not valid, or a file cannot be read or written.
    """
    table = read_table(options.table) if options.table else None
    config = _config(options, table)
    if options.out:
        check_writable(options.out)
    learner = build_learner(config, table)
    curve = _practise(learner, config)
    result = finish_training(learner, config)
    if options.out:
        write_whole(options.out, to_bytes(snapshot(learner, config)))
    if options.json:
        print(json.dumps({"config": as_json(config), "result": result, "curve": curve}))
    else:
        _print_result(options, config, result)
    return 0


def _config(options: argparse.Namespace, table: Checkpoint | None) -> TrainingConfig:
    seed = options.seed
    if table is not None:
        if seed is not None:
            raise InvalidInput("--from goes on with the table's own generator; leave --seed out")
        seed = table.meta["config"]["seed"]
    given = {name: getattr(options, name) for name in _SETTINGS} | settings_from(options)
    given["seed"] = TrainingConfig.seed if seed is None else seed
    config = training_config(
        options.agent, **walk_from(options), observation=options.observation, **given
    )
    check_ends(config.world.disturbances, config.steps)
    return config


def _practise(learner: Learner, config: TrainingConfig) -> list[dict[str, float]]:
    """Run the training loop with a progress bar, and return the evaluations."""
    curve = []
    with progress() as bar:
        task = bar.add_task("practising", total=config.steps)
        for record in train(learner, config):
            if isinstance(record, StepTaken):
                bar.update(task, completed=record.step)
            elif isinstance(record, Evaluated):
                bar.update(task, description=f"walks {record.distance_m:.2f} m")
                curve.append(
                    {
                        "step": record.step,
                        "distance_m": record.distance_m,
                        "epsilon": record.epsilon,
                    }
                )
    return curve


def _print_result(
    options: argparse.Namespace, config: TrainingConfig, result: dict[str, Any]
) -> None:
    best_m = result["best_known_m"]
    print(
        f"After {config.steps:,} steps of practice it walks {result['distance_m']:.2f} m in 50 "
        f"steps; one-step look-ahead walks {result['greedy_distance_m']:.2f} m"
        f"{'' if best_m is None else f', the best known walk is {best_m:.2f} m'}."
    )
    if options.out:
        print(f"The table is in {options.out}.")
