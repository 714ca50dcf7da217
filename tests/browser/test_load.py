"""Transfers of a first visit, without the 3D view."""

from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import CDPSession

from tests.browser.dashboard import Dashboard
from tests.browser.serving import Serving

pytestmark = pytest.mark.timeout(300)

MAX_REQUESTS = 60
MAX_BYTES = 250_000


@dataclass
class Traffic:
    """Requests of a page and their bytes on the wire, headers included; frames are left out."""

    paths: dict[str, str] = field(default_factory=dict)
    sizes: dict[str, int] = field(default_factory=dict)

    def record(self, session: CDPSession) -> None:
        """Count from now on."""
        session.on("Network.requestWillBeSent", self._sent)
        session.on("Network.dataReceived", self._received)
        session.on("Network.loadingFinished", self._finished)
        session.send("Network.enable")
        session.send("Network.setCacheDisabled", {"cacheDisabled": True})

    @property
    def total_bytes(self) -> int:
        """Bytes of the counted requests, as far as they have come."""
        return sum(size for request, size in self.sizes.items() if request in self.paths)

    def _sent(self, event: dict[str, Any]) -> None:
        url = urlsplit(event["request"]["url"])
        # The 3D view also loads `data:` and `blob:` addresses, which are no requests.
        if url.scheme == "http" and not url.path.startswith("/viewer/"):
            self.paths[event["requestId"]] = url.path

    def _received(self, event: dict[str, Any]) -> None:
        # For streams, which do not finish.
        request = event["requestId"]
        self.sizes[request] = self.sizes.get(request, 0) + event["encodedDataLength"]

    def _finished(self, event: dict[str, Any]) -> None:
        self.sizes[event["requestId"]] = event["encodedDataLength"]


def test_a_first_visit_transfers_little(dashboard: Dashboard, server: Serving) -> None:
    traffic = Traffic()
    traffic.record(dashboard.page.context.new_cdp_session(dashboard.page))
    dashboard.open(server.address)
    dashboard.page.wait_for_load_state("load")

    paths = sorted(traffic.paths.values())
    scripts = [path for path in paths if path.endswith(".js")]
    assert "/static/js/main.js" in scripts
    assert len({*scripts}) == len(scripts)
    assert len(paths) <= MAX_REQUESTS, "\n".join(paths)
    assert traffic.total_bytes <= MAX_BYTES
