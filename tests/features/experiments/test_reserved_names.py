"""Names that an agent's settings may not have: all that commands and summaries use beside them."""

from dataclasses import fields

from app.cli.program import program_of
from app.features.experiments.response_models import (
    CurveOfSetting,
    PooledView,
    SettingView,
    VersusView,
)
from hexapods.experiments.config import ExperimentConfig, settings_by_name
from hexapods.runs.config import RESERVED, TrainingConfig, usable_agents

# Rows of summaries, which have settings beside what was measured with them.
ROWS = (SettingView, PooledView, CurveOfSetting, VersusView)


def names_of_commands() -> set[str]:
    """Options of `train` and `sweep` beside the agents' settings, and parameters that get them."""
    program, settings = program_of(), settings_by_name(usable_agents())
    used: set[str] = set()
    for command in ("train", "sweep"):
        for argument in program[command].assemble_argument_collection():
            if (field := argument.field_info.name) not in settings:
                used |= {field, argument.name.lstrip("-").replace("-", "_")}
    return (used | {"h", "help"}) - {"*"}


def test_every_name_that_is_used_otherwise_is_reserved() -> None:
    used = names_of_commands()
    for row in ROWS:
        used |= set(row.model_fields)
    # Settings are arguments beside the fields: `experiment_config(name, {"alpha": ...})`.
    used |= {field.name for field in fields(ExperimentConfig)}
    field_names = {field.name for field in fields(TrainingConfig)}
    assert {name for name in used - field_names if not name.startswith("_")} == RESERVED
