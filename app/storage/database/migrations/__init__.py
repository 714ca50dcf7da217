"""Alembic revisions of the core's tables. The file of a released revision is never changed.

Alembic discovers the files in `versions` by `env`; `docs/operations.md` describes an upgrade. To
change the tables, add a file to `versions` with the previous one as its `down_revision`. Features
have branches of their own, `app/features/NAME/migrations`.
"""
