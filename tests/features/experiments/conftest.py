"""Fixtures of the API's and of the jobs' tests, for those of experiments."""

from tests.api.conftest import api, data, made_once, serve, shared, trained
from tests.jobs.conftest import jobs, store

__all__ = ["api", "data", "jobs", "made_once", "serve", "shared", "store", "trained"]
