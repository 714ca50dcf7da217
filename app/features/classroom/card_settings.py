"""The settings that a card may open: their limits, and what a participant gives of them."""

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from hexapods.domain.errors import HexapodError, InvalidInput, UnknownName
from hexapods.domain.gait import NAMED_GAITS
from hexapods.domain.observation import OBSERVATIONS
from hexapods.domain.robot import PRESETS
from hexapods.domain.settings import DeclaredSetting, declared_fields
from hexapods.domain.world import WORLDS
from hexapods.runs.config import SIMULATORS, TrainingConfig, agent_settings, usable_agents
from hexapods.runs.race_config import RaceConfig

RACE_STEPS = "race_steps"
_NAMED: Mapping[str, Any] = {
    "gait": NAMED_GAITS,
    "robot": PRESETS,
    "simulator": SIMULATORS,
    "observation": OBSERVATIONS,
    "world": WORLDS,
}
"""By field, the names of which one may be chosen."""
_NEVER = ("seed", "pace")
"""A participant's seed is the room's; a pace would hold a core that others wait for."""


class Limits(Protocol):
    """See `app.features.classroom.lesson.Bounds`."""

    @property
    def minimum(self) -> float | None: ...  # noqa: D102 - declared there
    @property
    def maximum(self) -> float | None: ...  # noqa: D102
    @property
    def choices(self) -> Sequence[Any] | None: ...  # noqa: D102


def declared(form: Mapping[str, Any]) -> Mapping[str, DeclaredSetting]:
    """Return the declared settings of a start, by name: of the training, its agent, and the race.

    Args:
        form: fields of the start; its `agent` says whose settings there are.
    """
    agent = form.get("agent", TrainingConfig.agent)
    try:
        settings_of_agent = agent_settings(agent) if isinstance(agent, str) else {}
    except HexapodError:
        settings_of_agent = {}  # the start says so
    steps = declared_fields(RaceConfig)["steps"]
    settings = {**declared_fields(TrainingConfig), **settings_of_agent, RACE_STEPS: steps}
    return {name: setting for name, setting in settings.items() if name not in _NEVER}


def names_of(field: str) -> list[str] | None:
    """Return the names of which a field has one; None of a declared setting."""
    if field == "agent":
        return list(usable_agents())
    return list(_NAMED[field]) if field in _NAMED else None


def check_bounds(name: str, bounds: Limits, form: Mapping[str, Any]) -> None:
    """Check the bounds of a setting that a card opens.

    Args:
        name: of the setting.
        bounds: within which it may be chosen.
        form: fields of the start that the card offers.

    Raises:
        UnknownName: if there is no such setting, or no such choice.
        InvalidInput: if a bound is outside of the setting's own, or of another kind.
    """
    names, settings = names_of(name), declared(form)
    if names is None and name not in settings:
        raise UnknownName("setting", name, [*_NAMED, "agent", *settings])
    low, high = bounds.minimum, bounds.maximum
    setting = settings.get(name)
    if (low is not None or high is not None) and (setting is None or not setting.is_number):
        raise InvalidInput("minimum and maximum are of numbers alone; give choices")
    if low is not None and high is not None and low > high:
        raise InvalidInput(f"minimum must be at most maximum, {high:g}")
    for bound in (low, high):
        if bound is not None and setting is not None:
            _check_bound(setting, bound)
    for choice in bounds.choices or ():
        if names is not None:
            if choice not in names:
                raise UnknownName("choice", choice, names)
        elif setting is not None:
            setting.normalized(choice)


def check_given(name: str, value: Any, bounds: Limits, form: Mapping[str, Any]) -> Any:
    """Check a value that a participant gives, and return it as the start takes it.

    Raises:
        InvalidInput: if it is outside of the card's bounds; the message names them.
    """
    setting = declared(form).get(name)
    value = value if setting is None else setting.normalized(value)
    if bounds.choices is not None and not any(_is_same(value, choice) for choice in bounds.choices):
        raise UnknownName(name, value, map(str, bounds.choices))
    names = names_of(name)
    if names is not None and value not in names:
        raise UnknownName(name, value, names)
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    low, high = bounds.minimum, bounds.maximum
    if not (low is None and high is None) and not is_number:
        raise InvalidInput(f"{name} must be a number{_range(low, high)}")
    if (low is not None and value < low) or (high is not None and value > high):
        raise InvalidInput(f"{name} must be a number{_range(low, high)} on this card, not {value}")
    return value


def _check_bound(setting: DeclaredSetting, bound: float) -> None:
    """Check that a bound is valid for the setting; an excluded limit itself may be a bound."""
    if setting.is_whole and bound != int(bound):
        raise InvalidInput(f"{bound:g} is outside of the setting's own bounds: {setting.valid}")
    value = int(bound) if setting.is_whole else float(bound)
    if not setting.allows(value) and value not in (setting.low, setting.high):
        raise InvalidInput(f"{bound:g} is outside of the setting's own bounds: {setting.valid}")


def _is_same(value: Any, choice: Any) -> bool:
    return value == choice and isinstance(value, bool) == isinstance(choice, bool)


def _range(low: float | None, high: float | None) -> str:
    above = "" if low is None else f" from {low:g}" if high is not None else f" of at least {low:g}"
    return above + (
        "" if high is None else f" to {high:g}" if low is not None else f" up to {high:g}"
    )
