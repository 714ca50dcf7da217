"""Runs and all that belongs to them, kept: rows in a database, files beside it.

`store` is the interface (`RunStore`) and the shape of a run. `database` implements it for SQLite
and PostgreSQL. `artifacts` keeps files whole or not at all, `disk_space` their quota,
`recordings` and `stored_recordings` what the stage replays, `idempotency` and `sessions` what
outlives a request.
"""
