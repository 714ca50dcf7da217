"""`hexapods train`: train an agent to walk, or go on with its training, and save its table."""

import json
import shlex
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Group, Parameter

from app.cli.exit_codes import FAILED, INTERRUPTED
from app.cli.files import check_writable, write_whole
from app.cli.options import WALKING_PROBLEM, AsJson, Data, Gait, KeepOptions, WalkOptions, read_gait
from app.cli.setting_options import AgentOptions, DeclaredOptions, flag
from app.cli.terminal import progress
from app.settings import Settings, read_settings
from hexapods import practice
from hexapods.agents.registry import learns
from hexapods.domain.errors import InvalidInput
from hexapods.domain.gait import DEFAULT_GAIT
from hexapods.domain.observation import Observation
from hexapods.domain.records import to_json
from hexapods.domain.settings import declared_fields
from hexapods.interruption import Interrupted
from hexapods.runs.config import TrainingConfig, WalkingProblem, usable_agents
from hexapods.runs.records import Evaluated, StepTaken, TrainingRecord
from hexapods.trainings import Training, learned_by, read_table

_WALK_SETTINGS = declared_fields(WalkingProblem)
_PRACTICE_SETTINGS = {
    name: setting
    for name, setting in declared_fields(TrainingConfig).items()
    if name not in (*_WALK_SETTINGS, "pace")  # the command has no pace
}
_PRACTICE = Group("Practice", sort_key=(2, 0))
_LEARNERS = tuple(filter(learns, usable_agents()))
_WALK = WalkOptions()
_NOT_KEPT = KeepOptions()


def train(
    *,
    gait: Gait = DEFAULT_GAIT,
    walk: WalkOptions = _WALK,
    observation: Annotated[Observation, Parameter(group=_PRACTICE)] = TrainingConfig.observation,
    agent: Annotated[
        str,
        Parameter(
            metavar="NAME",
            group=_PRACTICE,
            completer=lambda _: _LEARNERS,
            help=f"{', '.join(_LEARNERS)}, or my.module:Agent; see `--agent NAME --help`",
        ),
    ] = TrainingConfig.agent,
    table: Annotated[str | None, Parameter(name="--from", metavar="FILE")] = None,
    checkpoint: Annotated[str | None, Parameter(name="--resume", metavar="FILE")] = None,
    out: Annotated[str | None, Parameter(metavar="FILE")] = None,
    keeping: KeepOptions = _NOT_KEPT,
    data: Data = None,
    as_json: AsJson = False,
    **settings: Annotated[
        Any,
        DeclaredOptions(_WALK_SETTINGS, group=WALKING_PROBLEM),
        DeclaredOptions(_PRACTICE_SETTINGS, group=_PRACTICE),
        AgentOptions(),
    ],
) -> int:
    """Train an agent to walk, or go on with its training, and save its table.

    Exit code 1: what was learned cannot be evaluated. Exit code 130: Ctrl-C.

    Args:
        observation: how the agent reads the state
        table: continue from this table
        checkpoint: go on from a checkpoint, exactly; only with --out, --json
        out: file for the table (q.npz); Ctrl-C keeps q.checkpoint.npz

    Raises:
        HexapodError: if the options are not valid, or a file cannot be read or written.
    """
    keeping.check()
    if checkpoint:
        kept = {"keep": keeping.keep, "gait": gait, "observation": observation, "agent": agent}
        _check_nothing_else({**asdict(walk), **kept, "from": table}, settings)
        out = out or checkpoint
    if out:
        check_writable(out)
    if not checkpoint:
        problem = {"gait": read_gait(gait), **walk.fields(), "observation": observation}
        settings = {**problem, **settings}
    if keeping.keep:
        kept_in = read_settings(data=data)
        return _keep(agent, settings, table, kept_in, name=keeping.name, out=out, as_json=as_json)
    try:
        training = _resume(checkpoint) if checkpoint else _train(agent, settings, table, out)
    except Interrupted as interrupted:
        _say_how_to_go_on(interrupted, out, as_json)
        return INTERRUPTED
    if out:
        write_whole(out, training.to_bytes())
        if checkpoint and Path(checkpoint) == _checkpoint_of(out):
            Path(checkpoint).unlink()
    if as_json:
        print(json.dumps(_as_json(training)))
    else:
        _print_result(training, out)
    return FAILED if training.result is None else 0


