"""Builds the application with `create_app`, and serves it with uvicorn; nothing at import."""

import asyncio
import contextlib
import gc
import logging
import os
import socket
import sys
import threading
from collections.abc import AsyncIterator, Callable, Iterator, Sequence
from functools import cache, partial
from types import FrameType

import uvicorn
from fastapi import APIRouter, FastAPI
from fastapi.routing import iter_route_contexts
from starlette.middleware.cors import CORSMiddleware
from starlette.routing import BaseRoute

from app.active_features import Features
from app.api import (
    contract,
    docs,
    events,
    monitoring,
    options,
    pages,
    problems,
    races,
    replays,
    robot_preview,
    runs,
    spectators,
    stage,
    trainings,
)
from app.api.concurrency_limit import WorkSlots
from app.api.deps import PageFiles, Services
from app.api.guards import RouteGuards
from app.api.host_check import HostGuard
from app.api.middleware import SecurityHeaders
from app.api.policy import (
    WATCH_STAGE,
    GuardedPage,
    RoutePolicy,
    api_router,
    guard_everything,
    operation_id,
)
from app.api.problem_pages import ProblemPages
from app.api.public_path import ForwardedPath, PublicPath
from app.api.request_headers import DeclaredHeaders
from app.api.stage_paths import StagePaths
from app.api.starts import start_kinds, start_routes
from app.api.unfinished import IncompleteBodyGuard
from app.api.wellformed import MalformedRequestGuard
from app.events import logs
from app.events.run_metrics import RunMetrics
from app.feature import Feature, blaming
from app.installed_features import load
from app.jobs.jobs import Jobs
from app.jobs.stopping import Stopping
from app.limits.client_slots import ClientSlots
from app.limits.http_protocol import KEEP_ALIVE_S, limited_http
from app.limits.listener import ACCEPTS_AT_ONCE, BACKLOG, Listener, listen
from app.limits.open_files import connection_table, raise_file_limit
from app.setting_fields import PREFIX
from app.settings import Settings
from app.stage.playback import Replays
from app.stage.roles import Roles
from app.storage.database.deletions import Deletions
from app.storage.database.opening import open_store
from app.storage.database.store import RunStore
from app.storage.errors import OwnershipLost
from app.storage.idempotency import Idempotency
from app.storage.recordings import Recordings
from app.storage.server_lock import write_address_file
from app.viewer.replay_frames import ReplayFrames
from app.viewer.shared_stage import SharedStage
from app.viewer.viewer_page import viewer_routes
from hexapods import assets
from hexapods.domain.errors import HexapodError, InvalidInput
from hexapods.processes import start_fork_server
from hexapods.runs.config import usable_agents
from hexapods.system_processes import return_freed_memory
from hexapods.version import __version__

_logger = logging.getLogger(__name__)
GRACE_S = 3
_PURGE_EVERY_S = 300
SWITCH_S = 0.001
"""Python's switch interval [s]: shorter than its 5 ms, for the event loop's latency."""
GC_OBJECTS = 10_000
"""New objects after which Python looks for garbage, rather than 700: a body of 1 MB may have
300,000 lists, and would be looked through hundreds of times."""
_TICKS_PER_S = 10
"""Frequency of uvicorn's main loop [1/s]."""
_PRELOADED = [
    "app.cli",
    "app.jobs.worker",
    "hexapods.imports.reading",
    "hexapods.physics.mujoco_simulator",
]
"""Modules that jobs, pools and readers of robots import: the program that started them, and those
that are imported late."""
_DESCRIPTION = (
    "Hexapods that learn to walk, and race against look-ahead search. Errors are problem "
    "documents (RFC 9457), and each says what is valid; requests that prefer text/html get a page."
)


