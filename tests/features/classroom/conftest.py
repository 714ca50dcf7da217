"""Fixtures of the API's tests, for those of this feature's routes."""

from tests.api.conftest import api, data, made_once, serve, shared, trained
from tests.features.classroom.school import school

__all__ = ["api", "data", "made_once", "school", "serve", "shared", "trained"]
