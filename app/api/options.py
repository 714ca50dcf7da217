"""The options: every name, default, limit and sentence of help that a form needs."""

from collections.abc import Collection
from typing import Annotated, Any

from annotated_types import Ge, Le
from fastapi import APIRouter
from starlette.responses import JSONResponse, Response

from app import __version__
from app.agents.registry import learns
from app.api.answers import OptionsView
from app.api.deps import ServicesDep
from app.api.descriptions import SETTINGS
from app.domain.gait import GAIT_TITLES, NAMED_GAITS, resolve
from app.domain.palette import lane_colors
from app.domain.robot import PRESETS, Robot, as_mapping
from app.domain.settings import DeclaredSetting, declare, declared_fields
from app.domain.text import MAX_NAME
from app.experiments.config import (
    EXPERIMENTS,
    GRID,
    MAX_SEEDS,
    MAX_TRIALS,
    experiment_config,
    fields_of,
)
from app.experiments.config import as_json as experiment_as_json
from app.jobs.submissions import MAX_SETTINGS, TITLES
from app.runs.config import (
    MAX_LANES,
    MAX_RACE_STEPS,
    RACE_STEPS,
    RaceConfig,
    TrainingConfig,
    as_json,
)
from app.what_if.what_if import MAX_STEPS as MAX_WHAT_IF_STEPS
from app.what_if.what_if import SEEDS as WHAT_IF_SEEDS

router = APIRouter(prefix="/options", tags=["options"])


@router.get(
    "",
    response_model=OptionsView,
    summary="Gaits, robots, agents, clocks; defaults, limits and help",
)
def get_options(services: ServicesDep) -> Response:
    """All that a form needs."""
    return JSONResponse(catalogue(services.agents))


_SAID = {
    "table1": (
        "The paper's Table 1: Q-learning after 500 and after 1,000 steps beside greedy and "
        "two-step, in all four gaits, for both readings of the state."
    ),
    "figure4": (
        "The paper's Figure 4: practice in blocks of 250 steps up to 2,000, the table saved and "
        "loaded in between, and greedy as the line to reach."
    ),
    "sweep": (
        "A grid of any values: every combination is tried over all seeds. The paper names tuning "
        "as future work."
    ),
}
HELP = {
    "seeds": "How often each setting is tried, each time with other random numbers.",
    "gaits": "Which gaits are tried.",
    "robots": "Which robots are tried.",
    "observations": "Which readings of the state are tried.",
    "agents": "Who learns, or looks ahead, and is compared with the others.",
    "settings": "Combinations of values; each is tried over all seeds.",
    "trials": "Settings times seeds; agents that look ahead are tried once.",
    "workers": "How many trials are computed at once; one for each core if nothing is said.",
}


def experiments() -> list[dict[str, Any]]:
    """Each with its name, title, a sentence, its defaults, and the fields that it takes."""
    shown = []
    for name in EXPERIMENTS:
        defaults = experiment_as_json(experiment_config(name, {}))
        defaults["robots"] = [robot["preset"] for robot in defaults["robots"]]
        fields = fields_of(name)
        shown.append(
            {
                "name": name,
                "title": TITLES[name],
                "description": _SAID[name],
                "fields": list(fields),
                "grid": [field for field in GRID if field in fields],
                "defaults": defaults,
            }
        )
    return shown


def experiment_limits() -> dict[str, list[float | None]]:
    """From and to, of what only experiments have."""
    return {"seeds": [1, MAX_SEEDS], "trials": [1, MAX_TRIALS], "settings": [1, MAX_SETTINGS]}


