"""Starts of a lesson's cards: the form of a card with the settings that a participant gives."""

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from typing import Any

from pydantic import TypeAdapter, ValidationError

from app.api.agent_bodies import AgentBodies, agent_bodies
from app.api.descriptions import field_errors
from app.features.classroom.card_settings import RACE_STEPS, check_given, declared, names_of
from app.features.classroom.lesson import Card, Lesson
from app.jobs.submissions import RaceStart, Start, TrainingStart, check_training
from app.storage.database.store import RunStore
from hexapods.agents.registry import find, learns
from hexapods.domain.disturbance_documents import as_mapping, parse_disturbance
from hexapods.domain.errors import HexapodError, InvalidInput, UnknownName
from hexapods.domain.gait import DEFAULT_GAIT
from hexapods.domain.records import refusal_in
from hexapods.runs.config import TrainingConfig, agent_settings
from hexapods.runs.lane import LANE_FIELDS
from hexapods.shows.scene_spec import PAPERS_LANES

_WALK = ("gait", "robot", "simulator", "divisions", "grid_side_m", "tolerance", "reward", "world")
_PRACTICE = ("steps", "observation", "steps_per_episode", "evaluate_every")
_LEFT_OUT = ("seed", "name", "pace")
"""Fields of a page's form that are ignored: the room sets seed, name and the highest pace."""


class CardStarts:
    """Builds starts from the forms of cards, as bodies of requests for trainings and races."""

    def __init__(self, agents: tuple[str, ...]) -> None:
        """Use the registered agents."""
        self._agents = agents

    def given(self, card: Card, settings: Mapping[str, Any]) -> dict[str, Any]:
        """Return the settings of a participant, checked against those that the card opens.

        Args:
            card: the card.
            settings: values that the participant gives, by name.

        Raises:
            InvalidInput: if a setting is not open, or its value out of the card's bounds.
        """
        checked: dict[str, Any] = {}
        form = {**card.form, **{k: v for k, v in settings.items() if k == "agent"}}
        for name, value in settings.items():
            if name not in card.may:
                opened = ", ".join(card.may) or "none"
                raise InvalidInput(
                    f"{name[:60]} cannot be changed on this card; open are: {opened}"
                )
            checked[name] = check_given(name, value, card.may[name], form)
        return checked

    def start(self, card: Card, settings: Mapping[str, Any], seed: int, name: str) -> Start:
        """Return the start of a card that runs a training or a race.

        Args:
            card: the card.
            settings: settings of a participant, as `given` returns them.
            seed: seed of the run.
            name: name of the run.

        Raises:
            InvalidInput: if the form is not valid with these settings.
        """
        fields = _Fields({**card.form, **settings})
        body = fields.race(seed) if card.go == "race" else {**fields.training(), "seed": seed}
        return self._read("race" if card.go == "race" else "training", {**body, "name": name})

    def teaching(self, card: Card, trainer: str, name: str) -> TrainingStart:
        """Return the start of a robot that is taught on a card, by a trainer of its agent.

        Where people teach it, its steps last as long as the card says; errors as `start`.
        """
        assert card.teach is not None  # noqa: S101 - by its caller
        teach = card.teach
        settings = {
            "agent": teach.agent,
            "trainer": trainer,
            "watched_step_s": teach.step_s,
            "steps": teach.steps,
            # They would hold the robot while it is watched; at the end it is evaluated anyway.
            "evaluate_every": 0,
        }
        fields = _Fields({**card.form, **settings})
        body = {**fields.training(), "seed": 0, "name": name or None}
        start = self._read("training", body)
        assert isinstance(start, TrainingStart)  # noqa: S101 - by the body
        if trainer != "people":
            return start
        config = start.config
        return replace(start, config=replace(config, pace=config.robot.step_s / teach.step_s))

    def what_if(self, card: Card, settings: Mapping[str, Any]) -> TrainingConfig:
        """Return the config of the training of a what-if card; errors as `start`."""
        start = self._read("training", _Fields({**card.form, **settings}).training())
        assert isinstance(start, TrainingStart)  # noqa: S101 - by the body
        return start.config

    def check(self, lesson: Lesson, store: RunStore) -> None:
        """Check that the runs and what-ifs of the cards of a lesson can be started.

        Raises:
            InvalidInput: naming the card, if one cannot.
        """
        for number, card in enumerate(lesson.cards):
            if card.go is None and card.teach is None:
                continue
            try:
                if card.teach is not None:
                    check_training(self.teaching(card, "people", "").config)
                elif card.go == "what-if":
                    check_training(self.what_if(card, {}))
                else:
                    self.start(card, {}, 0, "").runs(store, lambda: "0")
            except HexapodError as error:
                raise InvalidInput(f"cards.{number}.state.form: {error}") from error

    def _read(self, kind: str, body: Mapping[str, Any]) -> TrainingStart | RaceStart:
        try:
            start: TrainingStart | RaceStart = _reader(self._agents, kind)(body).start()
        except ValidationError as error:
            errors = error.errors()
            if (refusal := refusal_in(errors)) is not None:
                raise refusal from refusal.__cause__
            errors_of_fields = field_errors(errors)
            raise InvalidInput(
                " ".join(entry["detail"] for entry in errors_of_fields[:3])
            ) from error
        return start


