"""Response models of runs of any kind: those of the core, and those of kinds that features add."""

from typing import TYPE_CHECKING, Annotated, Literal, Union

from pydantic import Field

from app.api.answers import Page
from app.events.run_view import DamagedRunView, RaceView, RunView, TrainingView
from app.storage.run_kind import added_kinds, run_kinds

if TYPE_CHECKING:
    KindName = str
    AnyRunView = RunView | DamagedRunView
    ListedRunView = AnyRunView
else:
    KindName = Literal[tuple(run_kinds())]
    AnyRunView = Annotated[
        Union[(TrainingView, RaceView, *(kind.response_model() for kind in added_kinds()))],
        Field(discriminator="kind"),
    ]
    """A run of any kind."""
    ListedRunView = AnyRunView | DamagedRunView


class RunPage(Page):
    """Page of runs of every kind."""

    items: list[ListedRunView]
