"""Fixtures of the API's and of the jobs' tests, for those of experiments."""

from importlib.util import find_spec

from tests.api.conftest import api, data, made_once, serve, shared, trained
from tests.jobs.conftest import jobs, store

# What is tested there is not there without its folder.
collect_ignore = [] if find_spec("app.features.archives") else ["test_archive.py"]
__all__ = ["api", "data", "jobs", "made_once", "serve", "shared", "store", "trained"]
