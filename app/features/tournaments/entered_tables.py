"""Tables of trainings that enter a tournament: what they have practised must be known."""

from app.features.tournaments.tournament import EnteredTable
from app.storage.database.store import RunStore
from app.storage.errors import NotFound
from app.storage.run import TABLE, Run
from hexapods.domain.errors import InvalidInput
from hexapods.domain.robot import Robot
from hexapods.runs.config import TrainingConfig
from hexapods.runs.tables import from_bytes
from hexapods.tournaments.entry import EntryConfig, check_table
from hexapods.tournaments.rules import TournamentRules
from hexapods.tournaments.tournament_file import sha256_of

MAX_TABLE_BYTES = 2 << 20


def entry_of_training(
    store: RunStore, rules: TournamentRules, training_id: str, agent: str, robot: Robot | None
) -> tuple[EntryConfig, EnteredTable]:
    """Return the entry of a finished training, and a copy of its table.

    Args:
        store: of the runs.
        rules: of the tournament.
        training_id: of the training.
        agent: that the entry names, which must be the training's.
        robot: that walks with the table; None for that of the rules.

    Raises:
        InvalidInput, TableMismatch, UnknownName: if the training has not finished, its practice is
            not known or beyond the budget, or the rules do not allow its table.
        DamagedFile: if its table is damaged.
    """
    run = _training(store, training_id)
    config = run.config
    if run.state != "finished" or not isinstance(config, TrainingConfig):
        raise InvalidInput(f"training {training_id} is {run.state}; one that is finished may enter")
    if config.agent != agent:
        raise InvalidInput(
            f"training {training_id} is of {config.agent}; name that as the agent", field="agent"
        )
    practised = _practised(store, run)
    if practised > rules.steps:
        raise InvalidInput(
            f"training {training_id} has practised {practised:,} steps, with all that it "
            f"continues; the budget of this tournament is {rules.steps:,}"
        )
    data = store.artifact(run.id, TABLE)
    if data is None:
        raise InvalidInput(f"training {training_id} has no table")
    if len(data) > MAX_TABLE_BYTES:
        raise InvalidInput(
            f"the table of training {training_id} has {len(data):,} bytes; one that enters has at "
            f"most {MAX_TABLE_BYTES:,}"
        )
    entry = EntryConfig(
        agent=agent, observation=config.observation, robot=robot, table=sha256_of(data)
    )
    check_table(entry, rules, from_bytes(data, f"the table of training {training_id}"))
    return entry, EnteredTable(training_id, sha256_of(data), data)


def _practised(store: RunStore, run: Run) -> int:
    """Return the steps that a training has practised, with all that it continues.

    Raises:
        InvalidInput: if that cannot be known.
    """
    runs = {run.id: run}
    while True:
        if store.is_imported(run.id):
            raise InvalidInput(
                f"training {run.id} was imported, so that its practice is not known here; enter "
                "one that was practised on this server"
            )
        if run.continued_from is None:
            return sum(practice.done for practice in runs.values())
        run = _training(store, run.continued_from)
        if run.id in runs:
            raise InvalidInput(f"training {run.id} continues itself")
        runs[run.id] = run


def _training(store: RunStore, training_id: str) -> Run:
    try:
        run = store.get(training_id)
    except NotFound as error:
        raise InvalidInput(
            f"there is no training {training_id!r} (any more), so that its practice is not known"
        ) from error
    if run.kind != "training":
        raise InvalidInput(f"{training_id!r} is a {run.kind}; name a training")
    return run
