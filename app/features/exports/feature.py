"""Exports as a feature: routes, what the options say of them, and a process that renders."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar

from fastapi import APIRouter

from app.api.deps import Services
from app.feature import Feature
from app.features.exports import routes
from app.features.exports.file_renderer import FileRenderer
from app.features.exports.options import ExportOption, export_options
from app.settings import Settings
from hexapods.exports.registry import missing_extras


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

    @classmethod
    def checks(cls) -> Mapping[str, Callable[[Settings], str]]:
        return {"exports": _installed}

    def close(self) -> None:
        self.renderer.close()


def _installed(settings: Settings) -> str:
    """Say which files of a walk need a package that is missing; all of them are optional."""
    del settings
    missing = missing_extras()
    needs = [
        f"{', '.join(title for title in missing if missing[title] == install)}: `{install}`"
        for install in dict.fromkeys(missing.values())
    ]
    if not needs:
        return "the packages for all files of a walk are installed"
    return f"packages for some files of a walk are not installed: {'; '.join(needs)}"


FEATURE = Exports
