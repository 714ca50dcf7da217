"""The promises are held against the same servers and pages as everything else."""

from tests.api.conftest import api, data, serve, trained
from tests.browser.conftest import dashboard, server

__all__ = ["api", "dashboard", "data", "serve", "server", "trained"]
