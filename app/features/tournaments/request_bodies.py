"""Request bodies of tournaments and their entries."""

from functools import cache
from typing import Annotated, Any

from pydantic import Field, create_model

from app.api.agent_bodies import with_settings_of
from app.api.descriptions import VALID
from app.api.fields import (
    Body,
    Declared,
    Name,
    RunId,
    SettingsBody,
    given_settings,
    named_in,
    record_fields,
    taken_by,
)
from app.features.tournaments.tournament import DEFAULT_ENTRIES_PER_HOUR, EntriesPerHour
from hexapods.domain.errors import InvalidInput
from hexapods.domain.observation import Observation
from hexapods.domain.robot import AnyRobot
from hexapods.domain.settings import DeclaredSetting, SettingValues, declare, declared_fields
from hexapods.domain.text import NAMES
from hexapods.domain.world import lasting_world
from hexapods.runs.config import TrainingConfig, WalkingProblem
from hexapods.tournaments.entry import EntryConfig
from hexapods.tournaments.rules import MAX_ROBOTS, MAX_WORLDS, TournamentRules

VALID.update(
    {
        "title": NAMES,
        "room": "the code of a room",
        "rules": "an object with gait, and what differs from the rules' defaults",
        "tables": "true or false",
        "withdraw_waiting": "true or false",
    }
)
_MAX_WORLD = 500
_Flag = Annotated[bool, Field(strict=True)]
_ENTRIES_PER_HOUR = declare("entries_per_hour", EntriesPerHour, DEFAULT_ENTRIES_PER_HOUR)


def tournament_fields() -> dict[str, DeclaredSetting]:
    """Return the numbers of a new tournament beside those of its walking problem."""
    of_walk = declared_fields(WalkingProblem)
    of_rules = declared_fields(TournamentRules)
    fields_of_rules = {name: setting for name, setting in of_rules.items() if name not in of_walk}
    return fields_of_rules | {_ENTRIES_PER_HOUR.name: _ENTRIES_PER_HOUR}


class RulesBody(Body):
    """Rules of a tournament; the other fields of `TournamentRules` are added to it."""

    worlds: Annotated[
        list[Annotated[str, Field(max_length=_MAX_WORLD), taken_by(lasting_world)]],
        Field(min_length=1, max_length=MAX_WORLDS, description=VALID["worlds"]),
    ] = Field(default_factory=lambda: list(TournamentRules.worlds))
    robots: Annotated[list[AnyRobot], Field(max_length=MAX_ROBOTS, description=VALID["robots"])] = (
        Field(default_factory=list)
    )
    tables: _Flag = False

    def rules(self) -> TournamentRules:
        """Convert to rules.

        Raises:
            UnknownName, InvalidInput: if the values are not valid together.
        """
        values: dict[str, Any] = {name: getattr(self, name) for name in type(self).model_fields}
        worlds, robots = tuple(self.worlds), tuple(self.robots)
        try:
            return TournamentRules(**{**values, "worlds": worlds, "robots": robots})
        except InvalidInput as error:
            error.field = f"rules.{error.field}" if error.field else ""
            raise


# Robots walk in the gaits that suit them.
_rule_fields = record_fields(TournamentRules, {"world", "gaits", *RulesBody.model_fields})
_Rules: Any = create_model(
    "TournamentRulesBody", __base__=RulesBody, __doc__=RulesBody.__doc__, **_rule_fields
)


class TournamentBody(Body):
    """A tournament: its rules, and the code of the room whose participants may enter."""

    title: Name = ""
    room: Annotated[str, Field(max_length=20, description=VALID["room"])] | None = None
    entries_per_hour: Annotated[Any, Declared(_ENTRIES_PER_HOUR)] = _ENTRIES_PER_HOUR.default
    rules: _Rules


class EntryBody(Body):
    """An entry: an agent with settings, or a finished training, whose table enters.

    With `training_id` observation and settings are those of the training. An operator may name the
    entrant; participants have their name in the room.
    """

    agent: str
    settings: SettingsBody = Field(default_factory=SettingsBody)
    steps: Annotated[Any, Declared(declared_fields(TrainingConfig)["steps"])] | None = None
    observation: Annotated[Observation | None, Field(description=VALID["observation"])] = None
    robot: Annotated[AnyRobot | None, Field(description=VALID["robot"])] = None
    training_id: Annotated[
        RunId | None, Field(description="the id of a finished training, whose table enters")
    ] = None
    name: Name | None = None

    def entry(self) -> EntryConfig:
        """Convert to an entry without a table."""
        return EntryConfig(
            agent=self.agent,
            observation=self.observation or EntryConfig.observation,
            settings=SettingValues(given_settings(self.settings)),
            steps=self.steps,
            robot=self.robot,
        )

    def check_of_training(self) -> None:
        """Check that nothing is given that the training says.

        Raises:
            InvalidInput: if something is.
        """
        values = {
            "settings": given_settings(self.settings),
            "steps": self.steps,
            "observation": self.observation,
        }
        for name, value in values.items():
            if value:
                raise InvalidInput(
                    f"{name} of a table are those of its training; leave {name} out", field=name
                )


@cache
def entry_body(agents: tuple[str, ...]) -> Any:
    """Return the type of an entry's body, with the settings of the registered agents."""
    bodies = {agent: with_settings_of(agent, EntryBody, "Entry") for agent in agents}
    return named_in(bodies, "agent", "agent")


class EndBody(Body):
    """Whether entries that are not judged yet are withdrawn."""

    withdraw_waiting: _Flag = False
