"""The guide as a feature: its pages."""

from collections.abc import Sequence

from starlette.routing import BaseRoute

from app.feature import Feature
from app.features.guide.pages import guide_routes
from hexapods import assets


class Guide(Feature):
    """The project's documentation as pages of the server."""

    name = "guide"

    def pages(self) -> Sequence[BaseRoute]:
        return guide_routes(assets.docs_dir())


FEATURE = Guide
