"""The recorded walk of a stored run that has ended, as exports read it."""

from collections.abc import Callable

from app.storage.errors import Conflict, Damaged
from app.storage.recordings import Recordings
from app.storage.run import NOT_ENDED, AnyRun, DamagedRun
from app.storage.run_kind import with_article
from hexapods.domain.errors import InvalidInput
from hexapods.exports.export_format import EncodedReplay, ExportSource
from hexapods.exports.recorded_walks import RecordedWalks
from hexapods.runs.clocks import Clock
from hexapods.runs.config import TrainingConfig
from hexapods.runs.race_config import RaceConfig

EncodeReplay = Callable[[str, Clock], EncodedReplay]
"""Returns the frames of a run, by its id, under a clock; see `app.viewer.replay_frames`."""


def source_of(run: AnyRun, recordings: Recordings, encode: EncodeReplay) -> ExportSource:
    """Return the source of an export of a run: its name, walks and frames.

    Raises:
        InvalidInput, Damaged, Conflict: see `recorded_walks`.
    """
    recorded_walks(run, recordings)
    return ExportSource(
        run.id,
        run.name or f"{run.kind} {run.id}",
        lambda: recorded_walks(run, recordings),
        lambda clock: encode(run.id, clock),
    )


def recorded_walks(run: AnyRun, recordings: Recordings) -> RecordedWalks:
    """Return the recorded walks of a race or training that has ended.

    Raises:
        InvalidInput: if the run is neither.
        Damaged: if the run cannot be decoded.
        Conflict: if it has not ended, or has no recording.
    """
    if isinstance(run, DamagedRun):
        raise Damaged(run.id, run.damaged)
    config = run.config
    if not isinstance(config, RaceConfig | TrainingConfig):
        raise InvalidInput(
            f"{run.id} is {with_article(run.kind)}, which records no walk; choose a race or a "
            "training"
        )
    if run.state in NOT_ENDED:
        raise Conflict(
            f"{run.kind} {run.id} is {run.state}; its walk can be had as a file once it ended, or "
            "was stopped",
            run.state,
        )
    if isinstance(config, RaceConfig):
        race = recordings.race(run.id)
        walks = RecordedWalks.of_race(config, race or ())
    else:
        practice = recordings.training(run.id)
        walks = (
            RecordedWalks(config, ())
            if practice is None
            else RecordedWalks.of_training(config, practice)
        )
    if not any(lane.steps for lane in walks.lanes):
        raise Conflict(f"{run.kind} {run.id} is {run.state} and has no recording", run.state)
    return walks
