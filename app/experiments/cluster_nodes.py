"""Dask's scheduler and worker without their HTTP servers, which ask for no certificate.

Importing this takes half a second, which whoever computes nothing need not spend. It relies on
`distributed.node.ServerNode.start_http_server` being what starts them, and on nothing else using
what that sets; promise 29 looks at every port of a cluster.
"""

from typing import Any

from distributed import Scheduler, Worker


class NoPages:
    """Listens for the cluster's own messages only."""

    def start_http_server(self, *args: Any, **options: Any) -> None:
        """Start none."""


class PagelessScheduler(NoPages, Scheduler):
    """A scheduler whose only port wants a certificate."""


class PagelessWorker(NoPages, Worker):
    """A worker whose only port wants a certificate."""