def create_app(settings: Settings, store: RunStore) -> FastAPI:
    """Build the application; its lifespan starts and stops jobs and stages.

    Args:
        settings: settings of the server.
        store: store of the runs, which must stay open until the application has stopped.
    """
    recordings, bus = Recordings(store), RunMetrics()
    stopping = Stopping()
    replays = ReplayFrames(Replays(store, recordings), stopping)
    features = Features(load(settings.without), store)
    new_stage = partial(
        SharedStage,
        store,
        recordings,
        bus,
        roles=Roles(settings.token, store.sessions, is_public=settings.spectators == "public"),
        frames=replays,
        members=features.stage_members(),
    )
    stages = [shared := new_stage()]
    jobs = Jobs(
        store,
        recordings,
        bus,
        # The owner of a run sees it on another page, so it is not offered to the stage.
        on_queued=lambda run_id: features.owner_of(run_id) or shared.stage.offer(run_id),
        owner_of=features.owner_of,
        niceness=settings.job_niceness,
    )
    app = FastAPI(
        title="Racing Hexapods",
        version=__version__,
        description=_DESCRIPTION,
        lifespan=_lifespan,
        openapi_url=None,
        docs_url=None,
        redoc_url=None,
        generate_unique_id_function=operation_id,
    )
    app.state.services = Services(
        settings=settings,
        store=store,
        recordings=recordings,
        bus=bus,
        jobs=jobs,
        stages=stages,
        idempotency=Idempotency(store),
        agents=usable_agents(),
        replays=replays,
        stopping=stopping,
        listeners=ClientSlots(settings.max_viewers, settings.viewers_per_address),
        new_stage=lambda path: new_stage(path=path, session_path="", announces=False),
        features=features,
        page_files=PageFiles(assets.static_dir(), settings.without, features.page_folders),
    )
    features.build(app.state.services)
    store.is_public = features.visible_runs(None)
    for feature in features:
        bus.state_events |= set(feature.state_events)
    app.state.work_slots = WorkSlots()
    app.state.metrics = monitoring.registry_of(app.state.services)
    app.router.routes += _api_routes(app.state.services.agents, features.classes)
    app.router.routes += [
        *_viewer_routes(),
        *pages.page_routes(app.state.services.page_files),
    ]
    app.router.routes += _pages_of_features(app.routes, features)
    problems.install(app)
    providers = features.providers
    contract.install(app, app.state.services.agents, settings, features.classes, providers)
    guards = RouteGuards(settings, app.state.work_slots, features, app.exception_handlers)
    guard_everything(app, guards)
    _check_public_path(app.routes, settings.public_path)
    # The middleware that is added last runs first.
    if settings.cors_origins:
        app.add_middleware(
            CORSMiddleware,
            allow_origins=settings.cors_origins,
            allow_methods=("GET", "POST", "PUT", "PATCH", "DELETE"),
            allow_headers=("Authorization", "Content-Type", "Idempotency-Key", "X-Requested-With"),
            expose_headers=("Location", "Retry-After", "Content-Disposition"),
        )
    app.add_middleware(HostGuard, settings=settings)
    app.add_middleware(IncompleteBodyGuard)
    app.add_middleware(ProblemPages)
    app.add_middleware(StagePaths, stages=app.state.services.stages)
    app.add_middleware(PublicPath, path=settings.public_path)
    app.add_middleware(MalformedRequestGuard)
    app.add_middleware(DeclaredHeaders)
    app.add_middleware(SecurityHeaders, frame_ancestors=settings.frame_ancestors)
    return app


def _pages_of_features(routes: Sequence[BaseRoute], features: Features) -> list[BaseRoute]:
    """Return the pages that features add to routes.

    Raises:
        InvalidInput: if a feature has the path of another one, or of the core.
    """
    paths: set[str] = {getattr(route, "path", "") for route in routes}
    pages: list[BaseRoute] = []
    for feature in features:
        with blaming(type(feature), "`pages`"):
            added = feature.pages()
        for page in added:
            path: str = getattr(page, "path", "")
            _check_is_new(type(feature), path, path in paths)
            paths.add(path)
        pages += added
    return pages


def _check_public_path(routes: Sequence[BaseRoute], public_path: str) -> None:
    """Check that no page of the server begins with its public path, with which it may be called.

    Raises:
        InvalidInput: if one does.
    """
    contexts = iter_route_contexts(routes)
    paths = {context.path or getattr(context.original_route, "path", "") for context in contexts}
    first_names = {path.split("/")[1] for path in paths if path} - {""}
    if public_path and public_path.split("/")[1] in first_names:
        raise InvalidInput(
            f"{PREFIX}PUBLIC_URL may not begin its path with a name of the server's own paths: "
            f"{', '.join(sorted(first_names))}; choose another, such as /hex/"
        )


