"""Dask's scheduler and worker without their HTTP servers, which require no client certificate.

A module of its own, since importing Dask takes half a second. It relies on
`distributed.node.ServerNode.start_http_server` being the only place that starts the HTTP servers,
and on no other code using the attributes that it sets; the test of promise 29 checks every port
of a cluster.
"""

from typing import Any

from distributed import Scheduler, Worker

from hexapods.processes import set_process_name


class NoHttpServer:
    """Mixin that starts no HTTP server: only the port of Dask's own protocol is open."""

    def start_http_server(self, *args: Any, **options: Any) -> None:
        """Do nothing."""


class SchedulerWithoutHttp(NoHttpServer, Scheduler):
    """A scheduler whose only port requires a client certificate."""


class WorkerWithoutHttp(NoHttpServer, Worker):
    """A worker, in a process of its own, whose only port requires a client certificate."""

    def __init__(self, *args: Any, **options: Any) -> None:
        """Take Dask's arguments, and name the process."""
        set_process_name("dask worker")
        super().__init__(*args, **options)
