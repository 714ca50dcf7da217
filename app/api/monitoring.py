"""Probes of liveness and readiness, and metrics for Prometheus, collected at each scrape."""

from collections.abc import Iterable
from typing import Literal

from fastapi import Request
from prometheus_client import (
    CollectorRegistry,
    GCCollector,
    PlatformCollector,
    ProcessCollector,
    exposition,
)
from prometheus_client.metrics_core import (
    CounterMetricFamily,
    GaugeMetricFamily,
    InfoMetricFamily,
    Metric,
)
from prometheus_client.registry import Collector
from starlette.responses import Response

from app.answer import Answer
from app.api.contract import TEXT, answers
from app.api.deps import Services, ServicesDep
from app.api.policy import PUBLIC, WATCH, api_router, policy
from app.api.problems import problem
from app.api.record_response import RecordResponse
from app.api.work import PROBE
from app.events.damage import damage_counts
from app.storage.run import STATES
from hexapods.domain.errors import HexapodError
from hexapods.version import __version__

router = api_router(tags=["health"])


class HealthView(Answer):
    """Status and version of the server."""

    status: Literal["ok", "ready"]
    version: str


@router.get("/healthz", summary="Liveness probe")
@policy(access=PUBLIC, work=PROBE)
async def get_health() -> RecordResponse[HealthView]:
    """Return 200 as long as the server responds at all."""
    return RecordResponse(HealthView(status="ok", version=__version__))


@router.get("/readyz", summary="Readiness probe")
@policy(access=PUBLIC, work=PROBE)
def get_readiness(services: ServicesDep) -> RecordResponse[HealthView] | Response:
    """Return 503 with the reason while something that runs need is unavailable."""
    trouble = _unready_reason(services)
    if trouble is not None:
        return problem(503, trouble, headers={"Retry-After": "1"})
    return RecordResponse(HealthView(status="ready", version=__version__))


def _unready_reason(services: Services) -> str | None:
    """Return why runs cannot be started, in a sentence; None if they can."""
    if (reason := services.jobs.health_problem()) is not None:
        return reason
    try:
        services.store.check_disk_space()
        services.store.check_writable()
        services.store.list(limit=1)
    except HexapodError as error:
        return f"No run can be started: {error}."
    return None


@router.get(
    "/metrics",
    summary="Get metrics for Prometheus",
    response_class=Response,
    responses=answers(
        200, {"text/plain; version=0.0.4": TEXT, "application/openmetrics-text": TEXT}
    ),
)
@policy(access=WATCH)
def get_metrics(request: Request) -> Response:
    """Return metrics of runs by state, steps, viewers, the queue and the process."""
    encode, content_type = exposition.choose_encoder(request.headers.get("accept", ""))
    registry: CollectorRegistry = request.app.state.metrics
    return Response(encode(registry), headers={"Content-Type": content_type})


def registry_of(services: Services) -> CollectorRegistry:
    """Create an app's own registry, rather than use the global one."""
    registry = CollectorRegistry()
    registry.register(_ServicesCollector(services))
    for of_process in (ProcessCollector, PlatformCollector, GCCollector):
        of_process(registry=registry)
    return registry


class _ServicesCollector(Collector):
    def __init__(self, services: Services) -> None:
        self._services = services
        self._damaged = damage_counts(services.store)

    def collect(self) -> Iterable[Metric]:
        services = self._services
        counts, damaged = services.store.counts(), self._damaged()
        runs = GaugeMetricFamily("hexapods_runs", "Runs that are kept, by state.", labels=["state"])
        for state in STATES:
            runs.add_metric([state], counts.get(state, 0))
        yield runs
        yield GaugeMetricFamily(
            "hexapods_runs_damaged",
            "Runs that are kept and cannot be shown; hexapods doctor names them.",
            damaged["runs"],
        )
        rows = GaugeMetricFamily(
            "hexapods_rows_damaged",
            "Rows of the database that are left out, by table; hexapods doctor names them.",
            labels=["table"],
        )
        for table, number in damaged.items():
            rows.add_metric([table], number)
        yield rows
        yield GaugeMetricFamily(
            "hexapods_queue_depth", "Runs that wait for their turn.", counts.get("queued", 0)
        )
        yield CounterMetricFamily(
            "hexapods_steps", "Robots' steps computed, of all runs.", services.bus.steps
        )
        yield GaugeMetricFamily(
            "hexapods_steps_per_second",
            "Robots' steps computed a second, over the last ten seconds.",
            services.bus.steps_per_s,
        )
        yield GaugeMetricFamily(
            "hexapods_viewers",
            "Who watches the stage.",
            sum(shared.viewers for shared in services.stages),
        )
        yield CounterMetricFamily(
            "hexapods_pieces",
            "Pieces of the picture that were pushed, each to all who watch a stage.",
            sum(shared.pieces for shared in services.stages),
        )
        yield from services.features.metrics()
        yield InfoMetricFamily("hexapods", "The server.", {"version": __version__})
