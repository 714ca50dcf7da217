"""The demo as a feature: visitors, their allowance, and the clean-up of what they have made."""

import asyncio
import contextlib
import logging
from collections.abc import AsyncIterator, Iterable, Mapping, Sequence
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path
from typing import ClassVar

from fastapi import APIRouter
from prometheus_client.metrics_core import GaugeMetricFamily, Metric
from starlette.requests import Request
from starlette.responses import Response

from app.api.deps import Services, StartRequest
from app.api.identity import Identity
from app.api.runs import located
from app.feature import Feature
from app.features.demo import expiry, routes
from app.features.demo.access import Visitor, VisitorAccess
from app.features.demo.allowance import Allowance
from app.features.demo.expiry import Expiry
from app.features.demo.rows import VisitorRows
from app.features.demo.settings import DemoSettings
from app.features.demo.tables import METADATA
from app.features.demo.visitors import Visitors
from app.jobs.queue import Owner
from app.jobs.submissions import Start
from app.limits.addresses import client_of
from app.storage.database.store import RunStore
from app.storage.run import IdempotencyKey, Run

_logger = logging.getLogger(__name__)


class Demo(Feature):
    """A demo that is open to strangers.

    Attributes:
        visitors: of the server.
        expiry: deletes what they have made after a day.
    """

    name = "demo"
    uses = ("classroom", "tournaments")
    tables = METADATA
    migrations = Path(__file__).with_name("migrations")
    damage_advice: ClassVar[Mapping[str, str]] = {
        "visitor_runs": "nothing needs to be done: the next start of a server deletes these runs "
        "in time",
    }

    def __init__(self, core: Services) -> None:
        super().__init__(core)
        settings = core.settings.of(DemoSettings)
        self._is_demo = settings.demo
        self.visitors = core.provide(Visitors(core.store, Allowance.of(settings)))
        self.visitors.is_hidden = lambda run_id: core.features.is_hidden(run_id, None)
        # Filled by `open`: features of other packages are made later.
        self._others: list[Feature] = []
        self.expiry = core.provide(Expiry(core.store, core.jobs, self.visitors, self._others))

    @classmethod
    def routers(cls, agents: tuple[str, ...]) -> Sequence[APIRouter]:
        del agents
        return (routes.router,)

    @classmethod
    def read_rows(cls, store: RunStore) -> None:
        VisitorRows(store.database).all()

    @asynccontextmanager
    async def open(self) -> AsyncIterator[None]:
        if self._is_demo:
            self._others[:] = self.core.features
        # Before what they have made is shown, or goes on.
        await self._clean_up()
        cleaning = asyncio.create_task(self._keep_clean())
        try:
            yield
        finally:
            cleaning.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await cleaning

    def provider(self) -> VisitorAccess | None:
        return VisitorAccess(self.visitors, self.core.settings) if self._is_demo else None

    def owner_of(self, run_id: str) -> Owner | None:
        return self.visitors.owner_of(run_id)

    def start_run(
        self, request: Request, start_request: StartRequest, start: Start
    ) -> Response | None:
        """Start a run of a visitor, within the allowance, who is known by a cookie from then on.

        Of the idempotency key a hash is stored: who has the key of a first start owns its run.
        """
        identity: Identity | None = request.state.identity
        if not isinstance(identity, Visitor):
            return None
        cookie = identity.cookie
        visitors, jobs, address = self.visitors, self.core.jobs, client_of(request.scope)
        visitor_key, request_key = "", start_request.key

        def create(key: IdempotencyKey | None) -> list[Run]:
            nonlocal visitor_key
            queue = partial(jobs.start, key=key)
            started, visitor_key = visitors.start(cookie.value, address, start, queue, request_key)
            return [started]

        (run,) = start_request.with_hashed_key().runs(self.core, create)
        visitor_key = visitor_key or visitors.claim(cookie.value, request_key, run.id)
        response = located(self.core, request, run, 202)
        if visitor_key:
            age_s = int(visitors.allowance.lifetime.total_seconds())
            response.headers.append("Set-Cookie", cookie.set_header(visitor_key, age_s))
        return response

    def unfinished(self) -> Iterable[str]:
        return self.visitors.unfinished()

    def robots_txt(self) -> str | None:
        return routes.ROBOTS_TXT if self._is_demo else None

    def metrics(self) -> Iterable[Metric]:
        yield GaugeMetricFamily(
            "hexapods_visitors",
            "Visitors of a demo of whom something is kept or counted.",
            self.visitors.count,
        )

    def adopt(self, run_ids: Sequence[str]) -> None:
        self.visitors.forget(run_ids)

    async def _keep_clean(self) -> None:
        """Clean up a demo for as long as there is one, or something is left of one."""
        while self._is_demo or self.visitors.count:
            await asyncio.sleep(expiry.EVERY_S)
            await self._clean_up()

    async def _clean_up(self) -> None:
        try:
            gone = await asyncio.to_thread(self.expiry.sweep)
            for feature, names in zip(self._others, gone, strict=True):
                await feature.forget(names)
        except Exception:  # such as a damaged file: the next clean-up is not to be left out
            _logger.exception("the clean-up has failed")


FEATURE = Demo
