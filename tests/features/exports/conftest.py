"""Fixtures of the tests of exports, and of the API's, for those of this feature's routes."""

from tests.api.conftest import api, data, made_once, serve, shared, trained
from tests.exports.conftest import parts, raced

__all__ = ["api", "data", "made_once", "parts", "raced", "serve", "shared", "trained"]
