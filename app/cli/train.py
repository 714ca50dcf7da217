"""`hexapods train`: train an agent to walk, or go on with its training, and save its table."""

import argparse
import json
import shlex
import sys
from pathlib import Path
from typing import Any

from app.cli.exit_codes import FAILED, INTERRUPTED
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
from hexapods.interruption import Interrupted
from hexapods.practice import resume, train
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
    add_walk_options(parser, needs_gait=False)
    add_observation(parser, "how the agent reads the state")
    add_settings(parser, declared_fields(TrainingConfig), _SETTINGS)
    # None if not given: with --from, the table's generator state is used instead.
    parser.set_defaults(seed=None)
    parser.add_argument(
        "--agent", default=TrainingConfig.agent, help="registered name, or my.module:Agent"
    )
    parser.add_argument("--from", dest="table", metavar="Q.NPZ", help="continue from this table")
    parser.add_argument(
        "--resume",
        metavar="Q.CHECKPOINT.NPZ",
        help="go on with a training that was interrupted, exactly where it was; only --out and "
        "--json go with it",
    )
    parser.add_argument(
        "--out",
        metavar="Q.NPZ",
        help="file to save the table to; interrupted by Ctrl-C, the training is kept beside it, in "
        "Q.checkpoint.npz",
    )
    parser.add_argument("--json", action="store_true", help="print the result as JSON")
    parser.set_defaults(run=run, defaults=parser.get_default)


def run(options: argparse.Namespace) -> int:
    """Train an agent, print the result, and write the table; return the exit code.

    It is 1 if what was learned cannot be evaluated, and 130 after Ctrl-C.

    Raises:
        HexapodError: if the options are not valid, or a file cannot be read or written.
    """
    if options.resume:
        _check_nothing_else(options)
        options.out = options.out or options.resume
    elif options.gait is None:
        raise InvalidInput("give --gait, or --resume with the checkpoint of a training")
    if options.out:
        check_writable(options.out)
    try:
        training = _train(options)
    except Interrupted as interrupted:
        _say_how_to_go_on(options, interrupted)
        return INTERRUPTED
    if options.out:
        write_whole(options.out, training.to_bytes())
        if options.resume and Path(options.resume) == _checkpoint_of(options.out):
            Path(options.resume).unlink()
    if options.json:
        curve = [point._asdict() for point in training.curve]
        result = None if training.result is None else to_json(training.result)
        print(json.dumps({"config": to_json(training.config), "result": result, "curve": curve}))
    else:
        _print_result(options, training)
    return FAILED if training.result is None else 0


def _train(options: argparse.Namespace) -> Training:
    """Train as the options say, or go on, with a progress bar."""
    interrupted = read_table(options.resume) if options.resume else None
    steps = options.steps if interrupted is None else interrupted.config.steps
    with progress() as bar:
        task = bar.add_task("practising", total=steps)

        def show(record: TrainingRecord) -> None:
            if isinstance(record, StepTaken):
                bar.update(task, completed=record.step)
            elif isinstance(record, Evaluated):
                bar.update(task, description=f"walks {record.distance_m:.2f} m")

        if interrupted is not None:
            return resume(options.resume, on_record=show)
        return train(options.agent, on_record=show, **_arguments(options))


def _arguments(options: argparse.Namespace) -> dict[str, Any]:
    """Return arguments of `train`."""
    if options.table and options.seed is not None:
        raise InvalidInput("--from goes on with the table's own generator; leave --seed out")
    given = {name: getattr(options, name) for name in _SETTINGS if name != "seed"}
    if options.seed is not None:
        given["seed"] = options.seed
    given |= {**walk_from(options), "observation": options.observation, **settings_from(options)}
    table = read_table(options.table) if options.table else None
    checkpoint = _checkpoint_of(options.out) if options.out else None
    return {**given, "table": table, "checkpoint": checkpoint}


def _check_nothing_else(options: argparse.Namespace) -> None:
    """Check that beside `--resume` nothing is given that the checkpoint says.

    Raises:
        InvalidInput: naming an option.
    """
    free = ("command", "run", "defaults", "resume", "out", "json")
    for name, value in vars(options).items():
        if name not in free and value != options.defaults(name):
            option = "from" if name == "table" else name.replace("_", "-")
            raise InvalidInput(
                f"--resume goes on with all settings of its training; leave --{option} out"
            )


def _checkpoint_of(out: str) -> Path:
    """Return the path of the checkpoint of a training whose table goes to `out`."""
    return Path(f"{out.removesuffix('.npz')}.checkpoint.npz")


def _say_how_to_go_on(options: argparse.Namespace, interrupted: Interrupted) -> None:
    words = ["hexapods", "train", "--resume", str(interrupted.path), "--out", options.out]
    if options.json:
        words.append("--json")
    print(
        f"Interrupted after {interrupted.step:,} of {interrupted.steps:,} steps, which are kept in "
        f"{interrupted.path}. To go on:\n  {shlex.join(words)}",
        file=sys.stderr,
    )


def _print_result(options: argparse.Namespace, training: Training) -> None:
    best_m, steps = training.best_known_m, training.config.steps
    if training.result is None:
        print(f"After {steps:,} steps of practice it cannot be evaluated.")
    else:
        print(
            f"After {steps:,} steps of practice it walks {training.distance_m:.2f} m in 50 steps; "
            f"one-step look-ahead walks {training.greedy_distance_m:.2f} m"
            f"{'' if best_m is None else f', the best known walk is {best_m:.2f} m'}."
        )
    if options.out:
        print(f"The table is in {options.out}.")
