"""Names that an agent's settings may not have: all that commands and summaries use beside them."""

import argparse
from dataclasses import fields

from app.cli.program import parser_of
from app.features.experiments.response_models import (
    CurveOfSetting,
    PooledView,
    SettingView,
    VersusView,
)
from hexapods.experiments.config import ExperimentConfig
from hexapods.runs.config import RESERVED, TrainingConfig

# Rows of summaries, which have settings beside what was measured with them.
ROWS = (SettingView, PooledView, CurveOfSetting, VersusView)


def names_of_commands() -> set[str]:
    """Options of `train` and `sweep`, and where argparse keeps them."""
    actions = parser_of()._actions
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
    for row in ROWS:
        used |= set(row.model_fields)
    # Settings are arguments beside the fields: `experiment_config(name, {"alpha": ...})`.
    used |= {field.name for field in fields(ExperimentConfig)}
    own = {field.name for field in fields(TrainingConfig)}
    assert {name for name in used - own if not name.startswith("_")} == RESERVED
