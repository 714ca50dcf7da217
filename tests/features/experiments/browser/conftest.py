"""Fixtures of the browser's tests, for those of this feature's page."""

from tests.browser.conftest import dashboard, page, server, shared_server

__all__ = ["dashboard", "page", "server", "shared_server"]
