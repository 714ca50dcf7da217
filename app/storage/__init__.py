"""Persistent storage of runs: rows in a database, artifact files beside it.

- `database` is the store of runs, in SQLite or PostgreSQL; `run` defines what it stores,
  `run_kind` its kinds, also those that features add, `errors` its exceptions, `run_names` the names
  of runs that nobody has named; `stored_robot` a robot.
- `artifacts` writes files atomically and verifies their SHA-256; `artifact_file` reads them in
  chunks, `npz_artifacts` their arrays; `disk_space` enforces the quota of the data folder.
- `recordings`, `stored_trainings` and `stored_races` hold the recorded motion that the stage
  replays.
- `idempotency`, `sessions` and `run_ids`: idempotency keys, operators' sessions, sortable ids.
- `stored_tables` loads tables and checkpoints; `json_text` encodes JSON.
- `untrusted_input` has the base class and field types with which input from elsewhere is parsed;
  `imported_tables` validates tables from elsewhere.
- `server_lock` admits one server to a data folder, and records where it listens; `private_folder`
  shuts out other users of the machine.
"""
