"""Names that an agent's settings may not have: all that bodies, answers and commands use."""

import argparse
from dataclasses import fields

from pydantic import BaseModel

from app.api.answers import Change, ExperimentConfigView, LaneView, TrainingConfigView, WhatIfHalf
from app.api.experiment_answers import CurveOfSetting, PooledView, SettingView, VersusView
from app.api.experiment_body import ExperimentBody
from app.api.schemas import ChangeBody, LaneBody, PracticeBody, RaceBody, TrainingBody
from app.cli import _parser
from hexapods.experiments.config import ExperimentConfig
from hexapods.runs.config import RESERVED, TrainingConfig
from hexapods.runs.race_config import RaceConfig

BODIES = (PracticeBody, TrainingBody, LaneBody, RaceBody, ExperimentBody, ChangeBody)
ANSWERS = (
    LaneView,
    SettingView,
    PooledView,
    CurveOfSetting,
    VersusView,
    WhatIfHalf,
    Change,
    TrainingConfigView,
    ExperimentConfigView,
)


def names_of_commands() -> set[str]:
    """Options of `train` and `sweep`, and where argparse keeps them."""
    actions = _parser()._actions
    (commands,) = [one for one in actions if isinstance(one, argparse._SubParsersAction)]
    used: set[str] = set()
    for name in ("train", "sweep"):
        used |= set(commands.choices[name]._defaults)
        for action in commands.choices[name]._actions:
            flags = (flag.lstrip("-").replace("-", "_") for flag in action.option_strings)
            used |= {action.dest, *flags}
    return used


def test_every_name_that_is_used_otherwise_is_reserved() -> None:
    used = names_of_commands()
    for body in BODIES:
        used |= {*dir(body), *body.model_fields} - set(dir(BaseModel))
    for answer in ANSWERS:
        used |= set(answer.model_fields)
    for config in (ExperimentConfig, RaceConfig):
        used |= {one.name for one in fields(config)}
    own = {one.name for one in fields(TrainingConfig)}
    assert {name for name in used - own if not name.startswith("_")} == RESERVED
