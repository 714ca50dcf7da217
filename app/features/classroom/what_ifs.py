"""What-ifs of cards, answered by the what-if feature, if it is not left out."""

from typing import ClassVar, Protocol, cast

from app.api.answers import ComparisonView
from app.api.work import OTHER, Work
from app.feature import Feature
from app.storage.errors import NotFound
from hexapods.runs.config import TrainingConfig


class _WhatIfFeature(Protocol):
    """Interface of the what-if feature: importing its class would make it a part of this one."""

    work: ClassVar[Work]

    def ask_as_spectator(self, training: TrainingConfig, client: str) -> ComparisonView: ...


class WhatIfs:
    """Answers what-ifs of participants."""

    def __init__(self, feature: Feature | None) -> None:
        """Use the what-if feature; None if it is left out."""
        self._feature = cast("_WhatIfFeature | None", feature)

    @property
    def work(self) -> Work:
        """Kind of work of a what-if."""
        return OTHER if self._feature is None else self._feature.work

    def ask(self, training: TrainingConfig, client: str) -> ComparisonView:
        """Return the answer to a what-if.

        Args:
            training: config that is compared with its defaults.
            client: client that is charged for the computing time.

        Raises:
            NotFound: if the feature is left out.
            Busy: if too many are waiting, or the client has used up its allowance.
        """
        if self._feature is None:
            raise NotFound(
                "this server answers no what-ifs: its operator has left that feature out"
            )
        return self._feature.ask_as_spectator(training, client)