def _as_json(training: Training) -> dict[str, Any]:
    curve = [point._asdict() for point in training.curve]
    result = None if training.result is None else to_json(training.result)
    return {"config": to_json(training.config), "result": result, "curve": curve}


def _keep(
    agent: str,
    options: Mapping[str, Any],
    table: str | None,
    kept_in: Settings,
    *,
    name: str | None,
    out: str | None,
    as_json: bool,
) -> int:
    """Train, and keep the training in the data folder, with a progress bar."""
    # Imported here, as the database modules would slow the start of other commands.
    from app.cli import kept_runs  # noqa: PLC0415

    kept_runs.check_keepable([agent])
    _check_no_seed(table, options)
    trained = read_table(table) if table else None
    if trained is not None:
        learned_by(agent, trained)
    config = practice.config_of(agent, trained, options)
    kept, training = kept_runs.keep_training(kept_in, config, name=name, table=table)
    if training is None:
        return kept.report_unfinished()
    if out:
        write_whole(out, training.to_bytes())
    if as_json:
        print(json.dumps({"id": kept.id, "name": kept.progress.name, **_as_json(training)}))
        return 0
    _print_result(training, out)
    kept.print_where()
    return 0


def _train(agent: str, options: Mapping[str, Any], table: str | None, out: str | None) -> Training:
    """Train an agent, from a table if there is one, with a progress bar."""
    _check_no_seed(table, options)
    with _progress(options.get("steps", TrainingConfig.steps)) as show:
        return practice.train(
            agent,
            on_record=show,
            table=read_table(table) if table else None,
            checkpoint=_checkpoint_of(out) if out else None,
            **options,
        )


def _check_no_seed(table: str | None, options: Mapping[str, Any]) -> None:
    if table and "seed" in options:
        raise InvalidInput("--from goes on with the table's own generator; leave --seed out")


def _resume(checkpoint: str) -> Training:
    """Go on with a training, with a progress bar."""
    with _progress(read_table(checkpoint).config.steps) as show:
        return practice.resume(checkpoint, on_record=show)


@contextmanager
def _progress(steps: int) -> Iterator[Callable[[TrainingRecord], None]]:
    """Show a progress bar; yield the function that shows a record in it."""
    with progress() as bar:
        task = bar.add_task("practising", total=steps)

        def show(record: TrainingRecord) -> None:
            if isinstance(record, StepTaken):
                bar.update(task, completed=record.step)
            elif isinstance(record, Evaluated):
                bar.update(task, description=f"walks {record.distance_m:.2f} m")

        yield show


def _check_nothing_else(options: Mapping[str, Any], settings: Mapping[str, Any]) -> None:
    """Check that beside `--resume` nothing is given that the checkpoint says.

    Raises:
        InvalidInput: naming an option.
    """
    defaults = {
        **asdict(_WALK),
        "gait": DEFAULT_GAIT,
        "observation": TrainingConfig.observation,
        "agent": TrainingConfig.agent,
        "keep": False,
    }
    changed = [name for name, value in options.items() if value != defaults.get(name)]
    for name in (*changed, *settings):
        raise InvalidInput(
            f"--resume goes on with all settings of its training; leave {flag(name)} out"
        )


def _checkpoint_of(out: str) -> Path:
    """Return the path of the checkpoint of a training whose table goes to `out`."""
    return Path(f"{out.removesuffix('.npz')}.checkpoint.npz")


def _say_how_to_go_on(interrupted: Interrupted, out: str | None, as_json: bool) -> None:
    # Without --out there is no checkpoint, and Ctrl-C ends the command.
    words = ["hexapods", "train", "--resume", str(interrupted.path), "--out", out or ""]
    if as_json:
        words.append("--json")
    print(
        f"Interrupted after {interrupted.step:,} of {interrupted.steps:,} steps, which are kept in "
        f"{interrupted.path}. To go on:\n  {shlex.join(words)}",
        file=sys.stderr,
    )


def _print_result(training: Training, out: str | None) -> None:
    best_m, steps = training.best_known_m, training.config.steps
    if training.result is None:
        print(f"After {steps:,} steps of practice it cannot be evaluated.")
    else:
        print(
            f"After {steps:,} steps of practice it walks {training.distance_m:.2f} m in 50 steps; "
            f"one-step look-ahead walks {training.greedy_distance_m:.2f} m"
            f"{'' if best_m is None else f', the best known walk is {best_m:.2f} m'}."
        )
    if out:
        print(f"The table is in {out}.")
