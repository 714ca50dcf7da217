"""The names of `import hexapods as hx`, which loads this module when the first of them is used."""

import io
import os
import zipfile

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
from hexapods.agents.protocol import (
    Agent,
    AgentState,
    Expand,
    Node,
    Observe,
    Problem,
    Tabular,
    Transition,
    Tunable,
    Valuing,
)
from hexapods.agents.q_lambda import QLambda
from hexapods.agents.q_learning import QLearning
from hexapods.agents.r_max import RMax
from hexapods.agents.sarsa import Sarsa
from hexapods.agents.sarsa_lambda import SarsaLambda
from hexapods.agents.tabular import TabularLearner
from hexapods.domain.disturbances import (
    DeadBand,
    Delay,
    Disturbance,
    Friction,
    Limp,
    Lost,
    Patch,
    Payload,
    Push,
    Repair,
    Rough,
    SensorNoise,
    Slope,
    Stuck,
    Weak,
)
from hexapods.domain.errors import (
    DamagedFile,
    Diverged,
    HexapodError,
    IllegalAction,
    InvalidInput,
    TableMismatch,
    TooLong,
    UnknownName,
    Unreachable,
)
from hexapods.domain.gait import GaitSpec as Gait
from hexapods.domain.robot import LegMount, Robot
from hexapods.domain.settings import Setting
from hexapods.domain.simulator import Motion
from hexapods.domain.types import Action
from hexapods.domain.world import World
from hexapods.experiments.engine import Outcome
from hexapods.experiments.folder import NotKept
from hexapods.experiments.worker import ClusterLost
from hexapods.files import path_of
from hexapods.practice import Practice, evaluate, iter_train, train
from hexapods.races import CONFIG, Lane, Race, Standing, lane, race, race_from_bytes
from hexapods.repetition import Experiment, SettingResult, experiment
from hexapods.runs.recording import LaneRecording
from hexapods.runs.records import (
    ActionValues,
    EpisodeEnded,
    Evaluated,
    LaneStep,
    Reference,
    StepTaken,
)
from hexapods.trainings import CurvePoint, Training, training_from_bytes
from hexapods.viewing import View, view

__all__ = [
    "Action",
    "ActionValues",
    "Agent",
    "AgentState",
    "Beam",
    "ClusterLost",
    "CurvePoint",
    "DamagedFile",
    "DeadBand",
    "Delay",
    "Disturbance",
    "Diverged",
    "DoubleQ",
    "DynaQ",
    "DynaQPlus",
    "EpisodeEnded",
    "Evaluated",
    "Expand",
    "ExpectedSarsa",
    "Experiment",
    "Friction",
    "Gait",
    "Greedy",
    "HexapodError",
    "IllegalAction",
    "Informed",
    "InvalidInput",
    "Lane",
    "LaneRecording",
    "LaneStep",
    "LegMount",
    "Limp",
    "LinearModel",
    "LookAhead",
    "Lost",
    "Mcts",
    "Motion",
    "NStepSarsa",
    "Node",
    "NotKept",
    "Observe",
    "Outcome",
    "Patch",
    "Payload",
    "PosteriorSampling",
    "Practice",
    "PrioritizedSweeping",
    "Problem",
    "Push",
    "QLambda",
    "QLearning",
    "RMax",
    "Race",
    "RandomWalk",
    "Reference",
    "Repair",
    "Robot",
    "Rough",
    "Sarsa",
    "SarsaLambda",
    "SensorNoise",
    "Setting",
    "SettingResult",
    "Slope",
    "Standing",
    "StepTaken",
    "Stuck",
    "TableMismatch",
    "Tabular",
    "TabularLearner",
    "TooLong",
    "Training",
    "Transition",
    "Tunable",
    "TwoStep",
    "UnknownName",
    "Unreachable",
    "Valuing",
    "View",
    "Wave",
    "Weak",
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


def load(path: str | os.PathLike[str]) -> Training | Race:
    """Return what `Training.save` or `Race.save`, the dashboard or the command line has saved.

    Args:
        path: of an `.npz` file.

    Raises:
        InvalidInput: if the file cannot be read.
        DamagedFile: if it is neither, or was changed since it was written.
    """
    file = path_of(path, "a file")
    try:
        data = file.read_bytes()
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            is_race = f"{CONFIG}.npy" in archive.namelist()
    except OSError as error:
        raise InvalidInput(f"{file} cannot be read: {error.strerror}") from error
    except zipfile.BadZipFile as error:
        raise DamagedFile(f"{file} is neither a training nor a race: {error}") from error
    return race_from_bytes(data, str(file)) if is_race else training_from_bytes(data, str(file))
