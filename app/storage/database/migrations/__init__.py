"""How each released schema becomes the next. A file that was released is never changed.

`alembic` finds them by itself; `docs/operations.md` says what an upgrade does. A new one is a
file in `versions` that names the one before as its `down_revision`, together with a dump of its
schema in `tests/promises/released`.
"""