def _operations(router: APIRouter) -> Iterator[tuple[str, str]]:
    """Yield method and path of all routes of a router."""
    for context in iter_route_contexts(router.routes):
        path = context.path_format or context.path or ""
        yield from ((method, path) for method in context.methods or ())


def _check_is_new(feature: type[Feature], path: str, is_taken: bool) -> None:
    if is_taken:
        raise InvalidInput(
            f"the feature {feature.name} has the path {path}, which is there already; leave one of "
            f"both out by {PREFIX}WITHOUT"
        )


def _viewer_routes() -> list[BaseRoute]:
    """Return the routes of the 3D view behind the guards, of which its package knows nothing."""
    watch = RoutePolicy(access=WATCH_STAGE)
    return [
        GuardedPage(route.path, route.endpoint, watch, name=route.name) for route in viewer_routes()
    ]


@cache
def _api_routes(
    agents: tuple[str, ...], features: tuple[type[Feature], ...]
) -> tuple[BaseRoute, ...]:
    """Return the routes that are the same in all apps; FastAPI takes long to build them."""
    router, prefix = api_router(), "/api/v1"
    modules = (
        *(trainings, races, runs, replays),
        *(spectators, events, robot_preview),
    )
    routers = [module.router for module in modules]
    kinds = [*start_kinds(agents)]
    for feature in features:
        with blaming(feature, "`start_kinds`"):
            kinds += feature.start_kinds(agents)
    routers += [stage.stage_routes(features), options.option_routes(features)]
    routers += [replays.start_line_router, events.snapshot_routes(features)]
    routers.append(start_routes(agents, kinds))
    operations = {operation for added in routers for operation in _operations(added)}
    # First, so that their fixed paths, such as `/runs/NAME`, are not taken for a run's id.
    for feature in features:
        with blaming(feature, "`routers`"):
            of_starts = [added for kind in kinds for added in feature.routers_of_start(kind)]
            for added in (*feature.routers(agents), *of_starts):
                for method, path in set(_operations(added)):
                    _check_is_new(feature, f"{method} {prefix}{path}", (method, path) in operations)
                    operations.add((method, path))
                router.include_router(added, prefix=prefix)
    for added in routers:
        router.include_router(added, prefix=prefix)
    for included in (monitoring.router, docs.router):
        router.include_router(included)
    return tuple(router.routes)


@contextlib.asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    services: Services = app.state.services
    await asyncio.to_thread(services.stages[0].stage.restore)
    async with contextlib.AsyncExitStack() as opened:
        for shared in services.stages:
            await opened.enter_async_context(shared)
        await services.features.open(opened)
        services.jobs.open()
        await asyncio.to_thread(_resume_interrupted, services)
        purging = asyncio.create_task(_purge_deleted(services.store.deletions))
        try:
            yield
        finally:
            purging.cancel()
            services.bus.close()
            await _end_long_requests(app)
            await asyncio.to_thread(services.jobs.close)


async def _purge_deleted(deletions: Deletions) -> None:
    """Delete for good, at once and every few minutes, what can be restored no more."""
    while True:
        try:
            await asyncio.to_thread(deletions.purge)
        except HexapodError as error:
            _logger.warning("What was deleted stays on the disk for now: %s", error)
        await asyncio.sleep(_PURGE_EVERY_S)


def _resume_interrupted(services: Services) -> None:
    """Queue again what features let go on after a crash."""
    for run_id in list(services.features.unfinished()):
        try:
            services.jobs.resume(run_id)
        except HexapodError as error:
            _logger.warning("an interrupted run is not resumed: %s", error)
    services.features.on_resumed()


async def _end_long_requests(app: FastAPI) -> None:
    """Abort long requests: those that wait, by `Stopping.check`, and by killing the pools."""
    services: Services = app.state.services
    services.stopping.set()
    app.state.work_slots.close()
    for feature in services.features:
        try:
            await asyncio.to_thread(feature.close)
        except Exception:  # all else is still to end, such as the jobs with a checkpoint
            _logger.exception("the feature %s fails in `close`", feature.name)


