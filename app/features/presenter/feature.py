"""The presenter's window and its remote as a feature: what they show is kept with the stage."""

from collections.abc import Mapping
from typing import ClassVar

from app.feature import Feature
from app.features.presenter.presentation import Presentation
from hexapods.domain.records import Record


class PresenterFeature(Feature):
    """A window in large type, card by card, which its own keys or a remote command."""

    name = "presenter"
    stage_members: ClassVar[Mapping[str, type[Record]]] = {"presentation": Presentation}


FEATURE = PresenterFeature
