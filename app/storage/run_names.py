"""Names of runs by what they differ in, for runs that nobody has named."""

import re

from app.storage.run import Run
from app.storage.run_kind import added_kind
from hexapods.agents.appearance import name_of, title_of
from hexapods.domain.text import MAX_NAME, whole
from hexapods.domain.world import WORLDS
from hexapods.runs.config import TrainingConfig, WalkingProblem
from hexapods.runs.race_config import RaceConfig


def training_name(config: TrainingConfig, *, is_continued: bool = False) -> str:
    """Return a name like `Q-learning, α 0.5, 500 steps, ice, seed 3`."""
    more = " more" if is_continued else ""
    practice = f"{name_of(config.agent, config.settings)}, {whole(config.steps)}{more} steps"
    seed = f", seed {config.seed}" if config.seed != TrainingConfig.seed else ""
    return f"{practice}{_world_name(config)}{seed}"[:MAX_NAME]


def race_name(config: RaceConfig) -> str:
    """Return a name like `Race: Q-learning, Greedy, Two-step, ice`."""
    agents = dict.fromkeys(title_of(lane.agent) for lane in config.lanes)
    return f"Race: {', '.join(agents)}{_world_name(config)}"[:MAX_NAME]


def branch_name(original: str, step: int) -> str:
    """Return the name of a branch of a race; steps count from 1 there, as people count.

    A branch of a branch is named by its own step alone.
    """
    end = _branch_end(step)
    stem = re.sub(r", from step [^,]+$", "", original)
    return stem[: MAX_NAME - len(end)] + end


def is_named(run: Run) -> bool:
    """Return whether a run has another name than those made of its config, here or earlier."""
    config = run.config
    if isinstance(config, TrainingConfig):
        name = training_name(config, is_continued=run.continued_from is not None)
        earlier = f"{whole(config.steps)} steps: {config.resolved_gait.title}"
        return run.name not in (name, earlier)
    if (kind := added_kind(run.kind)) is not None:
        return not kind.has_made_name(run)
    if config.branch_from is not None:
        return not run.name.endswith(_branch_end(config.branch_from.step))
    earlier = f"Race: {config.resolved_gait.title}"
    return run.name not in (race_name(config), earlier)


def _branch_end(step: int) -> str:
    return f", from step {whole(step + 1)}"


def _world_name(problem: WalkingProblem) -> str:
    """Return `, ice` for a named world in which something happens; else nothing."""
    titles = [named.title.lower() for named in WORLDS.values() if named.world == problem.world]
    return "".join(f", {title}" for title in titles if problem.world.disturbances)
