"""The names of `import hexapods as hx`, which loads this module when the first of them is used."""

import zipfile
from pathlib import Path

from hexapods.agents.beam import Beam
from hexapods.agents.double_q import DoubleQ
from hexapods.agents.dyna_q import DynaQ
from hexapods.agents.dyna_q_plus import DynaQPlus
from hexapods.agents.expected_sarsa import ExpectedSarsa
from hexapods.agents.fixed_policies import RandomWalk, Wave
from hexapods.agents.informed import Informed
from hexapods.agents.linear_model import LinearModel
from hexapods.agents.lookahead import Greedy, LookAhead, TwoStep
from hexapods.agents.mcts import Mcts
from hexapods.agents.n_step_sarsa import NStepSarsa
from hexapods.agents.posterior_sampling import PosteriorSampling
from hexapods.agents.prioritized_sweeping import PrioritizedSweeping
from hexapods.agents.protocol import Agent, Problem, Transition
from hexapods.agents.q_lambda import QLambda
from hexapods.agents.q_learning import QLearning
from hexapods.agents.r_max import RMax
from hexapods.agents.sarsa import Sarsa
from hexapods.agents.sarsa_lambda import SarsaLambda
from hexapods.agents.tabular import TabularLearner
from hexapods.domain.errors import DamagedFile, HexapodError, InvalidInput, UnknownName
from hexapods.domain.gait import GaitSpec as Gait
from hexapods.domain.robot import Robot
from hexapods.domain.settings import Setting
from hexapods.domain.types import Action
from hexapods.domain.world import World
from hexapods.races import CONFIG, Lane, Race, lane, race, race_from_bytes
from hexapods.repetition import Experiment, experiment
from hexapods.trainings import Training, evaluate, iter_train, train, training_from_bytes
from hexapods.viewing import View, view

__all__ = [
    "Action",
    "Agent",
    "Beam",
    "DamagedFile",
    "DoubleQ",
    "DynaQ",
    "DynaQPlus",
    "ExpectedSarsa",
    "Experiment",
    "Gait",
    "Greedy",
    "HexapodError",
    "Informed",
    "InvalidInput",
    "Lane",
    "LinearModel",
    "LookAhead",
    "Mcts",
    "NStepSarsa",
    "PosteriorSampling",
    "PrioritizedSweeping",
    "Problem",
    "QLambda",
    "QLearning",
    "RMax",
    "Race",
    "RandomWalk",
    "Robot",
    "Sarsa",
    "SarsaLambda",
    "Setting",
    "TabularLearner",
    "Training",
    "Transition",
    "TwoStep",
    "UnknownName",
    "View",
    "Wave",
    "World",
    "evaluate",
    "experiment",
    "iter_train",
    "lane",
    "load",
    "race",
    "train",
    "view",
]


def load(path: str | Path) -> Training | Race:
    """Return what `Training.save` or `Race.save`, the dashboard or the command line has saved.

    Args:
        path: of an `.npz` file.

    Raises:
        InvalidInput: if the file cannot be read.
        DamagedFile: if it is neither, or was changed since it was written.
    """
    if not isinstance(path, str | Path):
        raise InvalidInput(f"a file is given by its path, not by {path!r}")
    try:
        data = Path(path).read_bytes()
        with zipfile.ZipFile(path) as archive:
            is_race = f"{CONFIG}.npy" in archive.namelist()
    except OSError as error:
        raise InvalidInput(f"{path} cannot be read: {error.strerror}") from error
    except zipfile.BadZipFile as error:
        raise DamagedFile(f"{path} is neither a training nor a race: {error}") from error
    return race_from_bytes(data, str(path)) if is_race else training_from_bytes(data, str(path))