@cache
def _reader(agents: tuple[str, ...], kind: str) -> Callable[[Any], Any]:
    bodies: AgentBodies = agent_bodies(agents)
    return TypeAdapter(getattr(bodies, kind)).validate_python


class _Fields:
    """Fields of a form, sorted by the part of a request body that has them."""

    def __init__(self, form: Mapping[str, Any]) -> None:
        """Sort the fields; the settings of an agent may be in `settings`, or by themselves.

        Raises:
            UnknownName: if there is no such field.
            InvalidInput: if a text is no value of its field.
        """
        flat = {name: value for name, value in form.items() if name not in ("settings", *_LEFT_OUT)}
        settings = form.get("settings") or {}
        if not isinstance(settings, Mapping):
            raise InvalidInput("settings must be an object with the agent's settings, by name")
        agent = flat.pop("agent", TrainingConfig.agent)
        if not isinstance(agent, str) or agent not in (agents := names_of("agent") or []):
            raise UnknownName("agent", agent, agents)
        self.agent, self._lanes = agent, flat.pop("lanes", None)
        settings_of_agent, known_settings = agent_settings(agent), declared(form)
        self._walk: dict[str, Any] = {"gait": DEFAULT_GAIT}
        self._practice: dict[str, Any] = {}
        self._settings = {
            name: _value(value, settings_of_agent.get(name)) for name, value in settings.items()
        }
        self._of_lanes: dict[str, dict[str, Any]] = {}
        self._race_steps: dict[str, Any] = {}
        for name, text in flat.items():
            value = _value(text, known_settings.get(name))
            if name in _WALK:
                self._walk[name] = value
            elif name in _PRACTICE:
                self._practice[name] = value
            elif name == RACE_STEPS:
                self._race_steps = {"steps": value}
            elif name in settings_of_agent:
                self._settings[name] = value
            elif name in ("disturb", "disturbances"):
                self._walk.setdefault("disturbances", []).extend(_disturbances(value))
            elif "." in name:
                lane, _, setting = name.rpartition(".")
                self._of_lanes.setdefault(lane, {})[setting] = value
            else:
                valid = ["agent", "settings", *_WALK, "disturb", *_PRACTICE, *settings_of_agent]
                raise UnknownName("field", name[:60], [*valid, "lanes", RACE_STEPS])

    def training(self) -> dict[str, Any]:
        """Return the body of a training."""
        return {
            "agent": self.agent, **self._walk, **self._practice, "settings": self._settings
        }  # fmt: skip

    def race(self, seed: int) -> dict[str, Any]:
        """Return the body of a race, whose learners practise first."""
        default = [self.agent if lane == TrainingConfig.agent else lane for lane in PAPERS_LANES]
        names = self._lanes if self._lanes is not None else default
        if isinstance(names, str):
            names = [lane.strip() for lane in names.split(",") if lane.strip()]
        if not isinstance(names, list) or not all(isinstance(lane, str) for lane in names):
            raise InvalidInput("lanes must be a list of agents' names")
        lanes = [self._lane(name) for name in names]
        return {**self._walk, **self._race_steps, "lanes": lanes, "seed": seed}

    def _lane(self, agent: str) -> dict[str, Any]:
        find(agent)
        settings_of_lane = self._of_lanes.get(agent, {})
        settings = {k: _value(v, agent_settings(agent).get(k)) for k, v in settings_of_lane.items()}
        of_lane = {name: settings.pop(name) for name in LANE_FIELDS if name in settings}
        if not learns(agent):
            return {"agent": agent, **of_lane, "settings": settings}
        practised = self._settings if agent == self.agent else {}
        training = {**self._practice, "settings": {**practised, **settings}}
        return {"agent": agent, **of_lane, "training": training}


def _value(text: Any, setting: Any) -> Any:
    """Parse the value of a field of a form, which may be text as it was typed."""
    if not isinstance(text, str):
        return text
    if setting is not None:
        return setting.parse(text)
    if text.startswith("{"):
        try:
            return json.loads(text)
        except (ValueError, RecursionError) as error:
            raise InvalidInput(f"{text[:40]!r} is no JSON object") from error
    return text


def _disturbances(value: Any) -> list[Any]:
    several = value if isinstance(value, list) else [value]
    return [as_mapping(parse_disturbance(x)) if isinstance(x, str) else x for x in several]
