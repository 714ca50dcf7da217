"""What-ifs and estimates as a feature: their services, routes and options."""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from fastapi import APIRouter

from app.api.answers import ComparisonView
from app.api.deps import Services
from app.api.starts import StartKind
from app.feature import Feature
from app.features.what_if import routes
from app.features.what_if.allowance import WHAT_IF, WhatIfAllowance
from app.features.what_if.estimate import Estimates
from app.features.what_if.response_models import WhatIfDefaults
from app.features.what_if.settings import WhatIfSettings
from app.features.what_if.what_if import MAX_STEPS, SEEDS, WhatIf
from app.jobs.process_pool import ProcessPool
from hexapods.runs.config import TrainingConfig


class WhatIfFeature(Feature):
    """What-ifs of spectators and operators, and estimates of how long runs take.

    Attributes:
        work: kind of work of a what-if, for features that let their clients ask.
    """

    name = "what_if"
    work = WHAT_IF
    option_types: ClassVar[Mapping[str, Any]] = {"defaults.what_if": WhatIfDefaults}

    def __init__(self, core: Services) -> None:
        super().__init__(core)
        self._what_if = core.provide(WhatIf(ProcessPool()))
        core.provide(WhatIfAllowance(core.settings.of(WhatIfSettings)))
        estimates = Estimates(ProcessPool(count=1), core.jobs.cores, core.stopping)
        self._estimates = core.provide(estimates)

    @classmethod
    def routers(cls, agents: tuple[str, ...]) -> Sequence[APIRouter]:
        return (routes.what_if_routes(agents),)

    @classmethod
    def routers_of_start(cls, start: StartKind) -> Sequence[APIRouter]:
        return (routes.estimate_routes(start),)

    @classmethod
    def options(cls, agents: tuple[str, ...]) -> Mapping[str, Any]:
        del agents
        return {
            "defaults": {"what_if": {"seeds": SEEDS}},
            "limits": {"what_if_steps": [1, MAX_STEPS]},
            "help": {"what_if_steps": "How many steps of practice a what-if may have."},
        }

    def close(self) -> None:
        self._what_if.close()
        self._estimates.close()

    def ask_as_spectator(self, training: TrainingConfig, client: str) -> ComparisonView:
        """Answer the what-if of a spectator, for features that let their clients ask; see `WhatIf`.

        Args:
            training: the training.
            client: who is charged: an address, or the name of an identity.

        Raises:
            Busy: also if those before have taken more than the client's allowance.
        """
        return self._what_if.ask(training, routes.spectator(self.core, client))


FEATURE = WhatIfFeature
