"""Routes of what-ifs and of estimates, whose bodies are those that start runs."""

from collections.abc import Mapping
from functools import partial
from typing import Any

from fastapi import APIRouter, Request

from app.api.agent_bodies import agent_bodies
from app.api.answers import ComparisonView
from app.api.deps import RoleDep, Services, ServicesDep
from app.api.identity import charged_client
from app.api.policy import OPERATOR, QUESTION, api_router, policy
from app.api.record_response import RecordResponse
from app.api.starts import StartKind
from app.features.what_if.allowance import WHAT_IF, WhatIfAllowance
from app.features.what_if.estimate import Estimates
from app.features.what_if.response_models import EstimateView
from app.features.what_if.what_if import (
    MAX_STEPS,
    OPERATORS_LIMIT_S,
    SEEDS,
    SPECTATORS_LIMIT_S,
    WhatIf,
    WhatIfRequester,
)
from app.storage.run_kind import run_kinds, with_article
from hexapods.domain.errors import InvalidInput

_ESTIMATES: Mapping[str, tuple[str, str]] = {
    "training": ("a training", "Time a few steps of the agent on this machine, and extrapolate."),
    "race": (
        "a race and its practice",
        "Time a few steps of each lane, and extrapolate; not for a race that branches off.",
    ),
}
"""By kind of run of the core: its name in the summary of the route, and the description."""


def what_if_routes(agents: tuple[str, ...]) -> APIRouter:
    """Return the route of what-ifs.

    Args:
        agents: names of the registered agents.
    """
    router = api_router()
    training_body: Any = agent_bodies(agents).training

    @router.post(
        "/what-if",
        tags=["what-if"],
        summary=f"Compare {SEEDS} seeds of a practice with {SEEDS} of the defaults",
        description=(
            f"Take a training's body, of at most {MAX_STEPS:,} steps; always use the kinematic "
            f"simulator.\n\nIt may compute {SPECTATORS_LIMIT_S:g} s, for operators "
            f"{OPERATORS_LIMIT_S:g} s: settings that take longer are refused."
        ),
    )
    @policy(access=QUESTION, work=WHAT_IF)
    def ask_what_if(
        services: ServicesDep, request: Request, role: RoleDep, body: training_body
    ) -> RecordResponse[ComparisonView]:
        """Return distances with these settings and with defaults, on the kinematic simulator."""
        if body.continue_from is not None:
            raise InvalidInput("a what-if begins with an empty table; leave out continue_from")
        requester = WhatIfRequester(check=services.stopping.check)
        if role == "spectator":
            requester = spectator(services, charged_client(request.scope))
        return RecordResponse(services.of(WhatIf).ask(body.start().config, requester))

    return router


def _estimate_of(kind: str) -> tuple[str, str]:
    """Return the texts, as in `_ESTIMATES`, of a kind that a feature adds."""
    counted = run_kinds()[kind].counted
    description = f"Time a few steps of its agents, and extrapolate to all of its {counted}."
    return with_article(kind), description


def estimate_routes(start: StartKind) -> APIRouter:
    """Return the route that estimates how long a run would take.

    Args:
        start: the kind of run, with its body.
    """
    router = api_router()
    body_type: Any = start.body
    thing, description = _ESTIMATES.get(start.kind) or _estimate_of(start.kind)

    @router.post(
        f"/{start.kind}s/estimate",
        tags=[f"{start.kind}s"],
        summary=f"Estimate how long {thing} would take on this server",
        description=description,
        name=f"estimate_{start.kind}",
    )
    @policy(access=OPERATOR)
    def estimate_of_kind(services: ServicesDep, body: body_type) -> RecordResponse[EstimateView]:
        start, estimates = body.start(), services.of(Estimates)
        seconds = round(estimates.of(start), 1)
        estimate = EstimateView(seconds=seconds, workers=estimates.workers_of(start))
        return RecordResponse(estimate)

    return router


def spectator(services: Services, client: str) -> WhatIfRequester:
    """Return a spectator as the requester of a what-if, charged for its time beyond a second.

    Args:
        services: services of the core.
        client: client that is charged: an address, or the key of an identity.

    Raises:
        Busy: if the client's what-ifs before have taken more than its allowance.
    """
    allowance = services.of(WhatIfAllowance)
    allowance.check(client)
    return WhatIfRequester(
        is_operator=False,
        check=services.stopping.check,
        charge=partial(allowance.charge, client),
    )
