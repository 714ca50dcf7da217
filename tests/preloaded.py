"""Imported once by the fork server of the tests, for all the servers that it forks."""

import importlib
import tempfile

from app.cli.program import without_garbage_collection

_IMPORTED_LATE = (
    "anyio._backends._asyncio",
    "hexapods.experiments.cluster",
    "hexapods.experiments.report.files",
    "hexapods.experiments.summary",
    "hexapods.imports.reading",
    "hexapods.physics.mujoco_simulator",
    "numpy.ma",
    "rich.console",
)
"""What commands and jobs import when they first need it."""

with without_garbage_collection(), tempfile.TemporaryDirectory() as folder:
    for late in _IMPORTED_LATE:
        importlib.import_module(late)
    from app.server import create_app
    from app.settings import read_settings
    from app.storage.database.opening import open_store
    from hexapods.domain.robot import Robot
    from hexapods.drawing.robot_mesh import RobotMesh
    from hexapods.physics.mjcf import compile_model

    # What is built once in a process: models of the default robot, pages, routes and their
    # description.
    compile_model(Robot())
    RobotMesh(Robot())
    settings = read_settings(data=folder)
    with open_store(settings) as store:
        create_app(settings, store).openapi()
# It was found by now; each fork has a TMPDIR of its own.
tempfile.tempdir = None