def serve(settings: Settings, on_ready: Callable[[int], None] | None = None) -> None:
    """Serve until SIGINT or SIGTERM.

    Args:
        settings: settings of the server.
        on_ready: called once the server accepts connections, with its port.

    Raises:
        InvalidInput: if the data folder cannot be written or is locked by another server, or the
            address cannot be bound.
        DamagedFile, StorageFailed: if the database cannot be used.
        OwnershipLost: if another server took over the database.
    """
    settings.prepare_data()
    # No other user may open the files that this process and its children create.
    os.umask(0o077)
    start_fork_server(_PRELOADED)
    return_freed_memory()
    sys.setswitchinterval(SWITCH_S)
    gc.set_threshold(GC_OBJECTS, *gc.get_threshold()[1:])
    connections = connection_table(settings, raise_file_limit())
    listener = listen(settings, connections)
    logs.install(settings.log_level)
    if settings.public_url is not None and not settings.trusted_proxies:
        _logger.warning(
            "HEXAPODS_TRUSTED_PROXIES names no proxy: all clients of one count as one address"
        )
    if settings.frame_ancestors and not settings.has_https:
        _logger.warning(
            "HEXAPODS_FRAME_ANCESTORS needs HTTPS: over plain HTTP browsers keep no cookies in a "
            "frame of another site, so that nobody is operator or joins a room there; let a proxy "
            "do TLS, and set HEXAPODS_PUBLIC_URL to its https:// address"
        )
    lost = threading.Event()
    with listener, open_store(settings, on_lost=lost.set) as store:
        app = create_app(settings, store)
        config = uvicorn.Config(
            ForwardedPath(app, settings.proxy_networks),
            lifespan="on",
            log_config=None,
            log_level="warning",
            access_log=False,
            server_header=False,
            timeout_graceful_shutdown=GRACE_S,
            # `ForwardedPath` reads them.
            proxy_headers=False,
            timeout_keep_alive=KEEP_ALIVE_S,
            http=limited_http(connections),
            # uvloop may not call the sockets' `close`, which counts connections.
            loop="asyncio",
            # asyncio also uses it as the number of connections to accept at once.
            backlog=ACCEPTS_AT_ONCE,
            ws="none",
        )
        server = _Server(config, app, settings, listener, lost)
        server.on_ready = on_ready
        server.run(sockets=[listener])
    if lost.is_set():
        raise OwnershipLost("another server has taken the database over, so this one has ended")


class _Server(uvicorn.Server):
    """Uvicorn server that writes an address file, and closes event streams on shutdown."""

    def __init__(
        self,
        config: uvicorn.Config,
        app: FastAPI,
        settings: Settings,
        listener: Listener,
        lost: threading.Event,
    ) -> None:
        super().__init__(config)
        self._app, self._settings, self._listener = app, settings, listener
        self._lost = lost
        self.on_ready: Callable[[int], None] | None = None

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        if self.started:
            # Objects that exist now stay: the garbage collector need not look through them.
            gc.freeze()
            self._listener.listen(BACKLOG)
            write_address_file(self._settings.data, _local_address(self._listener))
            address = self._settings.public_url or _local_address(self._listener, "localhost")
            sys.stdout.write(f"Racing Hexapods is at {address} (Ctrl-C stops it)\n")
            sys.stdout.flush()
            if self.on_ready is not None:
                self.on_ready(self._listener.getsockname()[1])

    async def on_tick(self, counter: int) -> bool:
        if counter % _TICKS_PER_S == 0:
            self._listener.table.close_overdue()
        return await super().on_tick(counter) or self._lost.is_set()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        # uvicorn waits for all connections: an event stream would not end by itself, and what takes
        # long not in time.
        services: Services = self._app.state.services
        services.bus.close()
        await asyncio.gather(*(shared.close() for shared in services.stages))
        await _end_long_requests(self._app)
        await super().shutdown(sockets)

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        # uvicorn would raise the signal again after shutdown, which gives a nonzero exit code.
        del sig, frame
        self.force_exit = self.should_exit
        self.should_exit = True


def _local_address(listener: socket.socket, any_address: str = "127.0.0.1") -> str:
    """Return the URL of the server on this machine; `any_address` stands for a wildcard host."""
    name, port = listener.getsockname()[:2]
    if name in ("0.0.0.0", "::"):  # noqa: S104 - compared, not bound
        name = any_address
    return f"http://[{name}]:{port}/" if ":" in name else f"http://{name}:{port}/"
