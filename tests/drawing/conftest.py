"""Fixtures: a real in-process viser server, and robots drawn on it."""

from tests.viewer.conftest import parts, robots, server, viser_server

__all__ = ["parts", "robots", "server", "viser_server"]
