"""A trial of an experiment as a run of its own, with the same outcome."""

from dataclasses import replace

from app.features.experiments.start import plan_of
from app.jobs.submissions import LaneStart, RaceStart, TrainingStart
from hexapods.domain.errors import InvalidInput
from hexapods.domain.text import MAX_NAME
from hexapods.experiments.config import ExperimentConfig
from hexapods.experiments.names import trial_names
from hexapods.experiments.plan import Trial
from hexapods.runs.config import RACE_STEPS, TrainingConfig


def trial_start(
    config: ExperimentConfig, experiment_id: str, key: str
) -> TrainingStart | RaceStart:
    """Return the request that runs a trial as the experiment did.

    The distance of a trial is that of its race; in a league or recovery that of its training.

    Args:
        config: the experiment.
        experiment_id: id of its run, for the notes.
        key: of the trial, `<setting key>#<seed number>`.

    Raises:
        InvalidInput: if the experiment has no such trial, or no single run is the same.
    """
    plan = plan_of(config)
    trial = plan.find(key)
    if trial is None:
        raise InvalidInput(
            f"the experiment has no trial {key[:200]!r}; GET …/trials lists those that it has done"
        )
    if trial.config.blocks > 1:
        raise InvalidInput(
            f"the trial {key} practises in {trial.config.blocks} blocks, which no single run does"
        )
    if trial.config.rivals:
        raise InvalidInput(f"the trial {key} measures wall times, which no other run repeats")
    name = _name(trial_names(plan, [key])[key])
    notes = f"Trial {key} of experiment {experiment_id}."
    return _start(trial, name, notes)


def _start(trial: Trial, name: str, notes: str) -> TrainingStart | RaceStart:
    # Evaluations change nothing in what is learned, and give the run a learning curve.
    config = replace(trial.config.training, evaluate_every=TrainingConfig.evaluate_every)
    if trial.config.evaluations:
        return TrainingStart(config, name, notes=notes)
    walk = config.walk()
    is_practised = trial.config.blocks > 0
    lane = LaneStart(
        config.agent,
        training=TrainingStart(config, name) if is_practised else None,
        given={
            "observation": config.observation,
            "keep_learning": False,
            "plans_with": trial.config.plans_with,
        },
        settings={} if is_practised else config.settings,
    )
    return RaceStart(walk, [lane], RACE_STEPS, config.seed, name, notes)


def _name(trial: str) -> str:
    """Return a trial's name as that of a run: of one that is too long the ends, which tell most."""
    words = trial.replace("\u00a0", " ")
    half = (MAX_NAME - 1) // 2
    return words if len(words) <= MAX_NAME else f"{words[:half]}…{words[-half:]}"
