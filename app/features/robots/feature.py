"""Robots that people make as a feature: routes of stored ones, and fields of the body's editor."""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from fastapi import APIRouter

from app.api.deps import Services
from app.api.option_answers import SettingOption
from app.feature import Feature
from app.features.robots import routes
from app.features.robots.body_fields import leg_fields, torso_fields
from app.features.robots.readings import RobotReadings
from hexapods.runs.catalogue import setting_option


class RobotFeature(Feature):
    """Robots are stored from bodies and files, renamed, hidden, corrected and deleted.

    The store of robots is the core's: runs name robots that are stored in it.
    """

    name = "robots"
    option_types: ClassVar[Mapping[str, Any]] = {
        "leg_fields": dict[str, SettingOption],
        "torso_fields": dict[str, SettingOption],
    }

    def __init__(self, core: Services) -> None:
        super().__init__(core)
        core.provide(RobotReadings())

    @classmethod
    def routers(cls, agents: tuple[str, ...]) -> Sequence[APIRouter]:
        del agents
        return (routes.router,)

    @classmethod
    def options(cls, agents: tuple[str, ...]) -> Mapping[str, Any]:
        del agents
        fields = {"leg_fields": leg_fields(), "torso_fields": torso_fields()}
        return {
            group: {name: setting_option(setting) for name, setting in settings.items()}
            for group, settings in fields.items()
        }


FEATURE = RobotFeature
