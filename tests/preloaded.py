"""Imported once by the fork server of the tests, for all the servers that it forks."""

import importlib
from tempfile import TemporaryDirectory

from app.cli import without_garbage_collection

with without_garbage_collection(), TemporaryDirectory() as folder:
    importlib.import_module("app.physics.mujoco_simulator")
    from app.server import create_app
    from app.settings import read_settings
    from app.storage.database.opening import open_store

    settings = read_settings(data=folder)
    # What is built once in a process: the routes and their description.
    with open_store(settings) as store:
        create_app(settings, store).openapi()
