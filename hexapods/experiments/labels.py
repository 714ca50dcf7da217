"""Display names of gaits, worlds, robots, observations and parameters in experiments."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from hexapods.domain.disturbance_documents import as_mapping
from hexapods.domain.disturbances import Disturbance
from hexapods.domain.errors import HexapodError
from hexapods.domain.gait import GAIT_TITLES
from hexapods.domain.settings import declared_fields
from hexapods.domain.world import WORLDS, parse_world
from hexapods.experiments.published import GAITS
from hexapods.runs.config import TrainingConfig, agent_settings

OBSERVATION_LABELS: Mapping[str, str] = {
    "measured": "feet measured",
    "commanded": "commands remembered",
    "planned": "feet as planned",
}
"""Label of each observation."""


def parameter_text(name: str, value: Any, agent: str) -> str:
    """Describe a value of a training's field or of a setting of its agent: `α 0.3`."""
    training_fields = declared_fields(TrainingConfig)
    return (
        training_fields[name] if name in training_fields else agent_settings(agent)[name]
    ).describe(value)


def gait_name(gait: str) -> str:
    """Return a gait's display name; a user's own gait keeps its name."""
    return GAIT_TITLES.get(gait, gait)


def gait_name_with_papers(gait: str) -> str:
    """Return a gait's display name, and the paper's name for it in brackets."""
    return f"{gait_name(gait)} ({GAITS[gait]})" if gait in GAITS else gait_name(gait)


def world_name(world: str) -> str:
    """Return a world's display name; of one without a name what happens in it."""
    if world in WORLDS:
        return WORLDS[world].title
    try:
        return " and ".join(map(_disturbance_name, parse_world(world).disturbances))
    except HexapodError:
        return world


def _disturbance_name(disturbance: Disturbance) -> str:
    """Describe a disturbance by its fields: `Weak servos (legs 1, 2; share of torque 0.5)`."""
    declared = declared_fields(type(disturbance))  # type: ignore[arg-type]  # of a class, not an instance
    usual = {field.name: field.default for field in fields(disturbance)} | {
        "kind": disturbance.kind
    }
    values = [
        f"{(declared[name].about.title if name in declared else name).lower()} "
        + (", ".join(map(str, value)) if isinstance(value, list) else format(value))
        for name, value in as_mapping(disturbance).items()
        if value != usual[name]
    ]
    return f"{disturbance.title} ({'; '.join(values)})" if values else disturbance.title


def robot_name(robot: str) -> str:
    """Return a robot's display name: `stiff robot`."""
    return f"{robot.replace(' (modified)', ', modified')} robot"
