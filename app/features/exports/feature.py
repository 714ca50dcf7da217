"""Exports as a feature: routes, what the options say of them, and a process that renders."""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from fastapi import APIRouter

from app.api.deps import Services
from app.feature import Feature
from app.features.exports import routes
from app.features.exports.file_renderer import FileRenderer
from app.features.exports.options import ExportOption, export_options


class Exports(Feature):
    """The recorded walks of races and trainings as files.

    Attributes:
        renderer: renders large files, such as videos.
    """

    name = "exports"
    option_types: ClassVar[Mapping[str, Any]] = {"exports": list[ExportOption]}

    def __init__(self, core: Services) -> None:
        super().__init__(core)
        self.renderer = core.provide(FileRenderer(check=core.stopping.check))

    @classmethod
    def routers(cls, agents: tuple[str, ...]) -> Sequence[APIRouter]:
        del agents
        return (routes.router,)

    @classmethod
    def options(cls, agents: tuple[str, ...]) -> Mapping[str, Any]:
        del agents
        return {"exports": export_options()}

    def close(self) -> None:
        self.renderer.close()


FEATURE = Exports
