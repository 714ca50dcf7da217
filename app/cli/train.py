"""`hexapods train`: train an agent to walk, and save its table."""

import argparse
import json

from app.cli.files import check_writable, write_whole
from app.cli.options import (
    CommandParser,
    add_observation,
    add_settings,
    add_walk_options,
    settings_from,
    walk_from,
)
from app.cli.terminal import progress
from hexapods.domain.errors import InvalidInput
from hexapods.domain.records import to_json
from hexapods.domain.settings import declared_fields
from hexapods.practice import train
from hexapods.runs.config import TrainingConfig, WalkingProblem
from hexapods.runs.records import Evaluated, StepTaken, TrainingRecord
from hexapods.trainings import Training, read_table

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
    if options.table and options.seed is not None:
        raise InvalidInput("--from goes on with the table's own generator; leave --seed out")
    table = read_table(options.table) if options.table else None
    if options.out:
        check_writable(options.out)
    given = {name: getattr(options, name) for name in _SETTINGS if name != "seed"}
    if options.seed is not None:
        given["seed"] = options.seed
    given |= {**walk_from(options), "observation": options.observation, **settings_from(options)}
    with progress() as bar:
        task = bar.add_task("practising", total=options.steps)

        def show(record: TrainingRecord) -> None:
            if isinstance(record, StepTaken):
                bar.update(task, completed=record.step)
            elif isinstance(record, Evaluated):
                bar.update(task, description=f"walks {record.distance_m:.2f} m")

        training = train(options.agent, table=table, on_record=show, **given)
    if options.out:
        write_whole(options.out, training.to_bytes())
    if options.json:
        curve = [point._asdict() for point in training.curve]
        result = to_json(training.result)
        print(json.dumps({"config": to_json(training.config), "result": result, "curve": curve}))
    else:
        _print_result(options, training)
    return 0


def _print_result(options: argparse.Namespace, training: Training) -> None:
    best_m = training.best_known_m
    print(
        f"After {training.config.steps:,} steps of practice it walks {training.distance_m:.2f} m "
        f"in 50 steps; one-step look-ahead walks {training.greedy_distance_m:.2f} m"
        f"{'' if best_m is None else f', the best known walk is {best_m:.2f} m'}."
    )
    if options.out:
        print(f"The table is in {options.out}.")
