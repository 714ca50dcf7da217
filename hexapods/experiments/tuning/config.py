"""Configs of tunings: a league of one learner in one place, and a search before it."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, get_args

from hexapods.agents.registry import learns
from hexapods.domain.checks import check_whole
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.gait import AnyGait
from hexapods.domain.observation import Observation
from hexapods.domain.records import to_json
from hexapods.domain.settings import DeclaredSetting
from hexapods.experiments.config import (
    MAX_SEEDS,
    MAX_TRIALS,
    ExperimentConfig,
    ExperimentName,
)
from hexapods.experiments.tuning.ranges import (
    SearchRange,
    declared_range,
    parse_range,
    setting_name,
)
from hexapods.runs.config import agent_settings, usable_agents

Objective = Literal["distance", "area"]
OBJECTIVES: Mapping[Objective, str] = {
    "distance": "distance after the practice",
    "area": "distance on average over the practice",
}
"""Objective of the search: the mean over the seeds of the distance in an evaluation after the
practice, or of the area under the learning curve divided by its steps."""
MAX_CANDIDATES = 10_000


@dataclass(frozen=True, kw_only=True)
class TuningConfig(ExperimentConfig):
    """Config of a tuning. `tuning_config` adds the ranges that the agent declares.

    The fields of the experiment are those of the league on the held-out seeds, in one place: the
    first agent is tuned, the others walk beside it, and `seeds` is the number of held-out seeds.

    Attributes:
        candidates: number of combinations of settings that are tried, the defaults first.
        search_seeds: number of seeds for each of them, other ones than those held out.
        objective: what is searched for.
        ranges: where, as `parse_range` reads it, one for each setting.

    Raises:
        UnknownName, InvalidInput: if a value is invalid, empty or repeated.
    """

    kind: ClassVar[str] = "tuning"
    options: ClassVar[Mapping[str, str]] = {
        **ExperimentConfig.options,
        "agents": "the agent or --beside",
        "ranges": "--settings or --range",
        "search_seeds": "--seeds",
        "seeds": "--held-out",
        "held_out_seeds": "--held-out",
    }

    experiment: ExperimentName = "league"
    gaits: tuple[AnyGait, ...]
    observations: tuple[Observation, ...] = ("measured",)
    candidates: int = 40
    search_seeds: int = 8
    objective: Objective = "distance"
    ranges: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        check_whole("candidates", self.candidates, 1, MAX_CANDIDATES)
        check_whole("search_seeds", self.search_seeds, 1, MAX_SEEDS)
        for name in ("gaits", "observations", "robots", "worlds", "steps"):
            if len(getattr(self, name)) > 1:
                raise InvalidInput(f"a tuning is in one place, so {name} must name one")
        if self.objective not in OBJECTIVES:
            raise UnknownName("objective", self.objective, get_args(Objective))
        trials = self.candidates * self.search_seeds
        if trials > MAX_TRIALS:
            raise InvalidInput(
                f"the search has {trials:,} trials, the most is {MAX_TRIALS:,}; choose fewer "
                "candidates or fewer seeds"
            )

    @property
    def agent(self) -> str:
        """The agent that is tuned."""
        return self.agents[0]

    @property
    def search_ranges(self) -> tuple[SearchRange, ...]:
        """Search range of each tuned setting."""
        settings = agent_settings(self.agent)
        return tuple(parse_range(text, settings) for text in self.ranges)


def config_json(config: TuningConfig) -> dict[str, Any]:
    """Convert a config to plain types as a summary has it: `seeds` are called `held_out_seeds`."""
    names = {"seeds": "held_out_seeds"}
    return {names.get(name, name): value for name, value in to_json(config).items()}


def tuning_config(
    agent: str,
    *,
    settings: Sequence[str] | None = None,
    ranges: Iterable[str] = (),
    beside: Sequence[str] = (),
    **given: Any,
) -> TuningConfig:
    """Create the config of a tuning.

    Args:
        agent: the learner.
        settings: names of the settings to search, or of their options; by default those that
            declare their values and those of `ranges`.
        ranges: `NAME=LOW:HIGH` or `NAME=VALUE,VALUE` in place of what is declared.
        beside: agents that walk on the held-out seeds too.
        given: other attributes of `TuningConfig`.

    Raises:
        UnknownName, InvalidInput: if a value is invalid, or there is nothing to tune.
    """
    if not learns(agent):
        learners = [name for name in usable_agents() if learns(name)]
        raise InvalidInput(
            f"{agent} does not learn, so there is nothing to tune; choose one of: "
            f"{', '.join(learners)}"
        )
    declared = agent_settings(agent)
    if not declared:
        raise InvalidInput(f"{agent} has no settings, so there is nothing to tune")
    _check_beside(agent, beside)
    chosen = None if settings is None else [setting_name(text) for text in settings]
    found = _given_ranges(ranges, declared, chosen)
    for name in declared if chosen is None else chosen:
        if name not in declared:
            raise UnknownName(f"setting of {agent}", name, declared)
        range_ = found.get(name) or declared_range(declared[name])
        if range_ is not None:
            found[name] = range_
        elif chosen is not None:
            raise InvalidInput(
                f"{name} has no limits between which to search; name them with --range"
            )
    if not found:
        raise InvalidInput(
            f"no setting of {agent} has limits between which to search; name them with --range"
        )
    ordered = tuple(str(found[name]) for name in declared if name in found)
    return TuningConfig(agents=(agent, *beside), ranges=ordered, **given)


def _check_beside(agent: str, beside: Sequence[str]) -> None:
    if agent in beside:
        raise InvalidInput(
            f"{agent} is tuned, and walks with its defaults anyway; leave it out of --beside"
        )
    for place, name in enumerate(beside):
        if name in beside[:place]:
            raise InvalidInput(f"--beside names {name} twice")


def _given_ranges(
    texts: Iterable[str],
    declared: Mapping[str, DeclaredSetting],
    settings: Sequence[str] | None,
) -> dict[str, SearchRange]:
    found: dict[str, SearchRange] = {}
    for one in (parse_range(text, declared) for text in texts):
        if one.name in found:
            raise InvalidInput(f"the range of {one.name} is given twice")
        if settings is not None and one.name not in settings:
            raise InvalidInput(f"{one.name} has a range, but is not one of the settings to tune")
        found[one.name] = one
    return found
