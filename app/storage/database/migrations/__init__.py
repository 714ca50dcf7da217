"""Alembic migrations from each released schema to the next. A released file is never changed.

Alembic discovers the files in `versions` by `env`; `docs/operations.md` describes an upgrade. To
add a migration, add a file to `versions` with the previous one as its `down_revision`, and a dump
of its schema to `tests/promises/released`.
"""