_GAITS = {
    "left-right-origin": (
        "Three legs on each side of the way; legs that stand opposite each other move together."
    ),
    "left-right-vertical": (
        "Three legs on each side of the way; each leg moves with its mirror image."
    ),
    "front-back-origin": (
        "One leg leads, three in front and three behind; opposite legs move together."
    ),
    "front-back-vertical": (
        "One leg leads, three in front and three behind; each leg moves with its mirror image."
    ),
}
_ROBOTS = {
    "stiff": "Strong servos on a floor with grip: they hold the body level.",
    "compliant": "Weak servos: the body sags and pitches under its own weight.",
    "slippery": "Feet that slide on the floor.",
}
_AGENTS = {
    "q-learning": (
        "Q-learning",
        "Learns by trying, knows nothing beforehand, and then decides without thinking.",
    ),
    "greedy": ("Greedy", "Simulates every possible step, and takes the best one."),
    "two-step": ("Two-step", "Simulates every possible pair of steps, and takes the best one."),
}
_OBSERVATIONS = {
    "measured": "Where the feet are, by the joint angles.",
    "commanded": "Where the feet were last sent; the body's drift is not seen.",
}
_CLOCKS = {
    "paper": "A decision costs a share of a step's time for every future that was simulated.",
    "wall": "A decision costs the time that this computer took for it.",
    "free": "Thinking costs nothing.",
}
_SIMULATORS = {
    "mujoco": "Real physics: servos, contacts, friction.",
    "kinematic": "The law of a step without slip: exact, and very quick.",
}
_HELP = {
    "gait": "Which way is forward, and which two legs move together.",
    "what_if_steps": "How many steps of practice a what-if may have.",
    "observation": "How the robot knows where its feet are.",
    "robot": "Which robot walks; it differs in servos and friction.",
    "simulator": "What computes the walking.",
    "lanes": "Which agents race.",
    "clock": "What thinking costs in the race; it can change who wins.",
    "name": "What the run is called in the list.",
}
_RACE_STEPS = declared_fields(RaceConfig)["steps"]
_SETTINGS = {
    **SETTINGS,
    # As many as a race of any number of lanes may have.
    "race_steps": declare(
        "race_steps", Annotated[int, Ge(1), Le(MAX_RACE_STEPS // MAX_LANES), _RACE_STEPS.about]
    ),
}
"""Every declared setting, by the name of the form's field."""


def catalogue(agents: Collection[str]) -> dict[str, Any]:
    """All choices, their defaults and limits, in plain types.

    Args:
        agents: the names that were registered at start.
    """
    return {
        "version": __version__,
        "gaits": [_gait(name) for name in NAMED_GAITS],
        "robots": [
            {"name": name, "description": _ROBOTS.get(name, ""), "robot": as_mapping(robot)}
            for name, robot in PRESETS.items()
        ],
        "agents": _agents(agents),
        "simulators": _described(_SIMULATORS),
        "observations": _described(_OBSERVATIONS),
        "clocks": _described(_CLOCKS),
        "experiments": experiments(),
        "defaults": {
            "training": _training_defaults(),
            "race": _race_defaults(),
            "what_if": {"seeds": WHAT_IF_SEEDS},
        },
        "settings": {name: _setting(setting) for name, setting in _SETTINGS.items()},
        "limits": _limits() | experiment_limits(),
        "help": {name: setting.about.help for name, setting in _SETTINGS.items()} | _HELP | HELP,
    }


def _gait(name: str) -> dict[str, Any]:
    gait = resolve(name, Robot().azimuths_deg)
    return {
        "name": name,
        "title": GAIT_TITLES[name],
        "forward_deg": gait.forward_deg,
        "azimuths_deg": gait.azimuths_deg,
        "pairs": gait.pairs,
        "description": _GAITS[name],
    }


def _agents(names: Collection[str]) -> list[dict[str, Any]]:
    ours = [name for name in _AGENTS if name in names]
    ordered = [*ours, *(name for name in names if name not in ours)]
    shown = []
    for name, color in zip(ordered, lane_colors(ordered), strict=True):
        title, description = _AGENTS.get(name, (name, "An agent of an installed package."))
        shown.append(
            {
                "name": name,
                "title": title,
                "description": description,
                "learns": learns(name),
                "color": color,
            }
        )
    return shown


def _described(sentences: dict[str, str]) -> list[dict[str, str]]:
    return [{"name": name, "description": said} for name, said in sentences.items()]


def _training_defaults() -> dict[str, Any]:
    shown = as_json(TrainingConfig(gait=next(iter(NAMED_GAITS))))
    return {**shown, "robot": Robot().name}


def _race_defaults() -> dict[str, Any]:
    lanes = [{"agent": name, **({"training": {}} if learns(name) else {})} for name in _AGENTS]
    return {"steps": RACE_STEPS, "seed": 0, "lanes": lanes}


def _limits() -> dict[str, list[float | None]]:
    return {
        **{n: [one.low, one.high] for n, one in _SETTINGS.items() if one.is_number},
        "what_if_steps": [1, MAX_WHAT_IF_STEPS],
        "lanes": [1, MAX_LANES],
        "name": [0, MAX_NAME],
    }


def _setting(setting: DeclaredSetting) -> dict[str, Any]:
    about = setting.about
    return {
        "title": about.title,
        "symbol": about.symbol,
        "unit": about.unit,
        "help": about.help,
        "valid": setting.valid,
        "minimum": setting.low,
        "maximum": setting.high,
        "excludes_minimum": setting.excludes_low,
        "excludes_maximum": setting.excludes_high,
        "is_whole": setting.is_whole,
        "is_live": about.live,
    }
