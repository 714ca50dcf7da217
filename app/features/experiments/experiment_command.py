"""`hexapods experiment`: the paper's experiments and others, over many seeds."""

from dataclasses import dataclass
from typing import Annotated, Any

from cyclopts import Parameter

from app.cli.setting_options import reads, split
from app.features.experiments.command_trials import run_experiment
from app.features.experiments.trial_options import ExecutionOptions, TrialOptions
from hexapods.domain.errors import InvalidInput, UnknownName
from hexapods.domain.settings import declared_fields
from hexapods.domain.world import WORLDS
from hexapods.experiments.config import ExperimentConfig, experiment_config
from hexapods.experiments.formatting import listed
from hexapods.experiments.presets import PRESETS
from hexapods.runs.config import TrainingConfig

_SETTINGS = declared_fields(TrainingConfig)


def _names() -> list[str]:
    """Return the presets that this command starts; others have a command of their own."""
    return [name for name, preset in PRESETS.items() if preset.command == f"experiment {name}"]


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class WorldOptions:
    """Options that some experiments take.

    Attributes:
        tolerance: build tolerance of the robots (league, recovery), as a fraction (default 0.03)
        steps: steps of practice: in a league in all (default 250), in a recovery before the
            disturbance (default 100)
    """

    world: Annotated[
        tuple[str, ...],
        Parameter(
            completer=lambda _: [*WORLDS],
            help=f"one or more of {', '.join(WORLDS)}, or a disturbance such as limp:legs=1,4",
        ),
    ] = ()
    tolerance: Annotated[float | None, Parameter(converter=reads(_SETTINGS["tolerance"]))] = None
    reward: Annotated[
        str | None,
        Parameter(
            converter=reads(_SETTINGS["reward"]),
            help=f"{_SETTINGS['reward'].about.help} Of all but the paper's.",
        ),
    ] = None
    steps: Annotated[
        tuple[int, ...] | None,
        Parameter(converter=reads(_SETTINGS["steps"], lists=True), n_tokens=1, metavar="LIST"),
    ] = None

    def fields(self) -> dict[str, Any]:
        """Return fields of an experiment; None where nothing is given."""
        return {
            "worlds": self._worlds(),
            "tolerance": self.tolerance,
            "reward": self.reward,
            "steps": self.steps,
        }

    def _worlds(self) -> tuple[str, ...] | None:
        """Return the worlds, separated by commas; a disturbance may have commas too."""
        worlds: list[str] = []
        for entry in (entry for text in self.world for entry in split(text)):
            # Names of worlds and kinds begin with a letter, so a number belongs to a list of legs.
            if worlds and ":" in worlds[-1] and entry[:1].isdecimal():
                worlds[-1] += f",{entry}"
            else:
                worlds.append(entry)
        return tuple(worlds) or None


_TRIALS, _WORLDS, _EXECUTION = TrialOptions(), WorldOptions(), ExecutionOptions()


def experiment(
    experiment: Annotated[
        str,
        Parameter(name="EXPERIMENT", completer=lambda _: _names(), help=", ".join(_names())),
    ],
    /,
    *,
    trials: TrialOptions = _TRIALS,
    worlds: WorldOptions = _WORLDS,
    execution: ExecutionOptions = _EXECUTION,
) -> int:
    """Repeat an experiment over many seeds, or go on with it from its results folder.

    Raises:
        HexapodError: if the options are not valid.
    """
    return run_experiment(config_of(experiment, trials, worlds), execution)


def config_of(experiment: str, trials: TrialOptions, worlds: WorldOptions) -> ExperimentConfig:
    """Return the experiment of some options.

    Raises:
        HexapodError: if the options are not valid.
    """
    names = _names()
    if experiment not in names:
        raise UnknownName("experiment", experiment, names)
    grid, special = trials.fields(), worlds.fields()
    for field, value in {**special, "agents": grid["agents"]}.items():
        takers = [name for name in names if field in PRESETS[name].fields]
        if value is not None and experiment not in takers:
            option = ExperimentConfig.option_of(field)
            raise InvalidInput(f"{option} is for {listed(takers)}, not {experiment}")
    return experiment_config(experiment, {**grid, **special})
