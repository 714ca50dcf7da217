"""Imported once by the fork server of the tests, for all the servers that it forks."""

from app.cli import without_garbage_collection
from app.runs.config import usable_agents

with without_garbage_collection():
    import app.jobs.worker
    import app.physics.mujoco_simulator
    import app.server  # noqa: F401
    from app.api.starts import start_routes

    start_routes(usable_agents())
